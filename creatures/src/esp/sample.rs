//! A creature made by hand: a quadruped that walks by four oscillators, with three eyes. It proves that machines
//! compute alike, and is what rates are measured with; nothing evolves from it.

use super::Genotype;
use super::body::genotype::{Body, Edge, Joint, Muscle, Receptor, Segment};
use super::body::{Phenotype, Shape};
use super::brain::{Brain, Control, Node, NodeKind, Output, Seal, Source, Target};
use super::key::GeneId;
use super::syllabus::SkillId;
use glam::{DQuat, DVec3};

/// The skill that it has: the first of any syllabus.
const SKILL: SkillId = SkillId(0);
/// How often it strides, 1/s.
const STRIDES: f64 = 1.5;
/// How many oscillators it has, each a quarter of a stride after the other.
const PHASES: u16 = 4;

/// Where the front hips are along the trunk, m from its middle.
pub const FRONT: f64 = 0.22;
/// How often the tail's gene occurs.
const TAIL: u8 = 3;

/// The body: a trunk of 28.8 kg, four legs of two segments of 2.4 kg with muscles in front and behind, and eyes
/// ahead, to the left and to the right.
pub fn quadruped_body() -> Body {
    body(&[FRONT, -FRONT], false)
}

/// A trunk with a pair of legs at each of so many places along it, m, and a tail of three segments or none: 4
/// parts without legs, 16 with three pairs.
pub fn body(hips: &[f64], tail: bool) -> Body {
    let (trunk, thigh, shin, link) = (GeneId(0), GeneId(1), GeneId(2), GeneId(3));
    let leg = Shape::Box([0.05, 0.05, 0.12]);
    let eyes = [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, -1.0, 0.0)];
    let eyes = eyes.into_iter().zip(100..).map(|(direction, id)| Receptor {
        id: GeneId(id),
        owner: SKILL,
        locked: false,
        direction: direction.normalize(),
    });
    let segment = |id, shape| Segment { id, shape, recursion_limit: 1, receptors: Vec::new() };
    let hip = |(x, id): (&f64, u32)| {
        let out = DVec3::new(*x, 0.13, -0.06).normalize();
        let muscles = [1.0, -1.0].map(|side| (out + 0.5 * side * DVec3::X, DVec3::new(side, 0.0, -0.3)));
        edge(id, [trunk, thigh], [out, DVec3::Z], true, muscles)
    };
    let mut segments = vec![
        Segment { receptors: eyes.collect(), ..segment(trunk, Shape::Box([0.3, 0.15, 0.08])) },
        segment(thigh, leg),
        segment(shin, leg),
    ];
    let mut edges: Vec<Edge> = hips.iter().zip(10..).map(hip).collect();
    let knee = [1.0, -1.0].map(|side| (DVec3::new(side, 0.0, -0.5), DVec3::new(side, 0.0, 0.5)));
    edges.push(edge(20, [thigh, shin], [DVec3::NEG_Z, DVec3::Z], false, knee));
    if tail {
        segments.push(Segment { recursion_limit: TAIL, ..segment(link, Shape::Box([0.12, 0.06, 0.04])) });
        let bend = [1.0, -1.0].map(|side| (DVec3::new(-0.5, 0.0, side), DVec3::new(0.5, 0.0, side)));
        edges.push(edge(21, [trunk, link], [DVec3::NEG_X, DVec3::X], false, bend));
        edges.push(edge(22, [link, link], [DVec3::NEG_X, DVec3::X], false, bend));
    }
    Body { root: trunk, next_id: 200, segments, edges }
}

/// A hinge about y between a parent and a child, with two muscles that bend it either way.
fn edge(
    id: u32,
    [from, to]: [GeneId; 2],
    [parent_dir, child_dir]: [DVec3; 2],
    symmetric: bool,
    muscles: [(DVec3, DVec3); 2],
) -> Edge {
    let muscles = muscles.into_iter().zip(2 * id + 20..).map(|((on_parent, on_child), id)| Muscle {
        id: GeneId(id),
        owner: SKILL,
        locked: false,
        parent_dir: on_parent.normalize(),
        child_dir: on_child.normalize(),
        strength: 0.5,
    });
    Edge {
        id: GeneId(id),
        from,
        to,
        parent_dir,
        child_dir,
        orientation: DQuat::IDENTITY,
        gap: 0.03,
        scale: 1.0,
        reflect: false,
        symmetric,
        terminal_only: false,
        joint: Joint::Revolute,
        axis: DVec3::Y,
        travel: 0.1,
        muscles: muscles.collect(),
    }
}

/// It strides whatever it sees.
pub fn walker() -> Genotype {
    walking(quadruped_body())
}

/// A body that strides whatever it sees.
pub fn walking(body: Body) -> Genotype {
    let oscillator = |phase: u16| Node {
        kind: NodeKind::Sinusoidal { frequency: STRIDES, phase: f64::from(phase) / f64::from(PHASES) },
        inputs: Vec::new(),
    };
    let nodes = (0..PHASES).map(oscillator).collect();
    let outputs = drive(&body, |place| place % PHASES);
    Genotype { brain: brain(nodes, outputs), body }
}

/// It strides on the side of the eye that sees the light.
pub fn seeker() -> Genotype {
    let body = quadruped_body();
    let phenotype = develop(&body);
    let mut nodes = Vec::new();
    for (phase, receptor) in (0..PHASES).zip(phenotype.receptors.iter().cycle()) {
        let at = nodes.len() as u16;
        let phase = f64::from(phase) / f64::from(PHASES);
        nodes.push(Node { kind: NodeKind::Sinusoidal { frequency: STRIDES, phase }, inputs: Vec::new() });
        let bright = Some(Source::Photo(receptor.key.clone()));
        nodes.push(Node { kind: NodeKind::Scale { factor: 4.0 }, inputs: vec![bright] });
        let both = vec![Some(Source::Node(at)), Some(Source::Node(at + 1))];
        nodes.push(Node { kind: NodeKind::Multiply, inputs: both });
    }
    let outputs = drive(&body, |place| 3 * (place % PHASES) + 2);
    Genotype { brain: brain(nodes, outputs), body }
}

fn brain(nodes: Vec<Node>, outputs: Vec<Output>) -> Brain {
    Brain { controls: vec![Control { skill: SKILL, seal: Seal::Open, nodes, outputs }] }
}

/// Every muscle, driven by the node of its place.
fn drive(body: &Body, node: impl Fn(u16) -> u16) -> Vec<Output> {
    let muscles = (0..).zip(develop(body).muscles);
    muscles.map(|(place, muscle)| Output { node: node(place), target: Target::Muscle(muscle.key) }).collect()
}

fn develop(body: &Body) -> Phenotype {
    body.develop().expect("the body is legal; a test says so")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_are_legal() {
        let cases = [
            (body(&[], true), (4, 6, 3)),
            (quadruped_body(), (9, 16, 3)),
            (body(&[FRONT, 0.0, -FRONT], true), (16, 30, 3)),
        ];
        for (body, expected) in cases {
            body.check().unwrap();
            let phenotype = body.develop().unwrap();
            let counts = (phenotype.parts.len(), phenotype.muscles.len(), phenotype.receptors.len());
            assert_eq!(counts, expected);
        }
        assert!((quadruped_body().develop().unwrap().mass() - 48.0).abs() < 1e-9);
    }
}

//! Graphs for tests: small cubes in a row, to be changed field by field.

use super::genotype::{Body, Edge, Joint, Muscle, Receptor, Segment};
use super::shape::Shape;
use crate::esp::key::GeneId;
use crate::esp::syllabus::SkillId;
use glam::{DQuat, DVec3};

/// A cube of 0.2 m.
pub(in crate::esp) fn segment(id: u32, recursion_limit: u8) -> Segment {
    Segment { id: GeneId(id), shape: Shape::Box([0.1; 3]), recursion_limit, receptors: vec![] }
}

/// A child straight ahead, turned as its parent is, on a hinge about y.
pub(in crate::esp) fn edge(id: u32, from: u32, to: u32) -> Edge {
    Edge {
        id: GeneId(id),
        from: GeneId(from),
        to: GeneId(to),
        parent_dir: DVec3::X,
        child_dir: -DVec3::X,
        orientation: DQuat::IDENTITY,
        gap: 0.05,
        scale: 1.0,
        reflect: false,
        symmetric: false,
        terminal_only: false,
        joint: Joint::Revolute,
        axis: DVec3::Y,
        travel: 0.1,
        muscles: vec![],
    }
}

/// The same child to some side.
pub(in crate::esp) fn side(id: u32, from: u32, to: u32, way: DVec3) -> Edge {
    Edge { parent_dir: way, child_dir: -way, ..edge(id, from, to) }
}

/// Along the tops of parent and child.
pub(in crate::esp) fn muscle(id: u32) -> Muscle {
    Muscle {
        id: GeneId(id),
        owner: SkillId(0),
        locked: false,
        parent_dir: DVec3::Z,
        child_dir: DVec3::Z,
        strength: 0.5,
    }
}

/// Looks ahead.
pub(in crate::esp) fn receptor(id: u32) -> Receptor {
    Receptor { id: GeneId(id), owner: SkillId(0), locked: false, direction: DVec3::X }
}

/// The root is the first segment.
pub(in crate::esp) fn body(segments: Vec<Segment>, edges: Vec<Edge>) -> Body {
    let ids = segments.iter().map(|gene| gene.id.0).chain(edges.iter().map(|gene| gene.id.0));
    let muscles = edges.iter().flat_map(|gene| gene.muscles.iter().map(|muscle| muscle.id.0));
    let receptors = segments.iter().flat_map(|gene| gene.receptors.iter().map(|receptor| receptor.id.0));
    let next_id = 1 + ids.chain(muscles).chain(receptors).max().expect("a body has a segment");
    Body { root: segments[0].id, next_id, segments, edges }
}

/// A torso with a pair of two-part arms, a muscle at each joint, and an eye on each hand.
pub(in crate::esp) fn swimmer() -> Body {
    let mut hand = segment(2, 1);
    hand.receptors = vec![receptor(7)];
    let mut shoulder = Edge { symmetric: true, ..side(3, 0, 1, DVec3::Y) };
    shoulder.muscles = vec![muscle(5)];
    let mut elbow = side(4, 1, 2, DVec3::Y);
    elbow.muscles = vec![muscle(6)];
    body(vec![segment(0, 1), segment(1, 1), hand], vec![shoulder, elbow])
}

//! Creatures made by hand: what the physics does to them.

use super::*;
use crate::esp::body::phenotype::{Muscle, Receptor};
use crate::esp::brain::tests::key;
use crate::esp::key::GeneId;

/// A body of one part.
pub(in crate::esp) fn lump(shape: Shape) -> Phenotype {
    let root = Part {
        key: Vec::new(),
        segment: GeneId(0),
        shape,
        position: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        joint: None,
    };
    Phenotype { parts: vec![root], ..Phenotype::default() }
}

/// Hangs an unturned part on another, in one direction from centre to centre (E-14).
pub(in crate::esp) fn attach(
    body: &mut Phenotype,
    parent: usize,
    shape: Shape,
    direction: DVec3,
    gap: f64,
    kind: genotype::Joint,
    axis: DVec3,
) -> usize {
    let anchor = |shape: Shape, direction| shape.surface_point(direction) + gap * direction;
    let parent_anchor = anchor(body.parts[parent].shape, direction);
    let child_anchor = anchor(shape, -direction);
    body.parts.push(Part {
        key: Vec::new(),
        segment: GeneId(body.parts.len() as u32),
        shape,
        position: body.parts[parent].position + parent_anchor - child_anchor,
        rotation: DQuat::IDENTITY,
        joint: Some(PartJoint { parent, kind, parent_anchor, child_anchor, axis, travel: 0.1 }),
    });
    body.parts.len() - 1
}

/// Ties a muscle between two parts, at surface points in given directions (E-6).
pub(in crate::esp) fn tie(body: &mut Phenotype, parts: [usize; 2], directions: [DVec3; 2], strength: f64) {
    let ends = [0, 1].map(|end| body.parts[parts[end]].shape.surface_point(directions[end].normalize()));
    let places = [0, 1].map(|end| body.parts[parts[end]].position + ends[end]);
    let area = parts.map(|part| body.parts[part].shape.cross_section()).into_iter().fold(1.0, f64::min);
    let id = 1000 + body.muscles.len() as u32;
    body.muscles.push(Muscle {
        key: key(id),
        parts,
        ends,
        rest_length: (places[1] - places[0]).length(),
        force_max: strength * 2e4 * area,
    });
}

/// A trunk with four legs of two segments, a muscle in front of and one behind every hip and knee.
pub(in crate::esp) fn quadruped() -> Phenotype {
    let mut body = lump(Shape::Box([0.3, 0.15, 0.08]));
    for (x, y) in [(0.22, 0.13), (0.22, -0.13), (-0.22, 0.13), (-0.22, -0.13)] {
        let out = DVec3::new(x, y, -0.06).normalize();
        let leg = Shape::Box([0.05, 0.05, 0.12]);
        let thigh = attach(&mut body, 0, leg, out, 0.04, genotype::Joint::Revolute, DVec3::Y);
        let knee = genotype::Joint::Revolute;
        let shin = attach(&mut body, thigh, leg, -DVec3::Z, 0.03, knee, DVec3::Y);
        for side in [1.0, -1.0] {
            let across = DVec3::new(side, 0.0, -0.3);
            tie(&mut body, [0, thigh], [out + 0.5 * side * DVec3::X, across], 0.5);
            tie(&mut body, [thigh, shin], [DVec3::new(side, 0.0, -0.5), DVec3::new(side, 0.0, 0.5)], 0.5);
        }
    }
    body
}

fn spawn(body: &Phenotype) -> Creature<'_> {
    Creature::spawn(body, Physics::default(), Start::Rest).unwrap()
}

/// A muscle or receptor too many, whose activation stays 0, changes no bit (T-13, E-26).
#[test]
fn an_undriven_muscle_or_a_receptor_changes_no_bit() {
    let body = quadruped();
    let run = |body: &Phenotype| {
        let mut creature = spawn(body);
        let mut activations = vec![0.0; body.muscles.len()];
        let states = (0..300).map(|step| {
            for (muscle, activation) in activations.iter_mut().enumerate().take(16) {
                *activation = if (step / 15 + muscle) % 2 == 0 { 1.0 } else { 0.0 };
            }
            creature.step(&activations).unwrap();
            creature.state()
        });
        states.collect::<Vec<State>>()
    };
    let before = run(&body);
    assert!((before[299].centre - before[0].centre).length() > 0.02, "it moves");
    let mut more = body.clone();
    tie(&mut more, [0, 4], [DVec3::NEG_X, DVec3::Y], 1.0);
    more.receptors.push(Receptor { key: key(7), part: 2, point: DVec3::X * 0.05, axis: DVec3::X });
    assert_eq!(run(&more), before);
}

//! What is seen of a walker: its boxes on the ground, and where they are. It moves and measures nothing.

use super::body::{BodyKind, Part as Plan};
use super::phenotype::Phenotype;
use crate::record::{Frame, Part, Pose, Prop, Scene, Shape};
use glam::DVec3;

/// A body on its ground, heading towards −y (G-57), in the order of its parts.
pub(super) fn scene(body: BodyKind, step: f64) -> Scene {
    let plan = body.plan();
    let part = |name: String, part: &Plan| Part {
        name,
        creature: Some(0),
        shapes: vec![Shape::Box { half: 0.5 * part.size }],
    };
    let mut parts = vec![part(plan.torso.name.to_owned(), &plan.torso)];
    // Limbs are attached on the side x < 0 first, which is the right of who looks towards −y.
    for side in ["right", "left"] {
        parts.extend(plan.limb.iter().map(|link| part(format!("{side}_{}", link.part.name), &link.part)));
    }
    Scene {
        length_unit: "m".to_owned(),
        time_unit: "s".to_owned(),
        step,
        up: DVec3::Z,
        forward: DVec3::NEG_Y,
        creatures: vec![body.name().to_owned()],
        parts,
        props: vec![Prop { name: "ground".to_owned(), shape: Shape::Ground, pose: Pose::at(DVec3::ZERO) }],
        muscles: vec![],
        cords: vec![],
    }
}

/// Where the parts are now.
pub(super) fn frame(phenotype: &Phenotype) -> Frame {
    let world = phenotype.world();
    let pose = |&part| Pose::Rigid { position: world.position(part), orientation: world.orientation(part) };
    Frame {
        centers: vec![world.center_of_mass()],
        poses: phenotype.parts().iter().map(pose).collect(),
        ..Frame::default()
    }
}

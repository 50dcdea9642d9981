//! What is seen of a flyer: bones and films high above the ground, and where they are. It moves and measures
//! nothing.

use super::phenotype::Phenotype;
use super::skeleton::Bone;
use crate::record::{Frame, Part, Pose, Prop, Scene, Shape};
use glam::DVec3;

/// A flyer over its ground, in the order of its bones (F-2, F-22).
pub(super) fn scene(bones: &[Bone], step: f64) -> Scene {
    let segments = (bones.len() - 2) / 2;
    let name = |index: usize| match index {
        0 => "body".to_owned(),
        1 => "wing_root".to_owned(),
        index if index < 2 + segments => format!("left_wing_{}", index - 1),
        index => format!("right_wing_{}", index - 1 - segments),
    };
    let part = |(index, bone): (usize, &Bone)| {
        let mut shapes = vec![Shape::Capsule { radius: bone.radius, half_length: 0.5 * bone.length }];
        shapes.extend(bone.film.map(|film| Shape::Plate { corners: film.corners.to_vec() }));
        Part { name: name(index), creature: Some(0), shapes }
    };
    Scene {
        length_unit: "m".to_owned(),
        time_unit: "s".to_owned(),
        step,
        up: DVec3::Y,
        forward: DVec3::Z,
        creatures: vec!["flyer".to_owned()],
        parts: bones.iter().enumerate().map(part).collect(),
        props: vec![Prop { name: "ground".to_owned(), shape: Shape::Ground, pose: Pose::at(DVec3::ZERO) }],
        muscles: vec![],
        cords: vec![],
    }
}

/// Where the bones are now.
pub(super) fn frame(phenotype: &Phenotype) -> Frame {
    let world = phenotype.world();
    let pose = |body| Pose::Rigid { position: world.position(body), orientation: world.orientation(body) };
    Frame {
        centers: vec![world.center_of_mass()],
        poses: world.bodies().map(pose).collect(),
        ..Frame::default()
    }
}

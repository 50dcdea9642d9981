//! What is seen of a creature: its parts, the ground and discs. Lights are its trial's.

use super::Creature;
use crate::esp::body::Shape as Segment;
use crate::esp::body::phenotype::{self, Part as Expressed};
use crate::esp::brain::TICK;
use crate::esp::fitness::setup::{DISC_HEIGHT, DISC_RADIUS};
use crate::record::{Cord, Frame, Part, Pose, Prop, Scene, Shape};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_1_SQRT_2;

/// From the axes of a recorded capsule, which is along z, to ours, along x.
const CAPSULE: DQuat = DQuat::from_xyzw(0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);

impl Creature<'_> {
    pub(super) fn view(&self) -> Scene {
        let part = |(index, part): (usize, &Expressed)| Part {
            name: format!("part {index}"),
            creature: Some(0),
            shapes: vec![shape(part.shape)],
        };
        let ground = Prop { name: "ground".to_owned(), shape: Shape::Ground, pose: Pose::at(DVec3::ZERO) };
        let discs = self.discs.iter().map(|&centre| Prop {
            name: "disc".to_owned(),
            shape: Shape::Cylinder { radius: DISC_RADIUS, half_length: 0.5 * DISC_HEIGHT },
            pose: Pose::at(centre),
        });
        Scene {
            length_unit: "m".to_owned(),
            time_unit: "s".to_owned(),
            step: TICK,
            up: DVec3::Z,
            forward: DVec3::X,
            creatures: vec!["creature".to_owned()],
            parts: self.phenotype.parts.iter().enumerate().map(part).collect(),
            props: std::iter::once(ground).chain(discs).collect(),
            muscles: self.phenotype.muscles.iter().map(|muscle| muscle.key.to_string()).collect(),
            cords: self.phenotype.muscles.iter().map(|muscle| self.cord(muscle)).collect(),
        }
    }

    pub(super) fn shot(&self) -> Frame {
        let pose = |(index, part): (usize, &Expressed)| {
            let pose = self.world.pose(index);
            Pose::Rigid {
                position: pose.position,
                orientation: (pose.rotation * turn(part.shape)).normalize(),
            }
        };
        Frame {
            centers: vec![self.state.centre],
            poses: self.phenotype.parts.iter().enumerate().map(pose).collect(),
            muscles: vec![self.pulls.iter().map(|pull| pull.activation).collect()],
            ..Frame::default()
        }
    }

    fn cord(&self, muscle: &phenotype::Muscle) -> Cord {
        let end =
            |end: usize| turn(self.phenotype.parts[muscle.parts[end]].shape).inverse() * muscle.ends[end];
        Cord { parts: muscle.parts.map(|part| part as u32), ends: [end(0), end(1)] }
    }
}

/// From the axes in which a segment is recorded to its own.
fn turn(segment: Segment) -> DQuat {
    if matches!(segment, Segment::Capsule { .. }) { CAPSULE } else { DQuat::IDENTITY }
}

fn shape(segment: Segment) -> Shape {
    match segment {
        Segment::Box(half) => Shape::Box { half: DVec3::from_array(half) },
        Segment::Sphere(radius) => Shape::Sphere { radius },
        Segment::Capsule { radius, half_length } => Shape::Capsule { radius, half_length },
    }
}

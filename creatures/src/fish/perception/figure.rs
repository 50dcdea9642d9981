//! How a fish looks to the others: a copy of all that they may learn of it. A percept is what one
//! fish makes of another's figure.

use super::capsule::{Capsule, RADIUS};
use crate::fish::Posture;
use crate::fish::behaviour::Stage;
use crate::fish::habits::{Habits, Nature, Sex};
use crate::fish::mind::Intention;
use crate::fish::world::FishId;
use crate::math::{asin, atan2};
use glam::DVec3;

/// The nodes that are looked for when a fish is hidden in part.
const OUTLINE: [usize; 7] = [0, 5, 6, 7, 8, 21, 22];

/// A fish as others see it, world frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Which one.
    pub id: FishId,
    /// Whether it is in the water still; nothing else holds of one that is not.
    pub alive: bool,
    /// Predator, prey or pacifist.
    pub nature: Nature,
    /// Its colour.
    pub species: u32,
    /// Male or female.
    pub sex: Sex,
    /// Whether it is one to school with.
    pub schooling: bool,
    /// S.
    pub size: f64,
    /// f, of length 1.
    pub forward: DVec3,
    /// û, of length 1.
    pub up: DVec3,
    /// f × û.
    pub right: DVec3,
    /// b.
    pub center: DVec3,
    /// The nose.
    pub mouth: DVec3,
    /// Where it sees from.
    pub eye: DVec3,
    /// Midway between the tips of the tail.
    pub tail: DVec3,
    /// The belly.
    pub abdomen: DVec3,
    /// Of its centre of mass, length by time.
    pub velocity: DVec3,
    /// Seven nodes all around it.
    pub outline: [DVec3; 7],
    /// Nose, means of the five rings, tail.
    pub axis: [DVec3; 7],
    /// What stands in the light.
    pub shadow: Capsule,
    /// What it shows that it means to do.
    pub intention: Intention,
    /// Whom it shows that it courts.
    pub partner: Option<FishId>,
    /// How far its courtship is.
    pub stage: Stage,
}

impl Figure {
    /// Of a fish of some habits, from its 23 nodes and the velocity of its centre of mass. It shows nothing of
    /// what it means to do.
    pub fn new(id: FishId, habits: &Habits, positions: &[DVec3], velocity: DVec3) -> Figure {
        let posture = Posture::new(positions);
        let ring = |ring: usize| positions[1 + 4 * ring..5 + 4 * ring].iter().sum::<DVec3>() * 0.25;
        let (mouth, tail) = (posture.mouth(), posture.tail());
        let axis = [mouth, ring(0), ring(1), ring(2), ring(3), ring(4), tail];
        Figure {
            id,
            alive: true,
            nature: habits.nature,
            species: habits.species,
            sex: habits.sex,
            schooling: habits.schooling,
            size: habits.size,
            forward: posture.forward,
            up: posture.up,
            right: posture.right(),
            center: posture.center(),
            mouth,
            eye: posture.eye(),
            tail,
            abdomen: posture.abdomen(),
            velocity,
            outline: OUTLINE.map(|node| positions[node]),
            axis,
            shadow: Capsule { ends: [axis[1], axis[4]], radius: RADIUS * habits.size },
            intention: Intention::Wander,
            partner: None,
            stage: Stage::Search,
        }
    }

    /// L, its body length.
    pub fn length(&self) -> f64 {
        20.0 * self.size
    }

    /// A point as it lies to this fish's eye.
    pub fn locate(&self, point: DVec3) -> Bearing {
        let way = point - self.eye;
        let (ahead, left, above) = (way.dot(self.forward), -way.dot(self.right), way.dot(self.up));
        let distance = way.length();
        Bearing {
            distance,
            bearing: atan2(left, ahead),
            elevation: if distance > 0.0 { asin((above / distance).clamp(-1.0, 1.0)) } else { 0.0 },
            climb: atan2(above, ahead),
        }
    }

    /// E, the angle within [0, π] between where it heads and a point, seen from the mouth; 0 on the mouth
    /// (AF-9).
    pub fn turning_angle(&self, point: DVec3) -> f64 {
        let way = point - self.mouth;
        let across = way.cross(self.forward).length();
        if across == 0.0 && way.dot(self.forward) >= 0.0 { 0.0 } else { atan2(across, way.dot(self.forward)) }
    }
}

/// Where something is to a fish.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bearing {
    /// From the eye.
    pub distance: f64,
    /// In the plane of the fish, rad, left positive.
    pub bearing: f64,
    /// Above the plane of the fish, rad.
    pub elevation: f64,
    /// In the fish's plane of symmetry, rad, up positive: 0 ahead, π behind.
    pub climb: f64,
}

/// What a fish knows of another that it sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Percept<'a> {
    /// How the other looks: id, species, size, orientation, velocity and its signals.
    pub figure: &'a Figure,
    /// Where it is.
    pub place: Bearing,
    /// From b to b.
    pub distance: f64,
}

impl<'a> Percept<'a> {
    /// Of a figure, by a viewer.
    pub fn new(viewer: &Figure, figure: &'a Figure) -> Percept<'a> {
        let distance = (figure.center - viewer.center).length();
        Percept { figure, place: viewer.locate(figure.center), distance }
    }
}

//! How deep two parts overlap (E-18), by parry's distances in double precision. A round shape is a core, its centre
//! or its axis, with a skin about it: the distance of two cores says how deep their skins overlap, and no search for
//! a depth can go astray.

use super::Shape;
use super::phenotype::Part;
use glam::DVec3;
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::{Ball, Cuboid, Segment, Shape as Core};

/// A part as parry has it.
pub(super) struct Solid {
    core: Box<dyn Core>,
    /// Thickness of the skin about the core, m; 0 for a box alone.
    skin: f64,
    pose: Pose,
    centre: DVec3,
    /// Of the ball about it, m.
    radius: f64,
}

impl Solid {
    pub(super) fn of(part: &Part) -> Solid {
        let (core, skin, radius): (Box<dyn Core>, f64, f64) = match part.shape {
            Shape::Box(half) => {
                let half = DVec3::from_array(half);
                (Box::new(Cuboid::new(Vector::from_array(half.to_array()))), 0.0, half.length())
            }
            Shape::Sphere(radius) => (Box::new(Ball::new(0.0)), radius, radius),
            Shape::Capsule { radius, half_length } => {
                let end = Vector::new(half_length, 0.0, 0.0);
                (Box::new(Segment::new(-end, end)), radius, radius + half_length)
            }
        };
        let position = Vector::from_array(part.position.to_array());
        let pose = Pose::from_parts(position, Rotation::from_array(part.rotation.to_array()));
        Solid { core, skin, pose, centre: part.position, radius }
    }

    /// Whether one of two parts would have to move by more than a depth, m, for both to be apart. The depth is
    /// less than the thickness of any skin.
    pub(super) fn overlaps(&self, other: &Solid, depth: f64) -> bool {
        let reach = self.radius + other.radius - depth;
        if self.centre.distance_squared(other.centre) >= reach * reach {
            return false;
        }
        let skin = self.skin + other.skin;
        if skin > 0.0 {
            let apart = query::distance(&self.pose, &*self.core, &other.pose, &*other.core);
            apart.expect(SUPPORTED).distance < skin - depth
        } else {
            let contact = query::contact(&self.pose, &*self.core, &other.pose, &*other.core, 0.0);
            contact.expect(SUPPORTED).is_some_and(|contact| contact.dist < -depth)
        }
    }
}

const SUPPORTED: &str = "parry measures every pair of boxes, segments and balls";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::key::GeneId;
    use crate::math::from_rotation_vector;
    use glam::DQuat;

    const CUBE: Shape = Shape::Box([0.1, 0.1, 0.1]);
    const BALL: Shape = Shape::Sphere(0.1);
    const PILL: Shape = Shape::Capsule { radius: 0.1, half_length: 0.2 };

    fn solid(shape: Shape, position: DVec3, rotation: DQuat) -> Solid {
        Solid::of(&Part { key: vec![], segment: GeneId(0), shape, position, rotation, joint: None })
    }

    /// E-18: every pair of shapes, along the line on which their depth is plain.
    #[test]
    fn every_pair_of_shapes_may_overlap_by_a_depth_and_no_more() {
        let turned = from_rotation_vector(DVec3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        for (first, second, touching, rotation) in [
            (CUBE, CUBE, 0.2, DQuat::IDENTITY),
            (CUBE, BALL, 0.2, DQuat::IDENTITY),
            (CUBE, PILL, 0.4, DQuat::IDENTITY),
            (CUBE, PILL, 0.2, turned),
            (BALL, CUBE, 0.2, DQuat::IDENTITY),
            (BALL, BALL, 0.2, turned),
            (BALL, PILL, 0.4, DQuat::IDENTITY),
            (PILL, CUBE, 0.4, DQuat::IDENTITY),
            (PILL, BALL, 0.4, DQuat::IDENTITY),
            (PILL, PILL, 0.6, DQuat::IDENTITY),
            (PILL, PILL, 0.4, turned),
        ] {
            let at = |distance| solid(second, DVec3::X * distance, rotation);
            let origin = solid(first, DVec3::ZERO, DQuat::IDENTITY);
            let overlaps = |distance| origin.overlaps(&at(distance), 0.005);
            assert!(!overlaps(touching + 0.001), "{first:?}, {second:?} are apart");
            assert!(!overlaps(touching - 0.004), "{first:?}, {second:?} overlap by 4 mm");
            assert!(overlaps(touching - 0.006), "{first:?}, {second:?} overlap by 6 mm");
            assert!(overlaps(0.01) && overlaps(0.0), "{first:?}, {second:?} are one in the other");
        }
    }
}

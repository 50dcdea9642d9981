//! Joints between two parts: none has a motor, and only sliding axes have stops.

use super::world::Pose;
use glam::{DQuat, DVec3};
use rapier3d::prelude::{GenericJoint, JointAxesMask, JointAxis};

/// What a joint leaves free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// Nothing.
    Fixed,
    /// Rotation about the axis.
    Revolute,
    /// Every rotation.
    Spherical,
    /// Translation along the axis, as far as its travel to either side, m.
    Prismatic(f64),
    /// Rotation about the axis and translation along it, as far as its travel to either side, m.
    Cylindrical(f64),
}

/// How a child hangs from its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// What it leaves free.
    pub kind: JointKind,
    /// Its place in the parent's frame, m.
    pub parent_anchor: DVec3,
    /// Its place in the child's frame, m.
    pub child_anchor: DVec3,
    /// Unit, parent's frame.
    pub axis: DVec3,
}

impl JointKind {
    /// How far it slides to either side, m.
    fn travel(self) -> Option<f64> {
        match self {
            JointKind::Prismatic(travel) | JointKind::Cylindrical(travel) => Some(travel),
            JointKind::Fixed | JointKind::Revolute | JointKind::Spherical => None,
        }
    }
}

impl Joint {
    /// How far apart the anchors are where they should not be, m: off the free axis, and along it beyond the
    /// travel.
    pub(super) fn separation(&self, parent: &Pose, child: &Pose) -> f64 {
        let apart = child.point(self.child_anchor) - parent.point(self.parent_anchor);
        let Some(travel) = self.kind.travel() else { return apart.length() };
        let axis = parent.rotation * self.axis;
        let along = apart.dot(axis);
        let across = (apart - along * axis).length();
        let beyond = along.abs() - travel;
        if beyond > across { beyond } else { across }
    }

    /// The engine's joint, whose x axis is ours. `turn` is the child's rotation in the parent's frame as built:
    /// what is locked stays as it is then.
    pub(super) fn build(&self, turn: DQuat) -> GenericJoint {
        use JointAxesMask as Axes;
        let across = Axes::LIN_Y | Axes::LIN_Z;
        let tilts = Axes::ANG_Y | Axes::ANG_Z;
        let locked = match self.kind {
            JointKind::Fixed => Axes::LOCKED_FIXED_AXES,
            JointKind::Revolute => Axes::LIN_X | across | tilts,
            JointKind::Spherical => Axes::LIN_X | across,
            JointKind::Prismatic(_) => across | Axes::ANG_X | tilts,
            JointKind::Cylindrical(_) => across | tilts,
        };
        let frame = frame_of(self.axis);
        let mut joint = GenericJoint::default();
        joint.lock_axes(locked).set_contacts_enabled(true);
        joint.local_frame1 = Pose { position: self.parent_anchor, rotation: frame }.engine();
        joint.local_frame2 = Pose { position: self.child_anchor, rotation: turn.inverse() * frame }.engine();
        if let Some(travel) = self.kind.travel() {
            joint.set_limits(JointAxis::LinX, [-travel as f32, travel as f32]);
        }
        joint
    }
}

/// A rotation that takes x to an axis, without a trigonometric function.
fn frame_of(axis: DVec3) -> DQuat {
    let half = DVec3::X + axis;
    if half.length_squared() < 1e-12 {
        return DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0); // half a turn about z
    }
    let half = half.normalize();
    let turn = DVec3::X.cross(half);
    DQuat::from_xyzw(turn.x, turn.y, turn.z, half.x).normalize()
}

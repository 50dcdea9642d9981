//! One joint in one step: its free directions, the motion it has to take back, and its coordinates. It
//! solves nothing.
//!
//! Parent and child meet at the *child's* anchor. Every impulse of the joint acts on both there, equal and
//! opposite and at one point, so that it changes neither linear nor angular momentum, whatever the anchors'
//! drift. The parent's material point under that anchor carries a slider's axis with it, which makes the
//! relative velocity along the axis the exact rate of the slider's coordinate.

use super::model::{Joint, JointKind, StopRule};
use super::spatial::Six;
use super::staircase::{Demand, Motor, Staircase, Tread};
use crate::math;
use glam::{DMat3, DQuat, DVec3};

/// Where a body is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose {
    pub(super) position: DVec3,
    pub(super) orientation: DQuat,
    /// The orientation as a matrix.
    pub(super) rotation: DMat3,
}

impl Pose {
    pub(super) fn new(position: DVec3, orientation: DQuat) -> Pose {
        Pose { position, orientation, rotation: DMat3::from_quat(orientation) }
    }
}

/// What a degree of freedom does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Freedom {
    Turn,
    Slide,
}

/// One degree of freedom that a joint leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Degree {
    pub(super) motor: Motor,
    pub(super) stops: Option<(f64, f64)>,
    pub(super) staircase: Staircase,
    /// An impulse that holds whatever the staircase says: the last resort of a step (see `rounds`).
    pub(super) given: Option<f64>,
    /// Its place on the staircase, kept from step to step.
    pub(super) tread: Tread,
    /// The twist at the reference point of a unit rate.
    pub(super) direction: Six,
    /// Solved: rad/s or m/s.
    pub(super) rate: f64,
    /// Solved: of motor and stop together, on the child, N·m·s or N·s.
    pub(super) impulse: f64,
    /// Of the elimination: the momentum that a unit rate needs.
    pub(super) momentum: Six,
    /// Of the elimination: the impulse along the direction that a unit of each component needs.
    pub(super) need: Six,
    /// Of the elimination: one over the inertia along the direction.
    pub(super) mobility: f64,
    /// Of the elimination: the rate if the parent stood still.
    pub(super) drift: f64,
}

impl Degree {
    /// Starts a step at a coordinate, which matters only if there are stops.
    fn begin(&mut self, coordinate: f64, pace: &Pace) {
        let (low, high) = match self.stops {
            None => (f64::NEG_INFINITY, f64::INFINITY),
            Some(stops) => stop_rates(stops, coordinate, pace),
        };
        self.staircase = Staircase::new(self.motor, low, high, pace.dt);
        self.tread = self.staircase.warm(self.tread);
        self.given = None;
    }

    /// What it asks of a round.
    pub(super) fn demand(&self) -> Demand {
        self.given.map_or_else(|| self.staircase.demand(self.tread), Demand::Free)
    }
}

/// A joint, its constants and its state.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub(super) parent: usize,
    pub(super) kind: JointKind,
    parent_anchor: DVec3,
    child_anchor: DVec3,
    /// Child to parent axes in the start pose, inverted.
    rest_inverse: DQuat,
    /// The hinge's axis in the child's axes.
    child_axis: DVec3,
    /// The relative twist at the reference point that undoes the joint's drift.
    pub(super) bias: Six,
    /// Of the elimination: the bias and the locked degrees of freedom at their rates.
    pub(super) offset: Six,
    pub(super) degrees: usize,
    dofs: [Degree; 3],
    /// Of a joint with stops, in the pose as it is: both the stops and whoever senses the joint want them.
    known: Option<[f64; 3]>,
}

/// The stops' constants of one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    pub(super) dt: f64,
    /// The share of an error that one step takes back, over the step: 1/s.
    pub(super) correction: f64,
    pub(super) rule: StopRule,
}

impl Link {
    pub(super) fn new(parent: usize, joint: &Joint, base: DQuat, tip: DQuat) -> Link {
        let rest = base.inverse() * tip;
        let axis = match joint.kind {
            JointKind::Hinge { axis } | JointKind::Slider { axis } => axis,
            JointKind::Fixed | JointKind::Ball => DVec3::X,
        };
        Link {
            parent,
            kind: joint.kind,
            parent_anchor: joint.parent_anchor,
            child_anchor: joint.child_anchor,
            rest_inverse: rest.inverse(),
            child_axis: rest.inverse() * axis,
            bias: Six::ZERO,
            offset: Six::ZERO,
            degrees: joint.kind.degrees(),
            dofs: joint.stops.map(|stops| Degree {
                motor: Motor::default(),
                stops,
                staircase: Staircase::default(),
                given: None,
                tread: Tread::default(),
                direction: Six::ZERO,
                rate: 0.0,
                impulse: 0.0,
                momentum: Six::ZERO,
                need: Six::ZERO,
                mobility: 0.0,
                drift: 0.0,
            }),
            known: None,
        }
    }

    /// Takes note of a new pose.
    pub(super) fn follow(&mut self, parent: &Pose, child: &Pose) {
        if self.dofs().iter().any(|dof| dof.stops.is_some()) {
            self.known = Some(self.measure(parent, child));
        }
    }

    pub(super) fn dofs(&self) -> &[Degree] {
        &self.dofs[..self.degrees]
    }

    pub(super) fn dofs_mut(&mut self) -> &mut [Degree] {
        &mut self.dofs[..self.degrees]
    }

    /// Makes the joint ready for a step: directions and bias at the reference point, staircases.
    pub(super) fn prepare(&mut self, parent: &Pose, child: &Pose, reference: DVec3, pace: &Pace) {
        let at = self.meeting(child) - reference;
        for dof in 0..self.degrees {
            self.dofs[dof].direction = match self.axis(parent, dof) {
                (axis, Freedom::Turn) => Six::new(at.cross(axis), axis),
                (axis, Freedom::Slide) => Six::new(axis, DVec3::ZERO),
            };
        }
        let mut linear = self.gap(parent, child);
        let angular = match self.kind {
            JointKind::Ball => DVec3::ZERO,
            JointKind::Hinge { axis } => (parent.rotation * axis).cross(child.rotation * self.child_axis),
            JointKind::Fixed => parent.rotation * self.twist(parent, child),
            JointKind::Slider { axis } => {
                let axis = parent.rotation * axis;
                linear -= axis * axis.dot(linear);
                parent.rotation * self.twist(parent, child)
            }
        };
        let (linear, angular) = (linear * -pace.correction, angular * -pace.correction);
        self.bias = Six::new(linear + at.cross(angular), angular);
        let coordinates = self.known.unwrap_or_default();
        for (dof, coordinate) in self.dofs_mut().iter_mut().zip(coordinates) {
            dof.begin(coordinate, pace);
        }
    }

    /// The coordinates of its degrees of freedom, rad or m; zeros for what it has not.
    pub(super) fn coordinates(&self, parent: &Pose, child: &Pose) -> [f64; 3] {
        self.known.unwrap_or_else(|| self.measure(parent, child))
    }

    fn measure(&self, parent: &Pose, child: &Pose) -> [f64; 3] {
        match self.kind {
            JointKind::Fixed => [0.0; 3],
            JointKind::Hinge { axis } => {
                let q = self.rotation(parent, child);
                [math::wrap_angle(2.0 * math::atan2(axis.dot(q.xyz()), q.w)), 0.0, 0.0]
            }
            JointKind::Ball => math::rotation_vector(self.rotation(parent, child)).to_array(),
            JointKind::Slider { axis } => [(parent.rotation * axis).dot(self.gap(parent, child)), 0.0, 0.0],
        }
    }

    /// The anchors' distance off the free axis, m.
    pub(super) fn separation(&self, parent: &Pose, child: &Pose) -> f64 {
        let gap = self.gap(parent, child);
        match self.kind {
            JointKind::Slider { axis } => {
                let axis = parent.rotation * axis;
                (gap - axis * axis.dot(gap)).length()
            }
            JointKind::Fixed | JointKind::Hinge { .. } | JointKind::Ball => gap.length(),
        }
    }

    /// Where the two bodies meet, world frame: the child's anchor.
    pub(super) fn meeting(&self, child: &Pose) -> DVec3 {
        child.position + child.rotation * self.child_anchor
    }

    /// The axis of a degree of freedom, world frame, and whether it turns about it or slides along it.
    pub(super) fn axis(&self, parent: &Pose, dof: usize) -> (DVec3, Freedom) {
        match self.kind {
            JointKind::Fixed => (DVec3::ZERO, Freedom::Turn),
            JointKind::Hinge { axis } => (parent.rotation * axis, Freedom::Turn),
            JointKind::Ball => (parent.rotation.col(dof), Freedom::Turn),
            JointKind::Slider { axis } => (parent.rotation * axis, Freedom::Slide),
        }
    }

    /// From the parent's anchor to the child's, world frame.
    fn gap(&self, parent: &Pose, child: &Pose) -> DVec3 {
        self.meeting(child) - (parent.position + parent.rotation * self.parent_anchor)
    }

    /// The child's rotation since the start, in the parent's axes.
    fn rotation(&self, parent: &Pose, child: &Pose) -> DQuat {
        parent.orientation.conjugate() * child.orientation * self.rest_inverse
    }

    /// The same as a vector, twice the sine of half its angle long: what drift there is is small, and no
    /// transcendental function is needed to take it back.
    fn twist(&self, parent: &Pose, child: &Pose) -> DVec3 {
        let q = self.rotation(parent, child);
        q.xyz() * if q.w < 0.0 { -2.0 } else { 2.0 }
    }
}

/// Between which rates the stops leave a coordinate.
fn stop_rates((low, high): (f64, f64), coordinate: f64, pace: &Pace) -> (f64, f64) {
    let rate = |excess: f64, towards: f64| match pace.rule {
        StopRule::Reached if excess < 0.0 => -towards * f64::INFINITY,
        StopRule::Anticipated if excess < 0.0 => towards * (excess / pace.dt),
        _ => towards * (excess * pace.correction),
    };
    (rate(low - coordinate, 1.0), rate(coordinate - high, -1.0))
}

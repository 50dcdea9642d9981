//! What goes into a world between steps, motors and pushes, and what can be read off it. Nothing here moves
//! a body.

use super::joint::{Freedom, Link};
use super::model::{BodyId, JointId};
use super::staircase::Motor;
use super::world::{Mass, World};
use glam::{DMat3, DQuat, DVec3};

impl World {
    /// Commands a motor; the command holds until it is changed. A new world's motors are limp.
    ///
    /// # Panics
    /// If the joint has no such degree of freedom.
    pub fn drive(&mut self, joint: JointId, dof: usize, motor: Motor) {
        self.links[joint.0].dofs_mut()[dof].motor = motor;
    }

    /// Adds a force, N, at a body's centre of mass and a torque, N·m, both in the world frame, for the next
    /// step only.
    pub fn push(&mut self, body: BodyId, force: DVec3, torque: DVec3) {
        let body = &mut self.bodies[body.0];
        body.force += force;
        body.torque += torque;
    }

    /// Sets a body's velocity, m/s, and angular velocity, rad/s, world frame. Joints that these violate
    /// take them back in the next step, by impulses. A fixture stays at rest.
    pub fn set_velocity(&mut self, body: BodyId, velocity: DVec3, spin: DVec3) {
        if self.fixture && body.0 == 0 {
            return;
        }
        let body = &mut self.bodies[body.0];
        (body.velocity, body.spin) = (velocity, spin);
        let rotation = body.pose.rotation;
        body.angular_momentum = rotation * (body.moments * (rotation.transpose() * spin));
    }

    /// Degrees of freedom of a joint.
    pub fn degrees(&self, joint: JointId) -> usize {
        self.links[joint.0].degrees
    }

    /// A joint's coordinate: a hinge's angle in [−π, π), a component of a ball's rotation vector in the
    /// parent's axes, rad, or a slider's distance of anchors, m. In the start pose it is 0, a slider's the
    /// distance of the anchors (flyer F-16, F-17; walker G-16).
    ///
    /// # Panics
    /// If the joint has no such degree of freedom.
    pub fn coordinate(&self, joint: JointId, dof: usize) -> f64 {
        let link = self.link(joint, dof);
        link.coordinates(&self.bodies[link.parent].pose, &self.bodies[joint.0 + 1].pose)[dof]
    }

    /// All coordinates of a joint at once, as [`World::coordinate`] has them, 0 for what it has not: a ball's
    /// three cost no more than one.
    pub fn coordinates(&self, joint: JointId) -> [f64; 3] {
        let link = &self.links[joint.0];
        link.coordinates(&self.bodies[link.parent].pose, &self.bodies[joint.0 + 1].pose)
    }

    /// The rate of child against parent along a degree of freedom, rad/s or m/s: what its motor sees.
    ///
    /// # Panics
    /// If the joint has no such degree of freedom.
    pub fn rate(&self, joint: JointId, dof: usize) -> f64 {
        let link = self.link(joint, dof);
        let (parent, child) = (&self.bodies[link.parent], &self.bodies[joint.0 + 1]);
        match link.axis(&parent.pose, dof) {
            (axis, Freedom::Turn) => axis.dot(child.spin - parent.spin),
            (axis, Freedom::Slide) => {
                let at = link.meeting(&child.pose);
                axis.dot(child.velocity_at(at) - parent.velocity_at(at))
            }
        }
    }

    /// The impulse of motor and stop along a degree of freedom in the last step, on the child, N·m·s or N·s.
    ///
    /// # Panics
    /// If the joint has no such degree of freedom.
    pub fn impulse(&self, joint: JointId, dof: usize) -> f64 {
        self.link(joint, dof).dofs()[dof].impulse
    }

    fn link(&self, joint: JointId, dof: usize) -> &Link {
        let link = &self.links[joint.0];
        assert!(dof < link.degrees, "joint {} has {} degrees of freedom", joint.0, link.degrees);
        link
    }

    /// Every body, in the order of attachment.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyId> + use<> {
        (0..self.bodies.len()).map(BodyId)
    }

    /// Every joint, in the order of attachment.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = JointId> + use<> {
        (0..self.links.len()).map(JointId)
    }

    /// Centre of mass, m, world frame.
    pub fn position(&self, body: BodyId) -> DVec3 {
        self.bodies[body.0].pose.position
    }

    /// Body axes to world axes, unit length.
    pub fn orientation(&self, body: BodyId) -> DQuat {
        self.bodies[body.0].pose.orientation
    }

    /// The same as a matrix, whose columns are the body's axes.
    pub fn rotation(&self, body: BodyId) -> DMat3 {
        self.bodies[body.0].pose.rotation
    }

    /// Of the centre of mass, m/s, world frame.
    pub fn velocity(&self, body: BodyId) -> DVec3 {
        self.bodies[body.0].velocity
    }

    /// Angular velocity, rad/s, world frame.
    pub fn spin(&self, body: BodyId) -> DVec3 {
        self.bodies[body.0].spin
    }

    /// kg.
    pub fn mass(&self, body: BodyId) -> f64 {
        self.bodies[body.0].mass
    }

    /// Whether some contact point of a body is at most `tolerance` m above the ground (walker G-16).
    pub fn touches(&self, body: BodyId, tolerance: f64) -> bool {
        let Some(ground) = self.settings.ground else { return false };
        let body = &self.bodies[body.0];
        let normal = body.pose.rotation.transpose() * ground.normal;
        let height = ground.normal.dot(body.pose.position) - ground.offset - body.radius;
        self.points[body.points.0..body.points.1].iter().any(|p| height + normal.dot(p.local) <= tolerance)
    }

    /// Of all bodies, m, world frame.
    pub fn center_of_mass(&self) -> DVec3 {
        let (mass, moment) = self
            .bodies
            .iter()
            .fold((0.0, DVec3::ZERO), |(m, r), b| (m + b.mass, r + b.mass * b.pose.position));
        moment / mass
    }

    /// Of all bodies, kg·m/s, world frame.
    pub fn linear_momentum(&self) -> DVec3 {
        self.bodies.iter().fold(DVec3::ZERO, |p, b| p + b.mass * b.velocity)
    }

    /// Of all bodies about their centre of mass, kg·m²/s, world frame.
    pub fn angular_momentum(&self) -> DVec3 {
        let center = self.center_of_mass();
        self.bodies.iter().fold(DVec3::ZERO, |sum, b| {
            sum + b.angular_momentum + (b.pose.position - center).cross(b.mass * b.velocity)
        })
    }

    /// J.
    pub fn kinetic_energy(&self) -> f64 {
        self.bodies
            .iter()
            .map(|b| 0.5 * (b.mass * b.velocity.length_squared() + b.spin.dot(b.angular_momentum)))
            .sum()
    }

    /// Of gravity, J, zero at the origin. What is stored in the ground's springs is not in it.
    pub fn potential_energy(&self) -> f64 {
        self.bodies.iter().map(|b| -b.mass * self.settings.gravity.dot(b.pose.position)).sum()
    }

    /// The largest distance of two anchors off their joint's free axis, m (walker X-12, T-20).
    pub fn separation(&self) -> f64 {
        self.links
            .iter()
            .enumerate()
            .map(|(k, link)| link.separation(&self.bodies[link.parent].pose, &self.bodies[k + 1].pose))
            .fold(0.0, f64::max)
    }

    /// Rounds of the last step: how often its linear system was solved.
    pub fn rounds(&self) -> u32 {
        self.rounds
    }
}

impl Mass {
    fn velocity_at(&self, point: DVec3) -> DVec3 {
        self.velocity + self.spin.cross(point - self.pose.position)
    }
}

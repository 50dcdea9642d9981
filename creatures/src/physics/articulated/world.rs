//! The world: one tree of bodies in motion, and the step that moves it. What a step solves is in
//! [`super::rounds`]; here are its beginning and its end.

use super::contact::{Contact, Footing};
use super::joint::{Freedom, Link, Pace, Pose};
use super::model::{BodyId, JointId, ModelBuilder, Settings, Shape, StopRule};
use super::spatial::{Inertia, Six};
use super::staircase::Motor;
use crate::math;
use glam::{DMat3, DQuat, DVec3};

/// Why a step did not happen. The poses are those before it; the world is of no further use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StepFault {
    /// The step's length is not a positive finite number.
    #[error("the length of a step is positive and finite")]
    Duration,
    /// An inertia is not positive: the numbers have left the range in which they mean anything (flyer F-38).
    #[error("body {body}: its inertia is not positive")]
    Singular {
        /// The body's place in the order of attachment.
        body: usize,
    },
    /// A velocity or a position is NaN or infinite (walker X-11).
    #[error("body {body}: its motion is not finite")]
    NonFinite {
        /// The body's place in the order of attachment.
        body: usize,
    },
}

/// A body, its constants, its state and its share of the step's linear system.
#[derive(Debug, Clone)]
pub(super) struct Mass {
    mass: f64,
    /// Principal moments, kg·m².
    moments: DVec3,
    friction: f64,
    /// Half extents of the contact points about the centre of mass, m, and their own radius.
    half: DVec3,
    radius: f64,
    /// Its contact points among all: first, and one past the last.
    points: (usize, usize),

    pub(super) pose: Pose,
    velocity: DVec3,
    /// Angular velocity, rad/s.
    spin: DVec3,
    /// Angular momentum about its centre of mass: it, not the spin, is carried through a change of pose, so
    /// that what is free of torque keeps it to the last bit. `spin = I⁻¹ L` takes the place of an explicit
    /// gyroscopic torque (F-35), to which it is equal in first order, and bounds the spin by |L| over the
    /// least moment, where the explicit torque can grow without end.
    angular_momentum: DVec3,
    force: DVec3,
    torque: DVec3,

    /// World frame, about the centre of mass.
    rotational: DMat3,
    /// From the reference point to the centre of mass.
    arm: DVec3,
    /// Its own, at the reference point.
    pub(super) inertia: Inertia,
    /// What it would have at the step's end if it were free, at the reference point.
    pub(super) momentum: Six,
    /// With contacts and with everything that hangs on it.
    pub(super) carried: Inertia,
    /// The momentum that belongs to it.
    pub(super) impetus: Six,
    /// Solved, at the reference point.
    pub(super) twist: Six,
}

/// A point that can touch the ground, and the normal impulse of the last step in which it did.
#[derive(Debug, Clone, Copy)]
struct Point {
    /// In the body's axes, m.
    local: DVec3,
    pressure: f64,
}

/// One tree of bodies in motion.
#[derive(Debug, Clone)]
pub struct World {
    settings: Settings,
    stop_rule: StopRule,
    pub(super) fixture: bool,
    pub(super) bodies: Vec<Mass>,
    /// Link k hangs body k + 1 on a body of a lower index.
    pub(super) links: Vec<Link>,
    points: Vec<Point>,
    /// Those of this step; room for all points.
    pub(super) contacts: Vec<Contact>,
    rounds: u32,
}

impl World {
    /// Of a model that has been checked.
    pub(super) fn new(model: &ModelBuilder) -> World {
        let mut points = vec![];
        let bodies: Vec<Mass> = model
            .bodies
            .iter()
            .map(|body| {
                let first = points.len();
                let (half, radius) = match body.shape {
                    None => (DVec3::ZERO, 0.0),
                    Some(Shape::Cuboid { half }) => {
                        let corners = (0..8).map(|k| {
                            let side = |bit: u32| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
                            half * DVec3::new(side(0), side(1), side(2))
                        });
                        points.extend(corners.map(|local| Point { local, pressure: 0.0 }));
                        (half, 0.0)
                    }
                    Some(Shape::Capsule { radius, half_length }) => {
                        let half = DVec3::new(0.0, 0.0, half_length);
                        points.extend([-half, half].map(|local| Point { local, pressure: 0.0 }));
                        (half, radius)
                    }
                };
                let ground = model.settings.ground.map_or(0.0, |ground| ground.friction);
                Mass {
                    mass: body.mass,
                    moments: body.inertia,
                    friction: body.friction.min(ground),
                    half,
                    radius,
                    points: (first, points.len()),
                    pose: Pose::new(body.position, body.orientation.normalize()),
                    velocity: DVec3::ZERO,
                    spin: DVec3::ZERO,
                    angular_momentum: DVec3::ZERO,
                    force: DVec3::ZERO,
                    torque: DVec3::ZERO,
                    rotational: DMat3::ZERO,
                    arm: DVec3::ZERO,
                    inertia: Inertia::ZERO,
                    momentum: Six::ZERO,
                    carried: Inertia::ZERO,
                    impetus: Six::ZERO,
                    twist: Six::ZERO,
                }
            })
            .collect();
        let links = model
            .joints
            .iter()
            .enumerate()
            .map(|(k, (parent, joint))| {
                Link::new(*parent, joint, bodies[*parent].pose.orientation, bodies[k + 1].pose.orientation)
            })
            .collect();
        World {
            settings: model.settings,
            stop_rule: model.stop_rule,
            fixture: model.fixture,
            contacts: Vec::with_capacity(points.len()),
            bodies,
            links,
            points,
            rounds: 0,
        }
    }

    /// Moves the world by `dt` seconds. Pushes are used up, motors stay as they are.
    ///
    /// # Errors
    /// A fault of the numbers; the creature's misfortune, for its task to make an outcome of.
    pub fn step(&mut self, dt: f64) -> Result<(), StepFault> {
        if !(dt > 0.0 && dt < f64::INFINITY) {
            return Err(StepFault::Duration);
        }
        let footing = self.settings.ground.as_ref().map(|ground| Footing::new(ground, dt));
        self.gather(dt);
        let pace = Pace { dt, correction: self.settings.erp / dt, rule: self.stop_rule };
        let reference = self.bodies[0].pose.position;
        for (index, link) in self.links.iter_mut().enumerate() {
            link.prepare(&self.bodies[link.parent].pose, &self.bodies[index + 1].pose, reference, &pace);
        }
        if let Some(footing) = &footing {
            self.touch_down(footing, dt);
        }
        self.rounds =
            self.settle(footing.as_ref()).map_err(|fault| StepFault::Singular { body: fault.body })?;
        if let Some(body) = self.bodies.iter().position(|body| !body.twist.is_finite()) {
            return Err(StepFault::NonFinite { body });
        }
        for contact in &self.contacts {
            self.points[contact.point].pressure = contact.pressure;
        }
        self.advance(dt)
    }

    /// Inertias and free momenta at the reference point, the root's centre of mass: near the bodies, so that
    /// a creature far from the origin loses no digit.
    fn gather(&mut self, dt: f64) {
        let reference = self.bodies[0].pose.position;
        let gravity = self.settings.gravity;
        for body in &mut self.bodies {
            let rotation = body.pose.rotation;
            let scaled = DMat3::from_cols(
                rotation.x_axis * body.moments.x,
                rotation.y_axis * body.moments.y,
                rotation.z_axis * body.moments.z,
            );
            body.rotational = scaled * rotation.transpose();
            body.arm = body.pose.position - reference;
            body.inertia = Inertia::rigid(body.mass, body.rotational, body.arm);
            let linear = (body.velocity + gravity * dt) * body.mass + body.force * dt;
            let angular = body.angular_momentum + body.torque * dt;
            body.momentum = Six::new(linear, angular + body.arm.cross(linear));
            (body.force, body.torque) = (DVec3::ZERO, DVec3::ZERO);
        }
    }

    /// Finds the points that are in the ground, or would be after this step at the velocity they have.
    fn touch_down(&mut self, footing: &Footing, dt: f64) {
        self.contacts.clear();
        let Some(ground) = self.settings.ground else { return };
        let reference = self.bodies[0].pose.position;
        for (index, body) in self.bodies.iter().enumerate() {
            // Height and speed of a point are affine in its place; their least values over the box tell
            // most bodies that no point of theirs is near.
            let to_body = body.pose.rotation.transpose();
            let normal = to_body * footing.normal;
            let height = footing.normal.dot(body.pose.position) - ground.offset - body.radius;
            let speed = footing.normal.dot(body.velocity);
            let turn = to_body * footing.normal.cross(body.spin);
            let ahead = normal + turn * dt;
            let lowest = height - normal.abs().dot(body.half);
            let next_lowest = height + speed * dt - ahead.abs().dot(body.half);
            if lowest > 0.0 && next_lowest > 0.0 {
                continue;
            }
            let twist = Six::new(body.velocity - body.spin.cross(body.arm), body.spin);
            for (point, Point { local, pressure }) in
                (body.points.0..).zip(&mut self.points[body.points.0..body.points.1])
            {
                let gap = height + normal.dot(*local);
                let last = std::mem::take(pressure);
                if gap > 0.0 && gap + (speed + turn.dot(*local)) * dt > 0.0 {
                    continue;
                }
                let at = body.pose.position - reference + body.pose.rotation * *local
                    - footing.normal * body.radius;
                let contact = Contact::new(footing, index, point, body.friction, at, gap, &twist, last);
                self.contacts.push(contact);
            }
        }
    }

    /// Velocities from the solved twists, poses from the velocities.
    fn advance(&mut self, dt: f64) -> Result<(), StepFault> {
        let skip = usize::from(self.fixture);
        for (index, body) in self.bodies.iter_mut().enumerate().skip(skip) {
            body.spin = body.twist.angular();
            body.velocity = body.twist.linear() + body.spin.cross(body.arm);
            body.angular_momentum = body.rotational * body.spin;
            let position = body.pose.position + body.velocity * dt;
            let orientation = (turn(body.spin * dt) * body.pose.orientation).normalize();
            if !(position.is_finite() && orientation.is_finite()) {
                return Err(StepFault::NonFinite { body: index });
            }
            body.pose = Pose::new(position, orientation);
        }
        Ok(())
    }

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
    /// take them back in the next step, by impulses.
    pub fn set_velocity(&mut self, body: BodyId, velocity: DVec3, spin: DVec3) {
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
        link.coordinate(&self.bodies[link.parent].pose, &self.bodies[joint.0 + 1].pose, dof)
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

    /// How many bodies there are.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// How many joints there are.
    pub fn joint_count(&self) -> usize {
        self.links.len()
    }

    /// Centre of mass, m, world frame.
    pub fn position(&self, body: BodyId) -> DVec3 {
        self.bodies[body.0].pose.position
    }

    /// Body axes to world axes, unit length.
    pub fn orientation(&self, body: BodyId) -> DQuat {
        self.bodies[body.0].pose.orientation
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
    /// The impulse of the joint to its parent, at the reference point.
    pub(super) fn reaction(&self) -> Six {
        let mut wrench = self.carried.times(&self.twist);
        wrench.add_scaled(&self.impetus, -1.0);
        wrench
    }

    fn velocity_at(&self, point: DVec3) -> DVec3 {
        self.velocity + self.spin.cross(point - self.pose.position)
    }
}

/// The rotation by a vector: exp of half of it. Small ones, which is nearly all, by a series that is exact
/// to rounding, at a quarter of the cost.
fn turn(vector: DVec3) -> DQuat {
    let half = 0.5 * vector;
    let t = half.length_squared();
    if t > 0.04 {
        return math::from_rotation_vector(vector);
    }
    let sine = 1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0 * (1.0 - t / 110.0))));
    let cosine = 1.0 - t / 2.0 * (1.0 - t / 12.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0 * (1.0 - t / 90.0))));
    DQuat::from_xyzw(half.x * sine, half.y * sine, half.z * sine, cosine)
}

//! The world: one tree of bodies in motion, and the step that moves it. What a step solves is in
//! [`super::rounds`]; here are its beginning and its end.

use super::contact::{Contact, Footing, Site};
use super::joint::{Link, Pace, Pose};
use super::model::{ModelBuilder, Settings, Shape, StopRule};
use super::rounds::ROUNDS_MAX;
use super::spatial::{Inertia, Six};
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
    pub(super) mass: f64,
    /// Principal moments, kg·m².
    pub(super) moments: DVec3,
    pub(super) friction: f64,
    /// Half extents of the contact points about the centre of mass, m, and their own radius.
    pub(super) half: DVec3,
    pub(super) radius: f64,
    /// Its contact points among all: first, and one past the last.
    pub(super) points: (usize, usize),

    pub(super) pose: Pose,
    pub(super) velocity: DVec3,
    /// Angular velocity, rad/s.
    pub(super) spin: DVec3,
    /// Angular momentum about its centre of mass: it, not the spin, is carried through a change of pose, so
    /// that what is free of torque keeps it to the last bit. `spin = I⁻¹ L` takes the place of an explicit
    /// gyroscopic torque (F-35), to which it is equal in first order, and bounds the spin by |L| over the
    /// least moment, where the explicit torque can grow without end.
    pub(super) angular_momentum: DVec3,
    pub(super) force: DVec3,
    pub(super) torque: DVec3,

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
pub(super) struct Point {
    /// In the body's axes, m.
    pub(super) local: DVec3,
    pressure: f64,
}

/// One tree of bodies in motion.
#[derive(Debug, Clone)]
pub struct World {
    pub(super) settings: Settings,
    pub(super) stop_rule: StopRule,
    pub(super) fixture: bool,
    pub(super) bodies: Vec<Mass>,
    /// Link k hangs body k + 1 on a body of a lower index.
    pub(super) links: Vec<Link>,
    pub(super) points: Vec<Point>,
    /// Those of this step; room for all points.
    pub(super) contacts: Vec<Contact>,
    pub(super) rounds: u32,
    pub(super) rounds_max: u32,
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
        let mut links: Vec<Link> = model
            .joints
            .iter()
            .enumerate()
            .map(|(k, (parent, joint))| {
                Link::new(*parent, joint, bodies[*parent].pose.orientation, bodies[k + 1].pose.orientation)
            })
            .collect();
        for (k, link) in links.iter_mut().enumerate() {
            link.follow(&bodies[link.parent].pose, &bodies[k + 1].pose);
        }
        World {
            settings: model.settings,
            stop_rule: model.stop_rule,
            fixture: model.fixture,
            contacts: Vec::with_capacity(points.len()),
            bodies,
            links,
            points,
            rounds: 0,
            rounds_max: ROUNDS_MAX,
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
                let site = Site { body: index, point, coulomb: body.friction, at, gap };
                self.contacts.push(Contact::new(footing, &site, &twist, last));
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
        for (k, link) in self.links.iter_mut().enumerate() {
            link.follow(&self.bodies[link.parent].pose, &self.bodies[k + 1].pose);
        }
        Ok(())
    }
}

impl Mass {
    /// The impulse of the joint to its parent, at the reference point.
    pub(super) fn reaction(&self) -> Six {
        let mut wrench = self.carried.times(&self.twist);
        wrench.add_scaled(&self.impetus, -1.0);
        wrench
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

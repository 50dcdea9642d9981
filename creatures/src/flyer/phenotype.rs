//! A flyer's body at work: its skeleton on the articulated engine, read by its sensors, driven by its
//! effectors, held by the air (F-16..F-18, F-25, F-31..F-37, F-42). It knows no brain and no fitness.

use super::aerodynamics::{Air, Hull, Sail};
use super::genotype::BODY;
use super::sensors::{gyro, joint_angle, joint_stop};
use super::skeleton::{Bone, Hold, motor_torque};
use super::task::FlyerTask;
use crate::physics::articulated::{
    Body, BodyId, Joint, JointId, JointKind, ModelBuilder, Motor, Settings, StepFault, StopRule, World,
};
use glam::{DQuat, DVec3};

/// A developed body.
#[derive(Debug, Clone)]
pub struct Phenotype {
    world: World,
    /// In the order of the bones.
    limbs: Vec<Limb>,
    /// That of the wing-root, then those of the wing segments in the order of the bones.
    joints: Vec<JointId>,
    /// One a degree of freedom: the wing-root's x, y and z, then the hinges.
    actuators: Vec<Actuator>,
    /// Coordinates of the degrees of freedom when last sensed, rad.
    angles: Vec<f64>,
    /// The share of a joint's range in which its stop is felt.
    stop_fraction: f64,
    /// Of all limbs, kg.
    mass: f64,
    dt: f64,
}

/// One cylinder and what the air does to it.
#[derive(Debug, Clone, Copy)]
struct Limb {
    body: BodyId,
    mass: f64,
    half_length: f64,
    radius: f64,
    hull: Hull,
    sail: Option<Sail>,
}

/// A motor between its stops.
#[derive(Debug, Clone, Copy)]
struct Actuator {
    joint: JointId,
    dof: usize,
    /// Its stops are at ± this, rad.
    stop: f64,
    /// The rate of an effector's 1, rad/s.
    rate: f64,
    /// N·m.
    torque: f64,
}

/// A creature after a step, in one pass over its limbs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Of the centre of mass, m/s (F-51).
    pub velocity: DVec3,
    /// Of the fastest limb, m/s (F-39).
    pub speed: f64,
    /// Whether a limb touches the ground (F-50).
    pub landed: bool,
}

impl Phenotype {
    /// The body at rest in its start pose.
    pub fn develop(bones: &[Bone], task: &FlyerTask) -> Phenotype {
        let mut model = ModelBuilder::new(Settings {
            gravity: DVec3::new(0.0, -task.gravity, 0.0),
            erp: task.erp,
            ground: None, // the ground only ends the flight (F-41)
        });
        model.stop_rule(StopRule::Reached);
        let air = Air::scaled(task.alpha);
        let mut limbs: Vec<Limb> = Vec::with_capacity(bones.len());
        let (mut joints, mut actuators) = (Vec::new(), Vec::new());
        for bone in bones {
            let solid = Body {
                orientation: DQuat::from_mat3(&bone.axes).normalize(),
                shape: None,
                ..Body::capsule(bone.radius, bone.length, task.density, bone.centre)
            };
            let body = match bone.hold {
                None => model.root(solid),
                Some(hold) => {
                    let stop = if hold.hinge.is_some() { task.hinge_limit } else { task.ball_limit };
                    let (body, joint) = model
                        .attach(limbs[hold.parent].body, solid, joint(bone, &hold, stop))
                        .expect("a skeleton's bones meet where they hang");
                    let (parent, base) = (&limbs[hold.parent], &bones[hold.parent]);
                    let torque =
                        motor_torque(task.motor_k, (parent.mass, solid.mass), (base.length, bone.length));
                    let (degrees, rate) =
                        if hold.hinge.is_some() { (1, task.hinge_rate) } else { (3, task.ball_rate) };
                    actuators.extend((0..degrees).map(|dof| Actuator { joint, dof, stop, rate, torque }));
                    joints.push(joint);
                    body
                }
            };
            let hull = Hull::new(air, bone.radius, bone.length);
            limbs.push(Limb {
                body,
                mass: solid.mass,
                half_length: 0.5 * bone.length,
                radius: bone.radius,
                hull: if body.index() == BODY { hull.with_tail(task.tail_weight) } else { hull },
                sail: bone.film.map(|film| Sail::new(air, &film, solid.mass, task.dt, task.drag_limiter)),
            });
        }
        Phenotype {
            world: model.build().expect("legal genes and a checked task make sound bodies"),
            mass: limbs.iter().map(|limb| limb.mass).sum(),
            angles: vec![0.0; actuators.len()],
            stop_fraction: task.stop_fraction,
            dt: task.dt,
            limbs,
            joints,
            actuators,
        }
    }

    /// Reads every sensor in the order of F-25: of the wing-root three joint angles, three joint stops, roll
    /// and pitch; then of each wing segment its angle and its stop.
    pub fn sense(&mut self, readings: &mut [f64]) {
        let (ball, hinges) = self.joints.split_first().expect("every flyer has a wing-root");
        let (angles, flaps) = self.angles.split_at_mut(3);
        angles.copy_from_slice(&self.world.coordinates(*ball));
        for (flap, &hinge) in flaps.iter_mut().zip(hinges) {
            [*flap, ..] = self.world.coordinates(hinge);
        }
        let (root, wings) = readings.split_at_mut(8);
        for (dof, (angle, actuator)) in angles.iter().zip(&self.actuators).enumerate() {
            root[dof] = joint_angle(*angle, actuator.stop);
            root[3 + dof] = joint_stop(*angle, actuator.stop, self.stop_fraction);
        }
        (root[6], root[7]) = gyro(&self.world.rotation(self.limbs[BODY + 1].body));
        for (pair, (flap, actuator)) in wings.chunks_exact_mut(2).zip(flaps.iter().zip(&self.actuators[3..]))
        {
            pair[0] = joint_angle(*flap, actuator.stop);
            pair[1] = joint_stop(*flap, actuator.stop, self.stop_fraction);
        }
    }

    /// Sets every motor from effectors in [−1, 1] and the angles last sensed (F-31, F-33).
    pub fn drive(&mut self, effectors: &[f64]) {
        for ((actuator, effector), angle) in self.actuators.iter().zip(effectors).zip(&self.angles) {
            let rate = actuator.wanted(effector * actuator.rate, *angle, self.dt);
            self.world.drive(actuator.joint, actuator.dof, Motor { rate, effort: actuator.torque });
        }
    }

    /// One physics step: the air acts, then the engine moves (F-34, F-35).
    ///
    /// # Errors
    /// The world has left the numbers.
    pub fn step(&mut self) -> Result<(), StepFault> {
        self.blow();
        self.advance()
    }

    /// Lets the air act on every limb during the next [`Phenotype::advance`]: the first half of a step.
    pub fn blow(&mut self) {
        for limb in &self.limbs {
            let axes = self.world.rotation(limb.body);
            let to_limb = axes.transpose();
            let velocity = to_limb * self.world.velocity(limb.body);
            let spin = to_limb * self.world.spin(limb.body);
            let mut wrench = limb.hull.drag(velocity, spin);
            if let Some(sail) = &limb.sail {
                let film = sail.drag(velocity, spin);
                wrench.force += film.force;
                wrench.torque += film.torque;
            }
            self.world.push(limb.body, axes * wrench.force, axes * wrench.torque);
        }
    }

    /// Moves the body: the second half of a step.
    ///
    /// # Errors
    /// As [`Phenotype::step`].
    pub fn advance(&mut self) -> Result<(), StepFault> {
        self.world.step(self.dt)
    }

    /// What its evaluation looks at after a step.
    pub fn survey(&self) -> Survey {
        let (mut momentum, mut square, mut landed) = (DVec3::ZERO, 0.0, false);
        for limb in &self.limbs {
            let velocity = self.world.velocity(limb.body);
            momentum += velocity * limb.mass;
            let speed = velocity.length_squared();
            if speed > square {
                square = speed;
            }
            let dip = (self.world.rotation(limb.body).z_axis.y * limb.half_length).abs();
            landed |= self.world.position(limb.body).y - dip - limb.radius <= 0.0;
        }
        Survey { velocity: momentum / self.mass, speed: square.sqrt(), landed }
    }

    /// The angle of the first left hinge when last sensed, rad (F-70).
    pub fn flap(&self) -> f64 {
        self.angles[3]
    }

    /// kg.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The world that it lives in.
    pub fn world(&self) -> &World {
        &self.world
    }
}

impl Actuator {
    /// The rate to ask for so as to stop short of a stop, or not to go farther beyond it (F-33).
    fn wanted(&self, rate: f64, angle: f64, dt: f64) -> f64 {
        let stop = self.stop;
        let (least, most) = if angle > stop {
            (f64::NEG_INFINITY, 0.0)
        } else if angle < -stop {
            (0.0, f64::INFINITY)
        } else {
            ((-stop - angle) / dt, (stop - angle) / dt)
        };
        if rate < least {
            least
        } else if rate > most {
            most
        } else {
            rate
        }
    }
}

fn joint(bone: &Bone, hold: &Hold, stop: f64) -> Joint {
    let stops = Some((-stop, stop));
    let (kind, stops) = match hold.hinge {
        Some(axis) => (JointKind::Hinge { axis }, [stops, None, None]),
        None => (JointKind::Ball, [stops; 3]),
    };
    Joint {
        kind,
        parent_anchor: DVec3::new(0.0, 0.0, hold.at),
        child_anchor: DVec3::new(0.0, 0.0, -0.5 * bone.length),
        stops,
    }
}

#[cfg(test)]
mod tests;

//! A walker's body in its world: developed from its plan, read by its sensors, driven by speed commands
//! (G-16..G-21, G-47..G-53). It knows no genotype and no fitness.

use super::body::{BodyKind, Drive, Link, Part, Surface};
use super::sensors::{Heading, Sensor, stroke};
use crate::physics::articulated::{
    Body, BodyId, Ground, Joint, JointId, JointKind, ModelBuilder, Motor, Settings, StepFault, World,
};
use crate::{SpecError, math::wrap_angle};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Gravity, m/s² (G-47).
const GRAVITY: DVec3 = DVec3::new(0.0, 0.0, -9.81);
/// How high above the ground the lowest point starts, m (G-51).
const CLEARANCE: f64 = 0.001;
/// A part touches while a contact point is no farther from the ground than this, m (G-16).
const TOUCH: f64 = 0.001;
/// The share of joint drift that one step takes back.
const ERP: f64 = 0.2;

/// The `[task.world]` table: what the creature meets (G-48, G-50).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Footing {
    /// Coulomb coefficient of the ground; the lesser of ground and part holds.
    pub friction_ground: f64,
    /// Of the limbs' rubber.
    pub friction_limb: f64,
    /// Of the torso's smooth shell.
    pub friction_torso: f64,
    /// Of one contact point, N/m.
    pub stiffness: f64,
    /// Of one contact point, N·s/m.
    pub damping: f64,
    /// Below this speed friction grows in proportion to it, m/s.
    pub slip_speed: f64,
}

impl Default for Footing {
    fn default() -> Self {
        Footing {
            friction_ground: 0.9,
            friction_limb: 0.9,
            friction_torso: 0.3,
            stiffness: 600.0,
            damping: 10.0,
            slip_speed: 0.005,
        }
    }
}

impl Footing {
    /// Checks every number.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        let ranges = [
            ("friction_ground", self.friction_ground, 0.0, 10.0),
            ("friction_limb", self.friction_limb, 0.0, 10.0),
            ("friction_torso", self.friction_torso, 0.0, 10.0),
            ("stiffness", self.stiffness, 1.0, 1e6),
            ("damping", self.damping, 0.0, 1e6),
            ("slip_speed", self.slip_speed, 1e-4, 0.01),
        ];
        match ranges.into_iter().find(|(_, value, low, high)| !(*low..=*high).contains(value)) {
            Some((key, value, low, high)) => {
                Err(SpecError::new(key, format!("{value} is not within [{low}, {high}]")))
            }
            None => Ok(()),
        }
    }

    fn friction(&self, surface: Surface) -> f64 {
        match surface {
            Surface::Shell => self.friction_torso,
            Surface::Rubber => self.friction_limb,
        }
    }
}

/// A developed body.
#[derive(Debug, Clone)]
pub struct Phenotype {
    world: World,
    torso: BodyId,
    /// In order of attachment: torso, first limb outwards, second limb outwards.
    parts: Vec<BodyId>,
    joints: Vec<Actuator>,
    touching: Vec<BodyId>,
    heading: Heading,
}

#[derive(Debug, Clone, Copy)]
struct Actuator {
    joint: JointId,
    drive: Drive,
    stops: Option<(f64, f64)>,
}

/// A sensor's value is NaN or infinite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a sensor is not finite")]
pub struct NonFinite;

impl Phenotype {
    /// The body at rest, axis-aligned, its lowest point just above the ground (G-51).
    pub fn develop(body: BodyKind, footing: &Footing) -> Phenotype {
        let plan = body.plan();
        let mut model = ModelBuilder::new(Settings {
            gravity: GRAVITY,
            erp: ERP,
            ground: Some(Ground {
                normal: DVec3::Z,
                offset: 0.0,
                friction: footing.friction_ground,
                stiffness: footing.stiffness,
                damping: footing.damping,
                slip_speed: footing.slip_speed,
            }),
        });
        let solid = |part: &Part, position| Body {
            friction: footing.friction(part.surface),
            ..Body::cuboid(part.size, part.density, position)
        };
        let mut centre = DVec3::new(0.0, 0.0, CLEARANCE - lowest(body));
        let torso = model.root(solid(&plan.torso, centre));
        let mut phenotype = (vec![torso], Vec::new(), Vec::from_iter(plan.torso.touch.then_some(torso)));
        let (parts, joints, touching) = &mut phenotype;
        let start = centre;
        for side in [-1.0, 1.0] {
            let mut parent = torso;
            centre = start;
            for link in plan.limb {
                centre += offset(link, side);
                let joint = Joint {
                    kind: kind(link.drive),
                    parent_anchor: mirrored(link.parent_anchor, side),
                    child_anchor: mirrored(link.child_anchor, side),
                    stops: [link.stops, None, None],
                };
                let (part, joint) = model
                    .attach(parent, solid(&link.part, centre), joint)
                    .expect("the plans' joints are sound; a test develops each");
                parts.push(part);
                joints.push(Actuator { joint, drive: link.drive, stops: link.stops });
                touching.extend(link.part.touch.then_some(part));
                parent = part;
            }
        }
        let world = model.build().expect("the plans' bodies are sound; a test develops each");
        let (parts, joints, touching) = phenotype;
        Phenotype { world, torso, parts, joints, touching, heading: Heading::default() }
    }

    /// Reads every sensor in the order of G-17, each as its share of its range (eq. 4), into a slice of
    /// the body's number of inputs.
    ///
    /// # Errors
    /// A value that is not finite, which no clamp may hide.
    pub fn sense(&mut self, readings: &mut [f64]) -> Result<(), NonFinite> {
        let (position, orientation) = (self.world.position(self.torso), self.world.orientation(self.torso));
        let direction = self.heading.read(orientation * DVec3::NEG_Y);
        let (velocity, spin) = (self.world.velocity(self.torso), self.world.spin(self.torso));
        let world = &self.world;
        let joints = self
            .joints
            .iter()
            .flat_map(|actuator| (0..actuator.drive.degrees()).map(|degree| actuator.read(world, degree)));
        let motion = velocity.to_array().map(|component| (Sensor::LinearVelocity, component));
        let turning = spin.to_array().map(|component| (Sensor::AngularVelocity, component));
        let pose = [(Sensor::Height, position.z), (Sensor::Direction, direction)];
        let touches = self
            .touching
            .iter()
            .map(|&part| (Sensor::Touch, f64::from(u8::from(world.touches(part, TOUCH)))));
        let values = joints.chain(motion).chain(turning).chain(pose).chain(touches);
        for (reading, (sensor, value)) in readings.iter_mut().zip(values) {
            if !value.is_finite() {
                return Err(NonFinite);
            }
            *reading = sensor.norm(value);
        }
        Ok(())
    }

    /// Sets the speed of every degree of freedom from commands in [−1, 1], held until the next call (G-18).
    pub fn drive(&mut self, commands: &[f64]) {
        let mut commands = commands.iter();
        for actuator in &self.joints {
            let (speed, effort) = (actuator.drive.speed(), actuator.drive.effort());
            for (degree, command) in (0..actuator.drive.degrees()).zip(&mut commands) {
                self.world.drive(actuator.joint, degree, Motor { rate: command * speed, effort });
            }
        }
    }

    /// One physics step of `dt` seconds.
    ///
    /// # Errors
    /// The world has left the numbers.
    pub fn step(&mut self, dt: f64) -> Result<(), StepFault> {
        self.world.step(dt)
    }

    /// The world that it lives in.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The part whose motion is measured.
    pub fn torso(&self) -> BodyId {
        self.torso
    }

    /// Throws the whole body, m/s, to see how far it may go.
    #[cfg(test)]
    pub(super) fn throw(&mut self, velocity: DVec3) {
        for &part in &self.parts {
            self.world.set_velocity(part, velocity, DVec3::ZERO);
        }
    }

    /// Every part: torso, first limb outwards, second limb outwards.
    pub fn parts(&self) -> &[BodyId] {
        &self.parts
    }
}

impl Actuator {
    /// The joint's sensor and its raw value (G-16).
    fn read(&self, world: &World, degree: usize) -> (Sensor, f64) {
        let coordinate = world.coordinate(self.joint, degree);
        match self.drive {
            Drive::Hinge => (Sensor::Hinge, wrap_angle(coordinate)),
            Drive::Slider => {
                let stops = self.stops.expect("the plans give every slider its stroke");
                (Sensor::Slider, stroke(coordinate, stops))
            }
            Drive::Ball => (Sensor::Ball, coordinate),
        }
    }
}

fn kind(drive: Drive) -> JointKind {
    match drive {
        Drive::Hinge => JointKind::Hinge { axis: DVec3::X },
        Drive::Slider => JointKind::Slider { axis: DVec3::NEG_Z },
        Drive::Ball => JointKind::Ball,
    }
}

fn mirrored(anchor: DVec3, side: f64) -> DVec3 {
    DVec3::new(side * anchor.x, anchor.y, anchor.z)
}

/// From the parent's centre to the part's in the start pose.
fn offset(link: &Link, side: f64) -> DVec3 {
    mirrored(link.parent_anchor - link.child_anchor, side)
}

/// The height of the body's lowest point in the start pose, m, from the torso's centre.
fn lowest(body: BodyKind) -> f64 {
    let plan = body.plan();
    let mut lowest = -0.5 * plan.torso.size.z;
    let mut centre = 0.0;
    for link in plan.limb {
        centre += offset(link, 1.0).z;
        lowest = lowest.min(centre - 0.5 * link.part.size.z);
    }
    lowest
}

#[cfg(test)]
mod tests;

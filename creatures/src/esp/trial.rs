//! One trial: a settled creature, its brain and a target, step by step until the end (E-33, E-49, E-80). It
//! records and scores nothing; what a body is stands behind [`Living`].

use super::brain::{Circuit, TICK};
use super::fitness::setup::LIGHT_STRENGTH;
use super::fitness::{Moment, Record, Setup, Target};
use super::syllabus::Sensor;
use crate::Observer;
use crate::math::{atan2, cos, sin, wrap_angle};
use crate::record::{Frame, Part, Pose, Scene, Shape};
use glam::{DQuat, DVec3};

/// The most lights of a trial.
const LIGHTS_MAX: usize = super::fitness::setup::STACK;

/// A settled creature in its world, as a trial sees it. World frame: z up, the ground at z = 0.
pub trait Living {
    /// Why it cannot go on (E-23).
    type Fault;

    /// Greatest force of each muscle, N, in the order of the body's instances (E-24).
    fn strengths(&self) -> &[f64];

    /// m·g, N.
    fn weight(&self) -> f64;

    /// Where it is.
    fn state(&self) -> State;

    /// Puts the discs of a target on the ground, one upon the other: sensors, which push nothing (E-78).
    fn place_discs(&mut self, centre: DVec3, count: usize);

    /// What the muscles' lengths feel like, in the order of the body's instances (E-27).
    fn feel(&self, lengths: &mut [f64]);

    /// What the photoreceptors see, in the order of the body's instances (E-29).
    fn see(&self, lights: &[Light], signals: &mut [f64]);

    /// One step of [`TICK`] with the muscles' activations, in the order of the body's instances.
    ///
    /// # Errors
    /// What went wrong in the physics; the creature is not stepped again.
    fn step(&mut self, activations: &[f64]) -> Result<(), Self::Fault>;

    /// What there is to see besides the lights, its own parts first.
    fn scene(&self) -> Scene;

    /// Where that is.
    fn frame(&self) -> Frame;
}

/// A creature's state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Centre of mass, m.
    pub centre: DVec3,
    /// Of the centre of mass, m/s.
    pub velocity: DVec3,
    /// Of the forward axis about z, rad, from x towards y (E-21).
    pub heading: f64,
    /// Vertical part of the root's up axis, −1 to 1.
    pub up: f64,
    /// Height of the highest point, m.
    pub top: f64,
    /// Sum of the normal forces of the ground, N.
    pub ground_force: f64,
    /// Whether any part touches a disc.
    pub touches: bool,
}

/// A light.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Light {
    /// m, world frame.
    pub position: DVec3,
    /// S of E-29.
    pub strength: f64,
}

/// The lights of a moment; those that there are stand in front.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lights {
    all: [Light; LIGHTS_MAX],
    count: usize,
}

impl Lights {
    /// One light.
    pub(super) fn one(light: Light) -> Lights {
        let mut lights = Lights { count: 1, ..Lights::default() };
        lights.all[0] = light;
        lights
    }

    fn as_slice(&self) -> &[Light] {
        &self.all[..self.count]
    }
}

/// Where a trial started: what positions, headings and lights are measured from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Origin {
    /// On the ground below the settled centre of mass.
    point: DVec3,
    heading: f64,
    rotation: DQuat,
}

/// Who watches the trials, and which one begins next.
pub struct Show<'a> {
    /// Is shown every trial.
    pub observer: &'a mut dyn Observer,
    /// Of the next trial, from 0.
    pub number: u32,
}

impl Show<'_> {
    pub(super) fn begin<L: Living>(&mut self, creature: &L, lights: &[Light]) {
        self.observer.trial(self.number, &|| {
            let mut scene = creature.scene();
            scene.parts.extend(lights.iter().enumerate().map(|(index, light)| Part {
                name: format!("light {index}"),
                creature: None,
                shapes: vec![Shape::Light { strength: light.strength }],
            }));
            scene
        });
        self.number += 1;
        self.observer.frame(0.0, &|| frame(creature, lights));
    }

    pub(super) fn go_on<L: Living>(&mut self, creature: &L, seconds: f64, lights: &dyn Fn() -> Lights) {
        self.observer.frame(seconds, &|| frame(creature, lights().as_slice()));
    }
}

fn frame<L: Living>(creature: &L, lights: &[Light]) -> Frame {
    let mut frame = creature.frame();
    frame.poses.extend(lights.iter().map(|light| Pose::at(light.position)));
    frame
}

/// Lives one trial to its end and records it; `record` is emptied first. `show` is for who wants to see it.
///
/// The circuit is a fresh one. At each step the brain reads the state and the lights of that moment, the muscles
/// act, the world moves on.
///
/// # Errors
/// The fault that ended it; the record is as far as it got.
pub fn live<L: Living>(
    creature: &mut L,
    circuit: &mut Circuit,
    setup: &Setup,
    record: &mut Record,
    show: &mut Show,
) -> Result<(), L::Fault> {
    let origin = Origin::of(&creature.state());
    if let Some(target) = setup.target {
        creature.place_discs(origin.to_world(target.centre()), target.discs());
    }
    let strength: f64 = creature.strengths().iter().sum();
    record.moments.clear();
    record.moments.reserve(setup.steps() + 1);
    record.ended = false;
    record.has_muscles = strength > 0.0;
    record.moments.push(origin.moment(creature, setup.target, 0.0, 0.0));
    show.begin(creature, origin.lights(setup.target, 0.0).as_slice());
    for step in 0..setup.steps() {
        let lights = origin.lights(setup.target, step as f64 * TICK);
        sense(creature, lights.as_slice(), circuit);
        let activations = circuit.tick();
        let effort: f64 =
            creature.strengths().iter().zip(activations).map(|(most, share)| most * share).sum();
        creature.step(activations)?;
        let effort = if strength > 0.0 { effort / strength } else { 0.0 };
        let before = record.last().yaw;
        record.moments.push(origin.moment(creature, setup.target, effort, before));
        let seconds = (step + 1) as f64 * TICK;
        show.go_on(creature, seconds, &|| origin.lights(setup.target, seconds));
        if setup.end.is_met(&record.moments[1..]) {
            record.ended = true;
            break;
        }
    }
    Ok(())
}

/// Fills in what a creature feels and sees, for the next tick.
pub(super) fn sense<L: Living>(creature: &L, lights: &[Light], circuit: &mut Circuit) {
    creature.feel(circuit.lengths_mut());
    creature.see(lights, circuit.photos_mut());
    let state = creature.state();
    for (sensor, signal) in Sensor::ALL.into_iter().zip(circuit.sensors_mut()) {
        *signal = match sensor {
            Sensor::Tilt => 0.5 * (1.0 + state.up),
        };
    }
}

impl Origin {
    pub(super) fn of(state: &State) -> Origin {
        let half = 0.5 * state.heading;
        Origin {
            point: state.centre.with_z(0.0),
            heading: state.heading,
            rotation: DQuat::from_xyzw(0.0, 0.0, sin(half), cos(half)),
        }
    }

    pub(super) fn to_world(self, position: DVec3) -> DVec3 {
        self.point + self.rotation * position
    }

    pub(super) fn to_start(self, position: DVec3) -> DVec3 {
        self.rotation.inverse() * (position - self.point)
    }

    /// The lights of a target after so many seconds.
    fn lights(&self, target: Option<Target>, seconds: f64) -> Lights {
        let mut lights = Lights::default();
        if let Some(target) = target {
            lights.count = target.lights();
            for (index, light) in lights.all.iter_mut().enumerate().take(lights.count) {
                let position = self.to_world(target.light(index, seconds));
                *light = Light { position, strength: LIGHT_STRENGTH };
            }
        }
        lights
    }

    /// What is recorded of a state. `yaw` is that of the moment before, from which a turn is unwrapped.
    fn moment<L: Living>(&self, creature: &L, target: Option<Target>, effort: f64, yaw: f64) -> Moment {
        let state = creature.state();
        let to_target = target.map(|target| (self.to_world(target.centre()) - state.centre).with_z(0.0));
        let bearing = |way: DVec3| wrap_angle(atan2(way.y, way.x) - state.heading);
        Moment {
            position: self.to_start(state.centre),
            speed: state.velocity.length(),
            yaw: yaw + wrap_angle(state.heading - self.heading - yaw),
            up: state.up,
            top: state.top,
            ground_force: state.ground_force / creature.weight(),
            light_distance: to_target.map_or(0.0, DVec3::length),
            light_angle: to_target.map_or(0.0, bearing),
            effort,
            touched: state.touches,
        }
    }
}

#[cfg(test)]
pub(super) mod tests;

//! One fish in water: a body that is stepped by commands, or by bare muscle actuations (A-9..A-33). What it
//! wants, and what else is in the water, is told from outside.

use super::body::{Body, MUSCLES, NODES};
use super::controller_set::{ControllerSet, Maps};
use super::fins::{self, STROKE_MAX};
use super::hydrodynamics::Water;
use super::lattice::Motion;
use super::mechanics::{Fault, Mechanics};
use super::motor::{Actuation, Command, Gait, Motor};
use super::posture::Posture;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// λ, the length of a muscle at full contraction by its length at rest.
const CONTRACTION: f64 = 0.5;
/// A node faster than this, at size 1, has left the model.
const SPEED_MAX: f64 = 100.0;

/// A fish.
#[derive(Debug, Clone)]
pub struct Swimmer {
    /// Fishes of one size may share it.
    pub body: Arc<Body>,
    /// Where its nodes are.
    pub motion: Motion,
    /// What its motor controllers remember.
    pub motor: Motor,
    /// What it swims by in place of the hand-made controllers.
    learned: Option<Maps>,
    mechanics: Mechanics,
    /// u at the end of the last step, each in [0, 1].
    actuation: Actuation,
    /// (springs), l(t).
    rest_lengths: Vec<f64>,
    /// (nodes), of fins and of what the caller adds.
    forces: Vec<DVec3>,
}

impl Swimmer {
    /// At rest, in its rest shape about a place, heading to the left of y by an angle, rad.
    pub fn new(body: Arc<Body>, place: DVec3, heading: f64) -> Swimmer {
        Swimmer::linearised(body, place, heading, 1)
    }

    /// The same, with a step linearised more than once.
    pub fn linearised(body: Arc<Body>, place: DVec3, heading: f64, newton: u32) -> Swimmer {
        let turn = crate::math::from_rotation_vector(DVec3::Z * heading);
        let turn = if heading == 0.0 { DMat3::IDENTITY } else { DMat3::from_quat(turn) };
        let positions = body.rest.iter().map(|&node| place + turn * node).collect();
        Swimmer {
            motion: Motion::at_rest(positions),
            motor: Motor::default(),
            learned: None,
            actuation: [0.0; MUSCLES],
            mechanics: Mechanics::new(&body.lattice, newton, SPEED_MAX * body.size),
            rest_lengths: body.lattice.springs.iter().map(|spring| spring.rest_length).collect(),
            forces: vec![DVec3::ZERO; NODES],
            body,
        }
    }

    /// The same fish with a learned, legal set in place of its hand-made controllers; commands stay what they are
    ///
    #[must_use]
    pub fn taught(self, set: &ControllerSet) -> Swimmer {
        Swimmer { learned: Some(Maps::new(set)), ..self }
    }

    /// One step as a command asks (A-22..A-33).
    ///
    /// `forces` (nodes) are those of the world: contact, suction; empty for none.
    ///
    /// # Errors
    /// What has gone out of bounds; the fish is then of no use.
    pub fn step(&mut self, command: &Command, water: &impl Water, forces: &[DVec3]) -> Result<(), Fault> {
        let swim = self.motor.obey(command, self.posture().roll());
        let actuation = match &mut self.learned {
            None => self.motor.beat(&Gait::swim(swim)),
            Some(maps) => self.motor.follow(maps, swim),
        };
        let stroke = command.stroke.clamp(-STROKE_MAX, STROKE_MAX);
        fins::push(&self.body, &self.motion, self.motor.fins, stroke, water, &mut self.forces);
        self.contract(&actuation, water, forces)
    }

    /// One step with given muscle actuations; fins stay where they are and stroke no water.
    ///
    /// # Errors
    /// As [`Swimmer::step`].
    pub fn practise(&mut self, actuation: &Actuation, water: &impl Water) -> Result<(), Fault> {
        fins::push(&self.body, &self.motion, self.motor.fins, 0.0, water, &mut self.forces);
        self.contract(actuation, water, &[])
    }

    /// Contracts the muscles and moves by a step under what forces have gathered.
    fn contract(&mut self, actuation: &Actuation, water: &impl Water, forces: &[DVec3]) -> Result<(), Fault> {
        for (sum, force) in self.forces.iter_mut().zip(forces) {
            *sum += *force;
        }
        self.actuation = actuation.map(|u| u.clamp(0.0, 1.0));
        for (u, spring) in self.actuation.into_iter().zip(self.body.muscles) {
            // l(t) = l₀ (1 − u (1 − λ)); what is no number stays one and ends the step.
            let idle = self.body.lattice.springs[spring].rest_length;
            self.rest_lengths[spring] = idle * (1.0 - u * (1.0 - CONTRACTION));
        }
        let moved = self.mechanics.step(
            &self.body.lattice,
            &mut self.motion,
            &self.rest_lengths,
            &self.forces,
            water,
        );
        self.forces.fill(DVec3::ZERO);
        moved
    }

    /// How far its muscles were contracted at the end of the last step, u₁…u₁₂.
    pub fn actuation(&self) -> &Actuation {
        &self.actuation
    }

    /// Its derived points and directions.
    pub fn posture(&self) -> Posture<'_> {
        Posture::new(&self.motion.positions)
    }

    /// c.
    pub fn center_of_mass(&self) -> DVec3 {
        self.body.center_of_mass(&self.motion.positions)
    }

    /// The velocity of c, length by time.
    pub fn velocity(&self) -> DVec3 {
        self.body.center_of_mass(&self.motion.velocities)
    }
}

#[cfg(test)]
mod tests;

//! What holds in the world of ESP creatures (E-22, E-25, E-29). The numbers that the paper does not give; each
//! may be set in the task.

use super::brain::TICK;
use crate::SpecError;
use crate::physics::contact::Settings;
use serde::{Deserialize, Serialize};

/// The `physics` table of a task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Physics {
    /// Steps of the engine in a step of the brain; muscles pull anew in each (E-22).
    pub substeps: u32,
    /// Rounds of the solver in each of them.
    pub rounds: u32,
    /// Sweeps over all joints and contacts in a round: with one, a body that lies on its own folded limbs creeps
    /// away by half a metre in ten seconds (E-23).
    pub sweeps: u32,
    /// m/s².
    pub gravity: f64,
    /// Of everything on everything.
    pub friction: f64,
    /// Of everything on everything.
    pub restitution: f64,
    /// Of what is round on the ground, as a share of its radius: without it who is kicked once rolls on for ever.
    pub rolling_resistance: f64,
    /// 1/s.
    pub linear_damping: f64,
    /// 1/s.
    pub angular_damping: f64,
    /// β of a muscle, s (E-25).
    pub muscle_damping: f64,
    /// r0, the distance at which a light is half as bright, m (E-29).
    pub light_range: f64,
}

impl Default for Physics {
    fn default() -> Self {
        Physics {
            substeps: 8,
            rounds: 1,
            sweeps: 4,
            gravity: 9.81,
            friction: 0.8,
            restitution: 0.1,
            rolling_resistance: 0.05,
            linear_damping: 0.02,
            angular_damping: 0.2,
            muscle_damping: 0.02,
            light_range: 5.0,
        }
    }
}

impl Physics {
    /// Checks every number.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn checked(self) -> Result<Physics, SpecError> {
        let refuse = |key: &str, problem: String| Err(SpecError::new(key, problem));
        if !(4..=64).contains(&self.substeps) {
            return refuse("substeps", format!("{} is not within 4 to 64", self.substeps));
        }
        for (key, value) in [("rounds", self.rounds), ("sweeps", self.sweeps)] {
            if !(1..=64).contains(&value) {
                return refuse(key, format!("{value} is not within 1 to 64"));
            }
        }
        let positive = [("gravity", self.gravity, 1e3), ("light_range", self.light_range, 1e3)];
        for (key, value, most) in positive {
            if !(value > 0.0 && value <= most) {
                return refuse(key, format!("{value} is not within (0, {most}]"));
            }
        }
        let ranges = [
            ("friction", self.friction, 10.0),
            ("restitution", self.restitution, 1.0),
            ("rolling_resistance", self.rolling_resistance, 1.0),
            ("linear_damping", self.linear_damping, 100.0),
            ("angular_damping", self.angular_damping, 100.0),
            ("muscle_damping", self.muscle_damping, 1.0),
        ];
        for (key, value, most) in ranges {
            if !(0.0..=most).contains(&value) {
                return refuse(key, format!("{value} is not within [0, {most}]"));
            }
        }
        Ok(self)
    }

    /// For the engine.
    pub fn settings(&self) -> Settings {
        Settings {
            step: TICK / f64::from(self.substeps),
            rounds: self.rounds as usize,
            sweeps: self.sweeps as usize,
            gravity: self.gravity,
            friction: self.friction,
            restitution: self.restitution,
            rolling_resistance: self.rolling_resistance,
            linear_damping: self.linear_damping,
            angular_damping: self.angular_damping,
            density: super::body::shape::DENSITY,
        }
    }
}

//! What fishes do: the eight routines (A-68..A-84). Each gives a motor command for one step and remembers what it
//! needs for the next; none decides whether it is called.
//!
//! [`avoid`] for what is in the way, [`feed`], [`wander`] for wandering and leaving, [`escape`], [`school`],
//! [`courtship`].

pub mod avoid;
pub mod courtship;
pub mod escape;
pub mod feed;
pub mod school;
pub mod wander;

pub use courtship::{Courtship, Stage};
pub use feed::Bite;
pub use wander::Wander;

use super::chase::steer;
use super::fins::{FinAngles, NEUTRAL};
use super::{Chase, Command, Posture};
use crate::math::wrap_angle;
use crate::random::Stream;
use std::f64::consts::FRAC_PI_4;

/// σ of a fish that looks for something.
pub const SEARCH: f64 = 0.8;

/// What the routines of one fish remember from step to step.
#[derive(Debug, Clone)]
pub struct Routines {
    /// Of whatever is chased.
    pub chase: Chase,
    /// Of the mouth.
    pub bite: Bite,
    /// Of where it wanders.
    pub wander: Wander,
    /// Of how far it is with whom.
    pub courtship: Courtship,
}

impl Routines {
    /// At birth, with draws for where to wander.
    pub fn new(draws: Stream) -> Routines {
        Routines {
            chase: Chase::default(),
            bite: Bite::default(),
            wander: Wander::new(draws),
            courtship: Courtship::default(),
        }
    }
}

/// Swims in a direction, by the closed form of a turn and the fins' answer to an error of pitch.
/// Angles in rad, `swim` is σ.
fn head(posture: &Posture<'_>, heading: f64, pitch: f64, swim: f64) -> Command {
    let error = wrap_angle(heading - posture.heading());
    Command { swim, turn: steer(error), fins: slant(2.0 * (pitch - posture.pitch())), ..Command::default() }
}

/// γ = π/2 + clip(answer, ±π/4).
fn slant(answer: f64) -> FinAngles {
    FinAngles::both(NEUTRAL + answer.clamp(-FRAC_PI_4, FRAC_PI_4))
}

#[cfg(test)]
mod tests;

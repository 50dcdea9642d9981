//! How a trial starts, what stands around and what ends it. Angles are counter-clockwise from the creature's
//! forward axis, distances from its centre of mass, both as they are at the trial's start (E-80).

use super::record::{Moment, impact};
use crate::esp::brain::TICK;
use crate::math::{cos, floor, sin};
use glam::DVec3;
use std::f64::consts::TAU;

/// The longest trial, s.
pub const SECONDS_MAX: f64 = 600.0;
/// Strength of every light of a trial (E-31): three of them do not saturate a receptor.
pub const LIGHT_STRENGTH: f64 = 0.3;
/// Height of a light that stands on no disc, m (E-31).
pub const LIGHT_HEIGHT: f64 = 0.3;
/// Radius of a target disc, m (E-78).
pub const DISC_RADIUS: f64 = 0.25;
/// Height of a target disc, m (E-78).
pub const DISC_HEIGHT: f64 = 0.1;
/// Discs of a stack, each with its light (E-78).
pub const STACK: usize = 3;
/// Turns of a stack, 1/s (E-78).
const STACK_RATE: f64 = 1.0;

/// One trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Longest duration, s.
    pub seconds: f64,
    /// The pose before it settles.
    pub start: Start,
    /// What there is besides the ground.
    pub target: Option<Target>,
    /// What ends it early.
    pub end: End,
}

/// A pose before a creature settles.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// As expressed.
    #[default]
    Rest,
    /// Rolled by half a turn about the forward axis (E-58).
    UpsideDown,
}

/// Something with lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Degrees, left positive.
    pub heading: f64,
    /// m, from the creature's centre of mass, horizontally.
    pub distance: f64,
    /// Its form.
    pub form: Form,
}

/// The forms of targets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A light.
    Light,
    /// A disc on the ground with a light at its centre: vulnerable (E-78).
    Disc,
    /// Three discs, stacked and turning, with a light on each rim: dangerous (E-78).
    Stack,
}

/// What ends a trial before its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// Nothing.
    Never,
    /// The target is closer than this, m.
    Within(f64),
    /// The ground is hit by so many body weights, averaged over three steps.
    Impact(f64),
    /// A disc is touched.
    Touch,
}

impl Setup {
    /// Physics steps of the whole trial.
    pub fn steps(&self) -> usize {
        steps(self.seconds)
    }
}

impl Target {
    /// A target of a form.
    pub fn new(form: Form, heading: f64, distance: f64) -> Target {
        Target { heading, distance, form }
    }

    /// Its centre on the ground, start frame, m.
    pub fn centre(&self) -> DVec3 {
        let angle = self.heading.to_radians();
        self.distance * DVec3::new(cos(angle), sin(angle), 0.0)
    }

    /// How many lights it has.
    pub fn lights(&self) -> usize {
        match self.form {
            Form::Light | Form::Disc => 1,
            Form::Stack => STACK,
        }
    }

    /// How many discs it has, one upon the other.
    pub fn discs(&self) -> usize {
        match self.form {
            Form::Light => 0,
            Form::Disc => 1,
            Form::Stack => STACK,
        }
    }

    /// Where one of its lights is after so many seconds, start frame, m.
    pub fn light(&self, index: usize, seconds: f64) -> DVec3 {
        let centre = self.centre();
        match self.form {
            Form::Light => centre.with_z(LIGHT_HEIGHT),
            Form::Disc => centre.with_z(0.5 * DISC_HEIGHT),
            Form::Stack => {
                let turns = index as f64 / STACK as f64 + STACK_RATE * seconds;
                let angle = TAU * (turns - floor(turns));
                let rim = DISC_RADIUS * DVec3::new(cos(angle), sin(angle), 0.0);
                centre + rim.with_z((index as f64 + 0.5) * DISC_HEIGHT)
            }
        }
    }
}

impl End {
    /// Whether the last of the moments so far ends the trial.
    pub fn is_met(&self, moments: &[Moment]) -> bool {
        let Some(last) = moments.last() else { return false };
        match *self {
            End::Never => false,
            End::Within(distance) => last.light_distance < distance,
            End::Impact(weights) => impact(moments) >= weights,
            End::Touch => last.touched,
        }
    }
}

/// Physics steps of so many seconds.
pub fn steps(seconds: f64) -> usize {
    floor(seconds / TICK + 0.5) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// E-78, T-4 (h)
    #[test]
    fn a_stack_has_its_lights_on_three_rims_and_turns_once_a_second() {
        let stack = Target::new(Form::Stack, 0.0, 3.2);
        let expected = [(3.45, 0.0, 0.05), (3.075, 0.216506, 0.15), (3.075, -0.216506, 0.25)];
        for (index, (x, y, z)) in expected.into_iter().enumerate() {
            let light = stack.light(index, 0.0);
            assert!((light - DVec3::new(x, y, z)).length() < 1e-6, "{light}");
            assert!((stack.light(index, 3.0) - light).length() < 1e-12);
        }
        let quarter = stack.light(0, 0.25);
        assert!((quarter - DVec3::new(3.2, 0.25, 0.05)).length() < 1e-12, "{quarter}");
    }

    #[test]
    fn headings_are_to_the_left() {
        let light = Target::new(Form::Light, 90.0, 5.0).light(0, 7.0);
        assert!((light - DVec3::new(0.0, 5.0, 0.3)).length() < 1e-12, "{light}");
    }

    #[test]
    fn steps_are_counted_to_the_nearest() {
        assert_eq!([10.0, 0.1, 1.0 / 60.0, 2.0].map(steps), [600, 6, 1, 120]);
    }
}

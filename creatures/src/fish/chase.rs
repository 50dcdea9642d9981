//! Chasing a target: the routine that others share. It sees a place to be at and nothing that may
//! be in the way.

use super::fins::{FinAngles, NEUTRAL};
use super::motor::{Command, Turn};
use super::posture::{self, Posture};
use super::turn::STRENGTH;
use crate::math::{asin, wrap_angle};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_4, FRAC_PI_6};

/// The turning circle at size 1: its centre is so far to the side, and this is what cannot be reached by
/// turning.
const CIRCLE_CENTER: f64 = 25.0;
const CIRCLE_RADIUS: f64 = 24.5;
/// How far beyond the circle a target has to be before the fish turns again.
const CIRCLE_MARGIN: f64 = 1.25;
/// Headings further off than the first make the circle matter, nearer than the second end the swim out of it.
const OFF_COURSE: f64 = 25.0 * std::f64::consts::PI / 180.0;
const ON_COURSE: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// How steeply fins answer an error of pitch.
const PITCH_GAIN: f64 = 2.0;

/// What a chase remembers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Chase {
    /// Swims straight on, since the target lies inside the turning circle.
    pub straight: bool,
}

impl Chase {
    /// What to do in this step to get the mouth to a target. `swim` is σ, `size` the fish's S.
    pub fn toward(&mut self, target: DVec3, swim: f64, posture: &Posture<'_>, size: f64) -> Command {
        let error = bearing(target, posture);
        let gap = circle_gap(target, posture, error, size);
        self.straight = if self.straight {
            gap < CIRCLE_MARGIN * CIRCLE_RADIUS * size && error.abs() >= ON_COURSE
        } else {
            gap < CIRCLE_RADIUS * size && error.abs() > OFF_COURSE
        };
        let turn = if self.straight { 0.0 } else { error };
        Command { swim, turn: steer(turn), fins: tilt(target, posture), ..Command::default() }
    }

    /// The same without regard to what lies inside the turning circle, as in courtship.
    pub fn headlong(target: DVec3, swim: f64, posture: &Posture<'_>) -> Command {
        let turn = steer(bearing(target, posture));
        Command { swim, turn, fins: tilt(target, posture), ..Command::default() }
    }
}

/// ψ_err, rad in [−π, π): how far to the left a target lies of where the fish heads, seen from the mouth. 0
/// for one that is straight above, below or in the mouth (AF-9).
pub fn bearing(target: DVec3, posture: &Posture<'_>) -> f64 {
    let way = target - posture.mouth();
    if way.truncate().length_squared() == 0.0 {
        return 0.0;
    }
    wrap_angle(posture::heading(way) - posture.heading())
}

/// Where to turn for an error of heading, rad, left positive: e* = 0.75 clip(ψ_err / 30°, −1, 1).
pub fn steer(error: f64) -> Turn {
    Turn::Bias(STRENGTH * (error / FRAC_PI_6).clamp(-1.0, 1.0))
}

/// γ = π/2 + clip(2 (elevation − pitch), ±π/4), the elevation seen from the mouth.
pub fn tilt(target: DVec3, posture: &Posture<'_>) -> FinAngles {
    let way = (target - posture.mouth()).try_normalize();
    let elevation = way.map_or(posture.pitch(), |way| asin(way.z.clamp(-1.0, 1.0)));
    let answer = PITCH_GAIN * (elevation - posture.pitch());
    FinAngles::both(NEUTRAL + answer.clamp(-FRAC_PI_4, FRAC_PI_4))
}

/// How far a target is, in the plane, from the centre of the turning circle on its side.
fn circle_gap(target: DVec3, posture: &Posture<'_>, error: f64, size: f64) -> f64 {
    let forward = posture.forward.truncate().normalize_or_zero();
    let left = forward.perp();
    let side = if error < 0.0 { -left } else { left };
    let center = posture.center().truncate() + side * (CIRCLE_CENTER * size);
    (target.truncate() - center).length()
}

#[cfg(test)]
mod tests;

//! Not running into things.

use super::{head, slant};
use crate::fish::chase::steer;
use crate::fish::fins::{ASCENT, BRAKE, DESCENT, FinAngles};
use crate::fish::perception::{Figure, Percept, Preferences, Senses, Surface};
use crate::fish::{Command, Posture};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

/// Within this bearing a thing is on neither side, rad.
const DEAD_AHEAD: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Nearer than this by L a fish that cannot turn brakes.
const BRAKING: f64 = 0.25;
/// Normals steeper than this are those of beds and ceilings.
const LEVEL: f64 = 0.7;
/// σ while passing another fish.
const PASSING: f64 = 0.8;
/// Slower sideways motion than this is none, length by time.
const SIDEWAYS: f64 = 0.05;

/// Away from a surface.
///
/// Choice: below a ceiling or above a bed a turn helps nothing; the fish levels off and makes for open water. A
/// surface that merely slants is turned from, with pitch along its normal.
pub fn surface(senses: &Senses<'_>, posture: &Posture<'_>, surface: &Surface, avoid: Preferences) -> Command {
    let (me, length) = (senses.me, senses.me.length());
    let climb = FRAC_PI_6 * surface.normal.z;
    if surface.normal.z.abs() > LEVEL {
        return head(posture, posture.heading(), climb, 1.0);
    }
    let place = me.locate(surface.point);
    let angle = sharpness(surface.distance, length * senses.habits.sensitivity);
    match away(me, place.bearing, avoid) {
        Some(side) => {
            let fins = slant(2.0 * (climb - posture.pitch()));
            Command { swim: 1.0, turn: steer(side * angle), fins, ..Command::default() }
        }
        None => {
            let (fins, swim) = match (avoid.no_up, avoid.no_down) {
                _ if surface.distance < BRAKING * length => (BRAKE, 0.0),
                (false, _) => (ASCENT, 1.0),
                (true, false) => (DESCENT, 1.0),
                (true, true) => (BRAKE, 0.0),
            };
            // Braking alone would leave it facing the surface for ever: it turns on the spot as well as it can.
            let side = if place.bearing > 0.0 { -1.0 } else { 1.0 };
            let fins = FinAngles::both(fins);
            Command { swim, turn: steer(side * angle), fins, ..Command::default() }
        }
    }
}

/// Round another fish, astern of it if it crosses.
pub fn fish(senses: &Senses<'_>, other: &Percept<'_>, avoid: Preferences) -> Command {
    let me = senses.me;
    let sideways = (other.figure.velocity - me.velocity).dot(me.right);
    let side = if sideways.abs() > SIDEWAYS {
        Some(if sideways > 0.0 { 1.0 } else { -1.0 }) // it goes to the right, we to the left
    } else {
        away(me, other.place.bearing, avoid)
    };
    let angle = sharpness(other.place.distance, me.length() * senses.habits.sensitivity);
    let turn = steer(side.unwrap_or(0.0) * angle);
    Command { swim: PASSING, turn, fins: slant(-2.0 * other.place.elevation), ..Command::default() }
}

/// How far to turn, rad: 30° for what is far, 90° for what is near.
fn sharpness(distance: f64, antenna: f64) -> f64 {
    (FRAC_PI_2 * (1.0 - distance / antenna)).clamp(FRAC_PI_6, FRAC_PI_2)
}

/// 1 to the left, −1 to the right: the side away from a bearing, or, of what is dead ahead, one that is not
/// forbidden, else the left for fishes of even number. None if both are forbidden.
fn away(me: &Figure, bearing: f64, avoid: Preferences) -> Option<f64> {
    let preferred = if bearing.abs() >= DEAD_AHEAD {
        if bearing > 0.0 { -1.0 } else { 1.0 }
    } else if me.id.0.is_multiple_of(2) {
        1.0
    } else {
        -1.0
    };
    let forbidden = |side: f64| if side > 0.0 { avoid.no_left } else { avoid.no_right };
    [preferred, -preferred].into_iter().find(|&side| !forbidden(side))
}

//! Getting away from a predator.

use super::slant;
use crate::fish::Command;
use crate::fish::chase::steer;
use crate::fish::perception::{Percept, Senses};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

/// A predator beyond this bearing is astern, rad.
const ASTERN: f64 = 2.0 * PI / 3.0;

/// Flat out: straight from what is astern, else away from its side, and to the other height.
pub fn from(senses: &Senses<'_>, predator: &Percept<'_>) -> Command {
    let place = predator.place;
    let bearing = place.bearing.abs();
    let turn = if bearing > ASTERN {
        0.0
    } else {
        let left = if place.bearing == 0.0 { senses.me.id.0.is_multiple_of(2) } else { place.bearing < 0.0 };
        let angle = (FRAC_PI_2 - 0.5 * bearing).max(FRAC_PI_6);
        if left { angle } else { -angle }
    };
    Command { swim: 1.0, turn: steer(turn), fins: slant(-2.0 * place.elevation), ..Command::default() }
}

//! Swimming about, and out of water that does not suit.

use super::{SEARCH, head};
use crate::fish::perception::Senses;
use crate::fish::posture::heading;
use crate::fish::{Command, Posture};
use crate::math::{asin, wrap_angle};
use crate::random::Stream;
use glam::DVec3;

/// Time between turns.
const LEG: [f64; 2] = [8.0, 20.0];
/// Turns while wandering and while leaving, degrees either way.
const TURN_DEGREES: f64 = 60.0;
const LEAVING_TURN_DEGREES: f64 = 20.0;
/// Pitch, degrees either way.
const PITCH_DEGREES: f64 = 15.0;
/// Over what distance a gradient is felt.
const PROBE: f64 = 1.0;

/// Where a fish is wandering to.
#[derive(Debug, Clone)]
pub struct Wander {
    /// When it turns next; at once if it has done something else meanwhile.
    until: f64,
    heading: f64,
    pitch: f64,
    /// Whether it is on its way out.
    leaving: bool,
    draws: Stream,
}

impl Wander {
    /// Not wandering yet.
    pub fn new(draws: Stream) -> Wander {
        Wander { until: f64::NEG_INFINITY, heading: 0.0, pitch: 0.0, leaving: false, draws }
    }

    /// Starts anew: the fish has done something else.
    pub fn forget(&mut self) {
        (self.until, self.leaving) = (f64::NEG_INFINITY, false);
    }

    /// Nowhere in particular, at σ.
    pub fn about(&mut self, posture: &Posture<'_>, time: f64, swim: f64) -> Command {
        if time >= self.until {
            self.turn(posture, time, TURN_DEGREES);
        }
        head(posture, self.heading, self.pitch, swim)
    }

    /// Out of here: first along the gradient of what is worse, light or warmth, then with small turns.
    pub fn leave(&mut self, senses: &Senses<'_>, posture: &Posture<'_>, time: f64) -> Command {
        if !self.leaving {
            self.turn(posture, time, 0.0);
            self.leaving = true;
            if let Some(way) = better(senses) {
                let pitch_max = PITCH_DEGREES.to_radians();
                self.pitch = asin(way.z.clamp(-1.0, 1.0)).clamp(-pitch_max, pitch_max);
                if way.truncate().length() > 1e-6 {
                    self.heading = heading(way);
                }
            }
        } else if time >= self.until {
            self.turn(posture, time, LEAVING_TURN_DEGREES);
        }
        head(posture, self.heading, self.pitch, SEARCH)
    }

    fn turn(&mut self, posture: &Posture<'_>, time: f64, most_degrees: f64) {
        let mut draw = |most_degrees: f64| self.draws.between(-most_degrees, most_degrees).to_radians();
        self.heading = wrap_angle(posture.heading() + draw(most_degrees));
        self.pitch = draw(PITCH_DEGREES);
        self.until = time + self.draws.between(LEG[0], LEG[1]);
    }
}

/// The direction, of length 1, in which the worse of light and warmth gets better; none where it is level or
/// nothing is wrong.
fn better(senses: &Senses<'_>) -> Option<DVec3> {
    let (at, scene, habits) = (senses.me.center, senses.scene, senses.habits);
    // How far a value is out of a range, by the range's bounds at its largest; signed toward what is missing.
    let want = |value: f64, least: f64, most: f64, scale: f64| {
        (if value < least {
            least - value
        } else if value > most {
            most - value
        } else {
            0.0
        }) / scale
    };
    let light = |at: DVec3| scene.climate.light(at, scene.tank.surface());
    let warmth = |at: DVec3| scene.climate.temperature(at);
    let by_light = want(senses.brightness(), habits.brightness_min, habits.brightness_max, 1.0);
    let by_warmth = want(warmth(at), habits.temperature_min, habits.temperature_max, 40.0);
    let gradient = |field: &dyn Fn(DVec3) -> f64| {
        let along = |axis: DVec3| field(at + axis * PROBE) - field(at - axis * PROBE);
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    };
    let way = if by_light.abs() >= by_warmth.abs() {
        gradient(&light) * by_light
    } else {
        gradient(&warmth) * by_warmth
    };
    way.try_normalize()
}

//! The dance itself: what each of a pair does in a stage.

use super::{Counts, Courtship, Stage};
use crate::fish::behaviour::head;
use crate::fish::fins::{ASCENT, BRAKE, FinAngles, NEUTRAL};
use crate::fish::habits::Sex;
use crate::fish::perception::{Figure, Senses};
use crate::fish::{Chase, Command, Posture};
use crate::math::{asin, sin};
use glam::DVec3;
use std::f64::consts::TAU;

/// A point counts as touched within this by L, and again once he was beyond the other.
pub(super) const TOUCH: f64 = 0.15;
pub(super) const REARM: f64 = 0.3;
/// How much higher she rises, by L.
pub(super) const RISE: f64 = 1.5;
/// Sine of the pitch that counts as level.
pub(super) const LEVEL: f64 = 0.1;
/// How far from walls and obstacles she stops, by L.
pub(super) const ROOM: f64 = 2.0;
/// The loop's point: how far before her mouth, how far above it, its amplitude, by L; its period.
const LOOP_AHEAD: f64 = 1.0;
const LOOP_ABOVE: f64 = 0.25;
const LOOP_AMPLITUDE: f64 = 0.5;
const LOOP_PERIOD: f64 = 12.0;
/// Within this by L of the loop's centre he stops.
const LOOP_STOP: f64 = 0.4;
/// Steps that he waits there for a touch, one period of the point; he then swims off and comes anew (Choice: who
/// has stopped beside the point's way would wait for ever).
const LOOP_PATIENCE: u32 = 218;
/// Her bobbing: stroke and period.
const BOB: f64 = 0.3;
const BOB_PERIOD: f64 = 4.0;
/// Stroke of backing off.
const BACKING: f64 = 0.4;
/// How far below her abdomen he aims, by L (Choice): he climbs so slowly that he has to come level, and a mouth
/// this far below it touches it from below.
const AIM_BELOW: f64 = 0.1;
/// The least elevation of her abdomen from his mouth, degrees.
const NUZZLE_ELEVATION_DEGREES: f64 = 15.0;
/// σ on the last way to her abdomen. Choice: slower than this a fish hardly climbs, and he passes below her.
const NUZZLE_SWIM: f64 = 1.0;

/// One of a pair at its dance.
pub(super) struct Dancer<'a> {
    pub(super) senses: &'a Senses<'a>,
    /// How the partner looked when last seen.
    pub(super) partner: &'a Figure,
    pub(super) chase: &'a mut Chase,
    pub(super) posture: &'a Posture<'a>,
}

impl Dancer<'_> {
    /// What to do in this step.
    pub(super) fn command(&mut self, courtship: &mut Courtship) -> Command {
        let male = self.senses.me.sex == Sex::Male;
        match courtship.stage {
            Stage::Search | Stage::Follow => self.chase(self.partner.center),
            Stage::Display | Stage::Loop if male => self.looping(&mut courtship.counts),
            Stage::Display | Stage::Loop => {
                let stroke = BOB * sin(TAU * self.senses.scene.time / BOB_PERIOD);
                Command { fins: FinAngles::both(NEUTRAL), stroke, ..Command::default() }
            }
            Stage::Circle => {
                if !male {
                    courtship.counts.turn(self.senses.scene.time, self.posture.heading());
                }
                Chase::headlong(self.partner.tail, 1.0, self.posture)
            }
            Stage::Ascend if male => self.chase(self.partner.abdomen),
            // She levels out, and goes on for room, before she stops.
            Stage::Ascend if courtship.risen(self.senses) => {
                head(self.posture, self.posture.heading(), 0.0, 1.0)
            }
            Stage::Ascend => Command { swim: 1.0, fins: FinAngles::both(ASCENT), ..Command::default() },
            Stage::Nuzzle if male => self.nuzzling(&mut courtship.counts),
            Stage::Nuzzle | Stage::Done => hover(),
        }
    }

    fn chase(&mut self, target: DVec3) -> Command {
        self.chase.toward(target, 1.0, self.posture, self.senses.me.size)
    }

    /// The male's loop before her mouth.
    fn looping(&mut self, counts: &mut Counts) -> Command {
        let (partner, length) = (self.partner, self.senses.me.length());
        let center =
            partner.mouth + partner.forward * (LOOP_AHEAD * length) + DVec3::Z * (LOOP_ABOVE * length);
        let sweep = LOOP_AMPLITUDE * length * sin(TAU * self.senses.scene.time / LOOP_PERIOD);
        let point = center + DVec3::Z * sweep;
        counts.touch((point - self.posture.mouth()).length() / length);
        let distance = (center - self.posture.mouth()).length();
        if distance > length {
            counts.waited = 0;
            return self.chase(center);
        }
        if distance < LOOP_STOP * length && counts.waited < LOOP_PATIENCE {
            counts.waited += 1;
            return hover();
        }
        self.chase(point)
    }

    /// The male's touches of her abdomen from below.
    fn nuzzling(&mut self, counts: &mut Counts) -> Command {
        let length = self.senses.me.length();
        let way = self.partner.abdomen - self.posture.mouth();
        let distance = way.length();
        if counts.backing > 0 {
            // The last step is repeated until she is well ahead of him (Choice).
            let is_last = counts.backing == 1;
            let is_ahead = way.dot(self.posture.forward) > REARM * length;
            counts.backing -= u32::from(!is_last || is_ahead);
            return Command { stroke: BACKING, ..hover() };
        }
        let elevation = asin((way.z / distance.max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0));
        if distance < TOUCH * length && elevation >= NUZZLE_ELEVATION_DEGREES.to_radians() {
            counts.nuzzle();
            return Command { stroke: BACKING, ..hover() };
        }
        self.chase.toward(
            self.partner.abdomen - DVec3::Z * (AIM_BELOW * length),
            NUZZLE_SWIM,
            self.posture,
            self.senses.me.size,
        )
    }
}

/// Idle, fins held against the way, both alike: the reflex against rolling counts on way ahead, and rolls a
/// fish over that goes astern (Choice).
fn hover() -> Command {
    Command { fins: FinAngles::both(BRAKE), balance: false, ..Command::default() }
}

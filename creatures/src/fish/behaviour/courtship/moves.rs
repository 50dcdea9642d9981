//! The dance itself: what each of a pair does in a stage.

use super::{Courtship, Stage};
use crate::fish::behaviour::head;
use crate::fish::chase::bearing;
use crate::fish::fins::{ASCENT, BRAKE, FinAngles, NEUTRAL};
use crate::fish::habits::Sex;
use crate::fish::perception::{Figure, Senses};
use crate::fish::{Chase, Command, Posture};
use crate::math::{asin, sin};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A point counts as touched within this by L, and again once he was beyond the other.
pub(super) const TOUCH: f64 = 0.15;
pub(super) const REARM: f64 = 0.3;
/// How much higher she rises, by L.
pub(super) const RISE: f64 = 1.5;
/// Sine of the pitch that counts as level.
pub(super) const LEVEL: f64 = 0.1;
/// The loop's point: how far before her mouth, how far above it, its amplitude, by L; its period.
const LOOP_AHEAD: f64 = 1.0;
const LOOP_ABOVE: f64 = 0.25;
const LOOP_AMPLITUDE: f64 = 0.5;
const LOOP_PERIOD: f64 = 12.0;
/// Within this by L of the loop's centre he stops.
const LOOP_STOP: f64 = 0.4;
/// Her bobbing: stroke and period.
const BOB: f64 = 0.3;
const BOB_PERIOD: f64 = 4.0;
/// Stroke of backing off.
const BACKING: f64 = 0.4;
/// Where he starts to nuzzle from: behind and below her abdomen, and how near he has to come, by L.
const STAGING_BEHIND: f64 = 1.5;
const STAGING_BELOW: f64 = 0.8;
const STAGING_NEAR: f64 = 0.4;
/// Farther than this from her abdomen by L he starts anew.
const NUZZLE_FAR: f64 = 2.5;
/// The least elevation of her abdomen from his mouth, degrees.
const NUZZLE_ELEVATION_DEGREES: f64 = 15.0;
/// σ on the last way to her abdomen. Choice: slower than this a fish hardly climbs, and he passes below her.
const NUZZLE_SWIM: f64 = 1.0;

/// What to do with a partner that looked like this when last seen.
pub(super) fn command(
    courtship: &mut Courtship,
    senses: &Senses<'_>,
    partner: &Figure,
    chase: &mut Chase,
    posture: &Posture<'_>,
) -> Command {
    let (me, time) = (senses.me, senses.scene.time);
    let male = me.sex == Sex::Male;
    match courtship.stage {
        Stage::Search | Stage::Follow => chase.toward(partner.center, 1.0, posture, me.size),
        Stage::Display | Stage::Loop if male => looping(courtship, senses, partner, chase, posture),
        Stage::Display | Stage::Loop => {
            let stroke = BOB * sin(TAU * time / BOB_PERIOD);
            Command { fins: FinAngles::both(NEUTRAL), stroke, ..Command::default() }
        }
        Stage::Circle => {
            if !male {
                courtship.counts.turn(time, posture.heading());
            }
            Chase::headlong(partner.tail, 1.0, posture)
        }
        Stage::Ascend if male => chase.toward(partner.abdomen, 1.0, posture, me.size),
        // A hovering fish cannot change its pitch: she levels out before she stops (Choice).
        Stage::Ascend if courtship.risen(senses) => head(posture, posture.heading(), 0.0, 1.0),
        Stage::Ascend => Command { swim: 1.0, fins: FinAngles::both(ASCENT), ..Command::default() },
        Stage::Nuzzle if male => nuzzling(courtship, me, partner, chase, posture),
        Stage::Nuzzle | Stage::Done => hover(),
    }
}

/// Idle, fins held against the way.
fn hover() -> Command {
    Command { fins: FinAngles::both(BRAKE), ..Command::default() }
}

/// The male's loop before her mouth.
fn looping(
    courtship: &mut Courtship,
    senses: &Senses<'_>,
    partner: &Figure,
    chase: &mut Chase,
    posture: &Posture<'_>,
) -> Command {
    let (me, time) = (senses.me, senses.scene.time);
    let length = me.length();
    let center = partner.mouth + partner.forward * (LOOP_AHEAD * length) + DVec3::Z * (LOOP_ABOVE * length);
    let point = center + DVec3::Z * (LOOP_AMPLITUDE * length * sin(TAU * time / LOOP_PERIOD));
    courtship.counts.touch((point - posture.mouth()).length() / length);
    let distance = (center - posture.mouth()).length();
    if distance < LOOP_STOP * length {
        hover()
    } else if distance > length {
        chase.toward(center, 1.0, posture, me.size)
    } else {
        chase.toward(point, 1.0, posture, me.size)
    }
}

/// The male's touches of her abdomen from below and behind.
fn nuzzling(
    courtship: &mut Courtship,
    me: &Figure,
    partner: &Figure,
    chase: &mut Chase,
    posture: &Posture<'_>,
) -> Command {
    let length = me.length();
    let counts = &mut courtship.counts;
    if counts.backing > 0 {
        counts.backing -= 1;
        return Command { stroke: BACKING, ..hover() };
    }
    let way = partner.abdomen - posture.mouth();
    let distance = way.length();
    // Behind in the plane: she may hover with her head up, and he cannot climb as steeply as that (Choice).
    let level = DVec3::new(partner.forward.x, partner.forward.y, 0.0).normalize_or_zero();
    let staging = partner.abdomen - level * (STAGING_BEHIND * length) - DVec3::Z * (STAGING_BELOW * length);
    if counts.rising {
        let elevation = asin((way.z / distance.max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0));
        if distance < TOUCH * length && elevation >= NUZZLE_ELEVATION_DEGREES.to_radians() {
            counts.nuzzle();
            return Command { stroke: BACKING, ..hover() };
        }
        let missed = way.z < 0.0
            || distance > NUZZLE_FAR * length
            || bearing(partner.abdomen, posture).abs() > FRAC_PI_2;
        counts.rising = !missed;
    } else if (staging - posture.mouth()).length() < STAGING_NEAR * length {
        counts.rising = true;
    }
    if counts.rising {
        Chase::headlong(partner.abdomen, NUZZLE_SWIM, posture)
    } else {
        chase.toward(staging, 1.0, posture, me.size)
    }
}

use super::*;
use crate::fish::hydrodynamics::Still;
use crate::fish::mechanics::TIME_STEP;
use crate::fish::{Body, Swimmer};
use crate::random::stream;
use std::f64::consts::PI;
use std::sync::Arc;

/// Time until the mouth is within 0.15 L of a target, and the largest roll on the way, rad.
fn reach(target: DVec3, balance: bool, headlong: bool) -> (Option<f64>, f64) {
    let mut fish = Swimmer::new(Arc::new(Body::published(1.0)), DVec3::ZERO, 0.0);
    let (mut chase, mut roll) = (Chase::default(), 0.0f64);
    for step in 0..7000 {
        let posture = fish.posture();
        if (posture.mouth() - target).length() < 0.15 * fish.body.length() {
            return (Some(f64::from(step) * TIME_STEP), roll);
        }
        roll = roll.max(posture.roll().abs());
        let command = if headlong {
            Chase::headlong(target, 1.0, &posture)
        } else {
            chase.toward(target, 1.0, &posture, 1.0)
        };
        fish.step(&Command { balance, ..command }, &Still, &[]).unwrap();
    }
    (None, roll)
}

/// Sixteen targets 40 to 120 away, all round, within 29° of level.
fn targets() -> Vec<DVec3> {
    let mut draws = stream(1, [0, 0, 0], "targets");
    let target = |_| {
        let (distance, heading) = (draws.between(40.0, 120.0), draws.between(-PI, PI));
        let elevation = draws.between(-29f64, 29.0).to_radians();
        let (level, z) = (distance * crate::math::cos(elevation), distance * crate::math::sin(elevation));
        DVec3::new(-level * crate::math::sin(heading), level * crate::math::cos(heading), z)
    };
    (0..16).map(target).collect()
}

///
#[test]
fn a_fish_reaches_every_target() {
    let chases: Vec<_> = targets().into_iter().map(|target| (target, reach(target, true, false))).collect();
    let mut pace: Vec<f64> = Vec::new();
    for (target, (time, roll)) in chases {
        let time = time.unwrap_or_else(|| panic!("{target} is not reached"));
        assert!(roll.to_degrees() < 25.0, "{target}: rolls by {}°", roll.to_degrees());
        pace.push(time / (target - DVec3::new(0.0, 8.0, 0.0)).length());
    }
    pace.sort_by(f64::total_cmp);
    let (median, mean) = (0.5 * (pace[7] + pace[8]), pace.iter().sum::<f64>() / 16.0);
    assert!((1.0..2.0).contains(&median) && (1.2..3.0).contains(&mean), "{median} {mean}: {pace:?}");
}

/// what the reflex is for.
#[test]
fn without_the_reflex_a_fish_rolls_and_misses() {
    let chases: Vec<_> = targets().into_iter().map(|target| reach(target, false, false)).collect();
    let roll = chases.iter().map(|&(_, roll)| roll.to_degrees()).fold(0.0, f64::max);
    assert!(roll > 30.0, "{roll}°");
    let reached = chases.iter().filter(|(time, _)| time.is_some()).count();
    assert!(reached < 16, "{reached}");
}

/// a target inside the turning circle is orbited unless the fish first swims out.
#[test]
fn a_target_inside_the_turning_circle_is_reached_on_a_detour() {
    let target = DVec3::new(-20.0, 0.0, 0.0);
    assert!(reach(target, true, false).0.is_some());
    assert!(reach(target, true, true).0.is_none(), "without the detour it is orbited");
}

/// AF-9
#[test]
fn a_target_in_the_mouth_or_straight_above_keeps_the_heading() {
    let body = Body::published(1.0);
    let posture = Posture::new(&body.rest);
    let mut chase = Chase::default();
    let here = chase.toward(posture.mouth(), 1.0, &posture, 1.0);
    assert_eq!((here.turn, here.fins), (Turn::Bias(0.0), FinAngles::both(NEUTRAL)));
    let above = chase.toward(posture.mouth() + DVec3::Z, 1.0, &posture, 1.0);
    assert_eq!((above.turn, above.fins), (Turn::Bias(0.0), FinAngles::both(crate::fish::fins::ASCENT)));
}

///
#[test]
fn a_fish_turns_and_tilts_toward_its_target() {
    let body = Body::published(1.0);
    let posture = Posture::new(&body.rest);
    let to = |target: [f64; 3]| Chase::headlong(posture.mouth() + DVec3::from(target), 0.5, &posture);
    let left = to([-1.0, 1.0, 0.0]);
    assert_eq!((left.swim, left.turn), (0.5, Turn::Bias(0.75)));
    let right = to([0.1, 1.0, 0.0]);
    let expected = -0.75 * crate::math::atan2(0.1, 1.0) / FRAC_PI_6;
    assert!(matches!(right.turn, Turn::Bias(bias) if (bias - expected).abs() < 1e-12), "{right:?}");
    let up = to([0.0, 1.0, 0.1]);
    assert!((up.fins.left - NEUTRAL - 2.0 * crate::math::atan2(0.1, 1.0)).abs() < 1e-12, "{up:?}");
}

//! Timed turns: how hard and how long the turning segments contract for an angle. Which muscles
//! these are is the motor's business.

use super::mechanics::TIME_STEP;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

/// r of a turn of 30° and more.
pub const STRENGTH: f64 = 0.75;
/// s, the rate of contraction, by time.
const RATE: f64 = 2.0;
/// Time of the slow release.
const RELEASE: f64 = 4.0;
/// The largest angle of one turn, rad; larger ones are made of equal turns.
const ANGLE_MAX: f64 = FRAC_PI_2;
/// Below this angle, rad, strength shrinks and not the hold.
const ANGLE_FULL: f64 = FRAC_PI_6;
/// Angle, degrees, and time for which it is held: the calibrated table.
const HOLDS: [(f64, f64); 4] = [(30.0, 4.5), (45.0, 8.3), (60.0, 12.3), (90.0, 20.3)];

/// A turn under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedTurn {
    /// r with the sign of the turn, left positive.
    strength: f64,
    hold: f64,
    /// Turns still to make, this one included.
    turns: u32,
    /// Since the present turn began.
    time: f64,
}

impl TimedTurn {
    /// By an angle, rad, left positive. A turn beyond 90° is made of equal turns, one after the other.
    pub fn new(angle: f64) -> TimedTurn {
        let turns = crate::math::floor((angle.abs() - 1e-9) / ANGLE_MAX).max(0.0) + 1.0;
        let part = angle.abs() / turns;
        let strength = if part < ANGLE_FULL { STRENGTH * part / ANGLE_FULL } else { STRENGTH };
        let strength = if angle < 0.0 { -strength } else { strength };
        TimedTurn { strength, hold: hold(part.to_degrees()), turns: turns as u32, time: 0.0 }
    }

    /// Goes on by one step.
    pub fn step(&mut self) {
        self.time += TIME_STEP;
        if self.time >= self.duration() && self.turns > 1 {
            self.turns -= 1;
            self.time -= self.duration();
        }
    }

    /// e(t) = r · clip(t s, 0, 1) · clip(1 − (t − 1/s − hold)/4, 0, 1).
    pub fn bias(&self) -> f64 {
        let contraction = (self.time * RATE).clamp(0.0, 1.0);
        let release = (1.0 - (self.time - 1.0 / RATE - self.hold) / RELEASE).clamp(0.0, 1.0);
        self.strength * contraction * release
    }

    /// Whether its last turn is released.
    pub fn over(&self) -> bool {
        self.turns == 1 && self.time >= self.duration()
    }

    /// Of one turn: contraction, hold and release.
    fn duration(&self) -> f64 {
        1.0 / RATE + self.hold + RELEASE
    }
}

/// Linear between the rows of the table, the first below it.
fn hold(degrees: f64) -> f64 {
    let (first, _) = HOLDS[0];
    if degrees <= first {
        return HOLDS[0].1;
    }
    let upper = HOLDS.iter().position(|&(angle, _)| degrees <= angle).unwrap_or(HOLDS.len() - 1);
    let ((a, hold_a), (b, hold_b)) = (HOLDS[upper - 1], HOLDS[upper]);
    hold_a + (hold_b - hold_a) * (degrees - a) / (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn duration(degrees: f64) -> f64 {
        TimedTurn::new(degrees.to_radians()).duration()
    }

    /// A-26, the column of durations.
    #[test]
    fn larger_turns_are_held_longer() {
        for (degrees, expected) in
            [(10.0, 9.0), (30.0, 9.0), (45.0, 12.8), (52.5, 14.8), (60.0, 16.8), (90.0, 24.8)]
        {
            assert!((duration(degrees) - expected).abs() < 1e-9, "{degrees}: {}", duration(degrees));
        }
    }

    ///
    #[test]
    fn a_turn_contracts_fast_and_releases_slowly() {
        let at = |time: f64| TimedTurn { time, ..TimedTurn::new(-FRAC_PI_6) }.bias();
        for (time, expected) in
            [(0.0, 0.0), (0.25, -0.375), (0.5, -0.75), (5.0, -0.75), (7.0, -0.375), (9.0, 0.0), (20.0, 0.0)]
        {
            assert!((at(time) - expected).abs() < 1e-12, "{time}: {}", at(time));
        }
        assert_eq!(TimedTurn::new(FRAC_PI_6 / 3.0).strength, STRENGTH / 3.0);
    }

    #[test]
    fn a_turn_beyond_a_right_angle_is_made_of_equal_ones() {
        let mut turn = TimedTurn::new(150f64.to_radians());
        assert_eq!((turn.turns, turn.hold), (2, hold(75.0)));
        let steps = (1..)
            .find(|_| {
                turn.step();
                turn.over()
            })
            .unwrap();
        let expected = 2.0 * duration(75.0) / TIME_STEP;
        assert!((f64::from(steps) - expected).abs() <= 1.0, "{steps} {expected}");
        assert_eq!(TimedTurn::new(FRAC_PI_2).turns, 1);
    }
}

//! `turn`: round, on the spot (E-71).

use super::record::{Record, most_of};
use super::setup::{End, Setup, Start};
use super::{Context, Scoring, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters. The direction has no default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// Which way.
    pub direction: Direction,
    /// Length of the trial, s.
    #[serde(default = "seconds")]
    pub seconds: f64,
    /// The rate of turning that earns 1, rad/s.
    #[serde(default = "yaw_rate_max")]
    pub yaw_rate_max: f64,
    /// The drift up to which nothing is lost, m.
    #[serde(default = "drift_free")]
    pub drift_free: f64,
    /// The drift from which everything is lost, m.
    #[serde(default = "drift_zero")]
    pub drift_zero: f64,
}

fn seconds() -> f64 {
    10.0
}

fn yaw_rate_max() -> f64 {
    std::f64::consts::FRAC_PI_2
}

fn drift_free() -> f64 {
    0.5
}

fn drift_zero() -> f64 {
    2.0
}

/// A way to turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Counter-clockwise, seen from above.
    Left,
    /// Clockwise.
    Right,
}

impl Turn {
    /// The score of a turn in the wanted direction, rad, with a largest distance from the start, m.
    fn score_of(&self, yaw: f64, drift: f64) -> f64 {
        let kept = share((self.drift_zero - drift) / (self.drift_zero - self.drift_free));
        share(yaw / (self.yaw_rate_max * self.seconds)) * kept
    }
}

impl Scoring for Turn {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::positive("yaw_rate_max", self.yaw_rate_max, 100.0)?;
        ranges::positive("drift_zero", self.drift_zero, 1000.0)?;
        if (0.0..self.drift_zero).contains(&self.drift_free) {
            return Ok(());
        }
        let problem =
            format!("{} is not within [0, {}), below `drift_zero`", self.drift_free, self.drift_zero);
        Err(SpecError::new("drift_free", problem))
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        vec![Setup { seconds: self.seconds, start: Start::Rest, target: None, end: End::Never }]
    }

    fn score(&self, _: &Setup, record: &Record, _: &Context) -> f64 {
        let left = record.last().yaw;
        let yaw = match self.direction {
            Direction::Left => left,
            Direction::Right => -left,
        };
        let drift = most_of(&record.moments, |moment| moment.position.truncate().length());
        self.score_of(yaw, drift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};
    use glam::DVec3;
    use std::f64::consts::PI;

    fn turn(direction: Direction) -> Turn {
        let table = serde_json::json!({ "direction": direction });
        crate::read_spec(table).unwrap()
    }

    /// T-11
    #[test]
    fn turning_counts_while_the_creature_keeps_its_place() {
        for (yaw, drift, expected) in
            [(2.5 * PI, 0.8, 0.4), (2.5 * PI, 2.0, 0.0), (-1.0, 0.0, 0.0), (9.0 * PI, 0.1, 1.0)]
        {
            let found = turn(Direction::Left).score_of(yaw, drift);
            assert!((found - expected).abs() < 1e-6, "{yaw}, {drift}: {found}");
        }
    }

    #[test]
    fn left_and_right_are_opposite_and_the_largest_drift_counts() {
        // Half a turn to the right, and out to 1.25 m and back.
        let record = lived(10.0, |seconds, moment| {
            moment.yaw = -0.1 * PI * seconds;
            moment.position = DVec3::new(0.0, if seconds == 5.0 { -1.25 } else { 0.0 }, 3.0);
        });
        let score = |direction| {
            let turn = turn(direction);
            turn.score(&turn.trials(&context())[0], &record, &context())
        };
        assert_eq!(score(Direction::Left), 0.0);
        assert!((score(Direction::Right) - 0.2 * 0.5).abs() < 1e-9);
    }
}

//! `locomotion`: straight ahead in steps of speed, with little effort within a step (E-70).

use super::record::{Record, mean_of};
use super::setup::{End, Setup, Start};
use super::{Context, Scoring, ranges};
use crate::SpecError;
use crate::math::floor;
use serde::{Deserialize, Serialize};

/// Keeps a quotient such as 0.3 / 0.1 from falling below its step.
const ROUNDING: f64 = 1e-9;

/// The parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Locomotion {
    /// Length of the trial, s.
    pub seconds: f64,
    /// The speed that earns 1, m/s.
    pub speed_max: f64,
    /// A step of speed, q, m/s.
    pub speed_step: f64,
}

impl Default for Locomotion {
    fn default() -> Self {
        Locomotion { seconds: 10.0, speed_max: 3.0, speed_step: 0.1 }
    }
}

impl Locomotion {
    /// The score of a speed ahead, m/s, at an efficiency within [0, 1]. Below the first step of speed nothing
    /// counts, or standing still would beat crawling.
    fn score_of(&self, speed: f64, efficiency: f64) -> f64 {
        let steps = floor(speed / self.speed_step + ROUNDING);
        if steps < 1.0 { 0.0 } else { self.speed_step * (steps + efficiency) / self.speed_max }
    }
}

impl Scoring for Locomotion {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::positive("speed_max", self.speed_max, 100.0)?;
        ranges::positive("speed_step", self.speed_step, self.speed_max)
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        vec![Setup { seconds: self.seconds, start: Start::Rest, target: None, end: End::Never }]
    }

    fn score(&self, _: &Setup, record: &Record, _: &Context) -> f64 {
        // The first fifth is left out, against creatures that fall over once.
        let fifth = self.seconds / 5.0;
        let speed = (record.last().position.x - record.at(fifth).position.x) / (self.seconds - fifth);
        let effort = mean_of(record.lived(), |moment| moment.effort);
        self.score_of(speed, if record.has_muscles { 1.0 - effort } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};
    use glam::DVec3;

    /// T-6
    #[test]
    fn speed_counts_in_steps_and_efficiency_within_one() {
        let table = [
            (0.05, 0.9, 0.0),
            (0.1, 0.0, 0.033333),
            (0.3, 0.5, 0.116667),
            (0.37, 0.2, 0.106667),
            (0.37, 0.8, 0.126667),
            (0.4, 0.0, 0.133333),
            (1.0, 0.65, 0.355),
            (3.0, 1.0, 1.033333),
            (-0.4, 1.0, 0.0),
        ];
        for (speed, efficiency, expected) in table {
            let found = Locomotion::default().score_of(speed, efficiency);
            assert!((found - expected).abs() < 1e-6, "{speed}, {efficiency}: {found}");
        }
    }

    /// E-70: a leap in the first two of ten seconds earns nothing; then 0.5 m/s ahead at a mean effort of 0.4.
    #[test]
    fn the_first_fifth_does_not_count() {
        let run = |leap: f64| {
            let mut record = lived(10.0, |seconds, moment| {
                moment.position = DVec3::new(leap + 0.501 * (seconds - 2.0), seconds, 1.0);
                moment.effort = if seconds > 5.0 { 0.8 } else { 0.0 };
            });
            record.has_muscles = true;
            Locomotion::default().score(&Locomotion::default().trials(&context())[0], &record, &context())
        };
        assert!((run(0.0) - 0.1 * 5.6 / 3.0).abs() < 1e-9, "{}", run(0.0));
        assert_eq!(run(0.0), run(9.0));
    }
}

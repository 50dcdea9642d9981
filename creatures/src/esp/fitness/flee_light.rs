//! `flee_light`: away from a light, and not past it (E-77).

use super::avert_light::HEADINGS;
use super::record::{Record, least_of, mean_of};
use super::setup::{End, Form, Setup, Start, Target};
use super::{Context, Scoring, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FleeLight {
    /// Length of a trial, s.
    pub seconds: f64,
    /// Of the light at the start, m.
    pub distance: f64,
    /// How much farther off on the mean earns 1, m.
    pub gain_ref: f64,
    /// Of the light in each trial, degrees.
    pub headings: Vec<f64>,
    /// How long the way that is taken is looked at, s.
    pub wrong_way_seconds: f64,
    /// How much closer to the light costs in full, m.
    pub wrong_way_tolerance: f64,
    /// What getting closer costs.
    pub wrong_way_weight: f64,
}

impl Default for FleeLight {
    fn default() -> Self {
        FleeLight {
            seconds: 20.0,
            distance: 3.0,
            gain_ref: 5.0,
            headings: HEADINGS.to_vec(),
            wrong_way_seconds: 2.0,
            wrong_way_tolerance: 0.5,
            wrong_way_weight: 0.5,
        }
    }
}

impl FleeLight {
    /// The score of a mean distance, and of the smallest distance at first, m.
    fn score_of(&self, mean: f64, smallest: f64) -> f64 {
        let wrong_way = share((self.distance - smallest) / self.wrong_way_tolerance);
        let score = gain(mean, self.distance, self.gain_ref) - self.wrong_way_weight * wrong_way;
        if score > 0.0 { score } else { 0.0 }
    }
}

/// What a mean distance has gained over that at the start, as a share of `full`, all in m.
pub(super) fn gain(mean: f64, start: f64, full: f64) -> f64 {
    share((mean - start) / full)
}

impl Scoring for FleeLight {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::distance(self.distance)?;
        ranges::positive("gain_ref", self.gain_ref, 1000.0)?;
        ranges::headings(&self.headings, None)?;
        ranges::positive("wrong_way_seconds", self.wrong_way_seconds, self.seconds)?;
        ranges::positive("wrong_way_tolerance", self.wrong_way_tolerance, 1000.0)?;
        ranges::within("wrong_way_weight", self.wrong_way_weight, 1.0)
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        let target = |&heading| Some(Target::new(Form::Light, heading, self.distance));
        let setup = |target| Setup { seconds: self.seconds, start: Start::Rest, target, end: End::Never };
        self.headings.iter().map(target).map(setup).collect()
    }

    fn score(&self, _: &Setup, record: &Record, _: &Context) -> f64 {
        let mean = mean_of(record.lived(), |moment| moment.light_distance);
        let first = record.until(self.wrong_way_seconds);
        self.score_of(mean, least_of(first, |moment| moment.light_distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};

    /// T-11
    #[test]
    fn getting_closer_first_costs() {
        let kind = FleeLight::default();
        assert!((kind.score_of(5.5, 2.8) - 0.3).abs() < 1e-6);
        assert_eq!([kind.score_of(9.0, 3.0), kind.score_of(2.0, 1.0)], [1.0, 0.0]);
    }

    #[test]
    fn the_whole_way_counts_and_its_first_two_seconds_twice() {
        let kind = FleeLight::default();
        let setup = kind.trials(&context())[0];
        let record = lived(20.0, |seconds, moment| {
            moment.light_distance = if (1.5..=2.01).contains(&seconds) { 2.8 } else { 5.5 };
        });
        let mean = (31.0 * 2.8 + 1169.0 * 5.5) / 1200.0;
        let score = kind.score(&setup, &record, &context());
        assert!((score - ((mean - 3.0) / 5.0 - 0.2)).abs() < 1e-9, "{score}");
    }
}

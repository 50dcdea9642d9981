//! `strike`: hard on the ground (E-74).

use super::record::Record;
use super::setup::{End, Setup, Start};
use super::{Context, Scoring, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Strike {
    /// Length of the trial, s.
    pub seconds: f64,
    /// How far above its own weight an impact earns 1, body weights.
    pub body_weights: f64,
}

impl Default for Strike {
    fn default() -> Self {
        Strike { seconds: 5.0, body_weights: 20.0 }
    }
}

impl Strike {
    /// The score of the hardest impact, body weights.
    fn score_of(&self, impact: f64) -> f64 {
        share((impact - 1.0) / self.body_weights)
    }
}

impl Scoring for Strike {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::positive("body_weights", self.body_weights, 1e6)
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        vec![Setup { seconds: self.seconds, start: Start::Rest, target: None, end: End::Never }]
    }

    fn score(&self, _: &Setup, record: &Record, _: &Context) -> f64 {
        self.score_of(record.hardest_impact())
    }

    fn gauge(&self, record: &Record) -> Option<(&'static str, f64)> {
        Some(("impact", record.hardest_impact()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};

    /// T-11: 2000 N of a creature of 20 kg.
    #[test]
    fn an_impact_counts_above_the_creatures_own_weight() {
        let found = Strike::default().score_of(2000.0 / (20.0 * 9.81));
        assert!((found - 0.459684).abs() < 1e-6, "{found}");
        assert_eq!(
            [0.5, 1.0, 21.0, 90.0].map(|impact| Strike::default().score_of(impact)),
            [0.0, 0.0, 1.0, 1.0]
        );
    }

    #[test]
    fn the_hardest_impact_is_scored_and_told() {
        let strike = Strike::default();
        let record = lived(5.0, |seconds, moment| {
            moment.ground_force = if (1.99..2.04).contains(&seconds) { 11.0 } else { 1.0 };
        });
        assert_eq!(strike.gauge(&record), Some(("impact", 11.0)));
        assert_eq!(strike.score(&strike.trials(&context())[0], &record, &context()), 0.5);
    }
}

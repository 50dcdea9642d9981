//! `high_reach`: high up, with any part of the body (E-79).

use super::record::{Record, most_of};
use super::setup::{End, Setup, Start};
use super::{Context, Scoring, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HighReach {
    /// Length of the trial, s.
    pub seconds: f64,
    /// The height that earns 1, m.
    pub target_height: f64,
}

impl Default for HighReach {
    fn default() -> Self {
        HighReach { seconds: 10.0, target_height: 10.0 }
    }
}

impl Scoring for HighReach {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::positive("target_height", self.target_height, 1000.0)
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        vec![Setup { seconds: self.seconds, start: Start::Rest, target: None, end: End::Never }]
    }

    fn score(&self, _: &Setup, record: &Record, _: &Context) -> f64 {
        share(most_of(record.lived(), |moment| moment.top) / self.target_height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};

    #[test]
    fn the_highest_moment_counts() {
        let kind = HighReach::default();
        let record = lived(10.0, |seconds, moment| moment.top = if seconds == 4.0 { 2.5 } else { 1.0 });
        assert_eq!(kind.score(&kind.trials(&context())[0], &record, &context()), 0.25);
    }
}

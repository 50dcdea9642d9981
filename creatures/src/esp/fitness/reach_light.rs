//! `reach_light`: to a light (E-73).

use super::record::{Record, mean_of};
use super::setup::{End, Form, Setup, Start, Target};
use super::{Context, Scoring, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReachLight {
    /// Longest duration of a trial, s.
    pub seconds: f64,
    /// Of the light at the start, m.
    pub distance: f64,
    /// The distance at which a light is reached, m.
    pub reached: f64,
    /// Of the light in each trial, degrees.
    pub headings: Vec<f64>,
}

impl Default for ReachLight {
    fn default() -> Self {
        let headings = vec![0.0, 72.0, 144.0, -144.0, -72.0];
        ReachLight { seconds: 30.0, distance: 5.0, reached: 0.5, headings }
    }
}

impl ReachLight {
    /// The score of a mean distance at the end, m.
    fn score_of(&self, distance: f64) -> f64 {
        if distance < self.reached { 1.0 } else { share(1.0 - distance / self.distance) }
    }
}

impl Scoring for ReachLight {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::distance(self.distance)?;
        ranges::within("reached", self.reached, self.distance)?;
        ranges::headings(&self.headings, None)
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        let target = |&heading| Some(Target::new(Form::Light, heading, self.distance));
        let end = End::Within(self.reached);
        let setup = |target| Setup { seconds: self.seconds, start: Start::Rest, target, end };
        self.headings.iter().map(target).map(setup).collect()
    }

    fn score(&self, _: &Setup, record: &Record, _: &Context) -> f64 {
        if record.ended {
            return 1.0;
        }
        let last = record.after(self.seconds - self.seconds.min(1.0));
        self.score_of(mean_of(last, |moment| moment.light_distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};

    /// T-11: the first is 0.5 m away, which is not yet reached.
    #[test]
    fn the_way_covered_counts() {
        let kind = ReachLight::default();
        let scores = [0.5, 1.0, 2.5, 5.0, 6.0].map(|distance| kind.score_of(distance));
        assert!((kind.combine(&scores) - 0.44).abs() < 1e-6, "{scores:?}");
    }

    #[test]
    fn whoever_gets_there_has_done_everything() {
        let kind = ReachLight::default();
        let setup = kind.trials(&context())[0];
        let mut record = lived(30.0, |seconds, moment| {
            moment.light_distance = if seconds > 29.0 { 1.0 } else { 4.0 };
        });
        assert!((kind.score(&setup, &record, &context()) - 0.8).abs() < 1e-9);
        assert!(!setup.end.is_met(&record.moments));
        record.moments.last_mut().unwrap().light_distance = 0.49;
        assert!(setup.end.is_met(&record.moments));
        record.ended = true;
        assert_eq!(kind.score(&setup, &record, &context()), 1.0);
    }
}

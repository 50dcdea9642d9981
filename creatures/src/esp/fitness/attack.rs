//! `attack`: hard on the ground at a light, and nowhere without one (E-75).

use super::record::Record;
use super::setup::{End, Form, Setup, Start, Target};
use super::{Context, Reference, Scoring, mean, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters. The skill that strikes has no default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Attack {
    /// Longest duration of a trial, s.
    #[serde(default = "seconds")]
    pub seconds: f64,
    /// Of the light at the start, m.
    #[serde(default = "distance")]
    pub distance: f64,
    /// Of the light in each trial, degrees.
    #[serde(default = "headings")]
    pub headings: Vec<f64>,
    /// The skill whose impact is the measure of a strike.
    pub impact_from: String,
    /// The share of that impact that counts as one.
    #[serde(default = "half")]
    pub impact_fraction: f64,
    /// What counts as an impact at least, body weights.
    #[serde(default = "impact_floor")]
    pub impact_floor: f64,
    /// Trials without a light: 0 or 1, since a second would be lived as the first.
    #[serde(default = "dark_trials")]
    pub dark_trials: u32,
    /// What an impact without a light costs.
    #[serde(default = "half")]
    pub dark_penalty: f64,
}

fn seconds() -> f64 {
    30.0
}

fn distance() -> f64 {
    5.0
}

fn headings() -> Vec<f64> {
    vec![45.0, 135.0, -135.0, -45.0]
}

fn half() -> f64 {
    0.5
}

fn impact_floor() -> f64 {
    2.0
}

fn dark_trials() -> u32 {
    1
}

impl Attack {
    /// What counts as an impact, body weights.
    pub(super) fn threshold(&self, context: &Context) -> f64 {
        // A task that tests an attack has the impact; `EspTask` checks it.
        let share =
            context.impacts.get(&self.impact_from).map_or(0.0, |impact| impact * self.impact_fraction);
        if share > self.impact_floor { share } else { self.impact_floor }
    }
}

/// The score of the distance at the first impact, if there was one, where the light was at `start`, m.
pub(super) fn score_of(impact: Option<f64>, start: f64) -> f64 {
    impact.map_or(0.0, |distance| share(1.0 - distance / start))
}

impl Scoring for Attack {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::distance(self.distance)?;
        ranges::headings(&self.headings, None)?;
        ranges::within("impact_fraction", self.impact_fraction, 1.0)?;
        ranges::positive("impact_floor", self.impact_floor, 1e6)?;
        ranges::within("dark_penalty", self.dark_penalty, 1.0)?;
        match self.dark_trials {
            0 | 1 => Ok(()),
            more => Err(SpecError::new("dark_trials", format!("{more} is neither 0 nor 1"))),
        }
    }

    fn trials(&self, context: &Context) -> Vec<Setup> {
        let end = End::Impact(self.threshold(context));
        let light = |&heading| Some(Target::new(Form::Light, heading, self.distance));
        let dark = (0..self.dark_trials).map(|_| None);
        let targets = self.headings.iter().map(light).chain(dark);
        targets.map(|target| Setup { seconds: self.seconds, start: Start::Rest, target, end }).collect()
    }

    fn score(&self, setup: &Setup, record: &Record, _: &Context) -> f64 {
        match setup.target {
            Some(target) => score_of(record.ended.then(|| record.last().light_distance), target.distance),
            None if record.ended => -self.dark_penalty,
            None => 0.0,
        }
    }

    /// A fault in the dark costs what an impact does, or it would be the way out.
    fn score_of_fault(&self, setup: &Setup) -> f64 {
        if setup.target.is_some() { 0.0 } else { -self.dark_penalty }
    }

    fn combine(&self, scores: &[f64]) -> f64 {
        let (light, dark) = scores.split_at(self.headings.len());
        share(mean(light) + mean(dark))
    }

    fn references(&self) -> Vec<Reference<'_>> {
        vec![Reference { key: "impact_from", name: &self.impact_from, kind: "strike" }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};

    fn attack() -> Attack {
        crate::read_spec(serde_json::json!({ "impact_from": "strike" })).unwrap()
    }

    /// T-11
    #[test]
    fn impacts_count_by_their_distance_and_cost_in_the_dark() {
        let mut scores = [Some(0.5), Some(1.0), None, Some(2.0), None].map(|impact| score_of(impact, 5.0));
        assert!((attack().combine(&scores) - 0.575).abs() < 1e-6, "{scores:?}");
        scores[4] = -0.5;
        assert!((attack().combine(&scores) - 0.075).abs() < 1e-6);
        assert_eq!(attack().combine(&[0.0, 0.0, 0.0, 0.4, -0.5]), 0.0, "never below 0");
    }

    /// E-75
    #[test]
    fn what_counts_as_an_impact_follows_from_the_strike() {
        let threshold = |impact: f64| {
            let impacts = [("strike".to_owned(), impact)].into();
            attack().threshold(&Context { impacts: &impacts, ..context() })
        };
        assert_eq!([3.0, 10.0].map(threshold), [2.0, 5.0]);
    }

    #[test]
    fn the_first_impact_ends_a_trial() {
        let trials = attack().trials(&context());
        let mut record = lived(30.0, |_, moment| {
            moment.light_distance = 1.5;
            moment.ground_force = 2.5;
        });
        assert!(trials.iter().all(|setup| setup.end.is_met(&record.moments)));
        record.ended = true;
        let scores: Vec<f64> =
            trials.iter().map(|setup| attack().score(setup, &record, &context())).collect();
        assert_eq!(scores, [0.7, 0.7, 0.7, 0.7, -0.5]);
        let faults: Vec<f64> = trials.iter().map(|setup| attack().score_of_fault(setup)).collect();
        assert_eq!(faults, [0.0, 0.0, 0.0, 0.0, -0.5]);
    }
}

//! `expression`: whatever a formula says of a trial (E-58).

use super::formula::{Formula, Quantity};
use super::record::Record;
use super::setup::{End, Form, Setup, Start, Target};
use super::{Context, Scoring, ranges};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters. The score has no default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expression {
    /// The formula.
    pub score: Formula,
    /// Length of a trial, s.
    #[serde(default = "seconds")]
    pub seconds: f64,
    /// The pose before the creature settles.
    #[serde(default)]
    pub start: Start,
    /// Of the target, m.
    #[serde(default = "distance")]
    pub distance: f64,
    /// Of the target in each trial, degrees; without any there is one trial without a target.
    #[serde(default)]
    pub headings: Vec<f64>,
    /// Whether the target is a disc with a light, which can be touched, instead of a light.
    #[serde(default)]
    pub disc: bool,
}

fn seconds() -> f64 {
    10.0
}

fn distance() -> f64 {
    5.0
}

impl Scoring for Expression {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::distance(self.distance)?;
        if !self.headings.is_empty() {
            ranges::headings(&self.headings, None)?;
        }
        let absent = |quantity| match quantity {
            Quantity::LightDistance | Quantity::LightAngle => {
                self.headings.is_empty().then_some("`headings`")
            }
            Quantity::Touched => (self.headings.is_empty() || !self.disc).then_some("`headings` and `disc`"),
            _ => None,
        };
        for quantity in self.score.quantities() {
            if let Some(key) = absent(quantity) {
                let problem = format!("`{}` means nothing without {key}", quantity.name());
                return Err(SpecError::new("score", problem));
            }
        }
        Ok(())
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        let form = if self.disc { Form::Disc } else { Form::Light };
        let setup = |target| Setup { seconds: self.seconds, start: self.start, target, end: End::Never };
        match self.headings.as_slice() {
            [] => vec![setup(None)],
            headings => headings
                .iter()
                .map(|&heading| setup(Some(Target::new(form, heading, self.distance))))
                .collect(),
        }
    }

    fn score(&self, _: &Setup, record: &Record, _: &Context) -> f64 {
        self.score.value(record)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::Fitness;
    use crate::esp::fitness::tests::{context, lived};
    use serde_json::json;

    /// E-89, both examples.
    #[test]
    fn tip_recovery_is_a_formula() {
        let table = json!({ "kind": "expression", "start": "upside_down", "seconds": 8.0,
            "score": "clamp01(0.5 + 0.5 * mean_last(up_z, 2.0))" });
        let Ok(Fitness::Expression(tip)) = Fitness::read(&table) else { panic!("is legal") };
        let trials = tip.trials(&context());
        assert_eq!((trials.len(), trials[0].start), (1, Start::UpsideDown));
        let record = lived(8.0, |seconds, moment| moment.up = if seconds > 7.0 { 1.0 } else { -1.0 });
        assert!((tip.score(&trials[0], &record, &context()) - 0.5).abs() < 1e-9);

        let table = json!({ "kind": "expression", "start": "upside_down", "seconds": 30.0, "distance": 5.0,
            "headings": [0, 90, 180, -90],
            "score": "0.5 * clamp01(mean(up_z)) + 0.5 * clamp01(1 - last(light_distance) / 5)" });
        let Ok(Fitness::Expression(on)) = Fitness::read(&table) else { panic!("is legal") };
        let record = lived(30.0, |_, moment| (moment.up, moment.light_distance) = (0.5, 1.0));
        assert_eq!(on.trials(&context()).len(), 4);
        assert!((on.score(&trials[0], &record, &context()) - 0.65).abs() < 1e-9);
    }

    #[test]
    fn a_measure_that_has_no_meaning_is_refused() {
        for (table, word) in [
            (json!({ "kind": "expression", "score": "last(light_distance)" }), "headings"),
            (json!({ "kind": "expression", "score": "max(touched)", "headings": [0] }), "disc"),
        ] {
            let error = Fitness::read(&table).unwrap_err();
            assert!(error.path == "score" && error.problem.contains(word), "{error}");
        }
    }
}

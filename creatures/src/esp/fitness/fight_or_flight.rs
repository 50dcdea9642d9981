//! `fight_or_flight`: to what is vulnerable, away from what is dangerous (E-78). The weighting makes one fixed
//! reaction a direction worth less than telling the two apart in a single direction.

use super::record::{Record, mean_of};
use super::setup::{End, Form, Setup, Start, Target};
use super::{Context, Fitness, Reference, Scoring, attack, flee_light, mean, ranges};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters. The skills have no defaults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FightOrFlight {
    /// Longest duration of a trial, s.
    #[serde(default = "seconds")]
    pub seconds: f64,
    /// Of the target at the start, m.
    #[serde(default = "distance")]
    pub distance: f64,
    /// Of the target, degrees; two trials each.
    #[serde(default = "headings")]
    pub headings: Vec<f64>,
    /// The skill after which the vulnerable are scored.
    pub fight: String,
    /// The skill after which the dangerous are scored.
    pub flight: String,
    /// Takes the plain mean of all scores instead, to see what the weighting does.
    #[serde(default)]
    pub plain_mean: bool,
}

fn seconds() -> f64 {
    30.0
}

fn distance() -> f64 {
    5.0
}

fn headings() -> Vec<f64> {
    vec![0.0, 90.0, 180.0, -90.0]
}

impl FightOrFlight {
    /// The means over headings of the larger and of the smaller score of both trials, f+ and f−.
    fn split(scores: &[f64]) -> (f64, f64) {
        let pairs = scores
            .chunks_exact(2)
            .map(|pair| if pair[0] > pair[1] { (pair[0], pair[1]) } else { (pair[1], pair[0]) });
        let (larger, smaller): (Vec<f64>, Vec<f64>) = pairs.unzip();
        (mean(&larger), mean(&smaller))
    }
}

impl Scoring for FightOrFlight {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::distance(self.distance)?;
        ranges::headings(&self.headings, None)
    }

    /// For each heading the vulnerable, then the dangerous.
    fn trials(&self, context: &Context) -> Vec<Setup> {
        let weights = match context.fitness(&self.fight) {
            Some(Fitness::Attack(fight)) => fight.threshold(context),
            _ => f64::INFINITY, // the syllabus was checked: it is an attack
        };
        let forms = [(Form::Disc, End::Impact(weights)), (Form::Stack, End::Touch)];
        let setup = |heading, (form, end)| {
            let target = Some(Target::new(form, heading, self.distance));
            Setup { seconds: self.seconds, start: Start::Rest, target, end }
        };
        self.headings.iter().flat_map(|&heading| forms.map(|form| setup(heading, form))).collect()
    }

    fn score(&self, setup: &Setup, record: &Record, context: &Context) -> f64 {
        if setup.end != End::Touch {
            return attack::score_of(record.ended.then(|| record.last().light_distance), self.distance);
        }
        match context.fitness(&self.flight) {
            Some(Fitness::FleeLight(flight)) if !record.ended => {
                let mean = mean_of(record.lived(), |moment| moment.light_distance);
                flee_light::gain(mean, self.distance, flight.gain_ref)
            }
            _ => 0.0, // destroyed
        }
    }

    /// `F = (f+ + 2n·f−) / (2n + 1)` over n headings.
    fn combine(&self, scores: &[f64]) -> f64 {
        let (larger, smaller) = FightOrFlight::split(scores);
        if self.plain_mean {
            return 0.5 * (larger + smaller);
        }
        let weight = 2.0 * self.headings.len() as f64;
        (larger + weight * smaller) / (weight + 1.0)
    }

    fn measures(&self, scores: &[f64]) -> Vec<(&'static str, f64)> {
        let (larger, smaller) = FightOrFlight::split(scores);
        vec![("f_plus", larger), ("f_minus", smaller)]
    }

    fn references(&self) -> Vec<Reference<'_>> {
        vec![
            Reference { key: "fight", name: &self.fight, kind: "attack" },
            Reference { key: "flight", name: &self.flight, kind: "flee_light" },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};

    fn kind(headings: usize) -> FightOrFlight {
        let headings = vec![0.0; headings];
        let table = serde_json::json!({ "fight": "attack", "flight": "retreat", "headings": headings });
        crate::read_spec(table).unwrap()
    }

    /// Scores of the vulnerable and the dangerous, as trials have them.
    fn alternate(vulnerable: &[f64], dangerous: &[f64]) -> Vec<f64> {
        vulnerable.iter().zip(dangerous).flat_map(|(&fight, &flight)| [fight, flight]).collect()
    }

    /// T-5, the table: vulnerable; dangerous; f+, f−, F.
    #[test]
    fn telling_them_apart_counts_more_than_one_fixed_reaction() {
        let table = [
            ([1.0; 4], [0.0; 4], [1.0, 0.0, 0.111111]),
            ([1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.25, 0.25, 0.25]),
            ([0.8, 0.6, 0.7, 0.9], [0.5, 0.7, 0.0, 0.4], [0.775, 0.375, 0.419444]),
            ([1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 0.111111]),
            ([0.5; 4], [0.5; 4], [0.5; 3]),
            ([1.0; 4], [1.0; 4], [1.0; 3]),
        ];
        for (vulnerable, dangerous, expected) in table {
            let scores = alternate(&vulnerable, &dangerous);
            let measures = kind(4).measures(&scores);
            let found = [measures[0].1, measures[1].1, kind(4).combine(&scores)];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{vulnerable:?}, {dangerous:?}: {found}");
            }
        }
    }

    /// T-5, the weighting's purpose: one heading perfect in both cases against one reaction everywhere.
    #[test]
    fn one_heading_understood_beats_one_reaction_everywhere() {
        for (n, understood, fixed) in [(4, 0.25, 0.111111), (13, 0.076923, 0.037037)] {
            let mut one = vec![0.0; 2 * n];
            one[..2].fill(1.0);
            let everywhere = alternate(&vec![1.0; n], &vec![0.0; n]);
            assert!((kind(n).combine(&one) - understood).abs() < 1e-6);
            assert!((kind(n).combine(&everywhere) - fixed).abs() < 1e-6);
            let plain = FightOrFlight { plain_mean: true, ..kind(n) };
            assert!(
                plain.combine(&one) < plain.combine(&everywhere),
                "R-5: the plain mean has it the other way"
            );
        }
    }

    /// E-78
    #[test]
    fn the_vulnerable_are_struck_and_the_dangerous_destroy() {
        let kind = kind(1);
        let trials = kind.trials(&context());
        assert_eq!(trials.len(), 2);
        let mut record = lived(30.0, |_, moment| moment.light_distance = 7.0);
        let score =
            |record: &Record| trials.iter().map(|setup| kind.score(setup, record, &context())).collect();
        let unharmed: Vec<f64> = score(&record);
        assert_eq!(unharmed, [0.0, 0.4]);
        record.ended = true;
        record.moments.last_mut().unwrap().light_distance = 1.0;
        let ended: Vec<f64> = score(&record);
        assert_eq!(ended, [0.8, 0.0]);
    }
}

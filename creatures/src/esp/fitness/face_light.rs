//! `face_light`: the front towards a light (E-72).

use super::record::{Record, mean_of};
use super::setup::{End, Form, Setup, Start, Target};
use super::{Context, Scoring, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FaceLight {
    /// Length of a trial, s.
    pub seconds: f64,
    /// Of the light, m.
    pub distance: f64,
    /// Of the light in each trial, degrees.
    pub headings: Vec<f64>,
}

impl Default for FaceLight {
    fn default() -> Self {
        FaceLight { seconds: 10.0, distance: 5.0, headings: vec![45.0, 135.0, -135.0, -45.0] }
    }
}

/// The score of a mean angle to the light, where the light was at `heading`, both in degrees. Standing still
/// earns 0.
fn score_of(heading: f64, angle: f64) -> f64 {
    share(1.0 - angle / heading.abs())
}

impl Scoring for FaceLight {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::distance(self.distance)?;
        ranges::headings(&self.headings, Some((0.0, "whoever stands still would face the light")))
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        let target = |&heading| Some(Target::new(Form::Light, heading, self.distance));
        let setup = |target| Setup { seconds: self.seconds, start: Start::Rest, target, end: End::Never };
        self.headings.iter().map(target).map(setup).collect()
    }

    fn score(&self, setup: &Setup, record: &Record, _: &Context) -> f64 {
        let angle = mean_of(record.after(self.seconds / 2.0), |moment| moment.light_angle.abs());
        setup.target.map_or(0.0, |target| score_of(target.heading, angle.to_degrees()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::mean;
    use crate::esp::fitness::tests::{context, lived};

    /// T-11
    #[test]
    fn what_is_left_of_the_angle_is_lost() {
        let errors = [(45.0, 9.0), (135.0, 27.0), (-135.0, 135.0), (-45.0, 90.0)];
        let scores = errors.map(|(heading, angle)| score_of(heading, angle));
        for (found, expected) in scores.into_iter().zip([0.8, 0.8, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-6, "{found}");
        }
        assert!((FaceLight::default().combine(&scores) - 0.4).abs() < 1e-6);
        assert_eq!(mean(&scores), FaceLight::default().combine(&scores));
    }

    #[test]
    fn the_second_half_alone_counts_on_either_side() {
        let kind = FaceLight::default();
        let record = lived(10.0, |seconds, moment| {
            moment.light_angle = if seconds > 7.5 { -9f64 } else { 9.0 }.to_radians();
            if seconds <= 5.0 {
                moment.light_angle = 3.0;
            }
        });
        let score = kind.score(&kind.trials(&context())[0], &record, &context());
        assert!((score - 0.8).abs() < 1e-9, "{score}");
    }
}

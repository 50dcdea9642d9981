//! `avert_light`: the back towards a light, and not by the long way round (E-76).

use super::record::{Record, least_of, mean_of};
use super::setup::{End, Form, Setup, Start, Target};
use super::{Context, Scoring, ranges, share};
use crate::SpecError;
use serde::{Deserialize, Serialize};

/// The parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AvertLight {
    /// Length of a trial, s.
    pub seconds: f64,
    /// Of the light, m.
    pub distance: f64,
    /// Of the light in each trial, degrees; dense near the front, where it matters which way to turn.
    pub headings: Vec<f64>,
    /// How long the way that is taken is looked at, s.
    pub wrong_way_seconds: f64,
    /// What turning towards the light costs.
    pub wrong_way_weight: f64,
}

/// Headings of those who get away from a light, degrees.
pub(super) const HEADINGS: [f64; 13] =
    [0.0, 10.0, -10.0, 20.0, -20.0, 30.0, -30.0, 45.0, -45.0, 60.0, -60.0, 120.0, -120.0];

impl Default for AvertLight {
    fn default() -> Self {
        AvertLight {
            seconds: 10.0,
            distance: 5.0,
            headings: HEADINGS.to_vec(),
            wrong_way_seconds: 2.0,
            wrong_way_weight: 0.5,
        }
    }
}

impl AvertLight {
    /// The score of a mean angle to the direction away from the light, and of the smallest angle to the light
    /// at first, where the light was at `heading`, all in degrees.
    fn score_of(&self, heading: f64, away: f64, smallest: f64) -> f64 {
        let start = heading.abs();
        let averted = share(1.0 - away / (180.0 - start));
        let wrong_way = if start > 0.0 { share((start - smallest) / start) } else { 0.0 };
        let score = averted - self.wrong_way_weight * wrong_way;
        if score > 0.0 { score } else { 0.0 }
    }
}

impl Scoring for AvertLight {
    fn check(&self) -> Result<(), SpecError> {
        ranges::seconds(self.seconds)?;
        ranges::distance(self.distance)?;
        ranges::headings(
            &self.headings,
            Some((180.0, "whoever stands still would face away from the light")),
        )?;
        ranges::positive("wrong_way_seconds", self.wrong_way_seconds, self.seconds)?;
        ranges::within("wrong_way_weight", self.wrong_way_weight, 1.0)
    }

    fn trials(&self, _: &Context) -> Vec<Setup> {
        let target = |&heading| Some(Target::new(Form::Light, heading, self.distance));
        let setup = |target| Setup { seconds: self.seconds, start: Start::Rest, target, end: End::Never };
        self.headings.iter().map(target).map(setup).collect()
    }

    fn score(&self, setup: &Setup, record: &Record, _: &Context) -> f64 {
        let angle = |moment: &super::Moment| moment.light_angle.abs().to_degrees();
        let away = mean_of(record.after(self.seconds / 2.0), |moment| 180.0 - angle(moment));
        let smallest = least_of(record.until(self.wrong_way_seconds), angle);
        setup.target.map_or(0.0, |target| self.score_of(target.heading, away, smallest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::{context, lived};

    /// T-11
    #[test]
    fn turning_towards_the_light_first_costs() {
        let kind = AvertLight::default();
        for (heading, away, smallest, expected) in
            [(20.0, 16.0, 5.0, 0.525), (0.0, 18.0, 0.0, 0.9), (-20.0, 160.0, 0.0, 0.0)]
        {
            let found = kind.score_of(heading, away, smallest);
            assert!((found - expected).abs() < 1e-6, "{heading}: {found}");
        }
    }

    #[test]
    fn the_way_is_looked_at_first_and_the_angle_in_the_second_half() {
        let kind = AvertLight::default();
        let setup = kind.trials(&context())[3];
        let record = lived(10.0, |seconds, moment| {
            let angle = match seconds {
                ..0.99 => 20.0f64,
                ..1.01 => -5.0, // in the first two seconds
                ..2.01 => 9.0,
                ..4.99 => 1.0, // after them, before the second half
                _ => -164.0,
            };
            moment.light_angle = angle.to_radians();
        });
        let score = kind.score(&setup, &record, &context());
        assert!((score - 0.525).abs() < 1e-9, "{score}");
    }
}

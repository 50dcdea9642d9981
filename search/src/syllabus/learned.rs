//! What is known of the skills that were learned: the score that must not be lost, and every score since (ESP
//! E-64, E-74). It tests nothing.

use super::settings::Settings;
use creatures::Outcome;
use creatures::esp::syllabus::SkillId;
use serde::{Deserialize, Serialize};

/// One learned skill.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Learned {
    pub(super) skill: SkillId,
    /// b: its score when it was encapsulated. It never changes, so that losses cannot add up stage by stage.
    pub(super) baseline: f64,
    /// How hard the creature strikes as it is now, body weights; of skills of kind `strike` alone.
    pub(super) impact: Option<f64>,
    /// Every measurement: the number of its stage, and the score.
    pub(super) history: Vec<(u32, f64)>,
}

impl Learned {
    /// The score below which too much of it is lost, for a tolerance t: b − t·|b| (E-64).
    pub(super) fn least(&self, tolerance: f64) -> f64 {
        self.baseline - tolerance * self.baseline.abs()
    }
}

/// A measure of an outcome, by name.
pub(super) fn measure(outcome: &Outcome, name: &str) -> Option<f64> {
    outcome.measures.iter().find(|(known, _)| known == name).map(|&(_, value)| value)
}

/// The score of a tested skill, if it was tested.
pub(super) fn score(outcome: &Outcome, settings: &Settings, skill: SkillId) -> Option<f64> {
    measure(outcome, &format!("score.{}", settings.name(skill)))
}

/// The impact of a tested skill, if its kind has one.
pub(super) fn impact(outcome: &Outcome, settings: &Settings, skill: SkillId) -> Option<f64> {
    measure(outcome, &format!("impact.{}", settings.name(skill)))
}

/// Whether an outcome was stopped by the loss of an older skill, and by which of the stage's tests.
pub(super) fn stopped_by(outcome: &Outcome) -> Option<usize> {
    let index = measure(outcome, "stopped_by")?;
    (index >= 0.0).then_some(index as usize)
}

/// The scores of the trials of the last test, in order.
pub(super) fn trials(outcome: &Outcome) -> Vec<f64> {
    let scores = outcome.measures.iter().filter(|(name, _)| name.starts_with("trial."));
    scores.map(|&(_, score)| score).collect()
}

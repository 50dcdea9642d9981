//! What a syllabus costs: tests of skills, trials and steps, a skill and a population, and who was stopped by which
//! older skill (ESP E-69). It decides nothing.

use super::learned::{measure, stopped_by};
use super::settings::Settings;
use super::stage::Part;
use creatures::Outcome;
use creatures::esp::syllabus::{SkillId, Stage};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::ops::AddAssign;

/// Evaluations counted. Outcomes that were inherited cost nothing and are not.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(super) struct Counts {
    /// Tests of the skill that is learned.
    pub(super) new: u64,
    /// Tests of older skills while a new one is learned.
    pub(super) retest: u64,
    /// Tests while an older skill gets used to a body.
    pub(super) reconcile: u64,
    /// Tests of the creature that goes on.
    pub(super) measure: u64,
    pub(super) trials: u64,
    /// Physics steps.
    pub(super) steps: u64,
    /// Individuals that were stopped, by the older skill that was lost.
    pub(super) stopped: BTreeMap<SkillId, u64>,
}

impl Counts {
    /// Counts one evaluation.
    pub(super) fn add(&mut self, part: Part, stage: &Stage, outcome: &Outcome) {
        let count = |name| measure(outcome, name).map_or(0, |value| value as u64);
        let tests = count("tests");
        match part {
            Part::Phase(_) | Part::Skill => {
                let stopped = stopped_by(outcome);
                let new = u64::from(stopped.is_none()).min(tests);
                self.new += new;
                self.retest += tests - new;
                if let Some(&skill) = stopped.and_then(|index| stage.retests.get(index)) {
                    *self.stopped.entry(skill).or_default() += 1;
                }
            }
            Part::Reconcile(_) => self.reconcile += tests,
            Part::Measure => self.measure += tests,
        }
        self.trials += count("trials");
        self.steps += u64::from(outcome.steps);
    }

    /// As keys of a generation's notes.
    pub(super) fn notes(&self, settings: &Settings) -> Map<String, Value> {
        let mut notes = Map::new();
        for (kind, tests) in [
            ("new", self.new),
            ("retest", self.retest),
            ("reconcile", self.reconcile),
            ("measure", self.measure),
        ] {
            notes.insert(format!("tests_{kind}"), json!(tests));
        }
        notes.insert("trials".to_owned(), json!(self.trials));
        notes.insert("steps".to_owned(), json!(self.steps));
        for (&skill, count) in &self.stopped {
            notes.insert(format!("stopped_by.{}", settings.name(skill)), json!(count));
        }
        notes
    }
}

impl AddAssign<&Counts> for Counts {
    fn add_assign(&mut self, other: &Counts) {
        self.new += other.new;
        self.retest += other.retest;
        self.reconcile += other.reconcile;
        self.measure += other.measure;
        self.trials += other.trials;
        self.steps += other.steps;
        for (&skill, count) in &other.stopped {
            *self.stopped.entry(skill).or_default() += count;
        }
    }
}

/// The costs of every skill so far, in the order of learning, by population.
pub(super) type Ledger = Vec<(SkillId, Vec<Counts>)>;

//! A syllabus of skills: each is evolved in populations of its own on what the creature that was picked before
//! knows, and is then locked (ESP E-59..E-69, E-81..E-86). One search goes through all of them, so that a creature
//! that does the last leads back to the first in one lineage. What is true of one creature is in `creatures::esp`.

mod amend;
mod archive;
mod breeding;
mod crowd;
mod fingerprints;
mod import;
mod learned;
mod ledger;
mod lesson;
mod regime;
mod search;
mod settings;
mod stage;
mod written;

pub use amend::AmendError;
pub use fingerprints::{Change, Difference, Subject};
pub use import::Import;
pub use regime::{Regime, Reproduction, Selection};
pub use settings::{Course, KIND, LISTS, Settings};

use crate::Search;
use crate::checkpoint::{RestoreError, require};
use crate::registry::Plan;
use search::{Learning, State};
use serde_json::{Value, json};
use stage::parts;
use std::sync::Arc;

impl Settings {
    /// Every stage of the search in order: generations, and individuals of each.
    fn sizes(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let brought = !self.course.import.is_none();
        self.stages(&[]).into_iter().enumerate().flat_map(move |(index, stage)| {
            let parts = parts(self, &stage, brought && index == 0);
            parts.into_iter().map(move |part| {
                let (populations, size) = part.populations(self, stage.skill);
                (part.generations(self, stage.skill), populations * size)
            })
        })
    }
}

impl Plan for Settings {
    fn table(&self) -> Value {
        Value::Object(self.search_table())
    }

    fn lists(&self) -> Vec<(&'static str, Value)> {
        LISTS.into_iter().zip(Settings::lists(self).map(Value::Array)).collect()
    }

    /// That of the first skill under its own fitness; every stage has its own.
    fn task(&self) -> Option<Value> {
        let tests = json!([{ "skill": self.table.skill[0].id }]);
        Some(json!({ "skill": self.table.skill, "pandemonium": self.table.pandemonium, "tests": tests }))
    }

    /// Of the largest stage.
    fn population(&self) -> u32 {
        self.sizes().map(|(_, individuals)| individuals).max().unwrap_or_default()
    }

    /// Of all stages.
    fn generations(&self) -> u32 {
        self.sizes().fold(0, |sum, (generations, _)| sum.saturating_add(generations))
    }

    fn individuals(&self) -> u64 {
        self.sizes().map(|(generations, individuals)| u64::from(generations) * u64::from(individuals)).sum()
    }

    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search> {
        Box::new(Learning::new(Arc::new(self.clone()), seed, stage, State::default()))
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        let written = written::read(bytes)?;
        let differences = written.fingerprints.differences(self, &written.progress());
        let same = differences.iter().all(|difference| difference.refused.is_none());
        require(same, "what it has evolved already stands otherwise in this syllabus")?;
        let state = written.state(self)?;
        Ok(Box::new(Learning::restore(Arc::new(self.clone()), seed, stage, state)?))
    }

    fn amend(&self, checkpoint: &[u8]) -> Result<Vec<Difference>, AmendError> {
        self.differences(checkpoint)
    }
}

#[cfg(test)]
mod tests;

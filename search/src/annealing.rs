//! Simulated annealing of muscle functions by practice: independent chains, each with one candidate at a time
//! (fishes ). A generation is one step of every chain. What the functions do to a fish is
//! `creatures`' business.

mod chain;
mod schedule;

pub(crate) use chain::{Chains, Standing, State};
pub use schedule::{Cooling, Schedule};

use crate::checkpoint::{self, RestoreError};
use crate::registry::Plan;
use crate::settings::{self, read_joined, write_joined};
use crate::{Individual, Record, Search};
use creatures::fish::{Criterion, FishTask};
use creatures::{Outcome, SpecError};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Its name in experiment files.
pub const KIND: &str = "anneal";

/// The `[search]` table of kind `anneal`.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// How practice goes on.
    pub schedule: Schedule,
    /// T_k.
    pub temperature: Cooling,
    /// Steps of the task's lesson.
    lesson_steps: u32,
}

/// Keys beside those of the schedule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Table {
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<Cooling>,
}

impl Default for Table {
    fn default() -> Self {
        Table { kind: KIND.to_owned(), temperature: Some(Cooling::default()) }
    }
}

impl Settings {
    /// Reads the `[search]` table for a resolved task.
    ///
    /// # Errors
    /// A task that is no drill, an unknown key, a wrong type, a number out of range (AF-17).
    pub fn read(table: Value, task: &Value) -> Result<Settings, SpecError> {
        let FishTask::Drill(drill) = FishTask::read(task.clone())? else {
            return Err(SpecError::new("kind", "`anneal` needs a task with `scenario = \"drill\"`"));
        };
        let given = table.get("temperature").is_some();
        let (schedule, table): (Schedule, Table) = read_joined(settings::object(table)?)?;
        schedule.check()?;
        let usual = usual_temperature(&drill.lesson.objective.criterion);
        let temperature = table.temperature.filter(|_| given).unwrap_or(usual);
        temperature.check("temperature")?;
        Ok(Settings { schedule, temperature, lesson_steps: drill.lesson.steps })
    }
}

/// Temperatures for a criterion where the experiment names none: turns are judged on a scale ten times as wide
///
pub(crate) fn usual_temperature(criterion: &Criterion) -> Cooling {
    match criterion {
        Criterion::HeadingDegrees(_) => Cooling { start: 0.05, end: 0.001 },
        Criterion::Target(_) | Criterion::Speed(_) | Criterion::Path(_) => Cooling::default(),
    }
}

impl Plan for Settings {
    fn table(&self) -> Value {
        let table = Table { kind: KIND.to_owned(), temperature: Some(self.temperature) };
        Value::Object(write_joined(&table, &self.schedule))
    }

    fn population(&self) -> u32 {
        self.schedule.chains
    }

    fn generations(&self) -> u32 {
        self.schedule.steps + 1
    }

    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search> {
        let lessons = [(self.temperature, self.lesson_steps)];
        Box::new(Annealing { chains: Chains::new(&self.schedule, &lessons, seed, stage) })
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        let lessons = [(self.temperature, self.lesson_steps)];
        let mut chains = Chains::new(&self.schedule, &lessons, seed, stage);
        chains.restore(checkpoint::read(KIND, bytes)?)?;
        Ok(Box::new(Annealing { chains }))
    }
}

/// The search at work.
#[derive(Debug)]
struct Annealing {
    chains: Chains,
}

impl Search for Annealing {
    fn ask(&mut self) -> Vec<Individual> {
        self.chains.ask()
    }

    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record {
        Record { species: Vec::new(), notes: self.chains.tell(outcomes) }
    }

    fn checkpoint(&self) -> Vec<u8> {
        checkpoint::write(KIND, &self.chains.standing())
    }
}

#[cfg(test)]
mod tests;

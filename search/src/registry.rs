//! Every kind of search, by name: which system it fits, how its table is read, how it starts and goes on.
//! A new search is one line here. It runs nothing.

use crate::checkpoint::RestoreError;
use crate::syllabus::{self, AmendError, Difference};
use crate::{Search, annealing, generational, grn, learning, neat, probe};
use creatures::SpecError;
use creatures::fish::{self, FishTask, WorldTask, habits};
use creatures::flyer;
use serde_json::Value;
use std::fmt;

/// A search ready to start: its resolved settings.
pub trait Plan: fmt::Debug + Send + Sync {
    /// The `[search]` table with every default filled in.
    fn table(&self) -> Value;

    /// The lists of tables of [`Kind::lists`] with every default filled in, by their keys.
    fn lists(&self) -> Vec<(&'static str, Value)> {
        Vec::new() // most searches have `[search]` alone
    }

    /// The experiment's task, where the search knows it; none where `[task]` says it.
    fn task(&self) -> Option<Value> {
        None // most searches evolve for a task that they are given
    }

    /// Individuals a generation; those of the largest stage where stages differ.
    fn population(&self) -> u32;

    /// Generations of all stages.
    fn generations(&self) -> u32;

    /// Individuals of all generations.
    fn individuals(&self) -> u64 {
        u64::from(self.population()) * u64::from(self.generations())
    }

    /// The search at its beginning.
    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search>;

    /// The search at a checkpoint of it, with the seed and stage with which it was started.
    ///
    /// # Errors
    /// Bytes that are no checkpoint of this search.
    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError>;

    /// What differs between this plan and the one with which a checkpoint was written, if a search can go on from
    /// there with this one.
    ///
    /// # Errors
    /// A difference in what it has come to already; bytes that are no checkpoint; a kind of search that takes no
    /// differences.
    fn amend(&self, checkpoint: &[u8]) -> Result<Vec<Difference>, AmendError> {
        let _ = checkpoint; // most searches go on with what they began with
        Err(AmendError::Kind)
    }
}

/// Reads a `[search]` table for a resolved task.
type Read = fn(table: Value, task: &Value) -> Result<Box<dyn Plan>, SpecError>;

/// One kind of search.
#[derive(Debug)]
pub struct Kind {
    /// Its name: `search.kind`.
    pub name: &'static str,
    /// The system whose genotypes it varies.
    pub system: &'static str,
    /// Independent repetitions where the experiment does not say.
    pub runs: u32,
    /// Lists of tables at the top of the file that the search reads as keys beside those of its own table.
    pub lists: &'static [&'static str],
    read: Read,
}

/// Every kind.
pub static KINDS: [Kind; 8] = [
    Kind {
        name: annealing::KIND,
        system: "fish",
        runs: 1,
        lists: &[],
        read: |table, task| Ok(Box::new(annealing::Settings::read(table, task)?)),
    },
    Kind { name: generational::KIND, system: "fish", runs: 1, lists: &[], read: read_fishes },
    Kind {
        name: generational::KIND,
        system: "flyer",
        runs: 1,
        lists: &[],
        read: |table, _| Ok(Box::new(generational::Settings::<flyer::Settings>::read(table)?)),
    },
    Kind {
        name: grn::KIND,
        system: "walker",
        runs: 20,
        lists: &[],
        read: |table, task| Ok(Box::new(grn::Settings::read(table, task)?)),
    },
    Kind {
        name: learning::KIND,
        system: "fish",
        runs: 1,
        lists: &[],
        read: |table, task| Ok(Box::new(learning::Settings::read(table, task)?)),
    },
    Kind {
        name: neat::KIND,
        system: "walker",
        runs: 20,
        lists: &[],
        read: |table, task| Ok(Box::new(neat::Settings::read(table, task)?)),
    },
    Kind {
        name: probe::KIND,
        system: "probe",
        runs: 1,
        lists: &[],
        read: |table, task| Ok(Box::new(probe::Settings::read(table, task)?)),
    },
    Kind {
        name: syllabus::KIND,
        system: "esp",
        runs: 1,
        lists: &syllabus::LISTS,
        read: |table, _| Ok(Box::new(syllabus::Settings::read(table)?)),
    },
];

/// Populations of what a fish's task takes.
fn read_fishes(table: Value, task: &Value) -> Result<Box<dyn Plan>, SpecError> {
    if let Some(scenario) = WorldTask::scenario_of(task) {
        let given = table.pointer("/variation/focus").cloned();
        let mut settings = generational::Settings::<habits::variation::Settings>::read(table)?;
        if given.is_some() && settings.variation.focus != scenario {
            return Err(SpecError::new("variation.focus", "is not whose habits the task's scenario tests"));
        }
        settings.variation.focus = scenario;
        return Ok(Box::new(settings));
    }
    match FishTask::read(task.clone())? {
        FishTask::Drill(_) | FishTask::Race(_) => {
            Ok(Box::new(generational::Settings::<fish::variation::Variation>::read(table)?))
        }
        FishTask::Buoys(_) | FishTask::Learning(_) => Err(SpecError::new(
            "kind",
            "`generational` needs a task of controllers or of habits, not of sets",
        )),
    }
}

/// The kind that a `[search]` table names.
///
/// # Errors
/// No kind, an unknown one, or one that does not fit the system; each says which ones do.
pub fn kind(table: &Value, system: &str) -> Result<&'static Kind, SpecError> {
    let fitting: Vec<String> =
        KINDS.iter().filter(|kind| kind.system == system).map(|kind| format!("`{}`", kind.name)).collect();
    let fitting = fitting.join(", ");
    let name = match table.get("kind") {
        Some(Value::String(name)) => name,
        Some(other) => {
            let problem = format!("{other} is no kind of search; system `{system}` has {fitting}");
            return Err(SpecError::new("kind", problem));
        }
        None => {
            let problem = format!("is missing; system `{system}` has {fitting}");
            return Err(SpecError::new("kind", problem));
        }
    };
    let mut named = KINDS.iter().filter(|kind| kind.name == name).peekable();
    let first = named.peek().copied();
    match named.find(|kind| kind.system == system).or(first) {
        Some(kind) if kind.system == system => Ok(kind),
        Some(kind) => {
            let problem = format!("`{name}` fits system `{}`; system `{system}` has {fitting}", kind.system);
            Err(SpecError::new("kind", problem))
        }
        None => Err(SpecError::new("kind", format!("unknown variant `{name}`, expected one of {fitting}"))),
    }
}

impl Kind {
    /// Reads a `[search]` table, with the lists of [`Kind::lists`] in it, for a resolved task; the task is null
    /// where the plan says it ([`Plan::task`]).
    ///
    /// # Errors
    /// An unknown key, a wrong type or a value out of range, with the path of the key.
    pub fn plan(&self, table: Value, task: &Value) -> Result<Box<dyn Plan>, SpecError> {
        (self.read)(table, task)
    }
}

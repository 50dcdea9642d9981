//! The experiment file: TOML text into experiments ready to start, or every problem with its place in the
//! text. Keys are known or errors; nothing is ignored. It reads no file and starts nothing by itself.

mod matrix;
mod overrides;
mod problem;
mod published;
mod read;
mod tree;

pub use overrides::Overrides;
pub use problem::Problem;
pub use published::Published;

use crate::checkpoint::RestoreError;
use crate::culling::Culling;
use crate::registry::Plan;
use crate::syllabus::{AmendError, Difference};
use crate::{Place, Search, registry};
use creatures::SpecError;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// One experiment, every default filled in: a whole file, or one cell of its matrix.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// As in the file; a cell's is `file/cell`.
    pub name: String,
    /// The name of the matrix that it is a cell of.
    pub group: Option<String>,
    /// The profile that was laid over the file.
    pub profile: Option<String>,
    /// Its coordinates in the matrix: value by dotted key; empty without one.
    pub cell: BTreeMap<String, Value>,
    /// The system's name.
    pub system: String,
    /// The seed of run 1.
    pub seed: u64,
    /// Independent repetitions.
    pub runs: u32,
    /// Share of evaluations that count only once two workers found the same bits (design: determinism).
    pub audit: f64,
    task: Value,
    /// Whether the file says the task, and not the search.
    says_task: bool,
    kind: &'static registry::Kind,
    plan: Arc<dyn Plan>,
    culling: Option<Culling>,
    published: Vec<Published>,
}

/// The resolved text, in the order in which it is written.
#[derive(Serialize)]
struct Resolved<'a> {
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    group: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    profile: Option<&'a str>,
    system: &'a str,
    seed: u64,
    runs: u32,
    audit: f64,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    cell: &'a BTreeMap<String, Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    task: Option<&'a Value>,
    search: Value,
    #[serde(flatten)]
    lists: BTreeMap<&'static str, Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    culling: Option<Culling>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    published: &'a [Published],
}

/// Reads another TOML file, of one table, with the same words for what is wrong: `read` takes the values, and names
/// the key that it refuses.
///
/// # Errors
/// Every problem found, in the order of the text.
pub fn read_table<T>(text: &str, read: impl Fn(Value) -> Result<T, SpecError>) -> Result<T, Vec<Problem>> {
    read::table(text, read)
}

impl Experiment {
    /// Reads an experiment file: one experiment, or one for every cell of its `[matrix]`.
    ///
    /// # Errors
    /// Every problem found, in the order of the text; then nothing of the file is taken.
    pub fn parse(text: &str, overrides: &Overrides) -> Result<Vec<Experiment>, Vec<Problem>> {
        read::experiments(text, overrides)
    }

    /// Reads an experiment file that must make one experiment.
    ///
    /// # Errors
    /// Every problem found; a matrix is one.
    pub fn parse_one(text: &str, overrides: &Overrides) -> Result<Experiment, Vec<Problem>> {
        let mut experiments = Experiment::parse(text, overrides)?;
        match (experiments.pop(), experiments.is_empty()) {
            (Some(experiment), true) => Ok(experiment),
            _ => {
                Err(vec![Problem::new("matrix", "one experiment is wanted here, and a matrix makes several")])
            }
        }
    }

    /// Reads the text that [`Experiment::resolved`] has given.
    ///
    /// # Errors
    /// The first problem; text of an older program may have some.
    pub fn parse_resolved(text: &str) -> Result<Experiment, Problem> {
        Experiment::parse_one(text, &Overrides::default()).map_err(|problems| problems[0].clone())
    }

    /// The names of a file's profiles, for those who check them all.
    ///
    /// # Errors
    /// Text that is no TOML.
    pub fn profiles(text: &str) -> Result<Vec<String>, Vec<Problem>> {
        let tree = tree::Node::parse(text)?;
        let profiles = tree.table().and_then(|table| table.get("profile")).and_then(tree::Node::table);
        Ok(profiles.map_or(vec![], |profiles| profiles.keys().cloned().collect()))
    }

    /// Canonical TOML with every default filled in: stable order, and itself a file of the same experiment.
    pub fn resolved(&self) -> String {
        toml::to_string(&Resolved {
            name: &self.name,
            group: self.group.as_deref(),
            profile: self.profile.as_deref(),
            system: &self.system,
            seed: self.seed,
            runs: self.runs,
            audit: self.audit,
            cell: &self.cell,
            task: self.says_task.then_some(&self.task),
            search: self.plan.table(),
            lists: self.plan.lists().into_iter().collect(),
            culling: self.culling,
            published: &self.published,
        })
        .expect("tables, lists, strings and numbers within 64 bits are TOML")
    }

    /// The experiment's identity: BLAKE3 of [`Experiment::resolved`].
    pub fn digest(&self) -> [u8; 32] {
        *blake3::hash(self.resolved().as_bytes()).as_bytes()
    }

    /// The resolved task as the JSON text that travels to workers; a stage may have another
    /// ([`crate::Stage::task`]).
    pub fn task_json(&self) -> String {
        self.task.to_string()
    }

    /// Its coordinates in the matrix as a JSON object; empty without one.
    pub fn coordinates(&self) -> Value {
        Value::Object(self.cell.clone().into_iter().collect())
    }

    /// `search.kind`.
    pub fn search_kind(&self) -> &'static str {
        self.kind.name
    }

    /// The published results as a JSON list.
    pub fn published(&self) -> Value {
        serde_json::to_value(&self.published).expect("plain structs serialise")
    }

    /// The culling rule, unless culling is off.
    pub fn culling(&self) -> Option<&Culling> {
        self.culling.as_ref()
    }

    /// Whether the individual of a place is audited. Its outcome does not depend on that.
    pub fn audits(&self, seed: u64, place: Place) -> bool {
        self.audit > 0.0 && place.stream(seed, "audit").chance(self.audit)
    }

    /// What the system's interim measure is called in an outcome of a task; see [`Culling::cutoff`].
    pub fn interim_measure(&self, task: &Value) -> &'static str {
        creatures::system(&self.system).map_or("fitness", |system| system.interim_measure(task))
    }

    /// The seed of a run, from 1: run i is an experiment of its own with `seed + i − 1`.
    pub fn seed_of(&self, run: u32) -> u64 {
        self.seed + u64::from(run.max(1) - 1)
    }

    /// The resolved task: of every stage that has none of its own ([`crate::Stage::task`]).
    pub fn task(&self) -> &Value {
        &self.task
    }

    /// The search of a run, from 1, at its beginning. Its stages count from 0.
    pub fn start(&self, run: u32) -> Box<dyn Search> {
        self.plan.start(self.seed_of(run), 0)
    }

    /// The search of a run at a checkpoint of it.
    ///
    /// # Errors
    /// Bytes that are no checkpoint of this search.
    pub fn restore(&self, run: u32, checkpoint: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        self.plan.restore(self.seed_of(run), 0, checkpoint)
    }

    /// What differs between this experiment and the one whose search wrote a checkpoint, if [`Experiment::restore`]
    /// can go on from there with this one (ESP E-86); empty if nothing does.
    ///
    /// # Errors
    /// A difference in what was evolved already, bytes that are no checkpoint, a kind of search that takes no
    /// differences.
    pub fn amend(&self, checkpoint: &[u8]) -> Result<Vec<Difference>, AmendError> {
        self.plan.amend(checkpoint)
    }

    /// Generations of a run, those of all its stages, when known beforehand.
    pub fn generations(&self) -> Option<u32> {
        Some(self.plan.generations())
    }

    /// Individuals of a generation, of the largest stage where they differ, when known beforehand.
    pub fn population(&self) -> Option<u32> {
        Some(self.plan.population())
    }

    /// Individuals in all runs, when known beforehand.
    pub fn planned(&self) -> Option<u64> {
        self.plan.individuals().checked_mul(u64::from(self.runs))
    }
}

#[cfg(test)]
mod tests;

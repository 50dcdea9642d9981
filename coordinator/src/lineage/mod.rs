//! The lineage: every individual, its parents, its outcome and where it came from, in one SQLite file that
//! people open while it is written. One writer, many readers. It decides nothing about evolution, opens no
//! genotype, and waits on no reader.

mod entry;
mod error;
mod id;
mod reader;

pub use entry::{
    Attempt, CloseGeneration, Culling, Ending, Evaluated, Event, Fate, Joined, NewExperiment, NewStage,
    OpenGeneration, Ruling, SetAside, State,
};
pub use error::{OpenError, QueryError, ReadError, WriteError};
pub use id::{ExperimentId, IndividualId, StageId};
pub use reader::{Reader, ResumePoint, Standing, StoredExperiment, StoredStage};

use std::path::Path;
use tokio::sync::watch;

/// Whether what is recorded reaches the disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Health {
    /// It does.
    Good,
    /// It does not, and why. What is queued is kept and tried again, unless the file is damaged.
    Stuck {
        /// In words for people.
        reason: String,
    },
}

/// The lineage of one coordinator: the one writer of its file. Clones share it.
#[derive(Clone)]
pub struct Lineage {
    reader: Reader,
}

impl Lineage {
    /// Opens a lineage for writing: creates it, or brings its schema up to date. Nobody else can open it so
    /// until [`Lineage::close`] or the end of the process; readers may, at any time.
    ///
    /// # Errors
    /// See [`OpenError`]. A file of a newer schema, or no lineage at all, is left untouched.
    pub async fn open(path: &Path) -> Result<Lineage, OpenError> {
        let _ = path;
        unimplemented!()
    }

    /// Drawn when the file was created; workers that come back use it to tell lineages apart.
    pub fn identity(&self) -> [u8; 16] {
        unimplemented!()
    }

    /// Reads what is committed.
    pub fn reader(&self) -> &Reader {
        &self.reader
    }

    /// Whether what is recorded reaches the disk.
    pub fn health(&self) -> watch::Receiver<Health> {
        unimplemented!()
    }

    /// Writes experiments down as running, all or none, and gives their numbers in order.
    ///
    /// # Errors
    /// See [`WriteError`], here and below.
    pub async fn create(&self, experiments: Vec<NewExperiment>) -> Result<Vec<ExperimentId>, WriteError> {
        let _ = experiments;
        unimplemented!()
    }

    /// Begins a stage of a run.
    pub async fn open_stage(&self, stage: NewStage) -> Result<StageId, WriteError> {
        let _ = stage;
        unimplemented!()
    }

    /// Ends the previous generation of a stage and begins the next, in one transaction with everything
    /// recorded so far. Returns when that is on disk, with the ids of the individuals in order of index.
    pub async fn open_generation(&self, generation: OpenGeneration) -> Result<Vec<IndividualId>, WriteError> {
        let _ = generation;
        unimplemented!()
    }

    /// Ends the last generation of a stage, and with it the stage.
    pub async fn close_stage(
        &self,
        stage: StageId,
        close: CloseGeneration,
        checkpoint: Vec<u8>,
    ) -> Result<(), WriteError> {
        let _ = (stage, close, checkpoint);
        unimplemented!()
    }

    /// Takes note of outcomes; they reach the disk soon, in batches, in the order recorded. Waits only while
    /// too many of them are on their way. The first ending of an individual stands: a second one changes
    /// nothing.
    pub async fn record(&self, evaluated: Vec<Evaluated>) -> Result<(), WriteError> {
        let _ = evaluated;
        unimplemented!()
    }

    /// Returns when everything recorded before is on disk.
    pub async fn flush(&self) -> Result<(), WriteError> {
        unimplemented!()
    }

    /// Sets what an experiment is up to, and why; the reason may be empty.
    pub async fn set_state(
        &self,
        experiment: ExperimentId,
        state: State,
        reason: String,
    ) -> Result<(), WriteError> {
        let _ = (experiment, state, reason);
        unimplemented!()
    }

    /// Writes an event down, soon.
    pub async fn event(&self, event: Event) -> Result<(), WriteError> {
        let _ = event;
        unimplemented!()
    }

    /// A worker attached: from now on its name in attempts means this one.
    pub async fn worker_joined(&self, worker: Joined) -> Result<(), WriteError> {
        let _ = worker;
        unimplemented!()
    }

    /// A worker went away, and why.
    pub async fn worker_left(&self, name: String, reason: String) -> Result<(), WriteError> {
        let _ = (name, reason);
        unimplemented!()
    }

    /// Commits everything recorded, tidies the file up and gives it free. Other clones find it closed.
    pub async fn close(self) {
        unimplemented!()
    }
}

/// The seed of an individual's evaluation: keyed by its place in its run, so that nobody stores it.
pub fn evaluation_seed(run_seed: u64, place: search::Place) -> u64 {
    let mut bytes = [0; 8];
    place.stream(run_seed, "evaluation").fill(&mut bytes);
    u64::from_le_bytes(bytes)
}

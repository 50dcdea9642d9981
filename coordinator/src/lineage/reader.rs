//! Reading what is committed, beside the writer or without one. It never writes and never waits for a writer.

use super::{ExperimentId, IndividualId, OpenError, ReadError, SetAside, StageId, State};
use creatures::Outcome;
use std::path::Path;

/// A reader of a lineage. Clones share its connections.
#[derive(Clone)]
pub struct Reader {}

/// An experiment as it stands in the lineage, with all that is needed to take it up again.
#[derive(Debug, Clone)]
pub struct StoredExperiment {
    /// Its number.
    pub id: ExperimentId,
    /// Its name, unique.
    pub name: String,
    /// The matrix that it is a cell of.
    pub group: Option<String>,
    /// Its matrix coordinates: a JSON object.
    pub cell: serde_json::Value,
    /// The system's name.
    pub system: String,
    /// The system's version.
    pub system_version: u32,
    /// The kind of its search.
    pub search_kind: String,
    /// The seed of run 1.
    pub seed: u64,
    /// Independent repetitions.
    pub runs: u32,
    /// JSON text of the resolved task.
    pub task_json: String,
    /// The resolved file.
    pub resolved: String,
    /// BLAKE3 of the resolved file.
    pub digest: [u8; 32],
    /// Published results to compare with.
    pub published: serde_json::Value,
    /// The physics fingerprint under which it began.
    pub fingerprint: [u8; 32],
    /// What it is up to.
    pub state: State,
    /// Why; may be empty.
    pub reason: String,
    /// Unix time, ms.
    pub created_ms: i64,
    /// Unix time, ms.
    pub ended_ms: Option<i64>,
    /// Individuals in all, when the search knows.
    pub planned: Option<u64>,
    /// In order of run and stage.
    pub stages: Vec<StoredStage>,
}

/// A stage as it stands in the lineage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredStage {
    /// Its row.
    pub id: StageId,
    /// Which repetition, from 1.
    pub run: u32,
    /// Which stage of the run, from 0.
    pub stage: u32,
    /// Its name.
    pub name: String,
    /// How many generations it takes, when known.
    pub generations: Option<u32>,
    /// True once its last generation has ended.
    pub ended: bool,
}

/// Where a stage goes on: its open generation.
#[derive(Debug, Clone)]
pub struct ResumePoint {
    /// Its number.
    pub generation: u32,
    /// The search's state before it asked for this generation.
    pub checkpoint: Vec<u8>,
    /// The culling rule of this generation.
    pub culling: Option<super::Culling>,
    /// In order of index.
    pub individuals: Vec<Standing>,
    /// The previous generation of the stage, in order of index; empty for the first.
    pub previous: Vec<Standing>,
}

/// How one individual stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// Its id.
    pub id: IndividualId,
    /// Its index in its generation.
    pub index: u32,
    /// BLAKE3 of its genotype.
    pub digest: [u8; 32],
    /// What became of it; `None` while pending.
    pub ending: Option<Result<Outcome, SetAside>>,
}

impl Reader {
    /// Opens a lineage for reading alone, also while another process writes it.
    ///
    /// # Errors
    /// As [`super::Lineage::open`], but for who holds it: that does not matter here.
    pub async fn open(path: &Path) -> Result<Reader, OpenError> {
        let _ = path;
        unimplemented!()
    }

    /// Every experiment that is running or paused, in order of number.
    ///
    /// # Errors
    /// See [`ReadError`], here and below.
    pub async fn unfinished(&self) -> Result<Vec<StoredExperiment>, ReadError> {
        unimplemented!()
    }

    /// One experiment.
    pub async fn experiment(&self, id: ExperimentId) -> Result<StoredExperiment, ReadError> {
        let _ = id;
        unimplemented!()
    }

    /// What a reference names: `last`, a number, or a name; the name of a matrix names its cells.
    pub async fn find(&self, reference: &str) -> Result<Vec<ExperimentId>, ReadError> {
        let _ = reference;
        unimplemented!()
    }

    /// The latest unfinished experiment of a resolved file.
    pub async fn find_unfinished(&self, digest: &[u8; 32]) -> Result<Option<ExperimentId>, ReadError> {
        let _ = digest;
        unimplemented!()
    }

    /// Where a stage goes on; `None` when it has no generation yet, or has ended.
    pub async fn resume_point(&self, stage: StageId) -> Result<Option<ResumePoint>, ReadError> {
        let _ = stage;
        unimplemented!()
    }

    /// The latest checkpoint of a stage: of one that has ended, its end.
    pub async fn checkpoint(&self, stage: StageId) -> Result<Option<Vec<u8>>, ReadError> {
        let _ = stage;
        unimplemented!()
    }
}

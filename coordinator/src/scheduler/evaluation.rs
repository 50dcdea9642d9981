//! What the scheduler is asked for and what it gives back: evaluations, reports on attempts at them, and how
//! they were settled. It opens no genotype.

use crate::lineage::{Attempt, Audited, Ruling, SetAside};
use bytes::Bytes;
use creatures::{Cull, Interim, Outcome};
use proto::convert::{TaskHash, task_hash};
use std::sync::Arc;

/// A task as it travels to workers, shared by all evaluations of an experiment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskText {
    /// The system's name.
    pub system: String,
    /// The system's version.
    pub version: u32,
    /// JSON text of the resolved `[task]` table.
    pub spec: String,
    /// Its name on the wire.
    pub hash: TaskHash,
}

impl TaskText {
    /// A task under its hash.
    pub fn new(system: &str, version: u32, spec: &str) -> TaskText {
        let hash = task_hash(system, version, spec);
        TaskText { system: system.to_owned(), version, spec: spec.to_owned(), hash }
    }
}

/// One genotype to evaluate.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// Its name, unique among all that is under evaluation: the individual's id in the lineage, or for a
    /// bare evaluation a number from [`Evaluation::BARE`] on.
    pub id: u64,
    /// What goes first within its queue: (run, generation, index).
    pub order: (u32, u32, u32),
    /// What the creature has to do.
    pub task: Arc<TaskText>,
    /// The payload; system and version are the task's.
    pub genotype: Bytes,
    /// The evaluation's seed.
    pub seed: u64,
    /// The culling rule, if there is one.
    pub cull: Option<Cull>,
    /// Its outcome counts only once another worker finds the same.
    pub audit: bool,
    /// Attempts made at it before, which were taken back: numbers go on after them.
    pub attempts_before: u32,
}

impl Evaluation {
    /// The first id of those that no individual has: SQLite's ids are positive signed numbers.
    pub const BARE: u64 = 1 << 63;
}

/// Which attempt at which evaluation. Attempts are numbered from 1 within their evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AttemptId {
    /// The evaluation.
    pub evaluation: u64,
    /// The number of the attempt at it.
    pub number: u32,
}

/// What a worker tells of one attempt.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Which one.
    pub attempt: AttemptId,
    /// Spent on it so far; finite and not negative. For statistics and fair shares alone.
    pub seconds: f64,
    /// What happened.
    pub news: News,
}

/// What happened to an attempt.
#[derive(Debug, Clone, PartialEq)]
pub enum News {
    /// It goes on, past its interim report.
    Interim(Interim),
    /// It has ended with an outcome.
    Outcome(Outcome),
    /// It has ended without one.
    Failure {
        /// In the worker's words.
        reason: String,
        /// The same on every worker, so that another attempt is in vain.
        lasting: bool,
    },
}

/// An evaluation that is over. Each one that was submitted is settled once, unless it is cancelled first.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// Which one.
    pub id: u64,
    /// What came of it.
    pub result: Result<Outcome, SetAside>,
    /// The ruling on its interim report, if one was asked for and reached.
    pub ruling: Option<Ruling>,
    /// What came of its audit, if it was chosen for one.
    pub audit: Option<Audited>,
    /// Physics steps that it would have lived on, had it not been culled: by the rule's share of the task.
    pub steps_spared: u64,
    /// The attempts at it by number, the last [`super::ATTEMPTS_KEPT`] of them at least.
    pub attempts: Vec<Attempt>,
}

/// Two attempts at one evaluation gave different bits: one of the workers cannot be trusted (walker X-18).
#[derive(Debug, Clone, PartialEq)]
pub struct Conflict {
    /// Which evaluation.
    pub id: u64,
    /// What it was settled with, and by which worker.
    pub first: (Outcome, String),
    /// What came later, and from which worker.
    pub second: (Outcome, String),
}

/// An attempt handed to a worker.
#[derive(Debug, Clone)]
pub struct Assignment {
    /// What reports on it must name.
    pub number: u32,
    /// What to do.
    pub evaluation: Evaluation,
}

//! What is written into the lineage, as the driver knows it. It holds no ids that the lineage has yet to
//! give, and nothing of SQL.

use super::{ExperimentId, IndividualId, StageId};
use creatures::{Outcome, Verdict};
use search::{PickedBy, Place};

/// An experiment as it was submitted: one cell of a matrix, or the whole file.
#[derive(Debug, Clone)]
pub struct NewExperiment {
    /// The resolved name, of a cell `matrix/cell`. A name that is taken gets `-2`, `-3`, … appended.
    pub name: String,
    /// The matrix that it is a cell of. Cells of one call to `create` stay together under one name.
    pub group: Option<String>,
    /// Its matrix coordinates: a JSON object, empty without a matrix.
    pub cell: serde_json::Value,
    /// The system's name.
    pub system: String,
    /// The system's version: outcomes of different versions are never mixed.
    pub system_version: u32,
    /// The kind of its search: `grn`, `neat`, …
    pub search_kind: String,
    /// The seed of run 1; run i has `seed + i − 1`.
    pub seed: u64,
    /// Independent repetitions.
    pub runs: u32,
    /// JSON text of the resolved `[task]` table: what travels to workers.
    pub task_json: String,
    /// The resolved file: what the seed and the hash refer to.
    pub resolved: String,
    /// BLAKE3 of the resolved file: the experiment's identity.
    pub digest: [u8; 32],
    /// Published results to compare with, as JSON.
    pub published: serde_json::Value,
    /// The program that took it.
    pub program_version: String,
    /// The physics fingerprint under which it began (design: determinism).
    pub fingerprint: [u8; 32],
    /// Individuals in all its runs, when the search knows.
    pub planned: Option<u64>,
    /// Whose first stages are its own as well; `None` for one that begins at the beginning.
    pub origin: Option<Origin>,
}

/// Where a fork leaves the experiment that it comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Which holds the stage.
    pub experiment: ExperimentId,
    /// The last stage that both have. Who goes on from its end is chosen anew.
    pub stage: u32,
}

/// What an experiment is up to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Evaluations are handed out.
    Running,
    /// Nothing is handed out until someone resumes it.
    Paused,
    /// Nothing is handed out until someone picks who goes on.
    Awaiting,
    /// Every run has ended.
    Finished,
    /// Ended by hand, for good.
    Cancelled,
    /// Ended by an error that time does not mend.
    Failed,
}

impl State {
    /// Every state.
    pub const ALL: [State; 6] =
        [State::Running, State::Paused, State::Awaiting, State::Finished, State::Cancelled, State::Failed];

    /// Its word in the lineage and on the wire.
    pub fn word(self) -> &'static str {
        match self {
            State::Running => "running",
            State::Paused => "paused",
            State::Awaiting => "awaiting",
            State::Finished => "finished",
            State::Cancelled => "cancelled",
            State::Failed => "failed",
        }
    }

    /// True of states from which it can still go on.
    pub fn is_unfinished(self) -> bool {
        matches!(self, State::Running | State::Paused | State::Awaiting)
    }
}

/// One search within a run.
#[derive(Debug, Clone)]
pub struct NewStage {
    /// The experiment that it belongs to.
    pub experiment: ExperimentId,
    /// Which repetition, from 1.
    pub run: u32,
    /// Which stage of the run, from 0.
    pub stage: u32,
    /// What the experiment file calls it; empty where there is one stage alone.
    pub name: String,
    /// The seed of the run: keys every stream of the stage.
    pub seed: u64,
    /// How many generations it takes, when known.
    pub generations: Option<u32>,
    /// JSON text of the resolved task of its evaluations; `None` for the experiment's.
    pub task_json: Option<String>,
}

/// The stage of a generation that is opened.
#[derive(Debug, Clone)]
pub enum InStage {
    /// One that stands already, and its number in its run.
    Open(StageId, u32),
    /// One that begins with it.
    New(NewStage),
}

/// The next generation of a run, and the end of what was before: one transaction.
#[derive(Debug, Clone)]
pub struct OpenGeneration {
    /// Its stage.
    pub stage: InStage,
    /// Its number, from 1: one more than the last.
    pub generation: u32,
    /// The search's state before it asked for these individuals.
    pub checkpoint: Vec<u8>,
    /// The culling rule of its evaluations; `None` without culling.
    pub culling: Option<Culling>,
    /// In order of index.
    pub individuals: Vec<search::Individual>,
    /// What the search said of the previous generation of its stage; `None` for the first.
    pub close: Option<CloseGeneration>,
    /// The stage that ends with it; `None` while one goes on, or where it has ended before.
    pub ends: Option<EndStage>,
    /// Who goes on from the end of a stage; `None` while one goes on, or where that stands already.
    pub choice: Option<NewChoice>,
}

/// The end of a stage.
#[derive(Debug, Clone)]
pub struct EndStage {
    /// Which.
    pub stage: StageId,
    /// What the search said of its last generation.
    pub close: CloseGeneration,
    /// The search's state after that.
    pub checkpoint: Vec<u8>,
    /// Whether the run has ended with it.
    pub over: bool,
}

/// Who may go on from the end of a stage.
#[derive(Debug, Clone)]
pub struct NewChoice {
    /// Whose choice it is: of a fork, not the stage's own.
    pub experiment: ExperimentId,
    /// At whose end.
    pub stage: StageId,
    /// Best first.
    pub candidates: Vec<search::Candidate>,
    /// Who does, unless somebody has yet to pick.
    pub picked: Option<Place>,
}

/// A changed file for an experiment that goes on with it.
#[derive(Debug, Clone)]
pub struct Amendment {
    /// Which.
    pub experiment: ExperimentId,
    /// The resolved file.
    pub resolved: String,
    /// BLAKE3 of the resolved file.
    pub digest: [u8; 32],
    /// JSON text of the resolved task of stages without one of their own.
    pub task_json: String,
    /// Individuals in all its runs, when the search knows.
    pub planned: Option<u64>,
    /// What differs, for those who read events: a JSON object.
    pub data: serde_json::Value,
}

/// Somebody's pick.
#[derive(Debug, Clone)]
pub struct NewPick {
    /// Of which experiment.
    pub experiment: ExperimentId,
    /// At the end of which stage.
    pub stage: StageId,
    /// One of the candidates.
    pub individual: IndividualId,
    /// Who picked.
    pub by: PickedBy,
    /// Why, in words; may be empty.
    pub note: String,
}

/// The culling rule of a generation (design: culling).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Culling {
    /// The share of the task's steps after which the interim report is made.
    pub at: f64,
    /// Measures below this are culled; none in a first generation.
    pub cutoff: Option<f64>,
}

/// The end of a generation. Its counts, best, mean and worst are taken from the outcomes on file: set-aside,
/// culled and aborted individuals count as fitness 0, as they did for the search.
#[derive(Debug, Clone)]
pub struct CloseGeneration {
    /// What the search said of it.
    pub record: search::Record,
    /// From its opening to its end on the wall, for statistics alone.
    pub wall_seconds: f64,
}

/// What became of one individual.
#[derive(Debug, Clone)]
pub struct Evaluated {
    /// Whose.
    pub individual: IndividualId,
    /// How it ended.
    pub ending: Ending,
    /// The ruling on its interim report, if there was one.
    pub ruling: Option<Ruling>,
    /// What came of its audit, if it was chosen for one.
    pub audit: Option<Audited>,
    /// Every attempt. At most one is [`Fate::Counted`].
    pub attempts: Vec<Attempt>,
}

/// An individual whose outcome was taken back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Retracted {
    /// Who is pending again.
    pub individual: IndividualId,
    /// Attempts made so far: numbers go on after them.
    pub attempts: u32,
}

/// How an individual came to its outcome.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// It was evaluated, or the service gave up on it.
    Settled(Result<Outcome, SetAside>),
    /// It takes over the outcome of an equal genotype, whose own ending must have been recorded before.
    Inherits(IndividualId),
}

/// Why the service gave up on an individual (design: a genotype that kills three workers).
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("set aside: {reason}")]
pub struct SetAside {
    /// In a few words.
    pub reason: String,
}

/// What the coordinator said of an interim report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ruling {
    /// Physics steps simulated by then.
    pub step: u32,
    /// The interim measure.
    pub measure: f64,
    /// What it was compared with: the generation's cutoff.
    pub cutoff: Option<f64>,
    /// What followed.
    pub verdict: Verdict,
}

/// One attempt to evaluate an individual.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Counts up from 1 within an individual.
    pub number: u32,
    /// The name of the worker.
    pub worker: String,
    /// What became of it.
    pub fate: Fate,
    /// Physics steps simulated, as far as reported.
    pub steps: u64,
    /// Spent on it, as far as reported; for statistics alone.
    pub seconds: f64,
}

/// What became of an attempt.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fate {
    /// Its outcome is the individual's.
    Counted,
    /// Another attempt was first.
    Duplicate,
    /// It gave the same bits as the one that counted, which an audit asked for.
    Confirmed,
    /// It gave other bits than two others.
    Refuted,
    /// Its worker went away, or fell silent.
    Lost(String),
    /// Its worker reported that it could not be done.
    Failed(String),
}

impl Fate {
    /// As in the lineage: `counted`, `duplicate`, `confirmed`, `refuted`, `lost:REASON`, `failed:REASON`.
    pub fn word(&self) -> String {
        match self {
            Fate::Counted => "counted".to_owned(),
            Fate::Duplicate => "duplicate".to_owned(),
            Fate::Confirmed => "confirmed".to_owned(),
            Fate::Refuted => "refuted".to_owned(),
            Fate::Lost(reason) => format!("lost:{reason}"),
            Fate::Failed(reason) => format!("failed:{reason}"),
        }
    }
}

/// What came of the audit of an evaluation that was chosen for one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Audited {
    /// Two workers found the same bits.
    Agreed,
    /// Nobody was there to find them again, so one worker's word counts.
    Skipped,
}

impl Audited {
    /// As in the lineage.
    pub fn word(self) -> &'static str {
        match self {
            Audited::Agreed => "agreed",
            Audited::Skipped => "skipped",
        }
    }
}

/// A worker that attached.
#[derive(Debug, Clone)]
pub struct Joined {
    /// Unique in the fleet while it is attached.
    pub name: String,
    /// Its machine.
    pub host: String,
    /// What it runs at once.
    pub slots: u32,
    /// Of its program.
    pub version: String,
    /// Of its physics.
    pub fingerprint: [u8; 32],
}

/// Something that happened and that a reader of the lineage should know.
#[derive(Debug, Clone)]
pub struct Event {
    /// The experiment that it concerns; `None` for the service.
    pub experiment: Option<ExperimentId>,
    /// One word or two, the same for every event of a kind: `conflict`, `state`.
    pub kind: String,
    /// A sentence.
    pub text: String,
    /// Particulars: a JSON object.
    pub data: serde_json::Value,
}

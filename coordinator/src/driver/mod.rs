//! The driver: the order of effects between search, lineage and fleet. A generation's end is on disk before
//! the next one is handed out. It knows no genotype, no SQL and no stream.

mod ahead;
mod amend;
mod conduct;
mod fork;
mod generation;
mod pick;
mod progress;
mod redo;
mod restore;
mod run;
mod submit;

pub use amend::{AmendError, Changed, amend_at_rest};
pub use fork::{Fork, ForkError, fork_at_rest};
pub use pick::{PickError, pick_at_rest};
pub use progress::{Counts, Ended, Happening, Progress, RunProgress, Tally};
pub use submit::{Submission, SubmitError};

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::{broadcast, mpsc, watch};
use tokio::task::JoinHandle;
use tracing::Instrument as _;

use crate::fleet::{Fleet, QueueControl};
use crate::lineage::{ExperimentId, Health, Lineage, ReadError, State, StoredExperiment, WriteError};

/// Why the experiments of a lineage cannot be taken up.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// It cannot be read.
    #[error("the lineage cannot be read")]
    Read(#[from] ReadError),
    /// It cannot be written.
    #[error("the lineage cannot be written")]
    Write(#[from] WriteError),
}

/// Why an experiment was not paused, resumed or cancelled.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// It has ended already.
    #[error("experiment {0} is {word}", word = .1.word())]
    Ended(ExperimentId, State),
    /// It was begun by other physics and cannot go on in this program.
    #[error("experiment {0}: {1}")]
    Incompatible(ExperimentId, String),
    /// The lineage could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The lineage could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The experiments of one coordinator. Clones share them.
#[derive(Clone)]
pub struct Driver {
    shared: Arc<Shared>,
}

struct Shared {
    lineage: Lineage,
    fleet: Fleet,
    fingerprint: [u8; 32],
    active: Mutex<BTreeMap<ExperimentId, Active>>,
    /// What was taken up when this coordinator started, by the digest of its file: it may end before somebody
    /// asks to go on with it.
    taken_up: Mutex<BTreeMap<[u8; 32], ExperimentId>>,
    /// Held by who picks, and by an experiment that comes to rest for want of a pick.
    picking: Arc<tokio::sync::Mutex<()>>,
    happenings: broadcast::Sender<Happening>,
    stopping: watch::Sender<bool>,
}

/// An experiment that is being conducted.
struct Active {
    name: String,
    control: QueueControl,
    progress: Arc<Progress>,
    picks: mpsc::UnboundedSender<conduct::Pick>,
    conducting: JoinHandle<()>,
}

impl std::fmt::Debug for Driver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Driver").finish_non_exhaustive()
    }
}

impl Driver {
    /// Takes up every experiment that is running or paused in the lineage.
    ///
    /// # Errors
    /// A lineage that cannot be read or written. An experiment that cannot go on (other physics, a
    /// checkpoint that does not fit) is no error here: it is paused or failed with its reason.
    pub async fn start(lineage: Lineage, fleet: Fleet, fingerprint: [u8; 32]) -> Result<Driver, ResumeError> {
        let driver = Driver {
            shared: Arc::new(Shared {
                lineage,
                fleet,
                fingerprint,
                active: Mutex::default(),
                taken_up: Mutex::default(),
                picking: Arc::default(),
                happenings: broadcast::channel(4096).0,
                stopping: watch::channel(false).0,
            }),
        };
        for stored in driver.shared.lineage.reader().unfinished().await? {
            if stored.state == State::Running {
                driver.taken_up().insert(stored.digest, stored.id);
                driver.take_up(stored).await?;
            }
        }
        Ok(driver)
    }

    /// What happens from now on. A listener that falls behind loses the oldest happenings.
    pub fn happenings(&self) -> broadcast::Receiver<Happening> {
        self.shared.happenings.subscribe()
    }

    /// The progress of an experiment that is being conducted; none for one at rest.
    pub fn progress(&self, id: ExperimentId) -> Option<Arc<Progress>> {
        self.active().get(&id).map(|active| active.progress.clone())
    }

    /// The experiments that are being conducted, by number, with their names.
    pub(crate) fn conducted(&self) -> Vec<(ExperimentId, String, Arc<Progress>)> {
        let active = self.active();
        active.iter().map(|(&id, one)| (id, one.name.clone(), one.progress.clone())).collect()
    }

    /// Hands out nothing more of an experiment; what runs is finished and recorded.
    ///
    /// # Errors
    /// One that has ended; a lineage that fails.
    pub async fn pause(&self, id: ExperimentId) -> Result<(), ControlError> {
        let stored = self.shared.lineage.reader().experiment(id).await?;
        if !changes(&stored, State::Paused)? {
            return Ok(());
        }
        let control = self.active().get(&id).map(|active| active.control.clone());
        if let Some(control) = control {
            control.pause().await;
        }
        self.settle_state(id, State::Paused, by_hand(State::Paused)).await?;
        Ok(())
    }

    /// Goes on with a paused experiment. One that waits for a pick goes on waiting.
    ///
    /// # Errors
    /// One that has ended, or was begun by other physics; a lineage that fails.
    pub async fn resume(&self, id: ExperimentId) -> Result<(), ControlError> {
        let stored = self.shared.lineage.reader().experiment(id).await?;
        if !changes(&stored, State::Running)? {
            return Ok(());
        }
        if let Some(reason) = incompatible(&stored, &self.shared.fingerprint) {
            return Err(ControlError::Incompatible(id, reason));
        }
        let control = self.active().get(&id).map(|active| active.control.clone());
        self.settle_state(id, State::Running, by_hand(State::Running)).await?;
        match control {
            Some(control) => control.resume().await,
            None => self.take_up(StoredExperiment { state: State::Running, ..stored }).await?,
        }
        Ok(())
    }

    /// Ends an experiment for good; what was evaluated stays in the lineage.
    ///
    /// # Errors
    /// One that has ended already; a lineage that fails.
    pub async fn cancel(&self, id: ExperimentId) -> Result<(), ControlError> {
        changes(&self.shared.lineage.reader().experiment(id).await?, State::Cancelled)?;
        let active = self.active().remove(&id);
        if let Some(active) = active {
            active.control.cancel().await;
            ended(active.conducting).await;
            let state = self.shared.lineage.reader().experiment(id).await?.state;
            if !state.is_unfinished() {
                return Err(ControlError::Ended(id, state)); // meanwhile, by itself
            }
        }
        self.settle_state(id, State::Cancelled, by_hand(State::Cancelled)).await?;
        Ok(())
    }

    /// Why nothing moves, when something holds up a running experiment; empty otherwise.
    pub fn held_up(&self) -> String {
        if let Health::Stuck { reason } = &*self.shared.lineage.health().borrow() {
            return format!("the lineage cannot be written: {reason}");
        }
        self.shared.fleet.obstacle()
    }

    /// The lineage, to read from.
    pub fn lineage(&self) -> &Lineage {
        &self.shared.lineage
    }

    /// The fleet.
    pub fn fleet(&self) -> &Fleet {
        &self.shared.fleet
    }

    /// Stops handing out and waits until what has arrived is on disk. Experiments stay as they are in the
    /// lineage.
    pub async fn stop(&self) {
        self.shared.stopping.send_replace(true);
        let active = std::mem::take(&mut *self.active());
        for (_, active) in active {
            active.control.pause().await;
            ended(active.conducting).await;
        }
        let flush = self.shared.lineage.flush();
        if !matches!(tokio::time::timeout(std::time::Duration::from_secs(10), flush).await, Ok(Ok(()))) {
            tracing::warn!("the last outcomes could not be committed; they will be evaluated again");
        }
    }

    /// Conducts an experiment of the lineage from where it stands.
    async fn take_up(&self, stored: StoredExperiment) -> Result<(), WriteError> {
        let id = stored.id;
        if let Some(reason) = incompatible(&stored, &self.shared.fingerprint) {
            tracing::warn!(experiment = %id, reason, "not taken up");
            self.settle_state(id, State::Paused, &reason).await?;
            return Ok(());
        }
        let experiment = match search::Experiment::parse_resolved(&stored.resolved) {
            Ok(experiment) => experiment,
            Err(problem) => {
                let reason = format!("its resolved file is not understood: {problem}");
                self.settle_state(id, State::Failed, &reason).await?;
                return Ok(());
            }
        };
        let queue = self.shared.fleet.queue(stored.name.clone(), 1).await;
        let control = queue.0.control();
        let progress = Arc::new(Progress::new(&experiment, self.evaluated(&stored).await));
        let (picks, made) = mpsc::unbounded_channel();
        // Its end takes it out again: it must be in by then.
        let mut active = self.active();
        let name = stored.name.clone();
        let span = tracing::info_span!("experiment", id = id.0, name);
        let conduct = conduct::conduct(self.clone(), stored, experiment, queue, progress.clone(), made);
        let conducting = tokio::spawn(conduct.instrument(span));
        active.insert(id, Active { name, control, progress, picks, conducting });
        Ok(())
    }

    /// How many of an experiment have an outcome on disk. For those who watch alone: without an answer it goes on
    /// as well.
    async fn evaluated(&self, stored: &StoredExperiment) -> u64 {
        if stored.stages.is_empty() {
            return 0;
        }
        let summaries = self.shared.lineage.reader().summaries(Some(&[stored.id])).await;
        summaries.ok().and_then(|summaries| summaries.first().map(|of| of.evaluated)).unwrap_or(0)
    }

    /// Writes down how conducting ended. One that was paused meanwhile stays so if it waits for a pick.
    async fn rest(&self, id: ExperimentId, state: State, reason: &str) -> Result<(), WriteError> {
        if state == State::Awaiting {
            let stored = self.shared.lineage.reader().experiment(id).await;
            if stored.is_ok_and(|stored| stored.state != State::Running) {
                return Ok(());
            }
        }
        self.settle_state(id, state, reason).await
    }

    /// Writes a state down and tells the watchers.
    async fn settle_state(&self, id: ExperimentId, state: State, reason: &str) -> Result<(), WriteError> {
        self.shared.lineage.set_state(id, state, reason.to_owned()).await?;
        self.tell(id);
        Ok(())
    }

    /// Tells the watchers that an experiment has another state.
    fn tell(&self, id: ExperimentId) {
        // Nobody listening is no error.
        let _ = self.shared.happenings.send(Happening::State(id));
    }

    fn taken_up(&self) -> std::sync::MutexGuard<'_, BTreeMap<[u8; 32], ExperimentId>> {
        self.shared.taken_up.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn active(&self) -> std::sync::MutexGuard<'_, BTreeMap<ExperimentId, Active>> {
        self.shared.active.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Pauses, resumes or cancels an experiment of a lineage in which nothing moves: it goes on, or not, when it is next
/// taken up.
///
/// # Errors
/// One that has ended; a lineage that fails.
pub async fn control_at_rest(lineage: &Lineage, id: ExperimentId, to: State) -> Result<(), ControlError> {
    if changes(&lineage.reader().experiment(id).await?, to)? {
        lineage.set_state(id, to, by_hand(to).to_owned()).await?;
    }
    Ok(())
}

/// Whether an order changes anything. What waits for a pick need not be told to run.
fn changes(stored: &StoredExperiment, to: State) -> Result<bool, ControlError> {
    if !stored.state.is_unfinished() {
        return Err(ControlError::Ended(stored.id, stored.state));
    }
    Ok(stored.state != to && (stored.state, to) != (State::Awaiting, State::Running))
}

/// Why an experiment has the state that somebody ordered.
fn by_hand(to: State) -> &'static str {
    match to {
        State::Paused => "paused by hand",
        State::Cancelled => "cancelled by hand",
        _ => "",
    }
}

/// Waits until what was settled is written; a lineage that cannot be written is not waited for.
async fn ended(mut conducting: JoinHandle<()>) {
    if tokio::time::timeout(std::time::Duration::from_secs(10), &mut conducting).await.is_err() {
        conducting.abort();
    }
}

/// Why an experiment cannot go on in this program: it was begun by other physics (ESP EF-12).
fn incompatible(stored: &StoredExperiment, fingerprint: &[u8; 32]) -> Option<String> {
    let known = creatures::system(&stored.system).map(creatures::System::version);
    if known != Some(stored.system_version) {
        return Some(format!(
            "it was begun by version {} of system `{}`, and this program has {}",
            stored.system_version,
            stored.system,
            known.map_or("none".to_owned(), |version| format!("version {version}"))
        ));
    }
    (stored.fingerprint != *fingerprint).then(|| {
        format!(
            "it was begun under the physics fingerprint {}, and this program has {}: use the program that began it",
            short(&stored.fingerprint),
            short(fingerprint)
        )
    })
}

/// The first bytes of a hash, for people.
fn short(hash: &[u8; 32]) -> String {
    hash[..6].iter().map(|byte| format!("{byte:02x}")).collect()
}

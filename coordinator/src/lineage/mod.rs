//! The lineage: every individual, its parents, its outcome and where it came from, in one SQLite file that
//! people open while it is written. One writer, many readers. It decides nothing about evolution, opens no
//! genotype, and waits on no reader.

mod checkpoint;
mod choice;
mod commits;
mod entry;
mod error;
mod fault;
mod file;
mod genotype;
mod hash;
mod id;
mod individual;
mod outcome;
mod pedigree;
mod query;
mod reader;
mod record;
mod register;
mod resume;
mod sandbox;
mod sql;
mod summary;
#[cfg(test)]
mod tests;
mod transaction;
mod writer;

pub use choice::{Picked, StoredCandidate, StoredChoice};
pub(crate) use commits::Commits;
pub use entry::{
    Amendment, Attempt, Audited, CloseGeneration, Culling, EndStage, Ending, Evaluated, Event, Fate, InStage,
    Joined, NewChoice, NewExperiment, NewPick, NewStage, OpenGeneration, Origin, Retracted, Ruling, SetAside,
    State,
};
pub use error::{OpenError, QueryError, ReadError, WriteError};
pub use file::is_at_work;
pub use hash::ExperimentHash;
pub use id::{ExperimentId, IndividualId, StageId};
pub use individual::{AttemptLine, Link, Portrait};
pub use pedigree::Ancestor;
pub use query::{Answer, Cell, Limits, VIEWS};
pub use reader::Reader;
pub use resume::{ResumePoint, Standing, StoredExperiment, StoredStage};
pub use summary::{RunProgress, Summary};

use creatures::encoding;
use genotype::Shelf;
use register::Register;
use sqlx::ConnectOptions as _;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock};
use tokio::sync::{Semaphore, mpsc, oneshot, watch};
use tokio::task::JoinHandle;
use transaction::{Checkpoint, PackedEnd, PackedGeneration};
use writer::{Entry, OUTCOMES_MAX, Queued, Writer};

/// Genotypes kept in memory as dictionaries of the next generation, bytes, over all stages. Beyond it they
/// are stored in full.
const SHELVES_MAX: usize = 64 << 20;

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

/// The lineage of one coordinator: the one writer of its file. Clones share it. When the last one is dropped,
/// what was recorded is still written; [`Lineage::close`] waits for that.
#[derive(Clone)]
pub struct Lineage {
    shared: Arc<Shared>,
}

struct Shared {
    identity: [u8; 16],
    reader: Reader,
    clients: Reader,
    queue: mpsc::Sender<Queued>,
    room: Arc<Semaphore>,
    shelves: Mutex<BTreeMap<StageId, Arc<Shelf>>>,
    health: watch::Receiver<Health>,
    commits: Commits,
    closing: watch::Sender<bool>,
    end: Arc<OnceLock<String>>,
    writer: Mutex<Option<JoinHandle<Result<(), WriteError>>>>,
}

impl Lineage {
    /// Opens a lineage for writing: creates it, or brings its schema up to date. Nobody else can open it so
    /// until [`Lineage::close`] or the end of the process; readers may, at any time.
    ///
    /// # Errors
    /// See [`OpenError`]. A file of a newer schema, or no lineage at all, is left untouched.
    pub async fn open(path: &Path) -> Result<Lineage, OpenError> {
        let found = file::look(path)?;
        let lock = file::Lock::take(path)?;
        if found == file::Found::Unmarked {
            file::recognise(path).await?;
        }
        let refused = |error: sqlx::Error| file::refused_by_sqlite(path, &error);
        let options = file::writing(path);
        let mut connection = options.connect().await.map_err(refused)?;
        file::migrate(&mut connection, &lock).await?;
        let register = Register::load(&mut connection).await.map_err(refused)?;
        sqlx::query(sql::sql!("workers_gone")).execute(&mut connection).await.map_err(refused)?;
        let identity: Vec<u8> =
            sqlx::query_scalar(sql::sql!("identity")).fetch_one(&mut connection).await.map_err(refused)?;
        let identity = identity.try_into().map_err(|_| OpenError::Corrupt {
            path: path.to_owned(),
            problem: "its identity is not 16 bytes long".to_owned(),
        })?;
        let reader = Reader::connect(path).await?;
        let clients = Reader::connect(path).await?;
        let files = lock.files().map_err(|error| refused(error.into()))?;

        let (queue, entries) = mpsc::channel(1024);
        let (health, felt) = watch::channel(Health::Good);
        let (closing, closed) = watch::channel(false);
        let end = Arc::new(OnceLock::new());
        let commits = Commits::default();
        let writer = Writer {
            connection,
            register,
            queue: entries,
            health,
            closing: closed,
            end: end.clone(),
            commits: commits.clone(),
            wal: checkpoint::WalKeeper::start(path, options),
            lock,
            files,
        };
        let writer = Mutex::new(Some(tokio::spawn(writer.run())));
        let room = Arc::new(Semaphore::new(OUTCOMES_MAX));
        let shelves = Mutex::default();
        let health = felt;
        let shared =
            Shared { identity, reader, clients, queue, room, shelves, health, commits, closing, end, writer };
        Ok(Lineage { shared: Arc::new(shared) })
    }

    /// Drawn when the file was created; workers that come back use it to tell lineages apart.
    pub fn identity(&self) -> [u8; 16] {
        self.shared.identity
    }

    /// Reads what is committed, for those who conduct experiments: no client keeps its connections busy.
    pub fn reader(&self) -> &Reader {
        &self.shared.reader
    }

    /// Reads what is committed, for clients, on connections of their own.
    pub fn clients(&self) -> &Reader {
        &self.shared.clients
    }

    /// Whether what is recorded reaches the disk.
    pub fn health(&self) -> watch::Receiver<Health> {
        self.shared.health.clone()
    }

    /// What the writer has done, for a scrape.
    pub(crate) fn commits(&self) -> &Commits {
        &self.shared.commits
    }

    /// Writes experiments down as running, all or none, and gives their numbers in order.
    ///
    /// # Errors
    /// See [`WriteError`], here and below.
    pub async fn create(&self, experiments: Vec<NewExperiment>) -> Result<Vec<ExperimentId>, WriteError> {
        let ids = self.answer(Entry::Create(experiments)).await?;
        Ok(ids.into_iter().map(ExperimentId).collect())
    }

    /// Begins a stage of a run.
    pub async fn open_stage(&self, stage: NewStage) -> Result<StageId, WriteError> {
        self.one(Entry::OpenStage(stage)).await.map(StageId)
    }

    /// Ends the previous generation of a run, with its stage if a new one begins, and begins the next, in one
    /// transaction with everything recorded so far. Returns when that is on disk, with the stage and the ids
    /// of the individuals in order of index.
    pub async fn open_generation(
        &self,
        next: OpenGeneration,
    ) -> Result<(StageId, Vec<IndividualId>), WriteError> {
        let OpenGeneration { stage, generation, checkpoint, culling, mut individuals, close, ends, choice } =
            next;
        let refused = |problem: String| {
            Err(WriteError::Contradiction { what: format!("open generation {generation}"), problem })
        };
        if let Some(large) = individuals.iter().find(|one| one.genotype.len() > encoding::SIZE_MAX) {
            return refused(format!("a genotype of {} bytes is over the limit", large.genotype.len()));
        }
        if individuals.is_empty() {
            return refused("it has no individuals".to_owned());
        }
        let number = match &stage {
            InStage::New(stage) => stage.stage,
            InStage::Open(_, number) => *number,
        };
        let size = individuals.len();
        // The first of a stage may have their parents in the last of the one before.
        let shelf = match (&stage, &ends) {
            (InStage::Open(stage, _), _) => self.shelves().get(stage).cloned(),
            (InStage::New(_), Some(ends)) => self.shelves().remove(&ends.stage),
            (InStage::New(_), None) => None,
        };
        let packing = tokio::task::spawn_blocking(move || {
            let (genotypes, next) =
                genotype::pack(&shelf.unwrap_or_default(), number, generation, &mut individuals);
            (individuals, genotypes, next, frame(&checkpoint), ends.map(PackedEnd::from))
        });
        let (individuals, genotypes, shelf, checkpoint, ends) =
            packing.await.expect("packing does not panic, and is not cancelled while its runtime lives");
        let opened = Entry::OpenGeneration(Box::new(PackedGeneration {
            stage,
            generation,
            checkpoint,
            culling,
            individuals,
            genotypes,
            close,
            ends,
            choice,
        }));
        let answer = self.answer(opened).await?;
        let [stage, first] = answer[..].try_into().expect("the writer answers this entry with two ids");
        self.shelve(StageId(stage), shelf);
        Ok((StageId(stage), (first..).take(size).map(IndividualId).collect()))
    }

    /// Ends the last generation of a stage, and with it the stage; `choice` says who may go on.
    pub async fn end_stage(&self, ends: EndStage, choice: Option<NewChoice>) -> Result<(), WriteError> {
        self.shelves().remove(&ends.stage);
        self.answer(Entry::EndStage(Box::new(PackedEnd::from(ends)), choice)).await.map(drop)
    }

    /// Writes down who may go on from the end of a stage that has ended before.
    pub async fn choose(&self, choice: NewChoice) -> Result<(), WriteError> {
        self.answer(Entry::Choose(choice)).await.map(drop)
    }

    /// Gives an experiment a changed file; it is running from then on, and no run of it is over.
    pub async fn amend(&self, amendment: Amendment) -> Result<(), WriteError> {
        self.answer(Entry::Amend(Box::new(amendment))).await.map(drop)
    }

    /// Writes down who goes on from the end of a stage: one of the candidates, where nobody has yet been
    /// picked. An experiment that waited is running from then on.
    pub async fn pick(&self, pick: NewPick) -> Result<(), WriteError> {
        self.answer(Entry::Pick(pick)).await.map(drop)
    }

    /// Takes note of outcomes; they reach the disk soon, in batches, in the order recorded. Waits only while
    /// too many of them are on their way. The first ending of an individual stands: a second one changes
    /// nothing.
    pub async fn record(&self, evaluated: Vec<Evaluated>) -> Result<(), WriteError> {
        if evaluated.is_empty() {
            return Ok(());
        }
        let count = u32::try_from(evaluated.len().min(OUTCOMES_MAX)).expect("the limit fits");
        let room = self.shared.room.clone().acquire_many_owned(count);
        let permit = room.await.expect("the semaphore is never closed");
        self.send(Queued { entry: Entry::Record(evaluated, permit), answer: None }).await
    }

    /// Takes back the outcomes of an open generation that rest on the word of workers of one name alone, with those
    /// that were inherited from them: the only rows of the lineage that are ever taken back. Nothing reads them
    /// before their generation ends. `first` and `size` are the generation's.
    pub async fn retract(
        &self,
        first: IndividualId,
        size: u32,
        worker: String,
    ) -> Result<Vec<Retracted>, WriteError> {
        let pairs = self.answer(Entry::Retract { first, size, worker }).await?;
        let retracted =
            |pair: &[u64]| Retracted { individual: IndividualId(pair[0]), attempts: pair[1] as u32 };
        Ok(pairs.chunks_exact(2).map(retracted).collect())
    }

    /// Returns when everything recorded before is on disk.
    pub async fn flush(&self) -> Result<(), WriteError> {
        self.answer(Entry::Flush).await.map(drop)
    }

    /// Sets what an experiment is up to, and why; the reason may be empty. Returns when that is on disk.
    pub async fn set_state(
        &self,
        experiment: ExperimentId,
        state: State,
        reason: String,
    ) -> Result<(), WriteError> {
        self.answer(Entry::SetState(experiment, state, reason)).await.map(drop)
    }

    /// Writes an event down, soon.
    pub async fn event(&self, event: Event) -> Result<(), WriteError> {
        self.send(Queued { entry: Entry::Event(event), answer: None }).await
    }

    /// A worker attached: from now on its name in attempts means this one.
    pub async fn worker_joined(&self, worker: Joined) -> Result<(), WriteError> {
        self.send(Queued { entry: Entry::Joined(worker), answer: None }).await
    }

    /// A worker's name is trusted no more.
    pub async fn worker_quarantined(&self, name: String) -> Result<(), WriteError> {
        self.send(Queued { entry: Entry::Quarantined(name), answer: None }).await
    }

    /// A worker went away, and why.
    pub async fn worker_left(&self, name: String, reason: String) -> Result<(), WriteError> {
        self.send(Queued { entry: Entry::Left(name, reason), answer: None }).await
    }

    /// Commits everything recorded, tidies the file up and gives it free. Other clones find it closed.
    ///
    /// # Errors
    /// When the disk does not take what is left; it is then lost, and will be evaluated again.
    pub async fn close(self) -> Result<(), WriteError> {
        let _ = self.shared.closing.send(true); // the writer may be gone
        let flushed = self.answer(Entry::Close).await.map(drop);
        let writer = self.shared.writer.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take();
        let Some(writer) = writer else { return flushed };
        self.shared.reader.close().await;
        self.shared.clients.close().await;
        writer.await.unwrap_or_else(|_| Err(WriteError::Closed { reason: "the writer died".to_owned() }))
    }

    fn shelves(&self) -> std::sync::MutexGuard<'_, BTreeMap<StageId, Arc<Shelf>>> {
        // A panic elsewhere leaves the map whole.
        self.shared.shelves.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn shelve(&self, stage: StageId, shelf: Shelf) {
        let mut shelves = self.shelves();
        shelves.remove(&stage);
        let bytes: usize = shelves.values().map(|shelf| shelf.bytes()).sum();
        if bytes + shelf.bytes() <= SHELVES_MAX {
            shelves.insert(stage, Arc::new(shelf));
        }
    }

    async fn one(&self, entry: Entry) -> Result<u64, WriteError> {
        let ids = self.answer(entry).await?;
        Ok(*ids.first().expect("the writer answers this entry with one id"))
    }

    async fn answer(&self, entry: Entry) -> Result<Vec<u64>, WriteError> {
        let (answer, waiting) = oneshot::channel();
        self.send(Queued { entry, answer: Some(answer) }).await?;
        waiting.await.unwrap_or_else(|_| Err(self.closed()))
    }

    async fn send(&self, queued: Queued) -> Result<(), WriteError> {
        self.shared.queue.send(queued).await.map_err(|_| self.closed())
    }

    fn closed(&self) -> WriteError {
        let reason = self.shared.end.get().map_or("the writer ended", String::as_str);
        WriteError::Closed { reason: reason.to_owned() }
    }
}

/// A checkpoint as it is stored.
fn frame(state: &[u8]) -> Checkpoint {
    let frame = zstd::bulk::compress(state, 3).expect("zstd compresses whatever fits in memory");
    Checkpoint { size: state.len(), digest: *blake3::hash(state).as_bytes(), frame }
}

impl From<EndStage> for PackedEnd {
    fn from(ends: EndStage) -> Self {
        let EndStage { stage, close, checkpoint, over } = ends;
        PackedEnd { stage, close, checkpoint: frame(&checkpoint), over }
    }
}

/// The seed of an individual's evaluation: keyed by its place in its run, so that nobody stores it.
pub fn evaluation_seed(run_seed: u64, place: search::Place) -> u64 {
    let mut bytes = [0; 8];
    place.stream(run_seed, "evaluation").fill(&mut bytes);
    u64::from_le_bytes(bytes)
}

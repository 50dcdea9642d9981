//! The one writer: takes entries from a bounded queue, commits them in batches, and keeps a batch that does
//! not reach the disk until it does. It computes nothing and reads nothing on the way of outcomes.

use super::checkpoint::WalKeeper;
use super::commits::Commits;
use super::entry::{
    Amendment, Evaluated, Event, InStage, Joined, NewChoice, NewExperiment, NewPick, NewStage, State,
};
use super::fault::{Fault, fault, words};
use super::file::{Files, Lock};
use super::register::Register;
use super::transaction::{PackedEnd, PackedGeneration, Refusal, Transaction};
use super::{ExperimentId, Health, IndividualId, WriteError};
use sqlx::sqlite::SqliteConnection;
use sqlx::{Connection as _, Executor as _};
use std::io;
use std::sync::{Arc, OnceLock};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, mpsc, oneshot, watch};
use tokio::time::{Instant, timeout_at};
use tracing::Instrument as _;

/// Outcomes on their way, at most; who records more waits.
pub(super) const OUTCOMES_MAX: usize = 1 << 16;

/// Outcomes of one transaction, about.
const BATCH: usize = 1 << 13;

/// How long an outcome waits for others to share its commit.
const LINGER: Duration = Duration::from_millis(20);

/// Between two attempts to write what the disk refused: doubled from the first to the second.
const RETRY: (Duration, Duration) = (Duration::from_millis(50), Duration::from_secs(2));

/// One entry, and who waits for it.
pub(super) struct Queued {
    pub(super) entry: Entry,
    /// Gets the ids that the entry was given.
    pub(super) answer: Option<oneshot::Sender<Result<Vec<u64>, WriteError>>>,
}

/// Something to write.
pub(super) enum Entry {
    Create(Vec<NewExperiment>),
    SetState(ExperimentId, State, String),
    OpenStage(NewStage),
    OpenGeneration(Box<PackedGeneration>),
    EndStage(Box<PackedEnd>, Option<NewChoice>),
    Choose(NewChoice),
    Pick(NewPick),
    Amend(Box<Amendment>),
    Record(Vec<Evaluated>, OwnedSemaphorePermit),
    Event(Event),
    Joined(Joined),
    Left(String, String),
    Quarantined(String),
    Retract {
        first: IndividualId,
        size: u32,
        worker: String,
    },
    Flush,
    /// The last one: what is queued before the channel closes is still written, and nothing after.
    Close,
    /// A disk without room for another page, for so many attempts.
    #[cfg(test)]
    FullFor(std::sync::atomic::AtomicU32),
}

impl Entry {
    /// For messages: `the lineage refused to …`.
    fn what(&self) -> String {
        match self {
            Entry::Create(experiments) => format!("create {} experiments", experiments.len()),
            Entry::SetState(id, state, _) => format!("set experiment {id} to {}", state.word()),
            Entry::OpenStage(stage) => {
                format!("open stage {} of run {} of experiment {}", stage.stage, stage.run, stage.experiment)
            }
            Entry::OpenGeneration(next) => match &next.stage {
                InStage::Open(stage, _) => format!("open generation {} of stage {stage}", next.generation),
                InStage::New(stage) => format!("open stage {} of run {}", stage.stage, stage.run),
            },
            Entry::EndStage(ends, _) => format!("end stage {}", ends.stage),
            Entry::Choose(choice) => format!("offer candidates of stage {}", choice.stage),
            Entry::Pick(pick) => format!("pick individual {} of stage {}", pick.individual, pick.stage),
            Entry::Amend(of) => format!("change the file of experiment {}", of.experiment),
            Entry::Record(evaluated, _) => format!("record {} outcomes", evaluated.len()),
            Entry::Event(event) => format!("write down the event `{}`", event.kind),
            Entry::Joined(worker) => format!("welcome worker `{}`", worker.name),
            Entry::Left(name, _) => format!("take leave of worker `{name}`"),
            Entry::Quarantined(name) => format!("quarantine worker `{name}`"),
            Entry::Retract { worker, .. } => format!("retract outcomes of worker `{worker}`"),
            Entry::Flush => "flush".to_owned(),
            Entry::Close => "close".to_owned(),
            #[cfg(test)]
            Entry::FullFor(_) => "be full".to_owned(),
        }
    }
}

/// See the module.
pub(super) struct Writer {
    pub(super) connection: SqliteConnection,
    pub(super) register: Register,
    pub(super) queue: mpsc::Receiver<Queued>,
    pub(super) health: watch::Sender<Health>,
    /// Turns true when somebody wants to be done, whether or not the disk takes what is left.
    pub(super) closing: watch::Receiver<bool>,
    /// Why nothing will ever be written again.
    pub(super) end: Arc<OnceLock<String>>,
    pub(super) commits: Commits,
    pub(super) wal: WalKeeper,
    /// Held until the last commit.
    pub(super) lock: Lock,
    /// Those that were opened.
    pub(super) files: Files,
}

impl Writer {
    /// Writes until every sender is gone, and then tidies up. Says whether all of it was written.
    pub(super) async fn run(mut self) -> Result<(), WriteError> {
        let mut written = Ok(());
        while let Some(batch) = self.gather().await {
            if batch.iter().any(|queued| matches!(queued.entry, Entry::Close)) {
                self.queue.close();
            }
            if let Err(reason) = self.write(batch).await {
                let _ = self.end.set(reason.clone()); // the first reason stands
                self.queue.close();
                written = Err(WriteError::Closed { reason });
                break;
            }
        }
        while let Some(queued) = self.queue.recv().await {
            refuse(queued, self.end.get().map_or("closed", String::as_str));
        }
        let _ = self.end.set("closed".to_owned());
        self.wal.stop().await;
        // A damaged file or a full disk may refuse; the next one to open it tidies up. No statistics are left
        // for the planner: with them it builds Bloom filters of whole tables for the steps of a pedigree.
        let _ = self.connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").await;
        let _ = self.connection.close().await;
        drop(self.lock);
        written
    }

    /// The entries of the next transaction, in order; adjacent outcomes joined. Lingers for more only while
    /// nobody waits for an answer.
    async fn gather(&mut self) -> Option<Vec<Queued>> {
        let mut batch = vec![self.queue.recv().await?];
        let until = Instant::now() + LINGER;
        let mut outcomes = outcomes(&batch[0]);
        while outcomes < BATCH && batch.len() < 256 {
            let awaited = batch.last().is_some_and(|queued| queued.answer.is_some());
            let next = if awaited || self.is_closing() {
                self.queue.try_recv().ok()
            } else {
                timeout_at(until, self.queue.recv()).await.ok().flatten()
            };
            let Some(next) = next else { break };
            outcomes += self::outcomes(&next);
            match (batch.last_mut().map(|last| &mut last.entry), next.entry) {
                (Some(Entry::Record(all, permit)), Entry::Record(more, another)) => {
                    all.extend(more);
                    permit.merge(another);
                }
                (_, entry) => batch.push(Queued { entry, answer: next.answer }),
            }
        }
        Some(batch)
    }

    /// Writes a batch, however long it takes.
    ///
    /// # Errors
    /// Why it can never be written.
    async fn write(&mut self, batch: Vec<Queued>) -> Result<(), String> {
        let mut pause = RETRY.0;
        loop {
            let (began, count) = (Instant::now(), batch.iter().map(outcomes).sum());
            let span = tracing::debug_span!("commit", entries = batch.len(), outcomes = count);
            let error = match self.attempt(&batch).instrument(span).await {
                Ok(answers) => {
                    self.commits.committed(began.elapsed(), count);
                    for (queued, answer) in batch.into_iter().zip(answers) {
                        if let Some(waiting) = queued.answer {
                            let _ = waiting.send(answer); // nobody need wait to the end
                        }
                    }
                    self.feel(Health::Good);
                    self.wal.committed();
                    return Ok(());
                }
                Err(error) => error,
            };
            self.commits.failed();
            let _ = self.connection.execute("ROLLBACK").await; // SQLite may have done so itself
            let reason = words(&error);
            self.feel(Health::Stuck { reason: reason.clone() });
            let hopeless = fault(&error) == Fault::Damaged;
            if hopeless || self.is_closing() {
                batch.into_iter().for_each(|queued| refuse(queued, &reason));
                return Err(reason);
            }
            let _ = tokio::time::timeout(pause, self.closing.wait_for(|closing| *closing)).await;
            pause = (pause * 2).min(RETRY.1);
        }
    }

    /// Whether what is written can be found again.
    fn recognise(&self) -> Result<(), sqlx::Error> {
        let advice = "stop this coordinator, and start it again on the right file";
        let replaced = match self.lock.files() {
            Ok(files) if files == self.files => return Ok(()),
            Ok(_) => "the write-ahead log has been replaced".to_owned(),
            Err(error) => error.to_string(),
        };
        Err(io::Error::other(format!("{replaced}: {advice}")).into())
    }

    /// One transaction with all of a batch: an answer to each entry, or none of it is written.
    async fn attempt(&mut self, batch: &[Queued]) -> Result<Vec<Result<Vec<u64>, WriteError>>, sqlx::Error> {
        if *self.health.borrow() != Health::Good {
            self.register = Register::load(&mut self.connection).await?; // what was rolled back is unknown again
        }
        self.recognise()?;
        self.connection.execute("BEGIN IMMEDIATE").await?;
        let mut answers = Vec::with_capacity(batch.len());
        for queued in batch {
            answers.push(self.entry(&queued.entry).await?);
        }
        self.connection.execute("COMMIT").await?;
        Ok(answers)
    }

    /// One entry, all of it or nothing.
    async fn entry(&mut self, entry: &Entry) -> Result<Result<Vec<u64>, WriteError>, sqlx::Error> {
        self.connection.execute("SAVEPOINT entry").await?;
        let applied = apply(&mut self.connection, &mut self.register, entry).await;
        let problem = match applied {
            Ok(ids) => {
                self.connection.execute("RELEASE entry").await?;
                return Ok(Ok(ids));
            }
            Err(Refusal::Sqlite(error)) => return Err(error),
            Err(Refusal::Contradiction(problem)) => problem,
        };
        self.undo().await?;
        tracing::error!(problem, "the lineage refused to {}", entry.what());
        if let Entry::Record(evaluated, _) = entry {
            self.record_singly(evaluated).await?;
        }
        Ok(Err(WriteError::Contradiction { what: entry.what(), problem }))
    }

    /// One outcome that contradicts the lineage must not cost those that share its batch.
    async fn record_singly(&mut self, evaluated: &[Evaluated]) -> Result<(), sqlx::Error> {
        for evaluated in evaluated {
            self.connection.execute("SAVEPOINT entry").await?;
            let mut transaction =
                Transaction { connection: &mut self.connection, register: &mut self.register };
            match transaction.record([evaluated]).await {
                Ok(()) => {
                    self.connection.execute("RELEASE entry").await?;
                }
                Err(Refusal::Sqlite(error)) => return Err(error),
                Err(Refusal::Contradiction(problem)) => {
                    self.undo().await?;
                    tracing::error!(problem, individual = evaluated.individual.0, "an outcome was refused");
                }
            }
        }
        Ok(())
    }

    async fn undo(&mut self) -> Result<(), sqlx::Error> {
        self.connection.execute("ROLLBACK TO entry").await?;
        self.connection.execute("RELEASE entry").await?;
        self.register = Register::load(&mut self.connection).await?;
        Ok(())
    }

    /// True when somebody closes the lineage, or nobody holds it any more.
    fn is_closing(&self) -> bool {
        *self.closing.borrow() || self.closing.has_changed().is_err()
    }

    fn feel(&self, health: Health) {
        let changed = self.health.send_if_modified(|felt| {
            let changed = *felt != health;
            *felt = health.clone();
            changed
        });
        match health {
            Health::Stuck { reason } if changed => tracing::error!(reason, "the lineage is not written"),
            Health::Good if changed => tracing::info!("the lineage is written again"),
            _ => {}
        }
    }
}

async fn apply(
    connection: &mut SqliteConnection,
    register: &mut Register,
    entry: &Entry,
) -> Result<Vec<u64>, Refusal> {
    let mut transaction = Transaction { connection, register };
    match entry {
        Entry::Create(experiments) => return transaction.create(experiments).await,
        Entry::OpenStage(stage) => return Ok(vec![transaction.open_stage(stage).await?]),
        Entry::OpenGeneration(next) => {
            let (stage, first) = transaction.open_generation(next).await?;
            return Ok(vec![stage.0, first.0]);
        }
        Entry::SetState(id, state, reason) => transaction.set_state(*id, *state, reason).await?,
        Entry::EndStage(ends, choice) => {
            transaction.end_stage(ends).await?;
            if let Some(choice) = choice {
                transaction.choose(choice).await?;
            }
        }
        Entry::Choose(choice) => transaction.choose(choice).await?,
        Entry::Pick(pick) => transaction.pick(pick).await?,
        Entry::Amend(amendment) => transaction.amend(amendment).await?,
        Entry::Record(evaluated, _) => transaction.record(evaluated).await?,
        Entry::Event(event) => transaction.event(event).await?,
        Entry::Joined(worker) => transaction.worker_joined(worker).await?,
        Entry::Left(name, reason) => transaction.worker_left(name, reason).await?,
        Entry::Quarantined(name) => transaction.worker_quarantined(name).await?,
        Entry::Retract { first, size, worker } => {
            let retracted = transaction.retract(*first, *size, worker).await?;
            return Ok(retracted.iter().flat_map(|of| [of.individual.0, of.attempts.into()]).collect());
        }
        Entry::Flush | Entry::Close => {}
        #[cfg(test)]
        Entry::FullFor(attempts) => {
            use std::sync::atomic::Ordering::Relaxed;
            let full = attempts.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).is_ok();
            let pages = if full { 1 } else { u32::MAX - 1 }; // SQLite takes no less than there are
            let pragma = sqlx::AssertSqlSafe(format!("PRAGMA max_page_count = {pages}"));
            transaction.connection.execute(sqlx::raw_sql(pragma)).await?;
        }
    }
    Ok(Vec::new())
}

fn outcomes(queued: &Queued) -> usize {
    if let Entry::Record(evaluated, _) = &queued.entry { evaluated.len() } else { 0 }
}

fn refuse(queued: Queued, reason: &str) {
    if let Some(waiting) = queued.answer {
        let _ = waiting.send(Err(WriteError::Closed { reason: reason.to_owned() }));
    }
}

//! Conducting one experiment: every run from where it stands to its end. Runs go on side by side, so that
//! the fleet works on while one of them waits for its last outcome, or for a pick. It decides nothing about
//! evolution.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use creatures::Outcome;
use search::{Experiment, Place};
use serde_json::json;
use tokio::sync::{OwnedMutexGuard, mpsc, watch};
use tokio::task::JoinSet;
use tracing::Instrument as _;

use super::Driver;
use super::generation::Inherited;
use super::progress::Progress;
use super::run::{Run, Step, Waiting};
use crate::fleet::{Conflict, Queue, QueueOutput, Settled, TaskText};
use crate::lineage::{
    Ending, Evaluated, Event, ExperimentId, IndividualId, ReadError, StageId, State, StoredExperiment,
    WriteError,
};

/// How long an outcome may wait for others to be committed with it; as much is evaluated again after a kill.
const WRITE_WITHIN: Duration = Duration::from_millis(50);
/// So many outcomes are committed at once.
const WRITE_AT: usize = 1024;

/// Why an experiment cannot go on.
#[derive(Debug, thiserror::Error)]
pub(super) enum ConductError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("run {run}, {at}: its checkpoint is not understood: {problem}")]
    Checkpoint { run: u32, at: String, problem: String },
    #[error("run {run}, {at}: the search now asks for other individuals than stand in the lineage")]
    OtherHistory { run: u32, at: String },
    #[error("run {run}: the search {problem}")]
    Search { run: u32, problem: String },
    #[error("{0}")]
    GaveUp(String),
}

/// A pick, for the one who conducts: at the end of which stage, and who goes on.
pub(super) type Pick = (StageId, Place);

/// What was settled and is not on disk yet: a commit an outcome would cost more than many an evaluation.
struct Unwritten {
    evaluated: Vec<Evaluated>,
    /// By when it is written.
    due: tokio::time::Instant,
}

impl Default for Unwritten {
    fn default() -> Self {
        Unwritten { evaluated: Vec::new(), due: tokio::time::Instant::now() }
    }
}

/// How conducting came to its end.
enum End {
    /// Every run has ended.
    Finished,
    /// Nothing moves until somebody picks; nobody picks as long as the guard lives.
    Awaiting(String, OwnedMutexGuard<()>),
    /// The driver stops, or the experiment was cancelled.
    Stopped,
}

/// What a run that goes on needs beside itself; shared by all of them.
pub(super) struct Conductor {
    pub(super) driver: Driver,
    pub(super) id: ExperimentId,
    pub(super) experiment: Experiment,
    pub(super) stored: StoredExperiment,
    /// The experiment that a fork comes from.
    pub(super) origin: Option<StoredExperiment>,
    /// Of stages without a task of their own.
    pub(super) task: Arc<TaskText>,
    pub(super) queue: Queue,
    pub(super) progress: Arc<Progress>,
}

/// Runs on their way.
#[derive(Default)]
struct Runs {
    /// For outcomes: by the id of the first individual of their generation, since ids are contiguous.
    waiting: BTreeMap<IndividualId, Run>,
    /// From one generation to the next.
    turning: JoinSet<Result<Step, ConductError>>,
    /// For a pick, at the end of a stage.
    awaiting: BTreeMap<StageId, Waiting>,
}

/// Conducts an experiment until its last generation has ended, it waits for a pick, it is cancelled, or the
/// driver stops.
pub(super) async fn conduct(
    driver: Driver,
    stored: StoredExperiment,
    experiment: Experiment,
    (queue, output): (Queue, QueueOutput),
    progress: Arc<Progress>,
    picks: mpsc::UnboundedReceiver<Pick>,
) {
    let id = stored.id;
    let task = Arc::new(TaskText::new(&stored.system, stored.system_version, &stored.task_json));
    let end = async {
        let origin = match stored.origin {
            Some(origin) => Some(driver.shared.lineage.reader().experiment(origin.experiment).await?),
            None => None,
        };
        let driver = driver.clone();
        let conductor = Conductor { driver, id, experiment, stored, origin, task, queue, progress };
        Arc::new(conductor).every_run(output, picks).await
    };
    let mut guard = None;
    let ending = match end.await {
        Ok(End::Finished) => Some((State::Finished, String::new())),
        Ok(End::Stopped) => None,
        Ok(End::Awaiting(reason, nobody_picks)) => {
            guard = Some(nobody_picks);
            Some((State::Awaiting, reason))
        }
        Err(ConductError::Write(WriteError::Closed { reason })) => {
            tracing::warn!(experiment = %id, reason, "the lineage is closed");
            None
        }
        // Nothing is wrong with the experiment: it goes on when the file can be read again.
        Err(ConductError::Read(error)) => {
            tracing::error!(experiment = %id, %error, "the experiment rests");
            Some((State::Paused, format!("{error}; when that is mended: `hatchery resume {id}`")))
        }
        Err(error) => {
            tracing::error!(experiment = %id, %error, "the experiment cannot go on");
            Some((State::Failed, error.to_string()))
        }
    };
    driver.active().remove(&id);
    if let Some((state, reason)) = ending
        && let Err(error) = driver.rest(id, state, &reason).await
    {
        tracing::error!(experiment = %id, %error, "its end could not be written");
    }
    drop(guard);
}

impl Conductor {
    async fn every_run(
        self: Arc<Self>,
        mut output: QueueOutput,
        mut picks: mpsc::UnboundedReceiver<Pick>,
    ) -> Result<End, ConductError> {
        let mut stopping = self.driver.shared.stopping.subscribe();
        let mut runs = Runs::default();
        let mut unwritten = Unwritten::default();
        for number in 1..=self.experiment.runs {
            let step = self.take_up(number).await?;
            self.clone().place(step, &mut runs).await;
        }
        loop {
            if runs.waiting.is_empty() && runs.turning.is_empty() {
                if runs.awaiting.is_empty() {
                    return Ok(End::Finished);
                }
                let nobody_picks = self.driver.shared.picking.clone().lock_owned().await;
                match picks.try_recv() {
                    Ok(pick) => self.clone().picked(pick, &mut runs),
                    Err(_) => return Ok(End::Awaiting(self.awaited(&runs.awaiting), nobody_picks)),
                }
                continue;
            }
            tokio::select! {
                () = stopped(&mut stopping) => {
                    self.write(&mut unwritten).await?;
                    return Ok(End::Stopped);
                }
                Some(turned) = runs.turning.join_next() => {
                    let turned = turned.expect("a turn neither panics nor is aborted while it is awaited");
                    if turned.is_err() {
                        self.write(&mut unwritten).await?; // what other runs came to
                    }
                    self.clone().place(turned?, &mut runs).await;
                }
                Some(pick) = picks.recv() => self.clone().picked(pick, &mut runs),
                settled = output.next() => {
                    let Some(settled) = settled else {
                        self.write(&mut unwritten).await?;
                        return Ok(End::Stopped);
                    };
                    self.report(output.take_conflicts()).await?;
                    let mut complete = self.settle(settled, &mut runs.waiting, &mut unwritten);
                    let verdicts = output.take_quarantined();
                    for verdict in &verdicts {
                        // Before the outcome that it was found out by: a kill between them must not hide it.
                        self.driver.shared.lineage.worker_quarantined(verdict.worker.clone()).await?;
                    }
                    for verdict in verdicts {
                        // A generation whose last outcome came with the verdict is still open.
                        runs.waiting.extend(complete.drain(..).map(|run| (run.generation.first(), run)));
                        self.write(&mut unwritten).await?;
                        complete = self.redo(&verdict.worker, &mut runs.waiting).await?;
                    }
                    if !complete.is_empty() || unwritten.evaluated.len() >= WRITE_AT {
                        self.write(&mut unwritten).await?;
                    }
                    for run in complete {
                        self.clone().place(Step::Goes(Box::new(run)), &mut runs).await;
                    }
                }
                () = tokio::time::sleep_until(unwritten.due), if !unwritten.evaluated.is_empty() => {
                    self.write(&mut unwritten).await?;
                }
            }
        }
    }

    /// Lets a run wait for outcomes, and only then hands its evaluations out; or, if no outcome is missing,
    /// lets it turn to its next generation; or lets it wait for a pick.
    async fn place(self: Arc<Self>, step: Step, runs: &mut Runs) {
        match step {
            Step::Goes(run) if run.generation.complete() => {
                let span = tracing::debug_span!("turn", run = run.number, generation = run.generation.number);
                runs.turning.spawn(async move { self.turn(*run).await }.instrument(span));
            }
            Step::Goes(mut run) => {
                let evaluations = std::mem::take(&mut run.evaluations);
                runs.waiting.insert(run.generation.first(), *run);
                self.queue.submit(evaluations).await;
            }
            Step::Waits(waiting) => {
                runs.awaiting.insert(waiting.stage, waiting);
            }
            Step::Over(number) => self.progress.finished(number),
        }
    }

    /// Lets a run that waited for this pick go on. One that nobody waits for was taken into account when its
    /// run was taken up.
    fn picked(self: Arc<Self>, (stage, place): Pick, runs: &mut Runs) {
        if let Some(waiting) = runs.awaiting.remove(&stage) {
            runs.turning.spawn(async move { self.follow(waiting, place).await });
        }
    }

    /// What is awaited, and what to type.
    fn awaited(&self, awaiting: &BTreeMap<StageId, Waiting>) -> String {
        let mut names: Vec<&str> = awaiting.values().map(|waiting| waiting.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        let names = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let runs = match self.experiment.runs {
            1 => String::new(),
            _ => {
                let mut runs: Vec<_> = awaiting.values().map(|waiting| waiting.number.to_string()).collect();
                runs.sort_unstable();
                format!(" of run {}", runs.join(", "))
            }
        };
        let id = self.id;
        format!(
            "stage {names}{runs} waits for a pick: see `hatchery candidates {id}`, then `hatchery pick {id} INDIVIDUAL`"
        )
    }

    /// Notes what the fleet has settled, to be written soon, and gives the runs that miss nothing any more:
    /// before they turn it must be written.
    fn settle(
        &self,
        settled: Vec<Settled>,
        waiting: &mut BTreeMap<IndividualId, Run>,
        unwritten: &mut Unwritten,
    ) -> Vec<Run> {
        if unwritten.evaluated.is_empty() {
            unwritten.due = tokio::time::Instant::now() + WRITE_WITHIN;
        }
        let evaluated = &mut unwritten.evaluated;
        let mut touched = Vec::new();
        for one in settled {
            let id = IndividualId(one.id);
            let waits = waiting.range_mut(..=id).next_back().and_then(|(&first, run)| {
                let index = run.generation.index(id)?;
                Some((first, run, index))
            });
            let Some((first, run, index)) = waits else {
                tracing::error!(experiment = %self.id, individual = id.0, "an outcome for which no run waits");
                continue;
            };
            let heirs = run.generation.settle(index, one.result.as_ref().ok().cloned());
            evaluated.push(Evaluated {
                individual: id,
                ending: Ending::Settled(one.result),
                ruling: one.ruling,
                audit: one.audit,
                attempts: one.attempts,
            });
            self.progress.settled(heirs.len(), 1);
            evaluated.extend(heirs.into_iter().map(take_over));
            if touched.last() != Some(&first) {
                touched.push(first);
            }
        }
        touched.sort_unstable();
        touched.dedup();
        let mut complete = Vec::new();
        for first in touched {
            let run = &waiting[&first];
            self.progress.generation(run);
            if run.generation.complete() {
                complete.extend(waiting.remove(&first));
            }
        }
        complete
    }

    /// Commits what was settled.
    #[tracing::instrument(level = "debug", skip_all, fields(outcomes = unwritten.evaluated.len()))]
    async fn write(&self, unwritten: &mut Unwritten) -> Result<(), ConductError> {
        self.driver.shared.lineage.record(std::mem::take(&mut unwritten.evaluated)).await?;
        Ok(())
    }

    /// Writes down that two workers disagreed: one of them cannot be trusted (walker X-18).
    async fn report(&self, conflicts: Vec<Conflict>) -> Result<(), ConductError> {
        for conflict in conflicts {
            let side = |(outcome, worker): &(Outcome, String)| {
                json!({
                    "worker": worker,
                    "fitness": outcome.fitness,
                    "fitness_bits": format!("{:016x}", outcome.fitness.to_bits()),
                    "steps": outcome.steps,
                })
            };
            let (first, second) = (side(&conflict.first), side(&conflict.second));
            let event = Event {
                experiment: Some(self.id),
                kind: "conflict".to_owned(),
                text: format!(
                    "workers `{}` and `{}` gave different outcomes for individual {}",
                    conflict.first.1, conflict.second.1, conflict.id
                ),
                data: json!({ "individual": conflict.id, "first": first, "second": second }),
            };
            tracing::error!(experiment = %self.id, data = %event.data, "{}", event.text);
            self.driver.shared.lineage.event(event).await?;
        }
        Ok(())
    }
}

/// Waits until the driver stops.
async fn stopped(stopping: &mut watch::Receiver<bool>) {
    // An error says that the driver is gone, which is a stop as well.
    let _ = stopping.wait_for(|stopping| *stopping).await;
}

pub(super) fn take_over(inherited: Inherited) -> Evaluated {
    Evaluated {
        individual: inherited.heir,
        ending: Ending::Inherits(inherited.from),
        ruling: None,
        audit: None,
        attempts: Vec::new(),
    }
}

//! Conducting one experiment: every run from where it stands to its end. Runs go on side by side, so that
//! the fleet works on while one of them waits for its last outcome. It decides nothing about evolution.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use bytes::Bytes;
use creatures::{Cull, Outcome};
use search::{Experiment, Place, Search};
use serde_json::json;
use tokio::sync::watch;
use tokio::task::JoinSet;
use tracing::Instrument as _;

use super::Driver;
use super::generation::{Generation, Inherited};
use super::progress::{Ended, Happening, Progress, Tally};
use crate::fleet::{Conflict, Evaluation, Queue, QueueOutput, Settled, TaskText};
use crate::lineage::{
    CloseGeneration, Culling, Ending, Evaluated, Event, ExperimentId, IndividualId, NewStage, OpenGeneration,
    ReadError, StageId, State, StoredExperiment, WriteError, evaluation_seed,
};

/// The one stage of a run whose search is a plain genetic algorithm.
pub(super) const STAGE: u32 = 0;
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
    #[error("run {run}: its checkpoint is not understood: {problem}")]
    Checkpoint { run: u32, problem: String },
    #[error(
        "run {run}, generation {generation}: the search now asks for other individuals than stand in the lineage"
    )]
    OtherHistory { run: u32, generation: u32 },
}

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

/// One run under way.
pub(super) struct Run {
    /// From 1.
    pub(super) number: u32,
    stage: StageId,
    search: Box<dyn Search>,
    pub(super) generation: Generation,
    inherited: u32,
    opened: Instant,
    /// To be handed out once the run waits for them: an outcome that came before would find nobody.
    evaluations: Vec<Evaluation>,
    /// All of the generation's, if the experiment is audited: an outcome may be taken back.
    pub(super) again: BTreeMap<IndividualId, Evaluation>,
}

/// What a run that goes on needs beside itself; shared by all of them.
pub(super) struct Conductor {
    pub(super) driver: Driver,
    pub(super) id: ExperimentId,
    experiment: Experiment,
    task: Arc<TaskText>,
    pub(super) queue: Queue,
    pub(super) progress: Arc<Progress>,
}

/// Conducts an experiment until its last generation has ended, it is cancelled, or the driver stops.
pub(super) async fn conduct(
    driver: Driver,
    stored: StoredExperiment,
    experiment: Experiment,
    queue: (Queue, QueueOutput),
    progress: Arc<Progress>,
) {
    let id = stored.id;
    let task = Arc::new(TaskText::new(&stored.system, stored.system_version, &stored.task_json));
    let (queue, output) = queue;
    let conductor = Arc::new(Conductor { driver: driver.clone(), id, experiment, task, queue, progress });
    let ending = match conductor.clone().every_run(&stored, output).await {
        Ok(true) => Some((State::Finished, String::new())),
        Ok(false) => None,
        Err(ConductError::Write(WriteError::Closed { reason })) => {
            tracing::warn!(experiment = %id, reason, "the lineage is closed");
            None
        }
        Err(error) => {
            tracing::error!(experiment = %id, %error, "the experiment cannot go on");
            Some((State::Failed, error.to_string()))
        }
    };
    driver.active().remove(&id);
    if let Some((state, reason)) = ending
        && let Err(error) = driver.settle_state(id, state, &reason).await
    {
        tracing::error!(experiment = %id, %error, "its end could not be written");
    }
}

impl Conductor {
    /// Gives whether every run has ended; not so when the driver stops.
    async fn every_run(
        self: Arc<Self>,
        stored: &StoredExperiment,
        mut output: QueueOutput,
    ) -> Result<bool, ConductError> {
        let mut stopping = self.driver.shared.stopping.subscribe();
        // Runs by the id of the first individual of their generation: ids are contiguous.
        let mut waiting: BTreeMap<IndividualId, Run> = BTreeMap::new();
        let mut turning: JoinSet<Result<Option<Run>, ConductError>> = JoinSet::new();
        let mut unwritten = Unwritten::default();
        for number in 1..=self.experiment.runs {
            if let Some(run) = self.take_up(stored, number).await? {
                self.clone().place(run, &mut waiting, &mut turning).await;
            }
        }
        while !(waiting.is_empty() && turning.is_empty()) {
            tokio::select! {
                () = stopped(&mut stopping) => {
                    self.write(&mut unwritten).await?;
                    return Ok(false);
                }
                Some(turned) = turning.join_next() => {
                    let turned = turned.expect("a turn neither panics nor is aborted while it is awaited")?;
                    if let Some(run) = turned {
                        self.clone().place(run, &mut waiting, &mut turning).await;
                    }
                }
                settled = output.next() => {
                    let Some(settled) = settled else {
                        self.write(&mut unwritten).await?;
                        return Ok(false);
                    };
                    self.report(output.take_conflicts()).await?;
                    let mut complete = self.settle(settled, &mut waiting, &mut unwritten);
                    for verdict in output.take_quarantined() {
                        // A generation whose last outcome came with the verdict is still open.
                        waiting.extend(complete.drain(..).map(|run| (run.generation.first(), run)));
                        self.write(&mut unwritten).await?;
                        complete = self.redo(&verdict.worker, &mut waiting).await?;
                    }
                    if !complete.is_empty() || unwritten.evaluated.len() >= WRITE_AT {
                        self.write(&mut unwritten).await?;
                    }
                    for run in complete {
                        self.clone().place(run, &mut waiting, &mut turning).await;
                    }
                }
                () = tokio::time::sleep_until(unwritten.due), if !unwritten.evaluated.is_empty() => {
                    self.write(&mut unwritten).await?;
                }
            }
        }
        Ok(true)
    }

    /// Lets a run wait for outcomes, and only then hands its evaluations out; or, if no outcome is missing,
    /// lets it turn to its next generation.
    async fn place(
        self: Arc<Self>,
        mut run: Run,
        waiting: &mut BTreeMap<IndividualId, Run>,
        turning: &mut JoinSet<Result<Option<Run>, ConductError>>,
    ) {
        if run.generation.complete() {
            let span = tracing::debug_span!("turn", run = run.number, generation = run.generation.number);
            turning.spawn(async move { self.turn(run).await }.instrument(span));
        } else {
            let evaluations = std::mem::take(&mut run.evaluations);
            waiting.insert(run.generation.first(), run);
            self.queue.submit(evaluations).await;
        }
    }

    /// Takes a run up where it stands; none if it has ended.
    async fn take_up(&self, stored: &StoredExperiment, number: u32) -> Result<Option<Run>, ConductError> {
        let lineage = &self.driver.shared.lineage;
        let stage = match stored.stages.iter().find(|stage| stage.run == number && stage.stage == STAGE) {
            Some(stage) if stage.ended => {
                self.progress.finished(number);
                return Ok(None);
            }
            Some(stage) => stage.id,
            None => {
                let new = NewStage {
                    experiment: self.id,
                    run: number,
                    stage: STAGE,
                    name: String::new(),
                    seed: self.experiment.seed_of(number),
                    generations: self.experiment.generations(),
                };
                lineage.open_stage(new).await?
            }
        };
        match lineage.reader().resume_point(stage).await? {
            Some(point) => self.resume(number, stage, point).await.map(Some),
            None => {
                let mut search = self.experiment.start(number);
                let checkpoint = search.checkpoint();
                let individuals = tokio::task::block_in_place(|| search.ask());
                self.open(number, stage, search, checkpoint, individuals, None, None).await
            }
        }
    }

    /// Goes on with a generation that stands in the lineage.
    async fn resume(
        &self,
        number: u32,
        stage: StageId,
        point: crate::lineage::ResumePoint,
    ) -> Result<Run, ConductError> {
        let mut search = self
            .experiment
            .restore(number, &point.checkpoint)
            .map_err(|problem| ConductError::Checkpoint { run: number, problem: problem.to_string() })?;
        let individuals = tokio::task::block_in_place(|| search.ask());
        let same = individuals.len() == point.individuals.len()
            && individuals
                .iter()
                .zip(&point.individuals)
                .all(|(asked, standing)| standing.has(&asked.genotype));
        let (true, Some(first)) = (same, point.individuals.first()) else {
            return Err(ConductError::OtherHistory { run: number, generation: point.generation });
        };
        let known = |standing: &[crate::lineage::Standing]| {
            standing.iter().map(|one| one.ending.clone().map(Result::ok)).collect::<Vec<_>>()
        };
        let previous = point.previous.first().map(|first| {
            let none = vec![None; point.previous.len()];
            Generation::new(point.generation - 1, first.id, &none, known(&point.previous), None).0
        });
        let inherits: Vec<_> = individuals.iter().map(|individual| individual.inherits).collect();
        let settled = known(&point.individuals);
        let (generation, inherited) =
            Generation::new(point.generation, first.id, &inherits, settled, previous.as_ref());
        let run = Run {
            number,
            stage,
            search,
            generation,
            inherited: 0,
            opened: Instant::now(),
            evaluations: Vec::new(),
            again: BTreeMap::new(),
        };
        self.begin(run, individuals, inherited, point.culling).await
    }

    /// Writes the next generation down, with the end of the one before, and hands it out. None if the search
    /// asks for nothing more: then the stage is closed.
    #[allow(clippy::too_many_arguments, reason = "the parts of one transaction, named once")]
    async fn open(
        &self,
        number: u32,
        stage: StageId,
        search: Box<dyn Search>,
        checkpoint: Vec<u8>,
        individuals: Vec<search::Individual>,
        previous: Option<&Generation>,
        close: Option<CloseGeneration>,
    ) -> Result<Option<Run>, ConductError> {
        let lineage = &self.driver.shared.lineage;
        if individuals.is_empty() {
            let close =
                close.unwrap_or_else(|| CloseGeneration { record: Default::default(), wall_seconds: 0.0 });
            lineage.close_stage(stage, close, checkpoint).await?;
            return Ok(None);
        }
        let generation = previous.map_or(1, |previous| previous.number + 1);
        let culling = self.experiment.culling().map(|rule| Culling {
            at: rule.at,
            cutoff: previous
                .and_then(|previous| rule.cutoff(&previous.outcomes(), self.experiment.interim_measure())),
        });
        let ids = lineage
            .open_generation(OpenGeneration {
                stage,
                generation,
                checkpoint,
                culling,
                individuals: individuals.clone(),
                close,
            })
            .await?;
        let inherits: Vec<_> = individuals.iter().map(|individual| individual.inherits).collect();
        let none = vec![None; individuals.len()];
        let (generation, inherited) = Generation::new(generation, ids[0], &inherits, none, previous);
        let run = Run {
            number,
            stage,
            search,
            generation,
            inherited: 0,
            opened: Instant::now(),
            evaluations: Vec::new(),
            again: BTreeMap::new(),
        };
        self.begin(run, individuals, inherited, culling).await.map(Some)
    }

    /// Records what needs no evaluation and makes the others ready to be handed out.
    async fn begin(
        &self,
        mut run: Run,
        individuals: Vec<search::Individual>,
        inherited: Vec<Inherited>,
        culling: Option<Culling>,
    ) -> Result<Run, ConductError> {
        run.inherited = individuals.iter().filter(|individual| individual.inherits.is_some()).count() as u32;
        self.driver.shared.lineage.record(inherited.into_iter().map(take_over).collect()).await?;
        let unsettled = run.generation.unsettled();
        self.progress.settled(individuals.len() - unsettled.len(), 0);
        self.progress.generation(run.number, STAGE, &run.generation);
        let is_unsettled = unsettled.into_iter().collect::<BTreeSet<_>>();
        for (index, individual) in individuals.into_iter().enumerate() {
            let may_be_taken_back = self.experiment.audit > 0.0 && individual.inherits.is_none();
            if !may_be_taken_back && !is_unsettled.contains(&index) {
                continue;
            }
            let id = run.generation.id(index).expect("it has an id for each individual");
            let evaluation = self.evaluation(&run, id, index as u32, individual.genotype, culling);
            if is_unsettled.contains(&index) {
                run.evaluations.push(evaluation.clone());
            }
            if may_be_taken_back {
                run.again.insert(id, evaluation);
            }
        }
        Ok(run)
    }

    fn evaluation(
        &self,
        run: &Run,
        id: IndividualId,
        index: u32,
        genotype: Vec<u8>,
        culling: Option<Culling>,
    ) -> Evaluation {
        let seed = self.experiment.seed_of(run.number);
        let place = Place { stage: STAGE, generation: run.generation.number, index };
        Evaluation {
            id: id.0,
            order: (run.number, place.generation, place.index),
            task: self.task.clone(),
            genotype: Bytes::from(genotype),
            seed: evaluation_seed(seed, place),
            cull: culling.map(|culling| Cull {
                at: culling.at,
                cutoff: culling.cutoff,
                control: self.experiment.culling().is_some_and(|rule| rule.in_control(seed, place)),
            }),
            audit: self.experiment.audits(seed, place),
            attempts_before: 0,
        }
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
            self.progress.generation(run.number, STAGE, &run.generation);
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

    /// Tells the search a whole generation and opens the next.
    async fn turn(&self, mut run: Run) -> Result<Option<Run>, ConductError> {
        let outcomes = run.generation.outcomes();
        let (record, checkpoint, individuals) = tokio::task::block_in_place(|| {
            let record = run.search.tell(&outcomes);
            let checkpoint = run.search.checkpoint();
            (record, checkpoint, run.search.ask())
        });
        let seconds = run.opened.elapsed().as_secs_f64();
        let ended = Ended {
            run: run.number,
            stage: STAGE,
            generation: run.generation.number,
            generations: self.experiment.generations(),
            tally: Tally::of(&outcomes),
            inherited: run.inherited,
            best: run.generation.best().map(|(id, _)| id),
            seconds,
            notes: serde_json::Value::Object(record.notes.clone()).to_string(),
        };
        let close = CloseGeneration { record, wall_seconds: seconds };
        let next = self
            .open(
                run.number,
                run.stage,
                run.search,
                checkpoint,
                individuals,
                Some(&run.generation),
                Some(close),
            )
            .await?;
        if next.is_none() {
            self.progress.finished(run.number);
        }
        // Nobody listening is no error.
        let _ = self.driver.shared.happenings.send(Happening::Generation(self.id, Box::new(ended)));
        Ok(next)
    }
}

/// Waits until the driver stops.
async fn stopped(stopping: &mut watch::Receiver<bool>) {
    // An error says that the driver is gone, which is a stop as well.
    let _ = stopping.wait_for(|stopping| *stopping).await;
}

fn take_over(inherited: Inherited) -> Evaluated {
    Evaluated {
        individual: inherited.heir,
        ending: Ending::Inherits(inherited.from),
        ruling: None,
        audit: None,
        attempts: Vec::new(),
    }
}

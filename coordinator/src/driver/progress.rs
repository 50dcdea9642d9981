//! How far an experiment is, for those who watch. Counts that live in memory alone; the lineage knows better.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use creatures::{Outcome, Status};
use search::Experiment;

use super::generation::Known;
use super::run::Run;
use crate::lineage::{ExperimentId, IndividualId};

/// Something that watchers want to know.
#[derive(Debug, Clone)]
pub enum Happening {
    /// An experiment changed its state.
    State(ExperimentId),
    /// A generation has ended and is on disk.
    Generation(ExperimentId, Box<Ended>),
}

/// A generation that has ended.
#[derive(Debug, Clone)]
pub struct Ended {
    /// From 1.
    pub run: u32,
    /// From 0.
    pub stage: u32,
    /// The stage's name; may be empty.
    pub stage_name: String,
    /// From 1.
    pub generation: u32,
    /// Of the stage, when known.
    pub generations: Option<u32>,
    /// What became of its individuals.
    pub tally: Tally,
    /// How many of them inherited their outcome.
    pub inherited: u32,
    /// The best completed individual.
    pub best: Option<IndividualId>,
    /// On the wall, for statistics alone.
    pub seconds: f64,
    /// What the search said of it: a JSON object.
    pub notes: String,
}

/// What became of a number of individuals. Best, mean and worst are over all of them: one that did not
/// complete has fitness 0.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    /// All of them.
    pub individuals: u32,
    /// Simulated to their end.
    pub completed: u32,
    /// Stopped at their interim report.
    pub culled: u32,
    /// Stopped by the physics.
    pub aborted: u32,
    /// Set aside by the service.
    pub failed: u32,
    /// Fitness.
    pub best: f64,
    /// Fitness.
    pub mean: f64,
    /// Fitness.
    pub worst: f64,
    /// Physics steps simulated.
    pub steps: u64,
}

impl Tally {
    /// Counts up what is known of a generation.
    pub(super) fn of(outcomes: &[Known]) -> Tally {
        let mut tally = Tally { best: f64::NEG_INFINITY, worst: f64::INFINITY, ..Tally::default() };
        let mut sum = 0.0;
        for known in outcomes {
            tally.count(known.as_ref());
            let fitness = known.as_ref().map_or(0.0, |outcome| outcome.fitness);
            tally.best = tally.best.max(fitness);
            tally.worst = tally.worst.min(fitness);
            sum += fitness;
        }
        if outcomes.is_empty() {
            return Tally::default();
        }
        tally.mean = sum / outcomes.len() as f64;
        tally
    }

    fn count(&mut self, known: Option<&Outcome>) {
        self.individuals += 1;
        match known.map(|outcome| outcome.status) {
            Some(Status::Completed) => self.completed += 1,
            Some(Status::Culled) => self.culled += 1,
            Some(Status::Aborted(_)) => self.aborted += 1,
            None => self.failed += 1,
        }
        self.steps += known.map_or(0, |outcome| u64::from(outcome.steps));
    }
}

/// How far one run is.
#[derive(Debug, Clone, Default)]
pub struct RunProgress {
    /// From 0.
    pub stage: u32,
    /// The stage's name; may be empty.
    pub stage_name: String,
    /// The one under evaluation, from 1; 0 before the first.
    pub generation: u32,
    /// How many the stage takes, when it says so.
    pub generations: Option<u32>,
    /// How many individuals it has.
    pub size: usize,
    /// How many of them are settled.
    pub done: usize,
    /// The best completed individual of the stage since the run was taken up, and its fitness.
    pub best: Option<(IndividualId, f64)>,
    /// Every generation has ended.
    pub finished: bool,
}

/// How far an experiment is.
#[derive(Debug)]
pub struct Progress {
    state: Mutex<Counts>,
}

/// The counts behind [`Progress`].
#[derive(Debug, Clone)]
pub struct Counts {
    /// By run, from run 1.
    pub runs: Vec<RunProgress>,
    /// Settled in all, those included that were on disk when the experiment was taken up.
    pub evaluated: u64,
    /// Individuals in all runs, when the search knows.
    pub planned: Option<u64>,
    /// Settlements by evaluation alone, with the time of the first: for the rate.
    settled: u64,
    since: Option<Instant>,
}

impl Progress {
    /// Of an experiment that is taken up with so many settled.
    pub(super) fn new(experiment: &Experiment, evaluated: u64) -> Progress {
        let runs = vec![RunProgress::default(); experiment.runs as usize];
        Progress {
            state: Mutex::new(Counts {
                runs,
                evaluated,
                planned: experiment.planned(),
                settled: 0,
                since: None,
            }),
        }
    }

    /// A copy of the counts.
    pub fn counts(&self) -> Counts {
        self.lock().clone()
    }

    pub(super) fn generation(&self, of: &Run) {
        let mut counts = self.lock();
        let run = &mut counts.runs[of.number as usize - 1];
        if run.stage != of.named.number {
            run.best = None; // the fitness of different stages does not compare
        }
        if run.stage_name != of.named.name {
            run.stage_name.clone_from(&of.named.name);
        }
        run.generations = of.named.generations;
        let (size, done) = of.generation.progress();
        (run.stage, run.generation, run.size, run.done) = (of.named.number, of.generation.number, size, done);
        if let Some((id, fitness)) = of.generation.best()
            && run.best.is_none_or(|(_, best)| fitness > best)
        {
            run.best = Some((id, fitness));
        }
    }

    pub(super) fn settled(&self, inherited: usize, evaluated: usize) {
        let mut counts = self.lock();
        counts.evaluated += (inherited + evaluated) as u64;
        if evaluated > 0 {
            counts.settled += evaluated as u64;
            counts.since.get_or_insert_with(Instant::now);
        }
    }

    /// So many settlements of a run were taken back; its best may be among them.
    pub(super) fn taken_back(&self, run: u32, count: usize) {
        let mut counts = self.lock();
        counts.evaluated = counts.evaluated.saturating_sub(count as u64);
        counts.runs[run as usize - 1].best = None;
    }

    pub(super) fn finished(&self, run: u32) {
        self.lock().runs[run as usize - 1].finished = true;
    }

    fn lock(&self) -> MutexGuard<'_, Counts> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Counts {
    /// Evaluations a second since the first outcome.
    pub fn rate(&self) -> f64 {
        let seconds = self.since.map_or(0.0, |since| since.elapsed().as_secs_f64());
        if seconds > 0.0 { self.settled as f64 / seconds } else { 0.0 }
    }
}

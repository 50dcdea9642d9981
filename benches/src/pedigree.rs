//! A lineage of any size without physics: real searches and real genotypes through the real writer, with fitness
//! drawn from each genotype. It is as deep and as inbred as an evolved one, and made in minutes.

use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use coordinator::lineage::{
    Attempt, CloseGeneration, EndStage, Ending, Evaluated, Fate, InStage, IndividualId, Lineage,
    NewExperiment, NewStage, OpenGeneration,
};
use creatures::{Outcome, Status};
use search::{Experiment, Individual, Overrides, Place};

/// How large.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Repetitions.
    pub runs: u32,
    /// Generations of each run.
    pub generations: u32,
    /// Individuals of each generation.
    pub population: u32,
}

impl Size {
    /// About a million individuals in runs of the paper's size.
    pub const MILLION: Size = Size { runs: 42, generations: 300, population: 80 };

    /// Individuals in all.
    pub fn individuals(self) -> u64 {
        u64::from(self.runs) * u64::from(self.generations) * u64::from(self.population)
    }
}

/// What was made.
#[derive(Debug)]
pub struct Made {
    /// The best individual of the last generation written: as far from the founders as any.
    pub youngest: IndividualId,
    /// From the first row to the last commit, s, the searches' own time left out.
    pub seconds: f64,
}

/// Fills a new lineage. The last run is left as a kill would leave it: its last generation is open, without
/// outcomes.
///
/// # Errors
/// A lineage that cannot be written.
pub async fn make(path: &Path, size: Size) -> anyhow::Result<Made> {
    let lineage = Lineage::open(path).await.with_context(|| format!("cannot open {}", path.display()))?;
    let experiment = experiment(size);
    let id = lineage.create(vec![describe(&experiment)]).await?[0];
    let mut made = Made { youngest: IndividualId(0), seconds: 0.0 };
    for run in 1..=size.runs {
        let begun = Instant::now();
        let stage = lineage
            .open_stage(NewStage {
                experiment: id,
                run,
                stage: 0,
                name: String::new(),
                seed: experiment.seed_of(run),
                generations: Some(size.generations),
                task_json: None,
            })
            .await?;
        made.seconds += begun.elapsed().as_secs_f64();
        let mut search = experiment.start(run);
        let mut previous: Vec<(IndividualId, Option<Outcome>)> = Vec::new();
        let mut close = None;
        for generation in 1..=size.generations {
            let checkpoint = search.checkpoint();
            let individuals = search.ask();
            let begun = Instant::now();
            let opened = OpenGeneration {
                stage: InStage::Open(stage, 0),
                generation,
                checkpoint,
                culling: None,
                individuals: individuals.clone(),
                close: close.take(),
                ends: None,
                choice: None,
            };
            let (_, ids) = lineage.open_generation(opened).await?;
            made.seconds += begun.elapsed().as_secs_f64();
            made.youngest = ids[0];
            if run == size.runs && generation == size.generations {
                break;
            }
            let mut current: Vec<(IndividualId, Option<Outcome>)> = Vec::new();
            let mut evaluated = Vec::new();
            for (individual, id) in individuals.iter().zip(ids) {
                let (ending, outcome) = live(individual, generation, &previous, &current);
                let attempts =
                    if matches!(ending, Ending::Settled(_)) { vec![attempt(&outcome)] } else { Vec::new() };
                evaluated.push(Evaluated { individual: id, ending, ruling: None, audit: None, attempts });
                current.push((id, Some(outcome)));
            }
            let begun = Instant::now();
            lineage.record(evaluated).await?;
            made.seconds += begun.elapsed().as_secs_f64();
            let outcomes: Vec<Option<Outcome>> = current.iter().map(|(_, outcome)| outcome.clone()).collect();
            close = Some(CloseGeneration { record: search.tell(&outcomes), wall_seconds: 0.2 });
            previous = current;
        }
        if let Some(close) = close.take() {
            let begun = Instant::now();
            let ends = EndStage { stage, close, checkpoint: search.checkpoint(), over: true };
            lineage.end_stage(ends, None).await?;
            made.seconds += begun.elapsed().as_secs_f64();
        }
    }
    let begun = Instant::now();
    lineage.close().await?;
    made.seconds += begun.elapsed().as_secs_f64();
    Ok(made)
}

/// Crawlers under the gene regulatory network's genetic algorithm.
fn experiment(size: Size) -> Experiment {
    let Size { runs, generations, population } = size;
    let text = format!(
        "name = 'pedigree'\nsystem = 'walker'\nseed = 1\nruns = {runs}\n[task]\nbody = 'crawler'\n[search]\n\
         kind = 'grn'\npopulation = {population}\ngenerations = {generations}\n"
    );
    let mut cells = Experiment::parse(&text, &Overrides::default()).expect("a legal experiment");
    cells.remove(0)
}

fn describe(experiment: &Experiment) -> NewExperiment {
    let system = creatures::system(&experiment.system).expect("a parsed experiment names a known system");
    NewExperiment {
        name: experiment.name.clone(),
        group: None,
        cell: experiment.coordinates(),
        system: experiment.system.clone(),
        system_version: system.version(),
        search_kind: experiment.search_kind().to_owned(),
        seed: experiment.seed,
        runs: experiment.runs,
        task_json: experiment.task_json(),
        resolved: experiment.resolved(),
        digest: experiment.digest(),
        published: experiment.published(),
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: creatures::fingerprint(),
        planned: experiment.planned(),
        origin: None,
    }
}

/// What becomes of an individual without a life: the outcome that it inherits, or one drawn from its genotype,
/// with as many measures as a walker's (walker G-62).
fn live(
    individual: &Individual,
    generation: u32,
    previous: &[(IndividualId, Option<Outcome>)],
    current: &[(IndividualId, Option<Outcome>)],
) -> (Ending, Outcome) {
    if let Some(from) = individual.inherits {
        let before = if from.generation == generation { current } else { previous };
        let (giver, outcome) = &before[from.index as usize];
        return (Ending::Inherits(*giver), outcome.clone().expect("a giver has lived"));
    }
    let place = Place { stage: 0, generation: 0, index: 0 };
    let sum =
        individual.genotype.iter().fold(0u64, |sum, &byte| sum.wrapping_mul(31).wrapping_add(byte.into()));
    let mut draws = place.stream(sum, "life");
    let names =
        ["dis", "x", "y", "peak_height", "peak_speed", "turns", "idle_share", "grn_collapse", "straightness"];
    let outcome = Outcome {
        status: Status::Completed,
        fitness: draws.between(0.0, 60.0),
        steps: 1800,
        measures: names.into_iter().map(|name| (name.to_owned(), draws.between(-10.0, 10.0))).collect(),
        interim: None,
        note: String::new(),
    };
    (Ending::Settled(Ok(outcome.clone())), outcome)
}

fn attempt(outcome: &Outcome) -> Attempt {
    Attempt {
        number: 1,
        worker: "worker-1".to_owned(),
        fate: Fate::Counted,
        steps: u64::from(outcome.steps),
        seconds: 0.003,
    }
}

//! Who submits evaluations and takes their outcomes, in the driver's stead: generation by generation, with a
//! disk that survives kills and takes a moment to write. It checks each outcome as it comes.

use crate::leave::Leave;
use coordinator::fleet::{Evaluation, Fleet, Queue, QueueOutput, Settled, TaskText};
use coordinator::lineage::evaluation_seed;
use creatures::{Cull, Outcome, Task};
use hatchery_tests::local;
use search::{Experiment, Individual, Place};
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::time::sleep;

/// What an outcome that has arrived takes to be on disk.
const COMMIT: Duration = Duration::from_millis(20);

const EXPERIMENT: &str = r#"
name = "simulated"
system = "probe"
seed = 1
runs = 1

[task]
work = 8

[search]
kind = "probe"
population = 6
generations = 4
payload = 16

[culling]
at = 0.5
fraction = 0.5
"#;

/// The experiment and what comes of it where nothing goes wrong.
pub(crate) struct Undisturbed {
    experiment: Experiment,
    text: Arc<TaskText>,
    task: Box<dyn Task>,
    lineage: String,
}

/// What survives a kill of the coordinator. Generations that are over, in order, and the open one.
#[derive(Default)]
pub(crate) struct Disk {
    closed: Vec<Vec<local::Lived>>,
    /// Of the open generation, by index.
    outcomes: BTreeMap<u32, Outcome>,
    checkpoint: Option<Vec<u8>>,
    /// The hash, once every generation is over.
    pub(crate) lineage: Option<String>,
}

/// What came out in one life of the coordinator.
struct Seen {
    settled: BTreeSet<u64>,
    leave: Leave,
}

impl Undisturbed {
    pub(crate) fn live() -> Undisturbed {
        let experiment = local::experiment(EXPERIMENT);
        let system = creatures::system("probe").expect("the probe is registered");
        let spec = experiment.task_json();
        let task = system.task(&spec).expect("a parsed experiment has a legal task");
        let text = Arc::new(TaskText::new("probe", system.version(), &spec));
        Undisturbed { experiment, text, task, lineage: local::lineage(EXPERIMENT) }
    }

    pub(crate) fn lineage(&self) -> &str {
        &self.lineage
    }

    fn evaluation(&self, place: Place, individual: &Individual, cutoff: Option<f64>) -> Evaluation {
        let run_seed = self.experiment.seed_of(1);
        let rule = self.experiment.culling().expect("the experiment has a rule");
        Evaluation {
            id: id(place),
            order: (1, place.generation, place.index),
            task: self.text.clone(),
            genotype: individual.genotype.clone().into(),
            seed: evaluation_seed(run_seed, place),
            cull: Some(Cull { at: rule.at, cutoff, control: rule.in_control(run_seed, place) }),
            audit: false,
            attempts_before: 0,
        }
    }
}

/// Unique in the experiment, as an individual's id is.
fn id(place: Place) -> u64 {
    u64::from(place.generation) * 100 + u64::from(place.index)
}

/// Conducts the experiment from where the disk says, until it is over. Notes what is settled, for the trace.
///
/// # Errors
/// Whatever must never happen.
pub(crate) async fn conduct(
    of: &Undisturbed,
    fleet: &Fleet,
    disk: &Mutex<Disk>,
    note: impl Fn(String),
) -> Result<(), Box<dyn Error>> {
    let mut seen = Seen { settled: BTreeSet::new(), leave: Leave::watch(fleet) };
    let (queue, mut output) = fleet.queue("simulated".to_owned(), 1).await;
    loop {
        let checkpoint = disk.lock().expect("one thread").checkpoint.clone();
        let mut search = match checkpoint {
            Some(checkpoint) => of.experiment.restore(1, &checkpoint)?,
            None => of.experiment.start(1),
        };
        let individuals = search.ask();
        if individuals.is_empty() {
            let mut disk = disk.lock().expect("one thread");
            disk.lineage = Some(local::hash_of(disk.closed.iter().flatten()));
            return Ok(());
        }
        let lived = generation(of, &queue, &mut output, disk, &mut seen, individuals, &note).await?;
        search.tell(&lived.iter().map(|one| Some(one.outcome.clone())).collect::<Vec<_>>());
        // One transaction: the end of this generation and the search before the next one.
        let mut disk = disk.lock().expect("one thread");
        disk.checkpoint = Some(search.checkpoint());
        disk.outcomes.clear();
        disk.closed.push(lived);
    }
}

/// One generation, as far as it is not on disk yet.
async fn generation(
    of: &Undisturbed,
    queue: &Queue,
    output: &mut QueueOutput,
    disk: &Mutex<Disk>,
    seen: &mut Seen,
    individuals: Vec<Individual>,
    note: &impl Fn(String),
) -> Result<Vec<local::Lived>, Box<dyn Error>> {
    let (number, previous) = {
        let disk = disk.lock().expect("one thread");
        let previous = disk.closed.last().map(|lived| lived.iter().map(|one| Some(one.outcome.clone())));
        (disk.closed.len() as u32 + 1, previous.map(Iterator::collect::<Vec<_>>))
    };
    let rule = of.experiment.culling().expect("the experiment has a rule");
    let cutoff =
        previous.and_then(|all| rule.cutoff(&all, of.experiment.interim_measure(of.experiment.task())));
    let asked = (0..).zip(&individuals).map(|(index, individual)| {
        let place = Place { stage: 0, generation: number, index };
        (index, of.evaluation(place, individual, cutoff))
    });
    let mut missing: BTreeMap<u64, (u32, Evaluation)> = asked.map(|(i, e)| (e.id, (i, e))).collect();
    missing.retain(|_, (index, _)| !disk.lock().expect("one thread").outcomes.contains_key(index));
    queue.submit(missing.values().map(|(_, evaluation)| evaluation.clone()).collect()).await;
    while !missing.is_empty() {
        let settled = output.next().await.ok_or("the queue ended by itself")?;
        if let Some(conflict) = output.take_conflicts().first() {
            return Err(format!("workers disagree: {conflict:?}").into());
        }
        sleep(COMMIT).await;
        for one in settled {
            note(format!("{one:?}"));
            seen.leave.check(&one)?;
            if !seen.settled.insert(one.id) {
                return Err(format!("evaluation {} is settled twice", one.id).into());
            }
            let (index, evaluation) =
                missing.remove(&one.id).ok_or_else(|| format!("nobody asked for {}", one.id))?;
            disk.lock().expect("one thread").outcomes.insert(index, check(of, &evaluation, one)?);
        }
    }
    let outcomes = disk.lock().expect("one thread").outcomes.clone();
    let lived = individuals.into_iter().zip(outcomes).map(|(individual, (index, outcome))| {
        let place = Place { stage: 0, generation: number, index };
        let evaluation = of.evaluation(place, &individual, cutoff);
        local::Lived { run: 1, place, individual, seed: evaluation.seed, cull: evaluation.cull, outcome }
    });
    Ok(lived.collect())
}

/// An outcome must be what evaluating it here gives, to the bit.
fn check(of: &Undisturbed, evaluation: &Evaluation, settled: Settled) -> Result<Outcome, Box<dyn Error>> {
    let outcome = settled.result.map_err(|aside| format!("evaluation {}: {aside}", settled.id))?;
    let here = of.task.evaluate(
        &evaluation.genotype,
        evaluation.seed,
        evaluation.cull.as_ref(),
        &mut creatures::Nobody,
    )?;
    if outcome.digest() != here.digest() {
        return Err(format!("evaluation {}: {outcome:?} is not {here:?}", settled.id).into());
    }
    Ok(outcome)
}

//! An experiment evaluated in this process, one individual after the other: no fleet, no database, no stream.
//! What it gives is what every distributed run must give.

use creatures::{Cull, Nobody, Outcome, Status};
use search::hash::{HashRow, LineageHasher};
use search::{Experiment, Individual, Overrides, PickedBy, Place};

/// One individual with its outcome.
#[derive(Debug)]
pub struct Lived {
    /// Which repetition, from 1.
    pub run: u32,
    /// Where it stands in its run.
    pub place: Place,
    /// As the search asked for it.
    pub individual: Individual,
    /// The seed of its evaluation.
    pub seed: u64,
    /// The rule that it was evaluated under.
    pub cull: Option<Cull>,
    /// What came of it; taken over from another individual where it inherits.
    pub outcome: Outcome,
}

/// The one experiment of a file without a matrix.
///
/// # Panics
/// When the file is no such experiment.
pub fn experiment(text: &str) -> Experiment {
    let mut experiments = Experiment::parse(text, &Overrides::default()).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(experiments.len(), 1, "a file without a matrix makes one experiment");
    experiments.remove(0)
}

/// The lineage hash of an experiment file without a matrix, in hexadecimal. Where a person has to pick, the
/// best is taken.
///
/// # Panics
/// When the file is no such experiment.
pub fn lineage(text: &str) -> String {
    lineage_of_picks(text, &[])
}

/// As [`lineage`], with the ranks (from 1) of those whom a person picks in each run, stage by stage.
///
/// # Panics
/// When the file is no such experiment, or has no such candidates.
pub fn lineage_of_picks(text: &str, ranks: &[usize]) -> String {
    let experiment = experiment(text);
    let mut hasher = LineageHasher::new();
    for run in 1..=experiment.runs {
        for event in run_alone(&experiment, run, ranks) {
            match event {
                Event::Lived(lived) => hash(&mut hasher, &lived),
                Event::Picked { stage, place } => hasher.pick(run, stage, place),
            }
        }
    }
    hasher.finish().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The lineage hash of individuals in order of run and place, among whom nobody was picked, in hexadecimal.
pub fn hash_of<'a>(history: impl IntoIterator<Item = &'a Lived>) -> String {
    let mut hasher = LineageHasher::new();
    for lived in history {
        hash(&mut hasher, lived);
    }
    hasher.finish().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Every individual of an experiment, in order of run and place.
pub fn history(experiment: &Experiment) -> Vec<Lived> {
    let lived = |event| match event {
        Event::Lived(lived) => Some(*lived),
        Event::Picked { .. } => None,
    };
    (1..=experiment.runs).flat_map(|run| run_alone(experiment, run, &[])).filter_map(lived).collect()
}

/// What a run is made of.
enum Event {
    Lived(Box<Lived>),
    /// At the end of which stage, and who.
    Picked {
        stage: u32,
        place: Place,
    },
}

/// One run, from its first generation to its last.
fn run_alone(experiment: &Experiment, run: u32, ranks: &[usize]) -> Vec<Event> {
    let system = creatures::system(&experiment.system).expect("a parsed experiment names a system");
    let run_seed = experiment.seed_of(run);
    let mut search = experiment.start(run);
    let mut history: Vec<Event> = Vec::new();
    let mut previous: Vec<Option<Outcome>> = Vec::new();
    let mut ranks = ranks.iter();
    let (mut stage, mut generation) = (None, 0);
    loop {
        let individuals = search.ask();
        if individuals.is_empty() {
            let Some(choice) = search.choice() else { break };
            let rank = if choice.by == PickedBy::Human { ranks.next().copied().unwrap_or(1) } else { 1 };
            let place = choice.candidates[rank - 1].place;
            history.push(Event::Picked { stage: search.stage().number, place });
            search.pick(place).expect("a candidate may be picked");
            continue;
        }
        let named = search.stage();
        if stage.replace(named.number) != Some(named.number) {
            generation = 0;
        }
        generation += 1;
        let spec = named.task.unwrap_or_else(|| experiment.task().clone());
        let task = system.task(&spec.to_string()).expect("a search asks for legal tasks");
        let rule = experiment.culling();
        let cutoff = match rule {
            Some(rule) if generation > 1 => rule.cutoff(&previous, experiment.interim_measure(&spec)),
            _ => None,
        };
        let mut outcomes: Vec<Option<Outcome>> = Vec::new();
        for (index, individual) in (0..).zip(individuals) {
            let place = Place { stage: named.number, generation, index };
            let seed = coordinator::lineage::evaluation_seed(run_seed, place);
            let cull =
                rule.map(|rule| Cull { at: rule.at, cutoff, control: rule.in_control(run_seed, place) });
            let outcome = match individual.inherits {
                Some(from) if from.generation == generation => outcomes[from.index as usize].clone(),
                Some(from) => previous[from.index as usize].clone(),
                None => {
                    let outcome = task.evaluate(&individual.genotype, seed, cull.as_ref(), &mut Nobody);
                    Some(outcome.expect("a search makes legal genotypes"))
                }
            };
            let outcome = outcome.expect("nothing is set aside without a fleet");
            outcomes.push(Some(outcome.clone()));
            history.push(Event::Lived(Box::new(Lived { run, place, individual, seed, cull, outcome })));
        }
        search.tell(&outcomes);
        previous = outcomes;
    }
    history
}

fn hash(hasher: &mut LineageHasher, lived: &Lived) {
    let status = match lived.outcome.status {
        Status::Completed => "completed".to_owned(),
        Status::Culled => "culled".to_owned(),
        Status::Aborted(reason) => format!("aborted:{}", reason.word()),
    };
    let parents = &lived.individual.parents;
    hasher.row(&HashRow {
        run: lived.run,
        place: lived.place,
        genotype: &lived.individual.genotype,
        parents: &parents.iter().map(|parent| (parent.place, parent.role.as_str())).collect::<Vec<_>>(),
        operator: &lived.individual.operator,
        status: &status,
        fitness: lived.outcome.fitness,
    });
}

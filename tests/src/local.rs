//! An experiment evaluated in this process, one individual after the other: no fleet, no database, no stream.
//! What it gives is what every distributed run must give.

use creatures::{Cull, Outcome, Status};
use search::hash::{HashRow, LineageHasher};
use search::{Experiment, Individual, Overrides, Place};

/// The lineage hash of an experiment file without a matrix, in hexadecimal.
///
/// # Panics
/// When the file is no experiment.
pub fn lineage(text: &str) -> String {
    let experiments = Experiment::parse(text, &Overrides::default()).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(experiments.len(), 1, "a file without a matrix makes one experiment");
    let experiment = &experiments[0];
    let mut hasher = LineageHasher::new();
    for run in 1..=experiment.runs {
        evaluate(experiment, run, &mut hasher);
    }
    hasher.finish().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// One run, from its first generation to its last.
fn evaluate(experiment: &Experiment, run: u32, hasher: &mut LineageHasher) {
    let system = creatures::system(&experiment.system).expect("a parsed experiment names a system");
    let task = system.task(&experiment.task_json()).expect("a parsed experiment has a legal task");
    let seed = experiment.seed_of(run);
    let mut search = experiment.start(run);
    let mut previous: Vec<Option<Outcome>> = Vec::new();
    for generation in 1.. {
        let individuals = search.ask();
        if individuals.is_empty() {
            return;
        }
        let culling = experiment.culling();
        let cutoff = match culling {
            Some(rule) if generation > 1 => rule.cutoff(&previous, experiment.interim_measure()),
            _ => None,
        };
        let mut outcomes: Vec<Option<Outcome>> = Vec::new();
        for (index, individual) in (0..).zip(&individuals) {
            let place = Place { stage: 0, generation, index };
            let outcome = match individual.inherits {
                Some(from) if from.generation == generation => outcomes[from.index as usize].clone(),
                Some(from) => previous[from.index as usize].clone(),
                None => {
                    let cull = culling.map(|rule| Cull { at: rule.at, cutoff, control: rule.in_control(seed, place) });
                    let seed = coordinator::lineage::evaluation_seed(seed, place);
                    let outcome = task.evaluate(&individual.genotype, seed, cull.as_ref(), &mut |_| {});
                    Some(outcome.expect("a search makes legal genotypes"))
                }
            };
            hash(hasher, run, place, individual, outcome.as_ref());
            outcomes.push(outcome);
        }
        search.tell(&outcomes);
        previous = outcomes;
    }
}

fn hash(hasher: &mut LineageHasher, run: u32, place: Place, individual: &Individual, outcome: Option<&Outcome>) {
    let outcome = outcome.expect("nothing is set aside without a fleet");
    let status = match outcome.status {
        Status::Completed => "completed".to_owned(),
        Status::Culled => "culled".to_owned(),
        Status::Aborted(reason) => format!("aborted:{}", reason.word()),
    };
    let parents: Vec<_> = individual.parents.iter().map(|parent| (parent.place, parent.role.as_str())).collect();
    hasher.row(&HashRow {
        run,
        place,
        genotype: &individual.genotype,
        parents: &parents,
        operator: &individual.operator,
        status: &status,
        fitness: outcome.fitness,
    });
}

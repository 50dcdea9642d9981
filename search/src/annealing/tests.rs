use super::*;
use crate::Place;
use creatures::fish::{Fish, Genotype};
use creatures::{Nobody, Status, System, Task};
use serde_json::json;
use std::collections::BTreeMap;

fn drill() -> Value {
    Fish.resolve(json!({"scenario": "drill"})).unwrap()
}

fn plan(table: Value) -> Settings {
    Settings::read(table, &drill()).unwrap()
}

fn task() -> Box<dyn Task> {
    Fish.task(&drill().to_string()).unwrap()
}

/// The outcomes of a generation; with `backwards` they are lived in another order.
fn live(task: &dyn Task, individuals: &[Individual], backwards: bool) -> Vec<Option<Outcome>> {
    let live = |individual: &Individual| task.evaluate(&individual.genotype, 1, None, &mut Nobody).ok();
    if backwards {
        let mut outcomes: Vec<_> = individuals.iter().rev().map(live).collect();
        outcomes.reverse();
        return outcomes;
    }
    individuals.iter().map(live).collect()
}

/// the default is the published schedule, and a turn is annealed hotter.
#[test]
fn the_published_schedule_is_the_default() {
    let settings = plan(json!({"kind": "anneal"}));
    assert_eq!((settings.population(), settings.generations()), (8, 6841));
    let expected = json!({
        "kind": "anneal", "chains": 8, "steps": 6840, "encoding": "tied", "samples": 15, "moves": 3,
        "temperature": {"start": 0.005, "end": 0.0001}, "deviation": {"start": 0.5, "end": 0.1},
    });
    assert_eq!(settings.table(), expected);
    assert_eq!(plan(settings.table()), settings);
    let turn = json!({"scenario": "drill", "lesson": {"objective": {"criterion": {"heading_degrees": 30}}}});
    let turn = Settings::read(json!({"kind": "anneal"}), &Fish.resolve(turn).unwrap()).unwrap();
    assert_eq!(turn.temperature, Cooling { start: 0.05, end: 0.001 });
}

/// AF-17
#[test]
fn a_schedule_out_of_range_is_refused_by_its_key() {
    let refused = |table: Value| Settings::read(table, &drill()).unwrap_err().path;
    assert_eq!(refused(json!({"temperature": {"start": 0.0, "end": 0.0}})), "temperature.start");
    assert_eq!(refused(json!({"temperature": {"start": 0.01, "end": 0.02}})), "temperature.end");
    assert_eq!(refused(json!({"temperature": {"start": 0.01, "end": 0.0}})), "temperature.end");
    assert_eq!(refused(json!({"deviation": {"start": -0.5, "end": 0.1}})), "deviation.start");
    assert_eq!(refused(json!({"steps": 0})), "steps");
    assert_eq!(refused(json!({"chains": 0})), "chains");
    assert_eq!(refused(json!({"samples": 3})), "samples");
    assert_eq!(refused(json!({"moves": 0})), "moves");
    assert_eq!(refused(json!({"cooling": 1})), "cooling");
    let race = Fish.resolve(json!({"scenario": "race"})).unwrap();
    assert_eq!(Settings::read(json!({"kind": "anneal"}), &race).unwrap_err().path, "kind");
}

/// What a chain went through: place, value and whether it was accepted, by E_min as the traits have it.
type Rows = Vec<(Place, u64, bool, Vec<u8>)>;

/// Anneals to the end. Before each of the given generations the search is killed and restored.
fn anneal(settings: &Settings, kills: &[u32], backwards: bool) -> Rows {
    let task = task();
    let mut search = settings.start(9, 0);
    let mut rows = Rows::new();
    for generation in 1.. {
        if kills.contains(&generation) {
            let checkpoint = search.checkpoint();
            search.ask();
            search = settings.restore(9, 0, &checkpoint).unwrap();
        }
        let individuals = search.ask();
        if individuals.is_empty() {
            return rows;
        }
        let outcomes = live(&*task, &individuals, backwards);
        for (index, (individual, outcome)) in (0..).zip(individuals.iter().zip(&outcomes)) {
            let place = Place { stage: 0, generation, index };
            let value = outcome.as_ref().unwrap().fitness;
            let threshold = individual.traits["threshold"].as_f64();
            let accepted = threshold.is_none_or(|threshold| value >= threshold);
            rows.push((place, value.to_bits(), accepted, individual.genotype.clone()));
        }
        search.tell(&outcomes);
    }
    rows
}

/// T-25: the pure part. The order of evaluation and kills change no bit of any row.
#[test]
fn chains_are_the_same_bit_for_bit_however_they_are_evaluated() {
    let settings = plan(json!({"chains": 4, "steps": 60}));
    let rows = anneal(&settings, &[], false);
    assert_eq!(rows.len(), 4 * 61);
    assert_eq!(anneal(&settings, &[1, 2, 17, 61], true), rows);
}

/// a candidate has one parent, its chain's current state, from which it differs in three samples at most.
#[test]
fn every_candidate_comes_from_the_state_that_its_chain_is_in() {
    let settings = plan(json!({"chains": 2, "steps": 40}));
    let task = task();
    let mut search = settings.start(3, 0);
    let mut genotypes: BTreeMap<Place, Vec<f64>> = BTreeMap::new();
    let mut current: Vec<Place> = Vec::new();
    let (mut accepted, mut rejected) = (0, 0);
    for generation in 1..=41 {
        let individuals = search.ask();
        let outcomes = live(&*task, &individuals, false);
        for (index, (individual, outcome)) in (0..).zip(individuals.iter().zip(&outcomes)) {
            let place = Place { stage: 0, generation, index };
            let Genotype::MuscleSamples(samples) = Genotype::decode(&individual.genotype).unwrap() else {
                unreachable!("chains hold samples")
            };
            if generation > 1 {
                let parent = individual.parents[0].place;
                assert_eq!((individual.parents.len(), parent), (1, current[index as usize]));
                let changed = genotypes[&parent].iter().zip(&samples.values).filter(|(a, b)| a != b).count();
                assert!((1..=3).contains(&changed), "{changed}");
            }
            genotypes.insert(place, samples.values);
            let value = outcome.as_ref().unwrap().fitness;
            match individual.traits["threshold"].as_f64() {
                None => current.push(place),
                Some(threshold) if value >= threshold => {
                    current[index as usize] = place;
                    accepted += 1;
                }
                Some(_) => rejected += 1,
            }
        }
        search.tell(&outcomes);
    }
    assert!(accepted > 10 && rejected > 10, "{accepted} {rejected}");
}

/// AF-8: who breaks or is set aside is rejected, whatever the temperature.
#[test]
fn a_chain_rejects_who_did_not_live_to_the_end() {
    let settings = plan(json!({"chains": 1, "steps": 5, "temperature": {"start": 1000.0, "end": 1000.0}}));
    let task = task();
    let mut search = settings.start(1, 0);
    let first = search.ask();
    search.tell(&live(&*task, &first, false));
    let aborted = |individuals: &[Individual]| {
        let mut outcomes = live(&*task, individuals, false);
        let outcome = outcomes[0].as_mut().unwrap();
        (outcome.status, outcome.fitness) = (Status::Aborted(creatures::Reason::BlowUp), 0.0);
        outcomes
    };
    let second = search.ask();
    assert_eq!(search.tell(&aborted(&second)).notes["accepted"], 0);
    let third = search.ask();
    assert_eq!(third[0].parents[0].place.generation, 1);
    assert_eq!(search.tell(&[None]).notes["accepted"], 0);
    let fourth = search.ask();
    assert_eq!(search.tell(&live(&*task, &fourth, false)).notes["accepted"], 1, "it is hot");
    assert_eq!(search.ask()[0].parents[0].place.generation, 4);

    // A chain whose founder breaks has nothing to lose.
    let mut search = settings.start(1, 0);
    let first = search.ask();
    search.tell(&aborted(&first));
    let restored = settings.restore(1, 0, &search.checkpoint()).unwrap().ask();
    let second = search.ask();
    assert_eq!(restored, second);
    assert!(second[0].traits["threshold"].is_null());
    assert_eq!(search.tell(&live(&*task, &second, false)).notes["accepted"], 1);
}

#[test]
fn a_checkpoint_of_other_chains_is_refused() {
    let small = plan(json!({"chains": 2, "steps": 5}));
    let mut search = small.start(1, 0);
    let first = search.ask();
    search.tell(&live(&*task(), &first, false));
    let checkpoint = search.checkpoint();
    let refused = |table: Value| plan(table).restore(1, 0, &checkpoint).err().unwrap().to_string();
    let unfit = "checkpoint does not fit its search: it has another number of chains";
    assert_eq!(refused(json!({"chains": 3, "steps": 5})), unfit);
    assert!(plan(json!({"chains": 2, "steps": 9})).restore(1, 0, &checkpoint).is_ok());
}

/// progress of a tied chain's best state at k = 90 and 1440 of 6840.
#[test]
fn practice_makes_a_swimmer() {
    let settings = plan(json!({"chains": 1}));
    let task = task();
    let mut search = settings.start(1, 0);
    let (mut best, mut progress) = (f64::NEG_INFINITY, 0.0);
    let mut seen = Vec::new();
    for step in 0..=1440 {
        let individuals = search.ask();
        let outcomes = live(&*task, &individuals, false);
        let outcome = outcomes[0].as_ref().unwrap();
        if outcome.fitness > best {
            best = outcome.fitness;
            progress = outcome.measures.iter().find(|(name, _)| name == "progress").unwrap().1;
        }
        if step == 90 || step == 1440 {
            seen.push(progress);
        }
        search.tell(&outcomes);
    }
    assert!(seen[0] < 0.09 && (0.11..0.25).contains(&seen[1]), "{seen:?}");
}

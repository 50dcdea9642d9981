use super::*;
use creatures::fish::{Fish, Genotype};
use creatures::{Nobody, System, Task};
use serde_json::json;

fn curriculum() -> Value {
    let task = json!({"scenario": "learning", "race": {"steps": 364}, "buoys": {"steps": 400, "trials": 1}});
    Fish.resolve(task).unwrap()
}

fn plan(table: Value) -> Settings {
    Settings::read(table, &curriculum()).unwrap()
}

#[test]
fn every_default_is_filled_in() {
    let settings = plan(json!({"kind": "learning", "chains": 2, "steps": 50}));
    assert_eq!((settings.population(), settings.generations()), (4, 53));
    let table = settings.table();
    assert_eq!(table["temperatures"][1], json!({"start": 0.05, "end": 0.001}));
    assert_eq!((&table["gains"], &table["oscillations"]), (&json!([0.5, 1.0, 1.5]), &json!(1)));
    assert_eq!(plan(table), settings);
}

/// AF-17
#[test]
fn a_curriculum_out_of_range_is_refused_by_its_key() {
    let refused = |table: Value| Settings::read(table, &curriculum()).unwrap_err().path;
    assert_eq!(refused(json!({"temperatures": [{"start": 1.0, "end": 0.1}]})), "temperatures");
    let hot = json!([{"start": 1.0, "end": 0.1}, {"start": 0.1, "end": 1.0}]);
    assert_eq!(refused(json!({"temperatures": hot})), "temperatures[1].end");
    assert_eq!(refused(json!({"gains": []})), "gains");
    assert_eq!(refused(json!({"gains": [1.0, -1.0]})), "gains.1");
    assert_eq!(refused(json!({"oscillations": 8})), "oscillations");
    assert_eq!(refused(json!({"temperature": 1})), "temperature");
    let swims = Fish.resolve(json!({"scenario": "learning", "lessons": [{}]})).unwrap();
    assert_eq!(Settings::read(json!({}), &swims).unwrap_err().problem, "`learning` needs a lesson of a turn");
    let drill = Fish.resolve(json!({"scenario": "drill"})).unwrap();
    assert_eq!(Settings::read(json!({}), &drill).unwrap_err().path, "kind");
}

/// Everybody of a run, generation by generation, with the fitness of each. Before each of the given generations
/// the search is killed and restored.
fn learn(settings: &Settings, kills: &[usize]) -> Vec<Vec<(Individual, u64)>> {
    let task: Box<dyn Task> = Fish.task(&curriculum().to_string()).unwrap();
    let mut search = settings.start(2, 0);
    let mut generations = Vec::new();
    loop {
        if kills.contains(&generations.len()) {
            let checkpoint = search.checkpoint();
            search.ask();
            search = settings.restore(2, 0, &checkpoint).unwrap();
        }
        let individuals = search.ask();
        if individuals.is_empty() {
            return generations;
        }
        let live = |individual: &Individual| task.evaluate(&individual.genotype, 3, None, &mut Nobody).ok();
        let outcomes: Vec<_> = individuals.iter().map(live).collect();
        search.tell(&outcomes);
        let fitness = outcomes.iter().map(|outcome| outcome.as_ref().unwrap().fitness.to_bits());
        generations.push(individuals.into_iter().zip(fitness).collect());
    }
}

/// A-41..A-44, A-90: practice, race, buoys; every controller leads back to its chain's random start.
#[test]
fn practice_leads_to_controllers_and_these_to_sets() {
    let settings = plan(json!({"chains": 2, "steps": 60}));
    let generations = learn(&settings, &[]);
    assert_eq!(generations.len(), 63);
    let kind = |individual: &Individual| Genotype::decode(&individual.genotype).unwrap().kind();
    let race = &generations[61];
    assert_eq!(race.len(), (2 + 2 * 2) * 3, "two swims, two turns on each of them, three gains");
    assert!(race.iter().all(|(racer, _)| kind(racer) == "controller" && racer.operator == "abstract"));
    let sets = &generations[62];
    assert!((1..=2).contains(&sets.len()), "{}", sets.len());
    for (set, _) in sets {
        assert_eq!((kind(set), set.operator.as_str()), ("controller_set", "assemble"));
        assert!(set.parents.len() >= 2 && set.parents.iter().all(|parent| parent.place.generation == 62));
    }
    // From the first set by first parents.
    let (mut place, mut operators) = (Place { stage: 0, generation: 63, index: 0 }, vec![]);
    loop {
        let (individual, _) = &generations[place.generation as usize - 1][place.index as usize];
        operators.push(individual.operator.as_str());
        match individual.parents.first() {
            Some(parent) => place = parent.place,
            None => break,
        }
    }
    assert_eq!((operators[0], operators[1], *operators.last().unwrap()), ("assemble", "abstract", "random"));
    assert!(operators[2..operators.len() - 1].iter().all(|operator| *operator == "anneal"));
    assert!(operators.len() > 10, "{operators:?}");
}

/// T-25: in every phase, kills change no bit.
#[test]
fn a_curriculum_goes_on_from_its_checkpoints() {
    let settings = plan(json!({"chains": 1, "steps": 12}));
    let whole = learn(&settings, &[]);
    assert_eq!(whole.len(), 15);
    assert_eq!(learn(&settings, &[0, 1, 7, 13, 14, 15]), whole);
}

use super::*;
use crate::fish::Fish;
use crate::fish::habits::{Habits, Sex};
use crate::record::{Happening, Keeper, Recording};
use crate::{Cull, Interim, Nobody, Status, System, Task};
use serde_json::{Value, json};
use std::collections::BTreeSet;

fn table(scenario: &str, keys: Value) -> Value {
    let mut table = json!({"scenario": scenario, "trials": 1, "duration": 20.0});
    table.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
    table
}

fn task(scenario: &str, keys: Value) -> Box<dyn Task> {
    let resolved = Fish.resolve(table(scenario, keys)).unwrap();
    assert_eq!(Fish.resolve(resolved.clone()).unwrap(), resolved, "resolved is resolved");
    Fish.task(&resolved.to_string()).unwrap()
}

fn published(focus: Focus) -> Vec<u8> {
    let habits = focus.vectors().iter().map(|&(nature, sex)| Habits::published(nature, sex)).collect();
    Genotype { habits }.encode()
}

fn live(task: &dyn Task, genotype: &[u8], seed: u64) -> Outcome {
    let outcome = task.evaluate(genotype, seed, None, &mut Nobody).unwrap();
    assert_eq!(outcome.status, Status::Completed, "{}", outcome.note);
    outcome
}

fn measure(outcome: &Outcome, name: &str) -> f64 {
    outcome.measures.iter().find(|(key, _)| key == name).unwrap().1
}

///
#[test]
fn every_scenario_runs_and_depends_on_its_seed() {
    for (name, focus) in [("prey", Focus::Prey), ("predator", Focus::Predator), ("pacifist", Focus::Pacifist)]
    {
        let task = task(name, json!({}));
        let genotype = published(focus);
        let [one, same, other] = [1, 1, 2].map(|seed| live(&*task, &genotype, seed));
        assert_eq!(one.digest(), same.digest());
        assert_ne!(measure(&one, "state_hash"), measure(&other, "state_hash"));
        assert_eq!(one.steps, 364);
        assert!(one.fitness > -1.0 && one.fitness < 2.0, "{name}: {}", one.fitness);
    }
}

/// a prey that nobody hunts lives all the time.
#[test]
fn prey_without_predators_are_worth_their_time_and_meals() {
    let task = task("prey", json!({"predators": 0, "males": 0, "females": 0, "obstacles": []}));
    let outcome = live(&*task, &published(Focus::Prey), 3);
    let expected =
        1.0 + 0.05 * measure(&outcome, "meals") / 5.0 - 0.001 * measure(&outcome, "contact_steps") / 5.0;
    assert!((outcome.fitness - expected).abs() < 1e-12, "{}", outcome.fitness);
}

/// a set that was learned takes the place of the hand-made controllers, in every fish, and is checked.
#[test]
fn fishes_of_a_world_swim_by_what_was_learned() {
    let set = serde_json::to_value(crate::fish::controller_set::tests::set()).unwrap();
    let published = published(Focus::Prey);
    let [hand_made, learned, again] = [json!({}), json!({"controllers": set}), json!({"controllers": set})]
        .map(|keys| live(&*task("prey", keys), &published, 1));
    assert_ne!(measure(&hand_made, "state_hash"), measure(&learned, "state_hash"));
    assert_eq!(learned.digest(), again.digest());
    let mut broken = set;
    broken["swims"][1]["measured"] = json!(-1.0);
    let refused = Fish.resolve(table("prey", json!({"controllers": broken}))).unwrap_err();
    assert_eq!(refused.path, "controllers", "{refused}");
    assert!(refused.problem.contains("swims[1].measured"), "{refused}");
}

/// who watches a trial hears every change of intention, of the fish that was of the intention before,
/// and sees muscles at work.
#[test]
fn changes_of_intention_and_muscles_are_told() {
    let task = task("prey", json!({"duration": 60.0}));
    let mut keeper = Keeper::new(0, 40);
    let outcome = task.evaluate(&published(Focus::Prey), 1, None, &mut keeper).unwrap();
    let Recording { scene, shots } = keeper.recording().unwrap();
    let mut intentions = vec!["wander".to_owned(); scene.creatures.len()];
    let (mut changes, mut causes) = (0, BTreeSet::new());
    for (time, event) in shots.iter().flat_map(|shot| shot.events.iter().map(|event| (shot.time, event))) {
        assert!(event.time <= time + 40.0 * scene.step && event.time > time - 40.0 * scene.step);
        let Happening::Intention { from, to, cause } = &event.happening else { continue };
        let held = &mut intentions[event.creature as usize];
        assert_eq!(from, held, "at {}", event.time);
        held.clone_from(to);
        changes += 1;
        causes.insert(cause.clone());
    }
    assert_eq!(f64::from(changes), measure(&outcome, "intention_changes"));
    assert!(causes.contains("collision") && causes.contains("desire"), "{causes:?}");
    let last = &shots.last().unwrap().frame;
    for ((mind, intention), muscles) in last.minds.iter().zip(&intentions).zip(&last.muscles) {
        assert!(mind.as_ref().is_none_or(|mind| mind.intention == *intention));
        assert_eq!(muscles.len(), scene.muscles.len());
        assert!(muscles.iter().all(|u| (0.0..=1.0).contains(u)) && muscles.iter().any(|&u| u > 0.0));
    }
}

/// AF-11
#[test]
fn a_world_without_food_or_mates_ends_on_time() {
    let alone = task("pacifist", json!({"males": 1, "females": 0, "food": {"count": 0}}));
    let outcome = live(&*alone, &published(Focus::Pacifist), 1);
    assert_eq!((outcome.steps, outcome.fitness), (364, 0.0));
}

/// all prey dead, nothing more can happen.
#[test]
fn a_trial_ends_when_all_prey_are_dead() {
    let starts = json!([
        {"fish": 0, "position": [0.0, -40.0, 0.0]},
        {"fish": 1, "position": [0.0, -14.0, 0.0], "heading_degrees": 180.0},
    ]);
    let keys =
        json!({"prey": 1, "males": 0, "females": 0, "duration": 300.0, "obstacles": [], "starts": starts});
    for (scenario, focus) in [("prey", Focus::Prey), ("predator", Focus::Predator)] {
        let task = task(scenario, keys.clone());
        let mut genotype = Genotype::decode(&published(focus)).unwrap();
        if focus == Focus::Predator {
            genotype.habits[0].appetite = 20.0;
        }
        let outcome = live(&*task, &genotype.encode(), 1);
        assert!(outcome.steps < 5455 && measure(&outcome, "deaths") == 1.0, "{scenario}: {outcome:?}");
        match focus {
            Focus::Prey => assert!(outcome.fitness < f64::from(outcome.steps) / 5455.0 + 1e-3),
            _ => assert!((1.0..1.1).contains(&outcome.fitness), "{}", outcome.fitness),
        }
    }
}

/// the interim report is the most that the fitness can become, and it never rises.
#[test]
fn no_fitness_is_above_what_was_possible() {
    for (name, focus) in [("prey", Focus::Prey), ("predator", Focus::Predator), ("pacifist", Focus::Pacifist)]
    {
        let task = task(name, json!({"trials": 2, "duration": 15.0}));
        let genotype = published(focus);
        let fitness = live(&*task, &genotype, 5).fitness;
        let mut last = f64::INFINITY;
        for at in [0.01, 0.4, 0.6, 0.99] {
            let cull = Cull { at, cutoff: None, control: false };
            let mut report = |interim: Interim| {
                assert!(interim.measure >= fitness, "{name} at {at}: {} {fitness}", interim.measure);
                assert!(interim.measure <= last + 1e-12, "{name} at {at}");
                last = interim.measure;
            };
            task.evaluate(&genotype, 5, Some(&cull), &mut report).unwrap();
        }
        assert!(last.is_finite(), "{name} reported");
        let cull = Cull { at: 0.5, cutoff: Some(1e3), control: false };
        let culled = task.evaluate(&genotype, 5, Some(&cull), &mut Nobody).unwrap();
        assert_eq!((culled.status, culled.fitness), (Status::Culled, 0.0));
    }
}

/// AF-10, AF-18
#[test]
fn worlds_that_cannot_be_are_refused_by_field() {
    let at = |x: f64, fish: u32| json!({"fish": fish, "position": [x, 0.0, -85.0]});
    for (keys, path) in [
        (json!({"prey": 0, "predators": 0, "males": 0, "females": 0}), "prey"),
        (json!({"prey": 1001}), "prey"),
        (json!({"duration": 0.0}), "duration"),
        (json!({"duration": -1.0}), "duration"),
        (json!({"trials": 0}), "trials"),
        (json!({"prey": 900}), "tank"),
        (json!({"starts": [at(0.0, 3)]}), "starts[0].position"),
        (json!({"starts": [at(201.0, 3)]}), "starts[0].position"),
        (json!({"starts": [at(100.0, 3), at(150.0, 3)]}), "starts[1].fish"),
        (json!({"starts": [at(100.0, 30)]}), "starts[0].fish"),
        (
            json!({"obstacles": [{"shape": "sphere", "center": [0, 0, 0], "radius": -1.0}]}),
            "obstacles[0].radius",
        ),
        (
            json!({"currents": [{"flow": "vortex", "center": [0, 0], "core": 0, "speed": 1}]}),
            "currents[0].core",
        ),
        (json!({"food": {"count": 1, "sink": -1.0}}), "food"),
        (json!({"weights": {"alive": -1.0}}), "weights"),
        (json!({"climate": {"light": -1.0}}), "climate.light"),
    ] {
        let error = Fish.resolve(table("prey", keys)).unwrap_err();
        assert_eq!(error.path, path, "{error}");
    }
    let error = Fish.resolve(table("prey", json!({"starts": [at(0.0, 3)]}))).unwrap_err();
    assert!(error.problem.contains("fish 3 starts inside an obstacle"), "{error}");
    assert!(Fish.resolve(table("prey", json!({"fishes": 3}))).is_err(), "an unknown key");
}

#[test]
fn habits_of_another_scenario_are_refused() {
    let task = task("prey", json!({}));
    assert!(task.check(&published(Focus::Prey)).is_ok());
    let error = task.check(&published(Focus::Predator)).unwrap_err().to_string();
    assert!(error.contains("`habits`") && error.contains("Predator"), "{error}");
}

///
#[test]
fn starts_are_apart_and_free() {
    let task = WorldTask::published(Focus::Prey);
    let genotype = Genotype { habits: vec![Habits::published(Nature::Prey, Sex::Male)] };
    for seed in 0..20 {
        let fishes = task.inhabitants(&genotype, seed, 0);
        let at: Vec<_> = fishes.iter().map(|fish| fish.swimmer.posture().center()).collect();
        for (index, one) in at.iter().enumerate() {
            assert!(task.environment().free(*one, 10.0));
            for other in &at[..index] {
                assert!((*one - *other).length() > 38.0, "two body lengths, less what b is off the origin");
            }
        }
    }
}

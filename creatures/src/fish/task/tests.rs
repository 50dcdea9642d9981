use super::*;
use crate::fish::controller_set::tests::{beating, set};
use crate::fish::samples::Encoding;
use crate::fish::{Genotype, Samples};
use crate::random::stream;
use crate::{Nobody, Reason, Status};
use serde_json::json;

fn ready(task: Value) -> Ready {
    FishTask::read(task).unwrap().prepare().unwrap()
}

fn live(task: Value, genotype: &Genotype) -> Outcome {
    ready(task).evaluate(&genotype.encode(), 7, None, &mut Nobody).unwrap()
}

fn measure(outcome: &Outcome, name: &str) -> f64 {
    outcome.measures.iter().find(|(key, _)| key == name).unwrap().1
}

fn swim(amplitude: f64) -> Genotype {
    Genotype::Controller(beating(amplitude, 0.0))
}

/// swim-MC(1) from rest makes 0.213 BL in a drill; the same gait as a controller starts it a quarter beat on.
#[test]
fn a_drill_pays_for_progress_less_roughness() {
    let outcome = live(json!({"scenario": "drill"}), &swim(1.0));
    assert_eq!((outcome.status, outcome.steps), (Status::Completed, 182));
    let progress = measure(&outcome, "progress");
    assert!((progress - 0.213).abs() < 0.02, "{progress}");
    assert_eq!(measure(&outcome, "criterion"), progress);
    let roughness = measure(&outcome, "roughness");
    assert_eq!(outcome.fitness, progress - roughness);
    assert!(roughness > 0.05 * progress && roughness < 0.5 * progress, "{roughness}");
}

///
#[test]
fn a_turn_is_practised_by_a_fish_that_already_swims() {
    let criterion = json!({"heading_degrees": 30.0});
    let task = |approach: u32| json!({"scenario": "drill", "lesson": {"approach": approach, "objective": {"criterion": criterion}}});
    let bent = Genotype::Controller(beating(1.0, 0.4));
    let straight = live(task(420), &swim(1.0));
    let outcome = live(task(420), &bent);
    let turned = measure(&outcome, "heading_change_degrees");
    assert!(turned > 15.0, "{turned}°");
    assert!((measure(&outcome, "criterion") + (30.0 - turned).abs() / 30.0).abs() < 1e-12);
    assert!(measure(&straight, "heading_change_degrees").abs() < 10.0);
    assert!(measure(&outcome, "speed") > 1.5 * measure(&live(task(0), &bent), "speed"), "it was under way");
}

/// the race of a controller that beats as swim-MC(1) reaches its cruise.
#[test]
fn a_race_measures_way_speed_and_turning() {
    let outcome = live(json!({"scenario": "race"}), &swim(1.0));
    assert!((measure(&outcome, "speed") - 0.0719).abs() < 0.0015, "{:?}", outcome.measures);
    assert!(measure(&outcome, "turn_rate").abs() < 0.002, "{:?}", outcome.measures);
    assert!((3.0..4.3).contains(&outcome.fitness), "{}", outcome.fitness);
    let left = live(json!({"scenario": "race"}), &Genotype::Controller(beating(1.0, 0.2)));
    assert!(measure(&left, "turn_rate") > 0.01, "{:?}", left.measures);
    let larger = live(json!({"scenario": "race", "body": {"size": 1.7}}), &swim(1.0));
    assert!((larger.fitness - outcome.fitness).abs() < 1e-9, "body lengths are the same for all sizes");
}

#[test]
fn samples_race_by_repeating_themselves() {
    let samples = Samples::random(0, Encoding::Tied, 15, 60, &mut stream(1, [0, 0, 0], "samples"));
    let outcome =
        live(json!({"scenario": "race", "course": {"steps": 200}}), &Genotype::MuscleSamples(samples));
    assert_eq!((outcome.status, outcome.steps), (Status::Completed, 200));
}

///
#[test]
fn a_learned_set_finds_its_buoys() {
    let task = json!({"scenario": "buoys", "course": {"trials": 2}});
    let outcome = live(task, &Genotype::ControllerSet(set()));
    let reached = measure(&outcome, "reached");
    assert!(reached >= 4.0, "{outcome:?}");
    assert!(outcome.fitness >= 0.5 * reached && outcome.fitness <= 0.5 * reached + 1.0, "{outcome:?}");
    assert_eq!(outcome.steps, 2 * 7273);
    let pace = measure(&outcome, "time_per_buoy");
    assert!((50.0..400.0).contains(&pace), "{pace}");
}

#[test]
fn buoys_are_drawn_by_the_seed_and_within_the_course() {
    let course = buoys::Course::default();
    let task = ready(json!({"scenario": "buoys", "course": {"trials": 1, "steps": 200}}));
    let bytes = Genotype::ControllerSet(set()).encode();
    let fitness = |seed| task.evaluate(&bytes, seed, None, &mut Nobody).unwrap().fitness;
    assert_eq!(fitness(1), fitness(1));
    assert_ne!(fitness(1), fitness(2));
    assert!(course.check().is_ok());
}

/// the interim report, and what a rule makes of it.
#[test]
fn every_scenario_reports_and_is_culled_on_the_way() {
    let set = Genotype::ControllerSet(set());
    let samples = Samples::random(0, Encoding::Tied, 15, 182, &mut stream(1, [0, 0, 0], "samples"));
    for (task, genotype, steps) in [
        (json!({"scenario": "drill"}), Genotype::MuscleSamples(samples), 182),
        (json!({"scenario": "race"}), swim(1.0), 1091),
        (json!({"scenario": "buoys", "course": {"steps": 400, "trials": 2}}), set, 800),
    ] {
        let task = ready(task);
        let cull = Cull { at: 0.5, cutoff: Some(1e9), control: false };
        let mut seen = None;
        let outcome = task.evaluate(&genotype.encode(), 1, Some(&cull), &mut |i| seen = Some(i)).unwrap();
        assert_eq!((outcome.status, outcome.fitness, outcome.steps), (Status::Culled, 0.0, steps / 2));
        assert_eq!(outcome.interim, seen);
        let speed = outcome.measures.iter().any(|(name, _)| name == "speed");
        assert_eq!(speed, steps == 182, "a race that was stopped has no speed");
        let free = task.evaluate(&genotype.encode(), 1, None, &mut Nobody).unwrap();
        let spared = Cull { control: true, ..cull };
        let spared = task.evaluate(&genotype.encode(), 1, Some(&spared), &mut Nobody).unwrap();
        assert_eq!((spared.fitness, spared.steps, free.interim), (free.fitness, steps, None));
    }
}

/// what a task is not for.
#[test]
fn a_genotype_of_another_kind_or_lesson_is_refused_by_its_field() {
    let refused = |task: Value, genotype: &Genotype| {
        let task = ready(task);
        let error = task.check(&genotype.encode()).unwrap_err().to_string();
        assert!(task.evaluate(&genotype.encode(), 0, None, &mut Nobody).is_err());
        error
    };
    let samples = |lesson, steps| {
        let stream = &mut stream(1, [0, 0, 0], "samples");
        Genotype::MuscleSamples(Samples::random(lesson, Encoding::Tied, 15, steps, stream))
    };
    let set = Genotype::ControllerSet(set());
    let field = |rest: &str| format!("genotype field {rest}");
    assert_eq!(
        refused(json!({"scenario": "race"}), &set),
        field("`genotype`: `controller_set` has no place in `race`")
    );
    assert_eq!(
        refused(json!({"scenario": "buoys"}), &swim(1.0)),
        field("`genotype`: `controller` has no place in `buoys`")
    );
    assert_eq!(
        refused(json!({"scenario": "drill"}), &samples(1, 182)),
        field("`samples.lesson`: 1 is none of 1 lessons")
    );
    assert_eq!(
        refused(json!({"scenario": "learning"}), &samples(0, 90)),
        field("`samples.steps`: 90 where the lesson has 182")
    );
}

/// in a curriculum each kind goes where it belongs.
#[test]
fn a_curriculum_takes_every_kind() {
    let task = json!({
        "scenario": "learning", "race": {"steps": 50}, "buoys": {"steps": 30, "trials": 1},
    });
    let samples = |lesson| {
        let stream = &mut stream(1, [0, 0, 0], "samples");
        Genotype::MuscleSamples(Samples::random(lesson, Encoding::Tied, 15, 182, stream))
    };
    let steps = |genotype: &Genotype| live(task.clone(), genotype).steps;
    assert_eq!(steps(&samples(1)), 182);
    assert_eq!(steps(&swim(1.0)), 50);
    assert_eq!(steps(&Genotype::ControllerSet(set())), 30);
    let [straight, turn] = [0, 1].map(|lesson| live(task.clone(), &samples(lesson)));
    assert!(measure(&turn, "speed") > measure(&straight, "speed"), "the turn is practised under way");
}

/// AF-8: a fish so large that its muscles tear at it is an outcome with its step, and never NaN.
#[test]
fn a_fish_that_breaks_is_an_outcome() {
    let mut design = Design::published();
    for node in &mut design.nodes {
        node.position = node.position.map(|value| 1e4 * value);
    }
    let design = serde_json::to_value(design).unwrap();
    let outcome = live(json!({"scenario": "race", "body": {"design": design}}), &swim(1.0));
    assert!(matches!(outcome.status, Status::Aborted(Reason::BlowUp)), "{outcome:?}");
    assert_eq!(outcome.fitness, 0.0);
    assert!(outcome.note.starts_with("node ") && outcome.note.ends_with(" at step 1"), "{}", outcome.note);
    assert!(outcome.measures.iter().all(|(_, value)| value.is_finite()));
}

//! Examinations of puppets.

use super::*;
use crate::Nobody;
use crate::esp::fitness::Start;
use crate::esp::fitness::tests::context;
use crate::esp::trial::tests::{Broken, Puppet, constant, seeker};
use serde_json::json;

/// A test of the first skill by a fitness of any kind.
fn test(fitness: serde_json::Value, stop_below: Option<f64>) -> Test {
    Test { skill: SkillId(0), fitness: Fitness::read(&fitness).unwrap(), stop_below }
}

fn examine(
    brain: &Brain,
    spawn: impl FnMut(&Setup) -> Result<Puppet, Broken>,
    tests: &[Test],
) -> Report<Broken> {
    let body = Puppet::body();
    Candidate { brain, body: &body, spawn }.examine(tests, &context(), &mut Nobody)
}

fn healthy(_: &Setup) -> Result<Puppet, Broken> {
    Ok(Puppet::at(0.0, 0.0, 1.0))
}

/// E-66: three strides of 0.5 m/s, at an efficiency of 0.7.
#[test]
fn the_last_test_gives_the_fitness() {
    let tests = [test(json!({ "kind": "high_reach" }), None), test(json!({ "kind": "locomotion" }), None)];
    let report = examine(&constant([0.5, 0.0, 0.0]), healthy, &tests);
    assert_eq!(report.tests[0].score, 0.08);
    let efficiency = 1.0 - 0.3 * 599.0 / 600.0;
    let expected = 0.1 * (5.0 + efficiency) / 3.0;
    assert!((report.fitness - expected).abs() < 1e-9, "{} is not {expected}", report.fitness);
    assert_eq!((report.skipped, report.steps, report.tests[1].trials.len()), (0, 1200, 1));
}

/// E-64: just above and just below the limit.
#[test]
fn who_has_lost_too_much_is_tried_no_further() {
    let tests = |least| {
        [
            test(json!({ "kind": "high_reach" }), Some(least)),
            test(json!({ "kind": "high_reach", "target_height": 1.0 }), None),
            test(json!({ "kind": "locomotion" }), None),
        ]
    };
    let stopped = examine(&constant([0.5, 0.0, 0.0]), healthy, &tests(0.0801));
    assert_eq!((stopped.fitness, stopped.tests.len(), stopped.skipped, stopped.steps), (0.0, 1, 2, 600));
    let passed = examine(&constant([0.5, 0.0, 0.0]), healthy, &tests(0.08));
    assert_eq!((passed.tests.len(), passed.skipped), (3, 0));
    assert!(passed.fitness > 0.1);
}

/// E-49: a brain's clock and state start at each trial's start.
#[test]
fn every_trial_starts_afresh() {
    let twice = test(json!({ "kind": "face_light", "headings": [45, 45], "seconds": 2.0 }), None);
    let report = examine(&seeker(), healthy, &[twice]);
    let [first, second] = report.tests[0].trials[..] else { panic!("two trials") };
    assert_eq!(first.to_bits(), second.to_bits());
    assert!(first > 0.5, "{first}");
    assert_eq!(report.fitness, first);
}

/// E-58
#[test]
fn a_trial_says_how_its_creature_starts() {
    let mut starts = Vec::new();
    let upside_down =
        json!({ "kind": "expression", "start": "upside_down", "score": "last(up_z)", "seconds": 1 });
    let tests = [test(upside_down, None), test(json!({ "kind": "strike" }), None)];
    examine(
        &constant([0.0; 3]),
        |setup| {
            starts.push(setup.start);
            healthy(setup)
        },
        &tests,
    );
    assert_eq!(starts, [Start::UpsideDown, Start::Rest]);
}

/// E-23, EF-10: a fault costs its trial, wherever it comes, and the rest goes on.
#[test]
fn a_fault_costs_one_trial_and_is_told() {
    let mut spawned = 0;
    let spawn = |setup: &Setup| {
        spawned += 1;
        match spawned {
            1 => healthy(setup),
            2 => Ok(Puppet { breaks: Some(60), ..Puppet::at(0.0, 0.0, 0.0) }),
            _ => Err(Broken(0)),
        }
    };
    let three = json!({ "kind": "face_light", "headings": [90, 90, 90], "seconds": 4.0 });
    let report = examine(&seeker(), spawn, &[test(three, None)]);
    let result = &report.tests[0];
    assert!(result.trials[0] > 0.5);
    assert_eq!(result.trials[1..], [0.0, 0.0]);
    assert_eq!(result.faults, [(1, Broken(60)), (2, Broken(0))]);
    assert!((result.score - result.trials[0] / 3.0).abs() < 1e-12);
    assert_eq!(report.steps, 240 + 60);
}

/// E-74, E-87
#[test]
fn measures_of_trials_are_told() {
    let report = examine(&constant([0.0; 3]), healthy, &[test(json!({ "kind": "strike" }), None)]);
    assert_eq!(report.tests[0].measures, [("impact", 1.0)]);
    let both = json!({ "kind": "fight_or_flight", "fight": "attack", "flight": "retreat", "headings": [0] });
    let report = examine(&constant([1.0, 0.0, 0.0]), healthy, &[test(both, None)]);
    let names: Vec<&str> = report.tests[0].measures.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["f_plus", "f_minus"]);
    assert_eq!(report.tests[0].trials, [0.0, 0.0], "it strikes nothing, and is destroyed");
}

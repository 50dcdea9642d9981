//! Tasks as they are written, and what comes out of them.

use crate::esp::sample::{seeker, walker};
use crate::esp::syllabus::SkillId;
use crate::esp::{Esp, Genotype};
use crate::{Nobody, Outcome, Reason, Status, System};
use serde_json::{Value, json};

fn ten_skills(tests: Value) -> Value {
    let mut task: Value = serde_json::from_str(include_str!("../syllabus/ten_skills.json")).unwrap();
    task["tests"] = tests;
    task
}

fn one_skill(fitness: Value) -> Value {
    json!({ "skill": [{ "id": "it", "fitness": fitness }], "tests": [{ "skill": "it" }] })
}

fn evaluate(task: &Value, genotype: &Genotype) -> Outcome {
    let task = Esp.task(&Esp.resolve(task.clone()).unwrap().to_string()).unwrap();
    task.check(&genotype.encode()).unwrap();
    task.evaluate(&genotype.encode(), 0, None, &mut Nobody).unwrap()
}

fn measure(outcome: &Outcome, name: &str) -> Option<f64> {
    outcome.measures.iter().find(|(known, _)| known == name).map(|&(_, value)| value)
}

#[test]
fn a_task_is_resolved_with_every_default_filled_in() {
    let resolved = Esp.resolve(one_skill(json!({ "kind": "strike", "seconds": 3.0 }))).unwrap();
    let fitness = json!({ "kind": "strike", "seconds": 3.0, "body_weights": 20.0 });
    assert_eq!((&resolved["skill"][0]["fitness"], &resolved["tests"][0]["fitness"]), (&fitness, &fitness));
    assert_eq!(
        (&resolved["physics"]["substeps"], &resolved["skill"][0]["body"]),
        (&json!(8), &json!("locked"))
    );
    assert_eq!(Esp.resolve(resolved.clone()).unwrap(), resolved);
    Esp.task(&resolved.to_string()).unwrap();
}

/// EF-1..EF-6, EF-16
#[test]
fn a_bad_task_is_refused_by_the_path_of_its_key() {
    let test = |test: Value| ten_skills(json!([test]));
    let with = |key: &str, value: Value| {
        let mut task = test(json!({ "skill": "strike" }));
        task[key] = value;
        task
    };
    let phase = |fitness: Value| test(json!({ "skill": "forward_locomotion", "fitness": fitness }));
    let bad = [
        ("skill", with("skill", json!([]))),
        ("skill[0].fitness.sped_max", {
            let mut task = test(json!({ "skill": "strike" }));
            task["skill"][0]["fitness"]["sped_max"] = json!(1.0);
            task
        }),
        ("tests", ten_skills(json!([]))),
        ("tests[0].skill", test(json!({ "skill": "left_torn" }))),
        ("tests[1].skill", ten_skills(json!([{ "skill": "strike" }, { "skill": "strike" }]))),
        ("tests[0].weight", test(json!({ "skill": "strike", "weight": 1.0 }))),
        ("tests[0].fitness.kind", phase(json!({ "kind": "strike" }))),
        ("tests[0].fitness.kind", phase(json!({ "seconds": 5.0 }))),
        ("tests[0].fitness.speed_step", phase(json!({ "kind": "locomotion", "speed_step": -0.1 }))),
        ("tests[0].fitness.impact_from", {
            let fitness = json!({ "kind": "attack", "impact_from": "left_turn" });
            test(json!({ "skill": "attack", "fitness": fitness }))
        }),
        ("tests[0].skill", test(json!({ "skill": "attack" }))),
        ("tests[0].skill", test(json!({ "skill": "fight_or_flight" }))),
        ("impacts.strok", with("impacts", json!({ "strok": 4.0 }))),
        ("impacts.left_turn", with("impacts", json!({ "left_turn": 4.0 }))),
        ("impacts.strike", with("impacts", json!({ "strike": -1.0 }))),
        ("physics.substeps", with("physics", json!({ "substeps": 1 }))),
        ("physics.wind", with("physics", json!({ "wind": 1 }))),
    ];
    for (path, task) in bad {
        let error = Esp.resolve(task).unwrap_err();
        assert_eq!(error.path, path, "{error}");
    }
    let error = Esp.resolve(test(json!({ "skill": "attack" }))).unwrap_err().to_string();
    assert!(error.contains("`strike`"), "{error}");
    let mut given = test(json!({ "skill": "fight_or_flight" }));
    given["impacts"] = json!({ "strike": 4.2 });
    Esp.resolve(given).unwrap();
}

/// E-66, E-87
#[test]
fn an_outcome_tells_every_test() {
    let mut task = one_skill(json!({ "kind": "strike", "seconds": 1.0 }));
    task["skill"].as_array_mut().unwrap().push(json!({
        "id": "gait", "fitness": { "kind": "locomotion", "seconds": 2.0, "speed_step": 0.01 }
    }));
    task["tests"] = json!([{ "skill": "it", "stop_below": 0.0 }]);
    let outcome = evaluate(&task, &walker());
    assert_eq!((outcome.status, outcome.steps, outcome.note.as_str()), (Status::Completed, 60, ""));
    let of = |name| measure(&outcome, name);
    assert_eq!((of("score.it"), of("trial.0")), (Some(outcome.fitness), Some(outcome.fitness)));
    assert!(of("impact.it").unwrap() > 1.0);
    assert_eq!((of("tests"), of("trials"), of("stopped_by")), (Some(1.0), Some(1.0), Some(-1.0)));
    assert_eq!((of("parts"), of("muscles"), of("receptors")), (Some(9.0), Some(16.0), Some(3.0)));
    assert_eq!((of("inert_wires"), of("fault.blow_up")), (Some(0.0), None));
}

/// E-63, E-64
#[test]
fn who_falls_short_is_stopped_with_a_fitness_of_nothing() {
    let mut task = one_skill(json!({ "kind": "strike", "seconds": 1.0 }));
    task["tests"] = json!([{ "skill": "it", "stop_below": 0.999 }]);
    let outcome = evaluate(&task, &walker());
    assert_eq!((outcome.status, outcome.fitness), (Status::Completed, 0.0));
    assert_eq!(measure(&outcome, "stopped_by"), Some(0.0));
}

/// A test of what a creature has never learned is no test.
#[test]
fn a_test_of_a_skill_without_control_is_refused() {
    let task = Esp.resolve(ten_skills(json!([{ "skill": "left_turn" }]))).unwrap();
    let task = Esp.task(&task.to_string()).unwrap();
    let error = task.check(&walker().encode()).unwrap_err().to_string();
    assert!(error.contains("brain.controls") && error.contains("`left_turn`"), "{error}");
    assert!(task.evaluate(&walker().encode(), 0, None, &mut Nobody).is_err());
}

/// EF-10: a world that throws creatures about is one in which every trial ends in a fault.
#[test]
fn who_fails_in_every_trial_is_aborted_with_the_reason() {
    let mut task = one_skill(json!({ "kind": "locomotion", "seconds": 5.0 }));
    // A world that its solver cannot hold together.
    task["physics"] = json!({ "gravity": 1000.0, "substeps": 4, "rounds": 1, "sweeps": 1 });
    let outcome = evaluate(&task, &walker());
    assert!(matches!(outcome.status, Status::Aborted(_)), "{outcome:?}");
    assert_eq!(outcome.fitness, 0.0);
    let Status::Aborted(reason) = outcome.status else { unreachable!() };
    assert_ne!(reason, Reason::SelfIntersecting);
    assert!(outcome.note.contains("trial 0: ") && outcome.note.contains("at step"), "{}", outcome.note);
    assert_eq!(measure(&outcome, &format!("fault.{}", reason.word())), Some(1.0));
}

/// T-13, E-48: a skill that is encapsulated, and tested alone, lives the same life to the bit.
#[test]
fn encapsulation_changes_no_bit_of_a_life() {
    let task =
        one_skill(json!({ "kind": "expression", "seconds": 3.0, "score": "mean(com_x) + mean(top_z)" }));
    let open = evaluate(&task, &walker());
    let mut sealed = walker();
    sealed.encapsulate(SkillId(0));
    assert_ne!(sealed, walker());
    assert_eq!(evaluate(&task, &sealed).digest(), open.digest());
}

/// One creature alone is the creature among others (design: determinism).
#[test]
fn what_was_lived_before_changes_no_bit() {
    let walk = one_skill(json!({ "kind": "locomotion", "seconds": 2.0 }));
    let see = one_skill(json!({ "kind": "face_light", "seconds": 1.0, "headings": [45, -135] }));
    let alone = evaluate(&walk, &walker()).digest();
    evaluate(&see, &seeker());
    evaluate(&see, &walker());
    assert_eq!(evaluate(&walk, &walker()).digest(), alone);
}

#[test]
fn proofs_are_legal_and_lively() {
    for proof in Esp.proofs() {
        let task = Esp.task(&proof.task).unwrap();
        task.check(&proof.genotype).unwrap();
        let outcome = task.evaluate(&proof.genotype, proof.seed, None, &mut Nobody).unwrap();
        assert_eq!(outcome.status, Status::Completed, "{outcome:?}");
        assert!(outcome.fitness > 0.0, "{outcome:?}");
    }
}

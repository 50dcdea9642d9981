//! The `[task]` table (A-93, AF-1, AF-17) and the proofs.

use super::*;
use crate::Nobody;
use serde_json::json;

#[test]
fn a_task_is_resolved_with_every_default_filled_in() {
    let resolved = Fish.resolve(json!({"scenario": "drill", "lesson": {"approach": 5}})).unwrap();
    let expected = json!({
        "scenario": "drill",
        "body": {"size": 1.0, "newton": 1},
        "lesson": {
            "approach": 5, "steps": 182, "interpolation": "spline",
            "objective": {
                "smoothness_weight": 1.0, "criterion_weight": 1.0, "rate_weight": 1e-3, "bend_weight": 1e-4,
                "criterion": {"target": [0.0, 100.0, 0.0]},
            },
        },
    });
    assert_eq!(resolved, expected);
    for scenario in ["drill", "race", "buoys", "learning"] {
        let resolved = Fish.resolve(json!({"scenario": scenario})).unwrap();
        assert_eq!(Fish.resolve(resolved.clone()).unwrap(), resolved);
        Fish.task(&resolved.to_string()).unwrap();
    }
}

#[test]
fn a_bad_task_is_refused_by_the_path_of_its_key() {
    let refused = |task: serde_json::Value| Fish.resolve(task.clone()).expect_err(&task.to_string()).path;
    let drill = |lesson: serde_json::Value| refused(json!({"scenario": "drill", "lesson": lesson}));
    let buoys = |course: serde_json::Value| refused(json!({"scenario": "buoys", "course": course}));
    assert_eq!(refused(json!({})), "scenario");
    assert_eq!(refused(json!({"scenario": "dril"})), "scenario");
    assert_eq!(refused(json!({"scenario": "drill", "race": {}})), "race");
    assert_eq!(refused(json!({"scenario": "race", "body": {"size": 0.0}})), "body.size");
    assert_eq!(refused(json!({"scenario": "race", "body": {"newton": 5}})), "body.newton");
    assert_eq!(refused(json!({"scenario": "race", "course": {"steps": 1}})), "course.steps");
    assert_eq!(
        refused(json!({"scenario": "race", "course": {"interpolation": "cubic"}})),
        "course.interpolation"
    );
    assert_eq!(refused(json!({"scenario": "learning", "lessons": []})), "lessons");
    assert_eq!(refused(json!({"scenario": "learning", "lessons": [{}, {"steps": 1}]})), "lessons[1].steps");
    assert_eq!(refused(json!({"scenario": "learning", "race": {"steps": 0}})), "race.steps");
    assert_eq!(drill(json!({"steps": 1})), "lesson.steps");
    assert_eq!(drill(json!({"approach": 2_000_000})), "lesson.approach");
    assert_eq!(drill(json!({"objective": {"rate_weight": -1}})), "lesson.objective.rate_weight");
    assert_eq!(
        drill(json!({"objective": {"criterion": {"heading_degrees": 0}}})),
        "lesson.objective.criterion.heading_degrees"
    );
    assert_eq!(buoys(json!({"trials": 0})), "course.trials");
    assert_eq!(buoys(json!({"distance_min": 7.0})), "course.distance_max");
    assert_eq!(buoys(json!({"elevation_degrees": 90.0})), "course.elevation_degrees");
    assert_eq!(buoys(json!({"reach": 0.0})), "course.reach");
}

/// AF-1
#[test]
fn a_task_may_bring_its_own_body_and_a_lame_one_is_refused() {
    let mut design = serde_json::to_value(body::Design::published()).unwrap();
    let task = |design: &serde_json::Value| json!({"scenario": "race", "body": {"design": design}});
    let resolved = Fish.resolve(task(&design)).unwrap();
    assert_eq!(resolved["body"]["design"], design);
    design["nodes"][20]["mass"] = json!(0.0);
    let error = Fish.resolve(task(&design)).unwrap_err();
    assert_eq!(error.to_string(), "`body.design`: `nodes[20].mass`: 0 is not above 0");
}

/// Each proof lives to its end, and its bits are those of every machine: those of learning, then the worlds'.
#[test]
fn proofs_have_their_bits() {
    let proofs = Fish.proofs();
    let (learning, worlds) = proofs.split_at(proofs.len() - 3);
    let bits = [learning, worlds].map(|proofs| {
        let mut hasher = blake3::Hasher::new();
        for proof in proofs {
            let task = Fish.task(&proof.task).unwrap();
            let outcome = task.evaluate(&proof.genotype, proof.seed, None, &mut Nobody).unwrap();
            assert_eq!(outcome.status, crate::Status::Completed, "{}: {}", proof.task, outcome.note);
            hasher.update(&outcome.digest());
        }
        hasher.finalize().to_hex()[..16].to_owned()
    });
    assert_eq!(bits, GOLDEN, "a change here is a new version");
}

const GOLDEN: [&str; 2] = ["ee8f3f1e7d0d23a0", "a7ff6887b4b3bec9"];

//! The `[task]` table (F-66, X-11), the culling rule's measure (F-54) and the proofs.

use super::*;
use crate::Nobody;
use serde_json::json;

/// F-66
#[test]
fn a_task_is_resolved_with_every_default_filled_in() {
    let resolved = Flyer.resolve(json!({"alpha": 3e-4})).unwrap();
    let expected = json!({
        "steps": 1500, "dt": 0.05, "start_height": 250.0, "gravity": 9.81, "density": 0.01, "alpha": 3e-4,
        "tail_weight": 1.75, "hinge_limit": std::f64::consts::FRAC_PI_3,
        "ball_limit": std::f64::consts::PI / 9.0, "hinge_rate": 2.0, "ball_rate": 0.5, "motor_k": 1.0,
        "erp": 0.2, "brain_substeps": 2, "stop_fraction": 0.1, "w_hover": 1.0, "w_speed": 1.0,
        "interim": "distance", "blow_up_speed": 1000.0, "drag_limiter": false,
    });
    assert_eq!(resolved, expected);
    assert_eq!(Flyer.resolve(resolved.clone()).unwrap(), resolved);
    Flyer.task(&resolved.to_string()).unwrap();
}

///
#[test]
fn a_bad_task_is_refused_by_the_path_of_its_key() {
    let bad = [
        json!({"dt": 0.0}),
        json!({"dt": -0.05}),
        json!({"dt": null}),
        json!({"dt": 1.5}),
        json!({"steps": 3}),
        json!({"steps": 1e9}),
        json!({"steps": 100.5}),
        json!({"start_height": -1.0}),
        json!({"gravity": -9.81}),
        json!({"density": 0.0}),
        json!({"alpha": -1e-9}),
        json!({"alpha": "thin"}),
        json!({"tail_weight": 1e3}),
        json!({"hinge_limit": 3.5}),
        json!({"ball_limit": 0.0}),
        json!({"hinge_rate": -1.0}),
        json!({"ball_rate": 1e9}),
        json!({"motor_k": -1.0}),
        json!({"erp": 1.1}),
        json!({"brain_substeps": 0}),
        json!({"stop_fraction": 2.0}),
        json!({"w_hover": -1.0}),
        json!({"w_speed": 1e9}),
        json!({"interim": "height"}),
        json!({"blow_up_speed": 0.0}),
        json!({"drag_limiter": 1}),
        json!({"cfm": 1e-9}),
    ];
    for task in bad {
        let key = task.as_object().unwrap().keys().next().unwrap();
        let error = Flyer.resolve(task.clone()).unwrap_err();
        assert_eq!(&error.path, key, "{task}: {error}");
    }
    let nan = FlyerTask { alpha: f64::NAN, ..FlyerTask::default() };
    assert_eq!(nan.checked().unwrap_err().path, "alpha");
    Flyer.resolve(json!({"alpha": 0.0})).unwrap();
}

/// F-54
#[test]
fn the_culling_rule_compares_what_the_task_says() {
    let measure = |task| Flyer.interim_measure(&Flyer.resolve(task).unwrap());
    assert_eq!(measure(json!({})), "distance");
    assert_eq!(measure(json!({"interim": "fitness"})), "fitness");
    let outcome = live_first_proof();
    assert!(outcome.measures.iter().any(|(name, _)| name == "distance"));
}

fn live_first_proof() -> crate::Outcome {
    let proof = &Flyer.proofs()[0];
    let task = Flyer.task(&proof.task).unwrap();
    task.evaluate(&proof.genotype, proof.seed, None, &mut Nobody).unwrap()
}

#[test]
fn proofs_are_legal_and_fly() {
    let proofs = Flyer.proofs();
    assert_eq!(proofs.len(), 6);
    for (place, proof) in proofs.iter().enumerate() {
        let task = Flyer.task(&proof.task).unwrap();
        task.check(&proof.genotype).unwrap();
        let outcome = task.evaluate(&proof.genotype, proof.seed, None, &mut Nobody).unwrap();
        assert_eq!(
            (outcome.status, outcome.steps),
            (crate::Status::Completed, 100),
            "{place}: {}",
            outcome.note
        );
    }
}

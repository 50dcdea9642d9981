//! Walkers: four fixed bodies on the ground, each driven by a gene regulatory network or by NEAT's neural
//! network (Tibermacine and Djedi). What is true of one creature is here; what needs a population is not.
//!
//! Read [`body`], [`sensors`] and [`phenotype`] for the creature, [`grn`] and [`neat`] for what drives it,
//! [`task`] for its life.

pub mod body;
pub mod genotype;
pub mod grn;
pub mod neat;
pub mod phenotype;
mod scene;
pub mod sensors;
pub mod task;

pub use body::BodyKind;
pub use genotype::Genotype;
pub use task::WalkerTask;

use crate::random::stream;
use crate::{Proof, SpecError, System, Task, read_spec};

/// The registry's entry.
#[derive(Debug)]
pub struct Walker;

impl System for Walker {
    fn name(&self) -> &'static str {
        "walker"
    }

    /// The world version of the specification: bodies, contact, sensors, motors.
    fn version(&self) -> u32 {
        1
    }

    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError> {
        if task.get("body").is_none() && task.is_object() {
            let bodies = BodyKind::ALL.map(BodyKind::name).join(", ");
            return Err(SpecError::new("body", format!("is missing; it is one of {bodies}")));
        }
        let task = read_spec::<WalkerTask>(task)?.checked()?;
        Ok(serde_json::to_value(task).expect("a plain struct serialises"))
    }

    fn task(&self, resolved: &str) -> Result<Box<dyn Task>, SpecError> {
        let value = serde_json::from_str(resolved).map_err(|e| SpecError::new("", e.to_string()))?;
        Ok(Box::new(read_spec::<WalkerTask>(value)?.checked()?))
    }

    /// Eq. 6 so far (G-61).
    fn interim_measure(&self, _task: &serde_json::Value) -> &'static str {
        "dis"
    }

    /// Each body under each controller for a second and a half, so that every kind of joint and motor, the
    /// ground and both networks take part.
    fn proofs(&self) -> Vec<Proof> {
        let proof = |body, genotype: Vec<u8>| {
            let task = WalkerTask { seconds: 1.5, ..WalkerTask::new(body) };
            let task = serde_json::to_string(&task).expect("a plain struct serialises");
            Proof { task, genotype, seed: 0 }
        };
        let both = |body: BodyKind| {
            let mut draws = stream(0, [0, 0, body as u32], "walker proof");
            let grn = grn::Genotype::random(body, &grn::Settings::default(), &mut draws);
            let eager = neat::Settings { add_node: 0.5, add_link: 1.0, ..neat::Settings::default() };
            let mut neat = neat::Genotype::random(body, &eager, &mut draws);
            let mut register = neat::Register::new(body);
            for _ in 0..12 {
                neat.mutate(&eager, &mut register, &mut draws);
            }
            [proof(body, grn.encode()), proof(body, neat.encode())]
        };
        BodyKind::ALL.into_iter().flat_map(both).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_task_is_resolved_with_every_default_filled_in() {
        let resolved = Walker.resolve(json!({"body": "hopper", "world": {"friction_limb": 0.5}})).unwrap();
        assert_eq!(resolved["phi"], 10.0);
        assert_eq!(resolved["theta"], 2.0);
        assert_eq!(resolved["seconds"], 7.5);
        assert_eq!((&resolved["control_hz"], &resolved["physics_hz"]), (&json!(60), &json!(240)));
        let world = &resolved["world"];
        assert_eq!(world["friction_limb"], 0.5);
        assert_eq!((&world["friction_ground"], &world["friction_torso"]), (&json!(0.9), &json!(0.3)));
        assert_eq!(Walker.resolve(resolved.clone()).unwrap(), resolved);
        Walker.task(&resolved.to_string()).unwrap();
    }

    #[test]
    fn a_bad_task_is_refused_by_the_path_of_its_key() {
        let with = |key: &str, value: serde_json::Value| json!({"body": "arm", key: value});
        let bad = [
            ("body", json!({})),
            ("body", json!({"body": "snail"})),
            ("phi", with("phi", json!(0))),
            ("theta", with("theta", json!("two"))),
            ("theta", with("theta", json!(11))),
            ("seconds", with("seconds", json!(-1))),
            ("seconds", with("seconds", json!(7.51))),
            ("seconds", with("seconds", json!(1e9))),
            ("control_hz", with("control_hz", json!(0))),
            ("physics_hz", with("physics_hz", json!(250))),
            ("gravity", with("gravity", json!(9.81))),
            ("world.friction_limb", with("world", json!({"friction_limb": -0.1}))),
            ("world.slip_speed", with("world", json!({"slip_speed": 0.5}))),
            ("world.wind", with("world", json!({"wind": 1}))),
        ];
        for (path, task) in bad {
            let error = Walker.resolve(task.clone()).unwrap_err();
            assert_eq!(error.path, path, "{task}: {error}");
        }
    }

    #[test]
    fn proofs_are_legal_and_their_networks_use_every_kind_of_link() {
        let proofs = Walker.proofs();
        assert_eq!(proofs.len(), 8);
        for proof in &proofs {
            let task = Walker.task(&proof.task).unwrap();
            task.check(&proof.genotype).unwrap();
            if let Genotype::Neat(genotype) = Genotype::decode(&proof.genotype).unwrap() {
                assert!(!genotype.hidden.is_empty() && genotype.recurrent() > 0, "{genotype:?}");
            }
        }
    }
}

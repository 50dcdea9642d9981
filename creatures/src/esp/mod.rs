//! ESP creatures: bodies with muscles that learn a syllabus of skills, each encapsulated once it is learned, with
//! pandemonium among those that compete (Lessin, Fussell, Miikkulainen and Risi 2015).

pub mod body;
pub mod brain;
pub mod creature;
pub mod demonstration;
pub mod encapsulation;
pub mod energy;
pub mod examination;
pub mod eye;
pub mod fault;
pub mod fitness;
pub mod genotype;
pub mod key;
pub mod muscle;
pub mod pandemonium;
pub mod physics;
pub mod sample;
pub mod syllabus;
pub mod task;
pub mod trial;
pub mod variation;

pub use genotype::Genotype;
pub use task::{EspTask, TaskTable};

use crate::{Proof, SpecError, System, Task, read_spec};
use serde_json::json;

/// The registry's entry.
#[derive(Debug)]
pub struct Esp;

impl System for Esp {
    fn name(&self) -> &'static str {
        "esp"
    }

    fn version(&self) -> u32 {
        1
    }

    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError> {
        let table = read_spec::<TaskTable>(task)?.resolved()?;
        Ok(serde_json::to_value(table).expect("a plain struct serialises"))
    }

    fn task(&self, resolved: &str) -> Result<Box<dyn Task>, SpecError> {
        let value = serde_json::from_str(resolved).map_err(|e| SpecError::new("", e.to_string()))?;
        Ok(Box::new(read_spec::<TaskTable>(value)?.check()?))
    }

    /// A quadruped that walks, and one that sees: joints, contacts, muscles, brain, light and shade take part.
    fn proofs(&self) -> Vec<Proof> {
        let skill =
            |fitness| json!({ "skill": [{ "id": "it", "fitness": fitness }], "tests": [{ "skill": "it" }] });
        let proof = |fitness, genotype: Genotype| {
            let task = self.resolve(skill(fitness)).expect("the task is legal; a test says so");
            Proof { task: task.to_string(), genotype: genotype.encode(), seed: 0 }
        };
        // Of all that was lived, so that no bit of it is lost.
        let walk = json!({
            "kind": "expression",
            "seconds": 2.0,
            "score": "mean(ground_force_bw) + mean(com_x) + mean(com_y) + mean(com_z) + mean(activation)",
        });
        let see = json!({ "kind": "face_light", "seconds": 2.0, "distance": 2.0, "headings": [60, -120] });
        vec![proof(walk, sample::walker()), proof(see, sample::seeker())]
    }
}

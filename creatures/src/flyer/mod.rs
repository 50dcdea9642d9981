//! Flyers: double-winged creatures whose bodies and brains evolve together in the air (Shim and Kim 2003).
//! What is true of one creature is here; what needs a population is not. Units are SI, angles in radians (F-1).
//!
//! Read [`genotype`] for what is inherited, [`variation`] for how it changes, [`skeleton`], [`film`] and
//! [`phenotype`] for the body that it becomes, [`aerodynamics`] for the air, [`sensors`], [`function`] and
//! [`brain`] for what drives the wings, [`task`], `life` and [`fitness`] for what it has to do.

pub mod aerodynamics;
pub mod brain;
pub mod film;
pub mod fitness;
pub mod function;
pub mod genotype;
mod life;
pub mod phenotype;
mod scene;
pub mod sensors;
pub mod skeleton;
pub mod task;
mod traits;
pub mod variation;

pub use brain::Brain;
pub use function::Function;
pub use genotype::{Effector, Genotype, Kind, Neuron, Node, Source};
pub use task::FlyerTask;
pub use variation::Settings;

use crate::random::stream;
use crate::{Proof, SpecError, System, Task, read_spec};

/// The registry's entry.
#[derive(Debug)]
pub struct Flyer;

impl System for Flyer {
    fn name(&self) -> &'static str {
        "flyer"
    }

    fn version(&self) -> u32 {
        1
    }

    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError> {
        let task = read_spec::<FlyerTask>(task)?.checked()?;
        Ok(serde_json::to_value(task).expect("a plain struct serialises"))
    }

    fn task(&self, resolved: &str) -> Result<Box<dyn Task>, SpecError> {
        let value = serde_json::from_str(resolved).map_err(|e| SpecError::new("", e.to_string()))?;
        Ok(Box::new(read_spec::<FlyerTask>(value)?.checked()?))
    }

    /// Distance or fitness, as the task says (F-54).
    fn interim_measure(&self, task: &serde_json::Value) -> &'static str {
        let measure = task.get("interim").and_then(|key| read_spec::<task::Measure>(key.clone()).ok());
        measure.unwrap_or(FlyerTask::default().interim).name()
    }

    /// Founders of one to eight wing segments for five seconds each, in the paper's air and in thin air, with
    /// and without the limit on drag, so that every kind of joint, motor, stop and force takes part.
    fn proofs(&self) -> Vec<Proof> {
        let paper = FlyerTask { steps: 100, ..FlyerTask::default() };
        let thin = FlyerTask { alpha: 3e-4, ..paper.clone() };
        let limited = FlyerTask { alpha: 3e-3, drag_limiter: true, ..paper.clone() };
        let proof = |(segments, task): (usize, &FlyerTask)| {
            let task = serde_json::to_string(task).expect("a plain struct serialises");
            Proof { task, genotype: flying_founder(segments).encode(), seed: 0 }
        };
        [(1, &thin), (2, &limited), (3, &thin), (4, &paper), (6, &thin), (8, &limited)].map(proof).to_vec()
    }
}

/// The first founder of so many wing segments.
fn flying_founder(segments: usize) -> Genotype {
    (0..)
        .map(|place| Genotype::random(&Settings::default(), &mut stream(0, [0, 0, place], "flyer proof")))
        .find(|founder| founder.segments() == segments)
        .expect("founders are drawn until one will do")
}

#[cfg(test)]
mod tests;

//! Artificial fishes: spring bodies in water that learn to swim (Terzopoulos, Tu and Grzeszczuk 1994).
//!
//! Read [`body`] and [`lattice`] for what a fish is made of, [`mechanics`], [`skyline`] and [`hydrodynamics`]
//! for how it moves, [`motor`], [`turn`] and [`fins`] for what drives it, [`swimmer`] for one fish
//! in water, [`chase`] for what makes it get somewhere.
//!
//! What it learns: [`samples`] practised for an [`objective`], [`abstraction`] to a [`controller`], a
//! [`controller_set`] that steers by maps; [`genotype`] is what of these is varied,
//! [`variation`] how controllers are, and [`task`] what they are put to.
//!
//! How it lives: [`habits`] are what it is born with, [`mind`] what it feels and means to do, [`perception`] what
//! it notices, [`behaviour`] what it does, in a [`world`] with others.

pub mod abstraction;
pub mod behaviour;
pub mod body;
pub mod chase;
pub mod controller;
pub mod controller_set;
pub mod fins;
pub mod genotype;
pub mod habits;
pub mod hydrodynamics;
pub mod lattice;
pub mod mechanics;
pub mod mind;
pub mod motor;
pub mod objective;
pub mod perception;
pub mod posture;
pub mod practice;
pub mod samples;
mod scene;
pub mod skyline;
pub mod swimmer;
pub mod task;
pub mod turn;
pub mod variation;
pub mod world;

pub use abstraction::abstracted;
pub use body::Body;
pub use chase::Chase;
pub use controller::Controller;
pub use controller_set::{Calibrated, ControllerSet};
pub use genotype::Genotype;
pub use hydrodynamics::{Still, Water};
pub use motor::{Actuation, Command, Motor, Turn};
pub use objective::{Criterion, Objective};
pub use posture::Posture;
pub use samples::{Encoding, Interpolation, Samples};
pub use swimmer::Swimmer;
pub use task::FishTask;
pub use world::WorldTask;

use crate::random::stream;
use crate::{Proof, SpecError, System, Task};

/// The registry's entry.
#[derive(Debug)]
pub struct Fish;

impl System for Fish {
    fn name(&self) -> &'static str {
        "fish"
    }

    fn version(&self) -> u32 {
        1
    }

    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError> {
        if WorldTask::is(&task) {
            return Ok(serde_json::to_value(WorldTask::read(task)?).expect("a plain struct serialises"));
        }
        let task = FishTask::read(task)?;
        let resolved = serde_json::to_value(&task).expect("a plain struct serialises");
        task.prepare()?;
        Ok(resolved)
    }

    fn task(&self, resolved: &str) -> Result<Box<dyn Task>, SpecError> {
        let value = serde_json::from_str(resolved).map_err(|e| SpecError::new("", e.to_string()))?;
        if WorldTask::is(&value) {
            return Ok(Box::new(WorldTask::read(value)?));
        }
        Ok(Box::new(FishTask::read(value)?.prepare()?))
    }

    /// Body lengths toward the target of a drill, along the course of a race, or the fitness so far at the buoys
    /// (A-94). In a
    /// world, the fitness that it can reach at most.
    fn interim_measure(&self, task: &serde_json::Value) -> &'static str {
        if WorldTask::is(task) { "fitness" } else { "progress" }
    }

    /// Practice of both encodings and interpolations, straight, turning and for every criterion, in two sizes; a
    /// race of a controller; a set at the buoys, which chases, turns, climbs and rolls; and the worlds.
    fn proofs(&self) -> Vec<Proof> {
        let samples = |encoding| {
            let samples =
                Samples::random(0, encoding, samples::COUNT, 60, &mut stream(0, [0, 0, 0], "fish proof"));
            Genotype::MuscleSamples(samples)
        };
        let controller = match samples(Encoding::Tied) {
            Genotype::MuscleSamples(samples) => abstracted(&samples, 1),
            _ => unreachable!("samples are samples"),
        };
        let entry =
            |name: &str, controller, measured| Calibrated { name: name.to_owned(), controller, measured };
        let set = ControllerSet {
            swims: vec![entry("swim", controller.symmetrised(), 0.05)],
            turns: vec![entry("turn", controller.clone(), 0.02)],
        };
        let lesson = r#"{"scenario":"drill","lesson":{"steps":60"#;
        [
            (format!("{lesson}}}}}"), samples(Encoding::Full)),
            (format!(r#"{lesson},"interpolation":"linear"}},"body":{{"size":1.7}}}}"#), samples(Encoding::Tied)),
            (format!(r#"{lesson},"approach":60,"objective":{{"criterion":{{"heading_degrees":30}}}}}}}}"#), samples(Encoding::Tied)),
            (format!(r#"{lesson},"objective":{{"criterion":{{"path":[[0,0,0],[0,9,0]]}}}}}},"body":{{"newton":2}}}}"#), samples(Encoding::Full)),
            (r#"{"scenario":"race","course":{"steps":120}}"#.to_owned(), Genotype::Controller(controller)),
            (r#"{"scenario":"buoys","course":{"steps":300,"trials":2}}"#.to_owned(), Genotype::ControllerSet(set)),
        ]
        .map(|(task, genotype)| Proof { task, genotype: genotype.encode(), seed: 0 })
        .into_iter()
        .chain(world::task::proofs())
        .collect()
    }
}

#[cfg(test)]
mod tests;

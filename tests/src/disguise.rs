//! The probe in disguise: workers with something wrong with them are real in all else, but for what becomes of the
//! probe's tasks.

use creatures::probe::Probe;
use creatures::{Proof, SpecError, System, Task};

/// The probe, with each of its tasks put into another's hands.
#[derive(Debug)]
pub struct Disguise(pub fn(Box<dyn Task>) -> Box<dyn Task>);

impl Disguise {
    /// The registry of a worker in this disguise.
    pub fn system(&'static self, name: &str) -> Option<&'static dyn System> {
        if name == Probe.name() { Some(self) } else { creatures::system(name) }
    }
}

impl System for Disguise {
    fn name(&self) -> &'static str {
        Probe.name()
    }

    fn version(&self) -> u32 {
        Probe.version()
    }

    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError> {
        Probe.resolve(task)
    }

    fn task(&self, resolved: &str) -> Result<Box<dyn Task>, SpecError> {
        Ok(self.0(Probe.task(resolved)?))
    }

    fn proofs(&self) -> Vec<Proof> {
        Probe.proofs()
    }
}

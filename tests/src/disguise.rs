//! The probe in disguise: workers with something wrong with them are real in all else, but for what becomes of the
//! probe's tasks.

use std::future::pending;
use std::process::ExitCode;

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

/// A worker's whole life with something about it changed, as its program would live it but for signals.
pub async fn work_otherwise(
    arguments: worker::command::Arguments,
    change: impl FnOnce(&mut worker::Config),
) -> ExitCode {
    let mut config = match arguments.config() {
        Ok(config) => config,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    change(&mut config);
    match worker::run(config, pending()).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

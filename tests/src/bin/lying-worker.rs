//! A worker that lies: every so many outcomes of probes are better than they were. Real in all else: it is the
//! worker's own library that runs.

use std::process::ExitCode;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use clap::Parser;
use creatures::{Cull, DecodeError, Observer, Outcome, Task};
use hatchery_tests::{Disguise, work_otherwise};

/// How this worker lies.
#[derive(Debug, Parser)]
struct LyingArguments {
    #[command(flatten)]
    worker: worker::command::Arguments,
    /// One of so many outcomes is a lie
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
}

static EVERY: OnceLock<u64> = OnceLock::new();
static TOLD: AtomicU64 = AtomicU64::new(0);

#[tokio::main]
async fn main() -> ExitCode {
    let arguments = LyingArguments::parse();
    EVERY.set(arguments.every).expect("set once");
    work_otherwise(arguments.worker, |config| config.systems = |name| DISGUISE.system(name)).await
}

static DISGUISE: Disguise = Disguise(|task| Box::new(LyingTask(task)));

struct LyingTask(Box<dyn Task>);

impl Task for LyingTask {
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError> {
        self.0.check(genotype)
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        seed: u64,
        cull: Option<&Cull>,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        let mut outcome = self.0.evaluate(genotype, seed, cull, observer)?;
        let every = *EVERY.get().expect("set before the first evaluation");
        if (TOLD.fetch_add(1, Ordering::Relaxed) + 1).is_multiple_of(every) {
            outcome.fitness += 1.0;
        }
        Ok(outcome)
    }
}

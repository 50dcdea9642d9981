//! A worker with something wrong with it: its process dies of some genotypes, or its physics are not those of
//! the others. Real in all else: it is the worker's own library that runs.

use std::process::ExitCode;
use std::sync::OnceLock;

use clap::Parser;
use creatures::{Cull, DecodeError, Observer, Outcome, Task};
use hatchery_tests::{Disguise, work_otherwise};

/// What is wrong with this worker.
#[derive(Debug, Parser)]
struct FragileArguments {
    #[command(flatten)]
    worker: worker::command::Arguments,
    /// The process aborts over probe genotypes whose first byte is below this
    #[arg(long, default_value_t = 0)]
    fatal_below: u8,
    /// Its physics fingerprint differs in one bit
    #[arg(long)]
    foreign_physics: bool,
    /// The release that it says it is of
    #[arg(long)]
    release: Option<String>,
}

static FATAL_BELOW: OnceLock<u8> = OnceLock::new();

#[tokio::main]
async fn main() -> ExitCode {
    let arguments = FragileArguments::parse();
    FATAL_BELOW.set(arguments.fatal_below).expect("set once");
    let change = |config: &mut worker::Config| {
        config.systems = |name| DISGUISE.system(name);
        if arguments.foreign_physics {
            config.fingerprint[0] ^= 1;
        }
        if let Some(release) = arguments.release {
            config.version = release;
        }
    };
    work_otherwise(arguments.worker, change).await
}

static DISGUISE: Disguise = Disguise(|task| Box::new(FragileTask(task)));

struct FragileTask(Box<dyn Task>);

impl Task for FragileTask {
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
        let fatal_below = *FATAL_BELOW.get().expect("set before the first evaluation");
        if genotype.first().is_some_and(|&first| first < fatal_below) {
            std::process::abort();
        }
        self.0.evaluate(genotype, seed, cull, observer)
    }
}

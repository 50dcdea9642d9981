//! The worker as a command: arguments, environment, logs, signals, exit codes. `hatchery-worker` and the
//! hidden subcommand of `hatchery` are both this.

use crate::config::{Config, ConfigError};
use crate::session::run;
use crate::tasks::chain;
use std::error::Error;
use std::io::{IsTerminal, Read};
use std::process::{ExitCode, exit};
use std::{env, io, thread};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::mpsc;
use tracing_subscriber::EnvFilter;

/// Bad usage, as clap has it.
const USAGE: u8 = 2;
/// Interrupted by a second signal.
const INTERRUPTED: i32 = 130;

/// What a worker's command line says.
#[derive(Debug, Clone, clap::Args)]
pub struct Arguments {
    /// Where the coordinator listens
    #[arg(long, value_name = "URL", env = "HATCHERY_COORDINATOR")]
    pub coordinator: String,
    /// Evaluations to run at once [default: one a core]
    #[arg(long, value_name = "N", env = "HATCHERY_SLOTS")]
    pub slots: Option<usize>,
    /// Name in the fleet [default: host and process]
    #[arg(long, env = "HATCHERY_WORKER")]
    pub name: Option<String>,
    /// End at once when standard input does: for a worker whose starter may be killed
    #[arg(long, hide = true)]
    pub leashed: bool,
}

impl Arguments {
    /// The settings that these arguments ask for.
    ///
    /// # Errors
    /// The argument that is wrong.
    pub fn config(&self) -> Result<Config, ConfigError> {
        let mut config = Config::new(&self.coordinator)?;
        if let Some(slots) = self.slots {
            config = config.with_slots(slots)?;
        }
        if let Some(name) = &self.name {
            config = config.with_name(name)?;
        }
        Ok(config)
    }
}

/// Runs a worker until it is drained or refused. SIGTERM or Ctrl-C drains it, a second one ends the process
/// at once.
pub fn execute(arguments: Arguments) -> ExitCode {
    let config = match log().and_then(|()| Ok(arguments.config()?)) {
        Ok(config) => config,
        Err(error) => {
            eprintln!("error: {}", chain(&*error));
            return ExitCode::from(USAGE);
        }
    };
    if arguments.leashed {
        thread::spawn(leash);
    }
    match serve(config) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tracing::error!("{}", chain(&*error));
            ExitCode::FAILURE
        }
    }
}

/// One thread is enough for the stream; the others are the slots'.
fn serve(config: Config) -> Result<(), Box<dyn Error>> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let mut signals = signals()?;
        let first = async move {
            signals.recv().await;
            tokio::spawn(async move {
                signals.recv().await;
                exit(INTERRUPTED);
            });
        };
        Ok(run(config, first).await?)
    })
}

/// Each SIGTERM and each Ctrl-C.
fn signals() -> io::Result<mpsc::Receiver<()>> {
    let (sender, receiver) = mpsc::channel(1);
    for kind in [SignalKind::terminate(), SignalKind::interrupt()] {
        let mut signal = signal(kind)?;
        let sender = sender.clone();
        tokio::spawn(async move { while signal.recv().await.is_some() && sender.send(()).await.is_ok() {} });
    }
    Ok(receiver)
}

/// Ends the process with its standard input. Its coordinator is gone as well, so nothing is worth a drain.
fn leash() {
    let mut input = io::stdin().lock();
    let mut buffer = [0; 64];
    while input.read(&mut buffer).is_ok_and(|count| count > 0) {}
    exit(0);
}

/// Logs to standard error, as `HATCHERY_LOG` says: for people on a terminal, a JSON object a line otherwise.
/// A process that logs already goes on as it did.
fn log() -> Result<(), Box<dyn Error>> {
    let wanted = env::var("HATCHERY_LOG").unwrap_or_default();
    let wanted = if wanted.is_empty() { "info" } else { &wanted };
    let filter = EnvFilter::try_new(wanted).map_err(|error| format!("HATCHERY_LOG `{wanted}`: {error}"))?;
    let log = tracing_subscriber::fmt().with_env_filter(filter).with_writer(io::stderr);
    let _ = if io::stderr().is_terminal() { log.try_init() } else { log.json().try_init() };
    Ok(())
}

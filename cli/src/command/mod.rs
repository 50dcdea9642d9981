//! The commands, one a file: each opens a connection, asks, and renders the answer. None of them knows
//! whether a coordinator or a file answers.

mod amend;
mod best;
mod candidates;
mod check;
mod compare;
mod completions;
mod control;
mod export;
mod fork;
mod hash;
mod import;
mod life;
mod lineage;
mod list;
mod pick;
mod replay;
mod run;
mod show;
mod sql;
mod status;
mod submit;
mod watch;
mod workers;

use std::path::Path;

use crate::arguments::{Command, Overrides};
use crate::exit::Failure;
use crate::render::Output;

/// Carries out one command.
pub(crate) async fn execute(command: Command, output: Output) -> Result<(), Failure> {
    match command {
        Command::Run(arguments) => run::run(arguments, output).await,
        Command::Check(arguments) => check::check(&arguments, output),
        Command::Submit(arguments) => submit::submit(arguments, output).await,
        Command::List(ask) => list::list(&ask, output).await,
        Command::Status(arguments) => status::status(arguments, output).await,
        Command::Watch(arguments) => watch::watch(arguments, output).await,
        Command::Pause(arguments) => control::control(control::Order::Pause, arguments, output).await,
        Command::Resume(arguments) => control::control(control::Order::Resume, arguments, output).await,
        Command::Cancel(arguments) => control::control(control::Order::Cancel, arguments, output).await,
        Command::Candidates(arguments) => candidates::candidates(arguments, output).await,
        Command::Pick(arguments) => pick::pick(arguments, output).await,
        Command::Amend(arguments) => amend::amend(arguments, output).await,
        Command::Fork(arguments) => fork::fork(arguments, output).await,
        Command::Workers(dial) => workers::workers(&dial, output).await,
        Command::Best(arguments) => best::best(arguments, output).await,
        Command::Show(arguments) => show::show(arguments, output).await,
        Command::Lineage(arguments) => lineage::lineage(arguments, output).await,
        Command::Sql(arguments) => sql::sql(arguments, output).await,
        Command::Hash(arguments) => hash::hash(arguments, output).await,
        Command::Export(arguments) => export::export(arguments, output).await,
        Command::Replay(arguments) => replay::replay(arguments, output).await,
        Command::Compare(arguments) => compare::compare(arguments, output).await,
        Command::Completions(arguments) => completions::completions(&arguments),
        Command::Worker(arguments) => {
            // A worker makes a runtime of its own, so `main` starts it before there is one.
            let coordinator = arguments.coordinator.unwrap_or_default();
            Err(anyhow::anyhow!("the worker of {coordinator} was started from within").into())
        }
    }
}

/// The text of an experiment file.
fn read_text(file: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(file).map_err(|error| {
        let place = file.display();
        match error.kind() {
            std::io::ErrorKind::NotFound => Failure::NotFound(format!("{place}: no such file")),
            std::io::ErrorKind::InvalidData => Failure::Usage(format!("{place}: not UTF-8 text")),
            _ => Failure::Failed(anyhow::Error::new(error).context(place.to_string())),
        }
    })
}

impl Overrides {
    /// With `--seed N` as the setting that it stands for, after all others.
    fn with_seed(mut self, seed: Option<u64>) -> Overrides {
        self.set.extend(seed.map(|seed| format!("seed={seed}")));
        self
    }
}

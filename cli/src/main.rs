//! `hatchery`: the command line. Every command is a client of a coordinator, or of a lineage file served in
//! this process; `hatchery run` is the whole in one. It decides nothing that the crates below it decide.
//!
//! ```text
//! arguments  as typed                     connect  a coordinator dialled, or a file served here
//! command/   one command a file           render/  text, tables, JSON, bars, errors
//! compare/   the published comparison     picture/ a recording as sheet, film, chart
//! crew       the worker processes of `run`
//! exit       failures and exit codes      signals  Ctrl-C, once and twice
//! ```

mod arguments;
mod command;
mod compare;
mod connect;
mod crew;
mod exit;
mod picture;
mod render;
mod signals;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use tracing_subscriber::EnvFilter;

use arguments::{Arguments, Command};
use exit::{Exit, Failure};
use render::Output;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() && arguments::ask_for_json(std::env::args_os()) => {
            let failure = Failure::Usage(arguments::complaint(&error));
            render::failure::report(&failure, true);
            return failure.exit().into();
        }
        Err(error) => error.exit(),
    };
    if let Command::Worker(arguments) = arguments.command {
        return worker::command::execute(arguments);
    }
    log();
    let output = Output { json: arguments.json };
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build();
    let done = match runtime {
        Ok(runtime) => runtime.block_on(command::execute(arguments.command, output)),
        Err(error) => Err(Failure::from(error)),
    };
    match done {
        Ok(()) => Exit::Done.into(),
        Err(failure) if failure.is_broken_pipe() => Exit::Done.into(),
        Err(failure) => {
            render::failure::report(&failure, output.json);
            failure.exit().into()
        }
    }
}

/// Logs to standard error as `HATCHERY_LOG` says, warnings unless told otherwise: for people on a terminal, a
/// JSON object a line otherwise.
fn log() {
    let filter = EnvFilter::try_from_env("HATCHERY_LOG").unwrap_or_else(|_| EnvFilter::new("warn"));
    let log = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    if std::io::stderr().is_terminal() { log.init() } else { log.json().init() }
}

//! `hatchery-worker`: the worker as a program of its own.

use clap::Parser;
use std::process::ExitCode;

/// Joins a Hatchery coordinator, evaluates creatures, reports their outcomes.
#[derive(Debug, Parser)]
#[command(name = "hatchery-worker", version)]
struct CommandLine {
    #[command(flatten)]
    arguments: worker::command::Arguments,
}

fn main() -> ExitCode {
    worker::command::execute(CommandLine::parse().arguments)
}

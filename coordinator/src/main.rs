//! `hatchery-coordinator`: one coordinator as a service of its own.

use std::io::IsTerminal;

use anyhow::Context;
use clap::Parser;
use coordinator::credentials::command::{Init, Tokens};
use coordinator::health::Health;
use tracing_subscriber::EnvFilter;

/// Holds populations and their lineage, and hands evaluations to the workers that attach.
///
/// On start it takes up every experiment that was running. SIGTERM or Ctrl-C: it stops handing out, commits what has
/// arrived, says goodbye and exits with 0.
#[derive(Debug, Parser)]
#[command(name = "hatchery-coordinator", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(flatten)]
    config: coordinator::Config,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Make credentials: a small authority, the server's certificate, and a join token for workers and one for
    /// clients
    Init(Init),
    /// List, make and revoke join tokens, also while a coordinator runs on them
    Tokens(Tokens),
    /// Ask the coordinator on this machine how it is
    Health(Health),
}

const EXAMPLES: &str = "Examples:
  hatchery-coordinator --db farm.db
  hatchery-coordinator --db farm.db --listen 127.0.0.1:0 --address-file farm.address

On a network, for workers and clients of other machines:
  hatchery-coordinator init --host head.example
  hatchery-coordinator --db farm.db --listen 0.0.0.0:7878 --credentials credentials

Logs: HATCHERY_LOG=debug (error, warn, info, debug, trace); human on a terminal, JSON otherwise.";

fn main() -> std::process::ExitCode {
    let arguments = Arguments::parse();
    let done = match arguments.command {
        Some(Command::Init(init)) => init.execute(),
        Some(Command::Tokens(tokens)) => tokens.execute(),
        Some(Command::Health(health)) => ask(health),
        None => {
            log();
            run(arguments.config)
        }
    };
    match done {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("hatchery-coordinator: {error:#}");
            std::process::ExitCode::FAILURE
        }
    }
}

/// Logs to standard error: for people on a terminal, a JSON object a line otherwise.
fn log() {
    let filter = EnvFilter::try_from_env("HATCHERY_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    let logs = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    if std::io::stderr().is_terminal() {
        logs.init();
    } else {
        logs.json().init();
    }
}

#[tokio::main(flavor = "current_thread")]
async fn ask(health: Health) -> anyhow::Result<()> {
    health.execute().await
}

#[tokio::main]
async fn run(config: coordinator::Config) -> anyhow::Result<()> {
    let running = coordinator::start(config).await?;
    let mut terminate = tokio::signal::unix::signal(tokio::signal::unix::SignalKind::terminate())
        .context("cannot listen for SIGTERM")?;
    tokio::select! {
        _ = terminate.recv() => tracing::info!("SIGTERM: stopping"),
        result = tokio::signal::ctrl_c() => {
            result.context("cannot listen for Ctrl-C")?;
            tracing::info!("Ctrl-C: stopping");
        }
    }
    running.shutdown().await;
    Ok(())
}

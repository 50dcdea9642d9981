//! `hatchery-coordinator`: one coordinator as a service of its own.

use std::io::IsTerminal;

use anyhow::Context;
use clap::Parser;
use tracing_subscriber::EnvFilter;

/// Holds populations and their lineage, and hands evaluations to the workers that attach.
///
/// On start it takes up every experiment that was running. SIGTERM or Ctrl-C: it stops handing out, commits what has
/// arrived, says goodbye and exits with 0.
#[derive(Debug, Parser)]
#[command(name = "hatchery-coordinator", version, after_help = EXAMPLES)]
struct Arguments {
    #[command(flatten)]
    config: coordinator::Config,
}

const EXAMPLES: &str = "Examples:
  hatchery-coordinator --db farm.db
  hatchery-coordinator --db farm.db --listen 127.0.0.1:0 --address-file farm.address

Logs: HATCHERY_LOG=debug (error, warn, info, debug, trace); human on a terminal, JSON otherwise.";

fn main() -> std::process::ExitCode {
    let arguments = Arguments::parse();
    let filter = EnvFilter::try_from_env("HATCHERY_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    let logs = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    if std::io::stderr().is_terminal() {
        logs.init();
    } else {
        logs.json().init();
    }
    match run(arguments.config) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("hatchery-coordinator: {error:#}");
            std::process::ExitCode::FAILURE
        }
    }
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

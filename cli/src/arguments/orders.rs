//! Arguments of the commands that follow and direct an experiment under way.

use std::path::PathBuf;

use clap::Args;

use super::Dial;

/// `hatchery watch`.
#[derive(Debug, Args)]
#[command(after_help = WATCH_HELP)]
pub(crate) struct Watch {
    /// `last`, a number or a name; the name of a matrix means all its cells
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// Which coordinator.
    #[command(flatten)]
    pub(crate) dial: Dial,
}

const WATCH_HELP: &str = "\
Bars on a terminal, one line a generation otherwise, one object a line with --json. Ends when every \
experiment watched has ended or waits for a pick: exit code 0 if all finished, 1 if one failed or was \
cancelled, 5 if one waits. Ctrl-C ends the watching alone.";

/// An order about an experiment, or about every cell of a matrix.
#[derive(Debug, Args)]
#[command(after_help = CONTROL_HELP)]
pub(crate) struct Control {
    /// `last`, a number or a name; the name of a matrix means all its cells
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// Which coordinator.
    #[command(flatten)]
    pub(crate) dial: Dial,
    /// Write the order into this lineage file, on which nobody is at work
    #[arg(long, value_name = "FILE", conflicts_with_all = ["coordinator", "join", "join_file"])]
    pub(crate) db: Option<PathBuf>,
}

const CONTROL_HELP: &str = "\
Orders go to a coordinator (--coordinator, --join-file; HATCHERY_JOIN, HATCHERY_COORDINATOR). One about a run that was \
interrupted goes into its lineage file: --db FILE.";

//! Arguments of the commands about stages: candidates, picks, changed files and forks.

use std::path::PathBuf;

use clap::Args;

use super::{Ask, Overrides};

/// `hatchery candidates`.
#[derive(Debug, Args)]
pub(crate) struct Candidates {
    /// `last`, a number or a name
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// At the end of this stage, by name or number [default: of those where a pick is awaited, or else of all]
    #[arg(long, value_name = "STAGE")]
    pub(crate) stage: Option<String>,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

/// `hatchery pick`.
#[derive(Debug, Args)]
#[command(after_help = PICK_HELP)]
pub(crate) struct Pick {
    /// `last`, a number or a name
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// One of the candidates
    #[arg(value_name = "INDIVIDUAL")]
    pub(crate) individual: u64,
    /// Why, for those who read the lineage
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true)]
    pub(crate) note: String,
    /// Whom to tell.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const PICK_HELP: &str = "\
Examples:
  hatchery candidates last
  hatchery pick last 4711 --note \"turns on the spot\"

A coordinator (--coordinator, HATCHERY_COORDINATOR) goes on at once. A lineage file at rest (--db, HATCHERY_DB, \
else hatchery.db in the current folder) takes the pick, and the same `hatchery run` as before goes on with it. \
Who is no candidate, or picked where nothing is awaited, is refused, and nothing changes.";

/// `hatchery amend`.
#[derive(Debug, Args)]
#[command(after_help = AMEND_HELP)]
pub(crate) struct Amend {
    /// `last`, a number or a name
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// The changed experiment file
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// What changes the file.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// Whom to tell.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const AMEND_HELP: &str = "\
Example:
  hatchery pause last
  hatchery amend last fight-or-flight.toml

An experiment that is paused, waits for a pick or has finished goes on with skills appended, or others changed \
that it has not begun. Everything else is refused, with every difference named, and nothing changes: fork it \
instead (hatchery fork ID --after STAGE FILE). In a file at rest (--db), `hatchery run FILE` then goes on.";

/// `hatchery fork`.
#[derive(Debug, Args)]
#[command(after_help = FORK_HELP)]
pub(crate) struct Fork {
    /// The other experiment: `last`, a number or a name
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// The last stage that both have, by name or number
    #[arg(long, value_name = "STAGE")]
    pub(crate) after: String,
    /// A changed experiment file [default: as the other's]
    #[arg(value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
    /// What changes the file.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// Whom to tell.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const FORK_HELP: &str = "\
Examples:
  hatchery fork last --after left_turn shorter.toml        and go on otherwise from there
  hatchery fork last --after left_turn ten.toml --set skill.left_turn.pick=human
                                                           and let a person pick who goes on

The stages up to there are shared, not copied: ancestors lead back into them. Who goes on from the end of the \
last of them is picked anew. In a file at rest (--db), `hatchery run FILE` then goes on with the fork.";

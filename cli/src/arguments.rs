//! Arguments as they are typed. It opens nothing, dials nothing and reads no file.

mod orders;
mod replay;
mod stages;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum, builder::PossibleValuesParser};
use coordinator::lineage::VIEWS;

pub(crate) use orders::{Control, Watch};
pub(crate) use replay::Replay;
pub(crate) use stages::{Amend, Candidates, Fork, Pick};

/// Evolve virtual creatures, and ask what became of them.
#[derive(Debug, Parser)]
#[command(name = "hatchery", version, propagate_version = true, max_term_width = 100, after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Print JSON: one document, or one object a line for streams
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Whether a command line asks for JSON, also one that is not understood.
pub(crate) fn ask_for_json(words: impl Iterator<Item = OsString>) -> bool {
    words.take_while(|word| word != "--").any(|word| word == "--json")
}

/// What is wrong with a command line, without the word that text begins with.
pub(crate) fn complaint(error: &clap::Error) -> String {
    let text = error.render().to_string();
    text.strip_prefix("error: ").unwrap_or(&text).trim_end().to_owned()
}

const EXAMPLES: &str = "\
Start here:
  hatchery run experiments/quickstart.toml     evolve on every core of this machine
  hatchery best last                           the best individual of the last experiment
  hatchery lineage INDIVIDUAL --line           its ancestors, back to a founder
  hatchery replay INDIVIDUAL                   live it again, and compare the fitness bit for bit

An experiment ID is `last`, a number or a name; the name of a matrix stands for all its cells.
Exit codes: 0 done, 1 failed, 2 usage or bad input, 3 not found, 4 coordinator unreachable, 5 waiting for a \
pick, 130 interrupted.
Environment: HATCHERY_JOIN (a client's join token), HATCHERY_JOIN_FILE (a file that holds one), \
HATCHERY_COORDINATOR (URL), HATCHERY_DB (file), HATCHERY_LOG (error, warn, info, debug, trace, or per module as \
in `coordinator=debug`), NO_COLOR.";

/// One command.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run an experiment on this machine: coordinator, workers and lineage in one command
    Run(Run),
    /// Validate an experiment file; nothing is created
    Check(Check),
    /// Hand an experiment file to a coordinator
    Submit(Submit),
    /// List experiments
    #[command(after_help = SOURCE_HELP)]
    List(Ask),
    /// Show one experiment: its state, its runs, how far they are
    #[command(after_help = SOURCE_HELP)]
    Status(AskExperiment),
    /// Follow an experiment until it ends
    Watch(Watch),
    /// Hand out nothing more of an experiment; what runs is finished and recorded
    Pause(Control),
    /// Go on with a paused experiment
    Resume(Control),
    /// End an experiment for good; what was evaluated stays in the lineage
    Cancel(Control),
    /// Who may go on from the end of a stage, and who did
    #[command(after_help = SOURCE_HELP)]
    Candidates(Candidates),
    /// Say who goes on from the end of a stage
    Pick(Pick),
    /// Go on with a changed experiment file, where it changes only what has not begun
    Amend(Amend),
    /// Begin an experiment whose first stages are another's
    Fork(Fork),
    /// List the workers of a coordinator
    Workers(Dial),
    /// The best individuals of an experiment
    Best(Best),
    /// Everything about one individual
    Show(Show),
    /// The ancestors of an individual, back to the founders
    Lineage(Lineage),
    /// Ask the lineage a question in SQL (a single SELECT)
    #[command(after_help = SQL_HELP)]
    Sql(Sql),
    /// The lineage hash of an experiment: equal hashes are equal lineages, bit for bit
    #[command(after_help = SOURCE_HELP)]
    Hash(AskExperiment),
    /// Write a view of the lineage as CSV or NDJSON
    Export(Export),
    /// Live an individual again from the lineage alone and compare the fitness bits; record and draw it
    Replay(Replay),
    /// Compare the cells of a matrix, or several experiments: means, t-tests, curves, the paper's figures
    Compare(Compare),
    /// Print a completion script for a shell
    #[command(after_help = COMPLETIONS_HELP)]
    Completions(Completions),
    /// Evaluate for the `hatchery run` that started this process
    #[command(hide = true)]
    Worker(worker::command::Arguments),
}

/// Which coordinator.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Dial {
    /// The coordinator [env: HATCHERY_COORDINATOR] [default: http://127.0.0.1:7878]
    #[arg(long, value_name = "URL", conflicts_with_all = ["join", "join_file"])]
    pub(crate) coordinator: Option<String>,
    /// How to join it.
    #[command(flatten)]
    pub(crate) join: Join,
}

/// The join token of a coordinator on a network.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Join {
    /// Ask the coordinator of the join token in this file [env: HATCHERY_JOIN_FILE]
    #[arg(long, value_name = "FILE", conflicts_with = "join")]
    pub(crate) join_file: Option<PathBuf>,
    /// Ask the coordinator of this join token [env: HATCHERY_JOIN]; others on this machine see it in the list of
    /// processes, so rather use the file or the environment
    #[arg(long, value_name = "TOKEN")]
    pub(crate) join: Option<String>,
}

/// Whom to ask: a coordinator, or a lineage file.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Ask {
    /// Ask this coordinator [env: HATCHERY_COORDINATOR]
    #[arg(long, value_name = "URL", conflicts_with_all = ["db", "join", "join_file"])]
    pub(crate) coordinator: Option<String>,
    /// How to join one.
    #[command(flatten)]
    pub(crate) join: Join,
    /// Read this lineage file [env: HATCHERY_DB] [default: hatchery.db in the current folder]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["join", "join_file"])]
    pub(crate) db: Option<PathBuf>,
}

const SOURCE_HELP: &str = "\
Asks a coordinator (--coordinator, --join-file; HATCHERY_JOIN, HATCHERY_COORDINATOR) or reads a lineage file (--db, HATCHERY_DB, else \
hatchery.db in the current folder), also while a run is writing it.";

/// What changes an experiment file on its way in.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Overrides {
    /// Apply the file's [profile.NAME] table
    #[arg(long, value_name = "NAME")]
    pub(crate) profile: Option<String>,
    /// Set a key, dotted: --set search.population=40
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_value)]
    pub(crate) set: Vec<String>,
}

fn key_value(typed: &str) -> Result<String, String> {
    match typed.split_once('=') {
        Some((key, _)) if !key.trim().is_empty() => Ok(typed.to_owned()),
        _ => Err("expected KEY=VALUE, as in search.population=40".to_owned()),
    }
}

/// `hatchery run`.
#[derive(Debug, Args)]
#[command(after_help = RUN_HELP)]
pub(crate) struct Run {
    /// The experiment file
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// The seed of the first run; run i has seed + i - 1 (the same as --set seed=N)
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Worker processes [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) workers: Option<u16>,
    /// The lineage file; made if it does not exist
    #[arg(long, value_name = "FILE", env = "HATCHERY_DB", default_value = "hatchery.db")]
    pub(crate) db: PathBuf,
    /// Begin with this creature as the finished first skill (search.import): an individual of the lineage file, or a
    /// file with its genotype, as bytes or as `hatchery show INDIVIDUAL --json` prints it
    #[arg(long, value_name = "INDIVIDUAL|FILE")]
    pub(crate) import: Option<String>,
    /// What changes the file.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

const RUN_HELP: &str = "\
Examples:
  hatchery run experiments/quickstart.toml
  hatchery run experiments/hopper-neat.toml --set runs=5 --workers 2
  hatchery run experiments/grn-vs-neat.toml --profile smoke --db smoke.db

If the lineage file holds the same experiment unfinished (the same file, profile and settings), it goes on \
where it stood; so a killed run costs what was in flight and no more. One that is over is begun anew. Ctrl-C commits and says how to go on; \
a second Ctrl-C ends at once. A run that waits for a pick ends with exit code 5 and says what to type.";

/// `hatchery check`.
#[derive(Debug, Args)]
#[command(after_help = CHECK_HELP)]
pub(crate) struct Check {
    /// The experiment file
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Print the file with every default filled in: what a run would store
    #[arg(long)]
    pub(crate) resolved: bool,
    /// What changes the file.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

const CHECK_HELP: &str = "\
Examples:
  hatchery check experiments/crawler-grn.toml
  hatchery check experiments/crawler-grn.toml --resolved --set task.seconds=3

The file is read with each of its profiles, unless --profile chooses one. Every problem is named with file, line and \
column; the exit code is then 2.";

/// `hatchery submit`.
#[derive(Debug, Args)]
#[command(after_help = SUBMIT_HELP)]
pub(crate) struct Submit {
    /// The experiment file
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// The seed of the first run (the same as --set seed=N)
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Take up an unfinished experiment of the same file and settings instead of making another one
    #[arg(long)]
    pub(crate) resume: bool,
    /// Begin with this creature as the finished first skill (search.import): an individual of the coordinator's
    /// lineage, or a file with its genotype, as bytes or as `hatchery show INDIVIDUAL --json` prints it
    #[arg(long, value_name = "INDIVIDUAL|FILE")]
    pub(crate) import: Option<String>,
    /// What changes the file.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// Which coordinator.
    #[command(flatten)]
    pub(crate) dial: Dial,
}

const SUBMIT_HELP: &str = "\
Examples:
  hatchery submit experiments/runner-neat.toml --join-file client.token
  hatchery submit experiments/runner-neat.toml --join 'hatchery://head:7878#client-…'
  HATCHERY_JOIN_FILE=client.token hatchery watch last

A join token, as `hatchery-coordinator tokens new client` prints it, says where the coordinator is and lets you in. \
Without one the coordinator of this machine is asked, at http://127.0.0.1:7878 unless --coordinator says otherwise.";

/// A question to a coordinator or a file about one experiment.
#[derive(Debug, Args)]
pub(crate) struct AskExperiment {
    /// `last`, a number or a name
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

/// `hatchery best`.
#[derive(Debug, Args)]
#[command(after_help = SOURCE_HELP)]
pub(crate) struct Best {
    /// `last`, a number or a name; of a matrix: the best of each cell
    #[arg(value_name = "ID")]
    pub(crate) experiment: String,
    /// How many, best first
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) limit: u32,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

/// `hatchery show`.
#[derive(Debug, Args)]
#[command(after_help = SHOW_HELP)]
pub(crate) struct Show {
    /// Its number
    #[arg(value_name = "INDIVIDUAL")]
    pub(crate) individual: u64,
    /// Print the genotype, decoded, as well (--json always has it)
    #[arg(long)]
    pub(crate) genotype: bool,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const SHOW_HELP: &str = "\
Examples:
  hatchery show 4711
  hatchery show 4711 --json | jq .genotype.decoded";

/// `hatchery lineage`.
#[derive(Debug, Args)]
#[command(after_help = LINEAGE_HELP)]
pub(crate) struct Lineage {
    /// Its number
    #[arg(value_name = "INDIVIDUAL")]
    pub(crate) individual: u64,
    /// Follow the first parents alone: one line back to one founder
    #[arg(long)]
    pub(crate) line: bool,
    /// How many generations back [default: to the founders]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) depth: Option<u32>,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const LINEAGE_HELP: &str = "\
Examples:
  hatchery lineage 4711 --line        one line of first parents, with the operators that made them
  hatchery lineage 4711 --depth 3     the whole pedigree, three generations back";

/// `hatchery sql`.
#[derive(Debug, Args)]
pub(crate) struct Sql {
    /// The statement
    #[arg(value_name = "SELECT")]
    pub(crate) statement: String,
    /// Stop with an error beyond so many rows [default: the coordinator's limit]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) rows: u64,
    /// Stop with an error after so many seconds [default: the coordinator's limit]
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=3600))]
    pub(crate) timeout: Option<u32>,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const SQL_HELP: &str = "\
Examples:
  hatchery sql \"SELECT operator, count(*), max(fitness) FROM v_individuals GROUP BY operator\"
  hatchery sql \"SELECT generation, best FROM v_generations WHERE run = 1\" --json

The views are the documented interface: v_experiments v_stages v_generations v_individuals v_parents \
v_evaluations v_culls v_best v_ancestors v_species v_workers v_checkpoints v_candidates v_picks v_audits \
v_events. The connection can only read; a statement that would write, attach a file or run for ever is refused \
or stopped.";

/// `hatchery export`.
#[derive(Debug, Args)]
#[command(after_help = EXPORT_HELP)]
pub(crate) struct Export {
    /// The view
    #[arg(value_parser = PossibleValuesParser::new(VIEWS), value_name = "VIEW")]
    pub(crate) view: String,
    /// As what
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    pub(crate) format: Format,
    /// Only this experiment, or the cells of this matrix [default: all]
    #[arg(long, value_name = "ID")]
    pub(crate) experiment: Option<String>,
    /// Where to [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const EXPORT_HELP: &str = "\
Examples:
  hatchery export v_generations --experiment last > generations.csv
  hatchery export v_individuals --format ndjson -o individuals.ndjson

Numbers keep every bit; bytes are written in hexadecimal; NULL is an empty field, or null.";

/// How rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Comma-separated values with a header line
    Csv,
    /// One JSON object a line
    Ndjson,
}

/// `hatchery compare`.
#[derive(Debug, Args)]
#[command(after_help = COMPARE_HELP)]
pub(crate) struct Compare {
    /// A matrix, one experiment, or several
    #[arg(value_name = "ID", required = true)]
    pub(crate) experiments: Vec<String>,
    /// Draw the fitness curves into this folder: curves.png and curves.svg, a panel a cell, and best.png and
    /// best.svg, all cells in one
    #[arg(long, value_name = "DIR")]
    pub(crate) plot: Option<PathBuf>,
    /// Write the fitness curves as CSV
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const COMPARE_HELP: &str = "\
Examples:
  hatchery compare grn-vs-neat --plot figures
  hatchery compare crawler-grn crawler-neat --csv curves.csv

A run's result is the best fitness of its last generation. Cells of equal body and two methods are compared \
by Student's two-sided t-test (equal variances), with Welch's p beside it; the verdict is at 0.05. Runs that \
have not finished are counted and left out. The exit code is 0 only if the table is complete.";

/// `hatchery completions`.
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// Which shell
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}

const COMPLETIONS_HELP: &str = "\
Examples:
  hatchery completions bash > ~/.local/share/bash-completion/completions/hatchery
  hatchery completions zsh > ~/.zfunc/_hatchery
  hatchery completions fish > ~/.config/fish/completions/hatchery.fish";

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_well_formed() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn a_setting_without_a_key_or_value_is_refused() {
        assert!(key_value("search.population=40").is_ok());
        assert!(key_value("name=a=b").is_ok(), "the value may hold an equals sign");
        assert!(key_value("population").is_err());
        assert!(key_value("=40").is_err());
    }

    #[test]
    fn a_coordinator_and_a_file_exclude_each_other() {
        let both = ["hatchery", "list", "--coordinator", "http://a:1", "--db", "b.db"];
        assert!(Arguments::try_parse_from(both).is_err());
    }
}

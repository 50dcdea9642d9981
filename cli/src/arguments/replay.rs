//! Arguments of `hatchery replay`: who is lived again, and what is written and drawn of it.

use std::path::PathBuf;

use clap::Args;

use super::Ask;

/// `hatchery replay`.
#[derive(Debug, Args)]
#[command(after_help = REPLAY_HELP)]
pub(crate) struct Replay {
    /// Its number
    #[arg(value_name = "INDIVIDUAL")]
    pub(crate) individual: u64,
    /// Others that are lived again as well; a film and a chart of muscles have them beside it
    #[arg(long, value_name = "INDIVIDUAL,…", value_delimiter = ',')]
    pub(crate) beside: Vec<u64>,
    /// Write where everything was at every step, as lines of JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) recording: Option<PathBuf>,
    /// Draw a contact sheet: views down, moments across, and where it went
    #[arg(long, value_name = "FILE.png", value_parser = png)]
    pub(crate) picture: Option<PathBuf>,
    /// Draw a film: moments from above by a camera that stands still
    #[arg(long, value_name = "FILE.png", value_parser = png)]
    pub(crate) film: Option<PathBuf>,
    /// Draw how far muscles were contracted over time, of fishes and ESP creatures
    #[arg(long, value_name = "FILE.png|svg", value_parser = png_or_svg)]
    pub(crate) muscles: Option<PathBuf>,
    /// When film and muscles begin; at the trial's start unless told
    #[arg(long, value_name = "TIME")]
    pub(crate) from: Option<f64>,
    /// When they end; at the trial's end unless told
    #[arg(long, value_name = "TIME")]
    pub(crate) to: Option<f64>,
    /// Which trial is recorded and drawn, of an evaluation that has several
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) trial: u32,
    /// Record one step in so many
    #[arg(long, value_name = "STEPS", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) every: u32,
    /// Let it show a skill under a light that moves as this file says instead; nothing is compared
    #[arg(long, value_name = "SCRIPT.toml",
        conflicts_with_all = ["trial", "beside", "film", "muscles", "from", "to"])]
    pub(crate) light: Option<PathBuf>,
    /// Which skill is on under the light; the one last tested unless it is named
    #[arg(long, value_name = "SKILL", requires = "light")]
    pub(crate) skill: Option<String>,
    /// Whom to ask.
    #[command(flatten)]
    pub(crate) ask: Ask,
}

const REPLAY_HELP: &str = "\
Examples:
  hatchery replay 4711 --picture 4711.png
  hatchery replay 4711 --recording 4711.jsonl --every 4
  hatchery replay 4711 --beside 4712,4713 --film race.png --muscles race.svg --to 10
  hatchery replay 4711 --light round.toml --skill move_to_light --picture round.png

docs/recordings.md says what a recording holds and how a notebook reads it. The exit code is 1 if the fitness \
differs in any bit from what the lineage has; what was asked for is written all the same.";

fn png(typed: &str) -> Result<PathBuf, String> {
    named(typed, &["png"]).ok_or_else(|| "pictures are PNG: name the file .png".to_owned())
}

fn png_or_svg(typed: &str) -> Result<PathBuf, String> {
    named(typed, &["png", "svg"])
        .ok_or_else(|| "charts are PNG or SVG: name the file .png or .svg".to_owned())
}

/// A file with one of these extensions.
fn named(typed: &str, extensions: &[&str]) -> Option<PathBuf> {
    let file = PathBuf::from(typed);
    let is = |extension: &&str| file.extension().is_some_and(|of| of.eq_ignore_ascii_case(extension));
    extensions.iter().any(is).then_some(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_named_as_what_it_is() {
        assert_eq!(png("a/b.png"), Ok(PathBuf::from("a/b.png")));
        assert!(png("a.svg").is_err() && png("png").is_err());
        assert_eq!(png_or_svg("a.SVG"), Ok(PathBuf::from("a.SVG")));
        assert!(png_or_svg("a.pdf").is_err());
    }
}

//! `hatchery check`: validates an experiment file here, without a coordinator. It creates nothing.

use std::path::Path;

use proto::v1;
use search::{Experiment, Problem};
use serde_json::json;

use super::read_text;
use crate::arguments::{Check, Overrides};
use crate::exit::Failure;
use crate::render::{Output, number};

pub(super) fn check(arguments: &Check, output: Output) -> Result<(), Failure> {
    let (file, text) = (&arguments.file, read_text(&arguments.file)?);
    let profiles = unchosen(&text, &arguments.overrides);
    let chosen = read(&text, &arguments.overrides);
    let mut problems: Vec<Problem> = chosen.as_ref().err().cloned().unwrap_or_default();
    for profile in &profiles {
        let overrides = Overrides { profile: Some(profile.clone()), ..arguments.overrides.clone() };
        let found = read(&text, &overrides).err().unwrap_or_default();
        problems.extend(found.into_iter().filter(|one| !problems.contains(one)).collect::<Vec<_>>());
    }
    let experiments = match chosen {
        Ok(experiments) if problems.is_empty() => experiments,
        _ => return Err(refuse(file, &text, problems)),
    };
    if output.json {
        return output.document(&json!({
            "file": file.display().to_string(),
            "profiles": profiles,
            "experiments": experiments.iter().map(document).collect::<Vec<_>>(),
        }));
    }
    if arguments.resolved {
        let texts: Vec<_> = experiments.iter().map(Experiment::resolved).collect();
        return output.line(texts.join("\n").trim_end());
    }
    let also = if profiles.is_empty() { "" } else { ", and with each profile: " };
    output.line(format!("{}: good{also}{}", file.display(), profiles.join(", ")))?;
    for experiment in &experiments {
        output.line(format!("  {}", summary(experiment)))?;
    }
    Ok(())
}

/// The profiles of a file, if none of them is chosen: whoever chooses one later should find it good.
fn unchosen(text: &str, overrides: &Overrides) -> Vec<String> {
    match overrides.profile {
        Some(_) => Vec::new(),
        None => Experiment::profiles(text).unwrap_or_default(),
    }
}

/// The experiments of a file.
///
/// # Errors
/// All its problems, each with its place.
pub(super) fn parse(file: &Path, text: &str, overrides: &Overrides) -> Result<Vec<Experiment>, Failure> {
    read(text, overrides).map_err(|problems| refuse(file, text, problems))
}

fn read(text: &str, overrides: &Overrides) -> Result<Vec<Experiment>, Vec<Problem>> {
    let set = overrides.set.iter().filter_map(|typed| typed.split_once('='));
    let overrides = search::Overrides {
        profile: overrides.profile.clone(),
        set: set.map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned())).collect(),
    };
    Experiment::parse(text, &overrides)
}

/// The failure that shows the problems of a file.
pub(super) fn refuse(file: &Path, text: &str, problems: Vec<Problem>) -> Failure {
    Failure::Problems {
        file: file.to_owned(),
        text: text.to_owned(),
        problems: problems.into_iter().map(on_the_wire).collect(),
    }
}

/// A problem as a coordinator would send it: both ways are shown the same.
fn on_the_wire(problem: Problem) -> v1::Problem {
    v1::Problem {
        start: problem.span.as_ref().map(|span| span.start as u64),
        end: problem.span.as_ref().map(|span| span.end as u64),
        key: problem.key,
        message: problem.message,
        help: problem.help.unwrap_or_default(),
        line: problem.line,
        column: problem.column,
    }
}

fn summary(experiment: &Experiment) -> String {
    let runs = match experiment.runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    };
    let mut words =
        vec![format!("{}:", experiment.name), experiment.system.clone(), experiment.search_kind().to_owned()];
    words.push(format!("{runs}, seed {}", experiment.seed));
    if let (Some(generations), Some(population)) = (experiment.generations(), experiment.population()) {
        words.push(format!("x {generations} generations x {population}"));
    }
    if let Some(planned) = experiment.planned() {
        words.push(format!("= {} individuals", number::count(planned)));
    }
    words.join(" ")
}

fn document(experiment: &Experiment) -> serde_json::Value {
    json!({
        "name": experiment.name,
        "group": experiment.group,
        "profile": experiment.profile,
        "system": experiment.system,
        "search": experiment.search_kind(),
        "seed": experiment.seed,
        "runs": experiment.runs,
        "generations": experiment.generations(),
        "population": experiment.population(),
        "planned": experiment.planned(),
        "cell": experiment.coordinates(),
        "digest": number::hex(&experiment.digest()),
        "resolved": experiment.resolved(),
    })
}

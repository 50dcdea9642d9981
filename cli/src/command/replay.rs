//! `hatchery replay`: lives an individual again, and others beside it, and says whether every bit is as it was. It
//! writes a recording and pictures if asked to, and nothing into the lineage.

use std::io::Write;
use std::path::Path;

use anyhow::anyhow;
use creatures::record::{Recording, Subject};
use serde_json::{Value, json};

use super::life::{Life, Seen, Watched, died};
use super::show::fetch;
use crate::arguments::Replay;
use crate::connect::{Connection, Source};
use crate::exit::Failure;
use crate::picture::{self, Layout};
use crate::render::Output;
use crate::render::whole::Whole;

mod light;

pub(super) async fn replay(arguments: Replay, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    if let Some(script) = arguments.light.clone() {
        let recorded = fetch(&connection, arguments.individual).await?;
        return light::show(recorded, script, arguments, output).await;
    }
    let watched = watched(&arguments);
    let mut lives = Vec::new();
    for id in std::iter::once(arguments.individual).chain(arguments.beside.iter().copied()) {
        let recorded = fetch(&connection, id).await?;
        let life = tokio::task::spawn_blocking(move || Life::again(recorded, watched))
            .await
            .map_err(|error| died(id, error))??;
        lives.push(life);
    }
    draw(&lives, &arguments)?;
    let files = [
        ("recording", &arguments.recording),
        ("picture", &arguments.picture),
        ("film", &arguments.film),
        ("muscles", &arguments.muscles),
    ];
    let (first, others) = lives.split_first().expect("one is named by every replay");
    if output.json {
        let mut document = first.document();
        for (what, file) in files {
            document[what] = json!(file);
        }
        document["beside"] = others.iter().map(Life::document).collect::<Vec<Value>>().into();
        output.document(&document)?;
    } else {
        for life in lives.iter().filter(|life| life.differences.is_empty()) {
            output.line(life.line())?;
        }
        for (what, file) in files.iter().filter_map(|(what, file)| Some((what, file.as_ref()?))) {
            output.line(format!("{what} {}", file.display()))?;
        }
    }
    let different = lives.iter().filter(|life| !life.differences.is_empty());
    let different: Vec<String> = different
        .map(|life| {
            format!("individual {} came out differently: {}", life.recorded.id, life.differences.join("; "))
        })
        .collect();
    if different.is_empty() { Ok(()) } else { Err(anyhow!(different.join("\n")).into()) }
}

/// How a life is recorded, if anything of it is to be written.
fn watched(arguments: &Replay) -> Option<Watched> {
    let files = [&arguments.recording, &arguments.picture, &arguments.film, &arguments.muscles];
    let is_asked_for = files.iter().any(|file| file.is_some());
    is_asked_for.then_some(Watched { trial: arguments.trial, every: arguments.every })
}

/// Writes what is asked for of what was seen: recording and picture are of the first life alone.
fn draw(lives: &[Life], arguments: &Replay) -> Result<(), Failure> {
    let seen: Vec<(&Life, &Seen)> =
        lives.iter().filter_map(|life| Some((life, life.seen.as_ref()?))).collect();
    let Some(&(first, of_first)) = seen.first() else { return Ok(()) };
    if let Some(file) = &arguments.recording {
        write(&of_first.recording, &of_first.subject, file)?;
    }
    let captions = first.captions(of_first);
    if let Some(file) = &arguments.picture {
        picture::draw(&of_first.recording, Layout::Contact, &captions, file)?;
    }
    if arguments.film.is_none() && arguments.muscles.is_none() {
        return Ok(());
    }
    let mut recording = match &seen[..] {
        [_] => of_first.recording.clone(),
        _ => {
            let of = |(life, seen): &(&Life, &Seen)| (life.recorded.id, seen.recording.clone());
            picture::beside(&seen.iter().map(of).collect::<Vec<_>>())?
        }
    };
    cut(&mut recording, arguments.from, arguments.to)?;
    let captions = match &seen[..] {
        [_] => captions,
        _ => {
            let of: Vec<String> = seen.iter().map(|(life, _)| life.caption()).collect();
            [format!("{} of {}", of_first.subject.system, first.recorded.experiment_name), of.join(";  ")]
        }
    };
    if let Some(file) = &arguments.film {
        picture::draw(&recording, Layout::Film, &captions, file)?;
    }
    if let Some(file) = &arguments.muscles {
        picture::muscles(&recording, &captions, file)?;
    }
    Ok(())
}

/// Leaves what lies between two times.
fn cut(recording: &mut Recording, from: Option<f64>, to: Option<f64>) -> Result<(), Failure> {
    let end = recording.shots.last().map_or(0.0, |shot| shot.time);
    let (from, to) = (from.unwrap_or(0.0), to.unwrap_or(f64::INFINITY));
    recording.shots.retain(|shot| (from..=to).contains(&shot.time));
    if recording.shots.is_empty() {
        return Err(Failure::NotFound(format!(
            "nothing was recorded from {from} to {to}: the trial ends at {end:.2}"
        )));
    }
    Ok(())
}

fn write(recording: &Recording, subject: &Subject, file: &Path) -> std::io::Result<()> {
    let mut out = Whole::begin(file)?;
    for line in recording.lines(subject) {
        writeln!(out, "{line}")?;
    }
    out.end()
}

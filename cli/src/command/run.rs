//! `hatchery run`: the whole in one command. A coordinator in this process on a loopback port of its own,
//! worker processes, and the same client as everywhere else; resumes what the lineage file holds unfinished.
//! It evaluates nothing in this process.

mod summary;

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::time::Instant;

use anyhow::anyhow;
use coordinator::scheduler::Summary;
use coordinator::{Config, Running, StartError};
use proto::v1::watch_event::What;
use proto::v1::{ControlRequest, ListRequest, SubmitReply, SubmitRequest};
use search::Experiment;
use tokio::sync::watch as latest;

use super::{check, import, read_text, watch};
use crate::arguments::Run;
use crate::connect::{Connection, DB_DEFAULT, PROMPT, Source, within};
use crate::crew::{Crew, News};
use crate::exit::Failure;
use crate::render::Output;
use crate::render::progress::Progress;
use crate::signals::Signals;

pub(super) async fn run(mut arguments: Run, output: Output) -> Result<(), Failure> {
    let mut signals = Signals::listen()?;
    let begun = Instant::now();
    arguments.overrides = arguments.overrides.with_seed(arguments.seed);
    let text = read_text(&arguments.file)?;
    let again = again(&arguments);
    if let Some(named) = &arguments.import {
        let lineage = Source::File(arguments.db.clone());
        arguments.overrides.set.push(import::assignment(named, &lineage).await?);
    }
    // A file with problems makes no database.
    let asked = check::parse(&arguments.file, &text, &arguments.overrides)?;
    let coordinator = coordinator::start(Config::embedded(arguments.db.clone()));
    let coordinator = coordinator.await.map_err(|error| match error {
        StartError::Lineage(error) => Failure::from(error),
        error => Failure::Failed(error.into()),
    })?;
    let mut crew = Crew::start(workers(&arguments), &address(&coordinator));
    let done = tokio::select! {
        done = conduct(&arguments, &again, (text, &asked), &coordinator, &mut crew, output) => match done {
            Err(failure) if failure.is_broken_pipe() => Err("nobody reads standard output any more"),
            done => Ok(done),
        },
        () = signals.first() => Err("interrupted"),
    };
    let done = done.unwrap_or_else(|why| {
        let db = arguments.db.display();
        let text = format!("{why}; what was evaluated is in {db}, and this goes on with it: {again}");
        Err(Failure::Interrupted(text))
    });
    let summary = match done {
        Ok(conducted) => summary::gather(&conducted, &arguments.db, begun.elapsed()).await,
        Err(failure) => Err(failure),
    };
    // The workers go last: one that is lost while the coordinator looks on is a suspicion.
    coordinator.shutdown().await;
    drop(crew);
    summary::show(&summary?, output)
}

fn address(coordinator: &Running) -> String {
    format!("http://{}", coordinator.address())
}

/// An experiment that has ended, and the connection that knows it.
#[derive(Debug)]
struct Conducted {
    connection: Connection,
    /// One experiment, or the cells of a matrix.
    experiments: Vec<u64>,
    /// The name of the matrix; empty without one.
    group: String,
}

/// Submits the file and follows the experiment to its end, with an eye on the workers.
async fn conduct(
    arguments: &Run,
    again: &str,
    (text, asked): (String, &[Experiment]),
    coordinator: &Running,
    crew: &mut Crew,
    output: Output,
) -> Result<Conducted, Failure> {
    let address = address(coordinator);
    let connection = Connection::open(&Source::Coordinator(address.clone())).await?;
    let mut progress = Progress::new(output);
    await_worker(coordinator.driver().fleet().summary(), crew, &mut progress).await?;
    let submitted = submit(&connection, arguments, text).await?;
    let first = submitted.experiments.first().ok_or_else(|| anyhow!("the file makes no experiment"))?;
    let group = first.group.clone();
    let reference = if group.is_empty() { first.id.to_string() } else { group.clone() };
    for paused in submitted.experiments.iter().filter(|experiment| experiment.state == "paused") {
        let request = within(PROMPT, ControlRequest { experiment: paused.id.to_string() });
        connection.experiments().resume(request).await?;
    }

    let workers = match workers(arguments) {
        1 => "1 worker".to_owned(),
        workers => format!("{workers} workers"),
    };
    progress.say(&format!("coordinator at {address}, {workers}, lineage in {}", arguments.db.display()))?;
    let named = asked.first().map(|asked| asked.group.as_ref().unwrap_or(&asked.name));
    let name = if group.is_empty() { &first.name } else { &group };
    if let Some(before) = named.filter(|&before| before != name && !submitted.resumed) {
        progress.say(&format!("{before} in this lineage is over: a new experiment begins, {name}"))?;
    }
    let own = |id: u64| submitted.experiments.iter().any(|experiment| experiment.id == id);
    let all = connection.experiments().list(within(PROMPT, ListRequest {})).await?.into_inner().experiments;
    for other in all.iter().filter(|other| other.state == "running" && !own(other.id)) {
        let (name, id) = (&other.name, other.id);
        progress
            .say(&format!("{name} (experiment {id}), which the file holds unfinished, goes on beside it"))?;
    }
    let mut events = watch::open(&connection, &reference).await?;
    let mut marks = BTreeMap::new();
    loop {
        tokio::select! {
            event = events.message() => match event? {
                Some(event) => {
                    if let Some(What::Progress(of)) = &event.what {
                        marks.insert(event.experiment, of.evaluated);
                        crew.evaluated(marks.values().sum());
                    }
                    progress.show(&event)?;
                }
                None => break,
            },
            news = crew.news() => match news {
                News::Restarted(text) => progress.say(&text)?,
                News::Lost(why) => return Err(lost(&why)),
            },
        }
    }
    progress.end();
    watch::verdict(progress.experiments()).map_err(|failure| match failure {
        Failure::Awaiting(what) => {
            let is_found = arguments.db.as_os_str() == DB_DEFAULT;
            let db = quoted(&arguments.db.display().to_string());
            let with = if is_found { String::new() } else { format!(", both with --db {db}") };
            Failure::Awaiting(format!("{what}{with}; and then, to go on: {again}"))
        }
        other => other,
    })?;
    let experiments = submitted.experiments.iter().map(|experiment| experiment.id).collect();
    Ok(Conducted { connection, experiments, group })
}

/// Waits until a worker has attached, so that a run does not begin with the word that there is none.
async fn await_worker(
    mut fleet: latest::Receiver<Summary>,
    crew: &mut Crew,
    progress: &mut Progress,
) -> Result<(), Failure> {
    loop {
        tokio::select! {
            // A fleet that is gone is told of by the next call.
            _ = fleet.wait_for(|fleet| fleet.slots > 0) => return Ok(()),
            news = crew.news() => match news {
                News::Restarted(text) => progress.say(&text)?,
                News::Lost(why) => return Err(lost(&why)),
            },
        }
    }
}

fn lost(why: &str) -> Failure {
    anyhow!("the workers die without evaluating anything: {why}; HATCHERY_LOG=debug shows more").into()
}

async fn submit(connection: &Connection, arguments: &Run, text: String) -> Result<SubmitReply, Failure> {
    let request = SubmitRequest {
        text: text.clone(),
        profile: arguments.overrides.profile.clone().unwrap_or_default(),
        set: arguments.overrides.set.clone(),
        resume: true,
    };
    let reply = connection.experiments().submit(within(PROMPT, request)).await;
    Ok(reply.map_err(|status| Failure::of_submission(status, arguments.file.clone(), text))?.into_inner())
}

/// One worker a core, unless told otherwise.
fn workers(arguments: &Run) -> u16 {
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    arguments.workers.unwrap_or_else(|| cores().try_into().unwrap_or(u16::MAX))
}

/// The command that goes on with a run.
fn again(arguments: &Run) -> String {
    let mut words = vec!["hatchery".to_owned(), "run".to_owned(), arguments.file.display().to_string()];
    let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
    if let Some(profile) = &arguments.overrides.profile {
        option("--profile", profile.clone());
    }
    for set in &arguments.overrides.set {
        option("--set", set.clone());
    }
    if let Some(workers) = arguments.workers {
        option("--workers", workers.to_string());
    }
    if let Some(named) = &arguments.import {
        option("--import", named.clone());
    }
    option("--db", arguments.db.display().to_string());
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::Overrides;

    #[test]
    fn the_command_that_goes_on_makes_the_same_experiment_in_the_same_file() {
        let overrides = Overrides { profile: Some("smoke".into()), set: vec!["name=it's".into()] };
        let arguments = Run {
            file: "my files/a.toml".into(),
            seed: Some(7),
            workers: Some(2),
            db: "b.db".into(),
            import: None,
            overrides: overrides.with_seed(Some(7)),
        };
        let expected = r"hatchery run 'my files/a.toml' --profile smoke --set 'name=it'\''s' --set seed=7 --workers 2 --db b.db";
        assert_eq!(again(&arguments), expected);
    }
}

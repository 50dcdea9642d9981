//! `hatchery replay`: lives an individual again on this machine, from the lineage alone, and compares every
//! bit of its fitness with what was recorded. It writes a recording and a picture if asked to, and nothing into
//! the lineage.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, anyhow};
use creatures::record::{Keeper, Recording, Subject};
use creatures::{Cull, Nobody, Observer, Outcome, Status, System};
use proto::v1::{Genotype, IndividualReply};
use serde_json::json;

use super::show::fetch;
use crate::arguments::Replay;
use crate::connect::{Connection, Source};
use crate::exit::Failure;
use crate::picture;
use crate::render::{Output, number};

mod light;

pub(super) async fn replay(arguments: Replay, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let recorded = fetch(&connection, arguments.individual).await?;
    let id = recorded.id;
    let ended = move |error| anyhow!("individual {id} ends the evaluation that lives it: {error}");
    if let Some(script) = arguments.light.clone() {
        let every = arguments.every;
        let shown = tokio::task::spawn_blocking(move || light::watch(&recorded, &arguments, &script));
        return light::print(&shown.await.map_err(ended)??, every, output);
    }
    let written = [("recording", arguments.recording.clone()), ("picture", arguments.picture.clone())];
    let (recorded, lived) = tokio::task::spawn_blocking(move || {
        let lived = watch(&recorded, &arguments)?;
        Ok::<_, Failure>((recorded, lived))
    })
    .await
    .map_err(ended)??;
    let differences = differences(&recorded, &lived);
    if output.json {
        output.document(&json!({
            "individual": recorded.id,
            "equal": differences.is_empty(),
            "recorded": { "status": recorded.status, "fitness": recorded.fitness,
                "fitness_bits": recorded.fitness.map(number::bits), "steps": recorded.steps },
            "replayed": { "status": word(lived.status), "fitness": lived.fitness,
                "fitness_bits": number::bits(lived.fitness), "steps": lived.steps },
            "differences": differences,
            "recording": written[0].1, "picture": written[1].1,
        }))?;
    } else if differences.is_empty() {
        output.line(format!(
            "individual {}: {}, fitness {} ({}), {} steps: equal bit for bit",
            recorded.id,
            word(lived.status),
            number::figure(lived.fitness),
            number::bits(lived.fitness),
            number::count(lived.steps.into())
        ))?;
    }
    if !output.json {
        for (what, file) in written.iter().filter_map(|(what, file)| Some((what, file.as_ref()?))) {
            output.line(format!("{what} {}", file.display()))?;
        }
    }
    if differences.is_empty() {
        Ok(())
    } else {
        Err(anyhow!("individual {} came out differently: {}", recorded.id, differences.join("; ")).into())
    }
}

/// Lives it again, and writes what is asked for of what was seen.
fn watch(recorded: &IndividualReply, arguments: &Replay) -> Result<Outcome, Failure> {
    if arguments.recording.is_none() && arguments.picture.is_none() {
        return live(recorded, &mut Nobody);
    }
    let mut keeper = Keeper::new(arguments.trial - 1, arguments.every);
    let outcome = live(recorded, &mut keeper)?;
    let (id, trials) = (recorded.id, keeper.trials());
    let recording = keeper.recording().ok_or_else(|| match trials {
        0 => Failure::Failed(anyhow!("individual {id} has no body: there is nothing to record")),
        _ => Failure::NotFound(format!("individual {id} has no trial {}, only {trials}", arguments.trial)),
    })?;
    let subject = subject(recorded, arguments.trial)?;
    if let Some(file) = &arguments.recording {
        write(&recording, &subject, file).with_context(|| file.display().to_string())?;
    }
    if let Some(file) = &arguments.picture {
        let [title, subtitle] = captions(recorded, &subject, trials, &outcome, &recording);
        picture::draw(&recording, &title, &subtitle, file)?;
    }
    Ok(outcome)
}

fn subject(recorded: &IndividualReply, trial: u32) -> Result<Subject, Failure> {
    let system = system(recorded)?;
    Ok(Subject {
        system: system.name().to_owned(),
        version: system.version(),
        individual: recorded.id,
        task: serde_json::from_str(&recorded.task)
            .with_context(|| format!("the task of individual {}", recorded.id))?,
        seed: recorded.seed,
        trial,
        light: None,
    })
}

fn write(recording: &Recording, subject: &Subject, file: &Path) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(file)?);
    for line in recording.lines(subject) {
        writeln!(out, "{line}")?;
    }
    out.into_inner().map_err(|error| error.into_error())?.sync_all()
}

/// What a picture is headed with.
fn captions(
    recorded: &IndividualReply,
    subject: &Subject,
    trials: u32,
    outcome: &Outcome,
    recording: &Recording,
) -> [String; 2] {
    let title = format!(
        "{} {} of {}, run {}, generation {}",
        subject.system, recorded.id, recorded.experiment_name, recorded.run, recorded.generation
    );
    let mut parts = vec![word(outcome.status), format!("fitness {}", number::figure(outcome.fitness))];
    if trials > 1 {
        parts.push(format!("trial {} of {trials}", subject.trial));
    }
    let end = recording.shots.last().map_or(0.0, |shot| shot.time);
    parts.push(format!("{end:.2} {}", recording.scene.time_unit).trim_end().to_owned());
    [title, parts.join(", ")]
}

/// Evaluates the recorded genotype under the recorded task, seed and culling rule.
fn live(recorded: &IndividualReply, observer: &mut dyn Observer) -> Result<Outcome, Failure> {
    let id = recorded.id;
    match recorded.status.as_str() {
        "pending" => {
            return Err(anyhow!("individual {id} has no outcome yet: there is nothing to compare").into());
        }
        "failed" => {
            return Err(anyhow!(
                "individual {id} was set aside, so there is no outcome to compare: {}",
                recorded.note
            )
            .into());
        }
        _ => {}
    }
    let genotype = genotype(recorded)?;
    let system = system(recorded)?;
    same_version(recorded, genotype, system)?;
    let task = system.task(&recorded.task).with_context(|| format!("the task of individual {id}"))?;
    let cull =
        recorded.cull.as_ref().map(|cull| Cull { at: cull.at, cutoff: cull.cutoff, control: cull.control });
    let outcome = task
        .evaluate(&genotype.payload, recorded.seed, cull.as_ref(), observer)
        .with_context(|| format!("the genotype of individual {id}"))?;
    Ok(outcome)
}

/// Outcomes of different versions are never compared (walker X-21).
fn same_version(recorded: &IndividualReply, genotype: &Genotype, system: &dyn System) -> Result<(), Failure> {
    if genotype.version == system.version() {
        return Ok(());
    }
    let (id, lived, name) = (recorded.id, genotype.version, system.name());
    let now = system.version();
    Err(anyhow!("individual {id} lived in version {lived} of {name}, this release has version {now}").into())
}

fn genotype(recorded: &IndividualReply) -> Result<&Genotype, Failure> {
    let genotype = recorded.genotype.as_ref();
    Ok(genotype.ok_or_else(|| anyhow!("individual {} comes without a genotype", recorded.id))?)
}

fn system(recorded: &IndividualReply) -> Result<&'static dyn System, Failure> {
    let name = &genotype(recorded)?.system;
    Ok(creatures::system(name).ok_or_else(|| anyhow!("this release does not know the system `{name}`"))?)
}

/// What came out differently, with both values; floats by their bits.
fn differences(recorded: &IndividualReply, lived: &Outcome) -> Vec<String> {
    let mut differences = Vec::new();
    let mut compare = |what: &str, recorded: String, replayed: String| {
        if recorded != replayed {
            differences.push(format!("{what} recorded {recorded}, replayed {replayed}"));
        }
    };
    let shown = |value: Option<f64>| {
        value.map_or("none".to_owned(), |value| format!("{value} ({})", number::bits(value)))
    };
    compare("status", recorded.status.clone(), word(lived.status));
    compare("fitness", shown(recorded.fitness), shown(Some(lived.fitness)));
    compare("steps", recorded.steps.to_string(), lived.steps.to_string());
    if let (Some(then), Some(now)) = (&recorded.interim, &lived.interim) {
        compare("interim measure", shown(then.measure), shown(Some(now.measure)));
    }
    differences
}

/// A status as the lineage spells it.
fn word(status: Status) -> String {
    match status {
        Status::Completed => "completed".to_owned(),
        Status::Culled => "culled".to_owned(),
        Status::Aborted(reason) => format!("aborted:{}", reason.word()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A probe as a coordinator would record it.
    fn recorded() -> IndividualReply {
        let mut recorded = IndividualReply {
            id: 7,
            status: "completed".into(),
            genotype: Some(Genotype { system: "probe".into(), version: 1, payload: vec![1, 2, 3].into() }),
            task: r#"{"work":8}"#.into(),
            seed: 5,
            ..Default::default()
        };
        let lived = live(&recorded, &mut Nobody).unwrap();
        recorded.fitness = Some(lived.fitness);
        recorded.steps = lived.steps.into();
        recorded
    }

    #[test]
    fn an_individual_lives_again_to_the_same_bits() {
        let recorded = recorded();
        assert_eq!(differences(&recorded, &live(&recorded, &mut Nobody).unwrap()), [""; 0]);
    }

    #[test]
    fn one_bit_of_the_fitness_is_a_difference_and_both_patterns_are_shown() {
        let mut recorded = recorded();
        let truth = recorded.fitness.unwrap();
        let off = f64::from_bits(truth.to_bits() ^ 1);
        recorded.fitness = Some(off);
        let differences = differences(&recorded, &live(&recorded, &mut Nobody).unwrap());
        assert_eq!(differences.len(), 1);
        assert!(differences[0].contains(&number::bits(truth)) && differences[0].contains(&number::bits(off)));
    }

    #[test]
    fn what_has_no_outcome_or_is_of_another_version_is_not_compared() {
        for (status, word) in [("pending", "no outcome yet"), ("failed", "set aside")] {
            let failure =
                live(&IndividualReply { status: status.into(), ..recorded() }, &mut Nobody).unwrap_err();
            assert!(failure.to_string().contains(word), "{failure}");
        }
        let mut old = recorded();
        old.genotype.as_mut().unwrap().version = 0;
        assert!(live(&old, &mut Nobody).unwrap_err().to_string().contains("version 0 of probe"));
    }
}

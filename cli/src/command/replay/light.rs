//! `hatchery replay --light`: an ESP creature shows a skill under a light that a script moves (ESP E-83, R-11). It
//! tells distance and heading error over time, and compares nothing.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use creatures::esp::TaskTable;
use creatures::esp::demonstration::{Demonstration, DemonstrationError, LightScript, Sighting};
use creatures::record::Keeper;
use proto::v1::IndividualReply;
use serde_json::json;

use super::super::life::{died, genotype, same_version, subject, system};
use super::write;
use crate::arguments::Replay;
use crate::command::check::refuse;
use crate::command::read_text;
use crate::exit::Failure;
use crate::picture::{self, Layout};
use crate::render::Output;
use crate::render::table::{Column, table};

/// Lives it, writes what is asked for of what was seen, and tells the rest.
pub(super) async fn show(
    recorded: IndividualReply,
    script: PathBuf,
    arguments: Replay,
    output: Output,
) -> Result<(), Failure> {
    let (id, every) = (recorded.id, arguments.every);
    let shown = tokio::task::spawn_blocking(move || watch(&recorded, &arguments, &script));
    print(&shown.await.map_err(|error| died(id, error))??, every, output)
}

fn watch(recorded: &IndividualReply, arguments: &Replay, file: &Path) -> Result<Demonstration, Failure> {
    let script = read(file)?;
    let id = recorded.id;
    let genotype = genotype(recorded)?;
    let system = system(recorded)?;
    if system.name() != "esp" {
        let text =
            format!("individual {id} is of the system {}: only esp creatures see lights", system.name());
        return Err(Failure::Usage(text));
    }
    same_version(recorded, genotype, system)?;
    let task: TaskTable =
        serde_json::from_str(&recorded.task).with_context(|| format!("the task of individual {id}"))?;
    let task = task.check().with_context(|| format!("the task of individual {id}"))?;
    let mut keeper = Keeper::new(0, arguments.every);
    let shown = task.demonstrate(&genotype.payload, arguments.skill.as_deref(), &script, &mut keeper);
    let shown = shown.map_err(|error| match error {
        DemonstrationError::Skill(problem) => Failure::NotFound(format!("individual {id}: {problem}")),
        DemonstrationError::Genotype(error) => {
            anyhow!(error).context(format!("the genotype of individual {id}")).into()
        }
    })?;
    let recording = keeper.recording();
    if let Some(to) = &arguments.recording {
        let recording = recording.as_ref().ok_or_else(|| nothing(id))?;
        let mut subject = subject(recorded, 1)?;
        subject.light = Some(json!({ "skill": shown.skill, "script": script }));
        write(recording, &subject, to).with_context(|| to.display().to_string())?;
    }
    if let Some(to) = &arguments.picture {
        let title =
            format!("esp {id} of {}, `{}` under a moving light", recorded.experiment_name, shown.skill);
        let recording = recording.as_ref().ok_or_else(|| nothing(id))?;
        picture::draw(recording, Layout::Contact, &[title, summary(&shown)], to)?;
    }
    Ok(shown)
}

fn nothing(id: u64) -> Failure {
    anyhow!("individual {id} did not settle: there is nothing to record").into()
}

fn read(file: &Path) -> Result<LightScript, Failure> {
    let text = read_text(file)?;
    search::read_table(&text, LightScript::read).map_err(|problems| refuse(file, &text, problems))
}

/// With `--json` a line a sighting, one step in so many; otherwise a row a second.
fn print(shown: &Demonstration, every: u32, output: Output) -> Result<(), Failure> {
    if output.json {
        for sighting in shown.sightings.iter().step_by(every.max(1) as usize) {
            output.object(&serde_json::to_value(sighting).map_err(anyhow::Error::new)?)?;
        }
        return Ok(());
    }
    let columns = [
        Column::Right("s"),
        Column::Right("distance, m"),
        Column::Right("heading error, degrees"),
        Column::Right("ahead, m"),
        Column::Right("left, m"),
        Column::Right("light ahead, m"),
        Column::Right("light left, m"),
    ];
    let row = |one: &Sighting| {
        let [ahead, left] = one.creature.map(metres);
        let [light_ahead, light_left] = one.light.map(metres);
        let (distance, error) = (metres(one.distance), format!("{:+.1}", one.heading_error_degrees));
        vec![format!("{:.1}", one.seconds), distance, error, ahead, left, light_ahead, light_left]
    };
    // A row a second, and the last moment.
    let second = 60;
    let last = shown.sightings.len().saturating_sub(1);
    let rows =
        shown.sightings.iter().enumerate().filter(|(step, _)| step.is_multiple_of(second) || *step == last);
    output.line(table(&columns, rows.map(|(_, one)| row(one))))?;
    output.line(format!("`{}`: {}", shown.skill, summary(shown)))
}

/// To the centimetre; what rounds to zero has no sign.
fn metres(length: f64) -> String {
    format!("{:.2}", (100.0 * length).round() / 100.0 + 0.0)
}

/// In one line.
fn summary(shown: &Demonstration) -> String {
    let Some(last) = shown.sightings.last() else { return fault(shown) };
    let count = shown.sightings.len() as f64;
    let mean = |of: fn(&Sighting) -> f64| shown.sightings.iter().map(of).sum::<f64>() / count;
    let mut text = format!(
        "{:.1} s, mean distance {} m, mean heading error {:.1} degrees",
        last.seconds,
        metres(mean(|one| one.distance)),
        mean(|one| one.heading_error_degrees.abs())
    );
    if shown.fault.is_some() {
        text.push_str(&format!("; {}", fault(shown)));
    }
    text
}

fn fault(shown: &Demonstration) -> String {
    shown.fault.as_ref().map(|fault| format!("ended by a fault: {fault}")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use creatures::System;
    use proto::v1::Genotype;

    const PATH: &str = "point = [{ at = 0, ahead = 3, left = 0 }, { at = 1.5, ahead = 3, left = 3.5 }]";

    /// The seeing quadruped as a coordinator would record it.
    fn recorded() -> IndividualReply {
        let proof = creatures::esp::Esp.proofs().remove(1);
        let genotype = Genotype { system: "esp".into(), version: 1, payload: proof.genotype.into() };
        IndividualReply { id: 7, genotype: Some(genotype), task: proof.task, ..Default::default() }
    }

    fn arguments(folder: &Path) -> Replay {
        use clap::Parser;
        #[derive(Parser)]
        struct Typed {
            #[command(flatten)]
            replay: Replay,
        }
        let of = |name: &str| folder.join(name).display().to_string();
        let (light, recording, picture) = (of("light.toml"), of("7.jsonl"), of("7.png"));
        let typed = ["replay", "7", "--light", &light, "--recording", &recording, "--picture", &picture];
        Typed::parse_from(typed).replay
    }

    fn shown(script: &str, recorded: &IndividualReply) -> Result<Demonstration, Failure> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("light.toml");
        std::fs::write(&file, script).unwrap();
        let shown = watch(recorded, &arguments(folder.path()), &file)?;
        let lines = std::fs::read_to_string(folder.path().join("7.jsonl")).unwrap();
        let header: serde_json::Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
        assert_eq!(header["light"]["script"]["point"][1]["left"], 3.5);
        assert_eq!(lines.lines().count(), 1 + shown.sightings.len());
        assert!(folder.path().join("7.png").metadata().unwrap().len() > 1000);
        Ok(shown)
    }

    #[test]
    fn a_script_is_lived_recorded_and_told() {
        let shown = shown(PATH, &recorded()).unwrap();
        assert_eq!((shown.sightings.len(), shown.skill.as_str()), (91, "it"));
        let text = summary(&shown);
        assert!(text.starts_with("1.5 s, mean distance 3."), "{text}");
        assert_eq!([metres(-1e-16), metres(-1.006)], ["0.00", "-1.01"]);
    }

    #[test]
    fn a_bad_script_is_refused_at_its_line_and_column() {
        for (script, place, words) in [
            ("point = [{ at = 0, ahead = 3 }]", (1, 10), &["point[0].left", "is missing"][..]),
            ("\npoint = [{ at = 0, ahead = 3, left = 0 }]", (2, 9), &["point", "two points"]),
            ("hight = 3\npoint = [{ at = 0, ahead = 3, left = 0 }]", (1, 1), &["hight", "`height`"]),
            (&PATH.replace("1.5", "0"), (1, 50), &["point[1].at", "not later"]),
            (&PATH.replace("1.5", "nan"), (1, 50), &["point[1].at", "finite"]),
            ("point = [", (1, 10), &["unclosed array"]),
        ] {
            let failure = shown(script, &recorded()).unwrap_err();
            let Failure::Problems { problems, .. } = &failure else { panic!("{failure:?}") };
            assert_eq!((problems[0].line, problems[0].column), place, "{problems:?}");
            let text = crate::render::failure::lines(Path::new("light.toml"), problems);
            assert!(words.iter().all(|word| text.contains(word)), "{text}");
        }
    }

    #[test]
    fn who_sees_no_light_or_knows_no_such_skill_is_told_so() {
        let mut walker = recorded();
        walker.genotype.as_mut().unwrap().system = "walker".into();
        let failure = shown(PATH, &walker).unwrap_err();
        assert!(failure.to_string().contains("only esp creatures"), "{failure}");
        let mut old = recorded();
        old.genotype.as_mut().unwrap().version = 0;
        assert!(shown(PATH, &old).unwrap_err().to_string().contains("version 0 of esp"));
    }
}

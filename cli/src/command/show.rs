//! `hatchery show`: everything about one individual.

use proto::v1::{IndividualReply, IndividualRequest};
use serde_json::Value;

use crate::arguments::Show;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::table::facts;
use crate::render::{Output, json, number};

pub(super) async fn show(arguments: Show, output: Output) -> Result<(), Failure> {
    let individual =
        fetch(&Connection::open(&Source::of(&arguments.ask)?).await?, arguments.individual).await?;
    if output.json {
        return output.document(&json::individual(&individual));
    }
    output.line(text(&individual))?;
    if arguments.genotype
        && let Some(genotype) = &individual.genotype
    {
        output.line(genotype_text(&genotype.payload)?)?;
    }
    Ok(())
}

/// One individual with all that is needed to live it again.
pub(super) async fn fetch(connection: &Connection, individual: u64) -> Result<IndividualReply, Failure> {
    let request = within(PROMPT, IndividualRequest { individual });
    Ok(connection.lineage().individual(request).await?.into_inner())
}

/// A flat JSON object as `name value` pairs; text that is none as it is.
pub(super) fn pairs(text: &str) -> String {
    let Value::Object(object) = json::parsed(text) else { return text.to_owned() };
    let value = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => number.as_f64().map(number::figure).unwrap_or_default(),
        other => other.to_string(),
    };
    object.iter().map(|(name, of)| format!("{name} {}", value(of))).collect::<Vec<_>>().join(", ")
}

fn genotype_text(payload: &[u8]) -> Result<String, Failure> {
    match json::decoded(payload) {
        Value::Null => Ok(format!("genotype (not CBOR): {}", number::hex(payload))),
        decoded => Ok(serde_json::to_string_pretty(&decoded).map_err(anyhow::Error::new)?),
    }
}

fn text(of: &IndividualReply) -> String {
    let mut lines = vec![
        ("individual", of.id.to_string()),
        ("experiment", format!("{} {}", of.experiment, of.experiment_name)),
        ("place", place(of)),
        ("made by", of.operator.clone()),
        ("status", of.status.clone()),
    ];
    let mut say = |name: &'static str, what: String| {
        if !what.is_empty() {
            lines.push((name, what));
        }
    };
    say("note", of.note.clone());
    say(
        "fitness",
        of.fitness.map_or(String::new(), |f| format!("{}  ({})", number::figure(f), number::bits(f))),
    );
    say("steps", number::count(of.steps));
    say(
        "interim",
        of.interim.as_ref().map_or(String::new(), |interim| {
            let cutoff = of.cull.as_ref().and_then(|cull| cull.cutoff);
            let cutoff =
                cutoff.map_or(String::new(), |cutoff| format!(", cutoff {}", number::figure(cutoff)));
            format!("{} at step {}{cutoff}", number::figure_or_dash(interim.measure), interim.step)
        }),
    );
    say("measures", pairs(&of.measures));
    say("traits", pairs(&of.traits));
    say(
        "parents",
        of.parents
            .iter()
            .map(|link| format!("{} ({})", link.parent, link.role))
            .collect::<Vec<_>>()
            .join(", "),
    );
    say("children", number::count(of.children));
    say(
        "outcome of",
        if of.inherits == 0 { String::new() } else { format!("{}, whose genotype is equal", of.inherits) },
    );
    say(
        "genotype",
        of.genotype.as_ref().map_or(String::new(), |genotype| {
            format!(
                "{} version {}, {} bytes, BLAKE3 {}",
                genotype.system,
                genotype.version,
                genotype.payload.len(),
                number::hex(&of.digest)
            )
        }),
    );
    say("task", task(&of.task));
    say("seed", of.seed.to_string());
    for attempt in &of.attempts {
        say(
            "attempt",
            format!(
                "{} on {}: {}, {} steps in {}",
                attempt.number,
                attempt.worker,
                attempt.fate,
                number::count(attempt.steps),
                number::stretch(attempt.seconds)
            ),
        );
    }
    facts(&lines)
}

/// The task as it is written, but of a syllabus only what is tested: the rest is the experiment's (`--json` has it).
fn task(text: &str) -> String {
    let task = json::parsed(text);
    let (Some(skills), Some(tests)) = (task["skill"].as_array(), task["tests"].as_array()) else {
        return text.to_owned();
    };
    let test = |test: &Value| {
        let skill = test["skill"].as_str().unwrap_or("?");
        let kind = test["fitness"]["kind"].as_str().map_or(String::new(), |kind| format!(" by {kind}"));
        let least = test["stop_below"].as_f64();
        let least = least.map_or(String::new(), |least| format!(", not below {}", number::figure(least)));
        format!("{skill}{kind}{least}")
    };
    let tests: Vec<_> = tests.iter().map(test).collect();
    format!("tests {} (of a syllabus of {} skills)", tests.join("; "), skills.len())
}

fn place(of: &IndividualReply) -> String {
    let stage = if of.stage_name.is_empty() { of.stage.to_string() } else { of.stage_name.clone() };
    format!("run {}, stage {stage}, generation {}, index {}", of.run, of.generation, of.index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::v1::{AttemptInfo, Cull, Genotype, Interim, ParentLink};

    #[test]
    fn everything_known_of_an_individual_is_shown() {
        let individual = IndividualReply {
            id: 4711,
            experiment: 3,
            experiment_name: "crawler-grn".into(),
            run: 1,
            generation: 12,
            index: 7,
            operator: "crossover+tag".into(),
            status: "culled".into(),
            fitness: Some(0.0),
            traits: r#"{"n_reg":6,"beta":1.25}"#.into(),
            measures: r#"{"dis":3.5}"#.into(),
            genotype: Some(Genotype { system: "walker".into(), version: 1, payload: vec![0xa0].into() }),
            digest: vec![0xab; 4].into(),
            task: r#"{"body":"crawler"}"#.into(),
            seed: 9,
            cull: Some(Cull { at: 0.25, cutoff: Some(4.0), control: false }),
            interim: Some(Interim { step: 450, measure: Some(3.5) }),
            steps: 450,
            parents: vec![
                ParentLink { parent: 4600, role: "first".into() },
                ParentLink { parent: 4605, role: "second".into() },
            ],
            attempts: vec![AttemptInfo {
                number: 1,
                worker: "ada-17".into(),
                fate: "counted".into(),
                steps: 450,
                seconds: 0.012,
            }],
            ..Default::default()
        };
        insta::assert_snapshot!(text(&individual));
    }

    #[test]
    fn of_a_syllabus_the_tests_alone_are_shown() {
        let syllabus = r#"{"skill": [{"id": "walk", "fitness": {"kind": "locomotion"}}, {"id": "turn"}],
            "tests": [{"skill": "walk", "stop_below": 0.25, "fitness": {"kind": "locomotion", "seconds": 10}},
            {"skill": "turn", "fitness": {"kind": "turn"}}], "impacts": {}}"#;
        let shown = "tests walk by locomotion, not below 0.2500; turn by turn (of a syllabus of 2 skills)";
        assert_eq!(task(syllabus), shown);
        assert_eq!(task(r#"{"body":"crawler"}"#), r#"{"body":"crawler"}"#);
    }
}

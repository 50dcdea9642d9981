//! What a run came to, and what to ask next. It asks the coordinator while that is still there.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use proto::v1::{BestRequest, Experiment, GetRequest};
use serde_json::json;

use super::Conducted;
use crate::connect::{Connection, PATIENT, PROMPT, within};
use crate::exit::Failure;
use crate::render::table::{Column, facts, table};
use crate::render::{Output, number};

/// A finished run.
#[derive(Debug)]
pub(super) struct Summary {
    experiments: Vec<Ended>,
    group: String,
    db: String,
    seconds: f64,
}

/// One experiment that has ended.
#[derive(Debug)]
struct Ended {
    experiment: Experiment,
    best: Option<Best>,
    /// Its stages, in order, if it has several: what is best of one says nothing of another.
    stages: Vec<Stage>,
}

/// The best of a stage over all runs.
#[derive(Debug, Clone, PartialEq)]
struct Stage {
    name: String,
    individual: u64,
    fitness: f64,
}

/// Its best individual.
#[derive(Debug, Clone, Copy)]
struct Best {
    individual: u64,
    fitness: f64,
    /// The best of the first generation of the same run.
    first: Option<f64>,
}

impl Best {
    /// How many times the first generation's best it is; none where that is nothing.
    fn ratio(&self) -> Option<f64> {
        self.first.filter(|&first| first > 0.0).map(|first| self.fitness / first)
    }
}

pub(super) async fn gather(of: &Conducted, db: &Path, elapsed: Duration) -> Result<Summary, Failure> {
    let mut experiments = Vec::new();
    for &id in &of.experiments {
        let request = GetRequest { experiment: id.to_string() };
        let experiment = of.connection.experiments().get(within(PROMPT, request)).await?.into_inner();
        let stages = stages(&of.connection, id).await?;
        let mut best = best(&of.connection, id).await?;
        if let Some(best) = best.as_mut().filter(|_| !stages.is_empty()) {
            best.first = None; // of a stage that begins with what was learned before
        }
        experiments.push(Ended { experiment, best, stages });
    }
    let db = db.display().to_string();
    Ok(Summary { experiments, group: of.group.clone(), db, seconds: elapsed.as_secs_f64() })
}

async fn best(connection: &Connection, id: u64) -> Result<Option<Best>, Failure> {
    let request = BestRequest { experiment: id.to_string(), limit: 1 };
    let best = connection.lineage().best(within(PATIENT, request)).await?.into_inner().individuals;
    let Some(best) = best.first() else { return Ok(None) };
    let Some(fitness) = best.fitness else { return Ok(None) };
    let mut first = None;
    for row in connection.view("v_generations", Some(&id.to_string())).await?.collect().await? {
        let place = (row.count("run")?, row.count("stage")?, row.count("generation")?);
        if place == (best.run.into(), best.stage.into(), 1) {
            first = row.real("best")?;
        }
    }
    Ok(Some(Best { individual: best.id, fitness, first }))
}

/// The best of every stage in which somebody is picked; none if there is one stage alone. What leads to a pick or
/// measures it has a colon in its name.
async fn stages(connection: &Connection, id: u64) -> Result<Vec<Stage>, Failure> {
    let mut stages = BTreeMap::<u64, Stage>::new();
    for row in connection.view("v_stages", Some(&id.to_string())).await?.collect().await? {
        let name = row.text("name")?.to_owned();
        let (Some(fitness), false) = (row.real("best")?, name.contains(": ")) else { continue };
        let of = Stage { name, individual: row.count("best_individual")?, fitness };
        let best = stages.entry(row.count("stage")?).or_insert_with(|| of.clone());
        if fitness > best.fitness {
            *best = of;
        }
    }
    Ok(if stages.len() > 1 { stages.into_values().collect() } else { Vec::new() })
}

pub(super) fn show(summary: &Summary, output: Output) -> Result<(), Failure> {
    if output.json {
        return output.object(&document(summary));
    }
    output.line("")?;
    output.line(text(summary))
}

fn document(summary: &Summary) -> serde_json::Value {
    let ended = |of: &Ended| {
        json!({
            "id": of.experiment.id, "name": of.experiment.name, "state": of.experiment.state,
            "best_individual": of.best.map(|best| best.individual),
            "best": of.best.map(|best| best.fitness),
            "first_best": of.best.and_then(|best| best.first),
            "ratio": of.best.and_then(|best| best.ratio()),
            "stages": of.stages.iter().map(|stage| json!({
                "stage": stage.name, "best": stage.fitness, "best_individual": stage.individual,
            })).collect::<Vec<_>>(),
            "evaluated": of.experiment.evaluated, "culled": of.experiment.culled,
            "aborted": of.experiment.aborted, "failed": of.experiment.failed,
        })
    };
    json!({
        "event": "summary",
        "group": if summary.group.is_empty() { None } else { Some(&summary.group) },
        "db": summary.db,
        "seconds": summary.seconds,
        "experiments": summary.experiments.iter().map(ended).collect::<Vec<_>>(),
    })
}

fn text(summary: &Summary) -> String {
    let what = match &summary.experiments[..] {
        [one] => single(one, summary),
        several => matrix(several, summary),
    };
    format!("{what}\n\n{}", next(summary))
}

fn single(of: &Ended, summary: &Summary) -> String {
    let best = of.best.map_or("none".to_owned(), |best| {
        let ratio =
            best.ratio().map_or(String::new(), |ratio| format!(", {ratio:.2} times the first generation's"));
        format!("{} by individual {}{ratio}", number::figure(best.fitness), best.individual)
    });
    let mut lines = vec![("finished", format!("{} (experiment {})", of.experiment.name, of.experiment.id))];
    if of.stages.is_empty() {
        lines.push(("best", best));
    }
    lines.push(("evaluated", evaluated(&of.experiment, summary.seconds)));
    lines.push(("lineage", summary.db.clone()));
    let mut text = facts(&lines);
    if !of.stages.is_empty() {
        let columns = [Column::Left("stage"), Column::Right("best"), Column::Right("individual")];
        let row = |stage: &Stage| {
            vec![stage.name.clone(), number::figure(stage.fitness), stage.individual.to_string()]
        };
        text = format!("{text}\n\n{}", table(&columns, of.stages.iter().map(row)));
    }
    text
}

fn evaluated(of: &Experiment, seconds: f64) -> String {
    let mut text = format!("{} in {}", number::count(of.evaluated), number::stretch(seconds));
    for (count, word) in [(of.culled, "culled"), (of.aborted, "aborted"), (of.failed, "failed")] {
        if count > 0 {
            text.push_str(&format!(", {} {word}", number::count(count)));
        }
    }
    text
}

fn matrix(several: &[Ended], summary: &Summary) -> String {
    let columns = [
        Column::Right("id"),
        Column::Left("name"),
        Column::Right("best"),
        Column::Right("individual"),
        Column::Right("ratio"),
        Column::Right("evaluated"),
        Column::Right("culled"),
    ];
    let row = |of: &Ended| {
        vec![
            of.experiment.id.to_string(),
            of.experiment.name.clone(),
            number::figure_or_dash(of.best.map(|best| best.fitness)),
            of.best.map_or("-".to_owned(), |best| best.individual.to_string()),
            of.best.and_then(|best| best.ratio()).map_or("-".to_owned(), |ratio| format!("{ratio:.2}")),
            number::count(of.experiment.evaluated),
            number::count(of.experiment.culled),
        ]
    };
    let rows = table(&columns, several.iter().map(row));
    format!(
        "{rows}\n\n{} finished in {}, lineage in {}",
        summary.group,
        number::stretch(summary.seconds),
        summary.db
    )
}

/// What to ask next.
fn next(summary: &Summary) -> String {
    let db = if summary.db == "hatchery.db" {
        String::new()
    } else {
        format!(" --db {}", super::quoted(&summary.db))
    };
    let mut lines = Vec::new();
    if summary.experiments.len() > 1 {
        lines.push(format!("hatchery compare {}{db}", super::quoted(&summary.group)));
    }
    if let Some(best) = summary.experiments.iter().find_map(|ended| ended.best) {
        lines.push(format!("hatchery show {}{db}", best.individual));
        lines.push(format!("hatchery lineage {} --line{db}", best.individual));
        lines.push(format!("hatchery replay {}{db}", best.individual));
    }
    if let Some(first) = summary.experiments.first() {
        lines.push(format!("hatchery hash {}{db}", first.experiment.id));
    }
    format!("next:\n  {}", lines.join("\n  "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(id: u64, first: f64) -> Ended {
        let experiment = Experiment {
            id,
            name: format!("crawler-{id}"),
            state: "finished".into(),
            evaluated: 3200,
            culled: 12,
            ..Default::default()
        };
        let best = Some(Best { individual: 4711, fitness: 61.25, first: Some(first) });
        Ended { experiment, best, stages: vec![] }
    }

    fn summary(experiments: Vec<Ended>, group: &str) -> Summary {
        Summary { experiments, group: group.into(), db: "my runs/a.db".into(), seconds: 41.25 }
    }

    #[test]
    fn a_run_ends_with_what_it_came_to_and_what_to_ask_next() {
        insta::assert_snapshot!(text(&summary(vec![ended(1, 42.5)], "")));
    }

    #[test]
    fn of_a_syllabus_every_skill_has_its_best() {
        let stage = |name: &str, individual, fitness| Stage { name: name.into(), individual, fitness };
        let stages = vec![stage("forward_locomotion", 310, 0.125), stage("left_turn", 4711, 0.75)];
        let text = text(&summary(vec![Ended { stages, ..ended(1, 42.5) }], ""));
        assert!(!text.contains("times the first"), "{text}");
        for row in ["forward_locomotion", "0.1250", "310", "left_turn", "0.7500"] {
            assert!(text.contains(row), "{text}");
        }
    }

    #[test]
    fn a_matrix_ends_with_a_line_a_cell_and_its_comparison() {
        insta::assert_snapshot!(text(&summary(vec![ended(1, 42.5), ended(2, 0.0)], "grn-vs-neat")));
    }
}

//! The cells that are compared: experiments with their runs, read from rows of the lineage's views. It
//! computes nothing and asks nothing.

use std::collections::BTreeMap;

use anyhow::Context;
use search::experiment::Published;
use serde::Deserialize;

use crate::connect::Cells as Row;
use crate::exit::Failure;

mod skills;

/// The kind of search whose stages are skills.
const SYLLABUS: &str = "syllabus";

/// One experiment as a cell of the comparison.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cell {
    /// Its number in the lineage.
    pub(crate) experiment: u64,
    /// Its name.
    pub(crate) name: String,
    /// The matrix that it is a cell of; empty without one.
    pub(crate) group: String,
    /// The system's name.
    pub(crate) system: String,
    /// The system's version: outcomes of different versions are never mixed (X-21).
    pub(crate) world: u64,
    /// What moves, and whatever else the cells of a matrix differ in besides the method.
    pub(crate) body: String,
    /// The skill, of a syllabus: the cell is then that skill's alone.
    pub(crate) skill: Option<String>,
    /// The kind of its search.
    pub(crate) method: String,
    /// Its resolved task without the body: cells that are tested against each other have it in common.
    pub(crate) settings: serde_json::Value,
    /// The profile that it was submitted with; empty without one.
    pub(crate) profile: String,
    /// Runs asked for.
    pub(crate) planned: usize,
    /// Runs begun, in order of number.
    pub(crate) runs: Vec<Run>,
    /// What has been published on its body.
    pub(crate) published: Vec<Published>,
}

/// One run: its last stage.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Run {
    /// True once its last generation has ended.
    pub(crate) finished: bool,
    /// The generations that it takes, when known.
    pub(crate) planned: Option<u64>,
    /// Those that have ended, in order.
    pub(crate) generations: Vec<Generation>,
}

/// The fitness of one generation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Generation {
    /// Its number, from 1.
    pub(crate) number: u64,
    /// Its individuals.
    pub(crate) size: u64,
    /// Largest fitness.
    pub(crate) best: f64,
    /// Mean fitness.
    pub(crate) mean: f64,
    /// Least fitness.
    pub(crate) worst: f64,
    /// True if its evaluations were culled below a cutoff, or would have been.
    pub(crate) culling: bool,
}

impl Cell {
    /// The result of every finished run: the best fitness of its last generation (G-64).
    pub(crate) fn results(&self) -> Vec<f64> {
        self.finished().filter_map(|run| run.generations.last()).map(|last| last.best).collect()
    }

    /// The runs that have finished.
    pub(crate) fn finished(&self) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(|run| run.finished)
    }

    /// The generations that each of its runs takes, when known.
    pub(crate) fn generations(&self) -> Option<u64> {
        self.runs
            .iter()
            .find_map(|run| run.planned.or_else(|| run.finished.then_some(run.generations.len() as u64)))
    }

    /// The individuals of a generation.
    pub(crate) fn population(&self) -> Option<u64> {
        self.runs.iter().find_map(|run| run.generations.first()).map(|first| first.size)
    }

    /// True if any of its generations was under a culling rule.
    pub(crate) fn culling(&self) -> bool {
        self.runs.iter().flat_map(|run| &run.generations).any(|generation| generation.culling)
    }

    /// What was published on it.
    pub(crate) fn paper(&self) -> Option<&Published> {
        self.published.iter().find(|row| row.body == self.body && row.method == self.method)
    }
}

/// The cells of rows of `v_experiments`, `v_stages` and `v_generations`, in order of experiment.
pub(crate) fn cells(experiments: &[Row], stages: &[Row], generations: &[Row]) -> Result<Vec<Cell>, Failure> {
    let mut cells = BTreeMap::new();
    for row in experiments {
        let experiment = row.count("experiment")?;
        cells.insert(experiment, (cell(experiment, row)?, BTreeMap::<u64, (u64, Run)>::new()));
    }
    for row in stages {
        let Some((_, runs)) = cells.get_mut(&row.count("experiment")?) else { continue };
        let stage = row.count("stage")?;
        let ended = row.integer("ended_ms")?.is_some();
        let entry = runs
            .entry(row.count("run")?)
            .or_insert_with(|| (stage, Run { finished: true, ..Run::default() }));
        entry.1.finished &= ended;
        if stage >= entry.0 {
            entry.0 = stage;
            entry.1.planned = row.integer("generations")?.and_then(|planned| u64::try_from(planned).ok());
        }
    }
    for row in generations {
        let Some((_, runs)) = cells.get_mut(&row.count("experiment")?) else { continue };
        let Some((last_stage, run)) = runs.get_mut(&row.count("run")?) else { continue };
        if row.count("stage")? == *last_stage
            && let Some(generation) = generation(row)?
        {
            run.generations.push(generation);
        }
    }
    let mut made = Vec::new();
    let whole = |(mut cell, runs): (Cell, BTreeMap<u64, (u64, Run)>)| {
        cell.runs = runs.into_values().map(|(_, run)| run).collect();
        for run in &mut cell.runs {
            run.generations.sort_by_key(|generation| generation.number);
        }
        cell
    };
    for cell in cells.into_values().map(whole) {
        let skills = match cell.method.as_str() {
            SYLLABUS => skills::skills(&cell, stages, generations)?,
            _ => Vec::new(),
        };
        made.extend(if skills.is_empty() { vec![cell] } else { skills });
    }
    Ok(made)
}

/// A generation that has ended; none while it is open.
fn generation(row: &Row) -> Result<Option<Generation>, Failure> {
    let (Some(best), Some(mean), Some(worst)) = (row.real("best")?, row.real("mean")?, row.real("worst")?)
    else {
        return Ok(None);
    };
    Ok(Some(Generation {
        number: row.count("generation")?,
        size: row.count("individuals")?,
        best,
        mean,
        worst,
        culling: row.real("cull_at")?.is_some(),
    }))
}

fn cell(experiment: u64, row: &Row) -> Result<Cell, Failure> {
    let name = row.text("name")?.to_owned();
    let read = |column: &str| -> Result<serde_json::Value, Failure> {
        let text = row.text(column)?;
        if text.is_empty() {
            return Ok(serde_json::Value::Null);
        }
        let value = serde_json::from_str(text).with_context(|| format!("`{column}` of experiment {name}"))?;
        Ok(value)
    };
    let (coordinates, mut task, published) = (read("cell")?, read("task")?, read("published")?);
    let published = match published {
        serde_json::Value::Null => Vec::new(),
        list => serde_json::from_value(list).with_context(|| format!("`published` of experiment {name}"))?,
    };
    let body = body(&coordinates, &task, row.text("system")?);
    if let Some(settings) = task.as_object_mut() {
        settings.remove("body");
    }
    Ok(Cell {
        experiment,
        group: row.text("group")?.to_owned(),
        system: row.text("system")?.to_owned(),
        world: row.count("system_version")?,
        body,
        skill: None,
        settings: task,
        method: row.text("search")?.to_owned(),
        profile: profile(row.text("resolved")?),
        planned: usize::try_from(row.count("runs")?).context("runs")?,
        runs: Vec::new(),
        published,
        name,
    })
}

/// The profile that a resolved file says it was made with. Only that key is read: the text may be of another
/// release.
fn profile(resolved: &str) -> String {
    #[derive(Default, Deserialize)]
    struct Stored {
        #[serde(default)]
        profile: String,
    }
    toml::from_str::<Stored>(resolved).unwrap_or_default().profile
}

/// What a cell is called besides its method: the body, then its other matrix coordinates.
fn body(coordinates: &serde_json::Value, task: &serde_json::Value, system: &str) -> String {
    let word = |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let mut words: Vec<String> = task.get("body").map(word).into_iter().collect();
    for (key, value) in coordinates.as_object().into_iter().flatten() {
        if !matches!(key.as_str(), "task.body" | "search.kind") {
            let key = key.rsplit('.').next().unwrap_or(key);
            words.push(format!("{key}={}", word(value)));
        }
    }
    if words.is_empty() { system.to_owned() } else { words.join(" ") }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proto::v1::value::Kind;

    /// A cell with runs of one generation a result, for tests of what is made of cells.
    pub(crate) fn finished(body: &str, method: &str, results: &[f64]) -> Cell {
        let run = |&best: &f64| Run {
            finished: true,
            planned: Some(2),
            generations: [0.5, 1.0]
                .iter()
                .zip(1..)
                .map(|(share, number)| Generation {
                    number,
                    size: 80,
                    best: best * share,
                    mean: best * share / 2.0,
                    worst: 0.0,
                    culling: false,
                })
                .collect(),
        };
        Cell {
            experiment: 1,
            name: format!("walkers/{body}-{method}"),
            group: "walkers".into(),
            system: "walker".into(),
            world: 1,
            body: body.into(),
            skill: None,
            method: method.into(),
            settings: serde_json::json!({"phi": 10.0, "theta": 2.0}),
            profile: String::new(),
            planned: results.len(),
            runs: results.iter().map(run).collect(),
            published: Vec::new(),
        }
    }

    fn text(text: &str) -> Kind {
        Kind::Text(text.into())
    }

    fn experiment(id: i64, cell: &str) -> Row {
        Row::new(&[
            ("experiment", Kind::Integer(id)),
            ("name", text("walkers/arm-neat")),
            ("group", text("walkers")),
            ("system", text("walker")),
            ("system_version", Kind::Integer(1)),
            ("search", text("neat")),
            ("resolved", text("name = \"walkers/arm-neat\"\nprofile = \"smoke\"\n[task]\nbody = \"arm\"\n")),
            ("runs", Kind::Integer(2)),
            ("cell", text(cell)),
            ("task", text(r#"{"body":"arm","phi":10.0}"#)),
            ("published", text(r#"[{"body":"arm","method":"neat","mean":202.2}]"#)),
        ])
    }

    fn stage(run: i64, stage: i64, ended: bool) -> Row {
        let mut cells = vec![
            ("experiment", Kind::Integer(4)),
            ("run", Kind::Integer(run)),
            ("stage", Kind::Integer(stage)),
            ("generations", Kind::Integer(2)),
        ];
        cells.push(("ended_ms", Kind::Integer(1)));
        let mut row = Row::new(&cells);
        if !ended {
            row.clear("ended_ms");
        }
        row
    }

    fn generation(run: i64, stage: i64, number: i64, best: f64) -> Row {
        Row::new(&[
            ("experiment", Kind::Integer(4)),
            ("run", Kind::Integer(run)),
            ("stage", Kind::Integer(stage)),
            ("generation", Kind::Integer(number)),
            ("individuals", Kind::Integer(80)),
            ("best", Kind::Real(best)),
            ("mean", Kind::Real(best / 2.0)),
            ("worst", Kind::Integer(0)),
            ("cull_at", Kind::Real(0.25)),
        ])
    }

    #[test]
    fn rows_become_cells_with_runs_in_order_and_the_last_stage_alone() {
        let stages = [stage(1, 0, true), stage(1, 1, true), stage(2, 0, false)];
        let generations = [
            generation(1, 1, 2, 9.0),
            generation(1, 0, 1, 1.0),
            generation(1, 1, 1, 8.0),
            generation(2, 0, 1, 3.0),
        ];
        let made =
            cells(&[experiment(4, r#"{"task.body":"arm","search.population":40}"#)], &stages, &generations);
        let [cell] = &made.unwrap()[..] else { panic!("one experiment is one cell") };
        assert_eq!((cell.body.as_str(), cell.method.as_str()), ("arm population=40", "neat"));
        assert_eq!(cell.results(), [9.0], "the second run has not finished");
        assert_eq!(cell.runs[0].generations.iter().map(|g| g.best).collect::<Vec<_>>(), [8.0, 9.0]);
        assert!(cell.culling());
        assert_eq!((cell.generations(), cell.population()), (Some(2), Some(80)));
    }

    #[test]
    fn the_skills_of_a_syllabus_are_cells_of_their_own() {
        let row = experiment(4, "{}").with("search", text("syllabus")).with("task", text(""));
        let named = |name: &str, number, ended| stage(1, number, ended).with("name", text(name));
        let stages = [
            named("walk", 0, true),
            named("walk: measure", 1, true),
            named("turn", 2, true),
            named("turn: reconcile walk", 3, false),
        ];
        let generations = [
            generation(1, 0, 1, 1.0),
            generation(1, 1, 1, 2.0),
            generation(1, 2, 2, 9.0),
            generation(1, 2, 1, 8.0),
        ];
        let made = cells(&[row], &stages, &generations).unwrap();
        let [walk, turn] = &made[..] else { panic!("two skills: {made:?}") };
        assert_eq!((walk.skill.as_deref(), walk.results()), (Some("walk"), vec![1.0]));
        assert_eq!((turn.body.as_str(), turn.results()), ("turn", vec![9.0]));
    }

    #[test]
    fn a_published_result_is_found_by_body_and_method() {
        let made = cells(&[experiment(4, "{}")], &[], &[]).unwrap();
        assert_eq!(made[0].paper().unwrap().mean, 202.2);
        assert_eq!(made[0].results(), [0.0; 0]);
        assert_eq!(made[0].profile, "smoke");
    }
}

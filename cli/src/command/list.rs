//! `hatchery list`: every experiment, one a line. It shows what `status` shows in full.

use proto::v1::{Experiment, ListRequest};

use crate::arguments::Ask;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::table::{Column, table};
use crate::render::{Output, json, number};

pub(super) async fn list(ask: &Ask, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(ask)?).await?;
    let reply = connection.experiments().list(within(PROMPT, ListRequest {})).await?.into_inner();
    show(&reply.experiments, output)
}

/// Shows experiments as a table, or as a JSON list.
pub(super) fn show(experiments: &[Experiment], output: Output) -> Result<(), Failure> {
    if output.json {
        return output.document(&experiments.iter().map(json::experiment).collect::<Vec<_>>());
    }
    if experiments.is_empty() {
        return output.line("no experiments yet: start one with hatchery run FILE");
    }
    let columns = [
        Column::Right("id"),
        Column::Left("name"),
        Column::Left("system"),
        Column::Left("search"),
        Column::Left("state"),
        Column::Left("stage"),
        Column::Right("runs"),
        Column::Right("evaluated"),
        Column::Right("planned"),
        Column::Right("best"),
        Column::Left("begun (UTC)"),
    ];
    let row = |of: &Experiment| {
        // Of the latest stage: the fitness of different ones does not compare.
        let latest = of.progress.iter().map(|run| run.stage).max();
        let in_it = of.progress.iter().filter(|run| Some(run.stage) == latest);
        let best = in_it.filter_map(|run| run.best).reduce(f64::max);
        vec![
            of.id.to_string(),
            of.name.clone(),
            of.system.clone(),
            of.search.clone(),
            of.state.clone(),
            stage(of),
            of.runs.to_string(),
            number::count(of.evaluated),
            if of.planned == 0 { "-".to_owned() } else { number::count(of.planned) },
            number::figure_or_dash(best),
            number::time(of.created_ms),
        ]
    };
    output.line(table(&columns, experiments.iter().map(row)))
}

/// Where its hindmost run is: `left_turn 12/80`.
fn stage(of: &Experiment) -> String {
    let Some(run) = of.progress.iter().min_by_key(|run| (run.stage, run.generation)) else {
        return "-".to_owned();
    };
    let generations = if run.generations == 0 { String::new() } else { format!("/{}", run.generations) };
    let space = if run.stage_name.is_empty() { "" } else { " " };
    format!("{}{space}{}{generations}", run.stage_name, run.generation)
}

//! `hatchery status`: one experiment, with a line a run.

use proto::v1::{Experiment, GetRequest, Run};

use crate::arguments::AskExperiment;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::table::{Column, facts, table};
use crate::render::{Output, json, number};

pub(super) async fn status(arguments: AskExperiment, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let request = GetRequest { experiment: arguments.experiment };
    let experiment = connection.experiments().get(within(PROMPT, request)).await?.into_inner();
    if output.json {
        return output.document(&json::experiment(&experiment));
    }
    output.line(text(&experiment))
}

fn text(of: &Experiment) -> String {
    let mut state = of.state.clone();
    if !of.reason.is_empty() {
        state.push_str(&format!(": {}", of.reason));
    }
    let mut lines = vec![
        ("experiment", format!("{} {}", of.id, of.name)),
        ("state", state),
        ("system", of.system.clone()),
        ("search", of.search.clone()),
        ("seed", of.seed.to_string()),
        ("begun", format!("{} UTC", number::time(of.created_ms))),
    ];
    if let Some(ended) = of.ended_ms {
        let seconds = (ended - of.created_ms) as f64 / 1000.0;
        lines.push(("ended", format!("{} UTC, after {}", number::time(ended), number::stretch(seconds))));
    }
    let planned = if of.planned == 0 { String::new() } else { format!(" of {}", number::count(of.planned)) };
    lines.push((
        "evaluated",
        format!(
            "{}{planned} ({} culled, {} aborted, {} failed)",
            number::count(of.evaluated),
            number::count(of.culled),
            number::count(of.aborted),
            number::count(of.failed)
        ),
    ));
    let mut text = facts(&lines);
    if !of.progress.is_empty() {
        text.push_str("\n\n");
        text.push_str(&runs(&of.progress));
    }
    text
}

fn runs(runs: &[Run]) -> String {
    let columns = [
        Column::Right("run"),
        Column::Left("stage"),
        Column::Right("generation"),
        Column::Right("done"),
        Column::Right("best"),
        Column::Right("individual"),
        Column::Left("state"),
    ];
    let row = |of: &Run| {
        let stage = if of.stage_name.is_empty() { of.stage.to_string() } else { of.stage_name.clone() };
        let generations = if of.generations == 0 { String::new() } else { format!("/{}", of.generations) };
        vec![
            of.run.to_string(),
            stage,
            format!("{}{generations}", of.generation),
            format!("{}/{}", of.done, of.size),
            number::figure_or_dash(of.best),
            if of.best_individual == 0 { "-".to_owned() } else { of.best_individual.to_string() },
            if of.finished { "finished" } else { "open" }.to_owned(),
        ]
    };
    table(&columns, runs.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_names_the_state_its_reason_and_every_run() {
        let run = Run {
            run: 1,
            generation: 12,
            generations: 40,
            done: 17,
            size: 80,
            best: Some(61.25),
            best_individual: 4711,
            ..Default::default()
        };
        let experiment = Experiment {
            id: 3,
            name: "crawler-grn".into(),
            system: "walker".into(),
            search: "grn".into(),
            state: "running".into(),
            reason: "no worker is attached".into(),
            seed: 1,
            runs: 2,
            evaluated: 977,
            planned: 6400,
            aborted: 2,
            progress: vec![run, Run { run: 2, finished: true, ..Default::default() }],
            ..Default::default()
        };
        insta::assert_snapshot!(text(&experiment));
    }
}

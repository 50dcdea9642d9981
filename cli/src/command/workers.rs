//! `hatchery workers`: who is attached to a coordinator, and what they did.

use proto::v1::{WorkerInfo, WorkersRequest};

use crate::arguments::Dial;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::table::{Column, table};
use crate::render::{Output, json, number};

pub(super) async fn workers(dial: &Dial, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::coordinator(dial)?).await?;
    let workers = connection.fleet().workers(within(PROMPT, WorkersRequest {})).await?.into_inner().workers;
    if output.json {
        return output.document(&workers.iter().map(json::worker).collect::<Vec<_>>());
    }
    if workers.is_empty() {
        return output.line("no worker is attached: start some with hatchery-worker");
    }
    let columns = [
        Column::Right("id"),
        Column::Left("name"),
        Column::Left("host"),
        Column::Left("state"),
        Column::Right("slots"),
        Column::Right("in flight"),
        Column::Right("completed"),
        Column::Right("lost"),
        Column::Right("busy"),
        Column::Left("version"),
        Column::Left("attached (UTC)"),
        Column::Left("labels"),
    ];
    let row = |of: &WorkerInfo| {
        vec![
            of.id.to_string(),
            of.name.clone(),
            of.host.clone(),
            of.state.clone(),
            of.slots.to_string(),
            format!("{}/{}", of.in_flight, of.window),
            number::count(of.completed),
            number::count(of.lost),
            number::stretch(of.busy_seconds),
            of.version.clone(),
            number::time(of.attached_ms),
            of.labels.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(" "),
        ]
    };
    output.line(table(&columns, workers.iter().map(row)))
}

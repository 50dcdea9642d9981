//! `hatchery workers`: who is attached to a coordinator, what they did, and why they do nothing.

use proto::v1::{WorkerInfo, WorkersRequest};

use crate::arguments::Dial;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::table::{Column, table};
use crate::render::{Output, json, number};

pub(super) async fn workers(dial: &Dial, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::coordinator(dial)?).await?;
    let reply = connection.fleet().workers(within(PROMPT, WorkersRequest {})).await?.into_inner();
    let (workers, notes) = (reply.workers, reply.notes);
    if output.json {
        return output.document(&workers.iter().map(json::worker).collect::<Vec<_>>());
    }
    if workers.is_empty() {
        return output.line(notes.join("\n"));
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
    let mut text = table(&columns, workers.iter().map(row));
    for note in notes {
        text.push_str(&format!("\n{note}"));
    }
    output.line(text)
}

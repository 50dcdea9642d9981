//! `hatchery pick`: says who goes on from the end of a stage, to a coordinator or into a file at rest.

use proto::v1::PickRequest;

use crate::arguments::Pick;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::{Output, json};

pub(super) async fn pick(arguments: Pick, output: Output) -> Result<(), Failure> {
    let source = Source::of(&arguments.ask)?;
    let connection = Connection::open(&source).await?;
    let Pick { experiment, individual, note, .. } = arguments;
    let request = within(PROMPT, PickRequest { experiment, individual, note });
    let picked = connection.experiments().pick(request).await?.into_inner();
    if output.json {
        return output.document(&json::experiment(&picked));
    }
    let then = match source {
        Source::File(_) => "it goes on when `hatchery run` is given its file again",
        _ if picked.state == "paused" => "it goes on when it is resumed",
        _ => "it goes on",
    };
    output
        .line(format!("experiment {} {}: individual {individual} is picked; {then}", picked.id, picked.name))
}

//! `hatchery pause`, `resume` and `cancel`: one order to a coordinator, or into a file at rest, about an experiment or
//! every cell of a matrix.

use proto::v1::ControlRequest;

use super::list;
use crate::arguments::Control;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::Output;

/// What to do with the experiments named.
#[derive(Debug, Clone, Copy)]
pub(super) enum Order {
    Pause,
    Resume,
    Cancel,
}

pub(super) async fn control(order: Order, arguments: Control, output: Output) -> Result<(), Failure> {
    let source = match arguments.db {
        Some(file) => Source::File(file),
        None => Source::coordinator(&arguments.dial)?,
    };
    let connection = Connection::open(&source).await?;
    let mut client = connection.experiments();
    let request = within(PROMPT, ControlRequest { experiment: arguments.experiment });
    let reply = match order {
        Order::Pause => client.pause(request).await?,
        Order::Resume => client.resume(request).await?,
        Order::Cancel => client.cancel(request).await?,
    };
    list::show(&reply.into_inner().experiments, output)
}

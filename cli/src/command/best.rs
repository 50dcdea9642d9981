//! `hatchery best`: the best individuals of an experiment, or of each cell of a matrix.

use proto::v1::{BestRequest, IndividualReply};

use crate::arguments::Best;
use crate::connect::{Connection, PATIENT, Source, within};
use crate::exit::Failure;
use crate::render::table::{Column, table};
use crate::render::{Output, json, number};

pub(super) async fn best(arguments: Best, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let request = BestRequest { experiment: arguments.experiment, limit: arguments.limit };
    let best = connection.lineage().best(within(PATIENT, request)).await?.into_inner().individuals;
    if output.json {
        return output.document(&best.iter().map(json::individual).collect::<Vec<_>>());
    }
    if best.is_empty() {
        return output.line("nothing has been evaluated yet");
    }
    output.line(rows(&best))
}

fn rows(individuals: &[IndividualReply]) -> String {
    let columns = [
        Column::Right("individual"),
        Column::Right("fitness"),
        Column::Left("experiment"),
        Column::Right("run"),
        Column::Right("generation"),
        Column::Right("index"),
        Column::Left("operator"),
        Column::Left("traits"),
    ];
    let row = |of: &IndividualReply| {
        vec![
            of.id.to_string(),
            number::figure_or_dash(of.fitness),
            of.experiment_name.clone(),
            of.run.to_string(),
            of.generation.to_string(),
            of.index.to_string(),
            of.operator.clone(),
            super::show::pairs(&of.traits),
        ]
    };
    table(&columns, individuals.iter().map(row))
}

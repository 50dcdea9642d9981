//! `hatchery hash`: the lineage hash (design: determinism). Equal hashes are equal lineages, bit for bit.

use proto::v1::HashRequest;

use crate::arguments::AskExperiment;
use crate::connect::{Connection, PATIENT, Source, within};
use crate::exit::Failure;
use crate::render::{Output, json, number};

pub(super) async fn hash(arguments: AskExperiment, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let request = HashRequest { experiment: arguments.experiment };
    let hashes = connection.lineage().hash(within(PATIENT, request)).await?.into_inner().hashes;
    if output.json {
        return output.document(&hashes.iter().map(json::hash).collect::<Vec<_>>());
    }
    for of in hashes {
        let so_far = if of.finished { "" } else { ", unfinished: the hash of what stands so far" };
        let individuals = number::count(of.individuals);
        output.line(format!("{}  {} ({individuals} individuals{so_far})", number::hex(&of.hash), of.name))?;
    }
    Ok(())
}

//! `hatchery amend`: goes on with a changed experiment file. What may change, the coordinator says.

use proto::v1::{AmendRequest, SubmitRequest};
use serde_json::json;

use super::read_text;
use crate::arguments::Amend;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::{Output, json};

pub(super) async fn amend(arguments: Amend, output: Output) -> Result<(), Failure> {
    let text = read_text(&arguments.file)?;
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let (profile, set) = (arguments.overrides.profile.unwrap_or_default(), arguments.overrides.set);
    let file = Some(SubmitRequest { text: text.clone(), profile, set, ..Default::default() });
    let request = within(PROMPT, AmendRequest { experiment: arguments.experiment, file });
    let reply = connection.experiments().amend(request).await;
    let reply = reply.map_err(|status| Failure::of_submission(status, arguments.file, text))?.into_inner();
    let experiment = reply.experiment.unwrap_or_default();
    if output.json {
        let experiment = json::experiment(&experiment);
        return output.document(&json!({ "differences": reply.differences, "experiment": experiment }));
    }
    output.line(format!("experiment {} {} goes on with the changed file", experiment.id, experiment.name))?;
    reply.differences.iter().try_for_each(|difference| output.line(difference))
}

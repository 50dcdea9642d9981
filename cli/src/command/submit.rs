//! `hatchery submit`: hands an experiment file to a coordinator. The coordinator reads it; this end only
//! draws what it finds wrong.

use proto::v1::{SubmitReply, SubmitRequest};
use serde_json::json;

use super::{import, read_text};
use crate::arguments::Submit;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::{Output, json, number};

pub(super) async fn submit(arguments: Submit, output: Output) -> Result<(), Failure> {
    let text = read_text(&arguments.file)?;
    let mut overrides = arguments.overrides.with_seed(arguments.seed);
    let source = Source::coordinator(&arguments.dial)?;
    if let Some(named) = &arguments.import {
        overrides.set.push(import::assignment(named, &source).await?);
    }
    let connection = Connection::open(&Source::coordinator(&arguments.dial)?).await?;
    let request = SubmitRequest {
        text: text.clone(),
        profile: overrides.profile.unwrap_or_default(),
        set: overrides.set,
        resume: arguments.resume,
    };
    let reply = connection.experiments().submit(within(PROMPT, request)).await;
    let reply = reply.map_err(|status| Failure::of_submission(status, arguments.file, text))?.into_inner();
    show(&reply, output)
}

fn show(reply: &SubmitReply, output: Output) -> Result<(), Failure> {
    if output.json {
        let experiments: Vec<_> = reply.experiments.iter().map(json::experiment).collect();
        return output.document(&json!({ "resumed": reply.resumed, "experiments": experiments }));
    }
    for experiment in &reply.experiments {
        let done = if reply.resumed {
            format!("taken up again at {} of", number::count(experiment.evaluated))
        } else {
            "submitted,".to_owned()
        };
        output.line(format!(
            "experiment {} {}: {done} {} individuals",
            experiment.id,
            experiment.name,
            number::count(experiment.planned)
        ))?;
    }
    Ok(())
}

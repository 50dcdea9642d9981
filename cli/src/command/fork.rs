//! `hatchery fork`: begins an experiment whose first stages are another's.

use proto::v1::{ForkRequest, SubmitRequest};

use super::read_text;
use crate::arguments::Fork;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::{Output, json};

pub(super) async fn fork(arguments: Fork, output: Output) -> Result<(), Failure> {
    let Fork { experiment, after, file: path, overrides, ask } = arguments;
    let text = path.as_deref().map(read_text).transpose()?;
    if text.is_none() && (overrides.profile.is_some() || !overrides.set.is_empty()) {
        return Err(Failure::Usage("--profile and --set change a FILE, and none is named".to_owned()));
    }
    let connection = Connection::open(&Source::of(&ask)?).await?;
    let (profile, set) = (overrides.profile.unwrap_or_default(), overrides.set);
    let file = text.clone().map(|text| SubmitRequest { text, profile, set, ..Default::default() });
    let request = within(PROMPT, ForkRequest { experiment, after: after.clone(), file });
    let forked = connection.experiments().fork(request).await.map_err(|status| match (path, text) {
        (Some(path), Some(text)) => Failure::of_submission(status, path, text),
        _ => status.into(),
    });
    let forked = forked?.into_inner();
    if output.json {
        return output.document(&json::experiment(&forked));
    }
    output.line(format!("experiment {} {}: goes on after stage `{after}`", forked.id, forked.name))
}

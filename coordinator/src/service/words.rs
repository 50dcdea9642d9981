//! What workers say, read into the scheduler's words, or refused by the field's name. It knows no stream.

use crate::scheduler::{AttemptId, Hello, News, Report};
use creatures::{Interim, Outcome};
use proto::convert::NOTE_SIZE_MAX;
use proto::hello::{HOLDING_MAX, LABEL_SIZE_MAX, LABELS_MAX, NAME_SIZE_MAX, SLOTS_MAX, WINDOW_MAX, is_label};
use proto::refusal::Refusal;
use proto::v1;
use tonic::Status;

/// Reads a hello to the holder of a lineage, to whom what is held for another one is void.
///
/// # Errors
/// The field that is out of bounds.
pub fn introduce(hello: v1::Hello, lineage: &[u8; 16]) -> Result<Hello, Refusal> {
    let within = |field: &str, size: usize, limit: usize| {
        let text = || format!("`{field}` has {size} bytes, the limit is {limit}");
        if size <= limit { Ok(()) } else { Err(Refusal::Hello(text())) }
    };
    let between = |field: &str, found: u32, limit: u32| {
        let text = || format!("`{field}` is {found}, must be 1 to {limit}");
        if (1..=limit).contains(&found) { Ok(()) } else { Err(Refusal::Hello(text())) }
    };
    within("name", hello.name.len(), NAME_SIZE_MAX)?;
    within("host", hello.host.len(), NAME_SIZE_MAX)?;
    if hello.name.is_empty() || hello.name.chars().chain(hello.host.chars()).any(char::is_control) {
        let text = "`name` must not be empty, and neither it nor `host` have control characters";
        return Err(Refusal::Hello(text.to_owned()));
    }
    if hello.labels.len() > LABELS_MAX || !hello.labels.iter().all(|(key, value)| is_label(key, value)) {
        return Err(Refusal::Hello(format!(
            "`labels` has more than {LABELS_MAX}, or one that is empty, over {LABEL_SIZE_MAX} bytes or has control \
             characters"
        )));
    }
    if hello.incarnation == 0 {
        return Err(Refusal::Hello("`incarnation` is 0 or missing".to_owned()));
    }
    between("slots", hello.slots, SLOTS_MAX)?;
    between("window", hello.window, WINDOW_MAX)?;
    if hello.holding.len() > HOLDING_MAX {
        let found = hello.holding.len();
        return Err(Refusal::Hello(format!("`holding` has {found} attempts, the limit is {HOLDING_MAX}")));
    }
    let holding = if hello.lineage[..] == *lineage { hello.holding } else { Vec::new() };
    Ok(Hello {
        name: hello.name,
        host: hello.host,
        incarnation: hello.incarnation,
        version: hello.version,
        slots: hello.slots,
        window: hello.window,
        holding: holding.into_iter().map(attempt).collect(),
        labels: hello.labels,
    })
}

/// Holds a list to its limit.
pub(super) fn within(field: &str, found: usize, limit: usize) -> Result<(), Status> {
    let text = || format!("`{field}` has {found} entries, the limit is {limit}");
    if found <= limit { Ok(()) } else { Err(Status::invalid_argument(text())) }
}

pub(super) fn attempt(v1::Attempt { evaluation, number }: v1::Attempt) -> AttemptId {
    AttemptId { evaluation, number }
}

/// Reads a report. An outcome that means nothing ends its attempt all the same; what names no attempt, or
/// says nothing of it, is the worker's fault as a whole.
pub fn report(report: v1::Report) -> Result<Report, Status> {
    use v1::report::What;
    let missing = |field| Status::invalid_argument(format!("`reports.{field}` is missing"));
    let attempt = attempt(report.attempt.ok_or_else(|| missing("attempt"))?);
    let news = match report.what.ok_or_else(|| missing("what"))? {
        What::Interim(interim) => {
            News::Interim(Interim::try_from(interim).map_err(|error| error.within("reports.interim"))?)
        }
        What::Outcome(outcome) => match Outcome::try_from(outcome) {
            Ok(outcome) => News::Outcome(outcome),
            Err(error) => News::Failure { reason: format!("outcome: {error}"), lasting: false },
        },
        What::Failure(v1::Failure { mut reason, r#final }) => {
            reason.truncate(reason.floor_char_boundary(NOTE_SIZE_MAX));
            News::Failure { reason, lasting: r#final }
        }
    };
    let seconds = if report.seconds.is_finite() { report.seconds.max(0.0) } else { 0.0 };
    Ok(Report { attempt, seconds, news })
}

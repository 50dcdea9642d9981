//! `hatchery watch`: follows experiments until they end. `run` follows its own the same way.

use proto::v1::{Experiment, WatchEvent, WatchRequest};
use tonic::Streaming;

use crate::arguments::Watch;
use crate::connect::{Connection, Source};
use crate::exit::Failure;
use crate::render::Output;
use crate::render::progress::Progress;
use crate::signals::Signals;

pub(super) async fn watch(arguments: Watch, output: Output) -> Result<(), Failure> {
    let mut signals = Signals::listen()?;
    let connection = Connection::open(&Source::coordinator(&arguments.dial)?).await?;
    let mut events = open(&connection, &arguments.experiment).await?;
    let mut progress = Progress::new(output);
    loop {
        tokio::select! {
            event = events.message() => match event? {
                Some(event) => match progress.show(&event) {
                    Err(failure) if failure.is_broken_pipe() => return Err(ended()),
                    shown => shown?,
                },
                None => break,
            },
            () = signals.first() => {
                progress.end();
                return Err(ended());
            }
        }
    }
    progress.end();
    verdict(progress.experiments())
}

fn ended() -> Failure {
    Failure::Interrupted("the watching ended; the experiment goes on".to_owned())
}

/// Opens the stream of what happens to an experiment, or to the cells of a matrix. It has no deadline: it
/// lasts as long as they do.
pub(super) async fn open(
    connection: &Connection,
    experiment: &str,
) -> Result<Streaming<WatchEvent>, Failure> {
    let request = WatchRequest { experiment: experiment.to_owned() };
    Ok(connection.experiments().watch(request).await?.into_inner())
}

/// Whether all that was watched came to its end, or to a pick.
pub(super) fn verdict<'a>(experiments: impl Iterator<Item = &'a Experiment>) -> Result<(), Failure> {
    let (mut unfinished, mut awaiting) = (Vec::new(), Vec::new());
    for of in experiments {
        let reason = if of.reason.is_empty() { String::new() } else { format!(": {}", of.reason) };
        match of.state.as_str() {
            "finished" => {}
            "awaiting" => awaiting.push(format!("{}{reason}", of.name)),
            "failed" | "cancelled" => unfinished.push(format!("{} was {}{reason}", of.name, of.state)),
            _ => {
                return Err(Failure::Unreachable(format!(
                    "the coordinator went away while {} was {}{reason}",
                    of.name, of.state
                )));
            }
        }
    }
    match (unfinished.is_empty(), awaiting.is_empty()) {
        (true, true) => Ok(()),
        (true, false) => Err(Failure::Awaiting(awaiting.join("; "))),
        (false, _) => Err(anyhow::anyhow!(unfinished.join("; ")).into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn states(states: &[&str]) -> Result<(), Failure> {
        let of = |state: &&str| Experiment { name: "a".into(), state: (*state).into(), ..Default::default() };
        verdict(states.iter().map(of).collect::<Vec<_>>().iter())
    }

    #[test]
    fn only_what_finished_was_a_success() {
        assert!(states(&["finished", "finished"]).is_ok());
        assert_eq!(states(&["finished", "failed"]).unwrap_err().exit() as u8, 1);
        assert_eq!(states(&["cancelled"]).unwrap_err().exit() as u8, 1);
        assert_eq!(states(&["finished", "awaiting"]).unwrap_err().exit() as u8, 5);
        assert_eq!(states(&["awaiting", "failed"]).unwrap_err().exit() as u8, 1);
    }

    #[test]
    fn a_stream_that_ends_too_early_is_a_coordinator_that_went_away() {
        assert_eq!(states(&["running"]).unwrap_err().exit() as u8, 4);
    }
}

//! Whom a command talks to: a coordinator that is dialled, or a lineage file served in this process. Either
//! way the command is a gRPC client and knows no difference. It asks nothing itself.

mod file;
mod rows;

use std::path::{Path, PathBuf};
use std::time::Duration;

use proto::MESSAGE_SIZE_MAX;
use proto::v1::experiments_client::ExperimentsClient;
use proto::v1::fleet_client::FleetClient;
use proto::v1::lineage_client::LineageClient;
use tonic::transport::{Channel, Endpoint};

pub(crate) use rows::{Cells, Rows};

use crate::arguments::{Ask, Dial};
use crate::exit::Failure;

/// Where a coordinator listens unless told otherwise.
const COORDINATOR_DEFAULT: &str = "http://127.0.0.1:7878";
/// The lineage that a command reads, in the current folder, unless told otherwise.
const DB_DEFAULT: &str = "hatchery.db";

const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);
/// For answers that a coordinator gives from memory or from an index.
pub(crate) const PROMPT: Duration = Duration::from_secs(30);
/// For answers that read a whole experiment.
pub(crate) const PATIENT: Duration = Duration::from_secs(600);

/// Whom to talk to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Source {
    /// A coordinator's URL.
    Coordinator(String),
    /// A lineage file.
    File(PathBuf),
}

impl Source {
    /// Flag over environment over default: the file in the current folder if there is one, else the
    /// coordinator on this machine.
    pub(crate) fn of(ask: &Ask) -> Source {
        Source::choose(ask, &|name| std::env::var(name).ok(), Path::new(DB_DEFAULT).exists())
    }

    fn choose(ask: &Ask, environment: &dyn Fn(&str) -> Option<String>, here: bool) -> Source {
        let set = |name| environment(name).filter(|value| !value.is_empty());
        match (&ask.coordinator, &ask.db) {
            (Some(url), _) => Source::Coordinator(url.clone()),
            (None, Some(file)) => Source::File(file.clone()),
            (None, None) => match (set("HATCHERY_COORDINATOR"), set("HATCHERY_DB")) {
                (Some(url), _) => Source::Coordinator(url),
                (None, Some(file)) => Source::File(file.into()),
                (None, None) if here => Source::File(DB_DEFAULT.into()),
                (None, None) => Source::Coordinator(COORDINATOR_DEFAULT.to_owned()),
            },
        }
    }

    /// The coordinator of a command that a file cannot answer.
    pub(crate) fn coordinator(dial: &Dial) -> Source {
        Source::choose(
            &Ask { coordinator: dial.coordinator.clone(), db: None },
            &|name| std::env::var(name).ok().filter(|_| name == "HATCHERY_COORDINATOR"),
            false,
        )
    }
}

/// An open connection.
#[derive(Debug, Clone)]
pub(crate) struct Connection {
    channel: Channel,
}

impl Connection {
    /// Dials the coordinator, or opens the file for reading.
    ///
    /// # Errors
    /// A URL that is none, a coordinator that does not answer, a file that is not there or no lineage.
    pub(crate) async fn open(source: &Source) -> Result<Connection, Failure> {
        let channel = match source {
            Source::Coordinator(url) => dial(url).await?,
            Source::File(path) => file::serve(path).await?,
        };
        Ok(Connection { channel })
    }

    /// The client of the `Experiments` service.
    pub(crate) fn experiments(&self) -> ExperimentsClient<Channel> {
        ExperimentsClient::new(self.channel.clone())
            .max_decoding_message_size(MESSAGE_SIZE_MAX)
            .max_encoding_message_size(MESSAGE_SIZE_MAX)
    }

    /// The client of the `Lineage` service.
    pub(crate) fn lineage(&self) -> LineageClient<Channel> {
        LineageClient::new(self.channel.clone()).max_decoding_message_size(MESSAGE_SIZE_MAX)
    }

    /// The client of the `Fleet` service.
    pub(crate) fn fleet(&self) -> FleetClient<Channel> {
        FleetClient::new(self.channel.clone()).max_decoding_message_size(MESSAGE_SIZE_MAX)
    }
}

async fn dial(url: &str) -> Result<Channel, Failure> {
    let endpoint = endpoint(url)?;
    endpoint.connect().await.map_err(|error| {
        let mut text = format!("no coordinator answers at {url}");
        if let Some(cause) = innermost(&error) {
            text.push_str(&format!(" ({cause})"));
        }
        if url == COORDINATOR_DEFAULT {
            text.push_str(
                ": name one with --coordinator URL or HATCHERY_COORDINATOR, or start one with hatchery-coordinator",
            );
        }
        Failure::Unreachable(text)
    })
}

fn endpoint(url: &str) -> Result<Endpoint, Failure> {
    let wrong =
        |why: &str| Failure::Usage(format!("coordinator `{url}`: {why}, as in {COORDINATOR_DEFAULT}"));
    let whole = match url.split_once("://") {
        Some(("http", _)) => url.to_owned(),
        Some(_) => return Err(wrong("this release speaks http alone")),
        None => format!("http://{url}"),
    };
    let endpoint = Endpoint::from_shared(whole).map_err(|_| wrong("expected a URL"))?;
    if endpoint.uri().port().is_none() {
        return Err(wrong("the port is missing"));
    }
    Ok(endpoint.connect_timeout(CONNECT_TIMEOUT).tcp_nodelay(true).max_frame_size(Some(128 << 10)))
}

fn innermost(error: &dyn std::error::Error) -> Option<String> {
    let mut cause = error.source()?;
    while let Some(deeper) = cause.source() {
        cause = deeper;
    }
    Some(cause.to_string())
}

/// A request that is given up after a while, on both sides.
pub(crate) fn within<T>(deadline: Duration, message: T) -> tonic::Request<T> {
    let mut request = tonic::Request::new(message);
    request.set_timeout(deadline);
    request
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(coordinator: Option<&str>, db: Option<&str>, set: &[(&str, &str)], here: bool) -> Source {
        let ask = Ask { coordinator: coordinator.map(str::to_owned), db: db.map(PathBuf::from) };
        let environment =
            |name: &str| set.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned());
        Source::choose(&ask, &environment, here)
    }

    #[test]
    fn a_flag_goes_over_the_environment_and_that_over_the_file_that_lies_here() {
        let both = [("HATCHERY_COORDINATOR", "http://env:1"), ("HATCHERY_DB", "env.db")];
        let url = |url: &str| Source::Coordinator(url.to_owned());
        assert_eq!(chosen(Some("http://flag:1"), None, &both, true), url("http://flag:1"));
        assert_eq!(chosen(None, Some("flag.db"), &both, true), Source::File("flag.db".into()));
        assert_eq!(chosen(None, None, &both, true), url("http://env:1"));
        assert_eq!(chosen(None, None, &both[1..], true), Source::File("env.db".into()));
        assert_eq!(chosen(None, None, &[("HATCHERY_DB", "")], true), Source::File("hatchery.db".into()));
        assert_eq!(chosen(None, None, &[], false), url("http://127.0.0.1:7878"));
    }

    #[test]
    fn a_coordinator_is_a_url_with_a_port_and_http_may_be_left_out() {
        assert_eq!(endpoint("head:7878").unwrap().uri(), "http://head:7878/");
        for (url, why) in [
            ("https://head:7878", "http alone"),
            ("http://head", "port is missing"),
            ("http://he ad:1", "expected a URL"),
        ] {
            let failure = endpoint(url).unwrap_err();
            assert!(failure.to_string().contains(why), "{failure}");
            assert_eq!(failure.exit() as u8, 2);
        }
    }
}

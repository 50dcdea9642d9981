//! Whom a command talks to: a coordinator that is dialled, or a lineage file served in this process. Either
//! way the command is a gRPC client and knows no difference. It asks nothing itself.

mod file;
mod rows;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Duration;

use proto::MESSAGE_SIZE_MAX;
use proto::dial::{Address, DialError, Line};
use proto::join::{Kind, Token, TokenError};
use proto::v1::experiments_client::ExperimentsClient;
use proto::v1::fleet_client::FleetClient;
use proto::v1::lineage_client::LineageClient;

pub(crate) use rows::{Cells, Rows};

use crate::arguments::{Ask, Dial, Join};
use crate::exit::Failure;

/// Where a coordinator listens unless told otherwise.
const COORDINATOR_DEFAULT: &str = "http://127.0.0.1:7878";
/// The lineage that a command reads, in the current folder, unless told otherwise.
pub(crate) const DB_DEFAULT: &str = "hatchery.db";

const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);
/// For answers that a coordinator gives from memory or from an index.
pub(crate) const PROMPT: Duration = Duration::from_secs(30);
/// For answers that read a whole experiment.
pub(crate) const PATIENT: Duration = Duration::from_secs(600);

/// Whom to talk to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Source {
    /// A coordinator without credentials, by its URL.
    Coordinator(String),
    /// A coordinator behind TLS.
    Join(Token),
    /// A lineage file.
    File(PathBuf),
}

impl Source {
    /// Flag over environment over default: the file in the current folder if there is one, else the
    /// coordinator on this machine. In the environment a token goes over a URL, and that over a file.
    pub(crate) fn of(ask: &Ask) -> Result<Source, Failure> {
        Source::choose(ask, &|name| std::env::var(name).ok(), Path::new(DB_DEFAULT).exists())
    }

    fn choose(
        ask: &Ask,
        environment: &dyn Fn(&str) -> Option<String>,
        here: bool,
    ) -> Result<Source, Failure> {
        let set = |name| environment(name).filter(|value| !value.is_empty());
        let Join { join, join_file } = &ask.join;
        match (&ask.coordinator, join_file, join, &ask.db) {
            (Some(url), ..) => return Ok(Source::Coordinator(url.clone())),
            (_, Some(file), ..) => return joined(Token::read(file)),
            (_, _, Some(token), _) => return joined(token.parse()),
            (.., Some(file)) => return Ok(Source::File(file.clone())),
            (None, None, None, None) => {}
        }
        if let Some(token) = set("HATCHERY_JOIN") {
            return joined(token.parse());
        }
        if let Some(file) = set("HATCHERY_JOIN_FILE") {
            return joined(Token::read(file.as_ref()));
        }
        Ok(match (set("HATCHERY_COORDINATOR"), set("HATCHERY_DB")) {
            (Some(url), _) => Source::Coordinator(url),
            (None, Some(file)) => Source::File(file.into()),
            (None, None) if here => Source::File(DB_DEFAULT.into()),
            (None, None) => Source::Coordinator(COORDINATOR_DEFAULT.to_owned()),
        })
    }

    /// The coordinator of a command that a file cannot answer.
    pub(crate) fn coordinator(dial: &Dial) -> Result<Source, Failure> {
        Source::choose(
            &Ask { coordinator: dial.coordinator.clone(), join: dial.join.clone(), db: None },
            &|name| std::env::var(name).ok().filter(|_| name != "HATCHERY_DB"),
            false,
        )
    }
}

/// The coordinator of a token, which must be a client's.
fn joined(token: Result<Token, TokenError>) -> Result<Source, Failure> {
    let token = token.map_err(|error| {
        let cause = error.source().map(|cause| format!(": {cause}")).unwrap_or_default();
        Failure::Usage(format!("{error}{cause}"))
    })?;
    match token.pass.kind {
        Kind::Client => Ok(Source::Join(token)),
        Kind::Worker => Err(Failure::Usage(
            "that is a worker's join token: a client takes one of `hatchery-coordinator tokens new client`"
                .to_owned(),
        )),
    }
}

/// An open connection.
#[derive(Debug, Clone)]
pub(crate) struct Connection {
    channel: Line,
}

impl Connection {
    /// Dials the coordinator, or opens the file for reading.
    ///
    /// # Errors
    /// A URL that is none, a coordinator that does not answer, a file that is not there or no lineage.
    pub(crate) async fn open(source: &Source) -> Result<Connection, Failure> {
        let channel = match source {
            Source::Coordinator(url) => dial(address(url)?).await?,
            Source::Join(token) => dial(Address::of(token)).await?,
            Source::File(path) => file::serve(path).await?,
        };
        Ok(Connection { channel })
    }

    /// The client of the `Experiments` service.
    pub(crate) fn experiments(&self) -> ExperimentsClient<Line> {
        ExperimentsClient::new(self.channel.clone())
            .max_decoding_message_size(MESSAGE_SIZE_MAX)
            .max_encoding_message_size(MESSAGE_SIZE_MAX)
    }

    /// The client of the `Lineage` service.
    pub(crate) fn lineage(&self) -> LineageClient<Line> {
        LineageClient::new(self.channel.clone()).max_decoding_message_size(MESSAGE_SIZE_MAX)
    }

    /// The client of the `Fleet` service.
    pub(crate) fn fleet(&self) -> FleetClient<Line> {
        FleetClient::new(self.channel.clone()).max_decoding_message_size(MESSAGE_SIZE_MAX)
    }
}

async fn dial(address: Address) -> Result<Line, Failure> {
    let address = address.with(|endpoint| endpoint.connect_timeout(CONNECT_TIMEOUT));
    address.connect().await.map_err(|error| match error {
        DialError::Stranger { .. } | DialError::Plain { .. } | DialError::Tls { .. } => {
            Failure::Usage(error.to_string())
        }
        DialError::Silent { .. } => {
            let mut text = error.to_string();
            if let Some(cause) = innermost(&error) {
                text.push_str(&format!(" ({cause})"));
            }
            if text.contains(COORDINATOR_DEFAULT) {
                text.push_str(
                    ": name one with --coordinator URL, HATCHERY_COORDINATOR or HATCHERY_JOIN, or start one with \
                     hatchery-coordinator; a lineage file that is not ./hatchery.db is read with --db FILE",
                );
            }
            Failure::Unreachable(text)
        }
    })
}

/// A coordinator's address; `http://` may be left out.
fn address(url: &str) -> Result<Address, Failure> {
    let whole = if url.contains("://") { url.to_owned() } else { format!("http://{url}") };
    Address::plain(&whole).map_err(|error| Failure::Usage(format!("{error}, as in {COORDINATOR_DEFAULT}")))
}

fn innermost(error: &dyn Error) -> Option<String> {
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
    use proto::join::{KEY_SIZE, Pass, SECRET_SIZE, TokenId};

    fn chosen(coordinator: Option<&str>, db: Option<&str>, set: &[(&str, &str)], here: bool) -> Source {
        let ask = Ask {
            coordinator: coordinator.map(str::to_owned),
            db: db.map(PathBuf::from),
            join: Join::default(),
        };
        let environment =
            |name: &str| set.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned());
        Source::choose(&ask, &environment, here).unwrap()
    }

    fn token(kind: Kind) -> Token {
        let pass = Pass { kind, id: TokenId(1), secret: [1; SECRET_SIZE], authority: [4; KEY_SIZE] };
        Token { address: "head:1".to_owned(), pass }
    }

    #[test]
    fn a_token_goes_over_a_url_of_the_environment_and_under_any_flag() {
        let text = token(Kind::Client).to_string();
        let set = [("HATCHERY_JOIN", &*text), ("HATCHERY_COORDINATOR", "http://env:1")];
        assert_eq!(chosen(None, None, &set, true), Source::Join(token(Kind::Client)));
        assert_eq!(chosen(None, Some("flag.db"), &set, true), Source::File("flag.db".into()));
        let of = |join: String| {
            Source::choose(
                &Ask { join: Join { join: Some(join), join_file: None }, ..Ask::default() },
                &|_| None,
                true,
            )
        };
        assert_eq!(of(text).unwrap(), Source::Join(token(Kind::Client)));
        let failure = of(token(Kind::Worker).to_string()).unwrap_err();
        assert!(failure.to_string().contains("tokens new client") && failure.exit() as u8 == 2, "{failure}");
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
        assert_eq!(address("head:7878").unwrap().uri(), "http://head:7878/");
        for (url, why) in [
            ("https://head:7878", "a join token is needed"),
            ("http://head", "http://host:port"),
            ("http://he ad:1", "http://host:port"),
        ] {
            let failure = address(url).unwrap_err();
            assert!(failure.to_string().contains(why), "{failure}");
            assert_eq!(failure.exit() as u8, 2);
        }
    }
}

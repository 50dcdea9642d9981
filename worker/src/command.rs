//! The worker as a command: arguments, environment, logs, signals, exit codes. `hatchery-worker` and the
//! hidden subcommand of `hatchery` are both this.

use crate::config::{Config, ConfigError};
use crate::session::run;
use crate::tasks::chain;
use proto::dial::{Address, AddressError};
use proto::join::{Kind, Token, TokenError};
use std::error::Error;
use std::io::{IsTerminal, Read};
use std::path::PathBuf;
use std::process::{ExitCode, exit};
use std::time::Duration;
use std::{env, io, thread};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::mpsc;
use tracing_subscriber::EnvFilter;

/// Bad usage, as clap has it.
const USAGE: u8 = 2;
/// Interrupted by a second signal.
const INTERRUPTED: i32 = 130;

/// What the environment may say of how a worker works; where its coordinator is, is another matter.
pub const SETTINGS: [&str; 5] =
    ["HATCHERY_SLOTS", "HATCHERY_WORKER", "HATCHERY_TIME_LIMIT", "HATCHERY_IDLE_TIMEOUT", "HATCHERY_GRACE"];

/// What a worker's command line says.
#[derive(Debug, Clone, clap::Args)]
pub struct Arguments {
    /// Where a coordinator without credentials listens, on this machine or through a tunnel [env:
    /// HATCHERY_COORDINATOR]
    #[arg(long, value_name = "URL", conflicts_with_all = ["join", "join_file"])]
    pub coordinator: Option<String>,
    /// The file that holds this worker's join token, and nothing else [env: HATCHERY_JOIN_FILE]
    #[arg(long, value_name = "FILE", conflicts_with = "join")]
    pub join_file: Option<PathBuf>,
    /// The join token itself [env: HATCHERY_JOIN]; others on this machine see it in the list of processes, so rather
    /// use the file or the environment
    #[arg(long, value_name = "TOKEN")]
    pub join: Option<String>,
    /// Evaluations to run at once [default: one a core]
    #[arg(long, value_name = "N", env = "HATCHERY_SLOTS")]
    pub slots: Option<usize>,
    /// Name in the fleet [default: host and process]
    #[arg(long, env = "HATCHERY_WORKER")]
    pub name: Option<String>,
    /// Something to know it by in `hatchery workers`, as in rack=2; may be given several times
    #[arg(long = "label", value_name = "KEY=VALUE", value_parser = label)]
    pub labels: Vec<(String, String)>,
    /// Leave after so long, as in 90s, 15m, 2h or 1d: before a batch system ends it
    #[arg(long, value_name = "TIME", value_parser = stretch, env = "HATCHERY_TIME_LIMIT")]
    pub time_limit: Option<Duration>,
    /// Leave when there was nothing to evaluate for so long
    #[arg(long, value_name = "TIME", value_parser = stretch, env = "HATCHERY_IDLE_TIMEOUT")]
    pub idle_timeout: Option<Duration>,
    /// When leaving, let what runs go on for so long, and give back the rest
    #[arg(long, value_name = "TIME", value_parser = stretch, default_value = "25s", env = "HATCHERY_GRACE")]
    pub grace: Duration,
    /// End at once when standard input does: for a worker whose starter may be killed
    #[arg(long, hide = true)]
    pub leashed: bool,
}

/// What is wrong with a command line.
#[derive(Debug, thiserror::Error)]
pub enum ArgumentError {
    /// Nobody is named.
    #[error("which coordinator? give --join-file FILE, HATCHERY_JOIN, or --coordinator URL")]
    Nobody,
    /// It lets clients in, not workers.
    #[error("that is a client's join token: a worker takes one of `hatchery-coordinator tokens new worker`")]
    Client,
    /// Not a token, or its file cannot be read.
    #[error(transparent)]
    Token(#[from] TokenError),
    /// A setting is out of range.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

impl From<AddressError> for ArgumentError {
    fn from(error: AddressError) -> Self {
        ArgumentError::Config(error.into())
    }
}

impl Arguments {
    /// The settings that these arguments ask for.
    ///
    /// # Errors
    /// The argument that is wrong.
    pub fn config(&self) -> Result<Config, ArgumentError> {
        let mut config = Config::at(self.address(&|name| env::var(name).ok())?);
        config = config.with_labels(&self.labels)?;
        (config.time_limit, config.idle_timeout) = (self.time_limit, self.idle_timeout);
        config.grace = self.grace;
        if let Some(slots) = self.slots {
            config = config.with_slots(slots)?;
        }
        if let Some(name) = &self.name {
            config = config.with_name(name)?;
        }
        Ok(config)
    }

    /// The coordinator: a flag over the environment, there a token over a URL.
    fn address(&self, environment: &dyn Fn(&str) -> Option<String>) -> Result<Address, ArgumentError> {
        let set = |name| environment(name).filter(|value| !value.is_empty());
        let token = match (&self.coordinator, &self.join_file, &self.join) {
            (Some(url), ..) => return Ok(Address::plain(url)?),
            (_, Some(file), _) => Token::read(file)?,
            (_, _, Some(token)) => token.parse()?,
            _ => match (set("HATCHERY_JOIN"), set("HATCHERY_JOIN_FILE"), set("HATCHERY_COORDINATOR")) {
                (Some(token), ..) => token.parse()?,
                (_, Some(file), _) => Token::read(file.as_ref())?,
                (_, _, Some(url)) => return Ok(Address::plain(&url)?),
                _ => return Err(ArgumentError::Nobody),
            },
        };
        if token.pass.kind == Kind::Client {
            return Err(ArgumentError::Client);
        }
        Ok(Address::of(&token))
    }
}

fn label(typed: &str) -> Result<(String, String), String> {
    let (key, value) = typed.split_once('=').ok_or("expected KEY=VALUE, as in rack=2")?;
    Ok((key.trim().to_owned(), value.trim().to_owned()))
}

/// A stretch of time: a whole number, and `s`, `m`, `h` or `d`; seconds without.
fn stretch(typed: &str) -> Result<Duration, String> {
    let wrong = || format!("`{typed}` is no stretch of time, as in 90s, 15m, 2h or 1d");
    let digits = typed.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let seconds = match &typed[digits.len()..] {
        "" | "s" => 1,
        "m" => 60,
        "h" => 3600,
        "d" => 24 * 3600,
        _ => return Err(wrong()),
    };
    let number: u32 = digits.parse().map_err(|_| wrong())?;
    Ok(Duration::from_secs(u64::from(number) * seconds))
}

/// Runs a worker until it is drained or refused. SIGTERM or Ctrl-C drains it, a second one ends the process
/// at once.
pub fn execute(arguments: Arguments) -> ExitCode {
    let config = match log().and_then(|()| Ok(arguments.config()?)) {
        Ok(config) => config,
        Err(error) => {
            eprintln!("error: {}", chain(&*error));
            return ExitCode::from(USAGE);
        }
    };
    if arguments.leashed {
        thread::spawn(leash);
    }
    match serve(config) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tracing::error!("{}", chain(&*error));
            ExitCode::FAILURE
        }
    }
}

/// One thread is enough for the stream; the others are the slots'.
fn serve(config: Config) -> Result<(), Box<dyn Error>> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let mut signals = signals()?;
        let first = async move {
            signals.recv().await;
            tokio::spawn(async move {
                signals.recv().await;
                exit(INTERRUPTED);
            });
        };
        Ok(run(config, first).await?)
    })
}

/// Each SIGTERM and each Ctrl-C.
fn signals() -> io::Result<mpsc::Receiver<()>> {
    let (sender, receiver) = mpsc::channel(1);
    for kind in [SignalKind::terminate(), SignalKind::interrupt()] {
        let mut signal = signal(kind)?;
        let sender = sender.clone();
        tokio::spawn(async move { while signal.recv().await.is_some() && sender.send(()).await.is_ok() {} });
    }
    Ok(receiver)
}

/// Ends the process with its standard input. Its coordinator is gone as well, so nothing is worth a drain.
fn leash() {
    let mut input = io::stdin().lock();
    let mut buffer = [0; 64];
    while input.read(&mut buffer).is_ok_and(|count| count > 0) {}
    exit(0);
}

/// Logs to standard error, as `HATCHERY_LOG` says: for people on a terminal, a JSON object a line otherwise.
/// A process that logs already goes on as it did.
fn log() -> Result<(), Box<dyn Error>> {
    let wanted = env::var("HATCHERY_LOG").unwrap_or_default();
    let wanted = if wanted.is_empty() { "info" } else { &wanted };
    let filter = EnvFilter::try_new(wanted).map_err(|error| format!("HATCHERY_LOG `{wanted}`: {error}"))?;
    let log = tracing_subscriber::fmt().with_env_filter(filter).with_writer(io::stderr);
    let _ = if io::stderr().is_terminal() { log.try_init() } else { log.json().try_init() };
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use proto::join::{KEY_SIZE, Pass, SECRET_SIZE, TokenId};

    #[derive(Debug, Parser)]
    struct CommandLine {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn address(typed: &[&str], set: &[(&str, &str)]) -> Result<String, String> {
        let line = CommandLine::try_parse_from([&["worker"], typed].concat()).map_err(|e| e.to_string())?;
        let environment =
            |name: &str| set.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned());
        let address = line.arguments.address(&environment).map_err(|error| chain(&error))?;
        Ok(address.uri().to_string())
    }

    fn token(kind: Kind, address: &str) -> String {
        let pass = Pass { kind, id: TokenId(1), secret: [1; SECRET_SIZE], authority: [4; KEY_SIZE] };
        Token { address: address.to_owned(), pass }.to_string()
    }

    #[test]
    fn a_flag_goes_over_the_environment_and_there_a_token_over_a_url() {
        let (flag, set) = (token(Kind::Worker, "flag:1"), token(Kind::Worker, "set:1"));
        let both = [("HATCHERY_JOIN", &*set), ("HATCHERY_COORDINATOR", "http://plain:1")];
        assert_eq!(address(&["--join", &flag], &both).unwrap(), "https://flag:1/");
        assert_eq!(address(&["--coordinator", "http://flag:1"], &both).unwrap(), "http://flag:1/");
        assert_eq!(address(&[], &both).unwrap(), "https://set:1/");
        assert_eq!(address(&[], &both[1..]).unwrap(), "http://plain:1/");
        assert!(address(&[], &[("HATCHERY_JOIN", "")]).unwrap_err().contains("which coordinator?"));
        assert!(address(&["--join", &flag, "--coordinator", "http://flag:1"], &[]).is_err());
    }

    #[test]
    fn a_token_comes_from_a_file_and_must_be_a_workers() {
        let folder = env::temp_dir().join(format!("hatchery-join-{}", std::process::id()));
        std::fs::write(&folder, format!("{}\n", token(Kind::Worker, "head:1"))).unwrap();
        let path = folder.to_str().unwrap();
        assert_eq!(address(&["--join-file", path], &[]).unwrap(), "https://head:1/");
        assert_eq!(address(&[], &[("HATCHERY_JOIN_FILE", path)]).unwrap(), "https://head:1/");
        std::fs::remove_file(&folder).unwrap();
        let missing = address(&["--join-file", path], &[]).unwrap_err();
        assert!(missing.contains("cannot read the join token in") && missing.contains(path), "{missing}");
        let client = address(&["--join", &token(Kind::Client, "head:1")], &[]).unwrap_err();
        assert!(client.contains("a client's join token"), "{client}");
    }

    #[test]
    fn stretches_of_time_have_a_unit() {
        for (typed, seconds) in [("90s", 90), ("15m", 900), ("2h", 7200), ("1d", 86_400), ("7", 7)] {
            assert_eq!(stretch(typed).unwrap().as_secs(), seconds);
        }
        for typed in ["", "s", "1w", "1.5h", "-1s", "99999999999s", "é"] {
            assert!(stretch(typed).unwrap_err().contains("no stretch of time"), "{typed}");
        }
    }
}

//! What a worker is told before it starts. It reads no argument and no environment; `command` does.

use creatures::System;
use proto::dial::{Address, AddressError};
use proto::hello::{LABEL_SIZE_MAX, LABELS_MAX, NAME_SIZE_MAX, SLOTS_MAX, is_label};
use std::collections::BTreeMap;
use std::fs;
use std::hash::{BuildHasher, RandomState};
use std::num::NonZeroUsize;
use std::pin::Pin;
use std::thread::available_parallelism;
use std::time::Duration;
use tonic::transport::{self, Channel, Endpoint};

/// How long what runs may take to end once a worker is to stop: within the 30 s that Slurm and Kubernetes give.
pub const GRACE: Duration = Duration::from_secs(25);

/// Finds a system by its name.
pub type Registry = fn(&str) -> Option<&'static dyn System>;

/// Opens the connection to a coordinator.
pub type Dial = fn(Endpoint) -> Pin<Box<dyn Future<Output = Result<Channel, transport::Error>> + Send>>;

/// What evaluates in a slot.
#[derive(Debug, Clone, Copy)]
pub enum Hands {
    /// A plain thread.
    Threads,
    /// A task on the runtime, which takes as long as this says of a genotype and its seed: where time is
    /// simulated, threads would run ahead of it.
    Simulated(fn(&[u8], u64) -> Duration),
}

/// A worker's settings.
#[derive(Debug, Clone)]
pub struct Config {
    /// Where the coordinator listens, and what to show it.
    pub coordinator: Address,
    /// Unique in the fleet.
    pub name: String,
    /// The machine, for those who look at the fleet.
    pub host: String,
    /// Drawn at random when the process starts, never 0: tells whether a name that comes back is the same process.
    pub incarnation: u64,
    /// Evaluations that run at once, each on a thread of its own; 1 to [`SLOTS_MAX`].
    pub slots: usize,
    /// The systems that this worker can evaluate.
    pub systems: Registry,
    /// What it says of its physics when it joins: [`creatures::fingerprint`].
    pub fingerprint: [u8; 32],
    /// What it says of its release when it joins.
    pub version: String,
    /// What its starter says of it, for those who look at the fleet.
    pub labels: BTreeMap<String, String>,
    /// It leaves after so long.
    pub time_limit: Option<Duration>,
    /// It leaves when there was nothing to evaluate for so long.
    pub idle_timeout: Option<Duration>,
    /// A worker that leaves gives back what has not ended by then.
    pub grace: Duration,
    /// How it reaches the coordinator where the network is simulated; over TCP, and TLS, without.
    pub dial: Option<Dial>,
    /// What evaluates: threads, unless time is simulated.
    pub hands: Hands,
}

/// What is wrong with a worker's settings.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// Not the address of a coordinator.
    #[error(transparent)]
    Coordinator(#[from] AddressError),
    /// None, or too many.
    #[error("{found} slots are not within 1..={SLOTS_MAX}")]
    Slots {
        /// As given.
        found: usize,
    },
    /// Empty, or too long.
    #[error("a worker's name must have 1 to {NAME_SIZE_MAX} bytes, `{found}` has {}", found.len())]
    Name {
        /// As given.
        found: String,
    },
    /// Too many, or one that is empty, too long or holds what a terminal would obey.
    #[error(
        "label `{}`: a worker has {LABELS_MAX} labels at most, with keys and values of 1 to {LABEL_SIZE_MAX} bytes and \
         no control characters",
        found.escape_debug()
    )]
    Label {
        /// The first that is wrong.
        found: String,
    },
}

impl Config {
    /// Settings for a coordinator without credentials, with every other default.
    ///
    /// # Errors
    /// A URL that is none.
    pub fn new(coordinator: &str) -> Result<Self, ConfigError> {
        Ok(Config::at(Address::plain(coordinator)?))
    }

    /// Settings with every default: a slot a core, the name `HOST-PROCESS`, all published systems. Runs the
    /// fingerprint's evaluations.
    pub fn at(coordinator: Address) -> Self {
        let host = host();
        Config {
            coordinator,
            name: format!("{host}-{}", std::process::id()),
            host,
            incarnation: RandomState::new().hash_one(()).max(1), // random by its keys
            slots: available_parallelism().map_or(1, NonZeroUsize::get).min(SLOTS_MAX as usize),
            systems: creatures::system,
            fingerprint: creatures::fingerprint(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            labels: BTreeMap::new(),
            time_limit: None,
            idle_timeout: None,
            grace: GRACE,
            dial: None,
            hands: Hands::Threads,
        }
    }

    /// With another number of slots.
    ///
    /// # Errors
    /// Outside of 1 to [`SLOTS_MAX`].
    pub fn with_slots(self, slots: usize) -> Result<Self, ConfigError> {
        if (1..=SLOTS_MAX as usize).contains(&slots) {
            Ok(Config { slots, ..self })
        } else {
            Err(ConfigError::Slots { found: slots })
        }
    }

    /// With another name.
    ///
    /// # Errors
    /// Empty, or over [`NAME_SIZE_MAX`].
    pub fn with_name(self, name: &str) -> Result<Self, ConfigError> {
        if (1..=NAME_SIZE_MAX).contains(&name.len()) {
            Ok(Config { name: name.to_owned(), ..self })
        } else {
            Err(ConfigError::Name { found: name.to_owned() })
        }
    }

    /// With labels. A key that comes twice has its last value.
    ///
    /// # Errors
    /// More than [`LABELS_MAX`], or one that is empty, longer than [`LABEL_SIZE_MAX`] or has control characters.
    pub fn with_labels(self, labels: &[(String, String)]) -> Result<Self, ConfigError> {
        let illegal = labels.iter().find(|(key, value)| !is_label(key, value));
        match illegal.or_else(|| labels.get(LABELS_MAX)) {
            Some((key, value)) => Err(ConfigError::Label { found: format!("{key}={value}") }),
            None => Ok(Config { labels: labels.iter().cloned().collect(), ..self }),
        }
    }
}

/// This machine's name: the kernel's word where there is one, else the shell's.
fn host() -> String {
    let kernel = fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let host = kernel.or_else(|| std::env::var("HOSTNAME").ok()).unwrap_or_default();
    match host.trim() {
        "" => "worker".to_owned(),
        // Host names have 64 bytes at most where they follow the rules.
        host => host.chars().take(64).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinator_is_an_address_with_its_scheme() {
        assert!(Config::new("http://127.0.0.1:7171").is_ok());
        for url in ["", "127.0.0.1:7171", "ftp://host", "http://", "a b"] {
            let error = Config::new(url).unwrap_err().to_string();
            assert_eq!(error, format!("coordinator `{url}` is not of the form http://host:port"));
        }
    }

    #[test]
    fn labels_have_bounds() {
        let config = Config::new("http://host:1").unwrap();
        let label = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        let labelled = config.clone().with_labels(&[label("rack", "2"), label("rack", "3")]).unwrap();
        assert_eq!(labelled.labels, BTreeMap::from([label("rack", "3")]));
        for wrong in
            [label("", "2"), label("rack", ""), label("rack", "\u{1b}[2J"), label("rack", &"x".repeat(65))]
        {
            let error = config.clone().with_labels(&[label("a", "b"), wrong]).unwrap_err().to_string();
            assert!(error.contains("label `") && !error.contains('\u{1b}'), "{error}");
        }
        let many: Vec<_> = (0..17).map(|n| label(&n.to_string(), "x")).collect();
        assert!(config.clone().with_labels(&many).unwrap_err().to_string().contains("`16=x`"));
        assert!(config.with_labels(&many[1..]).is_ok());
    }

    #[test]
    fn slots_and_names_have_bounds() {
        let config = Config::new("http://host:1").unwrap();
        assert!(config.slots >= 1 && config.name.contains('-'));
        assert!(
            config.clone().with_slots(0).is_err()
                && config.clone().with_slots(SLOTS_MAX as usize + 1).is_err()
        );
        assert_eq!(config.clone().with_slots(3).unwrap().slots, 3);
        assert!(config.clone().with_name("").is_err() && config.clone().with_name(&"x".repeat(129)).is_err());
        assert_eq!(config.with_name("ada").unwrap().name, "ada");
    }

    #[test]
    fn the_fingerprint_is_the_same_every_time() {
        assert_eq!(creatures::fingerprint(), creatures::fingerprint());
        assert_eq!(Config::new("http://host:1").unwrap().fingerprint, creatures::fingerprint());
    }
}

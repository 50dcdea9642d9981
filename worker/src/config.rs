//! What a worker is told before it starts. It reads no argument and no environment; `command` does.

use creatures::System;
use std::fs;
use std::num::NonZeroUsize;
use std::pin::Pin;
use std::thread::available_parallelism;
use std::time::Duration;
use tonic::transport::{self, Channel, Endpoint};

/// The most slots that one worker may offer.
pub const SLOTS_MAX: usize = 4096;
/// The longest name of a worker, bytes.
pub const NAME_SIZE_MAX: usize = 128;

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
    /// Where the coordinator listens: `http://host:port`.
    pub coordinator: Endpoint,
    /// Unique in the fleet.
    pub name: String,
    /// The machine, for those who look at the fleet.
    pub host: String,
    /// Evaluations that run at once, each on a thread of its own; 1 to [`SLOTS_MAX`].
    pub slots: usize,
    /// The systems that this worker can evaluate.
    pub systems: Registry,
    /// What it says of its physics when it joins: [`creatures::fingerprint`].
    pub fingerprint: [u8; 32],
    /// What it says of its release when it joins.
    pub version: String,
    /// How it reaches the coordinator: over TCP, unless the network is simulated.
    pub dial: Dial,
    /// What evaluates: threads, unless time is simulated.
    pub hands: Hands,
}

/// What is wrong with a worker's settings.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// Not the address of a coordinator.
    #[error("coordinator `{url}` is not of the form http://host:port")]
    Coordinator {
        /// As given.
        url: String,
    },
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
}

impl Config {
    /// Settings with every default: a slot a core, the name `HOST-PROCESS`, all published systems. Runs the
    /// fingerprint's evaluations.
    ///
    /// # Errors
    /// An address that is none.
    pub fn new(coordinator: &str) -> Result<Self, ConfigError> {
        let host = host();
        Ok(Config {
            coordinator: endpoint(coordinator)?,
            name: format!("{host}-{}", std::process::id()),
            host,
            slots: available_parallelism().map_or(1, NonZeroUsize::get).min(SLOTS_MAX),
            systems: creatures::system,
            fingerprint: creatures::fingerprint(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            dial: |endpoint| Box::pin(async move { endpoint.connect().await }),
            hands: Hands::Threads,
        })
    }

    /// With another number of slots.
    ///
    /// # Errors
    /// Outside of 1 to [`SLOTS_MAX`].
    pub fn with_slots(self, slots: usize) -> Result<Self, ConfigError> {
        if (1..=SLOTS_MAX).contains(&slots) {
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
}

fn endpoint(url: &str) -> Result<Endpoint, ConfigError> {
    let endpoint = Endpoint::from_shared(url.to_owned()).ok();
    let endpoint = endpoint.filter(|endpoint| {
        let uri = endpoint.uri();
        uri.scheme_str() == Some("http") && uri.host().is_some_and(|host| !host.is_empty())
    });
    endpoint.ok_or_else(|| ConfigError::Coordinator { url: url.to_owned() })
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
        for url in ["", "127.0.0.1:7171", "https://host:7171", "ftp://host", "http://", "a b"] {
            let error = Config::new(url).unwrap_err().to_string();
            assert_eq!(error, format!("coordinator `{url}` is not of the form http://host:port"));
        }
    }

    #[test]
    fn slots_and_names_have_bounds() {
        let config = Config::new("http://host:1").unwrap();
        assert!(config.slots >= 1 && config.name.contains('-'));
        assert!(config.clone().with_slots(0).is_err() && config.clone().with_slots(SLOTS_MAX + 1).is_err());
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

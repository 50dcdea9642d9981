//! The worker: joins a coordinator, evaluates genotypes, reports outcomes. It keeps nothing on disk and
//! decides nothing: what to evaluate, whether a cutoff was right and what becomes of an outcome is the
//! coordinator's to say.
//!
//! ```text
//! command   arguments, signals, exit codes          config   what a worker is told before it starts
//! session   one attachment after another            slots    threads that evaluate, and their one queue
//! tasks     tasks by their hash, read once          reports  what waits to be sent, or to be confirmed
//! window    how many evaluations to ask for         backoff  how long to wait for a coordinator
//! ```
//!
//! Simulation runs on the slots' plain threads and never on the runtime, so heartbeats do not depend on it.

mod backoff;
pub mod command;
pub mod config;
mod reports;
mod session;
mod slots;
mod tasks;
mod window;

pub use config::{Config, ConfigError, Dial, Hands, Registry};
pub use session::{WorkerError, run};

//! The coordinator: holds the populations and their lineage, hands evaluations to the fleet, culls, and goes
//! on after any kill. It never steps physics.
//!
//! ```text
//! service/   parse, call, render            driver/     the order of effects: search ↔ lineage ↔ fleet
//! fleet      the task that runs ─────────►  scheduler/  who evaluates what until when: no I/O, no clock
//! lineage/   the one writer and the readers of the database
//! metrics/   what it does, as Prometheus text
//! server     puts it all together           config      what it is told when it starts
//! health     what a probe asks
//! credentials/  TLS, join tokens, and the door before the services
//! ```

pub mod config;
pub mod credentials;
pub mod driver;
pub mod fleet;
pub mod health;
pub mod lineage;
mod metrics;
pub mod scheduler;
mod server;
pub mod service;

pub use config::Config;
pub use server::{Running, StartError, start};

//! The harness: real coordinators, workers and clients as processes of their own, in a folder of their own, on
//! ports that the system chooses. It knows no test, and leaves no process behind.
//!
//! ```text
//! programs    finds and builds the binaries           process     one guarded child, its signals and its log
//! hatchery    a coordinator, its workers, a lineage   client      questions over gRPC
//! samples     small experiments                       keeper      credentials and their tokens
//! disguise    workers with something wrong with them   relay   a bad network between a worker and its coordinator
//! ```

pub mod client;
pub mod command;
pub mod disguise;
pub mod hatchery;
pub mod keeper;
pub mod local;
pub mod process;
pub mod programs;
pub mod relay;
pub mod samples;

pub use client::Client;
pub use disguise::{Disguise, work_otherwise};
pub use hatchery::Hatchery;
pub use process::Process;
pub use relay::{Relay, Way, Weather};

//! The wire: generated messages and services, the conversions between them and the domain, and how a
//! coordinator is found and dialled. It decides nothing.

pub mod convert;
pub mod dial;
pub mod hello;
pub mod join;
pub mod refusal;

pub use convert::{ConvertError, TaskHash, task_hash};
pub use refusal::Refusal;

/// The messages and services of `hatchery.v1`, as the .proto files document them.
#[allow(missing_docs, clippy::all, unreachable_pub, rustdoc::all, reason = "generated code")]
pub mod v1 {
    tonic::include_proto!("hatchery.v1");
}

/// The encoded file descriptor set, for gRPC reflection.
pub const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/hatchery.v1.bin"));

/// The protocol's number: raised when a worker and a coordinator of different releases cannot talk.
pub const PROTOCOL: u32 = 2;

/// Messages beyond this are refused before they are decoded, bytes, on both ends.
pub const MESSAGE_SIZE_MAX: usize = 64 << 20;

/// The same of what a worker sends. Little of it can be much in memory: an empty report takes 2 bytes on the wire.
pub const WORKER_MESSAGE_SIZE_MAX: usize = 4 << 20;

/// The most reports in one message.
pub const REPORTS_MAX: usize = 1024;

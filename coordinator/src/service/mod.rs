//! The gRPC services: each parses, calls and renders. None of them decides anything.

pub mod evaluation;
pub mod experiments;
pub mod fleet;
pub mod lineage;
pub mod words;

pub use evaluation::evaluation;
pub use fleet::fleet;

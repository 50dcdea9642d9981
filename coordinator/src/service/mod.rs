//! The gRPC services: each parses, calls and renders. None of them decides anything.

pub mod lineage;

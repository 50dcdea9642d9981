//! coordinator

pub mod fleet;
pub mod lineage;
pub mod scheduler;
pub mod service;

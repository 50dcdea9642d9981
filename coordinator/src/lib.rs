//! coordinator

pub mod lineage;
pub mod service;

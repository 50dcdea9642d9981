//! The brain: one central network in blocks of control, one a skill (E-33..E-36, E-45..E-55).
//!
//! Read [`node`] for what a node does, [`genotype`] for what is inherited, [`circuit`] for how it runs.

pub mod circuit;
pub mod genotype;
pub mod node;

pub use circuit::{Circuit, Forced};
pub use genotype::{Brain, Control, Instances, Node, Output, Seal, Source, Target};
pub use node::{NodeKind, TICK, clamp};

#[cfg(test)]
pub(super) mod tests;

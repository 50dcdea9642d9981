//! Flyers: double-winged creatures whose bodies and brains evolve together in the air (Shim and Kim 2003).
//! What is true of one creature is here; what needs a population is not.
//!
//! Read [`genotype`] for what is inherited.

pub mod function;
pub mod genotype;

pub use function::Function;
pub use genotype::{Effector, Genotype, Kind, Neuron, Node, Source};

//! Flyers: double-winged creatures whose bodies and brains evolve together in the air (Shim and Kim 2003).
//! What is true of one creature is here; what needs a population is not.
//!
//! Read [`genotype`] for what is inherited, [`variation`] for how it changes, [`function`] and [`brain`] for
//! what drives the wings.

pub mod brain;
pub mod function;
pub mod genotype;
pub mod variation;

pub use brain::Brain;
pub use function::Function;
pub use genotype::{Effector, Genotype, Kind, Neuron, Node, Source};

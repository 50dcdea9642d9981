//! Walkers: four fixed bodies on the ground, each driven by a gene regulatory network or by NEAT's neural
//! network (Tibermacine and Djedi). What is true of one creature is here; what needs a population is not.

pub mod body;
pub mod genotype;
pub mod grn;
pub mod neat;

pub use body::BodyKind;
pub use genotype::Genotype;

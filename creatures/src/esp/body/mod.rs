//! The body of an ESP creature: the graph that is inherited, and the parts, joints, muscles and receptors that it
//! is expressed into (E-1..E-19). It moves nothing.

pub mod expression;
pub mod genotype;
pub mod legality;
mod overlap;
pub mod phenotype;
pub mod shape;

pub use genotype::Body;
pub use legality::Illegal;
pub use phenotype::Phenotype;
pub use shape::Shape;

#[cfg(test)]
pub(super) mod tests;

//! The body of an ESP creature: the graph that is inherited, and the parts, joints, muscles and receptors that it
//! is expressed into (E-1..E-19). It moves nothing.

pub mod genotype;
pub mod phenotype;
pub mod shape;

pub use genotype::Body;
pub use phenotype::Phenotype;
pub use shape::Shape;

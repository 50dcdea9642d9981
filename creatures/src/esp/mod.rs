//! ESP creatures: bodies with muscles that learn a syllabus of skills, each encapsulated once it is learned, with
//! pandemonium among those that compete (Lessin, Fussell, Miikkulainen and Risi 2015).

pub mod body;
pub mod brain;
pub mod encapsulation;
pub mod examination;
pub mod fitness;
pub mod genotype;
pub mod key;
pub mod pandemonium;
pub mod syllabus;
pub mod trial;
pub mod variation;

pub use genotype::Genotype;

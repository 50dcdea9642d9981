//! The gene regulatory network: its genotype, its variation and its dynamics. It knows no population.

mod genotype;
mod network;
mod variation;

pub use genotype::{CONTROLLER, Genotype, Protein, REGULATORY, SCALING, TAG_MAX};
pub use network::{Network, speed};
pub use variation::Settings;

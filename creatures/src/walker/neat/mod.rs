//! NEAT's neural networks: genotype, innovation register, variation and the network itself. It knows no
//! species and no population.

mod genotype;
mod network;
mod register;
mod variation;

pub use genotype::{CONTROLLER, Genotype, LINKS_MAX, Link, NODES_MAX, WEIGHT_MAX};
pub use network::{Network, activation};
pub use register::{Register, Split};
pub use variation::Settings;

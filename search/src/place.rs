//! Places: where in an experiment something stands. Every decision of a search, every random stream and
//! the lineage hash use places; nothing uses the order in which outcomes arrive.

use creatures::random::{Stream, stream};
use serde::{Deserialize, Serialize};

/// Where an individual stands in its run. Ordered by stage, then generation, then index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Place {
    /// Which search of the run, from 0; a plain genetic algorithm has one.
    pub stage: u32,
    /// Which batch of the stage, from 1: generation 1 is the random one (walker G-24).
    pub generation: u32,
    /// Which individual of the generation, from 0.
    pub index: u32,
}

impl Place {
    /// The keyed random stream of this place for one purpose.
    pub fn stream(self, seed: u64, purpose: &str) -> Stream {
        stream(seed, [self.stage, self.generation, self.index], purpose)
    }
}

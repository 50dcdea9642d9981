//! The fishes' world: a tank with currents, light, warmth, obstacles and things to eat, and the fishes in it,
//! all of which move on from one state of the whole (A-46..A-51).
//!
//! Read [`obstacle`] and [`tank`] for what stands still, [`current`] and [`climate`] for the water, [`particle`]
//! for food, [`grid`] for who is near whom, [`inhabitant`] for one fish, [`aquarium`] for a step of all,
//! [`task`] for what is evaluated.

pub mod aquarium;
pub mod climate;
pub mod current;
pub mod environment;
pub mod grid;
pub mod inhabitant;
pub mod obstacle;
pub mod particle;
mod scene;
pub mod suction;
pub mod tank;
pub mod task;
mod trial;

pub use aquarium::{Aquarium, Event, Lost};
pub use climate::Climate;
pub use current::{Current, Currents};
pub use environment::Environment;
pub use grid::Grid;
pub use inhabitant::{Deeds, Inhabitant};
pub use obstacle::{Contact, Obstacle};
pub use particle::{Particle, Stuff};
pub use tank::Tank;
pub use task::WorldTask;

use std::fmt;

/// A fish of a world: its place in the order of fishes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct FishId(pub u32);

/// A particle of a world: its place in the order of particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ParticleId(pub u32);

impl FishId {
    /// Where it stands in lists of all fishes.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl ParticleId {
    /// Where it stands in lists of all particles.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl fmt::Display for FishId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "fish {}", self.0)
    }
}

//! Artificial fishes: spring bodies in water that learn to swim (Terzopoulos, Tu and Grzeszczuk 1994).
//!
//! Read [`body`] and [`lattice`] for what a fish is made of, [`mechanics`], [`skyline`] and [`hydrodynamics`]
//! for how it moves, [`motor`], [`turn`] and [`fins`] for what drives it, [`swimmer`] for one fish
//! in water, [`chase`] for what makes it get somewhere.

pub mod body;
pub mod chase;
pub mod fins;
pub mod hydrodynamics;
pub mod lattice;
pub mod mechanics;
pub mod motor;
pub mod posture;
pub mod skyline;
pub mod swimmer;
pub mod turn;

pub use body::Body;
pub use chase::Chase;
pub use hydrodynamics::{Still, Water};
pub use motor::{Actuation, Command, Motor, Turn};
pub use posture::Posture;
pub use swimmer::Swimmer;

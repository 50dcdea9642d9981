//! Artificial fishes: spring bodies in water that learn to swim (Terzopoulos, Tu and Grzeszczuk 1994).
//!
//! Read [`body`] and [`lattice`] for what a fish is made of, [`mechanics`], [`skyline`] and [`hydrodynamics`]
//! for how it moves.

pub mod body;
pub mod hydrodynamics;
pub mod lattice;
pub mod mechanics;
pub mod skyline;

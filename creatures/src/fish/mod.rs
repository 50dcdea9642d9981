//! Artificial fishes: spring bodies in water that learn to swim (Terzopoulos, Tu and Grzeszczuk 1994).
//!
//! Read [`body`] and [`lattice`] for what a fish is made of, [`mechanics`], [`skyline`] and [`hydrodynamics`]
//! for how it moves, [`motor`], [`turn`] and [`fins`] for what drives it, [`swimmer`] for one fish
//! in water, [`chase`] for what makes it get somewhere.
//!
//! What it learns: [`samples`] practised for an [`objective`], [`abstraction`] to a [`controller`], a
//! [`controller_set`] that steers by maps; [`genotype`] is what of these is varied.

pub mod abstraction;
pub mod body;
pub mod chase;
pub mod controller;
pub mod controller_set;
pub mod fins;
pub mod genotype;
pub mod hydrodynamics;
pub mod lattice;
pub mod mechanics;
pub mod motor;
pub mod objective;
pub mod posture;
pub mod samples;
pub mod skyline;
pub mod swimmer;
pub mod turn;

pub use abstraction::abstracted;
pub use body::Body;
pub use chase::Chase;
pub use controller::Controller;
pub use controller_set::{Calibrated, ControllerSet};
pub use genotype::Genotype;
pub use hydrodynamics::{Still, Water};
pub use motor::{Actuation, Command, Motor, Turn};
pub use objective::{Criterion, Objective};
pub use posture::Posture;
pub use samples::{Encoding, Interpolation, Samples};
pub use swimmer::Swimmer;

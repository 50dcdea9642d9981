//! Articulated bodies: trees of rigid bodies with hinges, balls, sliders and fixed joints, bounded motors,
//! stops, external wrenches and compliant ground contact, stepped exactly in O(n). It has no closed loops,
//! no contact between bodies, no clock and no randomness; a step allocates nothing.
//!
//! Positions are maximal coordinates; the state that moves is *momentum*. A step is first-order and
//! semi-implicit: momenta take up gravity and pushes, the joints, motors, stops and contacts act on the
//! velocities at the step's end (`rounds`, `tree`, `contact`), and the new velocities carry the poses. The
//! equations, and why they are these, are in `docs/engine.md`.

mod contact;
mod dashboard;
mod joint;
mod model;
mod rounds;
mod spatial;
mod staircase;
mod tree;
mod world;

#[cfg(test)]
mod tests;

pub use contact::Ground;
pub use model::{
    Body, BodyId, Joint, JointId, JointKind, ModelBuilder, ModelError, Settings, Shape, StopRule,
};
pub use staircase::Motor;
pub use world::{StepFault, World};

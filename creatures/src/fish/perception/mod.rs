//! What a fish perceives (A-52..A-59, A-65): taken from the state of the world, held to what an eye could see.
//! Nothing here decides what to do about it.
//!
//! Read [`figure`] for how a fish looks to others, [`scene`] for all there is to see, [`vision`] for what is
//! seen of it, [`hazard`] for what may be run into, [`focus`] for what is attended to.

pub mod brightness;
pub mod capsule;
pub mod figure;
pub mod focus;
pub mod hazard;
pub mod preferences;
pub mod scene;
pub mod vision;

pub use figure::{Figure, Percept};
pub use hazard::{Hazard, Surface};
pub use preferences::Preferences;
pub use scene::{Horizon, Room, Scene, Senses};

#[cfg(test)]
pub(super) mod tests;

//! Bodies that collide: rigid parts joined by joints without motors, in contact with each other and with level
//! ground, seen and touched. A thin face on rapier3d; it knows nothing of creatures, and hands out no type of
//! the engine. Lengths are in metres, frames have z up, our numbers are f64 and the engine's f32.
//!
//! Of the engine's traps it avoids: limits of angles, whose middle goes through the platform's sine (there are
//! none here); forces that persist (they are taken back after every step); a clamp on fast rotation; parts that
//! fall asleep; and a part that is no longer finite, which the engine would switch off without a word.

mod joint;
mod shape;
mod world;

#[cfg(test)]
mod tests;

pub use joint::{Joint, JointKind};
pub use shape::Shape;
pub use world::{Pose, Settings, Twist, World};

//! What goes on in a fish: what it feels, what it means to do and why, what it has been kept from (A-61..A-67).
//! How it does it is behaviour's.

pub mod feelings;
pub mod intention;
pub mod memory;

pub use feelings::{Drives, Fear};
pub use intention::{Cause, Intention, Situation, decide};
pub use memory::{Memory, Target};

use crate::random::Stream;

/// The mind of one fish, from step to step.
#[derive(Debug, Clone)]
pub struct Mind {
    /// Hunger and libido.
    pub drives: Drives,
    /// H, L and F as last felt, in [0, 1].
    pub felt: [f64; 3],
    /// What it means to do.
    pub intention: Intention,
    /// The rule that said so.
    pub cause: Cause,
    /// What it means to eat or to mate with.
    pub target: Option<Target>,
    /// What it was kept from.
    pub memory: Option<Memory>,
    /// Its coins, when hunger and libido are alike.
    pub coins: Stream,
}

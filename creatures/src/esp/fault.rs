//! Faults: what ends a trial because the physics means nothing any more (E-23). Each has its limit here, and its
//! name.

use crate::Reason;

/// The fastest that a segment may move, m/s (E-23).
pub const SPEED_MAX: f64 = 30.0;
/// How far a joint's anchors may be apart off its free axes, m (E-23).
pub const SEPARATION_MAX: f64 = 0.05;
/// How deep a segment may reach into the ground, m (E-23).
pub const SINKING_MAX: f64 = 0.2;

/// A trial's end that the creature did not earn.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{kind} at step {step} {}", if *.settled { "of the trial" } else { "of settling" })]
pub struct Fault {
    /// What is wrong.
    pub kind: FaultKind,
    /// The physics step after which it was seen, counted from 1.
    pub step: u32,
    /// Whether the trial had begun.
    pub settled: bool,
}

/// What may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FaultKind {
    /// A place or a speed is no number.
    #[error("a segment is nowhere: not finite")]
    NonFinite,
    /// Faster than [`SPEED_MAX`].
    #[error("a segment moves at {0:.1} m/s, over {SPEED_MAX}")]
    Speed(f64),
    /// Further apart than [`SEPARATION_MAX`].
    #[error("a joint is {0:.3} m apart, over {SEPARATION_MAX}")]
    Separation(f64),
    /// Deeper than [`SINKING_MAX`].
    #[error("a segment is {0:.3} m deep in the ground, over {SINKING_MAX}")]
    Sinking(f64),
    /// It does not come to rest before the trial: a fall must not score (E-20).
    #[error("a segment still moves at {0:.2} m/s when it should have settled")]
    Unsettled(f64),
    /// The energy balance does not hold: more came than the muscles gave.
    #[error("{0:.1} J came from nothing")]
    Energy(f64),
}

impl FaultKind {
    /// The reason under which an evaluation is aborted.
    pub fn reason(self) -> Reason {
        match self {
            FaultKind::NonFinite => Reason::NonFinite,
            FaultKind::Speed(_) => Reason::BlowUp,
            FaultKind::Separation(_) => Reason::JointSeparation,
            FaultKind::Sinking(_) => Reason::Sinking,
            FaultKind::Unsettled(_) => Reason::Unsettled,
            FaultKind::Energy(_) => Reason::EnergyFromNothing,
        }
    }
}

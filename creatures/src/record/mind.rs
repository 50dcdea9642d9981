//! What goes on in creatures that have a mind, and what happens to them: told beside their poses.

use serde::{Deserialize, Serialize};

/// What goes on in a creature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mind {
    /// What it means to do.
    pub intention: String,
    /// In [0, 1].
    pub hunger: f64,
    /// In [0, 1].
    pub libido: f64,
    /// In [0, 1].
    pub fear: f64,
    /// How far its courtship is.
    pub courtship: String,
}

/// Something that happened to a creature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Since the trial's start.
    pub time: f64,
    /// Its place among the scene's creatures.
    pub creature: u32,
    /// What it was.
    #[serde(flatten)]
    pub happening: Happening,
}

/// What can happen to a creature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Happening {
    /// It means to do something else from now on.
    Intention {
        /// What it meant to do until now.
        from: String,
        /// What it means to do now.
        to: String,
        /// Why.
        cause: String,
    },
    /// It ate something.
    Meal {
        /// Name of the part.
        of: String,
    },
    /// It was eaten.
    Death {
        /// By another, a place among the scene's creatures.
        by: u32,
    },
    /// It mated.
    Mating {
        /// With another, a place among the scene's creatures.
        with: u32,
    },
}

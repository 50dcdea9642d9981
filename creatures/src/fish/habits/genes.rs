//! The numbers among the habits, their bounds, and which of them are inherited together.

use super::Habits;

/// Habits that a crossover keeps together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Which water it likes.
    Comfort,
    /// How large it is, and how much it eats.
    Hunger,
    /// How soon it courts.
    Libido,
    /// What it fears.
    Fear,
    /// What it notices, and how it gets about.
    Temper,
}

impl Group {
    /// Every group, in the order of the genes.
    pub const ALL: [Group; 5] = [Group::Comfort, Group::Hunger, Group::Libido, Group::Fear, Group::Temper];
}

/// One number of the habits.
#[derive(Debug)]
pub struct Gene {
    /// As in the encoding.
    pub name: &'static str,
    /// The least and the most.
    pub bounds: [f64; 2],
    /// What it is inherited with.
    pub group: Group,
    /// Its value.
    pub read: fn(&Habits) -> f64,
    /// Sets it, whatever its bounds.
    pub write: fn(&mut Habits, f64),
}

macro_rules! gene {
    ($field:ident, $low:expr, $high:expr, $group:ident) => {
        Gene {
            name: stringify!($field),
            bounds: [$low, $high],
            group: Group::$group,
            read: |habits| habits.$field,
            write: |habits, value| habits.$field = value,
        }
    };
}

/// Below ½, which the threshold of hunger and libido does not reach.
const URGE_MAX: f64 = 0.499;

/// Every number of the habits.
pub static GENES: [Gene; 15] = [
    gene!(brightness_min, 0.0, 1.0, Comfort),
    gene!(brightness_max, 0.0, 1.0, Comfort),
    gene!(temperature_min, 0.0, 40.0, Comfort),
    gene!(temperature_max, 0.0, 40.0, Comfort),
    gene!(size, 0.5, 2.0, Hunger),
    gene!(appetite, 1.0, 20.0, Hunger),
    gene!(digestion, 0.0003, 0.01, Hunger),
    gene!(urge, 0.001, URGE_MAX, Hunger),
    gene!(ardour, 0.001, 0.02, Libido),
    gene!(fear_min, 0.1, 0.5, Fear),
    gene!(panic, 0.1, 1.0, Fear),
    gene!(sensitivity, 0.3, 2.0, Temper),
    gene!(persistence, 0.0, 200.0, Temper),
    gene!(vision, 60.0, 400.0, Temper),
    gene!(cruise, 0.2, 1.0, Temper),
];

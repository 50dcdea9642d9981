//! What a fish is like all its life: its nature, its size, what it fears, likes and wants. Habits that
//! are out of bounds are refused; what a fish feels at the moment is not here.

mod genes;
mod genotype;
pub mod variation;

pub use genes::{GENES, Gene, Group};
pub use genotype::{Genotype, VERSION};

use serde::{Deserialize, Serialize};

/// What a fish eats, and whom it flees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Nature {
    /// Eats prey and fears nobody.
    Predator,
    /// Eats particles, flees and schools.
    Prey,
    /// Eats particles and courts; nobody eats it.
    Pacifist,
}

/// Of two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sex {
    /// Chooses the near one.
    Male,
    /// Chooses the large one.
    Female,
}

/// The habits of a fish. Lengths are in length units, rates by time unit. Nature and sex are mere words until they
/// are known to be legal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Habits<N = Nature, S = Sex> {
    /// Predator, prey or pacifist.
    pub nature: N,
    /// Fishes of one number are conspecifics.
    pub species: u32,
    /// Male or female.
    pub sex: S,
    /// Whether it seeks safety in a school.
    pub schooling: bool,
    /// b₀: darker water is uncomfortable.
    pub brightness_min: f64,
    /// b₁: brighter water is uncomfortable.
    pub brightness_max: f64,
    /// T₀: colder water is uncomfortable.
    pub temperature_min: f64,
    /// T₁: warmer water is uncomfortable.
    pub temperature_max: f64,
    /// S.
    pub size: f64,
    /// α, meals that make it full.
    pub appetite: f64,
    /// p₀, the share of a meal digested by time.
    pub digestion: f64,
    /// p₁, growth of libido by time.
    pub ardour: f64,
    /// f₀: fear above it is acted on.
    pub fear_min: f64,
    /// f₁: one predator this frightening is fled from rather than schooled against.
    pub panic: f64,
    /// r: hunger or libido above it is acted on.
    pub urge: f64,
    /// Scale of the box in which it feels in danger of a collision.
    pub sensitivity: f64,
    /// p: how much nearer something else has to be to draw it from its target.
    pub persistence: f64,
    /// V_r, how far it sees.
    pub vision: f64,
    /// σ with which it wanders.
    pub cruise: f64,
}

impl Habits {
    /// The published habits of a nature.
    pub fn published(nature: Nature, sex: Sex) -> Habits {
        let predator = nature == Nature::Predator;
        Habits {
            nature,
            species: match nature {
                Nature::Predator => 0,
                Nature::Prey => 1,
                Nature::Pacifist => 2,
            },
            sex,
            schooling: nature == Nature::Prey,
            brightness_min: 0.0,
            brightness_max: 1.0,
            temperature_min: 0.0,
            temperature_max: 40.0,
            size: if predator { 1.5 } else { 1.0 },
            appetite: if predator { 3.0 } else { 5.0 },
            digestion: 0.00067,
            ardour: 0.0025,
            fear_min: 0.4,
            panic: 0.7,
            urge: 0.25,
            sensitivity: 1.0,
            persistence: 40.0,
            vision: 300.0,
            cruise: 0.5,
        }
    }

    /// L, its body length.
    pub fn length(&self) -> f64 {
        20.0 * self.size
    }

    /// Every number or pair that is out of bounds, with what is allowed; empty for legal habits (AF-5).
    pub fn violations(&self) -> Vec<String> {
        let outside = GENES.iter().filter_map(|gene| {
            let value = (gene.read)(self);
            let [least, most] = gene.bounds;
            let legal = (least..=most).contains(&value);
            (!legal).then(|| format!("`{}` {value} is not within {least} to {most}", gene.name))
        });
        let mut found: Vec<String> = outside.collect();
        if self.panic <= self.fear_min {
            found.push(format!("`panic` {} is not above `fear_min` {}", self.panic, self.fear_min));
        }
        for (what, least, most) in [
            ("brightness", self.brightness_min, self.brightness_max),
            ("temperature", self.temperature_min, self.temperature_max),
        ] {
            if least > most {
                found.push(format!("`{what}_min` {least} is above `{what}_max` {most}"));
            }
        }
        found
    }
}

#[cfg(test)]
mod tests;

//! How long a skill is evolved, in which populations, and who goes on: keys of `[search]` that every skill may
//! override (ESP E-37, E-38, E-64, E-67, E-81, E-82). It evolves nothing.

use crate::PickedBy;
use crate::settings::{GENERATIONS, check, within};
use creatures::SpecError;
use serde::{Deserialize, Serialize};

/// The most individuals of a generation, those of all populations together.
const INDIVIDUALS_MAX: u32 = 100_000;

/// The keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Regime {
    /// Independent populations of a skill, side by side; they share nothing but the creature from which they
    /// start, and the best of all of them go on (R of E-81).
    pub populations: u32,
    /// Individuals of each.
    pub population: u32,
    /// Generations of a skill, its phases of shaping included.
    pub generations: u32,
    /// The best that pass unchanged, with their outcome.
    pub elites: u32,
    /// How parents are drawn.
    pub selection: Selection,
    /// s of linear ranking: how many children the best has on average, 1 to 2.
    pub rank_pressure: f64,
    /// Ways to a child.
    pub reproduction: Reproduction,
    /// Who picks the creature that goes on.
    pub pick: PickedBy,
    /// Candidates that each population puts forward.
    pub keep_candidates: u32,
    /// t: the share of its first score that this skill may lose while later ones are learned.
    pub retest_tolerance: f64,
    /// Generations in which this skill gets used to a body that has changed.
    pub reconcile_generations: u32,
}

impl Default for Regime {
    fn default() -> Self {
        Regime {
            populations: 5,
            population: 200,
            generations: 80,
            elites: 4,
            selection: Selection::Rank,
            rank_pressure: 1.8,
            reproduction: Reproduction::default(),
            pick: PickedBy::Best,
            keep_candidates: 10,
            retest_tolerance: 0.2,
            reconcile_generations: 30,
        }
    }
}

impl Regime {
    /// Checks every key (EF-16).
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        check("populations", self.populations, 1..=1000)?;
        check("population", self.population, 2..=INDIVIDUALS_MAX / self.populations)?;
        check("generations", self.generations, GENERATIONS)?;
        if !(1..self.population).contains(&self.elites) {
            let problem =
                format!("{} is not within 1 to {}, below the population", self.elites, self.population - 1);
            return Err(SpecError::new("elites", problem));
        }
        check("rank_pressure", self.rank_pressure, 1.0..=2.0)?;
        self.reproduction.check().map_err(|error| within("reproduction", error))?;
        check("keep_candidates", self.keep_candidates, 1..=1000)?;
        check("retest_tolerance", self.retest_tolerance, 0.0..=1.0)?;
        check("reconcile_generations", self.reconcile_generations, GENERATIONS)
    }
}

/// How parents are drawn (E-37).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Selection {
    /// By linear ranking.
    Rank,
    /// In proportion to fitness.
    FitnessProportionate,
}

/// Shares of the ways to a child; they add up to 1 (E-38). Where a way is not open, mutation takes its share
/// (E-61, E-65).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Reproduction {
    /// A mutated copy of one parent.
    pub mutate: f64,
    /// Crossover of two, then mutated.
    pub crossover: f64,
    /// Grafting of the second onto the first, then mutated.
    pub graft: f64,
}

impl Default for Reproduction {
    fn default() -> Self {
        Reproduction { mutate: 0.4, crossover: 0.3, graft: 0.3 }
    }
}

impl Reproduction {
    fn check(&self) -> Result<(), SpecError> {
        for (key, share) in [("mutate", self.mutate), ("crossover", self.crossover), ("graft", self.graft)] {
            check(key, share, 0.0..=1.0)?;
        }
        let sum = self.mutate + self.crossover + self.graft;
        if (sum - 1.0).abs() > 1e-9 {
            return Err(SpecError::new("", format!("mutate, crossover and graft add up to {sum}, not to 1")));
        }
        Ok(())
    }
}

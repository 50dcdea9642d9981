//! How annealing cools, and how far its moves go. It draws nothing.

use crate::settings::{GENERATIONS, POPULATION, check, within};
use creatures::SpecError;
use creatures::fish::Encoding;
use creatures::fish::samples::{COUNT, COUNTS};
use creatures::math::pow;
use serde::{Deserialize, Serialize};

/// A number that falls geometrically from the first step to the last.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cooling {
    /// Before the first step.
    pub start: f64,
    /// At the last step.
    pub end: f64,
}

impl Default for Cooling {
    /// The temperatures of a straight swim.
    fn default() -> Self {
        Cooling { start: 0.005, end: 0.0001 }
    }
}

impl Cooling {
    /// At step k of K: `start (end/start)^(k/K)`.
    pub fn at(&self, step: u32, steps: u32) -> f64 {
        self.start * pow(self.end / self.start, f64::from(step) / f64::from(steps))
    }

    /// AF-17
    ///
    /// # Errors
    /// The key below `table` that is out of range and what is allowed.
    pub fn check(&self, table: &str) -> Result<(), SpecError> {
        let refuse = |key: &str, problem: String| Err(within(table, SpecError::new(key, problem)));
        if !(self.start > 0.0 && self.start <= 1e3) {
            return refuse("start", format!("{} is not within 0 to 1000, 0 left out", self.start));
        }
        if !(self.end > 0.0 && self.end <= self.start) {
            return refuse(
                "end",
                format!("{} is not within 0 to start = {}, 0 left out", self.end, self.start),
            );
        }
        Ok(())
    }
}

/// The keys of a `[search]` table that concern practice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Schedule {
    /// Independent chains of a lesson, C.
    pub chains: u32,
    /// Steps of a chain, K; each is a generation.
    pub steps: u32,
    /// Which muscles share a function.
    pub encoding: Encoding,
    /// Samples of a function, N.
    pub samples: u32,
    /// Samples that a step changes, with replacement.
    pub moves: u32,
    /// w_k, the standard deviation of a change.
    pub deviation: Cooling,
}

impl Default for Schedule {
    fn default() -> Self {
        Schedule {
            chains: 8,
            steps: 6840,
            encoding: Encoding::default(),
            samples: COUNT,
            moves: 3,
            deviation: Cooling { start: 0.5, end: 0.1 },
        }
    }
}

impl Schedule {
    /// AF-17
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        check("chains", self.chains, POPULATION)?;
        check("steps", self.steps, 1..=*GENERATIONS.end() - 10)?; // leaves room for what a curriculum adds
        check("samples", self.samples, COUNTS)?;
        check("moves", self.moves, 1..=1000)?;
        self.deviation.check("deviation")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T-15
    #[test]
    fn temperatures_fall_geometrically() {
        let cooling = Cooling::default();
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-8, "{found}");
        near(cooling.at(90, 6840), 0.00474914);
        near(cooling.at(3420, 6840), 0.000707107);
        near(cooling.at(0, 6840), 0.005);
        near(cooling.at(6840, 6840), 0.0001);
    }
}

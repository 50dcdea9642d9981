//! The search of the probe system: generations of random bytes, for measuring the service itself. It selects
//! nobody and learns nothing from what it is told.

use crate::checkpoint::{self, RestoreError};
use crate::registry::Plan;
use crate::settings::{GENERATIONS, POPULATION, check, write};
use crate::{Individual, Place, Record, Search};
use creatures::{Outcome, SpecError, encoding, read_spec};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Its name in experiment files.
pub const KIND: &str = "probe";

/// The `[search]` table of kind `probe`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Always [`KIND`].
    kind: String,
    /// Individuals a generation.
    pub population: u32,
    /// Generations a run.
    pub generations: u32,
    /// Bytes of a genotype.
    pub payload: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { kind: KIND.to_owned(), population: 1000, generations: 100, payload: 2048 }
    }
}

impl Settings {
    /// Reads the `[search]` table.
    ///
    /// # Errors
    /// An unknown key, a wrong type, a number out of range.
    pub fn read(table: Value) -> Result<Settings, SpecError> {
        let settings: Settings = read_spec(table)?;
        check("population", settings.population, POPULATION)?;
        check("generations", settings.generations, GENERATIONS)?;
        check("payload", settings.payload, 0..=encoding::SIZE_MAX as u32)?;
        Ok(settings)
    }
}

impl Plan for Settings {
    fn table(&self) -> Value {
        Value::Object(write(self))
    }

    fn population(&self) -> u32 {
        self.population
    }

    fn generations(&self) -> u32 {
        self.generations
    }

    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search> {
        Box::new(Probe { settings: self.clone(), seed, stage, told: 0 })
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        Ok(Box::new(Probe { settings: self.clone(), seed, stage, told: checkpoint::read(KIND, bytes)? }))
    }
}

/// The search at work: all that changes is how many generations it was told.
#[derive(Debug)]
struct Probe {
    settings: Settings,
    seed: u64,
    stage: u32,
    told: u32,
}

impl Search for Probe {
    fn ask(&mut self) -> Vec<Individual> {
        if self.told >= self.settings.generations {
            return Vec::new();
        }
        let generation = self.told + 1;
        let individual = |index| {
            let place = Place { stage: self.stage, generation, index };
            let mut genotype = vec![0; self.settings.payload as usize];
            place.stream(self.seed, "payload").fill(&mut genotype);
            Individual {
                genotype,
                parents: Vec::new(),
                operator: "random".to_owned(),
                traits: Value::Object(Default::default()),
                inherits: None,
            }
        };
        (0..self.settings.population).map(individual).collect()
    }

    fn tell(&mut self, _: &[Option<Outcome>]) -> Record {
        self.told += 1;
        Record::default()
    }

    fn checkpoint(&self) -> Vec<u8> {
        checkpoint::write(KIND, &self.told)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_asks_for_its_generations_and_ends() {
        let plan = Settings { population: 3, generations: 2, payload: 16, ..Settings::default() };
        let mut search = plan.start(1, 0);
        let first = search.ask();
        assert_eq!(first, search.ask(), "asking again changes nothing");
        assert!(first.iter().all(|individual| individual.genotype.len() == 16));
        search.tell(&vec![None; 3]);
        let mut restored = plan.restore(1, 0, &search.checkpoint()).unwrap();
        let second = search.ask();
        assert_ne!(first, second);
        assert_eq!(second, restored.ask());
        search.tell(&vec![None; 3]);
        assert!(search.ask().is_empty());
    }
}

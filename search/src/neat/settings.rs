//! The `[search]` table of kind `neat`: sizes, the keys of the species, and those of the variation. Every
//! default is the paper's or the specification's choice.

use super::Neat;
use crate::Search;
use crate::checkpoint::RestoreError;
use crate::registry::Plan;
use crate::settings::{self, GENERATIONS, POPULATION, check, read_joined, within, write_joined};
use creatures::walker::{BodyKind, neat};
use creatures::{SpecError, read_spec};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Its name in experiment files.
pub const KIND: &str = "neat";

/// Species, and who breeds in them: the keys of `[search.neat]` that concern a population.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Speciation {
    /// Genotypes nearer than this are compatible (G-33).
    pub threshold: f64,
    /// Generations without a rise of its best fitness after which a species ends (G-36).
    pub stagnation: u32,
    /// The share of a species that breeds, its best (G-37).
    pub survivors: f64,
    /// Probability that a child has two parents (G-38).
    pub mate: f64,
    /// In that case, probability that the second is another species' champion.
    pub interspecies: f64,
}

impl Default for Speciation {
    fn default() -> Self {
        Speciation { threshold: 0.26, stagnation: 15, survivors: 0.2, mate: 0.80, interspecies: 0.001 }
    }
}

/// The `[search]` table of kind `neat`.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The body for which genotypes are made: the task's.
    pub body: BodyKind,
    /// Individuals a generation.
    pub population: u32,
    /// Generations a run; generation 1 is the random one (G-24).
    pub generations: u32,
    /// Species, and who breeds in them.
    pub speciation: Speciation,
    /// How genotypes vary, and how far apart they are.
    pub variation: neat::Settings,
}

/// The table as it is written.
#[derive(Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Table {
    kind: String,
    population: u32,
    generations: u32,
    neat: Map<String, Value>,
}

impl Default for Table {
    fn default() -> Self {
        Table { kind: KIND.to_owned(), population: 80, generations: 300, neat: Map::new() }
    }
}

impl Settings {
    /// Reads the `[search]` table for a resolved walker task.
    ///
    /// # Errors
    /// An unknown key, a wrong type, a number out of range.
    pub fn read(table: Value, task: &Value) -> Result<Settings, SpecError> {
        let table: Table = read_spec(table)?;
        check("population", table.population, POPULATION)?;
        check("generations", table.generations, GENERATIONS)?;
        let (speciation, variation): (Speciation, neat::Settings) =
            read_joined(table.neat).map_err(|error| within("neat", error))?;
        let checks = || {
            check("threshold", speciation.threshold, 0.0..=1e6)?;
            check("stagnation", speciation.stagnation, 1..=u32::MAX)?;
            check("survivors", speciation.survivors, 0.0..=1.0)?;
            check("mate", speciation.mate, 0.0..=1.0)?;
            check("interspecies", speciation.interspecies, 0.0..=1.0)?;
            variation.check()
        };
        checks().map_err(|error| within("neat", error))?;
        let body = settings::walker_body(task)?;
        Ok(Settings {
            body,
            population: table.population,
            generations: table.generations,
            speciation,
            variation,
        })
    }
}

impl Plan for Settings {
    fn table(&self) -> Value {
        let table = Table {
            population: self.population,
            generations: self.generations,
            neat: write_joined(&self.speciation, &self.variation),
            ..Table::default()
        };
        Value::Object(settings::write(&table))
    }

    fn population(&self) -> u32 {
        self.population
    }

    fn generations(&self) -> u32 {
        self.generations
    }

    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search> {
        Box::new(Neat::start(self, seed, stage))
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        Ok(Box::new(Neat::restore(self, seed, stage, bytes)?))
    }
}

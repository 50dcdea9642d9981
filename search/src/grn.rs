//! The genetic algorithm of the gene regulatory networks: tournaments, an elite, one-point crossover, one
//! mutation (G-22..G-28). How a genotype varies is `creatures`' business; who breeds is decided here.

use crate::checkpoint::{RestoreError, require};
use crate::population::{Child, Population};
use crate::registry::Plan;
use crate::settings::{self, GENERATIONS, POPULATION, check, read_joined, within, write_joined};
use crate::{Individual, Place, Record, Search, selection};
use creatures::walker::{BodyKind, grn};
use creatures::{Outcome, SpecError, read_spec};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Its name in experiment files.
pub const KIND: &str = "grn";

/// Who breeds: the keys of `[search.grn]` that concern a population.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Breeding {
    /// Probability of crossover; otherwise a child begins as a copy.
    pub mate: f64,
    /// Probability that a child is mutated.
    pub mutate: f64,
    /// Draws of a tournament, with replacement.
    pub tournament: u32,
    /// The fittest that pass unchanged.
    pub elite: u32,
}

impl Default for Breeding {
    fn default() -> Self {
        Breeding { mate: 0.70, mutate: 0.80, tournament: 3, elite: 1 }
    }
}

/// The `[search]` table of kind `grn`.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The body for which genotypes are made: the task's.
    pub body: BodyKind,
    /// Individuals a generation.
    pub population: u32,
    /// Generations a run; generation 1 is the random one (G-24).
    pub generations: u32,
    /// Who breeds.
    pub breeding: Breeding,
    /// How genotypes vary.
    pub variation: grn::Settings,
}

/// The table as it is written.
#[derive(Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Table {
    kind: String,
    population: u32,
    generations: u32,
    grn: Map<String, Value>,
}

impl Default for Table {
    fn default() -> Self {
        Table { kind: KIND.to_owned(), population: 80, generations: 300, grn: Map::new() }
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
        let (breeding, variation): (Breeding, grn::Settings) =
            read_joined(table.grn).map_err(|error| within("grn", error))?;
        let checks = || {
            check("mate", breeding.mate, 0.0..=1.0)?;
            check("mutate", breeding.mutate, 0.0..=1.0)?;
            check("tournament", breeding.tournament, 1..=1000)?;
            check("elite", breeding.elite, 0..=table.population)?;
            variation.check()
        };
        checks().map_err(|error| within("grn", error))?;
        let body = settings::walker_body(task)?;
        Ok(Settings {
            body,
            population: table.population,
            generations: table.generations,
            breeding,
            variation,
        })
    }
}

impl Plan for Settings {
    fn table(&self) -> Value {
        let table = Table {
            population: self.population,
            generations: self.generations,
            grn: write_joined(&self.breeding, &self.variation),
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
        Box::new(Genetic { settings: self.clone(), seed, population: Population::new(stage) })
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        let population: Population<grn::Genotype> = Population::restore(KIND, stage, self.population, bytes)?;
        let same_body = population.members().iter().all(|member| member.genotype.body == self.body);
        require(same_body, "its population has another body")?;
        Ok(Box::new(Genetic { settings: self.clone(), seed, population }))
    }
}

/// The search at work.
#[derive(Debug)]
struct Genetic {
    settings: Settings,
    seed: u64,
    population: Population<grn::Genotype>,
}

impl Genetic {
    fn founder(&self, place: Place) -> Child<grn::Genotype> {
        let mut draws = place.stream(self.seed, "founder");
        let genotype = grn::Genotype::random(self.settings.body, &self.settings.variation, &mut draws);
        Child { genotype, parents: Vec::new(), operator: "random".to_owned() }
    }

    /// A child of one or two parents chosen by tournament (G-25).
    fn breed(&self, fitness: &[f64], place: Place) -> Child<grn::Genotype> {
        let Breeding { mate, mutate, tournament, .. } = self.settings.breeding;
        let mut select = place.stream(self.seed, "select");
        let first = selection::tournament(fitness, tournament, &mut select);
        let second = select.chance(mate).then(|| selection::tournament(fitness, tournament, &mut select));
        let mut child = match second.filter(|&second| second != first) {
            Some(second) => Child {
                genotype: grn::Genotype::crossover(
                    &self.population.members()[first].genotype,
                    &self.population.members()[second].genotype,
                    &mut place.stream(self.seed, "crossover"),
                ),
                parents: vec![
                    self.population.parent(first, "first"),
                    self.population.parent(second, "second"),
                ],
                operator: "crossover".to_owned(),
            },
            // One parent, or the same slot twice: a copy (G-26).
            None => self.population.copy(first, "copy"),
        };
        let mut mutation = place.stream(self.seed, "mutate");
        if mutation.chance(mutate) {
            let applied = child.genotype.mutate(&self.settings.variation, &mut mutation);
            child.operator = format!("{}+{applied}", child.operator);
        }
        child
    }

    /// The children of the next generation in order of index.
    fn next(&self) -> Vec<Child<grn::Genotype>> {
        let places = self.population.next_places(self.settings.population);
        if self.population.generation() == 0 {
            return places.map(|place| self.founder(place)).collect();
        }
        let fitness: Vec<f64> =
            self.population.members().iter().map(|member| member.scored.fitness).collect();
        let elites = self.settings.breeding.elite as usize;
        let ranks = selection::ranks(&fitness);
        places
            .enumerate()
            .map(|(index, place)| match ranks.get(index).filter(|_| index < elites) {
                Some(&rank) => self.population.copy(rank, "elite"),
                None => self.breed(&fitness, place),
            })
            .collect()
    }
}

impl Search for Genetic {
    fn ask(&mut self) -> Vec<Individual> {
        if self.population.generation() >= self.settings.generations {
            return Vec::new();
        }
        let children = self.next();
        self.population.ask(children)
    }

    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record {
        self.population.tell(outcomes);
        Record::default()
    }

    fn checkpoint(&self) -> Vec<u8> {
        self.population.checkpoint(KIND)
    }
}

#[cfg(test)]
mod tests;

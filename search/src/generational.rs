//! The genetic algorithm of the flyers, for any system whose genotypes can be crossed and grafted: an elite,
//! tournaments of two, three ways to a child, mutation always (flyer F-60..F-65). How a genotype varies is
//! `creatures`' business; who breeds is decided here.

use crate::checkpoint::RestoreError;
use crate::inheritance::Scored;
use crate::population::{Child, Heritable, Population};
use crate::registry::Plan;
use crate::settings::{self, GENERATIONS, POPULATION, check, within};
use crate::{Individual, Place, Record, Search};
use creatures::random::Stream;
use creatures::{Outcome, SpecError, Status, read_spec};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Map, Value, json};
use std::fmt::Debug;

mod fish;
mod flyer;
mod habits;

/// Its name in experiment files.
pub const KIND: &str = "generational";

/// How the genotypes of a system are made and varied: the value of its rates, `[search.variation]`.
pub trait Variation: Clone + Debug + Default + Serialize + DeserializeOwned + Send + Sync + 'static {
    /// What is varied.
    type Genotype: Heritable + Clone + Debug + Send;

    /// The measures whose largest value of a generation is recorded.
    const RECORDS: &'static [&'static str];

    /// Checks every rate.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    fn check(&self) -> Result<(), SpecError>;

    /// A founder.
    fn random(&self, stream: &mut Stream) -> Self::Genotype;

    /// A child that has the head of the first parent and the tail of the second, cut at the same place.
    fn crossover(
        &self,
        first: &Self::Genotype,
        second: &Self::Genotype,
        stream: &mut Stream,
    ) -> Self::Genotype;

    /// A child of the first parent with a part of the second, cut wherever it may be.
    fn graft(&self, first: &Self::Genotype, second: &Self::Genotype, stream: &mut Stream) -> Self::Genotype;

    /// Mutates, and names the mutations that came true, joined by `+`; empty if none did.
    fn mutate(&self, genotype: &mut Self::Genotype, stream: &mut Stream) -> String;
}

/// Probabilities of the three ways to a child; they add up to 1 (F-61).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Operators {
    /// A copy of the first parent.
    pub copy: f64,
    /// Crossover of two parents.
    pub crossover: f64,
    /// Grafting of the second parent onto the first.
    pub grafting: f64,
}

impl Default for Operators {
    fn default() -> Self {
        Operators { copy: 0.4, crossover: 0.3, grafting: 0.3 }
    }
}

impl Operators {
    fn check(&self) -> Result<(), SpecError> {
        for (key, share) in [("copy", self.copy), ("crossover", self.crossover), ("grafting", self.grafting)]
        {
            check(key, share, 0.0..=1.0)?;
        }
        let sum = self.copy + self.crossover + self.grafting;
        if (sum - 1.0).abs() > 1e-9 {
            return Err(SpecError::new(
                "",
                format!("copy, crossover and grafting add up to {sum}, not to 1"),
            ));
        }
        Ok(())
    }
}

/// The `[search]` table of kind `generational`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, bound = "V: Variation")]
pub struct Settings<V> {
    kind: String,
    /// Individuals a generation.
    pub population: u32,
    /// Generations a run; generation 1 is the random one.
    pub generations: u32,
    /// The share of the best that pass unchanged; one at least.
    pub elite: f64,
    /// Probability that a tournament is won by the better of its two.
    pub tournament_p: f64,
    /// Ways to a child.
    pub operators: Operators,
    /// How genotypes vary.
    pub variation: V,
}

impl<V: Variation> Default for Settings<V> {
    fn default() -> Self {
        Settings {
            kind: KIND.to_owned(),
            population: 300,
            generations: 100,
            elite: 0.2,
            tournament_p: 0.9,
            operators: Operators::default(),
            variation: V::default(),
        }
    }
}

impl<V: Variation> Settings<V> {
    /// Reads the `[search]` table.
    ///
    /// # Errors
    /// An unknown key, a wrong type, a number out of range, operators that do not add up to 1.
    pub fn read(table: Value) -> Result<Settings<V>, SpecError> {
        let settings: Settings<V> = read_spec(table)?;
        check("population", settings.population, 2..=*POPULATION.end())?;
        check("generations", settings.generations, GENERATIONS)?;
        check("elite", settings.elite, 0.0..=1.0)?;
        check("tournament_p", settings.tournament_p, 0.0..=1.0)?;
        settings.operators.check().map_err(|error| within("operators", error))?;
        settings.variation.check().map_err(|error| within("variation", error))?;
        Ok(settings)
    }

    /// How many pass unchanged (F-60).
    fn elites(&self) -> usize {
        // A share such as 0.2 is no binary fraction: a fifth of 300 is 60 and not 59.
        let elites = (self.elite * f64::from(self.population) + 1e-9) as usize;
        elites.max(1)
    }
}

impl<V: Variation> Plan for Settings<V> {
    fn table(&self) -> Value {
        Value::Object(settings::write(self))
    }

    fn population(&self) -> u32 {
        self.population
    }

    fn generations(&self) -> u32 {
        self.generations
    }

    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search> {
        Box::new(Generational { settings: self.clone(), seed, population: Population::new(stage) })
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        let population = Population::restore(KIND, stage, self.population, bytes)?;
        Ok(Box::new(Generational { settings: self.clone(), seed, population }))
    }
}

/// The search at work.
#[derive(Debug)]
struct Generational<V: Variation> {
    settings: Settings<V>,
    seed: u64,
    population: Population<V::Genotype>,
}

/// The indices of a population, the best first: those that completed before all others, whatever their
/// fitness, equals by index (F-55, F-60).
fn ranks<'a>(population: impl Iterator<Item = &'a Scored>) -> Vec<usize> {
    let scored: Vec<&Scored> = population.collect();
    let mut ranks: Vec<usize> = (0..scored.len()).collect();
    ranks.sort_by(|&a, &b| {
        let (a, b) = (scored[a], scored[b]);
        b.completed().cmp(&a.completed()).then(b.fitness.total_cmp(&a.fitness)) // stable: equals by index
    });
    ranks
}

/// Two uniform draws from `count` ranks, with replacement; the better one with the given probability (F-61).
fn tournament(count: usize, better: f64, stream: &mut Stream) -> usize {
    let (a, b) = (stream.below(count), stream.below(count));
    if stream.chance(better) { a.min(b) } else { a.max(b) }
}

impl<V: Variation> Generational<V> {
    fn founder(&self, place: Place) -> Child<V::Genotype> {
        let genotype = self.settings.variation.random(&mut place.stream(self.seed, "founder"));
        Child { genotype, parents: Vec::new(), operator: "random".to_owned() }
    }

    /// A child of the first parent, perhaps with a second one of the elite, mutated (F-61).
    fn breed(&self, ranks: &[usize], place: Place) -> Child<V::Genotype> {
        let Settings { operators, tournament_p, variation, .. } = &self.settings;
        let mut select = place.stream(self.seed, "select");
        let first = ranks[tournament(ranks.len(), *tournament_p, &mut select)];
        let way = select.unit();
        let second = ranks[select.below(self.settings.elites().min(ranks.len()))];
        let [one, other] = [first, second].map(|index| &self.population.members()[index].genotype);
        let mut mating = place.stream(self.seed, "mate");
        let (mut genotype, operator) = if way < operators.copy {
            (one.clone(), "copy")
        } else if way < operators.copy + operators.crossover {
            (variation.crossover(one, other, &mut mating), "crossover")
        } else {
            (variation.graft(one, other, &mut mating), "grafting")
        };
        let parents = match operator {
            "copy" => vec![self.population.parent(first, "only")],
            _ => vec![self.population.parent(first, "first"), self.population.parent(second, "second")],
        };
        let mutations = variation.mutate(&mut genotype, &mut place.stream(self.seed, "mutate"));
        let operator = match mutations.as_str() {
            "" => operator.to_owned(),
            mutations => format!("{operator}+{mutations}"),
        };
        Child { genotype, parents, operator }
    }

    /// The children of the next generation in order of index: the elite, the best first, and the others.
    fn next(&self) -> Vec<Child<V::Genotype>> {
        let places = self.population.next_places(self.settings.population);
        if self.population.generation() == 0 {
            return places.map(|place| self.founder(place)).collect();
        }
        let ranks = ranks(self.population.members().iter().map(|member| &member.scored));
        let elites = self.settings.elites();
        places
            .enumerate()
            .map(|(index, place)| match ranks.get(index).filter(|_| index < elites) {
                Some(&rank) => self.population.copy(rank, "elite"),
                None => self.breed(&ranks, place),
            })
            .collect()
    }
}

impl<V: Variation> Search for Generational<V> {
    fn ask(&mut self) -> Vec<Individual> {
        if self.population.generation() >= self.settings.generations {
            return Vec::new();
        }
        let children = self.next();
        self.population.ask(children)
    }

    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record {
        self.population.tell(outcomes);
        Record { species: Vec::new(), notes: notes(outcomes, V::RECORDS) }
    }

    fn checkpoint(&self) -> Vec<u8> {
        self.population.checkpoint(KIND)
    }
}

/// What a generation's row says beside what every row says (F-70): how many completed and their median
/// fitness, the largest of the named measures, and every measure of the best as `best_NAME`.
fn notes(outcomes: &[Option<Outcome>], records: &[&str]) -> Map<String, Value> {
    let valid = || outcomes.iter().flatten().filter(|outcome| outcome.status == Status::Completed);
    let mut fitness: Vec<f64> = valid().map(|outcome| outcome.fitness).collect();
    fitness.sort_by(f64::total_cmp);
    let mut notes = Map::new();
    notes.insert("valid".to_owned(), json!(fitness.len()));
    if let (Some(&low), Some(&high)) =
        (fitness.get((fitness.len().max(1) - 1) / 2), fitness.get(fitness.len() / 2))
    {
        notes.insert("median".to_owned(), json!(0.5 * (low + high)));
    }
    for &record in records {
        let values = valid().flat_map(|outcome| &outcome.measures).filter(|(name, _)| name == record);
        if let Some(largest) = values.map(|&(_, value)| value).max_by(f64::total_cmp) {
            notes.insert(format!("max_{record}"), json!(largest));
        }
    }
    // The first of equals.
    let best = valid().reduce(|best, outcome| if outcome.fitness > best.fitness { outcome } else { best });
    for (name, value) in best.iter().flat_map(|best| &best.measures) {
        notes.insert(format!("best_{name}"), json!(value));
    }
    notes
}

#[cfg(test)]
mod tests;

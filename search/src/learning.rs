//! A curriculum: practise lessons by annealing, abstract the best of each chain to controllers, race these to
//! know what they do, and send sets of them to the buoys (fishes A-41..A-44). Practice is one generation a step;
//! racing and the buoys are one each. It is one search, so that what comes of a chain leads back to its random
//! start in one lineage.

mod repertoire;

use crate::annealing::{Chains, Cooling, Schedule, Standing, State, usual_temperature};
use crate::checkpoint::{self, RestoreError, require};
use crate::registry::Plan;
use crate::settings::{self, check, read_joined, within, write_joined};
use crate::{Individual, Place, Record, Search};
use creatures::fish::controller::OSCILLATIONS_MAX;
use creatures::fish::{Controller, Criterion, FishTask};
use creatures::{Outcome, SpecError};
use repertoire::{Raced, Racer, Repertoire, swim_of};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// Its name in experiment files.
pub const KIND: &str = "learning";

/// Generations after practice: the race and the buoys.
const AFTER_PRACTICE: u32 = 2;

/// The `[search]` table of kind `learning`.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// How practice goes on; chains are those of one lesson.
    pub schedule: Schedule,
    /// What becomes of it.
    pub abstraction: Abstraction,
    /// Of each lesson its temperatures, its steps and what it teaches.
    lessons: Vec<Lesson>,
}

/// What the search has to know of a lesson.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lesson {
    temperature: Cooling,
    steps: u32,
    teaches: Teaches,
}

/// Which map a lesson's controllers go into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Teaches {
    Swim,
    Turn,
}

/// Keys beside those of the schedule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Abstraction {
    kind: String,
    /// T_k of each lesson, in their order.
    temperatures: Vec<Cooling>,
    /// M, oscillations of a controller.
    pub oscillations: u32,
    /// What the amplitudes of every swim and the bend of every turn are taken times, each a controller of its own
    ///
    pub gains: Vec<f64>,
}

impl Default for Abstraction {
    fn default() -> Self {
        Abstraction {
            kind: KIND.to_owned(),
            temperatures: Vec::new(),
            oscillations: 1,
            gains: vec![0.5, 1.0, 1.5],
        }
    }
}

impl Settings {
    /// Reads the `[search]` table for a resolved task.
    ///
    /// # Errors
    /// A task that is no curriculum with a swim and a turn, an unknown key, a wrong type, a number out of range
    /// (AF-17).
    pub fn read(table: Value, task: &Value) -> Result<Settings, SpecError> {
        let FishTask::Learning(curriculum) = FishTask::read(task.clone())? else {
            return Err(SpecError::new("kind", "`learning` needs a task with `scenario = \"learning\"`"));
        };
        let (schedule, mut abstraction): (Schedule, Abstraction) = read_joined(settings::object(table)?)?;
        schedule.check()?;
        let count = curriculum.lessons.len();
        if abstraction.temperatures.is_empty() {
            let criteria = curriculum.lessons.iter().map(|lesson| &lesson.objective.criterion);
            abstraction.temperatures = criteria.map(usual_temperature).collect();
        }
        let found = abstraction.temperatures.len();
        if found != count {
            return Err(SpecError::new(
                "temperatures",
                format!("are {found} where the task has {count} lessons"),
            ));
        }
        for (index, temperature) in abstraction.temperatures.iter().enumerate() {
            temperature.check(&format!("temperatures[{index}]"))?;
        }
        check("oscillations", abstraction.oscillations, 1..=OSCILLATIONS_MAX as u32)?;
        check("gains", abstraction.gains.len(), 1..=100)?;
        for (index, &gain) in abstraction.gains.iter().enumerate() {
            check(&index.to_string(), gain, 1e-3..=10.0).map_err(|error| within("gains", error))?;
        }
        let lessons = curriculum.lessons.iter().zip(&abstraction.temperatures);
        let lesson = |(lesson, &temperature): (&creatures::fish::task::Lesson, &Cooling)| Lesson {
            temperature,
            steps: lesson.steps,
            teaches: match lesson.objective.criterion {
                Criterion::HeadingDegrees(_) => Teaches::Turn,
                Criterion::Target(_) | Criterion::Speed(_) | Criterion::Path(_) => Teaches::Swim,
            },
        };
        let lessons: Vec<Lesson> = lessons.map(lesson).collect();
        for (teaches, what) in [(Teaches::Swim, "a swim"), (Teaches::Turn, "a turn")] {
            if !lessons.iter().any(|lesson| lesson.teaches == teaches) {
                return Err(SpecError::new("kind", format!("`learning` needs a lesson of {what}")));
            }
        }
        Ok(Settings { schedule, abstraction, lessons })
    }

    fn chains(&self, seed: u64, stage: u32) -> Chains {
        let lessons: Vec<_> = self.lessons.iter().map(|lesson| (lesson.temperature, lesson.steps)).collect();
        Chains::new(&self.schedule, &lessons, seed, stage)
    }
}

impl Plan for Settings {
    fn table(&self) -> Value {
        Value::Object(write_joined(&self.abstraction, &self.schedule))
    }

    /// Candidates of a step of practice; races and buoys are of other numbers.
    fn population(&self) -> u32 {
        self.schedule.chains.saturating_mul(self.lessons.len() as u32)
    }

    fn generations(&self) -> u32 {
        self.schedule.steps + 1 + AFTER_PRACTICE
    }

    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search> {
        let chains = self.chains(seed, stage);
        Box::new(Learning { settings: self.clone(), stage, chains, raced: None, tried: false, racing: None })
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        let written: Written = checkpoint::read(KIND, bytes)?;
        let mut chains = self.chains(seed, stage);
        chains.restore(written.practice)?;
        require(written.raced.is_none() || chains.over(), "it races before practice is over")?;
        require(!written.tried || written.raced.is_some(), "it is at the buoys before any race")?;
        let raced = written.raced.map(|raced| Repertoire::read(raced, &self.lessons)).transpose()?;
        let tried = written.tried;
        Ok(Box::new(Learning { settings: self.clone(), stage, chains, raced, tried, racing: None }))
    }
}

/// As a checkpoint has it.
#[derive(Debug, Serialize, Deserialize)]
struct Written {
    practice: Standing,
    raced: Option<Vec<Raced>>,
    tried: bool,
}

/// The search at work.
#[derive(Debug)]
struct Learning {
    settings: Settings,
    stage: u32,
    chains: Chains,
    /// What the controllers turned out to do; none before the race.
    raced: Option<Repertoire>,
    /// Whether sets have been at the buoys.
    tried: bool,
    /// Controllers asked for and not yet told.
    racing: Option<Vec<Racer>>,
}

impl Learning {
    /// The controllers of every chain's best state, at every gain, as they are raced. Every turn bends the swims
    /// of all chains of the first lesson of one: what bends one gait sharply may not bend another.
    fn racers(&self) -> Vec<Racer> {
        let Abstraction { oscillations, gains, .. } = &self.settings.abstraction;
        let (chains, lessons) = (self.settings.schedule.chains, &self.settings.lessons);
        let oscillations = *oscillations as usize;
        let first = lessons.iter().position(|lesson| lesson.teaches == Teaches::Swim);
        let first = first.expect("a curriculum has a lesson of a swim") * chains as usize;
        let straight = (0..).zip(self.chains.best().skip(first).take(chains as usize));
        let gaits: Vec<(u32, &State, Controller)> =
            straight.filter_map(|(gait, state)| Some((gait, state, swim_of(state, oscillations)?))).collect();
        let mut racers = Vec::new();
        for (index, best) in (0..).zip(self.chains.best()) {
            let (lesson, chain) = (index / chains, index % chains);
            for &gain in gains {
                match lessons[lesson as usize].teaches {
                    Teaches::Swim => racers.extend(
                        swim_of(best, oscillations)
                            .map(|swim| Racer::swim(best, &swim, [lesson, chain], gain)),
                    ),
                    Teaches::Turn => racers.extend(gaits.iter().map(|(gait, state, swim)| {
                        Racer::turn(best, oscillations, (state, swim), [lesson, chain, *gait], gain)
                    })),
                }
            }
        }
        racers
    }

    fn race_place(&self, index: u32) -> Place {
        Place { stage: self.stage, generation: self.settings.schedule.steps + 2, index }
    }

    fn tell_race(&mut self, racing: Vec<Racer>, outcomes: &[Option<Outcome>]) -> Map<String, Value> {
        assert_eq!(racing.len(), outcomes.len(), "one outcome a controller");
        let places = (0..).map(|index| self.race_place(index));
        let raced = racing.into_iter().zip(outcomes).zip(places).filter_map(|((racer, outcome), place)| {
            let turns = self.settings.lessons[racer.lesson as usize].teaches == Teaches::Turn;
            racer.measured(outcome.as_ref()?, turns, place)
        });
        let repertoire = Repertoire::new(raced.collect());
        let mut notes = Map::new();
        notes.insert("controllers".to_owned(), json!(repertoire.len()));
        self.raced = Some(repertoire);
        notes
    }
}

impl Search for Learning {
    fn ask(&mut self) -> Vec<Individual> {
        if !self.chains.over() {
            return self.chains.ask();
        }
        match &self.raced {
            None => {
                let racers = self.racers();
                let individuals = racers.iter().map(Racer::individual).collect();
                self.racing = Some(racers);
                individuals
            }
            Some(_) if self.tried => Vec::new(),
            Some(raced) => raced.sets(self.settings.schedule.chains, &self.settings.lessons),
        }
    }

    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record {
        let notes = match self.racing.take() {
            Some(racing) => self.tell_race(racing, outcomes),
            None if self.chains.over() => {
                self.tried = true;
                Map::new()
            }
            None => self.chains.tell(outcomes),
        };
        Record { species: Vec::new(), notes }
    }

    fn checkpoint(&self) -> Vec<u8> {
        let raced = self.raced.as_ref().map(Repertoire::written);
        let written = Written { practice: self.chains.standing(), raced, tried: self.tried };
        checkpoint::write(KIND, &written)
    }
}

#[cfg(test)]
mod tests;

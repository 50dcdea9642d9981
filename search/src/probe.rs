//! The search of the probe system: generations of random bytes, for measuring the service itself, in as many
//! stages as are asked for. It breeds nothing: what it is told decides only who may be picked at a stage's end.

use crate::checkpoint::{self, GenotypeBytes, RestoreError, require};
use crate::registry::Plan;
use crate::settings::{GENERATIONS, POPULATION, check, write};
use crate::{Candidate, Choice, Individual, Parent, PickError, PickedBy, Place, Record, Search, Stage};
use creatures::probe::ProbeTask;
use creatures::{Outcome, SpecError, encoding, read_spec};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Its name in experiment files.
pub const KIND: &str = "probe";
/// The most stages.
const STAGES_MAX: u32 = 1000;
/// Candidates at a stage's end, at most.
const CANDIDATES: usize = 5;
/// Bytes in which an individual differs from the picked one.
const VARIED: usize = 8;

/// The `[search]` table of kind `probe`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Always [`KIND`].
    kind: String,
    /// Individuals a generation.
    pub population: u32,
    /// Generations a stage.
    pub generations: u32,
    /// Bytes of a genotype.
    pub payload: u32,
    /// Stages a run. Individuals of later ones come from whoever was picked at the end of the one before.
    pub stages: u32,
    /// Who picks.
    pub pick: PickedBy,
    /// What each stage adds to the task's `work`, compressions.
    pub growth: u32,
    /// The stage, from 0, at whose end the search gives up; none for the end of all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fail_after: Option<u32>,
    /// The task's own `work`.
    #[serde(skip)]
    work: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            kind: KIND.to_owned(),
            population: 1000,
            generations: 100,
            payload: 2048,
            stages: 1,
            pick: PickedBy::Best,
            growth: 0,
            fail_after: None,
            work: 0,
        }
    }
}

impl Settings {
    /// Reads the `[search]` table for a resolved task.
    ///
    /// # Errors
    /// An unknown key, a wrong type, a number out of range.
    pub fn read(table: Value, task: &Value) -> Result<Settings, SpecError> {
        let settings: Settings = read_spec(table)?;
        check("population", settings.population, POPULATION)?;
        check("generations", settings.generations, GENERATIONS)?;
        check("payload", settings.payload, 0..=encoding::SIZE_MAX as u32)?;
        check("stages", settings.stages, 1..=STAGES_MAX)?;
        let work = read_spec::<ProbeTask>(task.clone())?.work;
        let last = settings.growth.checked_mul(settings.stages - 1).and_then(|more| work.checked_add(more));
        if last.is_none() {
            let problem = format!("{} is too much for {} stages", settings.growth, settings.stages);
            return Err(SpecError::new("growth", problem));
        }
        Ok(Settings { work, ..settings })
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
        self.generations.saturating_mul(self.stages)
    }

    fn start(&self, seed: u64, stage: u32) -> Box<dyn Search> {
        Box::new(Probe { settings: self.clone(), seed, first: stage, state: State::default() })
    }

    fn restore(&self, seed: u64, stage: u32, bytes: &[u8]) -> Result<Box<dyn Search>, RestoreError> {
        let state: State = checkpoint::read(KIND, bytes)?;
        state.check(self)?;
        Ok(Box::new(Probe { settings: self.clone(), seed, first: stage, state }))
    }
}

/// How far a search is.
#[derive(Debug, Default, Serialize, Deserialize)]
struct State {
    /// From 0.
    stage: u32,
    /// Generations of the stage that it was told.
    told: u32,
    /// Who was picked at the end of the stage before.
    base: Option<(Place, GenotypeBytes)>,
    /// Who may be picked now, best first: index in the last generation, fitness, steps.
    candidates: Vec<(u32, f64, u32)>,
}

impl State {
    fn check(&self, settings: &Settings) -> Result<(), RestoreError> {
        require(self.stage < settings.stages && self.told <= settings.generations, "it is beyond the end")?;
        require(self.base.is_some() == (self.stage > 0), "only a later stage comes from a picked one")?;
        let whole = |(_, genotype): &(Place, GenotypeBytes)| genotype.0.len() == settings.payload as usize;
        require(self.base.as_ref().is_none_or(whole), "the picked genotype is of another size")
    }
}

/// The search at work.
#[derive(Debug)]
struct Probe {
    settings: Settings,
    seed: u64,
    /// The number of its first stage.
    first: u32,
    state: State,
}

impl Probe {
    fn place(&self, generation: u32, index: u32) -> Place {
        Place { stage: self.first + self.state.stage, generation, index }
    }

    fn genotype(&self, place: Place) -> Vec<u8> {
        let mut drawn = place.stream(self.seed, "payload");
        match &self.state.base {
            Some((_, GenotypeBytes(base))) => {
                let mut genotype = base.clone();
                let varied = VARIED.min(genotype.len());
                drawn.fill(&mut genotype[..varied]);
                genotype
            }
            None => {
                let mut genotype = vec![0; self.settings.payload as usize];
                drawn.fill(&mut genotype);
                genotype
            }
        }
    }

    fn is_last(&self) -> bool {
        self.state.stage + 1 == self.settings.stages
    }
}

impl Search for Probe {
    fn ask(&mut self) -> Vec<Individual> {
        if self.state.told >= self.settings.generations {
            return Vec::new();
        }
        let parent = self.state.base.as_ref().map(|(place, _)| *place);
        let individual = |index| Individual {
            genotype: self.genotype(self.place(self.state.told + 1, index)),
            parents: parent.map(|place| Parent { place, role: "only".to_owned() }).into_iter().collect(),
            operator: if parent.is_some() { "vary" } else { "random" }.to_owned(),
            traits: Value::Object(Default::default()),
            inherits: None,
        };
        (0..self.settings.population).map(individual).collect()
    }

    fn stage(&self) -> Stage {
        let Settings { stages, growth, work, .. } = self.settings;
        let stage = self.state.stage;
        Stage {
            number: self.first + stage,
            name: if stages > 1 { format!("s{stage}") } else { String::new() },
            generations: Some(self.settings.generations),
            task: (growth > 0).then(|| json!(ProbeTask { work: work + growth * stage })),
        }
    }

    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record {
        self.state.told += 1;
        if self.state.told == self.settings.generations && !self.is_last() && self.failure().is_none() {
            let standing = |(index, outcome): (u32, &Option<Outcome>)| {
                outcome.as_ref().map_or((index, 0.0, 0), |of| (index, of.fitness, of.steps))
            };
            let mut all: Vec<_> = (0..).zip(outcomes).map(standing).collect();
            all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            all.truncate(CANDIDATES);
            self.state.candidates = all;
        }
        Record::default()
    }

    fn checkpoint(&self) -> Vec<u8> {
        checkpoint::write(KIND, &self.state)
    }

    fn choice(&self) -> Option<Choice> {
        let candidate = |&(index, fitness, steps): &(u32, f64, u32)| Candidate {
            place: self.place(self.settings.generations, index),
            fitness,
            notes: serde_json::Map::from_iter([("steps".to_owned(), json!(steps))]),
        };
        let candidates: Vec<_> = self.state.candidates.iter().map(candidate).collect();
        (!candidates.is_empty()).then_some(Choice { by: self.settings.pick, candidates })
    }

    fn failure(&self) -> Option<String> {
        let over = self.state.told >= self.settings.generations;
        (over && self.settings.fail_after == Some(self.state.stage))
            .then(|| format!("stage `{}`: it was to fail", self.stage().name))
    }

    fn pick(&mut self, place: Place) -> Result<(), PickError> {
        let choice = self.choice().ok_or(PickError::NotAwaited)?;
        if !choice.candidates.iter().any(|candidate| candidate.place == place) {
            return Err(PickError::NoCandidate(place));
        }
        let genotype = GenotypeBytes(self.genotype(place));
        let stage = self.state.stage + 1;
        self.state = State { stage, told: 0, base: Some((place, genotype)), candidates: Vec::new() };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use creatures::Status;

    fn outcome(fitness: f64) -> Option<Outcome> {
        let (status, note) = (Status::Completed, String::new());
        Some(Outcome { status, fitness, steps: 3, measures: vec![], interim: None, note })
    }

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
        assert!(search.ask().is_empty() && search.choice().is_none() && search.failure().is_none());
    }

    #[test]
    fn a_stage_ends_with_a_choice_and_the_next_comes_from_the_picked_one_on_a_task_of_its_own() {
        let table = json!({ "kind": KIND, "population": 7, "generations": 1, "payload": 16, "stages": 2,
            "growth": 5 });
        let plan = Settings::read(table, &json!({ "work": 2 })).unwrap();
        assert_eq!(plan.individuals(), 14);
        let mut search = plan.start(1, 0);
        let first = search.ask();
        assert_eq!(search.stage().task, Some(json!({ "work": 2 })));
        let nobody = Place { stage: 0, generation: 1, index: 0 };
        assert_eq!(search.pick(nobody), Err(PickError::NotAwaited));
        search.tell(&[0.5, 0.1, 0.9, 0.9, 0.2, 0.3, 0.0].map(outcome));
        assert!(search.ask().is_empty());
        let order: Vec<_> = search.choice().unwrap().candidates.iter().map(|c| c.place.index).collect();
        assert_eq!(order, [2, 3, 0, 5, 4], "the best first, the earlier of equals");
        let last = Place { index: 6, ..nobody };
        assert_eq!(search.pick(last), Err(PickError::NoCandidate(last)));

        let mut restored = plan.restore(1, 0, &search.checkpoint()).unwrap();
        for search in [&mut search, &mut restored] {
            search.pick(Place { index: 3, ..nobody }).unwrap();
            assert!(search.choice().is_none());
        }
        let second = search.ask();
        assert_eq!(second, restored.ask());
        let stage = search.stage();
        assert_eq!((stage.number, stage.name.as_str(), stage.task), (1, "s1", Some(json!({ "work": 7 }))));
        for individual in &second {
            assert_eq!(individual.parents[0].place, Place { index: 3, ..nobody });
            assert_eq!(individual.genotype[8..], first[3].genotype[8..]);
        }
        assert_eq!(search.pick(nobody), Err(PickError::NotAwaited));
        search.tell(&vec![None; 7]);
        assert!(search.ask().is_empty() && search.choice().is_none());
    }

    #[test]
    fn a_probe_that_is_to_fail_says_so_at_the_end_of_that_stage() {
        let plan =
            Settings { population: 1, generations: 1, stages: 2, fail_after: Some(0), ..Settings::default() };
        let mut search = plan.start(1, 0);
        search.ask();
        assert_eq!(search.failure(), None);
        search.tell(&[None]);
        assert!(search.ask().is_empty() && search.choice().is_none());
        assert_eq!(search.failure().as_deref(), Some("stage `s0`: it was to fail"));
    }
}

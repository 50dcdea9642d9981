//! The search at work: through the stages of each skill, from one picked creature to the next (ESP E-66). How a
//! stage's generations are bred is [`super::breeding`]'s business; here is in which order things happen.

use super::archive::Archive;
use super::breeding::Breeding;
use super::crowd::Crowd;
use super::learned::{self, Learned};
use super::ledger::{Counts, Ledger};
use super::settings::Settings;
use super::stage::{Part, parts};
use super::written;
use crate::checkpoint::{RestoreError, require};
use crate::{Choice, Individual, PickError, Place, Record, Search, Stage};
use creatures::esp::genotype::Genotype;
use creatures::esp::syllabus::{self, SkillId};
use creatures::{Outcome, SpecError};
use serde_json::json;
use std::sync::Arc;

/// Generations in a row without a fit child after which that is worth a warning (EF-15).
const STUCK_AFTER: u32 = 5;

/// The creature from which a stage starts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Base {
    /// All that it has learned is locked.
    pub(super) genotype: Genotype,
    /// Where it stands; none of one that was brought along.
    pub(super) place: Option<Place>,
}

/// All that the search has to know to go on.
#[derive(Debug, Default)]
pub(super) struct State {
    /// The skills that were learned, in that order.
    pub(super) learned: Vec<Learned>,
    /// The skill that is being learned; none between two of them.
    pub(super) current: Option<SkillId>,
    /// None before the first skill is learned.
    pub(super) base: Option<Base>,
    /// Which of the parts of the current skill.
    pub(super) part: usize,
    /// The number of that stage, from where the search started.
    pub(super) stage: u32,
    pub(super) crowd: Crowd,
    pub(super) archive: Archive,
    /// Whether a pick from the archive is awaited.
    pub(super) awaiting: bool,
    /// By population: generations in a row in which no child was fit.
    pub(super) stuck: Vec<u32>,
    pub(super) ledger: Ledger,
    /// Who was picked, and its rank among the candidates from 1.
    pub(super) picks: Vec<(SkillId, Place, u32)>,
    /// Why the search cannot go on.
    pub(super) failure: Option<String>,
}

/// What the current stage is.
#[derive(Debug, Clone, PartialEq)]
struct Now {
    /// The evolution of one skill.
    stage: syllabus::Stage,
    part: Part,
}

/// The search at work.
#[derive(Debug)]
pub(super) struct Learning {
    settings: Arc<Settings>,
    seed: u64,
    /// The number of the search's first stage.
    first_stage: u32,
    pub(super) state: State,
    /// The stage of the generation last asked for.
    asked: Stage,
}

impl Learning {
    pub(super) fn new(settings: Arc<Settings>, seed: u64, first_stage: u32, state: State) -> Learning {
        let mut search = Learning {
            settings,
            seed,
            first_stage,
            state,
            asked: Stage { number: first_stage, ..Stage::default() },
        };
        if let Some(Ok(stage)) = search.now().map(|now| search.named(&now)) {
            search.asked = stage;
        }
        search
    }

    /// The search at a state of it.
    ///
    /// # Errors
    /// No state that it can be in.
    pub(super) fn restore(
        settings: Arc<Settings>,
        seed: u64,
        first_stage: u32,
        state: State,
    ) -> Result<Learning, RestoreError> {
        let search = Learning::new(settings, seed, first_stage, state);
        let state = &search.state;
        let Some(now) = search.now() else {
            require(state.learned.len() == search.settings.lessons.len(), "it stands in no stage")?;
            return Ok(search);
        };
        let members = state.crowd.members.len();
        let (populations, size) = now.part.populations(&search.settings, now.stage.skill);
        require(members == 0 || members == (populations * size) as usize, "its population has another size")?;
        let late = now.part.generations(&search.settings, now.stage.skill);
        require(
            state.awaiting || state.failure.is_some() || state.crowd.generation(search.number()) < late,
            "its stage is over",
        )?;
        require(!state.awaiting || now.part == Part::Skill, "it waits for a pick where there is none")?;
        require(!state.awaiting || !state.archive.pooled().is_empty(), "it waits for a pick from nobody")?;
        let starts = matches!(now.part, Part::Phase(_) | Part::Skill) && state.learned.is_empty();
        require(state.base.is_some() || starts || search.brought(), "it has no creature to go on with")?;
        Ok(search)
    }

    /// Whether the current skill is the first, and a creature brings it along.
    fn brought(&self) -> bool {
        self.state.learned.is_empty() && !self.settings.course.import.is_none()
    }

    /// The current stage; none when all skills are learned.
    fn now(&self) -> Option<Now> {
        let learned: Vec<SkillId> = self.state.learned.iter().map(|one| one.skill).collect();
        let mut left = self.settings.stages(&learned).into_iter();
        // A skill that was added since may come before, and waits.
        let stage = match self.state.current {
            Some(current) => left.find(|stage| stage.skill == current)?,
            None => left.next()?,
        };
        let part = *parts(&self.settings, &stage, self.brought()).get(self.state.part)?;
        Some(Now { stage, part })
    }

    /// The current stage as the lineage names it.
    ///
    /// # Errors
    /// What was measured makes no legal task.
    fn named(&self, now: &Now) -> Result<Stage, SpecError> {
        let task = now.part.task(&self.settings, &now.stage, &self.state.learned);
        let system = creatures::system("esp").expect("a syllabus is of a system that there is");
        Ok(Stage {
            number: self.number(),
            name: now.part.name(&self.settings, now.stage.skill),
            generations: Some(now.part.generations(&self.settings, now.stage.skill)),
            task: Some(system.resolve(task)?),
        })
    }

    fn number(&self) -> u32 {
        self.first_stage + self.state.stage
    }

    /// Takes in what a generation cost, for the ledger and the generation's row.
    fn count(&mut self, now: &Now, size: u32, evaluated: &[bool], outcomes: &[Option<Outcome>]) -> Counts {
        let skill = now.stage.skill;
        if self.state.ledger.last().is_none_or(|(last, _)| *last != skill) {
            self.state.ledger.push((skill, Vec::new()));
        }
        let (_, populations) = self.state.ledger.last_mut().expect("it was just pushed");
        let mut total = Counts::default();
        for (population, (evaluated, outcomes)) in
            evaluated.chunks(size as usize).zip(outcomes.chunks(size as usize)).enumerate()
        {
            let mut counts = Counts::default();
            for outcome in evaluated.iter().zip(outcomes).filter(|(evaluated, _)| **evaluated) {
                if let Some(outcome) = outcome.1 {
                    counts.add(now.part, &now.stage, outcome);
                }
            }
            if populations.len() <= population {
                populations.resize_with(population + 1, Counts::default);
            }
            populations[population] += &counts;
            total += &counts;
        }
        total
    }

    /// Counts for each population in how many generations running no child was fit (EF-15).
    fn watch(&mut self, now: &Now, size: u32, evaluated: &[bool]) {
        let fresh = matches!(now.part, Part::Phase(_) | Part::Skill) && !now.stage.retests.is_empty();
        let members = &self.state.crowd.members;
        let stuck = &mut self.state.stuck;
        stuck.resize(members.len() / size as usize, 0);
        for (population, stuck) in (0..).zip(stuck.iter_mut()) {
            let mut children = Crowd::range(population, size).filter(|&index| evaluated[index]).peekable();
            let some = children.peek().is_some();
            *stuck =
                if fresh && some && children.all(|index| members[index].stopped) { *stuck + 1 } else { 0 };
        }
    }

    /// Ends a stage after its last generation.
    fn end(&mut self, now: &Now, outcomes: &[Option<Outcome>]) {
        let skill = now.stage.skill;
        match now.part {
            Part::Phase(_) => self.advance(),
            Part::Skill => self.end_skill(skill),
            Part::Reconcile(older) => {
                let best = self.state.crowd.ranks(0..self.state.crowd.members.len())[0];
                let mut genotype = self.state.crowd.members[best].genotype.clone();
                genotype.encapsulate(older);
                let hard = outcomes[best]
                    .as_ref()
                    .and_then(|outcome| learned::impact(outcome, &self.settings, older));
                if let Some(one) = self.state.learned.iter_mut().find(|one| one.skill == older) {
                    one.impact = hard.or(one.impact);
                }
                self.state.base = Some(Base { genotype, place: Some(self.state.crowd.place(best)) });
                self.state.crowd = Crowd::default();
                self.advance();
            }
            Part::Measure => self.end_measure(skill, outcomes[0].as_ref()),
        }
    }

    fn advance(&mut self) {
        self.state.part += 1;
        self.state.stage += 1;
    }

    /// A skill has had its generations: whoever goes on is picked, if the best is good enough (E-82).
    fn end_skill(&mut self, skill: SkillId) {
        let name = self.settings.name(skill);
        let best = self.state.archive.pooled().first().map(|(_, best)| best.fitness);
        self.state.failure = match (best, self.settings.lesson(skill).require) {
            (None, _) => Some(format!("stage `{name}`: no individual was fit, so that nobody can go on")),
            (Some(best), Some(least)) if best < least => {
                Some(format!("stage `{name}`: the best fitness is {best}, and {least} is required"))
            }
            _ => None,
        };
        self.state.awaiting = self.state.failure.is_none();
    }

    /// The creature that goes on was tested in all that it knows: now the skill is learned (E-66).
    fn end_measure(&mut self, skill: SkillId, outcome: Option<&Outcome>) {
        let number = self.number();
        let settings = &self.settings;
        let measured = |skill| outcome.and_then(|outcome| learned::score(outcome, settings, skill));
        let Some(baseline) = measured(skill) else {
            let name = settings.name(skill);
            self.state.failure =
                Some(format!("stage `{name}: measure`: the creature that goes on has no score"));
            return;
        };
        let new = Learned { skill, baseline, impact: None, history: Vec::new() };
        self.state.learned.push(new);
        for one in &mut self.state.learned {
            if let Some(score) = measured(one.skill) {
                one.history.push((number, score));
            }
            let hard = outcome.and_then(|outcome| learned::impact(outcome, settings, one.skill));
            one.impact = hard.or(one.impact);
        }
        if let Some(base) = &mut self.state.base {
            base.place = Some(self.state.crowd.place(0));
        } else {
            let genotype = self.state.crowd.members[0].genotype.clone();
            self.state.base = Some(Base { genotype, place: Some(self.state.crowd.place(0)) });
        }
        self.state.crowd = Crowd::default();
        self.state.archive = Archive::default();
        self.state.stuck.clear();
        self.state.current = None;
        self.state.part = 0;
        self.state.stage += 1;
    }

    /// How the populations fare, and who is stuck.
    fn notes(&self, counts: &Counts, size: u32) -> serde_json::Map<String, serde_json::Value> {
        let mut notes = counts.notes(&self.settings);
        for (number, members) in (1..).zip(self.state.crowd.members.chunks(size as usize)) {
            let fitness = members.iter().map(|member| member.scored.fitness);
            let mean = fitness.clone().sum::<f64>() / members.len() as f64;
            let best = fitness.max_by(f64::total_cmp);
            notes.insert(format!("best.{number}"), json!(best));
            notes.insert(format!("mean.{number}"), json!(mean));
        }
        for (number, generations) in (1..).zip(&self.state.stuck).filter(|(_, stuck)| **stuck >= STUCK_AFTER)
        {
            let text = format!("no child has kept its older skills for {generations} generations");
            notes.insert(format!("warning.{number}"), json!(text));
        }
        notes
    }
}

impl Search for Learning {
    fn ask(&mut self) -> Vec<Individual> {
        if self.state.awaiting || self.state.failure.is_some() {
            return Vec::new();
        }
        let Some(now) = self.now() else { return Vec::new() };
        let number = self.number();
        if self.asked.number != number || self.asked.task.is_none() {
            match self.named(&now) {
                Ok(stage) => self.asked = stage,
                Err(error) => {
                    let name = now.part.name(&self.settings, now.stage.skill);
                    self.state.failure = Some(format!("stage `{name}` has no legal task: {error}"));
                    return Vec::new();
                }
            }
        }
        let (_, size) = now.part.populations(&self.settings, now.stage.skill);
        let breeding = Breeding {
            settings: &self.settings,
            seed: self.seed,
            number,
            stage: &now.stage,
            part: now.part,
            base: self.state.base.as_ref(),
            crowd: &self.state.crowd,
        };
        let children = breeding.next();
        self.state.crowd.ask(number, size, children)
    }

    fn stage(&self) -> Stage {
        self.asked.clone()
    }

    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record {
        let now = self.now().expect("a generation is told after it was asked for");
        let skill = now.stage.skill;
        let number = self.number();
        let (_, size) = now.part.populations(&self.settings, skill);
        let evaluated = self.state.crowd.tell(number, outcomes);
        self.state.current = Some(skill);
        let counts = self.count(&now, size, &evaluated, outcomes);
        self.watch(&now, size, &evaluated);
        let notes = self.notes(&counts, size);
        if now.part == Part::Skill {
            let keep = self.settings.lesson(skill).regime.keep_candidates;
            let members = self.state.crowd.members.chunks(size as usize);
            for (population, (members, outcomes)) in members.zip(outcomes.chunks(size as usize)).enumerate() {
                let first = self.state.crowd.place(population * size as usize);
                let generation = members.iter().zip(outcomes);
                let (settings, retests) = (&self.settings, &now.stage.retests);
                self.state.archive.admit(population, keep, generation, first, settings, retests);
            }
        }
        if self.state.crowd.generation(number) >= now.part.generations(&self.settings, skill) {
            self.end(&now, outcomes);
        }
        Record { species: Vec::new(), notes }
    }

    fn checkpoint(&self) -> Vec<u8> {
        written::write(&self.settings, &self.state)
    }

    fn choice(&self) -> Option<Choice> {
        let now = self.now().filter(|_| self.state.awaiting)?;
        Some(Choice {
            by: self.settings.lesson(now.stage.skill).regime.pick,
            candidates: self.state.archive.candidates(&self.settings, &self.state.learned),
        })
    }

    fn pick(&mut self, place: Place) -> Result<(), PickError> {
        let Some(now) = self.now().filter(|_| self.state.awaiting) else { return Err(PickError::NotAwaited) };
        let pooled = self.state.archive.pooled();
        let Some(rank) = pooled.iter().position(|(_, kept)| kept.place == place) else {
            return Err(PickError::NoCandidate(place));
        };
        let mut genotype = pooled[rank].1.genotype.clone();
        genotype.encapsulate(now.stage.skill);
        self.state.picks.push((now.stage.skill, place, rank as u32 + 1));
        self.state.base = Some(Base { genotype, place: Some(place) });
        self.state.crowd = Crowd::default();
        self.state.archive = Archive::default();
        self.state.awaiting = false;
        self.advance();
        Ok(())
    }

    fn failure(&self) -> Option<String> {
        self.state.failure.clone()
    }
}

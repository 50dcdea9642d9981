//! The archive of each population: its best genotypes that differ, of all generations under the final parameters
//! (ESP E-81). Together they are the candidates of a stage. It picks nobody.

use super::crowd::Member;
use super::learned::{self, Learned};
use super::settings::Settings;
use crate::{Candidate, Place};
use creatures::Outcome;
use creatures::esp::genotype::Genotype;
use creatures::esp::syllabus::SkillId;
use serde_json::{Map, Value, json};

/// The archives of all populations.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Archive {
    /// By population.
    pub(super) populations: Vec<Vec<Kept>>,
}

/// One that may be picked.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kept {
    pub(super) genotype: Genotype,
    /// Where it was first.
    pub(super) place: Place,
    pub(super) fitness: f64,
    /// The score of each trial.
    pub(super) trials: Vec<f64>,
    /// The scores of older skills that were tested again.
    pub(super) retests: Vec<(SkillId, f64)>,
}

impl Archive {
    /// Takes in a generation of a population, in order of index; the unfit are left out. `first` is the place of
    /// its first member, `retests` the skills that were tested again.
    pub(super) fn admit<'a>(
        &mut self,
        population: usize,
        size: u32,
        generation: impl Iterator<Item = (&'a Member, &'a Option<Outcome>)>,
        first: Place,
        settings: &Settings,
        retests: &[SkillId],
    ) {
        if self.populations.len() <= population {
            self.populations.resize_with(population + 1, Vec::new);
        }
        let kept = &mut self.populations[population];
        for (offset, (member, outcome)) in (0..).zip(generation) {
            let Some(outcome) = outcome.as_ref().filter(|_| member.fit()) else { continue };
            let fitness = member.scored.fitness;
            // After its equals: those were first.
            let at = kept.partition_point(|other| other.fitness >= fitness);
            if at >= size as usize || kept.iter().any(|other| other.genotype == member.genotype) {
                continue;
            }
            let score = |&skill: &SkillId| Some((skill, learned::score(outcome, settings, skill)?));
            let one = Kept {
                genotype: member.genotype.clone(),
                place: Place { index: first.index + offset, ..first },
                fitness,
                trials: learned::trials(outcome),
                retests: retests.iter().filter_map(score).collect(),
            };
            kept.insert(at, one);
            kept.truncate(size as usize);
        }
    }

    /// All that are kept with the number of their population from 1, the best first, equals by place.
    pub(super) fn pooled(&self) -> Vec<(u32, &Kept)> {
        let numbered = (1..).zip(&self.populations);
        let mut all: Vec<(u32, &Kept)> =
            numbered.flat_map(|(number, kept)| kept.iter().map(move |one| (number, one))).collect();
        all.sort_by(|(_, a), (_, b)| b.fitness.total_cmp(&a.fitness).then(a.place.cmp(&b.place)));
        all
    }

    /// What a person picks from (E-82).
    pub(super) fn candidates(&self, settings: &Settings, learned: &[Learned]) -> Vec<Candidate> {
        let candidate = |(population, kept): (u32, &Kept)| Candidate {
            place: kept.place,
            fitness: kept.fitness,
            notes: kept.notes(population, settings, learned),
        };
        self.pooled().into_iter().map(candidate).collect()
    }
}

impl Kept {
    fn notes(&self, population: u32, settings: &Settings, learned: &[Learned]) -> Map<String, Value> {
        let mut notes = Map::new();
        notes.insert("population".to_owned(), json!(population));
        for (index, trial) in self.trials.iter().enumerate() {
            notes.insert(format!("trial.{index}"), json!(trial));
        }
        for &(skill, score) in &self.retests {
            let name = settings.name(skill);
            notes.insert(format!("score.{name}"), json!(score));
            let baseline = learned.iter().find(|one| one.skill == skill).map(|one| one.baseline);
            notes.insert(format!("baseline.{name}"), json!(baseline));
        }
        if let Value::Object(traits) = self.genotype.traits() {
            notes.extend(traits);
        }
        notes
    }
}

//! NEAT at the level of the population: every generation is sorted into species, each species is granted
//! offspring by its shared fitness, and breeds them from its best (G-29..G-45). How a genotype varies is
//! `creatures`' business.

mod breeding;
mod settings;
mod species;

pub use settings::{KIND, Settings, Speciation};

use crate::checkpoint::{self, GenotypeBytes, RestoreError, require};
use crate::inheritance::{Scored, inherited};
use crate::{Individual, Parent, Place, Record, Search};
use creatures::Outcome;
use creatures::walker::neat;
use serde_json::Value;
use species::{Sorting, Species};
use std::collections::{BTreeMap, BTreeSet};

/// The search at work: its state at the end of a generation, and the generation asked for.
#[derive(Debug)]
struct Neat {
    settings: Settings,
    seed: u64,
    stage: u32,
    /// The last generation told; 0 before the first.
    generation: u32,
    register: neat::Register,
    /// In order of index.
    population: Vec<Member>,
    /// Of that population, ascending by id.
    species: Vec<Species>,
    /// The id of the next species founded.
    next_species: u32,
    /// The generation asked for and not yet told.
    asked: Option<Asked>,
}

#[derive(Debug)]
struct Member {
    genotype: neat::Genotype,
    scored: Scored,
    species: u32,
}

/// A generation between ask and tell, with what it adds to the state.
#[derive(Debug)]
struct Asked {
    genotypes: Vec<(neat::Genotype, Vec<u8>)>,
    register: neat::Register,
    sorting: Sorting,
}

/// An individual in the making.
#[derive(Debug)]
struct Child {
    genotype: neat::Genotype,
    parents: Vec<Parent>,
    operator: String,
}

impl Neat {
    fn start(settings: &Settings, seed: u64, stage: u32) -> Neat {
        Neat {
            settings: settings.clone(),
            seed,
            stage,
            generation: 0,
            register: neat::Register::new(settings.body),
            population: Vec::new(),
            species: Vec::new(),
            next_species: 1,
            asked: None,
        }
    }

    fn restore(settings: &Settings, seed: u64, stage: u32, bytes: &[u8]) -> Result<Neat, RestoreError> {
        type State = (u32, neat::Register, Vec<(Scored, u32)>, Vec<Species>, u32);
        let (generation, register, members, species, next_species): State = checkpoint::read(KIND, bytes)?;
        let member = |(index, (scored, species)): (usize, (Scored, u32))| {
            let GenotypeBytes(bytes) = &scored.genotype;
            let genotype =
                neat::Genotype::decode(bytes).map_err(|source| RestoreError::Genotype { index, source })?;
            Ok(Member { genotype, scored, species })
        };
        let population: Vec<Member> =
            members.into_iter().enumerate().map(member).collect::<Result<_, _>>()?;
        let start = Neat::start(settings, seed, stage);
        let state = Neat { generation, register, population, species, next_species, ..start };
        state.check()?;
        Ok(state)
    }

    /// Checks a state that comes from outside for all that the search relies on.
    fn check(&self) -> Result<(), RestoreError> {
        let size = if self.generation == 0 { 0 } else { self.settings.population };
        require(self.population.len() == size as usize, "its population has another size")?;
        let same_body = self.population.iter().all(|member| member.genotype.body == self.settings.body);
        require(same_body, "its population has another body")?;
        let ids: BTreeSet<u32> = self.population.iter().map(|member| member.species).collect();
        let listed = self.species.iter().map(|species| species.id);
        require(listed.eq(ids.iter().copied()), "its species are not those of its population")?;
        let granted: u64 = self.species.iter().map(|species| u64::from(species.quota)).sum();
        require(granted == u64::from(size), "its quotas do not fill a generation")?;
        require(ids.last() < Some(&self.next_species), "its species are numbered beyond the next one")
    }

    fn place(&self, generation: u32, index: u32) -> Place {
        Place { stage: self.stage, generation, index }
    }

    /// Indices of a species' members in the last generation told, ascending.
    fn members(&self, species: u32) -> Vec<usize> {
        (0..self.population.len()).filter(|&index| self.population[index].species == species).collect()
    }

    /// Who stands for each species that goes on: a uniformly drawn member of the last generation (G-34).
    fn representatives(&self) -> BTreeMap<u32, (Place, &neat::Genotype)> {
        let drawn = |species: &Species| {
            let members = self.members(species.id);
            let mut draws = self.place(self.generation + 1, species.id).stream(self.seed, "representative");
            let index = members[draws.below(members.len())];
            (species.id, (self.place(self.generation, index as u32), &self.population[index].genotype))
        };
        self.species.iter().filter(|species| species.quota > 0).map(drawn).collect()
    }
}

impl Search for Neat {
    fn ask(&mut self) -> Vec<Individual> {
        if self.generation >= self.settings.generations {
            return Vec::new();
        }
        let mut register = self.register.clone();
        let children = breeding::next(self, &mut register);
        let first = self.place(self.generation + 1, 0);
        let sorting = species::sort(
            children.iter().map(|child| &child.genotype),
            first,
            self.representatives(),
            self.next_species,
            &self.settings,
        );
        let genotypes: Vec<Vec<u8>> = children.iter().map(|child| child.genotype.encode()).collect();
        let scored = self.population.iter().map(|member| &member.scored);
        let inherits = inherited(scored, &genotypes, [self.place(self.generation, 0), first]);
        let individuals = children
            .iter()
            .zip(&genotypes)
            .zip(inherits.into_iter().zip(&sorting.species))
            .map(|((child, genotype), (inherits, &species))| {
                let mut traits = child.genotype.traits();
                if let Value::Object(traits) = &mut traits {
                    traits.insert("species".to_owned(), species.into());
                }
                Individual {
                    genotype: genotype.clone(),
                    parents: child.parents.clone(),
                    operator: child.operator.clone(),
                    traits,
                    inherits,
                }
            })
            .collect();
        let genotypes = children.into_iter().map(|child| child.genotype).zip(genotypes).collect();
        self.asked = Some(Asked { genotypes, register, sorting });
        individuals
    }

    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record {
        let asked = self.asked.take().expect("a generation is told after it was asked for");
        assert_eq!(asked.genotypes.len(), outcomes.len(), "one outcome an individual");
        self.population = asked
            .genotypes
            .into_iter()
            .zip(&asked.sorting.species)
            .zip(outcomes)
            .map(|(((genotype, bytes), &species), outcome)| Member {
                genotype,
                scored: Scored::new(bytes, outcome.as_ref()),
                species,
            })
            .collect();
        let scores: Vec<(u32, f64)> =
            self.population.iter().map(|member| (member.species, member.scored.fitness)).collect();
        let previous = std::mem::take(&mut self.species);
        let standings = species::assess(&scores, &previous, &self.settings);
        let mut record = Record::default();
        for standing in &standings {
            record.species.push(crate::Species {
                id: standing.species.id,
                size: standing.size,
                best: standing.best,
                share: standing.share,
                quota: standing.species.quota,
                representative: asked.sorting.representatives[&standing.species.id],
                stagnant: standing.species.stagnant,
            });
        }
        let grown = asked.register.len() - self.register.len();
        record.notes.insert("innovations".to_owned(), asked.register.len().into());
        record.notes.insert("innovations_new".to_owned(), grown.into());
        record.notes.insert("species".to_owned(), standings.len().into());
        self.species = standings.into_iter().map(|standing| standing.species).collect();
        self.register = asked.register;
        self.next_species = asked.sorting.next_species;
        self.generation += 1;
        record
    }

    fn checkpoint(&self) -> Vec<u8> {
        let members: Vec<(&Scored, u32)> =
            self.population.iter().map(|member| (&member.scored, member.species)).collect();
        let state = (self.generation, &self.register, members, &self.species, self.next_species);
        checkpoint::write(KIND, &state)
    }
}

#[cfg(test)]
mod tests;

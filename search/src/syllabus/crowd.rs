//! The populations of a stage, side by side in one generation: who was scored, and who was asked for and is not
//! yet told. Individuals stand population by population. It breeds nobody.

use super::learned::stopped_by;
use crate::inheritance::{Scored, inherited};
use crate::population::Child;
use crate::{Individual, Parent, Place, selection};
use creatures::Outcome;
use creatures::esp::genotype::Genotype;
use serde_json::{Value, json};

/// One of the last generation told.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Member {
    pub(super) genotype: Genotype,
    pub(super) scored: Scored,
    /// Whether it was stopped by what it had lost of an older skill.
    pub(super) stopped: bool,
}

impl Member {
    /// Whether its fitness is what it reached: only then it may be a parent while anybody may (E-37).
    pub(super) fn fit(&self) -> bool {
        self.scored.completed() && !self.stopped
    }
}

/// One that was asked for.
#[derive(Debug)]
struct Asked {
    genotype: Genotype,
    bytes: Vec<u8>,
    inherits: bool,
}

/// All populations of a stage.
#[derive(Debug, Default)]
pub(super) struct Crowd {
    /// Where the members stand: stage and generation. While it is another stage than the search's, they are
    /// survivors of a phase before, to be scored anew (E-43).
    pub(super) at: (u32, u32),
    /// The last generation told.
    pub(super) members: Vec<Member>,
    asked: Option<Vec<Asked>>,
}

impl Crowd {
    /// Members at a stage and generation, as a checkpoint has them.
    pub(super) fn standing(at: (u32, u32), members: Vec<Member>) -> Crowd {
        Crowd { at, members, asked: None }
    }

    /// The last generation told of a stage; 0 before its first.
    pub(super) fn generation(&self, stage: u32) -> u32 {
        if self.at.0 == stage { self.at.1 } else { 0 }
    }

    /// The place of a member.
    pub(super) fn place(&self, index: usize) -> Place {
        Place { stage: self.at.0, generation: self.at.1, index: index as u32 }
    }

    /// A member as a parent.
    pub(super) fn parent(&self, index: usize, role: &str) -> Parent {
        Parent { place: self.place(index), role: role.to_owned() }
    }

    /// The members of a population of a size as a range of indices.
    pub(super) fn range(population: u32, size: u32) -> std::ops::Range<usize> {
        let first = (population * size) as usize;
        first..first + size as usize
    }

    /// The indices of some members, the fit before the others, then by fitness, equals by index.
    pub(super) fn ranks(&self, range: std::ops::Range<usize>) -> Vec<usize> {
        let fitness: Vec<f64> =
            self.members[range.clone()].iter().map(|member| member.scored.fitness).collect();
        let mut ranks: Vec<usize> =
            selection::ranks(&fitness).into_iter().map(|rank| range.start + rank).collect();
        ranks.sort_by_key(|&index| !self.members[index].fit()); // stable
        ranks
    }

    /// The next generation of a stage as the search asks for it. Children stand population by population, each
    /// of `size`.
    pub(super) fn ask(&mut self, stage: u32, size: u32, children: Vec<Child<Genotype>>) -> Vec<Individual> {
        let generation = self.generation(stage);
        let genotypes: Vec<Vec<u8>> = children.iter().map(|child| child.genotype.encode()).collect();
        let first = |generation| Place { stage, generation, index: 0 };
        let previous = if generation > 0 { self.members.as_slice() } else { &[] };
        let previous = previous.iter().map(|member| &member.scored);
        let inherits = inherited(previous, &genotypes, [first(generation), first(generation + 1)]);
        let mut individuals = Vec::with_capacity(children.len());
        for (index, (child, inherits)) in (0..).zip(children.iter().zip(inherits)) {
            let mut traits = child.genotype.traits();
            if let Value::Object(traits) = &mut traits {
                traits.insert("population".to_owned(), json!(index / size + 1));
            }
            individuals.push(Individual {
                genotype: genotypes[index as usize].clone(),
                parents: child.parents.clone(),
                operator: child.operator.clone(),
                traits,
                inherits,
            });
        }
        let asked = children.into_iter().zip(genotypes).zip(&individuals).map(|((child, bytes), one)| {
            Asked { genotype: child.genotype, bytes, inherits: one.inherits.is_some() }
        });
        self.asked = Some(asked.collect());
        individuals
    }

    /// Takes the outcomes of the generation last asked for, in order of index, and says of each individual
    /// whether it was evaluated, and not inherited.
    pub(super) fn tell(&mut self, stage: u32, outcomes: &[Option<Outcome>]) -> Vec<bool> {
        let asked = self.asked.take().expect("a generation is told after it was asked for");
        assert_eq!(asked.len(), outcomes.len(), "one outcome an individual");
        self.at = (stage, self.generation(stage) + 1);
        let evaluated = asked.iter().map(|one| !one.inherits).collect();
        let member = |(asked, outcome): (Asked, &Option<Outcome>)| Member {
            genotype: asked.genotype,
            scored: Scored::new(asked.bytes, outcome.as_ref()),
            stopped: outcome.as_ref().is_some_and(|outcome| stopped_by(outcome).is_some()),
        };
        self.members = asked.into_iter().zip(outcomes).map(member).collect();
        evaluated
    }
}

//! A population from generation to generation: who was scored, and who was asked for and is not yet told. It
//! breeds nobody.

use crate::checkpoint::{self, RestoreError, require};
use crate::inheritance::{Scored, inherited};
use crate::{Individual, Parent, Place};
use creatures::{DecodeError, Outcome, flyer, walker};
use serde_json::Value;

/// What a population needs to know of its genotypes.
pub trait Heritable: Sized {
    /// Canonical bytes.
    fn encode(&self) -> Vec<u8>;

    /// Reads canonical bytes.
    ///
    /// # Errors
    /// Bytes that are no legal genotype.
    fn decode(bytes: &[u8]) -> Result<Self, DecodeError>;

    /// What people ask about: a flat JSON object.
    fn traits(&self) -> Value;
}

macro_rules! heritable {
    ($genotype:ty) => {
        impl Heritable for $genotype {
            fn encode(&self) -> Vec<u8> {
                <$genotype>::encode(self)
            }

            fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
                <$genotype>::decode(bytes)
            }

            fn traits(&self) -> Value {
                <$genotype>::traits(self)
            }
        }
    };
}

heritable!(flyer::Genotype);
heritable!(walker::grn::Genotype);

/// One of the last generation told.
#[derive(Debug)]
pub(crate) struct Member<G> {
    pub(crate) genotype: G,
    pub(crate) scored: Scored,
}

/// An individual in the making.
#[derive(Debug)]
pub(crate) struct Child<G> {
    pub(crate) genotype: G,
    pub(crate) parents: Vec<Parent>,
    pub(crate) operator: String,
}

/// The population of one stage.
#[derive(Debug)]
pub(crate) struct Population<G> {
    stage: u32,
    /// The last generation told; 0 before the first.
    generation: u32,
    members: Vec<Member<G>>,
    /// The generation asked for and not yet told, each genotype with its bytes.
    asked: Option<Vec<(G, Vec<u8>)>>,
}

impl<G: Heritable + Clone> Population<G> {
    /// Before the first generation.
    pub(crate) fn new(stage: u32) -> Population<G> {
        Population { stage, generation: 0, members: Vec::new(), asked: None }
    }

    /// As a checkpoint of a search of that kind and size has it.
    ///
    /// # Errors
    /// Bytes that are no such checkpoint.
    pub(crate) fn restore(
        kind: &'static str,
        stage: u32,
        size: u32,
        bytes: &[u8],
    ) -> Result<Population<G>, RestoreError> {
        let (generation, scored): (u32, Vec<Scored>) = checkpoint::read(kind, bytes)?;
        let member = |(index, scored): (usize, Scored)| {
            let genotype =
                G::decode(&scored.genotype.0).map_err(|source| RestoreError::Genotype { index, source })?;
            Ok(Member { genotype, scored })
        };
        let members: Vec<_> = scored.into_iter().enumerate().map(member).collect::<Result<_, _>>()?;
        let size = if generation == 0 { 0 } else { size as usize };
        require(members.len() == size, "its population has another size")?;
        Ok(Population { stage, generation, members, asked: None })
    }

    /// The inverse of [`Population::restore`].
    pub(crate) fn checkpoint(&self, kind: &str) -> Vec<u8> {
        let scored: Vec<&Scored> = self.members.iter().map(|member| &member.scored).collect();
        checkpoint::write(kind, &(self.generation, scored))
    }

    /// The last generation told; 0 before the first.
    pub(crate) fn generation(&self) -> u32 {
        self.generation
    }

    /// The last generation told, in order of index.
    pub(crate) fn members(&self) -> &[Member<G>] {
        &self.members
    }

    /// The places of the next generation.
    pub(crate) fn next_places(&self, count: u32) -> impl Iterator<Item = Place> + use<G> {
        let (stage, generation) = (self.stage, self.generation + 1);
        (0..count).map(move |index| Place { stage, generation, index })
    }

    /// A member as a parent.
    pub(crate) fn parent(&self, index: usize, role: &str) -> Parent {
        let place = Place { stage: self.stage, generation: self.generation, index: index as u32 };
        Parent { place, role: role.to_owned() }
    }

    /// A copy of a member.
    pub(crate) fn copy(&self, index: usize, operator: &str) -> Child<G> {
        Child {
            genotype: self.members[index].genotype.clone(),
            parents: vec![self.parent(index, "only")],
            operator: operator.to_owned(),
        }
    }

    /// The next generation as a search asks for it.
    pub(crate) fn ask(&mut self, children: Vec<Child<G>>) -> Vec<Individual> {
        let genotypes: Vec<Vec<u8>> = children.iter().map(|child| child.genotype.encode()).collect();
        let first = |generation| Place { stage: self.stage, generation, index: 0 };
        let firsts = [first(self.generation), first(self.generation + 1)];
        let inherits = inherited(self.members.iter().map(|member| &member.scored), &genotypes, firsts);
        let individuals =
            children.iter().zip(&genotypes).zip(inherits).map(|((child, genotype), inherits)| Individual {
                genotype: genotype.clone(),
                parents: child.parents.clone(),
                operator: child.operator.clone(),
                traits: child.genotype.traits(),
                inherits,
            });
        let individuals = individuals.collect();
        self.asked = Some(children.into_iter().map(|child| child.genotype).zip(genotypes).collect());
        individuals
    }

    /// Takes the outcomes of the generation last asked for, in order of index.
    pub(crate) fn tell(&mut self, outcomes: &[Option<Outcome>]) {
        let asked = self.asked.take().expect("a generation is told after it was asked for");
        assert_eq!(asked.len(), outcomes.len(), "one outcome an individual");
        let member = |((genotype, bytes), outcome): ((G, Vec<u8>), &Option<Outcome>)| Member {
            genotype,
            scored: Scored::new(bytes, outcome.as_ref()),
        };
        self.members = asked.into_iter().zip(outcomes).map(member).collect();
        self.generation += 1;
    }
}

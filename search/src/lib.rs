//! What is asked next. A search is asked for a generation and told its outcomes; it knows nothing of
//! workers, SQL or gRPC. Pure: no I/O, no async, no clock, no thread, no hash order.

pub mod annealing;
pub mod checkpoint;
pub mod culling;
pub mod experiment;
pub mod generational;
pub mod grn;
pub mod hash;
mod inheritance;
pub mod learning;
pub mod neat;
pub mod place;
pub mod population;
pub mod probe;
pub mod registry;
pub mod selection;
mod settings;
pub mod syllabus;

pub use checkpoint::RestoreError;
pub use culling::Culling;
pub use experiment::{Experiment, Overrides, Problem, read_table};
pub use hash::{HashRow, LineageHasher};
pub use place::Place;

use creatures::Outcome;
use serde::{Deserialize, Serialize};

/// One published algorithm at work on one stage: ask / tell.
///
/// The driver alternates [`Search::ask`] and [`Search::tell`], starting with `ask`: searches are strictly
/// generational, and a missing outcome blocks rather than being guessed (walker G-76). The order of
/// individuals is the contract: outcome `i` belongs to individual `i`.
pub trait Search: Send {
    /// The individuals of the next generation in order of index; empty when the search is over, or when it
    /// waits for a pick ([`Search::choice`]).
    ///
    /// A pure function of the search's state: a search restored from its checkpoint asks for the same.
    fn ask(&mut self) -> Vec<Individual>;

    /// The stage of the generation last asked for. Its number never falls, and the generations of each stage
    /// count from 1.
    fn stage(&self) -> Stage {
        Stage::default() // most searches are one stage on the experiment's task
    }

    /// Takes the outcomes of the generation last asked for, in order of index, and says what it made of
    /// them. An individual that the service had to set aside comes as `None` and counts as fitness 0.
    fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Record;

    /// All that the search needs to go on from here: taken after `tell` or `pick` (or before the first `ask`),
    /// given back to the registry's `restore`.
    fn checkpoint(&self) -> Vec<u8>;

    /// What is to be picked from before the search asks for more, at the end of a stage: asked for when
    /// [`Search::ask`] gave nobody. One choice a stage at most.
    fn choice(&self) -> Option<Choice> {
        None // most searches pick nobody
    }

    /// Goes on with one of the candidates of [`Search::choice`].
    ///
    /// # Errors
    /// No pick is awaited, or the place is none of the candidates' (ESP EF-14); nothing changes.
    fn pick(&mut self, place: Place) -> Result<(), PickError> {
        let _ = place; // nothing is awaited
        Err(PickError::NotAwaited)
    }

    /// Why the search cannot go on; it then asks for nothing more (ESP E-82).
    fn failure(&self) -> Option<String> {
        None // most searches come to their end
    }
}

/// One stage of a search, as the lineage names it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stage {
    /// From 0: the `stage` of its places.
    pub number: u32,
    /// What it is for; empty where there is one alone.
    pub name: String,
    /// How many generations it takes; none where the plan says it ([`registry::Plan::generations`]).
    pub generations: Option<u32>,
    /// The resolved task of its evaluations; none for the experiment's.
    pub task: Option<serde_json::Value>,
}

/// Candidates at the end of a stage, best first; never empty.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Who picks.
    pub by: PickedBy,
    /// Best first.
    pub candidates: Vec<Candidate>,
}

/// Who picks the creature that goes on (ESP E-82).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PickedBy {
    /// Nobody: the best goes on.
    #[default]
    Best,
    /// A person.
    Human,
}

/// An individual that may be picked.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Where it stands.
    pub place: Place,
    /// Its fitness.
    pub fitness: f64,
    /// What a person wants to know of it: a flat JSON object.
    pub notes: serde_json::Map<String, serde_json::Value>,
}

/// Why a pick was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PickError {
    /// The search is not at such a point.
    #[error("no pick is awaited")]
    NotAwaited,
    /// It is at one, and this is no candidate.
    #[error("the individual at stage {}, generation {}, index {} is no candidate", .0.stage, .0.generation, .0.index)]
    NoCandidate(Place),
}

/// One individual as a search asks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Individual {
    /// Canonical bytes.
    pub genotype: Vec<u8>,
    /// Empty for founders.
    pub parents: Vec<Parent>,
    /// How it was made: the operators in order of application, joined by `+` (`crossover+tag`).
    pub operator: String,
    /// What people ask about (regulatory proteins, hidden nodes, species): a flat JSON object.
    pub traits: serde_json::Value,
    /// Equal genotype at an evaluated place, whose outcome it takes over without an evaluation. Either in
    /// the previous generation of its stage or earlier in this one, and never at a place that inherits from
    /// its own generation. An individual that was set aside hands that on as well.
    pub inherits: Option<Place>,
}

/// A parent and the part it played.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parent {
    /// Where the parent stands.
    pub place: Place,
    /// `first` (gives the head, or the structure), `second`, or `only`.
    pub role: String,
}

/// What a search has to say of a generation it was told.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Record {
    /// Species, for searches that have them.
    pub species: Vec<Species>,
    /// What else belongs in the generation's row: a flat JSON object.
    pub notes: serde_json::Map<String, serde_json::Value>,
}

/// One species in one generation (walker G-45).
#[derive(Debug, Clone, PartialEq)]
pub struct Species {
    /// Its number in the run; never reused.
    pub id: u32,
    /// Members.
    pub size: u32,
    /// Best raw fitness of this generation.
    pub best: f64,
    /// Its shared fitness: the mean raw fitness.
    pub share: f64,
    /// Offspring granted in the next generation.
    pub quota: u32,
    /// The individual that stood for it when members were sought.
    pub representative: Place,
    /// Generations since its best fitness last rose.
    pub stagnant: u32,
}

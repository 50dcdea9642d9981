//! Inheritance of outcomes: an individual whose genotype equals one already scored takes over that outcome
//! instead of being evaluated again (G-28). It compares bytes; it never opens a genotype.

use crate::checkpoint::GenotypeBytes;
use crate::{Place, selection};
use creatures::{Outcome, Status};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a search keeps of an individual that it was told of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Scored {
    pub(crate) genotype: GenotypeBytes,
    pub(crate) fitness: f64,
    pub(crate) ending: Ending,
}

/// What its ending means to a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Ending {
    /// Its fitness is what it reached.
    Completed,
    /// Stopped by a cutoff that holds for its generation alone.
    Culled,
    /// Aborted, or set aside by the service.
    Discarded,
}

impl Scored {
    pub(crate) fn new(genotype: Vec<u8>, outcome: Option<&Outcome>) -> Scored {
        Scored {
            genotype: GenotypeBytes(genotype),
            fitness: selection::fitness(outcome),
            ending: match outcome.map(|outcome| outcome.status) {
                Some(Status::Completed) => Ending::Completed,
                Some(Status::Culled) => Ending::Culled,
                Some(Status::Aborted(_)) | None => Ending::Discarded,
            },
        }
    }

    /// Whether its fitness is what it reached, and not the 0 of those who were stopped.
    pub(crate) fn completed(&self) -> bool {
        self.ending == Ending::Completed
    }
}

/// For each genotype of the next generation the place whose outcome it takes over, if any: the first equal
/// one of the `previous` generation, else the first equal one of its own. `first_of` gives the first place of
/// a generation: `[previous, next]`.
///
/// An individual that was set aside hands that on too: its genotype would only kill more workers. One that
/// was culled hands on nothing, since its end depended on a cutoff that no longer holds.
pub(crate) fn inherited<'a>(
    previous: impl Iterator<Item = &'a Scored>,
    next: &'a [Vec<u8>],
    [first_previous, first_next]: [Place; 2],
) -> Vec<Option<Place>> {
    let place = |first: Place, index: usize| Place { index: index as u32, ..first };
    let mut known: BTreeMap<&[u8], Place> = BTreeMap::new();
    for (index, scored) in previous.enumerate().filter(|(_, scored)| scored.ending != Ending::Culled) {
        known.entry(&scored.genotype.0).or_insert(place(first_previous, index));
    }
    let inherit = |(index, genotype): (usize, &'a Vec<u8>)| {
        let here = place(first_next, index);
        let first = *known.entry(genotype).or_insert(here);
        (first != here).then_some(first)
    };
    next.iter().enumerate().map(inherit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outcome_comes_from_the_previous_generation_or_earlier_in_this_one() {
        let at = |generation, index| Place { stage: 0, generation, index };
        let scored = |genotype: &str, culled| Scored {
            genotype: GenotypeBytes(genotype.into()),
            fitness: 1.0,
            ending: if culled { Ending::Culled } else { Ending::Completed },
        };
        let previous = [scored("a", false), scored("x", true), scored("b", false), scored("a", false)];
        let next = ["a", "c", "c", "x", "a"].map(|genotype| genotype.as_bytes().to_vec());
        assert_eq!(
            inherited(previous.iter(), &next, [at(1, 0), at(2, 0)]),
            [Some(at(1, 0)), None, Some(at(2, 1)), None, Some(at(1, 0))],
            "the first of equals, never through a chain, nothing from the culled"
        );
    }
}

//! The generation under evaluation: who is settled, who inherits, who is still out. A value that is told
//! outcomes; it writes nothing and waits for nothing.

use creatures::{Outcome, Status};
use search::Place;

use crate::lineage::IndividualId;

/// What is known of a settled individual: its outcome, or none if it was set aside.
pub(super) type Known = Option<Outcome>;

/// An outcome that needs no evaluation: who takes it over, and from whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Inherited {
    pub(super) heir: IndividualId,
    pub(super) from: IndividualId,
}

/// One batch of individuals on its way from asked to told.
#[derive(Debug)]
pub(super) struct Generation {
    pub(super) number: u32,
    /// Ids are contiguous in order of index.
    first: IndividualId,
    settled: Vec<Option<Known>>,
    /// By index: the later individuals of this generation that wait for its outcome.
    heirs: Vec<Vec<usize>>,
    missing: usize,
}

impl Generation {
    /// A generation of which nothing is known but what stands on disk (`settled`, by index) and what is
    /// inherited. Gives also the inheritances that could be settled at once.
    ///
    /// `inherits` names, by index, the place whose outcome an individual takes over; `previous` is the
    /// generation before, in order of index.
    pub(super) fn new(
        number: u32,
        first: IndividualId,
        inherits: &[Option<Place>],
        settled: Vec<Option<Known>>,
        previous: Option<&Generation>,
    ) -> (Generation, Vec<Inherited>) {
        let size = inherits.len();
        let mut generation =
            Generation { number, first, settled: vec![None; size], heirs: vec![vec![]; size], missing: size };
        let mut inherited = Vec::new();
        for (index, source) in inherits.iter().enumerate() {
            if let Some(source) = source.filter(|place| place.generation == number) {
                generation.heirs[source.index as usize].push(index);
            }
        }
        for (index, known) in settled.into_iter().enumerate() {
            if let Some(known) = known {
                generation.fill(index, known);
            }
        }
        for (index, source) in inherits.iter().enumerate() {
            if let Some(known) = generation.settled[index].clone() {
                // What was on disk may have heirs that were not.
                inherited.extend(generation.pass_on(index, &known));
            } else if let Some(source) = source.filter(|place| place.generation < number)
                && let Some(previous) = previous
                && let Some((known, from)) = previous.standing(source.index as usize)
            {
                inherited.push(Inherited { heir: first.at(index as u32), from });
                inherited.extend(generation.settle(index, known));
            }
        }
        (generation, inherited)
    }

    /// Settles one individual and everybody of this generation who inherits from it. A second settlement
    /// changes nothing.
    pub(super) fn settle(&mut self, index: usize, known: Known) -> Vec<Inherited> {
        if self.settled[index].is_some() {
            return Vec::new();
        }
        self.fill(index, known.clone());
        self.pass_on(index, &known)
    }

    /// Takes a settlement back, as if it had never been.
    pub(super) fn unsettle(&mut self, index: usize) {
        if self.settled[index].take().is_some() {
            self.missing += 1;
        }
    }

    fn pass_on(&mut self, index: usize, known: &Known) -> Vec<Inherited> {
        let mut inherited = Vec::new();
        for heir in self.heirs[index].clone() {
            if self.settled[heir].is_none() {
                inherited
                    .push(Inherited { heir: self.first.at(heir as u32), from: self.first.at(index as u32) });
                inherited.extend(self.settle(heir, known.clone()));
            }
        }
        inherited
    }

    fn fill(&mut self, index: usize, known: Known) {
        if self.settled[index].replace(known).is_none() {
            self.missing -= 1;
        }
    }

    /// The individuals that have to be evaluated: neither settled nor waiting to inherit.
    pub(super) fn unsettled(&self) -> Vec<usize> {
        let mut out: Vec<bool> = self.settled.iter().map(Option::is_none).collect();
        for heirs in &self.heirs {
            for &heir in heirs {
                out[heir] = false;
            }
        }
        (0..out.len()).filter(|&index| out[index]).collect()
    }

    /// The index of an individual of this generation.
    pub(super) fn index(&self, id: IndividualId) -> Option<usize> {
        let index = id.0.checked_sub(self.first.0)?;
        usize::try_from(index).ok().filter(|&index| index < self.settled.len())
    }

    /// The id at an index.
    pub(super) fn id(&self, index: usize) -> Option<IndividualId> {
        (index < self.settled.len()).then(|| self.first.at(index as u32))
    }

    /// The id of its first individual.
    pub(super) fn first(&self) -> IndividualId {
        self.first
    }

    fn standing(&self, index: usize) -> Option<(Known, IndividualId)> {
        Some((self.settled.get(index)?.clone()?, self.id(index)?))
    }

    /// Whether every individual is settled.
    pub(super) fn complete(&self) -> bool {
        self.missing == 0
    }

    /// How many there are, and how many of them are settled.
    pub(super) fn progress(&self) -> (usize, usize) {
        (self.settled.len(), self.settled.len() - self.missing)
    }

    /// What is known, in order of index; none for those not settled or set aside.
    pub(super) fn outcomes(&self) -> Vec<Known> {
        self.settled.iter().map(|known| known.clone().flatten()).collect()
    }

    /// The best completed individual so far: the lowest index among equals.
    pub(super) fn best(&self) -> Option<(IndividualId, f64)> {
        let mut best: Option<(IndividualId, f64)> = None;
        for (index, known) in self.settled.iter().enumerate() {
            if let Some(Some(outcome)) = known
                && outcome.status == Status::Completed
                && best.is_none_or(|(_, fitness)| outcome.fitness > fitness)
            {
                best = Some((self.first.at(index as u32), outcome.fitness));
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(fitness: f64) -> Known {
        Some(Outcome {
            status: Status::Completed,
            fitness,
            steps: 1,
            measures: vec![],
            interim: None,
            note: String::new(),
        })
    }

    fn at(generation: u32, index: u32) -> Option<Place> {
        Some(Place { stage: 0, generation, index })
    }

    #[test]
    fn an_heir_is_settled_with_the_one_it_inherits_from() {
        let (mut generation, inherited) =
            Generation::new(1, IndividualId(10), &[None, at(1, 0), at(1, 1), None], vec![None; 4], None);
        assert_eq!(inherited, []);
        assert_eq!(generation.unsettled(), [0, 3]);
        let heirs = generation.settle(0, outcome(2.0));
        assert_eq!(
            heirs,
            [
                Inherited { heir: IndividualId(11), from: IndividualId(10) },
                Inherited { heir: IndividualId(12), from: IndividualId(11) },
            ]
        );
        assert!(!generation.complete());
        generation.settle(3, None);
        assert!(generation.complete());
        assert_eq!(generation.best(), Some((IndividualId(10), 2.0)));
        assert_eq!(generation.settle(0, outcome(9.0)), [], "a second settlement changes nothing");
    }

    #[test]
    fn what_was_taken_back_is_settled_again_with_its_heirs() {
        let (mut generation, _) =
            Generation::new(1, IndividualId(1), &[None, at(1, 0), None], vec![None; 3], None);
        generation.settle(0, outcome(9.0));
        generation.settle(2, outcome(1.0));
        assert!(generation.complete());
        [0, 1].into_iter().for_each(|index| generation.unsettle(index));
        generation.unsettle(1);
        assert_eq!((generation.progress(), generation.unsettled()), ((3, 1), vec![0]));
        assert_eq!(generation.best(), Some((IndividualId(3), 1.0)));
        let heirs = generation.settle(0, outcome(2.0));
        assert_eq!(heirs, [Inherited { heir: IndividualId(2), from: IndividualId(1) }]);
        assert_eq!(generation.outcomes(), [outcome(2.0), outcome(2.0), outcome(1.0)]);
    }

    #[test]
    fn what_stands_on_disk_is_not_evaluated_again() {
        let (previous, _) =
            Generation::new(1, IndividualId(1), &[None, None], vec![Some(outcome(5.0)), Some(None)], None);
        let inherits = [at(1, 0), None, at(2, 1), None];
        let settled = vec![None, Some(outcome(3.0)), None, None];
        let (generation, inherited) =
            Generation::new(2, IndividualId(3), &inherits, settled, Some(&previous));
        assert_eq!(
            inherited,
            [
                Inherited { heir: IndividualId(3), from: IndividualId(1) },
                Inherited { heir: IndividualId(5), from: IndividualId(4) },
            ]
        );
        assert_eq!(generation.unsettled(), [3]);
        assert_eq!(generation.index(IndividualId(6)), Some(3));
        assert_eq!(generation.index(IndividualId(7)), None);
    }

    #[test]
    fn an_heir_of_one_set_aside_is_set_aside() {
        let (mut generation, _) = Generation::new(1, IndividualId(1), &[None, at(1, 0)], vec![None; 2], None);
        generation.settle(0, None);
        assert!(generation.complete());
        assert_eq!(generation.outcomes(), [None, None]);
    }
}

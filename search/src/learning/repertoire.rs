//! From practised states to controllers, and from raced controllers to sets (A-41..A-43). It lives nobody.

use super::{Lesson, Teaches};
use crate::annealing::State;
use crate::checkpoint::{GenotypeBytes, RestoreError, require};
use crate::{Individual, Parent, Place};
use creatures::fish::{Calibrated, Controller, ControllerSet, Genotype, abstracted};
use creatures::{Outcome, Status};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A controller on its way to the race.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Racer {
    pub(super) lesson: u32,
    chain: u32,
    /// Which chain's swim it is, or bends.
    gait: u32,
    gain: f64,
    controller: Controller,
    /// The state that it was abstracted from; of a turn, then that of the swim which it bends.
    parents: Vec<Parent>,
}

/// A controller that was raced.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Raced {
    lesson: u32,
    chain: u32,
    gait: u32,
    gain: f64,
    place: Place,
    /// Of the controller; turned over if the lesson's turn came out to the right.
    genotype: GenotypeBytes,
    /// L by time, or rad by time.
    measured: f64,
}

/// All that was raced and got to its end, in order of place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Repertoire {
    raced: Vec<(Raced, Controller)>,
}

/// The straight swim of a chain's best state; none where nothing swings (AF-20).
pub(super) fn swim_of(best: &State, oscillations: usize) -> Option<Controller> {
    let raw = abstracted(&best.samples, oscillations);
    (raw.oscillations() == oscillations && best.value > f64::NEG_INFINITY).then(|| raw.symmetrised())
}

impl Racer {
    /// The straight swim of a chain's best state, its amplitudes times a gain.
    pub(super) fn swim(best: &State, swim: &Controller, [lesson, chain]: [u32; 2], gain: f64) -> Racer {
        let parents = vec![Parent { place: best.place, role: "only".to_owned() }];
        Racer { lesson, chain, gait: chain, gain, controller: swim.amplified(gain), parents }
    }

    /// A straight swim bent as a chain's best turn is, times a gain.
    ///
    /// The turn's own beat is let go: it is learned under way, where a fish that holds a bend and coasts does as
    /// well as one that beats, and from rest does not get on at all.
    pub(super) fn turn(
        best: &State,
        oscillations: usize,
        (straight, swim): (&State, &Controller),
        [lesson, chain, gait]: [u32; 3],
        gain: f64,
    ) -> Racer {
        let controller = swim.bent(&abstracted(&best.samples, oscillations), gain);
        let parent = |state: &State, role: &str| Parent { place: state.place, role: role.to_owned() };
        let parents = vec![parent(best, "first"), parent(straight, "second")];
        Racer { lesson, chain, gait, gain, controller, parents }
    }

    pub(super) fn individual(&self) -> Individual {
        Individual {
            genotype: Genotype::Controller(self.controller.clone()).encode(),
            parents: self.parents.clone(),
            operator: "abstract".to_owned(),
            traits: json!({
                "lesson": self.lesson,
                "chain": self.chain,
                "gait": self.gait,
                "gain": self.gain,
                "frequency": self.controller.frequency[0],
            }),
            inherits: None,
        }
    }

    /// What it was seen to do; none of one that did not get to the end.
    pub(super) fn measured(
        self,
        outcome: &Outcome,
        turns: bool,
        place: Place,
    ) -> Option<(Raced, Controller)> {
        let name = if turns { "turn_rate" } else { "speed" };
        let measured = outcome.measures.iter().find(|(key, _)| key == name)?.1;
        let (measured, controller) = match measured < 0.0 {
            true => (-measured, self.controller.mirrored()),
            false => (measured, self.controller),
        };
        let genotype = GenotypeBytes(Genotype::Controller(controller.clone()).encode());
        let Racer { lesson, chain, gait, gain, .. } = self;
        let raced = Raced { lesson, chain, gait, gain, place, genotype, measured };
        (outcome.status == Status::Completed).then_some((raced, controller))
    }
}

impl Repertoire {
    pub(super) fn new(raced: Vec<(Raced, Controller)>) -> Repertoire {
        Repertoire { raced }
    }

    /// From a checkpoint.
    ///
    /// # Errors
    /// A controller of no lesson, or none.
    pub(super) fn read(raced: Vec<Raced>, lessons: &[Lesson]) -> Result<Repertoire, RestoreError> {
        let read = |(index, raced): (usize, Raced)| {
            require((raced.lesson as usize) < lessons.len(), "it has a controller of no lesson")?;
            let genotype = Genotype::decode(&raced.genotype.0)
                .map_err(|source| RestoreError::Genotype { index, source })?;
            match genotype {
                Genotype::Controller(controller) => Ok((raced, controller)),
                _ => Err(RestoreError::Unfit("it holds another kind of genotype")),
            }
        };
        let raced = raced.into_iter().enumerate().map(read).collect::<Result<_, _>>()?;
        Ok(Repertoire { raced })
    }

    pub(super) fn written(&self) -> Vec<Raced> {
        self.raced.iter().map(|(raced, _)| raced.clone()).collect()
    }

    pub(super) fn len(&self) -> usize {
        self.raced.len()
    }

    /// A set for each chain's swim, with the turn that bends it sharpest; none where nothing swims or nothing
    /// turns.
    pub(super) fn sets(&self, chains: u32, lessons: &[Lesson]) -> Vec<Individual> {
        (0..chains).filter_map(|gait| self.set(gait, lessons)).collect()
    }

    fn set(&self, gait: u32, lessons: &[Lesson]) -> Option<Individual> {
        let of = |teaches: Teaches| {
            self.raced.iter().filter(move |(raced, _)| {
                raced.gait == gait && lessons[raced.lesson as usize].teaches == teaches
            })
        };
        let sharpest = of(Teaches::Turn).map(|(raced, _)| raced).reduce(|sharpest, raced| {
            if raced.measured > sharpest.measured { raced } else { sharpest } // of equals the first
        })?;
        let turn = (sharpest.lesson, sharpest.chain);
        let turns = of(Teaches::Turn).filter(|(raced, _)| (raced.lesson, raced.chain) == turn);
        let calibrated = |(raced, controller): &(Raced, Controller)| Calibrated {
            name: raced.name(),
            controller: controller.clone(),
            measured: raced.measured,
        };
        let set = ControllerSet::assembled(
            of(Teaches::Swim).map(calibrated).collect(),
            turns.map(calibrated).collect(),
        )?;
        let parents = [(&set.swims, "swim"), (&set.turns, "turn")].map(|(map, role)| {
            let parent = |entry: &Calibrated| {
                let (raced, _) = self.raced.iter().find(|(raced, _)| raced.name() == entry.name)?;
                Some(Parent { place: raced.place, role: role.to_owned() })
            };
            map.iter().filter_map(parent).collect::<Vec<_>>()
        });
        let fastest = |map: &[Calibrated]| map.last().map_or(Value::Null, |entry| json!(entry.measured));
        let traits = json!({
            "gait": gait,
            "turn": sharpest.chain,
            "swims": set.swims.len(),
            "turns": set.turns.len(),
            "fastest": fastest(&set.swims),
            "sharpest": fastest(&set.turns),
        });
        Some(Individual {
            genotype: Genotype::ControllerSet(set).encode(),
            parents: parents.concat(),
            operator: "assemble".to_owned(),
            traits,
            inherits: None,
        })
    }
}

impl Raced {
    /// Its name in a set.
    fn name(&self) -> String {
        format!("lesson {} chain {} gait {} gain {}", self.lesson, self.chain, self.gait, self.gain)
    }
}

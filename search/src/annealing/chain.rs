//! Annealing chains: what each is at, what it tries next and whether it goes there. They know
//! each other as little as they know who evaluates them.

use super::{Cooling, Schedule};
use crate::checkpoint::{GenotypeBytes, RestoreError, require};
use crate::{Individual, Parent, Place};
use creatures::fish::{Genotype, Samples};
use creatures::math::log;
use creatures::random::Stream;
use creatures::{Outcome, Status};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// A state of a chain: samples, what they are worth and where they stand in the lineage.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State {
    pub(crate) samples: Samples,
    /// E; −∞ of one that could not be lived.
    pub(crate) value: f64,
    pub(crate) place: Place,
}

/// One chain between two steps.
#[derive(Debug, Clone, PartialEq)]
struct Chain {
    current: State,
    best: State,
}

/// A candidate that was asked for.
#[derive(Debug, Clone, PartialEq)]
struct Candidate {
    samples: Samples,
    /// E_min, what it needs to be accepted.
    threshold: f64,
}

/// As a checkpoint has it: E and place of the current and of the best state of each chain with its bytes, after
/// so many generations told.
pub(crate) type Standing = (u32, Vec<[Written; 2]>);

/// A state in a checkpoint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Written {
    genotype: GenotypeBytes,
    value: f64,
    place: Place,
}

/// All chains of a stage, lesson by lesson.
#[derive(Debug)]
pub(crate) struct Chains {
    schedule: Schedule,
    /// Of each lesson its temperatures and its steps.
    lessons: Vec<(Cooling, u32)>,
    seed: u64,
    stage: u32,
    /// Generations told; the first is that of the random states.
    told: u32,
    chains: Vec<Chain>,
    asked: Option<Vec<Candidate>>,
}

impl Chains {
    /// Before the first generation; a lesson is its temperatures and its steps.
    pub(crate) fn new(schedule: &Schedule, lessons: &[(Cooling, u32)], seed: u64, stage: u32) -> Chains {
        Chains {
            schedule: schedule.clone(),
            lessons: lessons.to_vec(),
            seed,
            stage,
            told: 0,
            chains: Vec::new(),
            asked: None,
        }
    }

    /// Whether every chain has made its last step.
    pub(crate) fn over(&self) -> bool {
        self.told > self.schedule.steps
    }

    /// The best state of each chain, lesson by lesson; none before the first generation.
    pub(crate) fn best(&self) -> impl Iterator<Item = &State> {
        self.chains.iter().map(|chain| &chain.best)
    }

    /// The candidates of the next step, one a chain; nobody when all steps are made.
    pub(crate) fn ask(&mut self) -> Vec<Individual> {
        if self.over() {
            return Vec::new();
        }
        let count = self.lessons.len() as u32 * self.schedule.chains;
        let (individuals, asked) = (0..count).map(|index| self.propose(index)).unzip();
        self.asked = Some(asked);
        individuals
    }

    /// Takes the outcomes of the candidates and says how many were accepted, and what is best.
    pub(crate) fn tell(&mut self, outcomes: &[Option<Outcome>]) -> Map<String, Value> {
        let asked = self.asked.take().expect("a generation is told after it was asked for");
        assert_eq!(asked.len(), outcomes.len(), "one outcome a candidate");
        let mut accepted = 0;
        for (index, (candidate, outcome)) in (0..).zip(asked.into_iter().zip(outcomes)) {
            let place = self.place(index);
            let threshold = candidate.threshold;
            // Who was stopped or set aside has reached nothing (AF-8).
            let lived = outcome.as_ref().filter(|outcome| outcome.status == Status::Completed);
            let value = lived.map_or(f64::NEG_INFINITY, |outcome| outcome.fitness);
            let state = State { samples: candidate.samples, value, place };
            let Some(chain) = self.chains.get_mut(index as usize) else {
                self.chains.push(Chain { best: state.clone(), current: state });
                continue;
            };
            if value > chain.best.value {
                chain.best = state.clone();
            }
            if value >= threshold && value > f64::NEG_INFINITY {
                chain.current = state;
                accepted += 1;
            }
        }
        self.told += 1;
        self.notes(accepted)
    }

    fn notes(&self, accepted: u32) -> Map<String, Value> {
        let mut notes = Map::new();
        notes.insert("step".to_owned(), json!(self.told - 1));
        notes.insert("accepted".to_owned(), json!(accepted));
        let best = self.chains.iter().map(|chain| chain.best.value).fold(f64::NEG_INFINITY, f64::max);
        notes.insert("best".to_owned(), json!(best)); // null while nobody has completed
        let current: f64 = self.chains.iter().map(|chain| chain.current.value).sum();
        notes.insert("mean_current".to_owned(), json!(current / self.chains.len() as f64));
        notes
    }

    /// Where a chain's candidate stands in the generation not yet told.
    fn place(&self, index: u32) -> Place {
        Place { stage: self.stage, generation: self.told + 1, index }
    }

    /// The candidate of a chain: random samples at first, then its current state with some samples moved.
    fn propose(&self, index: u32) -> (Individual, Candidate) {
        let lesson = index / self.schedule.chains;
        let (temperature, lesson_steps) = self.lessons[lesson as usize];
        let Schedule { encoding, samples: count, steps, moves, deviation, .. } = self.schedule;
        let place = self.place(index);
        let Some(Chain { current, .. }) = self.chains.get(index as usize) else {
            let stream = &mut place.stream(self.seed, "founder");
            let samples = Samples::random(lesson, encoding, count, lesson_steps, stream);
            let threshold = f64::NEG_INFINITY;
            let traits = self.traits(index, None);
            return (individual(&samples, Vec::new(), "random", traits), Candidate { samples, threshold });
        };
        let stream = &mut place.stream(self.seed, "anneal");
        let (t, w) = (temperature.at(self.told, steps), deviation.at(self.told, steps));
        let mut samples = current.samples.clone();
        for _ in 0..moves {
            move_one(&mut samples.values, w, stream);
        }
        // Drawn before dispatch, uniform in (0, 1], so that acceptance needs the candidate's value alone.
        let ln_xi = log(1.0 - stream.unit());
        let threshold = threshold(current.value, t, ln_xi);
        let traits = self.traits(index, Some([t, ln_xi, threshold]));
        let parent = Parent { place: current.place, role: "only".to_owned() };
        (individual(&samples, vec![parent], "anneal", traits), Candidate { samples, threshold })
    }

    /// Chain, lesson and step, then T, ln ξ and E_min of a candidate that may be rejected.
    fn traits(&self, index: u32, rule: Option<[f64; 3]>) -> Value {
        let [temperature, ln_xi, threshold] = rule.map_or([None; 3], |rule| rule.map(Some));
        json!({
            "chain": index % self.schedule.chains,
            "lesson": index / self.schedule.chains,
            "step": self.told,
            "temperature": temperature,
            "ln_xi": ln_xi,
            "threshold": threshold,
        })
    }

    /// All that is needed to go on from here.
    pub(crate) fn standing(&self) -> Standing {
        let write = |state: &State| Written {
            genotype: GenotypeBytes(Genotype::MuscleSamples(state.samples.clone()).encode()),
            value: state.value,
            place: state.place,
        };
        (self.told, self.chains.iter().map(|chain| [write(&chain.current), write(&chain.best)]).collect())
    }

    /// Goes to where a checkpoint was taken.
    ///
    /// # Errors
    /// A standing that these chains cannot be in.
    pub(crate) fn restore(&mut self, (told, written): Standing) -> Result<(), RestoreError> {
        let count = if told == 0 { 0 } else { self.lessons.len() * self.schedule.chains as usize };
        require(written.len() == count, "it has another number of chains")?;
        require(told <= self.schedule.steps + 1, "its chains are longer")?;
        let read = |index: usize, written: Written| {
            let genotype = Genotype::decode(&written.genotype.0)
                .map_err(|source| RestoreError::Genotype { index, source })?;
            let Genotype::MuscleSamples(samples) = genotype else {
                return Err(RestoreError::Unfit("it holds another kind of genotype"));
            };
            let Written { value, place, .. } = written;
            Ok(State { samples, value, place })
        };
        let chain = |(index, [current, best]): (usize, [Written; 2])| {
            Ok(Chain { current: read(index, current)?, best: read(index, best)? })
        };
        self.chains = written.into_iter().enumerate().map(chain).collect::<Result<_, RestoreError>>()?;
        self.told = told;
        self.asked = None;
        Ok(())
    }
}

fn individual(samples: &Samples, parents: Vec<Parent>, operator: &str, traits: Value) -> Individual {
    let genotype = Genotype::MuscleSamples(samples.clone()).encode();
    Individual { genotype, parents, operator: operator.to_owned(), traits, inherits: None }
}

/// E_min = E_cur + T ln ξ.
fn threshold(current: f64, temperature: f64, ln_xi: f64) -> f64 {
    current + temperature * ln_xi
}

/// Moves one of the values, any of them, by a normal deviate; what leaves [0, 1] is reflected back.
fn move_one(values: &mut [f64], deviation: f64, stream: &mut Stream) {
    let index = stream.below(values.len());
    let moved = (values[index] + deviation * stream.normal()).rem_euclid(2.0);
    values[index] = if moved > 1.0 { 2.0 - moved } else { moved };
}

#[cfg(test)]
mod tests {
    use super::*;
    use creatures::random::stream;

    /// T-15
    #[test]
    fn a_worse_state_is_accepted_within_the_temperature() {
        assert!((threshold(0.100, 0.005, log(0.3)) - 0.0939801359).abs() < 1e-10);
    }

    ///
    #[test]
    fn moves_are_reflected_into_range_and_hit_every_sample() {
        let mut values = vec![0.5; 6];
        let mut stream = stream(1, [0, 0, 0], "moves");
        let mut hit = [false; 6];
        for _ in 0..2000 {
            let before = values.clone();
            move_one(&mut values, 0.5, &mut stream);
            let changed: Vec<usize> = (0..6).filter(|&index| values[index] != before[index]).collect();
            assert!(changed.len() <= 1);
            changed.iter().for_each(|&index| hit[index] = true);
            assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "{values:?}");
        }
        assert_eq!(hit, [true; 6]);
    }
}

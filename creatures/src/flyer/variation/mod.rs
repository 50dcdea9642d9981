//! How flyers vary: founders, crossover, grafting, mutation (F-11, F-62..F-65). It selects nobody and keeps
//! every genotype legal.

mod founder;
mod mating;
mod mutation;
mod sources;

use super::Function;
use super::genotype::NEURONS_MAX;
use crate::SpecError;
use crate::random::Stream;
use serde::{Deserialize, Serialize};

/// The functions that oscillate, and are drawn more often (F-11).
const OSCILLATORS: [Function; 3] = [Function::Sin, Function::Cos, Function::SawWave];

/// Probabilities of the mutations and ranges of the draws. A mutation has the name of its probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Most neurons of a node, 2 to 4.
    pub max_neurons: usize,
    /// How much likelier sin, cos and saw-wave are drawn than another function, at most 1000.
    pub oscillators: usize,
    /// Probability that a drawn input crosses to the other wing, if it joins wing segments.
    pub cross: f64,
    /// Probability that a length, radius or angle moves.
    pub scalar: f64,
    /// How far: the standard deviation as a share of its range.
    pub sigma: f64,
    /// Probability that a wing segment changes to the other end of its parent.
    pub lpercent: f64,
    /// Probability that a neuron gets another function.
    pub function: f64,
    /// Probability that a neuron gets another delay.
    pub delay: f64,
    /// Probability that a node gets a neuron, if it may.
    pub add_neuron: f64,
    /// Probability that a node loses a neuron, if it has one.
    pub remove_neuron: f64,
    /// Probability that an input is drawn anew.
    pub redraw_input: f64,
    /// Probability that a neuron or effector gets an input, if it may.
    pub add_input: f64,
    /// Probability that a neuron or effector loses an input, if it has two or more.
    pub remove_input: f64,
    /// Probability that a wing gets a segment, if it may.
    pub add_segment: f64,
    /// Probability that a wing loses a segment, if it has two or more.
    pub remove_segment: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            max_neurons: NEURONS_MAX,
            oscillators: 3,
            cross: 0.10,
            scalar: 0.10,
            sigma: 0.10,
            lpercent: 0.05,
            function: 0.05,
            delay: 0.05,
            add_neuron: 0.05,
            remove_neuron: 0.05,
            redraw_input: 0.05,
            add_input: 0.02,
            remove_input: 0.02,
            add_segment: 0.05,
            remove_segment: 0.05,
        }
    }
}

impl Settings {
    /// Checks that every draw gives a legal genotype.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        if !(2..=NEURONS_MAX).contains(&self.max_neurons) {
            let problem = format!("{} is not within 2 to {NEURONS_MAX}", self.max_neurons);
            return Err(SpecError::new("max_neurons", problem));
        }
        if self.oscillators > 1000 {
            return Err(SpecError::new("oscillators", format!("{} is above 1000", self.oscillators)));
        }
        let shares = [
            ("cross", self.cross),
            ("scalar", self.scalar),
            ("sigma", self.sigma),
            ("lpercent", self.lpercent),
            ("function", self.function),
            ("delay", self.delay),
            ("add_neuron", self.add_neuron),
            ("remove_neuron", self.remove_neuron),
            ("redraw_input", self.redraw_input),
            ("add_input", self.add_input),
            ("remove_input", self.remove_input),
            ("add_segment", self.add_segment),
            ("remove_segment", self.remove_segment),
        ];
        match shares.iter().find(|(_, share)| !(0.0..=1.0).contains(share)) {
            Some((key, share)) => Err(SpecError::new(*key, format!("{share} is not within [0, 1]"))),
            None => Ok(()),
        }
    }

    /// A function, the oscillating ones with their weight, the others with 1.
    fn draw_function(&self, stream: &mut Stream) -> Function {
        let weight = |function| if OSCILLATORS.contains(&function) { self.oscillators } else { 1 };
        let mut draw = stream.below(Function::ALL.map(weight).iter().sum());
        for function in Function::ALL {
            match draw.checked_sub(weight(function)) {
                Some(rest) => draw = rest,
                None => return function,
            }
        }
        unreachable!("a draw is below the sum of the weights")
    }
}

#[cfg(test)]
mod tests;

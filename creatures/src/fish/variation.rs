//! How controllers vary in a population: every number by a normal deviate of its bound's width, and whole
//! muscle segments between two parents. Who breeds is the search's business.

use super::body::MUSCLES;
use super::controller::{Controller, OSCILLATIONS_MAX};
use super::samples::Encoding;
use crate::SpecError;
use crate::math::wrap_angle;
use crate::random::Stream;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::ops::Range;

/// Bounds of ω, A, α and φ.
const FREQUENCY: Range<f64> = 0.3..6.0;
const AMPLITUDE: Range<f64> = 0.0..0.75;
const OFFSET: Range<f64> = 0.0..1.0;
const PHASE: Range<f64> = -PI..PI;

/// Muscles of a segment, which are inherited together.
const SEGMENT: usize = 4;

/// How controllers are made and varied: `[search.variation]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Variation {
    /// Which muscles are alike.
    pub encoding: Encoding,
    /// M of every controller.
    pub oscillations: u32,
    /// Probability that a number is mutated.
    pub rate: f64,
    /// Standard deviation of a mutation, by the width of the number's bounds.
    pub strength: f64,
}

impl Default for Variation {
    fn default() -> Self {
        Variation { encoding: Encoding::default(), oscillations: 1, rate: 0.1, strength: 0.1 }
    }
}

impl Variation {
    /// Checks every number.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        if !(1..=OSCILLATIONS_MAX as u32).contains(&self.oscillations) {
            let problem = format!("{} is not within 1 to {OSCILLATIONS_MAX}", self.oscillations);
            return Err(SpecError::new("oscillations", problem));
        }
        for (key, value) in [("rate", self.rate), ("strength", self.strength)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(SpecError::new(key, format!("{value} is not within 0 to 1")));
            }
        }
        Ok(())
    }

    /// A founder: every number uniform within its bounds.
    pub fn random(&self, stream: &mut Stream) -> Controller {
        let m = self.oscillations as usize;
        let mut draw = |count: usize, bounds: Range<f64>| -> Vec<f64> {
            (0..count).map(|_| stream.between(bounds.start, bounds.end)).collect()
        };
        let functions = self.encoding.functions();
        let frequency = draw(m, FREQUENCY);
        let offset = draw(functions, OFFSET);
        let amplitude = draw(functions * m, AMPLITUDE);
        let phase = draw(functions * m, PHASE);
        Controller {
            frequency,
            offset: self.by_muscle(&offset, 1),
            amplitude: self.by_muscle(&amplitude, m),
            phase: self.by_muscle(&phase, m),
        }
    }

    /// Mutates, and says whether any number was.
    pub fn mutate(&self, controller: &mut Controller, stream: &mut Stream) -> bool {
        let m = controller.oscillations();
        let before = controller.clone();
        for w in &mut controller.frequency {
            self.mutate_one(w, &FREQUENCY, stream);
        }
        for (values, width, bounds) in [
            (&mut controller.offset, 1, &OFFSET),
            (&mut controller.amplitude, m, &AMPLITUDE),
            (&mut controller.phase, m, &PHASE),
        ] {
            let mut functions = self.by_function(values, width);
            for value in &mut functions {
                self.mutate_one(value, bounds, stream);
            }
            *values = self.by_muscle(&functions, width);
        }
        *controller != before
    }

    /// Phases go round, all else is reflected into its bounds. Two draws a number at most, the first always.
    fn mutate_one(&self, value: &mut f64, bounds: &Range<f64>, stream: &mut Stream) {
        if !stream.chance(self.rate) {
            return;
        }
        let width = bounds.end - bounds.start;
        let moved = *value + self.strength * width * stream.normal();
        *value = if *bounds == PHASE { wrap_angle(moved) } else { reflect(moved, bounds) };
    }

    /// (functions × width) as (12 × width): what muscles share is written for each.
    fn by_muscle(&self, functions: &[f64], width: usize) -> Vec<f64> {
        let of = |muscle: usize| functions[self.encoding.function(muscle) * width..][..width].to_vec();
        (0..MUSCLES).flat_map(of).collect()
    }

    /// The inverse: of muscles that share a function the first one's.
    fn by_function(&self, muscles: &[f64], width: usize) -> Vec<f64> {
        let first = |function: usize| (0..MUSCLES).find(|&muscle| self.encoding.function(muscle) == function);
        let of = |function: usize| {
            let muscle = first(function).expect("every function has a muscle");
            muscles[muscle * width..][..width].to_vec()
        };
        (0..self.encoding.functions()).flat_map(of).collect()
    }
}

/// Each segment of either parent, by a fair coin; the first one's frequencies.
pub fn crossover(first: &Controller, second: &Controller, stream: &mut Stream) -> Controller {
    let mut child = first.clone();
    for segment in 0..MUSCLES / SEGMENT {
        if stream.chance(0.5) {
            copy_segment(&mut child, segment, second, segment);
        }
    }
    child
}

/// The first parent with one segment of the second in place of any of its own.
pub fn graft(first: &Controller, second: &Controller, stream: &mut Stream) -> Controller {
    let mut child = first.clone();
    let [to, from] = [0; 2].map(|_| stream.below(MUSCLES / SEGMENT));
    copy_segment(&mut child, to, second, from);
    child
}

fn copy_segment(child: &mut Controller, to: usize, from: &Controller, segment: usize) {
    let m = child.oscillations();
    for (target, source, width) in [
        (&mut child.offset, &from.offset, SEGMENT),
        (&mut child.amplitude, &from.amplitude, SEGMENT * m),
        (&mut child.phase, &from.phase, SEGMENT * m),
    ] {
        target[to * width..(to + 1) * width].copy_from_slice(&source[segment * width..(segment + 1) * width]);
    }
}

/// Back into bounds, as a ball from their walls.
fn reflect(value: f64, bounds: &Range<f64>) -> f64 {
    let width = bounds.end - bounds.start;
    let way = (value - bounds.start).rem_euclid(2.0 * width);
    bounds.start + if way > width { 2.0 * width - way } else { way }
}

#[cfg(test)]
mod tests;

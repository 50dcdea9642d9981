//! Muscle functions by samples: what annealing varies, and how it is read between the samples. It
//! judges nothing.

use super::body::MUSCLES;
use super::mechanics::TIME_STEP;
use super::motor::Actuation;
use crate::DecodeError;
use crate::random::Stream;
use serde::{Deserialize, Serialize};

/// Samples of a function as published.
pub const COUNT: u32 = 15;
/// Steps of practice as published: 15 samples then resolve the useful band of beats.
pub const STEPS: u32 = 182;
/// Legal numbers of samples.
pub const COUNTS: std::ops::RangeInclusive<u32> = 4..=1000;
/// Legal steps of practice.
pub const HORIZONS: std::ops::RangeInclusive<u32> = 2..=100_000;

/// Which muscles share a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// One function a muscle.
    Full,
    /// One function a side of each segment: top and bottom contract alike, and the motion stays planar.
    #[default]
    Tied,
}

impl Encoding {
    /// Functions of a fish.
    pub fn functions(self) -> usize {
        match self {
            Encoding::Full => MUSCLES,
            Encoding::Tied => MUSCLES / 2,
        }
    }

    /// The function of a muscle, both from 0.
    pub fn function(self, muscle: usize) -> usize {
        match self {
            Encoding::Full => muscle,
            Encoding::Tied => 2 * (muscle / 4) + [0, 1, 1, 0][muscle % 4],
        }
    }
}

/// How a function goes between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// A natural cubic spline.
    #[default]
    Spline,
    /// Straight lines.
    Linear,
}

/// The genotype of practice: samples of every muscle function.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Samples {
    /// Which lesson of the task they are practised for; 0 where there is one.
    pub lesson: u32,
    /// Which muscles share a function.
    pub encoding: Encoding,
    /// N, samples a function, evenly from the beginning to the end.
    pub count: u32,
    /// From the first sample to the last, steps; what comes later is the same again.
    pub steps: u32,
    /// (functions × N), each in [0, 1].
    pub values: Vec<f64>,
}

impl Samples {
    /// Uniform draws.
    pub fn random(lesson: u32, encoding: Encoding, count: u32, steps: u32, stream: &mut Stream) -> Samples {
        let values = (0..encoding.functions() * count as usize).map(|_| stream.unit()).collect();
        Samples { lesson, encoding, count, steps, values }
    }

    /// AF-3
    ///
    /// # Errors
    /// The field that is wrong, of values with their index.
    pub fn check(&self) -> Result<(), DecodeError> {
        if !COUNTS.contains(&self.count) {
            let problem = format!("{} is not within {} to {}", self.count, COUNTS.start(), COUNTS.end());
            return Err(DecodeError::illegal("samples.count", problem));
        }
        if !HORIZONS.contains(&self.steps) {
            let problem = format!("{} is not within {} to {}", self.steps, HORIZONS.start(), HORIZONS.end());
            return Err(DecodeError::illegal("samples.steps", problem));
        }
        let expected = self.encoding.functions() * self.count as usize;
        if self.values.len() != expected {
            let problem = format!("{} values where {expected} are needed", self.values.len());
            return Err(DecodeError::illegal("samples.values", problem));
        }
        match self.values.iter().position(|value| !(0.0..=1.0).contains(value)) {
            Some(index) => Err(DecodeError::illegal(
                format!("samples.values[{index}]"),
                format!("{} is not within 0 to 1", self.values[index]),
            )),
            None => Ok(()),
        }
    }

    /// τ, time between samples.
    pub fn spacing(&self) -> f64 {
        f64::from(self.steps) * TIME_STEP / f64::from(self.count - 1)
    }

    /// The samples of one muscle, both from 0.
    pub fn of_muscle(&self, muscle: usize) -> &[f64] {
        let count = self.count as usize;
        let first = self.encoding.function(muscle) * count;
        &self.values[first..first + count]
    }
}

/// Samples ready to be read step by step.
#[derive(Debug, Clone)]
pub struct MuscleFunctions<'a> {
    samples: &'a Samples,
    interpolation: Interpolation,
    /// (functions × N), second derivatives at the samples by τ².
    bends: Vec<f64>,
}

impl<'a> MuscleFunctions<'a> {
    /// Of legal samples.
    pub fn new(samples: &'a Samples, interpolation: Interpolation) -> MuscleFunctions<'a> {
        let bends = samples.values.chunks_exact(samples.count as usize).flat_map(bends).collect();
        MuscleFunctions { samples, interpolation, bends }
    }

    /// What the muscles do at the end of a step, from 1: the functions' values, clamped.
    pub fn at(&self, step: u32) -> Actuation {
        let count = self.samples.count as usize;
        let step = (step - 1) % self.samples.steps + 1;
        let place = f64::from(step) / f64::from(self.samples.steps) * (count - 1) as f64;
        let functions = self.samples.values.chunks_exact(count).zip(self.bends.chunks_exact(count));
        let mut values = [0.0; MUSCLES];
        for (value, (samples, bends)) in values.iter_mut().zip(functions) {
            *value = match self.interpolation {
                Interpolation::Spline => spline(samples, bends, place),
                Interpolation::Linear => linear(samples, place),
            }
            .clamp(0.0, 1.0);
        }
        std::array::from_fn(|muscle| values[self.samples.encoding.function(muscle)])
    }
}

/// The sample on the left of a place, counted in samples, and how far on the place is.
fn locate(samples: &[f64], place: f64) -> (usize, f64) {
    let left = (place as usize).min(samples.len() - 2);
    (left, place - left as f64)
}

fn linear(samples: &[f64], place: f64) -> f64 {
    let (left, way) = locate(samples, place);
    samples[left] + way * (samples[left + 1] - samples[left])
}

fn spline(samples: &[f64], bends: &[f64], place: f64) -> f64 {
    let (left, b) = locate(samples, place);
    let a = 1.0 - b;
    let bend = (a * a * a - a) * bends[left] + (b * b * b - b) * bends[left + 1];
    a * samples[left] + b * samples[left + 1] + bend / 6.0
}

/// Second derivatives of the natural cubic spline by the square of the samples' spacing: the tridiagonal system
/// `M₋ + 4 M + M₊ = 6 (y₋ − 2 y + y₊)`, with none at either end.
fn bends(samples: &[f64]) -> Vec<f64> {
    let count = samples.len();
    let (mut bends, mut ratios) = (vec![0.0; count], vec![0.0; count]);
    for i in 1..count - 1 {
        let pivot = 4.0 - ratios[i - 1];
        ratios[i] = 1.0 / pivot;
        let right = 6.0 * (samples[i - 1] - 2.0 * samples[i] + samples[i + 1]);
        bends[i] = (right - bends[i - 1]) / pivot;
    }
    for i in (1..count - 1).rev() {
        bends[i] -= ratios[i] * bends[i + 1];
    }
    bends
}

#[cfg(test)]
mod tests;

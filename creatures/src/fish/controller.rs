//! Controllers: muscle functions abstracted to an offset and a few oscillations common to all muscles (A-41,
//! How they are found is `abstraction`'s business.

use super::body::MUSCLES;
use super::mechanics::TIME_STEP;
use super::motor::Actuation;
use crate::DecodeError;
use crate::math::{atan2, cos, sin, wrap_angle};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The most oscillations of a controller: as many frequencies as 15 samples tell apart.
pub const OSCILLATIONS_MAX: usize = 7;

/// One controller: `u_a(t) = clip(α_a + Σ A_am cos(θ_m + φ_am))`, θ_m growing by ω_m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// (M), ω, rad by time.
    pub frequency: Vec<f64>,
    /// (12), α, in [0, 1].
    pub offset: Vec<f64>,
    /// (12 × M), A, in [0, 1], muscle by muscle.
    pub amplitude: Vec<f64>,
    /// (12 × M), φ, rad in [−π, π], muscle by muscle.
    pub phase: Vec<f64>,
}

/// Left is positive, in the order of a segment's corners.
const SIDES: [f64; 4] = [1.0, -1.0, -1.0, 1.0];

/// θ of every oscillation, rad.
pub type Phases = [f64; OSCILLATIONS_MAX];

impl Controller {
    /// M.
    pub fn oscillations(&self) -> usize {
        self.frequency.len()
    }

    /// AF-4, AF-20
    ///
    /// # Errors
    /// The field that is wrong, below a path.
    pub fn check(&self, path: &str) -> Result<(), DecodeError> {
        let refuse =
            |field: &str, problem: String| Err(DecodeError::illegal(format!("{path}.{field}"), problem));
        let m = self.oscillations();
        if !(1..=OSCILLATIONS_MAX).contains(&m) {
            return refuse("frequency", format!("{m} oscillations where 1 to {OSCILLATIONS_MAX} are legal"));
        }
        for (field, found, expected) in [
            ("offset", self.offset.len(), MUSCLES),
            ("amplitude", self.amplitude.len(), MUSCLES * m),
            ("phase", self.phase.len(), MUSCLES * m),
        ] {
            if found != expected {
                return refuse(field, format!("{found} values where {expected} are needed"));
            }
        }
        let most = PI / TIME_STEP;
        if let Some(index) = self.frequency.iter().position(|&w| !(w > 0.0 && w <= most)) {
            let problem = format!("{} is not within 0 to {most:.1}, 0 left out", self.frequency[index]);
            return refuse(&format!("frequency[{index}]"), problem);
        }
        for (field, values, range) in [
            ("offset", &self.offset, 0.0..=1.0),
            ("amplitude", &self.amplitude, 0.0..=1.0),
            ("phase", &self.phase, -PI..=PI),
        ] {
            if let Some(index) = values.iter().position(|value| !range.contains(value)) {
                let problem = format!("{} is not within {} to {}", values[index], range.start(), range.end());
                return refuse(&format!("{field}[{index}]"), problem);
            }
        }
        Ok(())
    }

    /// What the muscles do at some phases.
    pub fn actuation(&self, phases: &Phases) -> Actuation {
        let m = self.oscillations();
        std::array::from_fn(|muscle| {
            let range = muscle * m..(muscle + 1) * m;
            let oscillations = self.amplitude[range.clone()].iter().zip(&self.phase[range]).zip(phases);
            let sum: f64 = oscillations.map(|((a, shift), phase)| a * cos(phase + shift)).sum();
            (self.offset[muscle] + sum).clamp(0.0, 1.0)
        })
    }

    /// Every amplitude times a gain, at most 1.
    #[must_use]
    pub fn amplified(&self, gain: f64) -> Controller {
        let amplitude = self.amplitude.iter().map(|a| if gain * a < 1.0 { gain * a } else { 1.0 }).collect();
        Controller { amplitude, ..self.clone() }
    }

    /// Left and right exchanged.
    #[must_use]
    pub fn mirrored(&self) -> Controller {
        let m = self.oscillations();
        let image = |muscle: usize| muscle - muscle % 4 + [1, 0, 3, 2][muscle % 4];
        let swapped = |values: &[f64], width: usize| -> Vec<f64> {
            (0..MUSCLES).flat_map(|muscle| values[image(muscle) * width..][..width].to_vec()).collect()
        };
        Controller {
            frequency: self.frequency.clone(),
            offset: swapped(&self.offset, 1),
            amplitude: swapped(&self.amplitude, m),
            phase: swapped(&self.phase, m),
        }
    }

    /// This straight swim bent as a turn is: per segment the left's mean offset of the turn exceeds the right's by
    /// some `2 d`, and here the left gets `gain · d` more and the right as much less.
    #[must_use]
    pub fn bent(&self, turn: &Controller, gain: f64) -> Controller {
        let mut bent = self.clone();
        for (segment, offsets) in bent.offset.chunks_exact_mut(4).enumerate() {
            let sides = turn.offset[4 * segment..4 * segment + 4].iter().zip(SIDES);
            let d = sides.map(|(offset, side)| side * offset).sum::<f64>() / 4.0;
            for (offset, side) in offsets.iter_mut().zip(SIDES) {
                *offset = (*offset + side * gain * d).clamp(0.0, 1.0);
            }
        }
        bent
    }

    /// The same controller later, by an angle of its first oscillation, rad.
    #[must_use]
    pub fn later(&self, angle: f64) -> Controller {
        let m = self.oscillations();
        let shift = |(index, phase): (usize, &f64)| {
            wrap_angle(phase + angle * self.frequency[index % m] / self.frequency[0])
        };
        Controller { phase: self.phase.iter().enumerate().map(shift).collect(), ..self.clone() }
    }

    /// The same controller at such a time that its first oscillation agrees best with another one's over all
    /// muscles, so that what lies between the two keeps their coordination.
    #[must_use]
    pub fn aligned(&self, to: &Controller) -> Controller {
        let (m, n) = (self.oscillations(), to.oscillations());
        let part = |of: fn(f64) -> f64| {
            let term = |muscle: usize| {
                let weight = self.amplitude[muscle * m] * to.amplitude[muscle * n];
                weight * of(to.phase[muscle * n] - self.phase[muscle * m])
            };
            (0..MUSCLES).map(term).sum::<f64>()
        };
        self.later(atan2(part(sin), part(cos)))
    }

    /// For a straight swim: left and right beat against each other alike, and bend to neither side.
    ///
    /// Per segment `z = ((z_TL + z_BL) − (z_TR + z_BR)) / 4` of the complex amplitudes; the left gets z, the right
    /// −z, and all four the mean offset.
    #[must_use]
    pub fn symmetrised(&self) -> Controller {
        let m = self.oscillations();
        let mut straight = self.clone();
        for segment in 0..MUSCLES / 4 {
            let first = 4 * segment;
            let offset = self.offset[first..first + 4].iter().sum::<f64>() / 4.0;
            straight.offset[first..first + 4].fill(offset);
            for oscillation in 0..m {
                let at = |corner: usize| (first + corner) * m + oscillation;
                let part = |of: fn(f64) -> f64| {
                    let term = |corner: usize| {
                        SIDES[corner] * self.amplitude[at(corner)] * of(self.phase[at(corner)])
                    };
                    (0..4).map(term).sum::<f64>() / 4.0
                };
                let (real, imaginary) = (part(cos), part(sin));
                for (corner, side) in SIDES.into_iter().enumerate() {
                    straight.amplitude[at(corner)] = (real * real + imaginary * imaginary).sqrt();
                    straight.phase[at(corner)] = atan2(side * imaginary, side * real);
                }
            }
        }
        straight
    }

    /// Becomes what lies between two controllers of as many oscillations, `share` of the way from the first to
    /// the second: offset, amplitude and frequency in a straight line, phase along the shorter arc.
    pub fn blend(&mut self, a: &Controller, b: &Controller, share: f64) {
        let line = |to: &mut [f64], a: &[f64], b: &[f64]| {
            for ((to, a), b) in to.iter_mut().zip(a).zip(b) {
                *to = a + share * (b - a);
            }
        };
        line(&mut self.frequency, &a.frequency, &b.frequency);
        line(&mut self.offset, &a.offset, &b.offset);
        line(&mut self.amplitude, &a.amplitude, &b.amplitude);
        for ((to, a), b) in self.phase.iter_mut().zip(&a.phase).zip(&b.phase) {
            *to = wrap_angle(a + share * wrap_angle(b - a));
        }
    }
}

/// Goes on by one step: phases grow by the frequencies, continuous when these change.
pub fn advance(phases: &mut Phases, frequency: &[f64]) {
    for (phase, w) in phases.iter_mut().zip(frequency) {
        *phase = (*phase + w * TIME_STEP) % (2.0 * PI);
    }
}

#[cfg(test)]
pub(crate) mod tests;

//! Abstraction: what is periodic in practised muscle functions, by a discrete Fourier transform. Sums are
//! made here in their fixed order: a general transform picks its algorithm by machine, and so its bits.

use super::body::MUSCLES;
use super::controller::Controller;
use super::samples::Samples;
use crate::math::{atan2, cos, sin};
use std::f64::consts::TAU;

/// Powers below this are rounding, by squares of samples (AF-20).
const NOISE: f64 = 1e-24;

/// The controller of practised samples that keeps at most so many oscillations: those with the largest power
/// summed over muscles, common to all of them, the strongest first.
///
/// Samples that do not swing leave a controller without oscillations, which is none to swim with (AF-20).
pub fn abstracted(samples: &Samples, oscillations: usize) -> Controller {
    let spectra = spectra(samples);
    let mut ranked: Vec<usize> = ranked(&spectra).into_iter().map(|(k, _)| k).collect();
    ranked.truncate(oscillations);

    let n = f64::from(samples.count);
    let kept = |spectrum: &Spectrum| ranked.iter().map(|&k| spectrum[k]).collect::<Vec<_>>();
    let parts: Vec<(f64, f64)> = spectra.iter().flat_map(kept).collect();
    Controller {
        frequency: ranked.iter().map(|&k| frequency(samples, k)).collect(),
        offset: spectra.iter().map(|spectrum| (spectrum[0].0 / n).clamp(0.0, 1.0)).collect(),
        amplitude: parts.iter().map(|(re, im)| 2.0 * (re * re + im * im).sqrt() / n).collect(),
        phase: parts.iter().map(|&(re, im)| atan2(im, re)).collect(),
    }
}

/// The share of what swings, by power summed over muscles, that each frequency has which swings at all: by angle in a
/// unit of time, the strongest first.
pub fn shares(samples: &Samples) -> Vec<(f64, f64)> {
    let ranked = ranked(&spectra(samples));
    let whole: f64 = ranked.iter().map(|(_, power)| power).sum();
    ranked.into_iter().map(|(k, power)| (frequency(samples, k), power / whole)).collect()
}

/// Of one muscle function: real and imaginary part by frequency.
type Spectrum = Vec<(f64, f64)>;

fn spectra(samples: &Samples) -> Vec<Spectrum> {
    (0..MUSCLES).map(|muscle| spectrum(samples.of_muscle(muscle))).collect()
}

/// Every frequency that is more than rounding, with its power summed over muscles, the strongest first.
fn ranked(spectra: &[Spectrum]) -> Vec<(usize, f64)> {
    let power = |k: usize| -> f64 {
        let of_muscle = |spectrum: &Spectrum| {
            let (real, imaginary) = spectrum[k];
            real * real + imaginary * imaginary
        };
        spectra.iter().map(of_muscle).sum()
    };
    let frequencies = 1..spectra.first().map_or(1, Vec::len);
    let mut ranked: Vec<_> = frequencies.map(|k| (k, power(k))).filter(|&(_, power)| power > NOISE).collect();
    ranked.sort_by(|(_, a), (_, b)| b.total_cmp(a)); // stable: of equals the lowest frequency
    ranked
}

/// ω of k beats in all the samples.
fn frequency(samples: &Samples, k: usize) -> f64 {
    TAU * k as f64 / (f64::from(samples.count) * samples.spacing())
}

/// F_k = Σ x_i e^(−2πi k i/N) for k from 0 to below N/2.
fn spectrum(samples: &[f64]) -> Spectrum {
    let count = samples.len();
    let part = |k: usize| {
        let turn = |i: usize| TAU * ((k * i) % count) as f64 / count as f64;
        let real = samples.iter().enumerate().map(|(i, x)| x * cos(turn(i))).sum();
        let imaginary = samples.iter().enumerate().map(|(i, x)| -x * sin(turn(i))).sum();
        (real, imaginary)
    };
    (0..=(count - 1) / 2).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::samples::Encoding;

    fn samples(function: impl Fn(usize, f64) -> f64) -> Samples {
        let values = (0..12).flat_map(|muscle| (0..15).map(move |i| (muscle, f64::from(i))));
        let values = values.map(|(muscle, i)| function(muscle, i)).collect();
        Samples { lesson: 0, encoding: Encoding::Full, count: 15, steps: 182, values }
    }

    /// T-16; the published frequency is for τ = 10/14.
    #[test]
    fn one_oscillation_is_found_exactly() {
        let samples = samples(|_, i| 0.5 + 0.3 * cos(TAU * 3.0 * i / 15.0 + 0.7));
        for k in 1..8 {
            let (re, im) = spectrum(samples.of_muscle(0))[k];
            assert!(k == 3 || 2.0 * (re * re + im * im).sqrt() / 15.0 < 1e-14, "{k}");
        }
        let controller = abstracted(&samples, 1);
        assert!((controller.frequency[0] * samples.spacing() * 14.0 / 10.0 - 1.7592918860).abs() < 1e-9);
        for muscle in 0..12 {
            assert!((controller.offset[muscle] - 0.5).abs() < 1e-14);
            assert!((controller.amplitude[muscle] - 0.3).abs() < 1e-14);
            assert!((controller.phase[muscle] - 0.7).abs() < 1e-13);
        }
    }

    /// power is summed over muscles.
    #[test]
    fn the_strongest_frequencies_of_all_muscles_together_are_kept() {
        let swing = |k: f64, i: f64, a: f64| a * cos(TAU * k * i / 15.0);
        // One muscle swings widely at k = 5, all the others little at k = 2.
        let samples =
            samples(|muscle, i| 0.5 + if muscle == 4 { swing(5.0, i, 0.4) } else { swing(2.0, i, 0.2) });
        let unit = TAU / (15.0 * samples.spacing());
        let frequencies = |m| abstracted(&samples, m).frequency;
        assert_eq!(frequencies(1), [unit * 2.0]);
        assert_eq!(frequencies(2).len(), 2);
        assert!((frequencies(2)[1] - unit * 5.0).abs() < 1e-12);
        assert_eq!(frequencies(7).len(), 2, "the rest is rounding");
        // 11 · 0.2² and 0.4².
        let shares = shares(&samples);
        assert_eq!(shares.iter().map(|(frequency, _)| *frequency).collect::<Vec<_>>(), frequencies(2));
        assert!((shares[0].1 - 0.44 / 0.6).abs() < 1e-12 && (shares[1].1 - 0.16 / 0.6).abs() < 1e-12);
        let two = abstracted(&samples, 2);
        assert!((two.amplitude[2 * 4 + 1] - 0.4).abs() < 1e-14 && two.amplitude[2 * 4].abs() < 1e-14);
    }

    /// AF-20
    #[test]
    fn constant_samples_leave_an_offset_and_nothing_to_swim_with() {
        assert_eq!(shares(&samples(|_, _| 0.3)), []);
        let controller = abstracted(&samples(|_, _| 0.3), 1);
        assert_eq!(controller.oscillations(), 0);
        assert!((controller.offset[0] - 0.3).abs() < 1e-15);
        let error = controller.check("controller").unwrap_err().to_string();
        assert_eq!(error, "genotype field `controller.frequency`: 0 oscillations where 1 to 7 are legal");
    }
}

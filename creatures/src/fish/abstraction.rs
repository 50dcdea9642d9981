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
    let count = samples.count as usize;
    let spectra: Vec<Vec<(f64, f64)>> =
        (0..MUSCLES).map(|muscle| spectrum(samples.of_muscle(muscle))).collect();
    let power = |k: usize| -> f64 {
        let of_muscle = |spectrum: &Vec<(f64, f64)>| {
            let (real, imaginary) = spectrum[k];
            real * real + imaginary * imaginary
        };
        spectra.iter().map(of_muscle).sum()
    };
    let mut ranked: Vec<usize> = (1..=(count - 1) / 2).filter(|&k| power(k) > NOISE).collect();
    ranked.sort_by(|&a, &b| power(b).total_cmp(&power(a))); // stable: of equals the lowest frequency
    ranked.truncate(oscillations);

    let n = count as f64;
    let kept = |spectrum: &Vec<(f64, f64)>| ranked.iter().map(|&k| spectrum[k]).collect::<Vec<_>>();
    let parts: Vec<(f64, f64)> = spectra.iter().flat_map(kept).collect();
    Controller {
        frequency: ranked.iter().map(|&k| TAU * k as f64 / (n * samples.spacing())).collect(),
        offset: spectra.iter().map(|spectrum| (spectrum[0].0 / n).clamp(0.0, 1.0)).collect(),
        amplitude: parts.iter().map(|(re, im)| 2.0 * (re * re + im * im).sqrt() / n).collect(),
        phase: parts.iter().map(|&(re, im)| atan2(im, re)).collect(),
    }
}

/// F_k = Σ x_i e^(−2πi k i/N) for k from 0 to below N/2.
fn spectrum(samples: &[f64]) -> Vec<(f64, f64)> {
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
        let two = abstracted(&samples, 2);
        assert!((two.amplitude[2 * 4 + 1] - 0.4).abs() < 1e-14 && two.amplitude[2 * 4].abs() < 1e-14);
    }

    /// AF-20
    #[test]
    fn constant_samples_leave_an_offset_and_nothing_to_swim_with() {
        let controller = abstracted(&samples(|_, _| 0.3), 1);
        assert_eq!(controller.oscillations(), 0);
        assert!((controller.offset[0] - 0.3).abs() < 1e-15);
        let error = controller.check("controller").unwrap_err().to_string();
        assert_eq!(error, "genotype field `controller.frequency`: 0 oscillations where 1 to 7 are legal");
    }
}

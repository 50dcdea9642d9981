//! What practice is for: the objective of a drill, larger is better. It moves nothing.

use super::body::MUSCLES;
use super::samples::Samples;
use crate::SpecError;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The weights of the objective and what it asks for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Objective {
    /// μ₁, of smoothness.
    pub smoothness_weight: f64,
    /// μ₂, of the criterion.
    pub criterion_weight: f64,
    /// ν₁, of the square of u̇.
    pub rate_weight: f64,
    /// ν₂, of the square of ü.
    pub bend_weight: f64,
    /// Ev.
    pub criterion: Criterion,
}

impl Default for Objective {
    fn default() -> Self {
        Objective {
            smoothness_weight: 1.0,
            criterion_weight: 1.0,
            rate_weight: 1e-3,
            bend_weight: 1e-4,
            criterion: Criterion::Target([0.0, 100.0, 0.0]),
        }
    }
}

/// What is to be achieved by the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Criterion {
    /// Come nearer to a place: (‖c(t₀) − x*‖ − ‖c(t₁) − x*‖)/L, in body lengths.
    Target([f64; 3]),
    /// Get on at a speed, L by time: −|mean speed − v*|/v*. The mean is of the way from start to end.
    Speed(f64),
    /// Keep to a polyline: −mean distance of c(t) to it, in body lengths.
    Path(Vec<[f64; 3]>),
    /// Turn by an angle, degrees, left positive: −|ψ* − Δψ|/|ψ*|.
    HeadingDegrees(f64),
}

/// What a drill saw, from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trace {
    /// c(t₀), world frame.
    pub start: DVec3,
    /// c(t₁).
    pub end: DVec3,
    /// t₁ − t₀.
    pub time: f64,
    /// Δψ, rad in [−π, π), left positive.
    pub heading_change: f64,
    /// Mean distance of c(t) to the criterion's path, at the ends of the steps; 0 without one.
    pub stray: f64,
    /// L.
    pub length: f64,
}

impl Objective {
    /// Checks every number.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        for (key, weight) in [
            ("smoothness_weight", self.smoothness_weight),
            ("criterion_weight", self.criterion_weight),
            ("rate_weight", self.rate_weight),
            ("bend_weight", self.bend_weight),
        ] {
            if !(0.0..=1e6).contains(&weight) {
                return Err(SpecError::new(key, format!("{weight} is not within 0 to 1000000")));
            }
        }
        let refuse = |key: &str, problem: String| Err(SpecError::new(format!("criterion.{key}"), problem));
        let somewhere = |place: &[f64; 3]| place.iter().all(|value| value.abs() <= 1e6);
        match &self.criterion {
            Criterion::Target(place) if !somewhere(place) => {
                refuse("target", format!("{place:?} is nowhere"))
            }
            Criterion::Speed(speed) if !(*speed > 0.0 && *speed <= 10.0) => {
                refuse("speed", format!("{speed} is not within 0 to 10, 0 left out"))
            }
            Criterion::Path(points) if points.len() < 2 || !points.iter().all(somewhere) => {
                refuse("path", "needs two places or more, each somewhere".to_owned())
            }
            Criterion::HeadingDegrees(angle) if !(angle.abs() > 0.0 && angle.abs() <= 180.0) => {
                refuse("heading_degrees", format!("{angle} is not within −180 to 180, 0 left out"))
            }
            _ => Ok(()),
        }
    }

    /// Ev of a drill.
    pub fn criterion_value(&self, trace: &Trace) -> f64 {
        match &self.criterion {
            Criterion::Target(_) => self.progress(trace),
            Criterion::Speed(speed) => {
                let mean = (trace.end - trace.start).length() / trace.time / trace.length;
                -(mean - speed).abs() / speed
            }
            Criterion::Path(_) => -trace.stray / trace.length,
            Criterion::HeadingDegrees(angle) => {
                -(angle - trace.heading_change.to_degrees()).abs() / angle.abs()
            }
        }
    }

    /// How much nearer to the target, in body lengths; without one, the way from the start.
    pub fn progress(&self, trace: &Trace) -> f64 {
        match &self.criterion {
            Criterion::Target(place) => {
                let target = DVec3::from_array(*place);
                ((trace.start - target).length() - (trace.end - target).length()) / trace.length
            }
            _ => (trace.end - trace.start).length() / trace.length,
        }
    }

    /// P, what roughness of the samples costs, over all muscles: `½ (ν₁ Σ (Δu)²/τ + ν₂ Σ (Δ²u)²/τ³)`.
    pub fn roughness(&self, samples: &Samples) -> f64 {
        let of_muscle = |muscle| self.roughness_of(samples.of_muscle(muscle), samples.spacing());
        (0..MUSCLES).map(of_muscle).sum()
    }

    /// The same of one function with its samples τ apart.
    pub fn roughness_of(&self, samples: &[f64], spacing: f64) -> f64 {
        let rates: f64 = samples.windows(2).map(|w| (w[1] - w[0]) * (w[1] - w[0])).sum();
        let bend = |w: &[f64]| {
            let bend = w[2] - 2.0 * w[1] + w[0];
            bend * bend
        };
        let bends: f64 = samples.windows(3).map(bend).sum();
        let cube = spacing * spacing * spacing;
        0.5 * (self.rate_weight * rates / spacing + self.bend_weight * bends / cube)
    }

    /// E = −μ₁ P + μ₂ Ev.
    pub fn value(&self, roughness: f64, criterion_value: f64) -> f64 {
        self.criterion_weight * criterion_value - self.smoothness_weight * roughness
    }
}

/// Distance of a point to a polyline of two points or more.
pub fn distance_to_path(point: DVec3, path: &[[f64; 3]]) -> f64 {
    let to_segment = |ends: &[[f64; 3]]| {
        let (a, b) = (DVec3::from_array(ends[0]), DVec3::from_array(ends[1]));
        let (along, square) = (b - a, (b - a).length_squared());
        let share = if square > 0.0 { ((point - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        (a + along * share - point).length()
    };
    path.windows(2).map(to_segment).fold(f64::INFINITY, |least, d| if d < least { d } else { least })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(samples: &[f64]) -> (f64, f64) {
        let tau = 10.0 / 14.0;
        let only = |rate_weight, bend_weight| Objective { rate_weight, bend_weight, ..Objective::default() };
        (only(1e-3, 0.0).roughness_of(samples, tau), only(0.0, 1e-4).roughness_of(samples, tau))
    }

    /// T-14
    #[test]
    fn roughness_is_of_steps_and_of_bends() {
        let samples = |function: fn(usize) -> f64| (0..15).map(function).collect::<Vec<_>>();
        for (samples, rate, bend) in [
            (samples(|i| if i == 1 { 1.0 } else { 0.0 }), 0.0014, 0.000686),
            (samples(|i| (i % 2) as f64), 0.0098, 0.0071344),
            (samples(|i| i as f64 / 14.0), 0.00005, 0.0),
        ] {
            let found = parts(&samples);
            assert!((found.0 - rate).abs() < 1e-12 && (found.1 - bend).abs() < 1e-12, "{found:?}");
        }
    }

    fn trace(end: DVec3, heading_change: f64) -> Trace {
        Trace { start: DVec3::ZERO, end, time: 10.0, heading_change, stray: 3.0, length: 20.0 }
    }

    ///
    #[test]
    fn each_criterion_is_largest_where_it_is_met() {
        let value = |criterion, end: [f64; 3], heading| {
            let objective = Objective { criterion, ..Objective::default() };
            objective.criterion_value(&trace(DVec3::from_array(end), heading))
        };
        assert_eq!(value(Criterion::Target([0.0, 100.0, 0.0]), [0.0, 10.0, 0.0], 0.0), 0.5);
        assert_eq!(value(Criterion::Target([0.0, 100.0, 0.0]), [0.0, -20.0, 0.0], 0.0), -1.0);
        assert_eq!(value(Criterion::Speed(0.05), [6.0, 8.0, 0.0], 0.0), 0.0);
        assert_eq!(value(Criterion::Speed(0.1), [6.0, 8.0, 0.0], 0.0), -0.5);
        assert_eq!(value(Criterion::Path(vec![[0.0; 3], [0.0, 1.0, 0.0]]), [0.0; 3], 0.0), -0.15);
        let heading = value(Criterion::HeadingDegrees(30.0), [0.0; 3], 15f64.to_radians());
        assert!((heading + 0.5).abs() < 1e-12);
        let right = value(Criterion::HeadingDegrees(-30.0), [0.0; 3], -15f64.to_radians());
        assert_eq!(right, heading);
    }

    #[test]
    fn a_path_is_as_near_as_its_nearest_segment() {
        let path = [[0.0, 0.0, 0.0], [0.0, 10.0, 0.0], [10.0, 10.0, 0.0], [10.0, 10.0, 0.0]];
        let distance = |x, y, z| distance_to_path(DVec3::new(x, y, z), &path);
        assert_eq!(
            [distance(3.0, 4.0, 0.0), distance(0.0, -4.0, 3.0), distance(5.0, 8.0, 0.0)],
            [3.0, 5.0, 2.0]
        );
    }

    #[test]
    fn an_objective_out_of_range_is_refused_with_its_key() {
        let refused = |objective: Objective| objective.check().unwrap_err().path;
        let of = |criterion| Objective { criterion, ..Objective::default() };
        assert_eq!(refused(Objective { rate_weight: -1.0, ..Objective::default() }), "rate_weight");
        assert_eq!(refused(of(Criterion::Target([f64::NAN, 0.0, 0.0]))), "criterion.target");
        assert_eq!(refused(of(Criterion::Speed(0.0))), "criterion.speed");
        assert_eq!(refused(of(Criterion::Path(vec![[0.0; 3]]))), "criterion.path");
        assert_eq!(refused(of(Criterion::HeadingDegrees(0.0))), "criterion.heading_degrees");
        assert!(Objective::default().check().is_ok());
    }
}

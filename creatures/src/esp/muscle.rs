//! Muscles: springs whose stiffness is set by activation, which pull and never push (E-24..E-28). Here is what
//! one does at a length; where it is attached is for the creature.

use super::body::phenotype::Muscle;
use super::brain::clamp;

/// The length at which a muscle has no tension, of that in the rest pose (E-25).
const SLACK: f64 = 0.5;
/// The most that a muscle pulls, of F_max (E-25).
const LIMIT: f64 = 2.0;

/// A muscle at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stretch {
    /// l, m.
    pub length: f64,
    /// dl/dt, m/s.
    pub rate: f64,
    /// How much faster than now it would shorten after a step of pulling with 1 N, m/s: h/m of what it moves.
    pub give: f64,
}

impl Muscle {
    /// Tension, N: limit(k (l − l_r) + β k dl/dt, 0, 2 F_max) with k = a F_max / (L0 − l_r) and l_r = L0/2
    /// (E-25). `damping` is β, s.
    ///
    /// The damping is taken as what is left of it at the step's end, which is β k / (1 + give β k): where a
    /// muscle is stiff and what it moves is light, β k alone would throw that back within one step. With a
    /// short step, or a still muscle, it is E-25 to the bit.
    pub fn tension(&self, activation: f64, stretch: Stretch, damping: f64) -> f64 {
        let slack = SLACK * self.rest_length;
        let stiffness = activation * self.force_max / (self.rest_length - slack);
        let damping = damping * stiffness;
        let pull =
            stiffness * (stretch.length - slack) + damping * stretch.rate / (1.0 + stretch.give * damping);
        pull.clamp(0.0, LIMIT * self.force_max)
    }

    /// What its length feels like: half at rest, 1 at twice that (E-27).
    pub fn feel(&self, length: f64) -> f64 {
        clamp(length / (2.0 * self.rest_length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::body::Shape;
    use crate::esp::brain::tests::key;
    use glam::DVec3;

    fn muscle() -> Muscle {
        Muscle { key: key(0), parts: [0, 1], ends: [DVec3::ZERO; 2], rest_length: 0.4, force_max: 100.0 }
    }

    /// T-10
    #[test]
    fn tension_follows_activation_length_and_rate() {
        for (activation, length, rate, expected) in [
            (1.0, 0.4, 0.0, 100.0),
            (0.5, 0.4, 0.0, 50.0),
            (0.5, 0.6, 0.0, 100.0),
            (1.0, 0.2, 0.0, 0.0),
            (1.0, 0.9, 0.0, 200.0),
            (0.0, 0.6, 0.0, 0.0),
            (0.5, 0.4, -1.0, 45.0),
        ] {
            let found = muscle().tension(activation, Stretch { length, rate, give: 0.0 }, 0.02);
            assert!((found - expected).abs() < 1e-9, "{activation}, {length}, {rate}: {found}");
        }
    }

    /// T-10
    #[test]
    fn a_length_feels_like_its_share_of_twice_the_rest() {
        let felt = [0.2, 0.4, 0.6, 0.9].map(|length| muscle().feel(length));
        assert!(felt.iter().zip([0.25, 0.5, 0.75, 1.0]).all(|(felt, is)| (felt - is).abs() < 1e-12));
    }

    /// T-10, E-24: 0.1 × 0.2 m at half strength.
    #[test]
    fn strength_goes_with_the_cross_section() {
        let force = 0.5 * 2e4 * Shape::Box([0.1, 0.5, 0.05]).cross_section();
        assert!((force - 200.0).abs() < 1e-9, "{force}");
    }

    /// The damping of a light end can stop it within a step, and no more.
    #[test]
    fn damping_never_throws_back() {
        for give in [1e-3, 1.0, 1e3] {
            let rate = 0.1;
            let still = muscle().tension(1.0, Stretch { length: 0.3, rate: 0.0, give }, 0.02);
            let moving = muscle().tension(1.0, Stretch { length: 0.3, rate, give }, 0.02);
            let left = rate - give * (moving - still);
            assert!(left > 0.0 && left < rate, "{give}: {left}");
        }
    }
}

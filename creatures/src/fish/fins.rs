//! Pectoral fins: two plates without nodes of their own, which push on the midsection (A-30..A-33). What angle
//! they are to have is the command's; what keeps the fish upright is here.

use super::body::{Body, MIDSECTION_LEFT, MIDSECTION_RIGHT};
use super::hydrodynamics::Water;
use super::lattice::Motion;
use super::mechanics::TIME_STEP;
use super::posture::Posture;
use crate::math::{cos, sin};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_6, PI};

/// γ at which a fin is edge-on and does nothing ahead.
pub const NEUTRAL: f64 = FRAC_PI_2;
/// γ of the steepest descent.
pub const DESCENT: f64 = FRAC_PI_4;
/// γ of the steepest ascent.
pub const ASCENT: f64 = 3.0 * FRAC_PI_4;
/// γ of a fin held against the way.
pub const BRAKE: f64 = PI;
/// The fastest stroke of a fin.
pub const STROKE_MAX: f64 = 0.5;

/// A_f at size 1, about a seventh of a side.
const AREA: f64 = 10.0;
/// The fastest change of γ, rad by time.
const TURN_RATE: f64 = 2.0;
/// How much of a roll the reflex answers, and how much it may ask of a fin, rad.
const REFLEX_GAIN: f64 = 2.0;
const REFLEX_MAX: f64 = FRAC_PI_6;

/// γ of both fins, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinAngles {
    /// γ_L.
    pub left: f64,
    /// γ_R.
    pub right: f64,
}

impl FinAngles {
    /// Both fins alike.
    pub fn both(angle: f64) -> FinAngles {
        FinAngles { left: angle, right: angle }
    }

    /// With the reflex against rolling: the fin on the low side lifts, the other one presses. `roll` is
    /// the fish's, rad, positive when it leans to its right.
    #[must_use]
    pub fn balanced(self, roll: f64) -> FinAngles {
        let lift = (REFLEX_GAIN * roll).clamp(-REFLEX_MAX, REFLEX_MAX);
        FinAngles { left: self.left - lift, right: self.right + lift }
    }

    /// A step's way from these angles toward others, within what a fin can do.
    #[must_use]
    pub fn turned(self, target: FinAngles) -> FinAngles {
        let most = TURN_RATE * TIME_STEP;
        let turn = |now: f64, target: f64| (now + (target - now).clamp(-most, most)).clamp(DESCENT, BRAKE);
        FinAngles { left: turn(self.left, target.left), right: turn(self.right, target.right) }
    }
}

/// Adds the fins' forces to those on the nodes: `F = −A_f (n·v − q) n`, `n = cos γ f + sin γ û`, a sixth on each
/// midsection node of its side, whose mean velocity v is, less the water's.
///
/// `stroke` is q, the speed at which the fins row.
pub fn push(
    body: &Body,
    motion: &Motion,
    angles: FinAngles,
    stroke: f64,
    water: &impl Water,
    forces: &mut [DVec3],
) {
    const SHARE: f64 = 1.0 / 6.0;
    let posture = Posture::new(&motion.positions);
    let area = AREA * body.size * body.size;
    for (side, angle) in [(MIDSECTION_LEFT, angles.left), (MIDSECTION_RIGHT, angles.right)] {
        let normal = posture.forward * cos(angle) + posture.up * sin(angle);
        let mean = |of_nodes: &[DVec3]| side.iter().map(|&node| of_nodes[node]).sum::<DVec3>() * SHARE;
        let velocity = mean(&motion.velocities) - water.velocity(mean(&motion.positions));
        let force = normal * -(area * (normal.dot(velocity) - stroke));
        for node in side {
            forces[node] += force * SHARE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::hydrodynamics::Still;

    fn forces(angles: FinAngles, stroke: f64, velocity: DVec3) -> Vec<DVec3> {
        let body = Body::published(1.0);
        let motion = Motion { velocities: vec![velocity; 23], positions: body.rest.clone() };
        let mut forces = vec![DVec3::ZERO; 23];
        push(&body, &motion, angles, stroke, &Still, &mut forces);
        forces
    }

    /// with v along f the paper's `−A ‖v‖ cos γ n`.
    #[test]
    fn equal_fins_push_alike_on_twelve_nodes() {
        let angle = 2.0;
        let found = forces(FinAngles::both(angle), 0.0, DVec3::new(0.0, 1.5, 0.0));
        let expected = DVec3::new(0.0, cos(angle), sin(angle)) * (-10.0 * 1.5 * cos(angle) / 6.0);
        for (node, force) in found.into_iter().enumerate() {
            let expected = if (1..13).contains(&node) { expected } else { DVec3::ZERO };
            assert!((force - expected).length() < 1e-14, "{node}: {force}");
        }
    }

    ///
    #[test]
    fn a_stroke_rows_without_any_way_on() {
        let total: DVec3 = forces(FinAngles::both(BRAKE), 0.4, DVec3::ZERO).into_iter().sum();
        assert!((total - DVec3::new(0.0, -8.0, 0.0)).length() < 1e-12, "{total}");
        let level: DVec3 = forces(FinAngles::both(BRAKE), 0.4, DVec3::new(0.0, -0.4, 0.0)).into_iter().sum();
        assert!(level.length() < 1e-12, "nothing pushes once the fish goes as fast as its fins");
    }

    ///
    #[test]
    fn fins_turn_slowly_and_within_their_range() {
        let start = FinAngles::both(NEUTRAL);
        let next = start.turned(FinAngles { left: BRAKE, right: 0.0 });
        assert_eq!((next.left, next.right), (NEUTRAL + 0.11, NEUTRAL - 0.11));
        let end = (0..100).fold(start, |now, _| now.turned(FinAngles { left: 4.0, right: 0.0 }));
        assert_eq!(end, FinAngles { left: BRAKE, right: DESCENT });
        let reflex = start.balanced(0.1);
        assert!(
            (reflex.left - (NEUTRAL - 0.2)).abs() < 1e-15 && (reflex.right - (NEUTRAL + 0.2)).abs() < 1e-15
        );
        let most = start.balanced(-1.0);
        assert!((most.left - (NEUTRAL + FRAC_PI_6)).abs() < 1e-15, "{most:?}");
    }
}

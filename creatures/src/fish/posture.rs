//! How a fish lies in the water: derived points and angles. It changes nothing.

use super::body::{ABDOMEN, Body, MIDSECTION, NOSE, RING_1, RING_3, TIPS};
use crate::math::{asin, atan2};
use glam::DVec3;
use std::f64::consts::PI;

/// Points and directions of a fish, world frame. It borrows the positions of its nodes.
#[derive(Debug, Clone, Copy)]
pub struct Posture<'a> {
    positions: &'a [DVec3],
    /// f, of length 1, from the midsection's end to its beginning.
    pub forward: DVec3,
    /// û, of length 1, across `forward`.
    pub up: DVec3,
}

impl<'a> Posture<'a> {
    /// Of the 23 nodes of a fish.
    pub fn new(positions: &'a [DVec3]) -> Posture<'a> {
        let forward =
            (mean(&positions[RING_1]) - mean(&positions[RING_3])).try_normalize().unwrap_or(DVec3::Y);
        let back = positions[5] + positions[6] - positions[7] - positions[8];
        let up = (back - forward * back.dot(forward)).try_normalize();
        let up = up.unwrap_or_else(|| forward.any_orthonormal_vector());
        Posture { positions, forward, up }
    }

    /// f × û.
    pub fn right(&self) -> DVec3 {
        self.forward.cross(self.up)
    }

    /// b, the mean of the midsection.
    pub fn center(&self) -> DVec3 {
        mean(&self.positions[MIDSECTION])
    }

    /// The nose.
    pub fn mouth(&self) -> DVec3 {
        self.positions[NOSE]
    }

    /// Midway between the nose and the ring behind it.
    pub fn eye(&self) -> DVec3 {
        (self.mouth() + mean(&self.positions[RING_1])) * 0.5
    }

    /// The middle of the belly.
    pub fn abdomen(&self) -> DVec3 {
        ABDOMEN.iter().map(|&node| self.positions[node]).sum::<DVec3>() / ABDOMEN.len() as f64
    }

    /// Midway between the tips of the tail.
    pub fn tail(&self) -> DVec3 {
        mean(&self.positions[TIPS[0]..=TIPS[1]])
    }

    /// c, weighed by the body's masses.
    pub fn center_of_mass(&self, body: &Body) -> DVec3 {
        body.center_of_mass(self.positions)
    }

    /// ψ = atan2(−f_x, f_y), rad, to the left positive, 0 along y.
    pub fn heading(&self) -> f64 {
        heading(self.forward)
    }

    /// asin f_z, rad, upward positive.
    pub fn pitch(&self) -> f64 {
        asin(self.forward.z.clamp(-1.0, 1.0))
    }

    /// φ, rad, positive when the fish leans to its right; beyond ±π/2 its back is below. A fish that stands on
    /// its head or tail does not lean.
    pub fn roll(&self) -> f64 {
        let level = DVec3::new(self.forward.y, -self.forward.x, 0.0).normalize_or_zero();
        let roll = asin(self.up.dot(level).clamp(-1.0, 1.0));
        match (self.up.z < 0.0, roll < 0.0) {
            (false, _) => roll,
            (true, false) => PI - roll,
            (true, true) => -PI - roll,
        }
    }
}

/// The heading of a direction, rad, as [`Posture::heading`] has it; 0 for one straight up or down.
pub fn heading(direction: DVec3) -> f64 {
    atan2(-direction.x, direction.y)
}

fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len() as f64
}

impl Body {
    /// c = Σ m x / Σ m of some positions or velocities of the nodes.
    pub fn center_of_mass(&self, of_nodes: &[DVec3]) -> DVec3 {
        let masses = &self.lattice.masses;
        let moment: DVec3 = masses.iter().zip(of_nodes).map(|(&mass, &value)| value * mass).sum();
        moment / masses.iter().sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    fn close(found: DVec3, expected: DVec3) {
        assert!((found - expected).length() < 1e-6, "{found} is not {expected}");
    }

    /// T-1, A-8
    #[test]
    fn points_of_a_fish_at_rest() {
        let body = Body::published(1.0);
        let posture = Posture::new(&body.rest);
        close(posture.center_of_mass(&body), DVec3::new(0.0, -0.406989, 0.0));
        close(posture.center(), DVec3::new(0.0, 0.333333, 0.0));
        close(posture.eye(), DVec3::new(0.0, 6.0, 0.0));
        close(posture.abdomen(), DVec3::new(0.0, -1.5, -2.3));
        close(posture.tail(), DVec3::new(0.0, -12.0, 0.0));
        assert_eq!((posture.forward, posture.up, posture.right()), (DVec3::Y, DVec3::Z, DVec3::X));
        assert_eq!((posture.heading(), posture.pitch(), posture.roll()), (0.0, 0.0, 0.0));
    }

    #[test]
    fn angles_are_positive_to_the_left_upward_and_leaning_to_the_right() {
        let body = Body::published(1.0);
        let turned = |rotation: DMat3| -> Vec<DVec3> { body.rest.iter().map(|&x| rotation * x).collect() };
        let angles = |heading: f64, pitch: f64, roll: f64| {
            let turn = DMat3::from_rotation_z(heading)
                * DMat3::from_rotation_x(pitch)
                * DMat3::from_rotation_y(roll);
            let positions = turned(turn);
            let posture = Posture::new(&positions);
            for (found, expected) in
                [(posture.heading(), heading), (posture.pitch(), pitch), (posture.roll(), roll)]
            {
                assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
            }
        };
        angles(0.5, 0.3, 0.2);
        angles(-2.0, -0.7, -1.2);
        angles(3.0, 0.1, 2.5);
        angles(0.0, 0.0, -2.5);
    }

    /// AF-9
    #[test]
    fn a_fish_straight_up_or_all_in_one_point_has_defined_angles() {
        let body = Body::published(1.0);
        let upright: Vec<DVec3> =
            body.rest.iter().map(|&x| DMat3::from_rotation_x(std::f64::consts::FRAC_PI_2) * x).collect();
        for positions in [upright, vec![DVec3::ONE; 23]] {
            let posture = Posture::new(&positions);
            let angles = [posture.heading(), posture.pitch(), posture.roll()];
            assert!(angles.iter().all(|angle| angle.is_finite()), "{angles:?}");
        }
    }
}

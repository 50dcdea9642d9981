//! The water's pressure on skin (A-16..A-18): a face is held back as far as it pushes water, and by nothing
//! where it draws away. It moves nothing.

use super::lattice::{Face, Motion};
use glam::DVec3;

/// How the water moves by itself.
pub trait Water {
    /// Its velocity at a point, length by time, world frame.
    fn velocity(&self, at: DVec3) -> DVec3;
}

/// Water that does not move by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Still;

impl Water for Still {
    fn velocity(&self, _: DVec3) -> DVec3 {
        DVec3::ZERO
    }
}

impl<F: Fn(DVec3) -> DVec3> Water for F {
    fn velocity(&self, at: DVec3) -> DVec3 {
        self(at)
    }
}

/// A face that pushes water.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pressed {
    /// As the face has them.
    pub corners: [usize; 3],
    /// n, outward, of length 1.
    pub normal: DVec3,
    /// A, the area that counts.
    pub area: f64,
    /// u, the water's own velocity at the centroid.
    pub water: DVec3,
}

/// The face as it pushes water, if it does: `n · v > 0`, with v the mean velocity of its corners less the
/// water's. A face without area pushes nothing (AF-6).
#[inline]
pub fn pressed(face: &Face, motion: &Motion, water: &impl Water) -> Option<Pressed> {
    const THIRD: f64 = 1.0 / 3.0;
    let [a, b, c] = face.corners.map(|corner| motion.positions[corner]);
    let [va, vb, vc] = face.corners.map(|corner| motion.velocities[corner]);
    let across = (b - a).cross(c - a);
    let flow = water.velocity((a + b + c) * THIRD);
    let velocity = (va + vb + vc) * THIRD - flow;
    // The sign is that of n · v; without area it is 0, and with a corner that is no number, false.
    if across.dot(velocity) > 0.0 {
        let double_area = across.length();
        let normal = across / double_area;
        return Some(Pressed {
            corners: face.corners,
            normal,
            area: 0.5 * face.weight * double_area,
            water: flow,
        });
    }
    None
}

impl Pressed {
    /// `f = −A (n·v) n` on the whole face, whose corners take a third each.
    ///
    /// `velocity` is the mean of the corners', not less the water's.
    pub fn force(&self, velocity: DVec3) -> DVec3 {
        self.normal * -(self.area * self.normal.dot(velocity - self.water))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn force(velocities: [DVec3; 3], water: DVec3) -> DVec3 {
        let positions = vec![DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
        let motion = Motion { positions, velocities: velocities.to_vec() };
        let face = Face { corners: [0, 1, 2], weight: 1.0 };
        let mean = (velocities[0] + velocities[1] + velocities[2]) / 3.0;
        pressed(&face, &motion, &|_| water).map_or(DVec3::ZERO, |pressed| pressed.force(mean))
    }

    /// T-5, the explicit rows.
    #[test]
    fn a_face_is_held_back_along_its_normal_where_it_pushes_water() {
        let all = |velocity| force([velocity; 3], DVec3::ZERO);
        let close = |found: DVec3, expected: DVec3| assert!((found - expected).length() < 1e-12, "{found}");
        close(all(DVec3::new(0.0, 0.0, 0.4)), DVec3::new(0.0, 0.0, -1.2));
        close(all(DVec3::new(0.0, 0.0, -0.4)), DVec3::ZERO);
        close(all(DVec3::new(1.0, 2.0, 0.5)), DVec3::new(0.0, 0.0, -1.5));
        let rising = [0.3, 0.6, 0.0].map(|speed| DVec3::new(0.0, 0.0, speed));
        close(force(rising, DVec3::new(0.0, 0.0, 0.1)), DVec3::new(0.0, 0.0, -0.6));
    }

    /// AF-6
    #[test]
    fn a_face_without_area_pushes_nothing() {
        let motion = Motion {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0],
            velocities: vec![DVec3::ONE; 3],
        };
        assert_eq!(pressed(&Face { corners: [0, 1, 2], weight: 1.0 }, &motion, &Still), None);
    }
}

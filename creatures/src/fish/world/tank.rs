//! The box of water that fishes live in. Its six faces are obstacles, and nothing is outside.

use super::obstacle::Contact;
use glam::DVec3;

/// The published tank: 20 by 20 by 10 body lengths.
pub const PUBLISHED: [f64; 3] = [400.0, 400.0, 200.0];

/// A tank about the origin; z is up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tank {
    /// From the middle to its faces.
    pub half: DVec3,
}

impl Tank {
    /// Of some extents along x, y and z.
    pub fn new(extents: [f64; 3]) -> Tank {
        Tank { half: DVec3::from_array(extents) * 0.5 }
    }

    /// Height of the water.
    pub fn surface(&self) -> f64 {
        self.half.z
    }

    /// How a point lies to the six faces: −x, x, −y, y, −z (the bed), z (the surface); normals point into the
    /// water, and distances are negative outside.
    pub fn contacts(&self, at: DVec3) -> [Contact; 6] {
        let face = |normal: DVec3| Contact { distance: normal.abs().dot(self.half) + normal.dot(at), normal };
        [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].map(face)
    }

    /// Whether a point is in the water, at least so far from every face.
    pub fn holds(&self, at: DVec3, margin: f64) -> bool {
        self.contacts(at).iter().all(|contact| contact.distance >= margin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_push_inward() {
        let tank = Tank::new(PUBLISHED);
        let contacts = tank.contacts(DVec3::new(-190.0, 0.0, 101.0));
        assert_eq!(contacts[0], Contact { distance: 10.0, normal: DVec3::X });
        assert_eq!(contacts[1].distance, 390.0);
        assert_eq!(contacts[4], Contact { distance: 201.0, normal: DVec3::Z });
        assert_eq!(contacts[5], Contact { distance: -1.0, normal: DVec3::NEG_Z });
        assert!(tank.holds(DVec3::ZERO, 100.0) && !tank.holds(DVec3::ZERO, 100.1));
    }
}

//! What an open mouth draws in: particles at a speed, prey by a force.

use crate::fish::Body;
use crate::fish::perception::Figure;
use glam::DVec3;

/// How far suction reaches, by L, and the cone before the mouth in which particles are drawn.
const REACH: f64 = 0.5;
const COS_CONE: f64 = 0.5; // 60°
/// Speed of a particle at the mouth, length by time.
const SPEED: f64 = 5.0;
/// Force on a prey at the mouth, at size 1.
const FORCE: f64 = 60.0;
/// What is this near by L is swallowed: particles, and b of a prey.
const SWALLOWS_PARTICLE: f64 = 0.05;
const SWALLOWS_PREY: f64 = 0.25;

/// The velocity that a mouth gives to a particle, length by time.
pub fn velocity(mouth: &Figure, particle: DVec3) -> DVec3 {
    let (pull, way) = pull(mouth, particle);
    // What is in the mouth has no direction to be in.
    if -way.dot(mouth.forward) < COS_CONE && way != DVec3::ZERO { DVec3::ZERO } else { way * (SPEED * pull) }
}

/// Adds the force of a mouth on a prey, spread over its nodes by their mass.
pub fn force(mouth: &Figure, prey: &Figure, body: &Body, forces: &mut [DVec3]) {
    let (pull, way) = pull(mouth, prey.center);
    if pull > 0.0 {
        let masses = &body.lattice.masses;
        let total = way * (FORCE * mouth.size * mouth.size * pull / masses.iter().sum::<f64>());
        for (force, mass) in forces.iter_mut().zip(masses) {
            *force += total * *mass;
        }
    }
}

/// How far a particle is from a mouth that swallows it.
pub fn swallows_particle(mouth: &Figure, particle: DVec3) -> Option<f64> {
    within(mouth, particle, SWALLOWS_PARTICLE)
}

/// How far b of a prey is from a mouth that swallows it.
pub fn swallows_prey(mouth: &Figure, prey: &Figure) -> Option<f64> {
    within(mouth, prey.center, SWALLOWS_PREY)
}

/// 1 − d/0.5 L, at least 0, and the direction to the mouth; none from in the mouth.
fn pull(mouth: &Figure, from: DVec3) -> (f64, DVec3) {
    let way = mouth.mouth - from;
    let pull = 1.0 - way.length() / (REACH * mouth.length());
    (pull.max(0.0), way.normalize_or_zero())
}

fn within(mouth: &Figure, point: DVec3, share: f64) -> Option<f64> {
    let distance = (mouth.mouth - point).length();
    (distance < share * mouth.length()).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::perception::tests::Pond;

    /// A-76; the mouth is at (0, 2, 0), looks along y, and L is 20.
    #[test]
    fn particles_before_the_mouth_are_drawn_in() {
        let pond = Pond::with_eye_at_origin();
        let mouth = &pond.figures[0];
        let at = |x, y| velocity(mouth, DVec3::new(x, y, 0.0));
        assert!((at(0.0, 7.0) - DVec3::new(0.0, -2.5, 0.0)).length() < 1e-12, "{}", at(0.0, 7.0));
        assert_eq!(at(0.0, 12.1), DVec3::ZERO, "out of reach");
        assert_eq!(at(5.0, 2.0), DVec3::ZERO, "beside the mouth");
        assert_eq!(at(0.0, 2.0), DVec3::ZERO, "AF-9: in the mouth");
        let near = |y| swallows_particle(mouth, DVec3::new(0.0, y, 0.0));
        assert!(near(2.99).is_some() && near(3.01).is_none());
    }

    ///
    #[test]
    fn prey_are_drawn_by_a_force_shared_by_mass() {
        let mut pond = Pond::with_eye_at_origin();
        pond.add(DVec3::new(0.0, 8.0 - 1.0 / 3.0, 0.0), 0.0);
        let mut forces = vec![DVec3::ZERO; 23];
        let body = Body::published(1.0);
        force(&pond.figures[0], &pond.figures[1], &body, &mut forces);
        let total: DVec3 = forces.iter().sum();
        assert!((total - DVec3::new(0.0, -24.0, 0.0)).length() < 1e-9, "{total}");
        let masses = &body.lattice.masses;
        assert!((forces[5].y / masses[5] - forces[0].y / masses[0]).abs() < 1e-12);
        assert_eq!(swallows_prey(&pond.figures[0], &pond.figures[1]), None);
        pond.figures[1].center.y = 6.9;
        assert!(swallows_prey(&pond.figures[0], &pond.figures[1]).is_some());
    }
}

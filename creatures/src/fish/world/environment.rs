//! All of a world that does not act: tank, currents, climate and obstacles (A-46..A-49), and what it does to a
//! body that touches it.

use super::{Climate, Currents, Obstacle, Tank};
use glam::DVec3;

/// Force on a node by how deep it is in a solid, at size 1.
const STIFFNESS: f64 = 30.0;

/// Where fishes live.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// The box of water.
    pub tank: Tank,
    /// How it moves.
    pub currents: Currents,
    /// Light and warmth.
    pub climate: Climate,
    /// What stands in it.
    pub obstacles: Vec<Obstacle>,
}

impl Environment {
    /// Whether a ball is in the water and in no obstacle.
    pub fn free(&self, at: DVec3, radius: f64) -> bool {
        self.tank.holds(at, radius) && self.obstacles.iter().all(|solid| solid.contact(at).distance >= radius)
    }

    /// Adds the contact forces on a fish's nodes: 30 S² times the depth of each in a solid, outward.
    /// Gives whether there are any.
    ///
    /// `reach` is the radius of a ball about `center` that holds all nodes.
    pub fn push(
        &self,
        positions: &[DVec3],
        size: f64,
        center: DVec3,
        reach: f64,
        forces: &mut [DVec3],
    ) -> bool {
        let mut touched = false;
        let stiffness = STIFFNESS * size * size;
        let mut press = |force: &mut DVec3, contact: super::Contact| {
            if contact.distance < 0.0 {
                *force += contact.normal * (-contact.distance * stiffness);
                touched = true;
            }
        };
        if !self.tank.holds(center, reach) {
            for (node, force) in positions.iter().zip(forces.iter_mut()) {
                self.tank.contacts(*node).into_iter().for_each(|contact| press(force, contact));
            }
        }
        for solid in &self.obstacles {
            let near = reach + solid.reach();
            if (solid.center() - center).length_squared() < near * near {
                for (node, force) in positions.iter().zip(forces.iter_mut()) {
                    press(force, solid.contact(*node));
                }
            }
        }
        touched
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::Body;
    use crate::fish::world::tank::PUBLISHED;

    ///
    #[test]
    fn solids_push_the_nodes_that_are_in_them() {
        let body = Body::published(2.0);
        let environment = Environment {
            tank: Tank::new(PUBLISHED),
            currents: Currents::default(),
            climate: Climate::default(),
            obstacles: vec![Obstacle::Sphere { center: [0.0, 20.0, 0.0], radius: 5.0 }],
        };
        let push = |place: DVec3| {
            let positions: Vec<DVec3> = body.rest.iter().map(|&node| node + place).collect();
            let mut forces = vec![DVec3::ZERO; 23];
            let touched = environment.push(&positions, 2.0, place, 48.0, &mut forces);
            (touched, forces)
        };
        let (touched, forces) = push(DVec3::ZERO);
        assert!(touched && forces[0] == DVec3::new(0.0, -120.0, 0.0), "the nose, 1 deep: {}", forces[0]);
        assert!(forces[1..].iter().all(|force| *force == DVec3::ZERO));
        assert!(!push(DVec3::new(0.0, -5.0, 0.0)).0);
        let (touched, forces) = push(DVec3::new(0.0, 0.0, 96.2));
        assert!(touched && forces[21].z < 0.0 && forces[22].z == 0.0, "the surface");
    }
}

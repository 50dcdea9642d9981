//! What the mechanics moves: point masses, the springs between them and the skin that the water presses on
//! . It has no state; positions, velocities and the springs' present lengths at rest are the
//! caller's.

use glam::DVec3;

/// A spring between two nodes, the lower number first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// The nodes at its ends.
    pub ends: [usize; 2],
    /// c, force by strain length.
    pub stiffness: f64,
    /// l₀, the length at which an idle spring pulls and pushes nothing.
    pub rest_length: f64,
}

/// A triangle of skin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// Counter-clockwise seen from outside.
    pub corners: [usize; 3],
    /// The share of its area that counts: triangles that cover the same skin share it.
    pub weight: f64,
}

/// Nodes, springs and skin.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// (nodes), mass.
    pub masses: Vec<f64>,
    /// ρ, drag of a node by its speed, whatever the water does.
    pub damping: f64,
    /// In the order in which their forces are summed.
    pub springs: Vec<Spring>,
    /// In the order in which their forces are summed, after all springs.
    pub faces: Vec<Face>,
}

/// Where the nodes are and how they move.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// (nodes), world frame.
    pub positions: Vec<DVec3>,
    /// (nodes), length by time, world frame.
    pub velocities: Vec<DVec3>,
}

impl Motion {
    /// At rest at some positions.
    pub fn at_rest(positions: Vec<DVec3>) -> Motion {
        Motion { velocities: vec![DVec3::ZERO; positions.len()], positions }
    }
}

impl Lattice {
    /// Pairs of nodes whose motions are coupled, the lower first.
    pub fn couplings(&self) -> impl Iterator<Item = (usize, usize)> {
        let springs = self.springs.iter().map(|spring| (spring.ends[0], spring.ends[1]));
        let pairs = |face: &Face| {
            let [a, b, c] = face.corners;
            [(a.min(b), a.max(b)), (b.min(c), b.max(c)), (a.min(c), a.max(c))]
        };
        springs.chain(self.faces.iter().flat_map(pairs))
    }

    /// ½ Σ m v², of springs ½ Σ c (‖r‖ − l)², with the springs' present lengths at rest l.
    pub fn energy(&self, motion: &Motion, rest_lengths: &[f64]) -> Energy {
        let kinetic = self.masses.iter().zip(&motion.velocities).map(|(m, v)| 0.5 * m * v.length_squared());
        let elastic = self.springs.iter().zip(rest_lengths).map(|(spring, l)| {
            let [i, j] = spring.ends;
            let strain = (motion.positions[j] - motion.positions[i]).length() - l;
            0.5 * spring.stiffness * strain * strain
        });
        Energy { kinetic: kinetic.sum(), elastic: elastic.sum() }
    }
}

/// The energy of a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// Of motion.
    pub kinetic: f64,
    /// Of the springs.
    pub elastic: f64,
}

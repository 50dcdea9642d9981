//! A fish's body: 23 nodes, 91 springs of which 12 are muscles, and a closed skin (A-1..A-9). A body that is not
//! whole and symmetric is refused; none moves here.

mod anatomy;
mod check;

pub use anatomy::{ABDOMEN, MIDSECTION, MIDSECTION_LEFT, MIDSECTION_RIGHT, NOSE, RING_1, RING_3, TIPS};
pub use check::BodyError;

use super::lattice::{Face, Lattice, Spring};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Nodes of a fish.
pub const NODES: usize = 23;
/// Springs of a fish.
pub const SPRINGS: usize = 91;
/// Springs that contract.
pub const MUSCLES: usize = 12;

/// L at size 1.
const LENGTH: f64 = 20.0;
/// ρ of a node at size 1.
const DAMPING: f64 = 0.05;

/// What a spring is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tissue {
    /// Diagonals, which keep the shape.
    Cross,
    /// Lengthwise along the flanks of three segments; the only springs whose length at rest changes.
    Muscle,
    /// Rings, nose and tail.
    Structural,
}

/// A body at size 1 as a file gives it: nodes and springs. The skin follows from their numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// In the order of A-1.
    pub nodes: Vec<Node>,
    /// In the order of A-5.
    pub springs: Vec<Link>,
}

/// A point mass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// At rest: x to the right, y forward, z up.
    pub position: [f64; 3],
    /// Above 0.
    pub mass: f64,
}

/// A spring, as long at rest as its ends are apart.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Two nodes, the lower number first.
    pub ends: [usize; 2],
    /// What it is of.
    pub tissue: Tissue,
    /// Above 0.
    pub stiffness: f64,
}

/// A body of a size, ready to move.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// S; 1 is the size of the published tables.
    pub size: f64,
    /// Nodes, springs and skin.
    pub lattice: Lattice,
    /// (23), at rest, heading along y with the origin near its middle.
    pub rest: Vec<DVec3>,
    /// u₁…u₁₂: which springs they are.
    pub muscles: [usize; MUSCLES],
}

impl Body {
    /// The published body (A-1..A-5), at a size.
    pub fn published(size: f64) -> Body {
        Body::new(&Design::published(), size).expect("the published body is whole; a test says so")
    }

    /// A body of a design, at a size: lengths by S, masses, stiffnesses and damping by S², so that it swims the
    /// same gait in the same time.
    ///
    /// # Errors
    /// The first thing about the design that is not whole (A-7, AF-1).
    pub fn new(design: &Design, size: f64) -> Result<Body, BodyError> {
        check::check(design)?;
        let square = size * size;
        let rest: Vec<DVec3> =
            design.nodes.iter().map(|node| DVec3::from_array(node.position) * size).collect();
        let spring = |link: &Link| {
            let [i, j] = link.ends;
            let rest_length = (rest[j] - rest[i]).length();
            Spring { ends: link.ends, stiffness: link.stiffness * square, rest_length }
        };
        let mut muscles = [0; MUSCLES];
        let contractile = design.springs.iter().enumerate().filter(|(_, link)| link.tissue == Tissue::Muscle);
        for (muscle, (index, _)) in muscles.iter_mut().zip(contractile) {
            *muscle = index; // in the order of springs, which is that of segments and of corners
        }
        let lattice = Lattice {
            masses: design.nodes.iter().map(|node| node.mass * square).collect(),
            damping: DAMPING * square,
            springs: design.springs.iter().map(spring).collect(),
            faces: anatomy::skin().into_iter().map(|(corners, weight)| Face { corners, weight }).collect(),
        };
        Ok(Body { size, lattice, rest, muscles })
    }

    /// L = 20 S.
    pub fn length(&self) -> f64 {
        LENGTH * self.size
    }
}

#[cfg(test)]
mod tests;

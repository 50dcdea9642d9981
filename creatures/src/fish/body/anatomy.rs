//! Which node is where, the published body and its skin (A-1..A-5, A-8, A-16). Rings go round by corners: top
//! left, top right, bottom right, bottom left.

use super::{Design, Link, NODES, Node, Tissue};
use std::ops::Range;

/// The nose, which is the mouth as well.
pub const NOSE: usize = 0;
/// The ring behind the nose.
pub const RING_1: Range<usize> = 1..5;
/// The last ring of the midsection.
pub const RING_3: Range<usize> = 9..13;
/// Rings 1 to 3: what the eye calls the body, and what carries the fins.
pub const MIDSECTION: Range<usize> = 1..13;
/// The midsection's left nodes, which the left fin moves.
pub const MIDSECTION_LEFT: [usize; 6] = [1, 4, 5, 8, 9, 12];
/// The midsection's right nodes.
pub const MIDSECTION_RIGHT: [usize; 6] = [2, 3, 6, 7, 10, 11];
/// Below the belly.
pub const ABDOMEN: [usize; 4] = [7, 8, 11, 12];

/// Half width, forward position and half height of each ring.
const RINGS: [(f64, f64, f64); 5] =
    [(1.1, 4.0, 1.6), (1.9, 0.0, 2.4), (1.6, -3.0, 2.2), (1.2, -7.5, 1.7), (1.0, -9.5, 1.6)];
/// Mass of a node of each ring; A-2 gives node 20 what the others of its ring have.
const RING_MASSES: [f64; 5] = [6.6, 11.0, 6.6, 1.1, 1.1];
const NOSE_MASS: f64 = 1.1;
const TIP_MASS: f64 = 0.165;
/// The tips of the tail fin.
pub const TIPS: [usize; 2] = [21, 22];

/// The node at a corner of a ring, both from 0; corners go round.
const fn at(ring: usize, corner: usize) -> usize {
    1 + 4 * ring + corner % 4
}

impl Tissue {
    /// c at size 1.
    fn stiffness(self) -> f64 {
        match self {
            Tissue::Cross => 38.0,
            Tissue::Muscle => 28.0,
            Tissue::Structural => 30.0,
        }
    }
}

impl Design {
    /// The published body; its proportions are A-1's, its springs follow from A-4's rule.
    pub fn published() -> Design {
        Design { nodes: nodes(), springs: springs() }
    }
}

fn nodes() -> Vec<Node> {
    let mut nodes = vec![Node { position: [0.0, 8.0, 0.0], mass: NOSE_MASS }];
    for ((x, y, z), mass) in RINGS.into_iter().zip(RING_MASSES) {
        let corners = [[-x, y, z], [x, y, z], [x, y, -z], [-x, y, -z]];
        nodes.extend(corners.map(|position| Node { position, mass }));
    }
    nodes.extend([2.4, -2.4].map(|z| Node { position: [0.0, -12.0, z], mass: TIP_MASS }));
    debug_assert_eq!(nodes.len(), NODES, "a nose, five rings of four and two tips");
    nodes
}

fn springs() -> Vec<Link> {
    use Tissue::{Cross, Muscle, Structural};
    let mut pairs = Vec::new();
    for corner in 0..4 {
        pairs.push((NOSE, at(0, corner), Structural));
    }
    for ring in 0..5 {
        for corner in 0..4 {
            pairs.push((at(ring, corner), at(ring, corner + 1), Structural));
        }
        pairs.push((at(ring, 0), at(ring, 2), Cross));
        pairs.push((at(ring, 1), at(ring, 3), Cross));
    }
    for ring in 0..4 {
        let lengthwise = if ring < 3 { Muscle } else { Structural };
        for corner in 0..4 {
            pairs.push((at(ring, corner), at(ring + 1, corner), lengthwise));
            pairs.push((at(ring, corner), at(ring + 1, corner + 1), Cross));
            pairs.push((at(ring, corner + 1), at(ring + 1, corner), Cross));
        }
    }
    let [top, bottom] = TIPS;
    for corner in 0..4 {
        let (near, far) = if corner < 2 { (top, bottom) } else { (bottom, top) };
        pairs.push((at(4, corner), near, Structural));
        pairs.push((at(4, corner), far, Cross));
    }
    pairs.push((top, bottom, Structural));
    let mut springs: Vec<Link> = pairs
        .into_iter()
        .map(|(i, j, tissue)| Link { ends: [i.min(j), i.max(j)], tissue, stiffness: tissue.stiffness() })
        .collect();
    springs.sort_by_key(|spring| spring.ends);
    springs
}

/// The closed skin: corners of each triangle, counter-clockwise from outside, and its weight.
///
/// A quadrilateral has both its diagonals at half weight: one alone would not be its own mirror image, and a
/// straight swimmer would drift.
pub(super) fn skin() -> Vec<([usize; 3], f64)> {
    let mut skin = Vec::new();
    for corner in 0..4 {
        skin.push(([NOSE, at(0, corner), at(0, corner + 1)], 1.0));
    }
    let mut cover = |[a, b, c, d]: [usize; 4]| {
        skin.extend([[a, b, c], [a, c, d], [a, b, d], [b, c, d]].map(|corners| (corners, 0.5)));
    };
    for ring in 0..4 {
        for corner in 0..4 {
            cover([at(ring, corner), at(ring + 1, corner), at(ring + 1, corner + 1), at(ring, corner + 1)]);
        }
    }
    let [top, bottom] = TIPS;
    cover([at(4, 0), at(4, 3), bottom, top]);
    cover([at(4, 1), top, bottom, at(4, 2)]);
    skin.push(([at(4, 0), top, at(4, 1)], 1.0));
    skin.push(([at(4, 2), bottom, at(4, 3)], 1.0));
    skin
}

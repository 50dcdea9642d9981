//! Whether a design is a whole, symmetric body (A-7, AF-1). It mends nothing.

use super::{Design, MUSCLES, NODES, SPRINGS, Tissue, anatomy};
use glam::DVec3;
use std::collections::BTreeSet;

/// Motions of the whole that strain no spring: three ways to move and three to turn.
const RIGID_MOTIONS: usize = 6;
/// Singular values below this share of a spring's unit count as none; the published body's least is 0.28.
const RANK_TOLERANCE: f64 = 1e-6;

/// What about a design is not whole, the first such thing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BodyError {
    /// Other numbers of parts than a fish has.
    #[error("{found} {what} where a fish has {expected}")]
    Count {
        /// Of what.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there have to be.
        expected: usize,
    },
    /// A mass, a stiffness or a position out of range.
    #[error("`{field}`: {problem}")]
    Value {
        /// Such as `nodes[20].mass`.
        field: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A spring from a node to itself, to no node, against the order of numbers, or there twice.
    #[error("`springs[{index}]`: {problem}")]
    Spring {
        /// Which one.
        index: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Something without its mirror image.
    #[error("`{field}` has no {plane} mirror image")]
    Asymmetric {
        /// Such as `nodes[3]`.
        field: String,
        /// `left-right` or `top-bottom`.
        plane: &'static str,
    },
    /// A node that no chain of springs joins to node 0.
    #[error("`nodes[{0}]` hangs on nothing")]
    Unconnected(usize),
    /// Springs that leave the body free to move in itself.
    #[error("springs hold {rank} of {expected} motions of the nodes: the body is not rigid", expected = 3 * NODES - RIGID_MOTIONS)]
    Loose {
        /// Of the rigidity matrix.
        rank: usize,
    },
}

/// Checks it all, in the order of the errors.
pub(super) fn check(design: &Design) -> Result<(), BodyError> {
    let muscles = design.springs.iter().filter(|spring| spring.tissue == Tissue::Muscle).count();
    for (what, found, expected) in [
        ("nodes", design.nodes.len(), NODES),
        ("springs", design.springs.len(), SPRINGS),
        ("muscles", muscles, MUSCLES),
    ] {
        if found != expected {
            return Err(BodyError::Count { what, found, expected });
        }
    }
    check_values(design)?;
    check_springs(design)?;
    check_mirror(design, "left-right", &LEFT_RIGHT, |p| [-p[0], p[1], p[2]])?;
    check_mirror(design, "top-bottom", &TOP_BOTTOM, |p| [p[0], p[1], -p[2]])?;
    check_connected(design)?;
    let rank = rank(rigidity(design));
    if rank != 3 * NODES - RIGID_MOTIONS {
        return Err(BodyError::Loose { rank });
    }
    Ok(())
}

fn check_values(design: &Design) -> Result<(), BodyError> {
    let refuse = |field: String, problem: String| Err(BodyError::Value { field, problem });
    for (index, node) in design.nodes.iter().enumerate() {
        if !node.position.iter().all(|value| value.is_finite()) {
            return refuse(format!("nodes[{index}].position"), format!("{:?} is nowhere", node.position));
        }
        if !(node.mass > 0.0 && node.mass.is_finite()) {
            return refuse(format!("nodes[{index}].mass"), format!("{} is not above 0", node.mass));
        }
    }
    for (index, spring) in design.springs.iter().enumerate() {
        if !(spring.stiffness > 0.0 && spring.stiffness.is_finite()) {
            let problem = format!("{} is not above 0", spring.stiffness);
            return refuse(format!("springs[{index}].stiffness"), problem);
        }
    }
    Ok(())
}

fn check_springs(design: &Design) -> Result<(), BodyError> {
    let mut before = BTreeSet::new();
    for (index, spring) in design.springs.iter().enumerate() {
        let [i, j] = spring.ends;
        let problem = if i == j {
            format!("joins node {i} to itself")
        } else if i > j {
            format!("names node {i} before node {j}")
        } else if j >= NODES {
            format!("ends at node {j}, the last is {}", NODES - 1)
        } else if !before.insert(spring.ends) {
            format!("joins nodes {i} and {j} once more")
        } else if before.last() != Some(&spring.ends) {
            format!("joins nodes {i} and {j} out of the order of numbers")
        } else {
            continue;
        };
        return Err(BodyError::Spring { index, problem });
    }
    Ok(())
}

/// The node that each one is the mirror image of, left and right.
const LEFT_RIGHT: [usize; NODES] = mirror([1, 0, 3, 2], [21, 22]);
/// The same, top and bottom.
const TOP_BOTTOM: [usize; NODES] = mirror([3, 2, 1, 0], [22, 21]);

const fn mirror(corners: [usize; 4], tips: [usize; 2]) -> [usize; NODES] {
    let mut images = [0; NODES];
    let mut node = 1;
    while node < NODES {
        let corner = (node - 1) % 4;
        images[node] = node - corner + corners[corner];
        node += 1;
    }
    images[anatomy::TIPS[0]] = tips[0];
    images[anatomy::TIPS[1]] = tips[1];
    images
}

fn check_mirror(
    design: &Design,
    plane: &'static str,
    images: &[usize; NODES],
    reflect: impl Fn([f64; 3]) -> [f64; 3],
) -> Result<(), BodyError> {
    for (index, node) in design.nodes.iter().enumerate() {
        let image = &design.nodes[images[index]];
        if reflect(node.position) != image.position || node.mass != image.mass {
            return Err(BodyError::Asymmetric { field: format!("nodes[{index}]"), plane });
        }
    }
    for (index, spring) in design.springs.iter().enumerate() {
        let [i, j] = spring.ends.map(|end| images[end]);
        let ends = [i.min(j), i.max(j)];
        let twin = design.springs.iter().find(|other| other.ends == ends);
        if !twin.is_some_and(|twin| twin.tissue == spring.tissue && twin.stiffness == spring.stiffness) {
            return Err(BodyError::Asymmetric { field: format!("springs[{index}]"), plane });
        }
    }
    Ok(())
}

fn check_connected(design: &Design) -> Result<(), BodyError> {
    let mut reached = [false; NODES];
    reached[anatomy::NOSE] = true;
    for _ in 0..NODES {
        for spring in &design.springs {
            let [i, j] = spring.ends;
            let either = reached[i] || reached[j];
            (reached[i], reached[j]) = (either, either);
        }
    }
    match reached.iter().position(|reached| !reached) {
        Some(node) => Err(BodyError::Unconnected(node)),
        None => Ok(()),
    }
}

/// (springs × 3 nodes), how much each spring is strained by each motion of a node.
fn rigidity(design: &Design) -> Vec<[f64; 3 * NODES]> {
    let row = |ends: [usize; 2]| {
        let [i, j] = ends;
        let position = |node: usize| DVec3::from_array(design.nodes[node].position);
        let direction = (position(j) - position(i)).normalize_or_zero().to_array();
        let mut row = [0.0; 3 * NODES];
        for (axis, &share) in direction.iter().enumerate() {
            row[3 * i + axis] = -share;
            row[3 * j + axis] = share;
        }
        row
    };
    design.springs.iter().map(|spring| row(spring.ends)).collect()
}

/// By Gram and Schmidt's method, each row twice, so that rounding leaves no false direction behind.
fn rank(rows: Vec<[f64; 3 * NODES]>) -> usize {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<[f64; 3 * NODES]> = Vec::new();
    for mut row in rows {
        for direction in basis.iter().chain(&basis) {
            let share = dot(direction, &row);
            row.iter_mut().zip(direction).for_each(|(value, along)| *value -= share * along);
        }
        let length = dot(&row, &row).sqrt();
        if length > RANK_TOLERANCE {
            row.iter_mut().for_each(|value| *value /= length);
            basis.push(row);
        }
    }
    basis.len()
}

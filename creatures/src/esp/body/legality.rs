//! Which expressed bodies are legal: enough of them to live, and no more than the physics holds (E-17..E-19). It
//! mends nothing.

use super::Phenotype;
use super::genotype::SEGMENTS_MAX;
use super::overlap::Solid;
use glam::DVec3;
use std::ops::RangeInclusive;

/// The most parts (E-17).
pub const PARTS_MAX: usize = 24;
/// The most muscles (E-17).
pub const MUSCLES_MAX: usize = 48;
/// The most receptors (E-17).
pub const RECEPTORS_MAX: usize = 24;
/// Legal masses, kg (E-17).
pub const MASS: RangeInclusive<f64> = 0.5..=500.0;
/// The longest side of the box about the rest pose, m (E-17).
pub const EXTENT_MAX: f64 = 5.0;
/// How deep two parts may overlap in the rest pose, m (E-18).
pub const OVERLAP_MAX: f64 = 0.005;

/// Why a graph has no legal body (E-19).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Illegal {
    /// Only while graphs are grafted (E-17, E-40); one that is read names its field.
    #[error("its graph has {found} segments where {SEGMENTS_MAX} are the most")]
    TooManySegments {
        /// How many genes.
        found: usize,
    },
    /// Expression stopped at the first part too many (EF-7).
    #[error("it has more than {PARTS_MAX} parts")]
    TooManyParts,
    /// E-17
    #[error("it has {found} muscles where {MUSCLES_MAX} are the most")]
    TooManyMuscles {
        /// How many.
        found: usize,
    },
    /// E-17
    #[error("it has {found} receptors where {RECEPTORS_MAX} are the most")]
    TooManyReceptors {
        /// How many.
        found: usize,
    },
    /// E-17
    #[error("its mass of {found:.3} kg is not within {} to {}", MASS.start(), MASS.end())]
    Mass {
        /// kg.
        found: f64,
    },
    /// E-17
    #[error("it is {found:.3} m long, wide or high where {EXTENT_MAX} m are the most")]
    Extent {
        /// The longest side of the box about it, m.
        found: f64,
    },
    /// E-18
    #[error("its parts {} and {} overlap by more than {OVERLAP_MAX} m", .parts[0], .parts[1])]
    Overlap {
        /// The first two that do.
        parts: [usize; 2],
    },
}

impl Illegal {
    /// Its name in notes.
    pub fn name(&self) -> &'static str {
        match self {
            Illegal::TooManySegments { .. } => "too_many_segments",
            Illegal::TooManyParts => "too_many_parts",
            Illegal::TooManyMuscles { .. } => "too_many_muscles",
            Illegal::TooManyReceptors { .. } => "too_many_receptors",
            Illegal::Mass { .. } => "mass",
            Illegal::Extent { .. } => "extent",
            Illegal::Overlap { .. } => "overlap",
        }
    }
}

impl Phenotype {
    /// Checks what only the expressed body shows, the cheapest first.
    pub(super) fn check(&self) -> Result<(), Illegal> {
        let found = self.muscles.len();
        if found > MUSCLES_MAX {
            return Err(Illegal::TooManyMuscles { found });
        }
        let found = self.receptors.len();
        if found > RECEPTORS_MAX {
            return Err(Illegal::TooManyReceptors { found });
        }
        let found = self.mass();
        if !MASS.contains(&found) {
            return Err(Illegal::Mass { found });
        }
        let found = self.extent().max_element();
        if found > EXTENT_MAX {
            return Err(Illegal::Extent { found });
        }
        self.check_overlap()
    }

    /// Sides of the box about the rest pose, m.
    pub fn extent(&self) -> DVec3 {
        let reach = |axis: DVec3| {
            let ends = self.parts.iter().map(|part| {
                let reach = part.shape.reach(part.rotation.conjugate() * axis);
                (part.position.dot(axis) - reach, part.position.dot(axis) + reach)
            });
            let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (near, far)| {
                (low.min(near), high.max(far))
            });
            high - low
        };
        DVec3::new(reach(DVec3::X), reach(DVec3::Y), reach(DVec3::Z))
    }

    fn check_overlap(&self) -> Result<(), Illegal> {
        let solids: Vec<Solid> = self.parts.iter().map(Solid::of).collect();
        for (second, solid) in solids.iter().enumerate() {
            for (first, other) in solids[..second].iter().enumerate() {
                if other.overlaps(solid, OVERLAP_MAX) {
                    return Err(Illegal::Overlap { parts: [first, second] });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::body::genotype::Edge;
    use crate::esp::body::tests::{body, edge, muscle, receptor, segment, side, swimmer};
    use crate::esp::body::{Body, Shape};

    fn reason(graph: &Body) -> &'static str {
        graph.check().unwrap();
        graph.develop().map(|_| "none").unwrap_or_else(|illegal| illegal.name())
    }

    /// E-17
    #[test]
    fn each_cap_has_its_reason() {
        assert_eq!(reason(&swimmer()), "none");

        let mut dust = body(vec![segment(0, 1)], vec![]);
        dust.segments[0].shape = Shape::Sphere(0.04);
        assert_eq!(reason(&dust), "mass");

        let mut block = body(vec![segment(0, 1)], vec![]);
        block.segments[0].shape = Shape::Box([0.5, 0.5, 0.3]); // 600 kg
        assert_eq!(reason(&block), "mass");

        let mut snake = body(vec![segment(0, 6), segment(1, 6)], vec![edge(2, 0, 1), edge(3, 1, 0)]);
        for gene in &mut snake.segments {
            gene.shape = Shape::Capsule { radius: 0.05, half_length: 0.15 };
        }
        assert_eq!(reason(&snake), "extent", "12 × 0.5 m");
        snake.segments[0].recursion_limit = 5;
        snake.segments[1].recursion_limit = 5;
        assert_eq!(reason(&snake), "none", "10 × 0.5 − 0.1 m");

        let comb = Edge { muscles: (10..14).map(muscle).collect(), ..edge(3, 0, 0) };
        let sides =
            Edge { muscles: (20..24).map(muscle).collect(), symmetric: true, ..side(4, 0, 1, DVec3::Y) };
        let mut hairy = body(vec![segment(0, 5), segment(1, 1)], vec![comb, sides]);
        assert_eq!(reason(&hairy), "too_many_muscles", "4 × 4 + 5 × 8");
        hairy.segments[0].recursion_limit = 4;
        assert_eq!(reason(&hairy), "none", "3 × 4 + 4 × 8");

        let sides = Edge { symmetric: true, ..side(3, 0, 1, DVec3::Y) };
        let mut watchful = body(vec![segment(0, 3), segment(1, 1)], vec![edge(2, 0, 0), sides]);
        watchful.segments[0].receptors = (10..13).map(receptor).collect();
        watchful.segments[1].receptors = (20..23).map(receptor).collect();
        watchful.next_id = 23;
        assert_eq!(reason(&watchful), "too_many_receptors", "9 parts of 3");
        watchful.segments[1].receptors.pop();
        assert_eq!(reason(&watchful), "none", "3 parts of 3 and 6 of 2");
    }

    /// E-18: neighbours included, and by more than 5 mm.
    #[test]
    fn parts_that_overlap_are_refused() {
        let turned_back = |gap| {
            let joint = Edge { gap, child_dir: DVec3::X, ..edge(2, 0, 1) };
            body(vec![segment(0, 1), segment(1, 1)], vec![joint])
        };
        let illegal = turned_back(0.05).develop().unwrap_err();
        assert_eq!(illegal, Illegal::Overlap { parts: [0, 1] });
        assert_eq!(reason(&turned_back(0.1)), "overlap", "one gap ahead, then back through the parent");

        let two = |way| {
            let edges = vec![edge(3, 0, 1), side(4, 0, 2, way)];
            body(vec![segment(0, 1), segment(1, 1), segment(2, 1)], edges)
        };
        assert_eq!(two(DVec3::X).develop(), Err(Illegal::Overlap { parts: [1, 2] }), "siblings");
        assert_eq!(reason(&two(-DVec3::X)), "none");
    }
}

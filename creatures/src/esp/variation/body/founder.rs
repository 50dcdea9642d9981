//! Founders: graphs drawn at random (E-42), and the random genes of which they are made.

use crate::esp::body::genotype::{
    Body, EDGES_MAX, Edge, GAP, Joint, Muscle, RECURSION, Receptor, SCALE, Segment, TRAVEL,
};
use crate::esp::body::shape::{CAPSULE_RADIUS, EXTENT, Shape};
use crate::esp::key::GeneId;
use crate::esp::syllabus::SkillId;
use crate::esp::variation::draw::{direction, orientation, pick, uniform};
use crate::math::{exp, log};
use crate::random::Stream;
use std::ops::RangeInclusive;

/// Segment genes of a founder (E-42).
pub(in crate::esp::variation) const FOUNDER_SEGMENTS: RangeInclusive<usize> = 1..=6;
/// Strengths that are drawn; what is legal is above 0.
pub(super) const STRENGTH: RangeInclusive<f64> = 0.01..=1.0;
/// Muscles that a drawn joint brings, if it moves.
const DRAWN_MUSCLES: RangeInclusive<usize> = 1..=2;
/// The most edges of a founder besides those that its segments hang from.
const SPARE_EDGES_MAX: usize = 2;

impl Body {
    /// A graph of so many segment genes for a first skill, each but the root hanging from an earlier one, and up to
    /// 2 more edges between any two. It is legal as a graph; its body may not be.
    pub(in crate::esp::variation) fn random(segments: usize, skill: SkillId, stream: &mut Stream) -> Body {
        let mut body = Body { root: GeneId(0), next_id: 0, segments: Vec::new(), edges: Vec::new() };
        for _ in 0..segments {
            let from = body.segments_with_room();
            let segment = body.random_segment(stream);
            if !from.is_empty() {
                let from = pick(from, stream);
                body.add_edge(from, segment, skill, stream);
            }
        }
        for _ in 0..stream.within(0, SPARE_EDGES_MAX) {
            let from = pick(body.segments_with_room(), stream);
            let to = body.segments[stream.below(body.segments.len())].id;
            body.add_edge(from, to, skill, stream);
        }
        body
    }

    /// Segment genes that another edge may leave.
    pub(super) fn segments_with_room(&self) -> Vec<GeneId> {
        let ids = self.segments.iter().map(|gene| gene.id);
        ids.filter(|&id| self.edges_from(id).count() < EDGES_MAX).collect()
    }

    /// Adds a segment gene without receptors.
    pub(super) fn random_segment(&mut self, stream: &mut Stream) -> GeneId {
        let id = self.next_id();
        let recursion_limit = stream.within(usize::from(*RECURSION.start()), usize::from(*RECURSION.end()));
        let shape = random_shape(stream);
        self.segments.push(Segment { id, shape, recursion_limit: recursion_limit as u8, receptors: vec![] });
        id
    }

    /// Adds an edge of random genes. Its child points away from the parent's side that it hangs from: of the
    /// others nearly all would stand in their parents.
    pub(super) fn add_edge(&mut self, from: GeneId, to: GeneId, skill: SkillId, stream: &mut Stream) {
        let (parent_dir, child_dir) = (direction(stream), direction(stream));
        let mut turn = orientation(stream);
        while (turn * child_dir).dot(parent_dir) > 0.0 {
            turn = orientation(stream);
        }
        let joint = Joint::ALL[stream.below(Joint::ALL.len())];
        let id = self.next_id();
        let mut edge = Edge {
            id,
            from,
            to,
            parent_dir,
            child_dir,
            orientation: turn,
            gap: uniform(GAP, stream),
            scale: uniform(SCALE, stream),
            reflect: stream.chance(0.5),
            symmetric: stream.chance(0.5),
            terminal_only: stream.chance(0.5),
            joint,
            axis: direction(stream),
            travel: uniform(TRAVEL, stream),
            muscles: Vec::new(),
        };
        if joint != Joint::Fixed {
            let count = stream.within(*DRAWN_MUSCLES.start(), *DRAWN_MUSCLES.end());
            edge.muscles = (0..count).map(|_| self.random_muscle(skill, stream)).collect();
        }
        self.edges.push(edge);
    }

    pub(super) fn random_muscle(&mut self, owner: SkillId, stream: &mut Stream) -> Muscle {
        let id = self.next_id();
        let (parent_dir, child_dir) = (direction(stream), direction(stream));
        Muscle { id, owner, locked: false, parent_dir, child_dir, strength: uniform(STRENGTH, stream) }
    }

    pub(super) fn random_receptor(&mut self, owner: SkillId, stream: &mut Stream) -> Receptor {
        Receptor { id: self.next_id(), owner, locked: false, direction: direction(stream) }
    }
}

/// Lengths are uniform by their logarithm: of a body of uniform ones few are light enough (E-17).
fn random_shape(stream: &mut Stream) -> Shape {
    let kind = stream.below(3);
    let mut length =
        |range: RangeInclusive<f64>| exp(uniform(log(*range.start())..=log(*range.end()), stream));
    match kind {
        0 => Shape::Box([(); 3].map(|()| length(EXTENT))),
        1 => Shape::Sphere(length(EXTENT)),
        _ => Shape::Capsule { radius: length(CAPSULE_RADIUS), half_length: length(EXTENT) },
    }
    .scaled(1.0) // a rounded end of a range may be out of it
}

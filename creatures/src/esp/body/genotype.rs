//! What is inherited of a body: a graph of segment genes joined by edge genes, with muscles on its edges and
//! receptors on its segments (E-1..E-8). It refuses whatever is not legal by itself; what only shows in the
//! expressed body is for the expression to refuse.

use super::Shape;
use crate::DecodeError;
use crate::esp::key::GeneId;
use crate::esp::syllabus::SkillId;
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// The most segment genes (E-17).
pub const SEGMENTS_MAX: usize = 12;
/// The most edges that leave one segment gene (E-17).
pub const EDGES_MAX: usize = 6;
/// The most muscle genes of an edge (E-17).
pub const MUSCLES_MAX: usize = 4;
/// The most receptor genes of a segment (E-17).
pub const RECEPTORS_MAX: usize = 3;
/// Legal recursion limits (E-10).
pub const RECURSION: RangeInclusive<u8> = 1..=6;
/// Legal gaps between a joint and either surface, m (E-3).
pub const GAP: RangeInclusive<f64> = 0.005..=0.10;
/// Legal scales of a child's subtree (E-3).
pub const SCALE: RangeInclusive<f64> = 0.5..=1.5;
/// Legal travels of a sliding joint to either side, m (E-3).
pub const TRAVEL: RangeInclusive<f64> = 0.02..=0.3;
/// How far the length of a unit vector or quaternion may be from 1.
const UNIT_TOLERANCE: f64 = 1e-9;

/// The graph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// The segment gene of part 0.
    pub root: GeneId,
    /// The id that the next new gene takes; above every id that was ever used (E-1).
    pub next_id: u32,
    /// In ascending id.
    pub segments: Vec<Segment>,
    /// In ascending id, which is the order of expression (E-9).
    pub edges: Vec<Edge>,
}

/// One segment gene (E-2).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Unique in the genotype.
    pub id: GeneId,
    /// Before the scales of the edges that lead to it.
    pub shape: Shape,
    /// How often the gene may occur on a way from the root, itself included (E-10).
    pub recursion_limit: u8,
    /// At most [`RECEPTORS_MAX`].
    pub receptors: Vec<Receptor>,
}

/// One joint gene: how a child hangs from its parent (E-3).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edge {
    /// Unique in the genotype.
    pub id: GeneId,
    /// The parent's gene.
    pub from: GeneId,
    /// The child's gene; the parent's own is legal.
    pub to: GeneId,
    /// Where the joint leaves the parent, unit, parent frame.
    pub parent_dir: DVec3,
    /// Where the joint enters the child, unit, child frame.
    pub child_dir: DVec3,
    /// Of the child in the parent frame, unit.
    pub orientation: DQuat,
    /// From the joint to either surface, m.
    pub gap: f64,
    /// Of every dimension in the child's subtree.
    pub scale: f64,
    /// Whether the child's subtree is mirrored in the parent's x–z plane (E-12).
    pub reflect: bool,
    /// Whether there are two copies, one plain and one mirrored (E-12).
    pub symmetric: bool,
    /// Whether only the last of a chain has this child (E-11).
    pub terminal_only: bool,
    /// What the joint leaves free.
    pub joint: Joint,
    /// Of the joint, unit, parent frame.
    pub axis: DVec3,
    /// How far a sliding joint goes to either side, m.
    pub travel: f64,
    /// At most [`MUSCLES_MAX`].
    pub muscles: Vec<Muscle>,
}

/// What a joint leaves free (E-4); none has a motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Joint {
    /// Nothing.
    Fixed,
    /// Rotation about the axis.
    Revolute,
    /// Every rotation.
    Spherical,
    /// Translation along the axis.
    Prismatic,
    /// Rotation about the axis and translation along it.
    Cylindrical,
}

/// One muscle gene (E-6).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Muscle {
    /// Unique in the genotype.
    pub id: GeneId,
    /// The skill under which it was grown (E-45).
    pub owner: SkillId,
    /// Whether it is closed to variation (E-45).
    pub locked: bool,
    /// To its end on the parent's surface, unit, parent frame.
    pub parent_dir: DVec3,
    /// To its end on the child's surface, unit, child frame.
    pub child_dir: DVec3,
    /// In (0, 1].
    pub strength: f64,
}

/// One photoreceptor gene (E-7).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Receptor {
    /// Unique in the genotype.
    pub id: GeneId,
    /// The skill under which it was grown (E-45).
    pub owner: SkillId,
    /// Whether it is closed to variation (E-45).
    pub locked: bool,
    /// To its place on the surface, and where it looks; unit, segment frame.
    pub direction: DVec3,
}

impl Joint {
    /// Every kind.
    pub const ALL: [Joint; 5] =
        [Joint::Fixed, Joint::Revolute, Joint::Spherical, Joint::Prismatic, Joint::Cylindrical];

    /// How many degrees of freedom it leaves (E-4).
    pub fn freedoms(self) -> usize {
        match self {
            Joint::Fixed => 0,
            Joint::Revolute | Joint::Prismatic => 1,
            Joint::Cylindrical => 2,
            Joint::Spherical => 3,
        }
    }
}

impl Segment {
    /// The gene without receptors.
    pub fn bare(&self) -> Segment {
        Segment { receptors: Vec::new(), ..self.clone() }
    }
}

impl Edge {
    /// The gene without muscles.
    pub fn bare(&self) -> Edge {
        Edge { muscles: Vec::new(), ..self.clone() }
    }
}

impl Body {
    /// Checks all that a graph shows without being expressed; nothing is clamped.
    ///
    /// # Errors
    /// EF-8: the field that is wrong, and what is allowed.
    pub fn check(&self) -> Result<(), DecodeError> {
        let found = self.segments.len();
        if found > SEGMENTS_MAX {
            return illegal("segments", format!("{found} where {SEGMENTS_MAX} are the most"));
        }
        if self.segment(self.root).is_none() {
            return illegal("root", format!("there is no segment {}", self.root.0));
        }
        self.check_ids()?;
        for (index, segment) in self.segments.iter().enumerate() {
            self.check_segment(&format!("segments[{index}]"), segment)?;
        }
        for (index, edge) in self.edges.iter().enumerate() {
            self.check_edge(&format!("edges[{index}]"), edge)?;
        }
        Ok(())
    }

    /// The segment gene of an id.
    pub fn segment(&self, id: GeneId) -> Option<&Segment> {
        self.segments.iter().find(|segment| segment.id == id)
    }

    /// The edges that leave a segment gene, in ascending id.
    pub fn edges_from(&self, id: GeneId) -> impl Iterator<Item = &Edge> {
        self.edges.iter().filter(move |edge| edge.from == id)
    }

    /// The ids of all genes with their fields, segments first.
    pub(in crate::esp) fn ids(&self) -> impl Iterator<Item = (String, GeneId)> + '_ {
        let segments = self.segments.iter().enumerate().flat_map(|(index, segment)| {
            let place = format!("segments[{index}]");
            let receptors = segment.receptors.iter().enumerate();
            let receptors: Vec<_> =
                receptors.map(|(at, gene)| (format!("{place}.receptors[{at}].id"), gene.id)).collect();
            std::iter::once((format!("{place}.id"), segment.id)).chain(receptors)
        });
        let edges = self.edges.iter().enumerate().flat_map(|(index, edge)| {
            let place = format!("edges[{index}]");
            let muscles = edge.muscles.iter().enumerate();
            let muscles: Vec<_> =
                muscles.map(|(at, gene)| (format!("{place}.muscles[{at}].id"), gene.id)).collect();
            std::iter::once((format!("{place}.id"), edge.id)).chain(muscles)
        });
        segments.chain(edges)
    }

    fn check_ids(&self) -> Result<(), DecodeError> {
        let mut seen = BTreeSet::new();
        for (field, id) in self.ids() {
            if !seen.insert(id) {
                return illegal(field, format!("the id {} is taken", id.0));
            }
            if id.0 >= self.next_id {
                return illegal(field, format!("the id {} is not below next_id, {}", id.0, self.next_id));
            }
        }
        if !self.segments.is_sorted_by_key(|segment| segment.id) {
            return illegal("segments", "not in ascending id");
        }
        if !self.edges.is_sorted_by_key(|edge| edge.id) {
            return illegal("edges", "not in ascending id");
        }
        Ok(())
    }

    fn check_segment(&self, place: &str, segment: &Segment) -> Result<(), DecodeError> {
        if let Some((name, length, legal)) = segment.shape.illegal_length() {
            within(&format!("{place}.shape.{name}"), length, legal)?;
        }
        if !RECURSION.contains(&segment.recursion_limit) {
            let problem = format!("{} is not within 1 to 6", segment.recursion_limit);
            return illegal(format!("{place}.recursion_limit"), problem);
        }
        at_most(&format!("{place}.receptors"), segment.receptors.len(), RECEPTORS_MAX)?;
        at_most(&format!("{place}: edges from it"), self.edges_from(segment.id).count(), EDGES_MAX)?;
        for (at, receptor) in segment.receptors.iter().enumerate() {
            unit(format!("{place}.receptors[{at}].direction"), receptor.direction.length())?;
        }
        Ok(())
    }

    fn check_edge(&self, place: &str, edge: &Edge) -> Result<(), DecodeError> {
        for (name, id) in [("from", edge.from), ("to", edge.to)] {
            if self.segment(id).is_none() {
                return illegal(format!("{place}.{name}"), format!("there is no segment {}", id.0));
            }
        }
        unit(format!("{place}.parent_dir"), edge.parent_dir.length())?;
        unit(format!("{place}.child_dir"), edge.child_dir.length())?;
        unit(format!("{place}.orientation"), edge.orientation.length())?;
        unit(format!("{place}.axis"), edge.axis.length())?;
        within(&format!("{place}.gap"), edge.gap, GAP)?;
        within(&format!("{place}.scale"), edge.scale, SCALE)?;
        within(&format!("{place}.travel"), edge.travel, TRAVEL)?;
        at_most(&format!("{place}.muscles"), edge.muscles.len(), MUSCLES_MAX)?;
        for (at, muscle) in edge.muscles.iter().enumerate() {
            let place = format!("{place}.muscles[{at}]");
            unit(format!("{place}.parent_dir"), muscle.parent_dir.length())?;
            unit(format!("{place}.child_dir"), muscle.child_dir.length())?;
            if !(muscle.strength > 0.0 && muscle.strength <= 1.0) {
                let problem = format!("{} is not above 0 and at most 1", muscle.strength);
                return illegal(format!("{place}.strength"), problem);
            }
        }
        Ok(())
    }
}

fn illegal<T>(field: impl Into<String>, problem: impl Into<String>) -> Result<T, DecodeError> {
    Err(DecodeError::illegal(field, problem))
}

fn at_most(field: &str, found: usize, most: usize) -> Result<(), DecodeError> {
    if found <= most { Ok(()) } else { illegal(field, format!("{found} where {most} are the most")) }
}

fn within(field: &str, value: f64, legal: RangeInclusive<f64>) -> Result<(), DecodeError> {
    if legal.contains(&value) {
        return Ok(());
    }
    illegal(field, format!("{value} is not within {} to {}", legal.start(), legal.end()))
}

fn unit(field: String, length: f64) -> Result<(), DecodeError> {
    if (length - 1.0).abs() <= UNIT_TOLERANCE {
        Ok(())
    } else {
        illegal(field, format!("length {length} is not 1"))
    }
}

#[cfg(test)]
mod tests;

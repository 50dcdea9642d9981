//! An expressed body: parts in their rest pose, how they hang together, and what pulls and sees (E-9..E-16). It is
//! what the physics is built from; it moves nothing.

use super::Shape;
use super::genotype::Joint;
use crate::esp::brain::Instances;
use crate::esp::key::{GeneId, InstanceKey, Step};
use glam::{DQuat, DVec3};

/// A legal body. Rest pose: the root at the origin, unrotated.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Phenotype {
    /// In the order of expression (E-9): the root first, every parent before its children.
    pub parts: Vec<Part>,
    /// In the order of their parts, then of their genes.
    pub muscles: Vec<Muscle>,
    /// In the order of their parts, then of their genes.
    pub receptors: Vec<Receptor>,
    /// Muscles that were left out, as their rest length is too short (E-18).
    pub too_short: Vec<InstanceKey>,
}

/// One occurrence of a segment gene.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The way from the root (E-16).
    pub key: Vec<Step>,
    /// Whose occurrence it is.
    pub segment: GeneId,
    /// Scaled (E-13).
    pub shape: Shape,
    /// Of its centre, m, rest pose.
    pub position: DVec3,
    /// From its frame to that of the rest pose.
    pub rotation: DQuat,
    /// To its parent; none for the root.
    pub joint: Option<PartJoint>,
}

/// How a part hangs from its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartJoint {
    /// The parent's index.
    pub parent: usize,
    /// What it leaves free.
    pub kind: Joint,
    /// The joint's place, m, parent frame (J of E-14).
    pub parent_anchor: DVec3,
    /// The joint's place, m, child frame.
    pub child_anchor: DVec3,
    /// Unit, parent frame.
    pub axis: DVec3,
    /// How far a sliding axis goes to either side, m.
    pub travel: f64,
}

/// One occurrence of a muscle gene.
#[derive(Debug, Clone, PartialEq)]
pub struct Muscle {
    /// Its name (E-16).
    pub key: InstanceKey,
    /// The parts that it pulls at: parent, then child.
    pub parts: [usize; 2],
    /// Its ends, m, each in its part's frame.
    pub ends: [DVec3; 2],
    /// L0, m: its length in the rest pose.
    pub rest_length: f64,
    /// F_max, N (E-24).
    pub force_max: f64,
}

/// One occurrence of a receptor gene.
#[derive(Debug, Clone, PartialEq)]
pub struct Receptor {
    /// Its name (E-16).
    pub key: InstanceKey,
    /// Where it sits.
    pub part: usize,
    /// Its place on the surface, m, part frame.
    pub point: DVec3,
    /// Where it looks, unit, part frame.
    pub axis: DVec3,
}

impl Part {
    /// Where a point of the part's frame is in the rest pose, m.
    pub fn place(&self, point: DVec3) -> DVec3 {
        self.position + self.rotation * point
    }
}

impl Phenotype {
    /// What the wires of a brain can end at.
    pub fn instances(&self) -> Instances {
        Instances {
            muscles: self.muscles.iter().map(|muscle| muscle.key.clone()).collect(),
            photos: self.receptors.iter().map(|receptor| receptor.key.clone()).collect(),
        }
    }

    /// Mass of all parts, kg.
    pub fn mass(&self) -> f64 {
        self.parts.iter().map(|part| part.shape.mass()).sum()
    }
}

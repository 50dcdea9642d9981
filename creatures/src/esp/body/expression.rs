//! Expression: from the graph that is inherited to parts, muscles and receptors (E-9..E-16). A pure function of
//! the graph, bounded by the cap on parts; an illegal body is refused, never cut down to a legal one.

use super::genotype::{Body, Edge, Segment};
use super::legality::{Illegal, PARTS_MAX};
use super::phenotype::{Muscle, Part, PartJoint, Phenotype, Receptor};
use crate::esp::key::{GeneId, InstanceKey, Step};
use glam::{DQuat, DVec3};

/// The least length of an expressed muscle in the rest pose, m (E-18).
pub const REST_LENGTH_MIN: f64 = 0.05;
/// What a muscle of strength 1 pulls with per cross-section, N/m² (E-24).
pub const STRESS: f64 = 2.0e4;

impl Body {
    /// Expresses the graph, which has passed [`Body::check`], depth first from the root, edges in ascending id,
    /// the plain copy of a symmetric edge before the mirrored one (E-9).
    ///
    /// # Errors
    /// Why the body is not legal (E-17..E-19); of too many parts none is built beyond the first too many (EF-7).
    pub fn develop(&self) -> Result<Phenotype, Illegal> {
        let phenotype = self.express()?;
        phenotype.check()?;
        Ok(phenotype)
    }

    /// As [`Body::develop`], without the checks of the whole.
    fn express(&self) -> Result<Phenotype, Illegal> {
        let mut growth = Growth { body: self, phenotype: Phenotype::default(), branches: Vec::new() };
        growth.plant()?;
        Ok(growth.phenotype)
    }
}

/// A body in the making.
struct Growth<'a> {
    body: &'a Body,
    phenotype: Phenotype,
    /// One a part.
    branches: Vec<Branch>,
}

/// What a part hands on to its children.
#[derive(Clone, Copy)]
struct Branch {
    /// m of E-12.
    mirrored: bool,
    /// Product of the scales on the way, not clamped (E-13).
    scale: f64,
}

impl<'a> Growth<'a> {
    fn plant(&mut self) -> Result<(), Illegal> {
        let gene = self.segment(self.body.root);
        let part = Part {
            key: Vec::new(),
            segment: gene.id,
            shape: gene.shape.scaled(1.0),
            position: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            joint: None,
        };
        self.add(part, gene, Branch { mirrored: false, scale: 1.0 })
    }

    /// Adds a part with its receptors, then its children.
    fn add(&mut self, part: Part, gene: &Segment, branch: Branch) -> Result<(), Illegal> {
        let index = self.phenotype.parts.len();
        if index == PARTS_MAX {
            return Err(Illegal::TooManyParts);
        }
        for receptor in &gene.receptors {
            let axis = branch.vector(receptor.direction);
            self.phenotype.receptors.push(Receptor {
                key: InstanceKey { part: part.key.clone(), gene: receptor.id },
                part: index,
                point: part.shape.surface_point(axis),
                axis,
            });
        }
        self.phenotype.parts.push(part);
        self.branches.push(branch);
        let (body, count) = (self.body, self.occurrences(index));
        let at_end = count == usize::from(gene.recursion_limit);
        for edge in body.edges_from(gene.id).filter(|edge| at_end || !edge.terminal_only) {
            for copy in 0..=u8::from(edge.symmetric) {
                self.follow(edge, copy, index)?;
            }
        }
        Ok(())
    }

    /// How often the gene of a part occurs on the way to it from the root, itself included (E-10).
    fn occurrences(&self, part: usize) -> usize {
        self.occurrences_of(self.phenotype.parts[part].segment, part)
    }

    fn occurrences_of(&self, gene: GeneId, mut part: usize) -> usize {
        let mut count = 0;
        loop {
            let Part { segment, joint, .. } = &self.phenotype.parts[part];
            count += usize::from(*segment == gene);
            match joint {
                Some(joint) => part = joint.parent,
                None => return count,
            }
        }
    }

    /// Hangs one copy of an edge's child from a part, unless its gene has occurred often enough.
    fn follow(&mut self, edge: &Edge, copy: u8, parent: usize) -> Result<(), Illegal> {
        let gene = self.segment(edge.to);
        if self.occurrences_of(gene.id, parent) >= usize::from(gene.recursion_limit) {
            return Ok(());
        }
        let Branch { mirrored, scale } = self.branches[parent];
        let branch = Branch { mirrored: mirrored ^ edge.reflect ^ (copy == 1), scale: scale * edge.scale };
        let above = &self.phenotype.parts[parent];
        let mut key = above.key.clone();
        key.push(Step(edge.id, copy));
        let shape = gene.shape.scaled(branch.scale);
        let [out, into] = [edge.parent_dir, edge.child_dir].map(|way| branch.vector(way));
        let turn = branch.rotation(edge.orientation);
        let parent_anchor = above.shape.surface_point(out) + edge.gap * out;
        let child_anchor = shape.surface_point(into) + edge.gap * into;
        let centre = parent_anchor - turn * child_anchor; // E-14
        let part = Part {
            key,
            segment: gene.id,
            shape,
            position: above.position + above.rotation * centre,
            rotation: (above.rotation * turn).normalize(),
            joint: Some(PartJoint {
                parent,
                kind: edge.joint,
                parent_anchor,
                child_anchor,
                axis: branch.vector(edge.axis),
                travel: edge.travel,
            }),
        };
        self.span(edge, &part, parent, branch);
        self.add(part, gene, branch)
    }

    /// Spans an edge's muscles between a part and the child that is about to be added.
    fn span(&mut self, edge: &Edge, child: &Part, parent: usize, branch: Branch) {
        let Phenotype { parts, muscles, too_short, .. } = &mut self.phenotype;
        let (above, index) = (&parts[parent], parts.len());
        let section = above.shape.cross_section().min(child.shape.cross_section());
        for gene in &edge.muscles {
            let ends = [
                above.shape.surface_point(branch.vector(gene.parent_dir)),
                child.shape.surface_point(branch.vector(gene.child_dir)),
            ];
            let key = InstanceKey { part: child.key.clone(), gene: gene.id };
            let rest_length = above.place(ends[0]).distance(child.place(ends[1]));
            if rest_length < REST_LENGTH_MIN {
                too_short.push(key);
                continue;
            }
            let force_max = gene.strength * STRESS * section;
            muscles.push(Muscle { key, parts: [parent, index], ends, rest_length, force_max });
        }
    }

    fn segment(&self, id: GeneId) -> &'a Segment {
        self.body.segment(id).expect("the body was checked: every edge and the root have their segments")
    }
}

/// E-12: with S = diag(1, −1, 1), S v and S R S where mirrored.
impl Branch {
    fn vector(self, v: DVec3) -> DVec3 {
        if self.mirrored { DVec3::new(v.x, -v.y, v.z) } else { v }
    }

    fn rotation(self, q: DQuat) -> DQuat {
        if self.mirrored { DQuat::from_xyzw(-q.x, q.y, -q.z, q.w) } else { q }
    }
}

#[cfg(test)]
mod tests;

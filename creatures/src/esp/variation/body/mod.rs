//! How a body's graph varies: founders, mutation, crossover, grafting (E-39..E-42). It keeps the graph legal by
//! itself; whether the body that it is expressed into is legal is for the expression to say.

mod founder;
mod mating;
mod mutation;

pub use mutation::Operator;

pub(super) use founder::FOUNDER_SEGMENTS;
pub(super) use mating::{Renaming, counterparts};

use crate::esp::body::Body;
use crate::esp::key::GeneId;
use std::collections::BTreeSet;

impl Body {
    /// An id for a new gene (E-1).
    fn next_id(&mut self) -> GeneId {
        let id = GeneId(self.next_id);
        self.next_id += 1;
        id
    }

    /// Deletes the genes that the root does not reach (E-41).
    fn delete_unreachable(&mut self) {
        let reached = self.reachable(self.root);
        self.segments.retain(|gene| reached.contains(&gene.id));
        self.edges.retain(|gene| reached.contains(&gene.from));
    }

    /// A segment gene and those that edges lead to from it, directly or in a chain.
    fn reachable(&self, from: GeneId) -> BTreeSet<GeneId> {
        let mut reached = BTreeSet::from([from]);
        let mut open = vec![from];
        while let Some(gene) = open.pop() {
            open.extend(self.edges_from(gene).map(|edge| edge.to).filter(|&to| reached.insert(to)));
        }
        reached
    }
}

#[cfg(test)]
mod tests;

//! Instance keys: names of expressed muscles and receptors that survive every mutation off their path (E-16).

use serde::{Deserialize, Serialize};
use std::fmt::{self, Display, Formatter};

/// The id of a gene, unique within its genotype and never reused there (E-1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct GeneId(pub u32);

/// One step from a part to its child: the edge that was followed, and which copy of a symmetric edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Step(pub GeneId, pub u8);

/// The name of one expressed muscle or receptor: the way to its part from the root, then its gene.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstanceKey {
    /// Empty for the root.
    pub part: Vec<Step>,
    /// The muscle's or receptor's gene.
    pub gene: GeneId,
}

/// `EDGE.COPY/…/GENE`
impl Display for InstanceKey {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for Step(edge, copy) in &self.part {
            write!(f, "{}.{copy}/", edge.0)?;
        }
        write!(f, "{}", self.gene.0)
    }
}

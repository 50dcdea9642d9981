//! The innovation register: one number for one structure, anywhere in a run (G-31). Part of a search's
//! checkpoint; workers never see it.

use super::genotype::Layout;
use crate::walker::body::BodyKind;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Every structural innovation of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Register {
    next_innovation: u32,
    next_node: u32,
    links: BTreeMap<(u32, u32, bool), u32>,
    splits: BTreeMap<(u32, u32), Split>,
}

/// The numbers that splitting one link brings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// The new node.
    pub node: u32,
    /// Innovation of the link into it.
    pub into: u32,
    /// Innovation of the link out of it.
    pub out: u32,
}

impl Register {
    /// The register of a run that begins: it knows the links of generation 1 (G-30).
    pub fn new(body: BodyKind) -> Register {
        let layout = Layout::of(body);
        let mut register = Register {
            next_innovation: 0,
            next_node: layout.first_hidden(),
            links: BTreeMap::new(),
            splits: BTreeMap::new(),
        };
        for (from, to) in layout.start() {
            register.link(from, to, false);
        }
        register
    }

    /// The innovation of a link, new if the run has not seen it.
    pub fn link(&mut self, from: u32, to: u32, recurrent: bool) -> u32 {
        let next = &mut self.next_innovation;
        *self.links.entry((from, to, recurrent)).or_insert_with(|| take(next))
    }

    /// The numbers of the `k`-th node on the link of an innovation, new if the run has not seen it.
    pub fn split(&mut self, innovation: u32, k: u32) -> Split {
        let (innovations, nodes) = (&mut self.next_innovation, &mut self.next_node);
        *self.splits.entry((innovation, k)).or_insert_with(|| Split {
            node: take(nodes),
            into: take(innovations),
            out: take(innovations),
        })
    }

    /// Innovations handed out so far.
    pub fn len(&self) -> usize {
        self.next_innovation as usize
    }

    /// Whether there are none; no body starts so.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The next number of a sequence.
fn take(next: &mut u32) -> u32 {
    let number = *next;
    *next = number.checked_add(1).expect("a run has far fewer than 2^32 innovations");
    number
}

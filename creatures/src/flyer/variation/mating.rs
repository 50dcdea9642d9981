//! Mating: crossover and grafting of the lists of nodes (F-62..F-64).

use super::Settings;
use crate::flyer::Genotype;
use crate::flyer::genotype::{FIRST_SEGMENT, NODES};
use crate::random::Stream;

impl Genotype {
    /// The nodes of the first parent up to a cut, those of the second from the same place on (F-62).
    pub fn crossover(
        first: &Genotype,
        second: &Genotype,
        settings: &Settings,
        stream: &mut Stream,
    ) -> Genotype {
        let cut = stream.within(1, first.nodes.len().min(second.nodes.len()) - 1);
        splice(first, cut, second, cut, settings, stream)
    }

    /// Wing segments of the second parent, from any of its segments to the tip, on a wing of the first cut
    /// anywhere; body and wing-root are the first's (F-62). What exceeds the longest wing is cut off.
    pub fn graft(first: &Genotype, second: &Genotype, settings: &Settings, stream: &mut Stream) -> Genotype {
        let stump = stream.within(FIRST_SEGMENT, first.nodes.len().min(NODES.end() - 1));
        let scion = stream.within(FIRST_SEGMENT, second.nodes.len() - 1);
        splice(first, stump, second, scion, settings, stream)
    }
}

/// The nodes of one parent before `until`, then those of the other from `from` on, as many as are legal.
/// References move with their nodes (F-63). Both sides of the seam are reconnected, and so is a node that
/// has lost its successor to the limit (F-64).
pub(super) fn splice(
    head: &Genotype,
    until: usize,
    tail: &Genotype,
    from: usize,
    settings: &Settings,
    stream: &mut Stream,
) -> Genotype {
    let mut nodes = [&head.nodes[..until], &tail.nodes[from..]].concat();
    let mut torn = vec![until - 1, until];
    if nodes.len() > *NODES.end() {
        nodes.truncate(*NODES.end());
        torn.push(nodes.len() - 1);
    }
    let count = nodes.len();
    let mut child = Genotype { nodes };
    child.reconnect_nodes(&torn, settings, stream, |reader, node| {
        if reader < until {
            (node < until).then_some(node)
        } else {
            node.checked_sub(from).map(|beyond| until + beyond).filter(|&moved| moved < count)
        }
    });
    child
}

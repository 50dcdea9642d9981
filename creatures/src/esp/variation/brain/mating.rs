//! Crossover and grafting of a control (E-39, E-40).

use super::ground::{Ground, limit_wires};
use crate::esp::brain::genotype::{NODES_MAX, WIRES_MAX};
use crate::esp::brain::{Control, Node, Output, Source, Target};
use crate::esp::key::InstanceKey;
use crate::random::Stream;
use std::collections::{BTreeMap, BTreeSet};

/// A control of two parents, aligned by index and cut at one or two places. A node brings its inputs and
/// outputs; the list ends where that of the parent at hand does.
pub(super) fn crossover(first: &Control, second: &Control, ground: &Ground, stream: &mut Stream) -> Control {
    // A cut behind the shorter list's end would come too late.
    let shortest = first.nodes.len().min(second.nodes.len()).max(1);
    let cuts: Vec<usize> = (0..stream.within(1, 2)).map(|_| stream.within(1, shortest)).collect();
    let parent = |index: usize| match cuts.iter().filter(|&&cut| cut <= index).count() % 2 {
        0 => first,
        _ => second,
    };
    let mut child = Control::new(first.skill);
    child.seal = first.seal;
    let mut driven = BTreeSet::new();
    while let Some(node) = parent(child.nodes.len()).nodes.get(child.nodes.len()) {
        let index = child.nodes.len();
        child.nodes.push(node.clone());
        for output in parent(index).outputs.iter().filter(|output| usize::from(output.node) == index) {
            let single = matches!(output.target, Target::Muscle(_));
            if !single || driven.insert(&output.target) {
                child.outputs.push(output.clone());
            }
        }
    }
    let count = child.nodes.len();
    for source in child.nodes.iter_mut().flat_map(|node| node.inputs.iter_mut().flatten()) {
        if matches!(source, Source::Node(node) if usize::from(*node) >= count) {
            *source = ground.random_source(count, stream);
        }
    }
    limit_wires(&mut child);
    child
}

/// Adds every node that feeds a grafted muscle, and drives it; stops where there is no room.
pub(super) fn graft(
    control: &mut Control,
    donor: &Control,
    rename: impl Fn(&InstanceKey) -> Option<InstanceKey>,
) {
    let mut ids = BTreeMap::new();
    for output in &donor.outputs {
        let Target::Muscle(key) = &output.target else { continue };
        let Some(target) = rename(key).map(Target::Muscle) else { continue };
        let new: Vec<u16> =
            feeders(donor, output.node).into_iter().filter(|node| !ids.contains_key(node)).collect();
        let wires =
            1 + new.iter().map(|&node| donor.nodes[usize::from(node)].sources().count()).sum::<usize>();
        if control.nodes.len() + new.len() > NODES_MAX || control.wires() + wires > WIRES_MAX {
            return;
        }
        if control.outputs.iter().any(|output| output.target == target) {
            continue;
        }
        let first = control.nodes.len();
        ids.extend(new.iter().enumerate().map(|(place, &node)| (node, (first + place) as u16)));
        for node in new {
            let Node { kind, inputs } = &donor.nodes[usize::from(node)];
            let source = |source: &Source| match source {
                Source::Node(node) => Some(Source::Node(ids[node])),
                Source::Length(key) => rename(key).map(Source::Length),
                Source::Photo(key) => rename(key).map(Source::Photo),
                Source::Sensor(sensor) => Some(Source::Sensor(*sensor)),
            };
            let inputs = inputs.iter().map(|slot| slot.as_ref().and_then(source)).collect();
            let mut node = Node { kind: *kind, inputs };
            node.trim();
            control.nodes.push(node);
        }
        control.outputs.push(Output { node: ids[&output.node], target });
    }
}

/// A node and all that it reads, directly or in a chain.
fn feeders(control: &Control, node: u16) -> BTreeSet<u16> {
    let mut found = BTreeSet::from([node]);
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        for source in control.nodes[usize::from(node)].sources() {
            if let Source::Node(feeder) = source
                && found.insert(*feeder)
            {
                open.push(*feeder);
            }
        }
    }
    found
}

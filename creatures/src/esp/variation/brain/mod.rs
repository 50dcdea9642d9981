//! How the control of the skill that is open varies: founders, mutation, crossover, grafting (E-39..E-42). It
//! selects nobody, never touches what is locked, and keeps every brain legal.

mod ground;
mod mating;
mod mutation;

pub use mutation::Operator;

use crate::esp::brain::genotype::NODES_MAX;
use crate::esp::brain::{Brain, Control, Instances, Node, NodeKind, Output, Seal};
use crate::esp::key::InstanceKey;
use crate::esp::syllabus::{SkillId, Syllabus};
use crate::random::Stream;
use ground::Ground;
use std::ops::RangeInclusive;

/// Nodes of the first skill's control in a founder (E-42).
pub const FIRST_NODES: RangeInclusive<usize> = 3..=10;
/// Nodes with which a later skill starts (E-42).
pub const NEW_NODES: RangeInclusive<usize> = 2..=6;

impl Brain {
    /// Adds a random control for a skill, open (E-42): the first of a brain has 3 to 10 nodes, a later one 2 to 6,
    /// and in one that drives muscles at least one oscillates. Each target is driven with probability 1/2, and at
    /// least one is if there is any.
    ///
    /// The skill is of the syllabus and has no control yet; the skills that it uses are encapsulated.
    pub fn begin(&mut self, skill: SkillId, body: &Instances, syllabus: &Syllabus, stream: &mut Stream) {
        let nodes = if self.controls.is_empty() { FIRST_NODES } else { NEW_NODES };
        let mut control = Control::new(skill);
        let count = stream.within(*nodes.start(), *nodes.end());
        let ground = Ground::of(&control, body, syllabus);
        control.nodes = (0..count).map(|_| ground.random_node(count, stream)).collect();
        if ground.drives_body {
            let sine = NodeKind::Sinusoidal { frequency: 0.1, phase: 0.0 };
            control.nodes[0] = Node { kind: ground::redraw(sine, stream), inputs: Vec::new() };
        }
        let targets = ground.free_targets(&control);
        let certain = if targets.is_empty() { 0 } else { stream.below(targets.len()) };
        for (place, target) in targets.into_iter().enumerate() {
            if place == certain || stream.chance(0.5) {
                control.outputs.push(Output { node: stream.below(count) as u16, target });
            }
        }
        self.controls.push(control);
    }

    /// One mutation of the open control, drawn by weight among those that it allows, and its name. None if no
    /// control is open or nothing can be changed.
    pub fn mutate(
        &mut self,
        body: &Instances,
        syllabus: &Syllabus,
        stream: &mut Stream,
    ) -> Option<&'static str> {
        let control = self.open_mut()?;
        let ground = Ground::of(control, body, syllabus);
        mutation::mutate(control, &ground, stream).map(Operator::name)
    }

    /// A child with the locked controls of this parent, and an open one of both (E-39): node lists are cut at
    /// one or two places, each node brings its inputs and outputs, references out of range are drawn anew.
    /// Wires to what `body`, the child's, does not express are dropped.
    pub fn crossover(
        &self,
        other: &Brain,
        body: &Instances,
        syllabus: &Syllabus,
        stream: &mut Stream,
    ) -> Brain {
        let mut child = self.clone();
        if let Some(control) = child.open_mut()
            && let Some(second) = other.control(control.skill)
        {
            let ground = Ground::of(control, body, syllabus);
            *control = mating::crossover(control, second, &ground, stream);
        }
        child.prune(body);
        child
    }

    /// Adds to the open control what in a donor's control of the same skill feeds grafted muscles (E-40).
    ///
    /// `rename` gives the keys that instances of the donor's body have in this one, none for those that did not
    /// come along. What has no room is left out.
    pub fn graft(&mut self, donor: &Brain, rename: impl Fn(&InstanceKey) -> Option<InstanceKey>) {
        if let Some(control) = self.open_mut()
            && let Some(donor) = donor.control(control.skill)
        {
            mating::graft(control, donor, rename);
        }
    }

    fn open_mut(&mut self) -> Option<&mut Control> {
        self.controls.iter_mut().find(|control| control.seal != Seal::Locked)
    }
}

impl Control {
    /// Removes a node with its outputs; what read it reads nothing, references to later ones follow them.
    fn remove_node(&mut self, removed: u16) {
        self.nodes.remove(usize::from(removed));
        self.rewire(|node| match node.cmp(&removed) {
            std::cmp::Ordering::Less => Some(node),
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Greater => Some(node - 1),
        });
    }

    /// Gives every reference to a node a new id, or drops its wire.
    fn rewire(&mut self, id: impl Fn(u16) -> Option<u16>) {
        use crate::esp::brain::Source;
        for node in &mut self.nodes {
            for slot in &mut node.inputs {
                *slot = match slot.take() {
                    Some(Source::Node(node)) => id(node).map(Source::Node),
                    sense => sense,
                };
            }
            node.trim();
        }
        self.outputs.retain_mut(|output| match id(output.node) {
            Some(node) => {
                output.node = node;
                true
            }
            None => false,
        });
    }

    fn has_room_for_node(&self) -> bool {
        self.nodes.len() < NODES_MAX
    }
}

#[cfg(test)]
mod tests;

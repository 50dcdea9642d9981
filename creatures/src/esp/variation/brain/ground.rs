//! What the wires of one skill may end at, and draws from it (E-35).

use crate::esp::brain::genotype::WIRES_MAX;
use crate::esp::brain::{Control, Instances, Node, NodeKind, Source, Target};
use crate::esp::syllabus::{Sensor, SkillId, Syllabus};
use crate::random::Stream;

/// The most inputs that a drawn node of any number of inputs starts with.
const DRAWN_INPUTS_MAX: usize = 3;

/// The surroundings of a control.
#[derive(Debug)]
pub(super) struct Ground<'a> {
    pub(super) body: &'a Instances,
    sensors: &'a [Sensor],
    uses: &'a [SkillId],
    pub(super) drives_body: bool,
}

impl<'a> Ground<'a> {
    pub(super) fn of(control: &Control, body: &'a Instances, syllabus: &'a Syllabus) -> Ground<'a> {
        let skill = syllabus.skill(control.skill).expect("the brain was checked against the syllabus");
        Ground { body, sensors: skill.sensors(), uses: skill.uses(), drives_body: skill.drives_body() }
    }

    /// What the control may drive, and does not yet.
    pub(super) fn free_targets(&self, control: &Control) -> Vec<Target> {
        let muscles = self.body.muscles.iter().filter(|_| self.drives_body).cloned().map(Target::Muscle);
        let skills = self.uses.iter().copied().map(Target::Skill);
        let driven = |target: &Target| control.outputs.iter().any(|output| output.target == *target);
        muscles.chain(skills).filter(|target| !driven(target)).collect()
    }

    /// A source: one of so many nodes as often as a sense, and each kind of sense as often as another.
    pub(super) fn random_source(&self, nodes: usize, stream: &mut Stream) -> Source {
        let Instances { muscles, photos } = self.body;
        let kinds = [muscles.len(), photos.len(), self.sensors.len()];
        let kinds: Vec<usize> = (0..kinds.len()).filter(|&kind| kinds[kind] > 0).collect();
        if kinds.is_empty() || stream.chance(0.5) {
            return Source::Node(stream.below(nodes) as u16);
        }
        match kinds[stream.below(kinds.len())] {
            0 => Source::Length(muscles[stream.below(muscles.len())].clone()),
            1 => Source::Photo(photos[stream.below(photos.len())].clone()),
            _ => Source::Sensor(self.sensors[stream.below(self.sensors.len())]),
        }
    }

    /// A node of any type, with parameters uniform in their ranges and every slot wired; one of any number of
    /// inputs gets 1 to 3. `nodes` is how many its control has with it.
    pub(super) fn random_node(&self, nodes: usize, stream: &mut Stream) -> Node {
        let kind = redraw(NodeKind::ALL[stream.below(NodeKind::ALL.len())], stream);
        let mut node = Node { kind, inputs: Vec::new() };
        self.fill(&mut node, nodes, stream);
        node
    }

    /// Wires the slots that are empty.
    pub(super) fn fill(&self, node: &mut Node, nodes: usize, stream: &mut Stream) {
        if node.kind.is_variadic() {
            let count = stream.within(1, DRAWN_INPUTS_MAX);
            while node.inputs.len() < count {
                node.inputs.push(Some(self.random_source(nodes, stream)));
            }
        } else {
            node.inputs.resize(node.kind.slots(), None);
            for slot in node.inputs.iter_mut().filter(|slot| slot.is_none()) {
                *slot = Some(self.random_source(nodes, stream));
            }
        }
    }
}

/// The same type of node with other parameters, each uniform in its range.
pub(super) fn redraw(kind: NodeKind, stream: &mut Stream) -> NodeKind {
    kind.map_parameters(|_, _, range| stream.between(*range.start(), *range.end()))
}

/// Takes out the last inputs of the last nodes until the wires are as few as is legal.
pub(super) fn limit_wires(control: &mut Control) {
    let mut excess = control.wires().saturating_sub(WIRES_MAX);
    for node in control.nodes.iter_mut().rev() {
        while excess > 0 && node.inputs.pop().is_some() {
            node.trim();
            excess = excess.saturating_sub(1);
        }
    }
}

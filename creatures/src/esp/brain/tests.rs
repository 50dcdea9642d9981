//! Brains for tests: random legal ones of the ten skills, bodies to wire them to, and senses to feed them with.

use super::node::SLOTS_MAX;
use super::*;
use crate::esp::key::{GeneId, InstanceKey, Step};
use crate::esp::syllabus::{Sensor, Syllabus};
use crate::random::{Stream, stream};

/// The key of a muscle or receptor on the root.
pub(in crate::esp) fn key(gene: u32) -> InstanceKey {
    InstanceKey { part: vec![], gene: GeneId(gene) }
}

/// A body of four muscles and three receptors, not all on the root.
pub(in crate::esp) fn body() -> Instances {
    let far = |gene, copy| InstanceKey { part: vec![Step(GeneId(7), copy)], gene: GeneId(gene) };
    Instances {
        muscles: vec![key(0), key(1), far(2, 0), far(2, 1)],
        photos: vec![key(3), far(4, 0), far(4, 1)],
    }
}

/// A random brain of all the skills, each encapsulated.
pub(in crate::esp) fn legal_brain(seed: u64, syllabus: &Syllabus) -> Brain {
    let body = body();
    let mut draws = stream(seed, [0, 0, 0], "brain for a test");
    let controls = syllabus.ids().map(|id| {
        let skill = syllabus.skill(id).unwrap();
        let count = draws.within(2, 8);
        let nodes = (0..count).map(|_| random_node(count, &body, skill.sensors(), &mut draws)).collect();
        let mut targets: Vec<Target> = skill.uses().iter().map(|&used| Target::Skill(used)).collect();
        if skill.drives_body() {
            targets.extend(body.muscles.iter().cloned().map(Target::Muscle));
        }
        let outputs =
            targets.into_iter().map(|target| Output { node: draws.below(count) as u16, target }).collect();
        Control { skill: id, seal: Seal::Locked, nodes, outputs }
    });
    Brain { controls: controls.collect() }
}

fn random_node(nodes: usize, body: &Instances, sensors: &[Sensor], draws: &mut Stream) -> Node {
    let kind = NodeKind::ALL[draws.below(NodeKind::ALL.len())];
    let kind = kind.map_parameters(|_, _, range| draws.between(*range.start(), *range.end()));
    let source = |draws: &mut Stream| match draws.below(5 + sensors.len()) {
        0..3 => Source::Node(draws.below(nodes) as u16),
        3 => Source::Length(body.muscles[draws.below(body.muscles.len())].clone()),
        4 => Source::Photo(body.photos[draws.below(body.photos.len())].clone()),
        sensor => Source::Sensor(sensors[sensor - 5]),
    };
    let inputs = (0..kind.slots().min(SLOTS_MAX / 2)).map(|_| draws.chance(0.9).then(|| source(draws)));
    let mut node = Node { kind, inputs: inputs.collect() };
    node.trim();
    node
}

/// Fills in random senses of a tick, the same for every circuit.
pub(in crate::esp) fn senses(seed: u64, tick: u32, circuit: &mut Circuit) {
    let mut draws = stream(seed, [0, 0, tick], "senses for a test");
    for sense in circuit.lengths_mut() {
        *sense = draws.unit();
    }
    for sense in circuit.photos_mut() {
        *sense = draws.unit();
    }
    for sense in circuit.sensors_mut() {
        *sense = draws.unit();
    }
}

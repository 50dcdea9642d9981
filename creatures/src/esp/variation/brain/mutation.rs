//! Mutation of a control: one event of the brain's row of E-41.

use super::ground::{Ground, redraw};
use crate::esp::brain::genotype::WIRES_MAX;
use crate::esp::brain::{Control, Node, NodeKind, Output, Source, Target};
use crate::esp::key::InstanceKey;
use crate::random::Stream;

/// Standard deviation of a moved parameter, as a share of its range.
const DEVIATION: f64 = 0.1;
/// The share of moved parameters that are drawn anew instead.
const REDRAWN: f64 = 0.1;
/// The wires that drawing one node brings at most: those of its slots, and one from it.
const NODE_WIRES: usize = 4;

/// The kinds of event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// Moves one parameter of one node.
    Parameter,
    /// Gives one node another type; it keeps the inputs that it has slots for.
    Type,
    /// Puts a node into one wire.
    Split,
    /// Adds a node with inputs, and a wire from it.
    AddNode,
    /// Removes a node with its wires.
    RemoveNode,
    /// Adds a wire into an empty slot or to a target.
    AddWire,
    /// Removes a wire.
    RemoveWire,
    /// Moves one end of a wire.
    RedirectWire,
    /// Wires an instance of a muscle or receptor as a sibling of the same gene is wired.
    CopyWiring,
}

impl Operator {
    /// Every operator with its weight.
    const WEIGHTS: [(Operator, f64); 9] = [
        (Operator::Parameter, 6.0),
        (Operator::Type, 1.5),
        (Operator::Split, 2.0),
        (Operator::AddNode, 2.0),
        (Operator::RemoveNode, 1.0),
        (Operator::AddWire, 4.0),
        (Operator::RemoveWire, 2.0),
        (Operator::RedirectWire, 2.0),
        (Operator::CopyWiring, 1.0),
    ];

    /// Its name in the lineage.
    pub fn name(self) -> &'static str {
        match self {
            Operator::Parameter => "parameter",
            Operator::Type => "node_type",
            Operator::Split => "split_wire",
            Operator::AddNode => "add_node",
            Operator::RemoveNode => "remove_node",
            Operator::AddWire => "add_wire",
            Operator::RemoveWire => "remove_wire",
            Operator::RedirectWire => "redirect_wire",
            Operator::CopyWiring => "copy_wiring",
        }
    }

    fn is_legal(self, control: &Control, ground: &Ground) -> bool {
        let wires = control.wires();
        match self {
            Operator::Parameter => control.nodes.iter().any(|node| parameters(node.kind) > 0),
            Operator::Type => !control.nodes.is_empty() && wires + NODE_WIRES <= WIRES_MAX,
            Operator::Split => wires > 0 && control.has_room_for_node() && wires + NODE_WIRES <= WIRES_MAX,
            Operator::AddNode => control.has_room_for_node() && wires + NODE_WIRES <= WIRES_MAX,
            Operator::RemoveNode => control.nodes.len() > 1,
            Operator::AddWire => wires < WIRES_MAX && !gaps(control, ground).is_empty(),
            Operator::RemoveWire | Operator::RedirectWire => wires > 0,
            Operator::CopyWiring => wires < WIRES_MAX && !copies(control, ground).is_empty(),
        }
    }

    fn apply(self, control: &mut Control, ground: &Ground, stream: &mut Stream) {
        let count = control.nodes.len();
        match self {
            Operator::Parameter => move_parameter(control, stream),
            Operator::Type => {
                let node = &mut control.nodes[stream.below(count)];
                let other =
                    |kind: &NodeKind| std::mem::discriminant(kind) != std::mem::discriminant(&node.kind);
                let kinds: Vec<NodeKind> = NodeKind::ALL.into_iter().filter(other).collect();
                node.kind = redraw(kinds[stream.below(kinds.len())], stream);
                node.inputs.truncate(node.kind.slots());
                node.trim();
                ground.fill(node, count, stream);
            }
            Operator::Split => {
                let wire = pick(wires(control), stream);
                insert(wire, control, ground, stream);
            }
            Operator::AddNode => {
                control.nodes.push(ground.random_node(count + 1, stream));
                let gaps = gaps(control, ground);
                if !gaps.is_empty() {
                    connect(pick(gaps, stream), Some(count as u16), control, ground, stream);
                }
            }
            Operator::RemoveNode => control.remove_node(stream.below(count) as u16),
            Operator::AddWire => connect(pick(gaps(control, ground), stream), None, control, ground, stream),
            Operator::RemoveWire => match pick(wires(control), stream) {
                Wire::Input(node, slot) => {
                    control.nodes[node].inputs[slot] = None;
                    control.nodes[node].trim();
                }
                Wire::Output(index) => drop(control.outputs.remove(index)),
            },
            Operator::RedirectWire => redirect(pick(wires(control), stream), control, ground, stream),
            Operator::CopyWiring => match pick(copies(control, ground), stream) {
                Copy::Drive(output) => {
                    control.outputs.retain(|other| other.target != output.target);
                    control.outputs.push(output);
                }
                Copy::Read(node, source) => control.nodes[node].inputs.push(Some(source)),
            },
        }
    }
}

/// One event; none if no operator is legal.
pub(super) fn mutate(control: &mut Control, ground: &Ground, stream: &mut Stream) -> Option<Operator> {
    let legal = Operator::WEIGHTS.into_iter().filter(|(operator, _)| operator.is_legal(control, ground));
    let legal: Vec<(Operator, f64)> = legal.collect();
    let mut draw = stream.unit() * legal.iter().map(|(_, weight)| weight).sum::<f64>();
    let drawn = legal.iter().find(|(_, weight)| {
        draw -= weight;
        draw < 0.0
    });
    let (operator, _) = *drawn.or(legal.last())?;
    operator.apply(control, ground, stream);
    Some(operator)
}

/// A wire of a control: a slot of a node, or one of the outputs.
#[derive(Debug, Clone, Copy)]
enum Wire {
    Input(usize, usize),
    Output(usize),
}

/// Where a wire may be added.
#[derive(Debug, Clone)]
enum Gap {
    Slot(usize, usize),
    Target(Target),
}

/// A wire that a sibling has.
#[derive(Debug, Clone)]
enum Copy {
    Drive(Output),
    Read(usize, Source),
}

fn wires(control: &Control) -> Vec<Wire> {
    let inputs = control.nodes.iter().enumerate().flat_map(|(node, gene)| {
        let wired = gene.inputs.iter().enumerate().filter(|(_, slot)| slot.is_some());
        wired.map(move |(slot, _)| Wire::Input(node, slot))
    });
    inputs.chain((0..control.outputs.len()).map(Wire::Output)).collect()
}

/// Empty slots, one a node of any number of inputs, and targets that are not driven.
fn gaps(control: &Control, ground: &Ground) -> Vec<Gap> {
    if control.nodes.is_empty() {
        return Vec::new();
    }
    let slots = control.nodes.iter().enumerate().flat_map(|(node, gene)| {
        let inputs = &gene.inputs;
        let end = if gene.kind.is_variadic() { inputs.len() + 1 } else { usize::MAX };
        let slots = 0..gene.kind.slots().min(end);
        let empty = slots.filter(|&slot| inputs.get(slot).is_none_or(Option::is_none));
        empty.map(move |slot| Gap::Slot(node, slot)).collect::<Vec<_>>()
    });
    slots.chain(ground.free_targets(control).into_iter().map(Gap::Target)).collect()
}

/// Fills a gap from a node, or from anywhere.
fn connect(gap: Gap, from: Option<u16>, control: &mut Control, ground: &Ground, stream: &mut Stream) {
    let count = control.nodes.len();
    match gap {
        Gap::Slot(node, slot) => {
            let source = from.map_or_else(|| ground.random_source(count, stream), Source::Node);
            let inputs = &mut control.nodes[node].inputs;
            if inputs.len() <= slot {
                inputs.resize(slot + 1, None);
            }
            inputs[slot] = Some(source);
        }
        Gap::Target(target) => {
            let node = from.unwrap_or_else(|| stream.below(count) as u16);
            control.outputs.push(Output { node, target });
        }
    }
}

/// Puts a node into a wire: what came over the wire is its first input.
fn insert(wire: Wire, control: &mut Control, ground: &Ground, stream: &mut Stream) {
    let new = control.nodes.len() as u16;
    let with_inputs: Vec<NodeKind> = NodeKind::ALL.into_iter().filter(|kind| kind.slots() > 0).collect();
    let kind = redraw(with_inputs[stream.below(with_inputs.len())], stream);
    let source = match wire {
        Wire::Input(node, slot) => control.nodes[node].inputs[slot].replace(Source::Node(new)),
        Wire::Output(index) => {
            let output = &mut control.outputs[index];
            Some(Source::Node(std::mem::replace(&mut output.node, new)))
        }
    };
    let mut node = Node { kind, inputs: vec![source] };
    ground.fill(&mut node, control.nodes.len() + 1, stream);
    control.nodes.push(node);
}

/// Draws one end of a wire anew: the source of an input, either end of an output.
fn redirect(wire: Wire, control: &mut Control, ground: &Ground, stream: &mut Stream) {
    let count = control.nodes.len();
    match wire {
        Wire::Input(node, slot) => {
            control.nodes[node].inputs[slot] = Some(ground.random_source(count, stream));
        }
        Wire::Output(index) => {
            let targets = ground.free_targets(control);
            let output = &mut control.outputs[index];
            if targets.is_empty() || stream.chance(0.5) {
                output.node = stream.below(count) as u16;
            } else {
                output.target = targets[stream.below(targets.len())].clone();
            }
        }
    }
}

fn move_parameter(control: &mut Control, stream: &mut Stream) {
    let nodes: Vec<&mut Node> = control.nodes.iter_mut().filter(|node| parameters(node.kind) > 0).collect();
    let node = pick(nodes, stream);
    let mut chosen = stream.below(parameters(node.kind));
    node.kind = node.kind.map_parameters(|_, value, range| {
        let (low, high) = range.into_inner();
        let Some(later) = chosen.checked_sub(1) else {
            chosen = usize::MAX;
            let moved = value + DEVIATION * (high - low) * stream.normal();
            return if stream.chance(REDRAWN) { stream.between(low, high) } else { moved.clamp(low, high) };
        };
        chosen = later;
        value
    });
}

fn parameters(kind: NodeKind) -> usize {
    let mut count = 0;
    kind.map_parameters(|_, value, _| {
        count += 1;
        value
    });
    count
}

/// What an instance could be given that a sibling has: the node that drives a muscle, and, where a node takes
/// any number of inputs, that it is read.
fn copies(control: &Control, ground: &Ground) -> Vec<Copy> {
    let mut copies = Vec::new();
    for output in &control.outputs {
        let Target::Muscle(key) = &output.target else { continue };
        for sibling in siblings(key, &ground.body.muscles) {
            let copy = Output { node: output.node, target: Target::Muscle(sibling.clone()) };
            if !control.outputs.contains(&copy) {
                copies.push(Copy::Drive(copy));
            }
        }
    }
    for (place, node) in control.nodes.iter().enumerate() {
        if !node.kind.is_variadic() || node.inputs.len() >= node.kind.slots() {
            continue;
        }
        for source in node.sources() {
            let read: Vec<Source> = match source {
                Source::Length(key) => {
                    siblings(key, &ground.body.muscles).cloned().map(Source::Length).collect()
                }
                Source::Photo(key) => {
                    siblings(key, &ground.body.photos).cloned().map(Source::Photo).collect()
                }
                Source::Node(_) | Source::Sensor(_) => continue,
            };
            let unread = read.into_iter().filter(|source| node.sources().all(|other| other != source));
            copies.extend(unread.map(|source| Copy::Read(place, source)));
        }
    }
    copies
}

fn siblings<'a>(key: &InstanceKey, all: &'a [InstanceKey]) -> impl Iterator<Item = &'a InstanceKey> {
    all.iter().filter(move |other| other.gene == key.gene && *other != key)
}

fn pick<T>(mut items: Vec<T>, stream: &mut Stream) -> T {
    items.swap_remove(stream.below(items.len()))
}

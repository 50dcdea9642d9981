//! Compiling nodes and wires: names become indices into flat arrays. Where a wire leads nowhere, silence stands.

use super::Cell;
use super::sigma::Link;
use crate::esp::brain::genotype::{Brain, Instances, Source, Target};
use crate::esp::syllabus::Sensor;

/// The index of the signal that is always 0.
const SILENCE: u32 = 0;

/// The flat arrays of a circuit.
pub(super) struct Wiring {
    pub(super) cells: Vec<Cell>,
    pub(super) inputs: Vec<u32>,
    /// Length of the memory.
    pub(super) memory: usize,
    pub(super) links: Vec<Link>,
    pub(super) link_starts: Vec<u32>,
    /// Number of signals.
    pub(super) signals: usize,
    /// The signal of each control's first node, in the brain's order.
    pub(super) nodes: Vec<u32>,
}

impl Wiring {
    pub(super) fn of(brain: &Brain, body: &Instances) -> Wiring {
        let senses = 1 + body.muscles.len() + body.photos.len() + Sensor::ALL.len();
        let mut wiring = Wiring {
            cells: Vec::new(),
            inputs: Vec::new(),
            memory: 0,
            links: Vec::new(),
            link_starts: vec![0],
            signals: senses,
            nodes: Vec::new(),
        };
        for control in &brain.controls {
            let first = index(wiring.signals);
            wiring.nodes.push(first);
            wiring.signals += control.nodes.len();
            for node in &control.nodes {
                let input = wiring.inputs.len();
                let signal = |source: &Source| signal(source, first, body);
                if node.kind.is_variadic() {
                    wiring.inputs.extend(node.sources().map(signal));
                } else {
                    let slot = |slot| node.inputs.get(slot).and_then(Option::as_ref).map_or(SILENCE, signal);
                    wiring.inputs.extend((0..node.kind.slots()).map(slot));
                }
                let memories = node.kind.memory();
                wiring.cells.push(Cell {
                    kind: node.kind,
                    input: index(input),
                    inputs: index(wiring.inputs.len() - input),
                    memory: index(wiring.memory),
                    memories: index(memories),
                });
                wiring.memory += memories;
            }
        }
        for muscle in &body.muscles {
            for (place, control) in brain.controls.iter().enumerate() {
                let drives = control
                    .outputs
                    .iter()
                    .filter(|output| matches!(&output.target, Target::Muscle(key) if key == muscle));
                let link =
                    |node: u16| Link { control: index(place), signal: wiring.nodes[place] + u32::from(node) };
                wiring.links.extend(drives.map(|output| link(output.node)));
            }
            wiring.link_starts.push(index(wiring.links.len()));
        }
        wiring
    }
}

/// The signal of a source, silence for one that the body does not express. `first` is that of the skill's first
/// node.
fn signal(source: &Source, first: u32, body: &Instances) -> u32 {
    let place = match source {
        Source::Node(node) => return first + u32::from(*node),
        Source::Length(key) => body.muscles.iter().position(|muscle| muscle == key),
        Source::Photo(key) => {
            body.photos.iter().position(|photo| photo == key).map(|place| body.muscles.len() + place)
        }
        Source::Sensor(sensor) => {
            let place = Sensor::ALL.iter().position(|known| known == sensor);
            place.map(|place| body.muscles.len() + body.photos.len() + place)
        }
    };
    place.map_or(SILENCE, |place| 1 + index(place))
}

/// Brains are far below 2³² of anything.
pub(super) fn index(count: usize) -> u32 {
    u32::try_from(count).expect("a legal brain has few nodes and wires")
}

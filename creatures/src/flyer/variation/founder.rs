//! Founders: genotypes drawn at random (F-11), and the random nodes of which they are made.

use super::Settings;
use super::sources::Offer;
use crate::flyer::genotype::{
    BODY, BODY_RADIUS, FIRST_SEGMENT, LENGTH, NODES, PSI, THETA, WING_RADIUS, effectors,
};
use crate::flyer::skeleton::{grow, intersects_itself};
use crate::flyer::{Effector, Genotype, Neuron, Node};
use crate::random::Stream;
use std::ops::RangeInclusive;

/// How often a founder whose films cross is drawn again (F-11).
const REDRAWS: usize = 100;

impl Genotype {
    /// A founder: 1 to 8 wing segments, every gene uniform in its range, every input uniform over all
    /// sensors and neurons (F-11).
    pub fn random(settings: &Settings, stream: &mut Stream) -> Genotype {
        let mut genotype = Genotype::without_crossing_films(stream);
        for node in &mut genotype.nodes {
            node.neurons = draw_neurons(settings, stream);
        }
        let offer = Offer::of(&genotype);
        for inputs in genotype.inputs_mut() {
            *inputs = offer.draw_inputs(offer.everywhere(), settings, stream);
        }
        genotype
    }

    /// Nodes without neurons and inputs, which have no part in where the films are. Those whose films cross
    /// are drawn again; the last draw is kept anyway.
    fn without_crossing_films(stream: &mut Stream) -> Genotype {
        let mut genotype = Genotype::bones(stream);
        for _ in 0..REDRAWS {
            if !intersects_itself(&grow(&genotype, 0.0)) {
                break;
            }
            genotype = Genotype::bones(stream);
        }
        genotype
    }

    /// One draw of such nodes.
    pub(super) fn bones(stream: &mut Stream) -> Genotype {
        let count = stream.within(*NODES.start(), *NODES.end());
        Genotype { nodes: (0..count).map(|node| Node::bone(node, stream)).collect() }
    }
}

impl Node {
    /// A node with neurons, still without inputs.
    pub(super) fn random(index: usize, settings: &Settings, stream: &mut Stream) -> Node {
        let bone = Node::bone(index, stream);
        Node { neurons: draw_neurons(settings, stream), ..bone }
    }

    /// A node without neurons, its effectors still without inputs.
    fn bone(index: usize, stream: &mut Stream) -> Node {
        let mut uniform = |range: RangeInclusive<f64>| stream.between(*range.start(), *range.end());
        let length = uniform(LENGTH);
        let radius = if index == BODY { uniform(BODY_RADIUS) } else { WING_RADIUS };
        let (mut lpercent, mut theta, mut psi) = (0, 0.0, 0.0);
        if index >= FIRST_SEGMENT {
            (theta, psi) = (uniform(THETA), uniform(PSI));
            lpercent = u8::from(stream.chance(0.5));
        }
        let effectors = vec![Effector { inputs: Vec::new() }; effectors(index)];
        Node { length, radius, lpercent, theta, psi, neurons: Vec::new(), effectors }
    }
}

fn draw_neurons(settings: &Settings, stream: &mut Stream) -> Vec<Neuron> {
    (0..stream.within(1, settings.max_neurons)).map(|_| Neuron::random(settings, stream)).collect()
}

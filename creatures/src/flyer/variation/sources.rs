//! Where inputs are drawn from, and how they follow their nodes when these move (F-63, F-64). It decides
//! neither which nodes move nor how many inputs there are.

use super::Settings;
use crate::flyer::genotype::{DELAY, INPUTS_MAX, sensors};
use crate::flyer::{Genotype, Kind, Neuron, Node, Source};
use crate::random::Stream;
use std::ops::Range;

/// What the nodes of a genotype offer to inputs: their sensors and neurons (F-10).
pub(super) struct Offer {
    /// Neurons by node.
    neurons: Vec<usize>,
}

impl Offer {
    pub(super) fn of(genotype: &Genotype) -> Offer {
        Offer { neurons: genotype.nodes.iter().map(|node| node.neurons.len()).collect() }
    }

    /// The whole genotype.
    pub(super) fn everywhere(&self) -> Range<usize> {
        0..self.neurons.len()
    }

    /// A node and those before and after it.
    pub(super) fn near(&self, node: usize) -> Range<usize> {
        node.saturating_sub(1)..self.neurons.len().min(node + 2)
    }

    /// A source, uniform over all sensors and neurons of some nodes; one of them is not the body, and so
    /// has sensors.
    pub(super) fn draw(&self, among: Range<usize>, settings: &Settings, stream: &mut Stream) -> Source {
        let offered = |node: usize| sensors(node) + self.neurons[node];
        let mut draw = stream.below(among.clone().map(offered).sum());
        for node in among {
            if let Some(rest) = draw.checked_sub(offered(node)) {
                draw = rest;
                continue;
            }
            let (kind, index) = match draw.checked_sub(sensors(node)) {
                None => (Kind::Sensor, draw),
                Some(neuron) => (Kind::Neuron, neuron),
            };
            let cross = stream.chance(settings.cross);
            return Source { node: node as u8, kind, index: index as u8, cross };
        }
        unreachable!("a draw is below the number of sources")
    }

    /// One to three sources (F-11).
    pub(super) fn draw_inputs(
        &self,
        among: Range<usize>,
        settings: &Settings,
        stream: &mut Stream,
    ) -> Vec<Source> {
        let count = stream.within(1, INPUTS_MAX);
        (0..count).map(|_| self.draw(among.clone(), settings, stream)).collect()
    }
}

impl Genotype {
    /// The lists of inputs of every node.
    pub(super) fn inputs_mut(&mut self) -> impl Iterator<Item = &mut Vec<Source>> {
        self.nodes.iter_mut().flat_map(Node::inputs_mut)
    }

    /// Rewires every input after nodes or neurons have moved. `kept(reader, source)` says what has become
    /// of a source that the node `reader`, by its new place, still names by its old one; what is lost is
    /// replaced by a draw near the reader (F-64).
    pub(super) fn reconnect(
        &mut self,
        settings: &Settings,
        stream: &mut Stream,
        kept: impl Fn(usize, Source) -> Option<Source>,
    ) {
        let offer = Offer::of(self);
        for (reader, node) in self.nodes.iter_mut().enumerate() {
            for source in node.inputs_mut().flatten() {
                *source =
                    kept(reader, *source).unwrap_or_else(|| offer.draw(offer.near(reader), settings, stream));
            }
        }
    }

    /// As [`Genotype::reconnect`] after nodes have moved: `moved(reader, node)` is the new place of a node,
    /// if it has one that the reader may still name. A node of `torn` has lost or got a neighbour, and with
    /// it all inputs from other nodes.
    pub(super) fn reconnect_nodes(
        &mut self,
        torn: &[usize],
        settings: &Settings,
        stream: &mut Stream,
        moved: impl Fn(usize, usize) -> Option<usize>,
    ) {
        self.reconnect(settings, stream, |reader, source| {
            let node = moved(reader, usize::from(source.node))?;
            let holds = node == reader || !torn.contains(&reader);
            holds.then_some(Source { node: node as u8, ..source })
        });
    }
}

impl Node {
    /// The lists of inputs: those of the neurons, then those of the effectors.
    pub(super) fn inputs_mut(&mut self) -> impl Iterator<Item = &mut Vec<Source>> {
        let neurons = self.neurons.iter_mut().map(|neuron| &mut neuron.inputs);
        neurons.chain(self.effectors.iter_mut().map(|effector| &mut effector.inputs))
    }
}

impl Neuron {
    /// A neuron still without inputs.
    pub(super) fn random(settings: &Settings, stream: &mut Stream) -> Neuron {
        let function = settings.draw_function(stream);
        Neuron { function, delay: draw_delay(stream), inputs: Vec::new() }
    }
}

pub(super) fn draw_delay(stream: &mut Stream) -> u8 {
    stream.within(usize::from(*DELAY.start()), usize::from(*DELAY.end())) as u8
}

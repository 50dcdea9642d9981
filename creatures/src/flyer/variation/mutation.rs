//! Mutation: independent trials at each gene, neuron, input and node (F-65).

use super::Settings;
use super::sources::{Offer, draw_delay};
use crate::flyer::genotype::{
    BODY, BODY_RADIUS, FIRST_SEGMENT, INPUTS_MAX, LENGTH, NODES, PSI, THETA, WING_ROOT,
};
use crate::flyer::{Genotype, Kind, Neuron, Node, Source};
use crate::random::Stream;
use std::cmp::Ordering;
use std::ops::RangeInclusive;

/// One kind of mutation: makes its trials, and says whether any came true.
type Mutation = fn(&mut Genotype, &Settings, &mut Stream) -> bool;

/// Every kind, by the name of its probability, in the order of application.
const MUTATIONS: [(&str, Mutation); 11] = [
    ("scalar", Genotype::move_scalars),
    ("lpercent", Genotype::flip_ends),
    ("function", Genotype::redraw_functions),
    ("delay", Genotype::redraw_delays),
    ("add_neuron", Genotype::add_neurons),
    ("remove_neuron", Genotype::remove_neurons),
    ("redraw_input", Genotype::redraw_inputs),
    ("add_input", Genotype::add_inputs),
    ("remove_input", Genotype::remove_inputs),
    ("add_segment", Genotype::add_segment),
    ("remove_segment", Genotype::remove_segment),
];

impl Genotype {
    /// Makes every trial and names the mutations that came true, in order: `scalar`, `lpercent`,
    /// `function`, `delay`, `add_neuron`, `remove_neuron`, `redraw_input`, `add_input`, `remove_input`,
    /// `add_segment`, `remove_segment` (F-65). The list may be empty; what is drawn anew may come out equal.
    pub fn mutate(&mut self, settings: &Settings, stream: &mut Stream) -> Vec<&'static str> {
        let came_true = MUTATIONS.into_iter().filter(|(_, mutation)| mutation(self, settings, stream));
        came_true.map(|(name, _)| name).collect()
    }

    fn move_scalars(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let scalars = self.nodes.iter_mut().enumerate().flat_map(|(index, node)| node.scalars_mut(index));
        each(scalars, settings.scalar, stream, |(scalar, range), stream| {
            let deviation = settings.sigma * (range.end() - range.start());
            *scalar = reflect(*scalar + deviation * stream.normal(), range);
        })
    }

    fn flip_ends(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let segments = self.nodes[FIRST_SEGMENT..].iter_mut();
        each(segments, settings.lpercent, stream, |node, _| node.lpercent = 1 - node.lpercent)
    }

    fn redraw_functions(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        each(self.neurons_mut(), settings.function, stream, |neuron, stream| {
            neuron.function = settings.draw_function(stream);
        })
    }

    fn redraw_delays(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        each(self.neurons_mut(), settings.delay, stream, |neuron, stream| neuron.delay = draw_delay(stream))
    }

    /// A new neuron may read every sensor and neuron, itself included.
    fn add_neurons(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let most = settings.max_neurons;
        let nodes = (0..self.nodes.len()).filter(|&index| self.nodes[index].neurons.len() < most);
        each(nodes.collect::<Vec<_>>(), settings.add_neuron, stream, |index, stream| {
            self.nodes[index].neurons.push(Neuron::random(settings, stream));
            let offer = Offer::of(self);
            let neuron = self.nodes[index].neurons.last_mut().expect("one was pushed");
            neuron.inputs = offer.draw_inputs(offer.everywhere(), settings, stream);
        })
    }

    fn remove_neurons(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let nodes = (0..self.nodes.len()).filter(|&index| !self.nodes[index].neurons.is_empty());
        each(nodes.collect::<Vec<_>>(), settings.remove_neuron, stream, |index, stream| {
            let removed = stream.below(self.nodes[index].neurons.len());
            self.remove_neuron(index, removed, settings, stream);
        })
    }

    /// Inputs from the neuron are lost, those from later ones of its node follow them (F-64).
    pub(super) fn remove_neuron(
        &mut self,
        node: usize,
        removed: usize,
        settings: &Settings,
        stream: &mut Stream,
    ) {
        self.nodes[node].neurons.remove(removed);
        self.reconnect(settings, stream, |_, source| {
            if source.kind == Kind::Sensor || usize::from(source.node) != node {
                return Some(source);
            }
            match usize::from(source.index).cmp(&removed) {
                Ordering::Less => Some(source),
                Ordering::Equal => None,
                Ordering::Greater => Some(Source { index: source.index - 1, ..source }),
            }
        });
    }

    fn redraw_inputs(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let offer = Offer::of(self);
        each(self.inputs_mut().flatten(), settings.redraw_input, stream, |source, stream| {
            *source = offer.draw(offer.everywhere(), settings, stream);
        })
    }

    fn add_inputs(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let offer = Offer::of(self);
        let lists = self.inputs_mut().filter(|inputs| inputs.len() < INPUTS_MAX);
        each(lists, settings.add_input, stream, |inputs, stream| {
            inputs.push(offer.draw(offer.everywhere(), settings, stream));
        })
    }

    fn remove_inputs(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let lists = self.inputs_mut().filter(|inputs| inputs.len() > 1);
        each(lists, settings.remove_input, stream, |inputs, stream| {
            inputs.remove(stream.below(inputs.len()));
        })
    }

    fn add_segment(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let happens = self.nodes.len() < *NODES.end() && stream.chance(settings.add_segment);
        if happens {
            let place = stream.within(FIRST_SEGMENT, self.nodes.len());
            self.insert_segment(place, settings, stream);
        }
        happens
    }

    /// A random wing segment with inputs from itself and its neighbours, which are reconnected (F-64).
    pub(super) fn insert_segment(&mut self, place: usize, settings: &Settings, stream: &mut Stream) {
        self.nodes.insert(place, Node::random(place, settings, stream));
        self.reconnect_nodes(&[place - 1, place + 1], settings, stream, |_, node| {
            Some(if node < place { node } else { node + 1 })
        });
        let offer = Offer::of(self);
        for inputs in self.nodes[place].inputs_mut() {
            *inputs = offer.draw_inputs(offer.near(place), settings, stream);
        }
    }

    fn remove_segment(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        let happens = self.nodes.len() > *NODES.start() && stream.chance(settings.remove_segment);
        if happens {
            let place = stream.within(FIRST_SEGMENT, self.nodes.len() - 1);
            self.delete_segment(place, settings, stream);
        }
        happens
    }

    /// Both neighbours of the wing segment are reconnected (F-64).
    pub(super) fn delete_segment(&mut self, place: usize, settings: &Settings, stream: &mut Stream) {
        self.nodes.remove(place);
        self.reconnect_nodes(&[place - 1, place], settings, stream, |_, node| match node.cmp(&place) {
            Ordering::Less => Some(node),
            Ordering::Equal => None,
            Ordering::Greater => Some(node - 1),
        });
    }

    fn neurons_mut(&mut self) -> impl Iterator<Item = &mut Neuron> {
        self.nodes.iter_mut().flat_map(|node| &mut node.neurons)
    }
}

impl Node {
    /// The genes that are numbers, with their ranges; what is fixed for the node is not among them (F-8).
    fn scalars_mut(&mut self, index: usize) -> Vec<(&mut f64, RangeInclusive<f64>)> {
        let mut scalars = vec![(&mut self.length, LENGTH)];
        match index {
            BODY => scalars.push((&mut self.radius, BODY_RADIUS)),
            WING_ROOT => {}
            _ => scalars.extend([(&mut self.theta, THETA), (&mut self.psi, PSI)]),
        }
        scalars
    }
}

/// Changes each item with a probability, and says whether any was.
fn each<T>(
    items: impl IntoIterator<Item = T>,
    probability: f64,
    stream: &mut Stream,
    mut change: impl FnMut(T, &mut Stream),
) -> bool {
    let mut any = false;
    for item in items {
        if stream.chance(probability) {
            change(item, stream);
            any = true;
        }
    }
    any
}

/// A value that has left its range, reflected once at the bound that it crossed, then clamped.
pub(super) fn reflect(value: f64, range: RangeInclusive<f64>) -> f64 {
    let (low, high) = range.into_inner();
    let reflected = if value < low {
        2.0 * low - value
    } else if value > high {
        2.0 * high - value
    } else {
        value
    };
    reflected.clamp(low, high)
}

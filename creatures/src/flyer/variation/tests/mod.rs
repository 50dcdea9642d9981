//! What each operator does and what it leaves alone (F-11, F-62..F-65, T-21).

use super::*;
use crate::flyer::genotype::effectors;
use crate::flyer::{Genotype, Kind, Neuron, Node, Source};
use crate::random::stream;
use proptest::prelude::*;

mod founders;
mod mating;
mod mutation;

fn draws(place: u32) -> Stream {
    stream(9, [0, 0, place], "variation test")
}

fn random(place: u32) -> Genotype {
    Genotype::random(&Settings::default(), &mut draws(place))
}

fn neuron_of(node: usize, index: u8) -> Source {
    Source { node: node as u8, kind: Kind::Neuron, index, cross: false }
}

/// A genotype in which each node has two neurons: the first reads the first neuron of every given node, at
/// most three, the second reads its own first. The mark tells the nodes of two such genotypes apart.
fn linked(count: usize, mark: f64, reads: impl Fn(usize) -> Vec<usize>) -> Genotype {
    let mut genotype = Genotype { nodes: Vec::new() };
    for index in 0..count {
        let mut node = Node::random(index, &Settings::default(), &mut draws(index as u32));
        node.length = 20.0 + index as f64 + mark;
        let neuron = |inputs| Neuron { function: Function::Average, delay: 40, inputs };
        let foreign = reads(index).into_iter().map(|node| neuron_of(node, 0)).collect();
        node.neurons = vec![neuron(foreign), neuron(vec![neuron_of(index, 0)])];
        genotype.nodes.push(node);
    }
    genotype
}

/// The nodes that the first neuron of a node reads.
fn read_by(genotype: &Genotype, node: usize) -> Vec<usize> {
    genotype.nodes[node].neurons[0].inputs.iter().map(|source| usize::from(source.node)).collect()
}

/// A node without inputs, as which it is the same before and after reconnection.
fn bare(node: &Node) -> Node {
    let mut node = node.clone();
    node.inputs_mut().for_each(Vec::clear);
    node
}

fn bare_all(nodes: &[Node]) -> Vec<Node> {
    nodes.iter().map(bare).collect()
}

fn assert_legal(genotype: &Genotype) {
    assert_eq!(&Genotype::decode(&genotype.encode()).unwrap(), genotype);
}

/// Whether a source is one that F-64 may draw for a node.
fn is_near(source: &Source, node: usize) -> bool {
    usize::from(source.node).abs_diff(node) <= 1
}

///
#[test]
fn settings_out_of_range_are_named() {
    let bad = [
        ("max_neurons", Settings { max_neurons: 1, ..Settings::default() }),
        ("max_neurons", Settings { max_neurons: 5, ..Settings::default() }),
        ("oscillators", Settings { oscillators: 1001, ..Settings::default() }),
        ("cross", Settings { cross: -0.1, ..Settings::default() }),
        ("scalar", Settings { scalar: f64::NAN, ..Settings::default() }),
        ("sigma", Settings { sigma: 1.1, ..Settings::default() }),
        ("add_input", Settings { add_input: f64::INFINITY, ..Settings::default() }),
        ("remove_segment", Settings { remove_segment: 2.0, ..Settings::default() }),
    ];
    for (key, settings) in bad {
        assert_eq!(settings.check().unwrap_err().path, key);
    }
    Settings::default().check().unwrap();
    Settings { oscillators: 0, ..Settings::default() }.check().unwrap();
}

proptest! {
    /// T-21: whatever the draws, a line of descent stays legal and survives its encoding, and a grafted
    /// child has body and wing-root of its first parent up to reconnected inputs.
    #[test]
    fn descent_stays_legal(seed: u64, max_neurons in 2..=NEURONS_MAX) {
        let settings = Settings { max_neurons, ..Settings::default() };
        let mut stream = stream(seed, [0, 0, 0], "variation test");
        let mut first = Genotype::random(&settings, &mut stream);
        let mut second = Genotype::random(&settings, &mut stream);
        for round in 0..40 {
            let mut child = if round % 2 == 0 {
                Genotype::crossover(&first, &second, &settings, &mut stream)
            } else {
                let child = Genotype::graft(&first, &second, &settings, &mut stream);
                prop_assert_eq!(bare_all(&child.nodes[..2]), bare_all(&first.nodes[..2]));
                child
            };
            prop_assert_eq!(&Genotype::decode(&child.encode()).unwrap(), &child);
            child.mutate(&settings, &mut stream);
            prop_assert_eq!(&Genotype::decode(&child.encode()).unwrap(), &child);
            for (index, node) in child.nodes.iter().enumerate() {
                prop_assert_eq!(node.effectors.len(), effectors(index));
                prop_assert!(node.neurons.len() <= max_neurons);
            }
            (first, second) = (second, child);
        }
    }
}

//! Founders (F-11).

use super::*;
use crate::flyer::genotype::{WING_ROOT, sensors};
use std::collections::BTreeMap;

/// F-11: counts of segments, neurons, inputs; where inputs come from; the weights of functions.
#[test]
fn founders_have_the_shares_of_the_requirement() {
    let (mut segments, mut neurons, mut inputs) = ([0; 9], [0; 5], [0; 4]);
    let mut functions: BTreeMap<Function, f64> = BTreeMap::new();
    let (mut crossed, mut links, mut from_root, mut expected_root) = (0.0, 0.0, 0.0, 0.0);
    let (mut ends, mut wing_nodes) = (0.0, 0.0);
    for place in 0..4000 {
        let founder = random(place);
        assert_legal(&founder);
        segments[founder.segments()] += 1;
        let count = |node: usize| sensors(node) + founder.nodes[node].neurons.len();
        let total: usize = (0..founder.nodes.len()).map(count).sum();
        for node in &founder.nodes {
            neurons[node.neurons.len()] += 1;
            for neuron in &node.neurons {
                *functions.entry(neuron.function).or_insert(0.0) += 1.0;
            }
            for source in node.sources() {
                links += 1.0;
                crossed += f64::from(u8::from(source.cross));
                from_root += f64::from(u8::from(usize::from(source.node) == WING_ROOT));
                expected_root += count(WING_ROOT) as f64 / total as f64;
            }
        }
        for list in founder.clone().inputs_mut() {
            inputs[list.len()] += 1;
        }
        ends += founder.nodes.iter().map(|node| f64::from(node.lpercent)).sum::<f64>();
        wing_nodes += founder.segments() as f64;
    }
    assert!(
        segments[0] == 0 && segments[1..].iter().all(|&count| (410..590).contains(&count)),
        "{segments:?}"
    );
    let nodes: i32 = neurons.iter().sum();
    assert!(
        neurons[0] == 0 && neurons[1..].iter().all(|&count| (count * 4 - nodes).abs() < nodes / 20),
        "{neurons:?}"
    );
    let lists: i32 = inputs.iter().sum();
    assert!(
        inputs[0] == 0 && inputs[1..].iter().all(|&count| (count * 3 - lists).abs() < lists / 20),
        "{inputs:?}"
    );
    let all: f64 = functions.values().sum();
    for function in Function::ALL {
        let weight = if OSCILLATORS.contains(&function) { 3.0 } else { 1.0 };
        let share = functions[&function] / all * 24.0;
        assert!((share / weight - 1.0).abs() < 0.1, "{function:?}: {share}");
    }
    assert!((crossed / links - 0.1).abs() < 0.005, "{crossed} of {links} cross");
    assert!((from_root / expected_root - 1.0).abs() < 0.02, "{from_root} of {expected_root} from the root");
    assert!((ends / wing_nodes - 0.5).abs() < 0.02);
}

#[test]
fn founders_keep_to_the_limit_of_neurons() {
    let settings = Settings { max_neurons: 2, ..Settings::default() };
    let founder = |place| Genotype::random(&settings, &mut draws(place));
    let most = (0..50).flat_map(|place| founder(place).nodes).map(|node| node.neurons.len()).max();
    assert_eq!(most, Some(2));
}

//! Mutation: its rates, what each kind changes, and what it does to references (F-64, F-65).

use super::super::mutation::reflect;
use super::*;
use crate::flyer::genotype::{BODY, NODES, WING_ROOT};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Settings under which nothing mutates but what is set.
fn only(set: impl FnOnce(&mut Settings)) -> Settings {
    let mut settings = Settings {
        scalar: 0.0,
        lpercent: 0.0,
        function: 0.0,
        delay: 0.0,
        add_neuron: 0.0,
        remove_neuron: 0.0,
        redraw_input: 0.0,
        add_input: 0.0,
        remove_input: 0.0,
        add_segment: 0.0,
        remove_segment: 0.0,
        ..Settings::default()
    };
    set(&mut settings);
    settings
}

/// F-64, F-65
#[test]
fn an_inserted_segment_shifts_references_and_tears_its_neighbours() {
    let parent = linked(6, 0.25, |_| vec![0, 5, 3]);
    for place in 0..100 {
        let mut child = parent.clone();
        child.insert_segment(4, &Settings::default(), &mut draws(place));
        assert_legal(&child);
        assert_eq!(bare_all(&child.nodes[..4]), bare_all(&parent.nodes[..4]));
        assert_eq!(bare_all(&child.nodes[5..]), bare_all(&parent.nodes[4..]));
        for node in [0, 1, 2, 6] {
            assert_eq!(read_by(&child, node), [0, 6, 3], "node {node}");
        }
        for node in [3, 4, 5] {
            assert!(child.nodes[node].sources().all(|source| is_near(source, node)), "node {node}");
        }
        assert!(child.nodes[4].sources().count() > child.nodes[4].neurons.len());
        assert_eq!(child.nodes[3].neurons[0].inputs[2], neuron_of(3, 0), "what is its own stays");
    }
}

/// F-64, F-65
#[test]
fn a_deleted_segment_takes_references_along_and_tears_its_neighbours() {
    let parent = linked(6, 0.25, |_| vec![0, 5, 3]);
    for place in 0..100 {
        let mut child = parent.clone();
        child.delete_segment(3, &Settings::default(), &mut draws(place));
        assert_legal(&child);
        assert_eq!(bare_all(&child.nodes), bare_all(&[&parent.nodes[..3], &parent.nodes[4..]].concat()));
        for node in [0, 1, 4] {
            assert_eq!(read_by(&child, node)[..2], [0, 4], "node {node}");
            assert!(is_near(&child.nodes[node].neurons[0].inputs[2], node), "node {node}");
        }
        for node in [2, 3] {
            assert!(child.nodes[node].sources().all(|source| is_near(source, node)), "node {node}");
        }
        child.delete_segment(4, &Settings::default(), &mut draws(place));
        assert_legal(&child);
    }
}

/// F-64: only the node that held an input of the removed neuron gets another.
#[test]
fn a_removed_neuron_takes_its_links_along_and_later_ones_shift() {
    let mut parent = linked(5, 0.25, |_| vec![2, 3]);
    let third = Neuron { function: Function::Sin, delay: 40, inputs: vec![neuron_of(2, 2)] };
    parent.nodes[2].neurons.push(third);
    parent.nodes[4].neurons[1].inputs = vec![neuron_of(2, 2), neuron_of(2, 1), neuron_of(4, 1)];
    for place in 0..100 {
        let mut child = parent.clone();
        child.remove_neuron(2, 0, &Settings::default(), &mut draws(place));
        assert_legal(&child);
        assert_eq!(child.nodes[4].neurons[1].inputs, [neuron_of(2, 1), neuron_of(2, 0), neuron_of(4, 1)]);
        assert_eq!(child.nodes[2].neurons[1].inputs, [neuron_of(2, 1)], "the third reads itself");
        for node in [0, 1, 3, 4] {
            let inputs = &child.nodes[node].neurons[0].inputs;
            assert!(is_near(&inputs[0], node) && inputs[1] == neuron_of(3, 0), "node {node}: {inputs:?}");
        }
    }
}

#[test]
fn without_mutations_a_mutant_is_a_copy() {
    let parent = random(1);
    let mut child = parent.clone();
    assert!(child.mutate(&only(|_| ()), &mut draws(2)).is_empty());
    assert_eq!(child, parent);
}

/// What may change in a genotype, each aspect in words.
fn aspects(genotype: &Genotype) -> BTreeMap<&'static str, String> {
    let nodes = &genotype.nodes;
    let neurons = || nodes.iter().flat_map(|node| &node.neurons);
    let list = |values: &mut dyn Iterator<Item = String>| values.collect::<Vec<_>>().join(" ");
    BTreeMap::from([
        (
            "scalars",
            list(&mut nodes.iter().map(|n| format!("{} {} {} {}", n.length, n.radius, n.theta, n.psi))),
        ),
        ("ends", list(&mut nodes.iter().map(|node| node.lpercent.to_string()))),
        ("functions", list(&mut neurons().map(|neuron| format!("{:?}", neuron.function)))),
        ("delays", list(&mut neurons().map(|neuron| neuron.delay.to_string()))),
        ("neurons", list(&mut nodes.iter().map(|node| node.neurons.len().to_string()))),
        ("inputs", list(&mut genotype.clone().inputs_mut().map(|inputs| inputs.len().to_string()))),
        ("sources", list(&mut nodes.iter().flat_map(Node::sources).map(|source| format!("{source:?}")))),
    ])
}

/// F-65: a mutation that is certain, by name and by what it changes; all else it leaves alone.
#[test]
fn each_mutation_changes_what_it_is_named_for() {
    let neuron = &["functions", "delays", "neurons", "inputs", "sources"][..];
    let node = &["scalars", "ends", "functions", "delays", "neurons", "inputs", "sources"][..];
    let certain = [
        ("scalar", only(|settings| settings.scalar = 1.0), &["scalars"][..]),
        ("lpercent", only(|settings| settings.lpercent = 1.0), &["ends"]),
        ("function", only(|settings| settings.function = 1.0), &["functions"]),
        ("delay", only(|settings| settings.delay = 1.0), &["delays"]),
        ("add_neuron", only(|settings| settings.add_neuron = 1.0), neuron),
        ("remove_neuron", only(|settings| settings.remove_neuron = 1.0), neuron),
        ("redraw_input", only(|settings| settings.redraw_input = 1.0), &["sources"]),
        ("add_input", only(|settings| settings.add_input = 1.0), &["inputs", "sources"]),
        ("remove_input", only(|settings| settings.remove_input = 1.0), &["inputs", "sources"]),
        ("add_segment", only(|settings| settings.add_segment = 1.0), node),
        ("remove_segment", only(|settings| settings.remove_segment = 1.0), node),
    ];
    let parent = linked(5, 0.25, |node| vec![node, 1]);
    for (name, settings, expected) in certain {
        let mut child = parent.clone();
        assert_eq!(child.mutate(&settings, &mut draws(3)), [name]);
        assert_legal(&child);
        let (before, after) = (aspects(&parent), aspects(&child));
        let changed: BTreeSet<_> = before.keys().filter(|aspect| before[*aspect] != after[*aspect]).collect();
        assert_eq!(changed, expected.iter().collect(), "{name}");
        let size = |genotype: &Genotype| {
            let count = |of: fn(&Node) -> usize| genotype.nodes.iter().map(of).sum::<usize>();
            (genotype.nodes.len(), count(|node| node.neurons.len()), count(|node| node.sources().count()))
        };
        let growth = size(&child).cmp(&size(&parent));
        let expected = match name.split_once('_') {
            Some(("add", _)) => Ordering::Greater,
            Some(("remove", _)) => Ordering::Less,
            _ => Ordering::Equal,
        };
        assert_eq!(growth, expected, "{name}");
    }
}

/// F-65: each trial comes true with its probability. A mutation with n trials is named with 1 − (1 − p)ⁿ.
#[test]
fn mutations_come_true_at_their_rates() {
    // Five nodes, two neurons each, one of one and one of two inputs; effectors have none.
    let parent = linked(5, 0.25, |node| vec![node, 1]);
    let lists = |least: usize, most: usize| {
        parent.clone().inputs_mut().filter(|inputs| (least..=most).contains(&inputs.len())).count() as i32
    };
    let inputs: i32 = parent.nodes.iter().map(|node| node.sources().count() as i32).sum();
    let settings = Settings::default();
    // Trials by name; removals have as many, or a few more when a neuron or input was added just before.
    let trials = [
        ("scalar", 0.1, 2 + 1 + 3 * 3),
        ("lpercent", 0.05, 3),
        ("function", 0.05, 10),
        ("delay", 0.05, 10),
        ("add_neuron", 0.05, 5),
        ("remove_neuron", 0.05, 5),
        ("redraw_input", 0.05, inputs),
        ("add_input", 0.02, lists(0, 2)),
        ("remove_input", 0.02, lists(2, 3)),
        ("add_segment", 0.05, 1),
        ("remove_segment", 0.05, 1),
    ];
    let mut counts: BTreeMap<&str, f64> = BTreeMap::new();
    for place in 0..10_000 {
        let mut child = parent.clone();
        let applied = child.mutate(&settings, &mut draws(place));
        assert!(applied.is_sorted_by_key(|name| trials.iter().position(|(known, ..)| known == name)));
        for name in applied {
            *counts.entry(name).or_insert(0.0) += 1e-4;
        }
    }
    for (name, probability, trials) in trials {
        let spared = (0..trials).fold(1.0, |spared, _| spared * (1.0 - probability));
        assert!(
            (counts[name] - (1.0 - spared)).abs() < 0.015,
            "{name}: {} of {}",
            counts[name],
            1.0 - spared
        );
    }
}

/// F-65: a standard deviation of a tenth of the range.
#[test]
fn scalars_move_by_a_tenth_of_their_range() {
    let settings = only(|settings| settings.scalar = 1.0);
    let mut squares = 0.0;
    for place in 0..4000 {
        let mut child = linked(3, 29.0, |_| vec![]);
        child.mutate(&settings, &mut draws(place));
        let moved = (child.nodes[BODY].length - 49.0) / 60.0;
        squares += moved * moved / 4000.0;
        assert_eq!(child.nodes[WING_ROOT].radius, 0.5);
    }
    assert!((squares.sqrt() - 0.1).abs() < 0.005, "{}", squares.sqrt());
}

/// F-65
#[test]
fn a_scalar_that_leaves_its_range_is_reflected_then_clamped() {
    for (value, expected) in [(1.5, 1.5), (0.75, 1.25), (2.25, 1.75), (4.0, 1.0), (-7.0, 2.0), (1.0, 1.0)] {
        assert_eq!(reflect(value, 1.0..=2.0), expected, "{value}");
    }
}

/// F-65: no wing outgrows eight segments or loses its last, and a node keeps to its limit of neurons.
#[test]
fn at_the_limits_nothing_is_added_or_removed() {
    let growing = Settings { add_segment: 1.0, add_neuron: 1.0, add_input: 1.0, ..only(|_| ()) };
    let mut genotype = linked(9, 0.0, |_| vec![]);
    for place in 0..5 {
        genotype.mutate(&growing, &mut draws(place));
    }
    assert_eq!(genotype.nodes.len(), *NODES.end());
    assert!(genotype.nodes[..9].iter().all(|node| node.neurons.len() == NEURONS_MAX));
    assert!(genotype.inputs_mut().all(|inputs| inputs.len() == 3));
    assert!(genotype.mutate(&growing, &mut draws(6)).is_empty());
    let shrinking = Settings { remove_segment: 1.0, remove_neuron: 1.0, remove_input: 1.0, ..only(|_| ()) };
    for place in 0..20 {
        genotype.mutate(&shrinking, &mut draws(place));
        assert_legal(&genotype);
    }
    assert_eq!(genotype.nodes.len(), *NODES.start());
    assert!(genotype.nodes.iter().all(|node| node.neurons.is_empty()));
    assert!(genotype.inputs_mut().all(|inputs| inputs.len() == 1));
    assert!(genotype.mutate(&shrinking, &mut draws(30)).is_empty());
}

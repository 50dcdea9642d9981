//! Crossover, grafting and what becomes of references (F-62..F-64).

use super::super::mating::splice;
use super::*;
use crate::flyer::genotype::{FIRST_SEGMENT, WING_ROOT};
use std::collections::{BTreeMap, BTreeSet};

/// F-62: the cut is aligned, each is reached, and the child has the second parent's length.
#[test]
fn crossover_cuts_everywhere_at_the_same_place_of_both() {
    let (first, second) = (linked(6, 0.25, |_| vec![]), linked(8, 0.5, |_| vec![]));
    let mut cuts = BTreeSet::new();
    for place in 0..300 {
        let child = Genotype::crossover(&first, &second, &Settings::default(), &mut draws(place));
        let made_at = |&cut: &usize| {
            bare_all(&child.nodes) == bare_all(&[&first.nodes[..cut], &second.nodes[cut..]].concat())
        };
        cuts.insert((1..6).find(made_at).expect("an aligned cut"));
    }
    assert_eq!(cuts, (1..=5).collect());
}

/// F-62: both cuts are free, body and wing-root are the first parent's, and ten nodes are the most.
#[test]
fn grafting_cuts_both_parents_anywhere_along_the_wings() {
    let mut cuts = BTreeSet::new();
    let (first, second) = (linked(10, 0.25, |_| vec![]), linked(7, 0.5, |_| vec![]));
    for place in 0..1000 {
        let child = Genotype::graft(&first, &second, &Settings::default(), &mut draws(place));
        let made_at = |&(stump, scion): &(usize, usize)| {
            let mut nodes = [&first.nodes[..stump], &second.nodes[scion..]].concat();
            nodes.truncate(10);
            bare_all(&child.nodes) == bare_all(&nodes)
        };
        let every = (2..=10).flat_map(|stump| (2..=6).map(move |scion| (stump, scion)));
        // A scion cut off at the tenth node is known by its beginning all the same.
        cuts.insert(every.clone().find(made_at).expect("a graft"));
    }
    let expected = (2..=9).flat_map(|stump| (2..=6).map(move |scion| (stump, scion)));
    assert_eq!(cuts, expected.collect());
}

/// F-63: each node reads those two before, itself and two after; seven nodes on five.
#[test]
fn references_move_with_their_nodes_and_those_left_behind_are_lost() {
    let around = |node: usize| [node.checked_sub(2), Some(node), Some(node + 2)];
    let within = move |count: usize| {
        move |node: usize| around(node).into_iter().flatten().filter(|&near| near < count).collect::<Vec<_>>()
    };
    let (first, second) = (linked(7, 0.25, within(7)), linked(8, 0.5, within(8)));
    let (stump, scion) = (4, 3);
    for place in 0..200 {
        let child = splice(&first, stump, &second, scion, &Settings::default(), &mut draws(place));
        assert_legal(&child);
        assert_eq!(bare_all(&child.nodes), bare_all(&[&first.nodes[..4], &second.nodes[3..]].concat()));
        let sources = |node: usize| &child.nodes[node].neurons[0].inputs;
        // First parent's nodes far from the seam: 0 and 2 stay with node 0, 1 and 3 with node 1, and 2
        // loses its reading of 4.
        assert_eq!(read_by(&child, 0), [0, 2]);
        assert_eq!(read_by(&child, 1), [1, 3]);
        assert_eq!(read_by(&child, 2)[..2], [0, 2]);
        assert!(is_near(&sources(2)[2], 2), "{:?}", sources(2));
        // The second parent's are one place further; its node 4 (now 5) loses 2 and its node 3 (now 4) 1.
        assert!(is_near(&sources(5)[0], 5));
        assert_eq!(read_by(&child, 5)[1..], [5, 7]);
        assert_eq!(read_by(&child, 6), [4, 6, 8]);
        assert_eq!(read_by(&child, 7), [5, 7]);
        // F-64: both sides of the seam keep what is their own alone.
        for (node, own) in [(3, 1), (4, 1)] {
            assert_eq!(sources(node)[own], neuron_of(node, 0));
            for source in sources(node) {
                assert!(is_near(source, node), "{node}: {source:?}");
            }
        }
        for node in 0..9 {
            assert_eq!(child.nodes[node].neurons[1].inputs, [neuron_of(node, 0)], "its own");
        }
    }
}

/// F-64: what replaces a lost input is uniform over the node, the one before and the one after.
#[test]
fn lost_inputs_are_drawn_from_the_neighbourhood_alike() {
    let (first, second) = (linked(5, 0.25, |_| vec![0; 3]), linked(5, 0.5, |_| vec![0; 3]));
    let mut drawn: BTreeMap<Source, i32> = BTreeMap::new();
    for place in 0..4000 {
        let settings = Settings { cross: 0.0, ..Settings::default() };
        let child = splice(&first, 3, &second, 3, &settings, &mut draws(place));
        for source in &child.nodes[3].neurons[0].inputs {
            *drawn.entry(*source).or_insert(0) += 1;
        }
    }
    // Nodes 2, 3 and 4 have two sensors and two neurons each.
    assert_eq!(drawn.len(), 12, "{drawn:?}");
    assert!(drawn.values().all(|&count| (900..1100).contains(&count)), "{drawn:?}");
}

/// F-64: a node that loses its successor to the limit of ten nodes has lost a neighbour.
#[test]
fn a_graft_cut_off_at_ten_nodes_reconnects_its_tip() {
    let reads = |node: usize| vec![node, WING_ROOT, FIRST_SEGMENT];
    let (first, second) = (linked(9, 0.25, reads), linked(9, 0.5, reads));
    for place in 0..50 {
        let child = splice(&first, 5, &second, 2, &Settings::default(), &mut draws(place));
        assert_eq!(child.nodes.len(), 10);
        assert_legal(&child);
        assert_eq!(read_by(&child, 3), [3, 1, 2], "the stump's inner nodes keep their inputs");
        let scion = &child.nodes[8].neurons[0].inputs;
        assert_eq!((scion[0], scion[2]), (neuron_of(8, 0), neuron_of(5, 0)), "and so do the scion's");
        let tip = &child.nodes[9].neurons[0].inputs;
        assert_eq!(tip[0], neuron_of(9, 0));
        assert!(tip.iter().all(|source| is_near(source, 9)), "{tip:?}");
    }
}

//! Founders (F-11).

use super::*;
use crate::flyer::genotype::{BODY_RADIUS, LENGTH, PSI, THETA, WING_ROOT, sensors};
use crate::flyer::skeleton::{grow, intersects_itself};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Whether counts are those of equally likely cases, within a tenth.
fn are_alike(counts: &[i32]) -> bool {
    let all: i32 = counts.iter().sum();
    counts.iter().all(|&count| (count * counts.len() as i32 - all).abs() < all / 10)
}

#[test]
fn a_wing_has_one_to_eight_random_segments() {
    let mut stream = draws(0);
    let (mut segments, mut ends) = ([0; 9], [0; 2]);
    let mut scalars: [Vec<f64>; 4] = Default::default();
    for _ in 0..8000 {
        let drawn = Genotype::bones(&mut stream);
        segments[drawn.segments()] += 1;
        scalars[0].extend(drawn.nodes.iter().map(|node| node.length));
        scalars[1].push(drawn.nodes[0].radius);
        for node in &drawn.nodes[2..] {
            ends[usize::from(node.lpercent)] += 1;
            scalars[2].push(node.theta);
            scalars[3].push(node.psi);
        }
    }
    assert!(segments[0] == 0 && are_alike(&segments[1..]), "{segments:?}");
    assert!(are_alike(&ends), "{ends:?}");
    for (values, range) in scalars.iter().zip([LENGTH, BODY_RADIUS, THETA, PSI]) {
        assert_uniform(values, range);
    }
}

/// A tenth of the values lies in each tenth of the range.
fn assert_uniform(values: &[f64], range: RangeInclusive<f64>) {
    let mut counts = [0; 10];
    for value in values {
        assert!(range.contains(value), "{value} is not within {range:?}");
        counts[((value - range.start()) / (range.end() - range.start()) * 10.0) as usize] += 1;
    }
    assert!(are_alike(&counts), "{counts:?} in {range:?}");
}

/// F-23: of single draws many are, so that a hundred redraws are enough.
#[test]
fn no_founder_has_crossing_films() {
    let crossing = |genotype: &Genotype| intersects_itself(&grow(genotype, 0.0));
    let single = (0..1000).filter(|&place| crossing(&Genotype::bones(&mut draws(place)))).count();
    assert!((350..550).contains(&single), "{single} of 1000 draws");
    assert_eq!((0..1000).filter(|&place| crossing(&random(place))).count(), 0);
}

#[test]
fn a_founders_brain_has_the_shares_of_the_requirement() {
    let (mut neurons, mut inputs) = ([0; 5], [0; 4]);
    let mut functions: BTreeMap<Function, f64> = BTreeMap::new();
    let (mut links, mut crossed, mut from_root, mut expected_root) = (0.0, 0.0, 0.0, 0.0);
    for place in 0..4000 {
        let founder = random(place);
        assert_legal(&founder);
        let offered = |node: usize| (sensors(node) + founder.nodes[node].neurons.len()) as f64;
        let share = offered(WING_ROOT) / (0..founder.nodes.len()).map(offered).sum::<f64>();
        for node in &founder.nodes {
            neurons[node.neurons.len()] += 1;
            for neuron in &node.neurons {
                *functions.entry(neuron.function).or_insert(0.0) += 1.0;
            }
            for source in node.sources() {
                links += 1.0;
                crossed += f64::from(u8::from(source.cross));
                from_root += f64::from(u8::from(usize::from(source.node) == WING_ROOT));
                expected_root += share;
            }
        }
        founder.clone().inputs_mut().for_each(|list| inputs[list.len()] += 1);
    }
    assert!(neurons[0] == 0 && are_alike(&neurons[1..]), "{neurons:?}");
    assert!(inputs[0] == 0 && are_alike(&inputs[1..]), "{inputs:?}");
    let all: f64 = functions.values().sum();
    for function in Function::ALL {
        let weight = if OSCILLATORS.contains(&function) { 3.0 } else { 1.0 };
        let share = functions[&function] / all * 24.0;
        assert!((share / weight - 1.0).abs() < 0.1, "{function:?}: {share}");
    }
    assert!((crossed / links - 0.1).abs() < 0.005, "{crossed} of {links} cross");
    assert!((from_root / expected_root - 1.0).abs() < 0.02, "{from_root} of {expected_root} from the root");
}

#[test]
fn founders_keep_to_the_limit_of_neurons() {
    let settings = Settings { max_neurons: 2, ..Settings::default() };
    let founder = |place| Genotype::random(&settings, &mut draws(place));
    let most = (0..50).flat_map(|place| founder(place).nodes).map(|node| node.neurons.len()).max();
    assert_eq!(most, Some(2));
}

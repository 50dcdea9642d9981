//! Distance and crossover (T-12), structural mutation (T-16), and legality throughout.

use super::*;
use crate::random::stream;
use proptest::prelude::*;
use std::collections::BTreeMap;

fn weighted(genes: &[(u32, f64)]) -> Genotype {
    let link = |&(innovation, weight)| Link {
        innovation,
        from: innovation,
        to: 14,
        weight,
        enabled: true,
        recurrent: false,
    };
    let links = genes.iter().map(link).collect();
    Genotype { body: BodyKind::Crawler, hidden: vec![], links }
}

/// T-12's A and B.
fn pair() -> (Genotype, Genotype) {
    let a = [0.5, -0.3, 0.8, 0.1, -0.6, 0.2, -0.9, 0.4, 1.0, 0.5];
    let b = [0.1, -0.5, 0.9, -0.4, -0.6, 0.7, -0.2, 0.0];
    let numbered = |weights: &[f64]| (1..).zip(weights.iter().copied()).collect::<Vec<_>>();
    let a = [numbered(&a), vec![(13, -0.7)]].concat();
    let b = [numbered(&b), vec![(11, 1.0), (12, -0.3)]].concat();
    (weighted(&a), weighted(&b))
}

fn innovations(genotype: &Genotype) -> Vec<u32> {
    genotype.links.iter().map(|link| link.innovation).collect()
}

/// T-12
#[test]
fn distance_counts_excess_disjoint_and_weights() {
    let settings = Settings::default();
    let (a, b) = pair();
    assert!((a.distance(&b, &settings) - 0.594545454545).abs() < 1e-9);
    assert_eq!(a.distance(&b, &settings), b.distance(&a, &settings));
    let mut moved = a.clone();
    moved.links.iter_mut().for_each(|link| link.weight += 0.3);
    assert!((a.distance(&moved, &settings) - 0.12).abs() < 1e-9);
    let parts = |c1, c2, c3| a.distance(&b, &Settings { c1, c2, c3, ..Settings::default() });
    assert!((parts(1.0, 0.0, 0.0) - 1.0 / 11.0).abs() < 1e-12);
    assert!((parts(0.0, 1.0, 0.0) - 4.0 / 11.0).abs() < 1e-12);
    assert!((parts(0.0, 0.0, 1.0) - 0.35).abs() < 1e-12);
    assert_eq!(weighted(&[]).distance(&weighted(&[]), &settings), 0.0);
}

/// T-12, G-39
#[test]
fn the_fitter_parent_gives_the_structure_and_among_equals_the_smaller() {
    let (a, b) = pair();
    assert!(a.leads(10.0, &b, 5.0) && !b.leads(5.0, &a, 10.0));
    assert!(!a.leads(7.0, &b, 7.0) && b.leads(7.0, &a, 7.0));
    assert!(a.leads(7.0, &a, 7.0), "among equals of one size the one that asks");
    let mut stream = stream(1, [0, 0, 0], "variation test");
    let child = Genotype::crossover(&a, &b, &Settings::default(), &mut stream);
    assert_eq!(innovations(&child), innovations(&a));
    let child = Genotype::crossover(&b, &a, &Settings::default(), &mut stream);
    assert_eq!(innovations(&child), innovations(&b));
}

/// G-39: a fair coin for weights; disabled in either parent stays disabled with 0.75.
#[test]
fn matching_genes_come_from_either_parent() {
    let (mut a, mut b) = pair();
    a.links[0].enabled = false;
    b.links[1].enabled = false;
    a.links[10].enabled = false;
    let (mut from_a, mut disabled) = (0, [0; 2]);
    for place in 0..4000 {
        let mut stream = stream(2, [0, 0, place], "variation test");
        let child = Genotype::crossover(&a, &b, &Settings::default(), &mut stream);
        from_a += usize::from(child.links[2].weight == a.links[2].weight);
        for (count, link) in disabled.iter_mut().zip(&child.links) {
            *count += usize::from(!link.enabled);
        }
        assert_eq!(child.links[8..], a.links[8..], "unmatched genes are copied with their flag");
    }
    assert!((from_a as i32 - 2000).abs() < 150, "{from_a}");
    assert!(disabled.iter().all(|&count| (count as i32 - 3000).abs() < 150), "{disabled:?}");
}

/// G-30, G-31: founders have the innovations with which the register begins.
#[test]
fn founders_link_everything_to_every_output() {
    for (body, count) in BodyKind::ALL.into_iter().zip([28, 108, 64, 108]) {
        let mut stream = stream(3, [0, 0, 0], "variation test");
        let founder = Genotype::random(body, &Settings::default(), &mut stream);
        let mut register = Register::new(body);
        assert_eq!((founder.links.len(), register.len()), (count, count));
        for link in &founder.links {
            let bias = body.inputs() as u32;
            assert_eq!(link.innovation, (link.to - bias - 1) * (bias + 1) + link.from);
            assert_eq!(register.link(link.from, link.to, false), link.innovation);
            assert!((-1.0..1.0).contains(&link.weight));
        }
        assert_eq!(register.len(), count, "nothing new was handed out");
    }
}

/// T-16: adding links around 16 → 14 (in the place of T-13's 6 → 4).
#[test]
fn a_link_that_would_close_a_cycle_is_recurrent() {
    let mut genotype = weighted(&[]);
    genotype.hidden = vec![16];
    let forward = Link { innovation: 28, from: 16, to: 14, weight: 0.8, enabled: false, recurrent: false };
    genotype.links = vec![forward];
    assert!(genotype.closes_cycle(14, 16), "16 → 14 counts though it is disabled");
    assert!(!genotype.closes_cycle(0, 16));
    assert!(!genotype.closes_cycle(16, 15));
    assert!(genotype.closes_cycle(16, 16));
    genotype.links = vec![Link { recurrent: true, ..forward }];
    assert!(!genotype.closes_cycle(14, 16), "recurrent links do not count");
}

/// T-16, G-41: a split recurrent link keeps its delay on the way in.
#[test]
fn a_split_link_is_disabled_and_replaced_by_two() {
    let mut register = Register::new(BodyKind::Crawler);
    let mut genotype = weighted(&[]);
    let innovation = register.link(15, 14, true);
    let old = Link { innovation, from: 15, to: 14, weight: 0.7, enabled: true, recurrent: true };
    genotype.links = vec![old];
    genotype.split(0, &mut register);
    let node = genotype.hidden[0];
    let [first, into, out] = genotype.links[..] else { panic!("{:?}", genotype.links) };
    assert_eq!(first, Link { enabled: false, ..old });
    assert_eq!(into, Link { innovation: into.innovation, to: node, weight: 1.0, ..old });
    assert_eq!(out, Link { innovation: out.innovation, from: node, recurrent: false, ..old });
}

/// T-16, G-31
#[test]
fn one_structure_has_one_number_in_the_whole_run() {
    let mut register = Register::new(BodyKind::Crawler);
    let founder = |place| {
        let mut stream = stream(5, [0, 0, place], "variation test");
        Genotype::random(BodyKind::Crawler, &Settings::default(), &mut stream)
    };
    let (mut a, mut b) = (founder(0), founder(1));
    a.split(9, &mut register);
    b.split(9, &mut register);
    assert_eq!((innovations(&a), &a.hidden), (innovations(&b), &b.hidden));
    a.links[9].enabled = true;
    a.split(9, &mut register);
    assert_eq!((a.hidden.len(), a.links.len(), register.len()), (2, 32, 32));
    b.links[9].enabled = true;
    b.split(9, &mut register);
    assert_eq!((innovations(&a), &a.hidden), (innovations(&b), &b.hidden));
    assert_eq!(register.link(3, 15, true), register.link(3, 15, true));
    assert_ne!(register.link(3, 15, true), register.link(3, 15, false));
}

#[test]
fn a_register_survives_its_checkpoint() {
    let mut register = Register::new(BodyKind::Arm);
    register.split(3, 0);
    register.link(20, 20, true);
    let restored: Register = crate::encoding::decode(&crate::encoding::encode(&register)).unwrap();
    assert_eq!(restored, register);
}

/// G-40: shares of the mutations, and what each of them changes.
#[test]
fn mutations_do_what_they_say_at_their_shares() {
    let mut start = stream(6, [0, 0, 0], "variation test");
    let parent = Genotype::random(BodyKind::Hopper, &Settings::default(), &mut start);
    let mut counts: BTreeMap<_, i32> = BTreeMap::new();
    for place in 0..10_000 {
        let (mut child, mut register) = (parent.clone(), Register::new(BodyKind::Hopper));
        let mut stream = stream(7, [0, 0, place], "variation test");
        let applied = child.mutate(&Settings::default(), &mut register, &mut stream);
        let grown = match applied.contains(&"add_node") {
            true => 2,
            false => 0,
        } + usize::from(applied.contains(&"add_link"));
        assert_eq!(child.links.len(), parent.links.len() + grown);
        let moved = parent.links.iter().zip(&child.links).any(|(a, b)| a.weight != b.weight);
        assert_eq!(moved, applied.contains(&"weights"));
        for operator in applied {
            *counts.entry(operator).or_insert(0) += 1;
        }
    }
    for (operator, expected) in [("add_node", 300_i32), ("add_link", 700), ("weights", 1000)] {
        assert!((counts[operator] - expected).abs() < 120, "{counts:?}");
    }
}

/// G-40: a tenth of the weights are drawn anew, the rest moved by at most the step, all clamped.
#[test]
fn weights_are_drawn_anew_or_moved_and_clamped() {
    let genes: Vec<_> = (0..1000).map(|innovation| (innovation, 7.9)).collect();
    let mut genotype = weighted(&genes);
    genotype.move_weights(&Settings::default(), &mut stream(8, [0, 0, 0], "variation test"));
    let anew = genotype.links.iter().filter(|link| link.weight.abs() <= 1.0).count();
    let clamped = genotype.links.iter().filter(|link| link.weight == 8.0).count();
    let moved = genotype.links.iter().filter(|link| (7.4..8.0).contains(&link.weight)).count();
    assert_eq!(anew + clamped + moved, 1000);
    assert!((70..130).contains(&anew) && clamped > 300 && moved > 400, "{anew} {clamped} {moved}");
}

#[test]
fn settings_out_of_range_are_named() {
    let bad = [
        ("add_node", Settings { add_node: 1.1, ..Settings::default() }),
        ("weights", Settings { weights: f64::NAN, ..Settings::default() }),
        ("limit", Settings { limit: 8.5, ..Settings::default() }),
        ("c3", Settings { c3: -1.0, ..Settings::default() }),
        ("perturb", Settings { replace: 0.2, ..Settings::default() }),
        ("start", Settings { limit: 0.5, ..Settings::default() }),
    ];
    for (key, settings) in bad {
        assert_eq!(settings.check().unwrap_err().path, key);
    }
    Settings::default().check().unwrap();
}

proptest! {
    /// Whatever the draws, a line of descent stays legal, hence acyclic, and survives its encoding.
    #[test]
    fn descent_stays_legal(seed: u64, body in proptest::sample::select(BodyKind::ALL.to_vec())) {
        let settings = Settings { add_node: 0.5, add_link: 0.8, weights: 0.5, ..Settings::default() };
        let mut stream = stream(seed, [0, 0, 0], "variation test");
        let mut register = Register::new(body);
        let mut first = Genotype::random(body, &settings, &mut stream);
        let mut second = Genotype::random(body, &settings, &mut stream);
        for _ in 0..40 {
            let mut child = Genotype::crossover(&first, &second, &settings, &mut stream);
            child.mutate(&settings, &mut register, &mut stream);
            prop_assert_eq!(&Genotype::decode(&child.encode()).unwrap(), &child);
            (first, second) = (second, child);
        }
    }
}

//! Crossover (T-7), the shares of mutations, and legality throughout.

use super::*;
use crate::random::stream;
use proptest::prelude::*;

fn numbered(count: u8, mark: u8) -> Vec<Protein> {
    (0..count).map(|index| Protein { id: index, enh: mark, inh: mark }).collect()
}

fn with_regulatory(body: BodyKind, regulatory: usize, place: u32) -> Genotype {
    let settings = Settings { reg_min: regulatory, reg_max: regulatory, ..Settings::default() };
    Genotype::random(body, &settings, &mut stream(1, [0, 0, place], "variation test"))
}

/// T-7: sizes 10 and 8 (four wired).
#[test]
fn a_child_has_the_head_of_one_and_the_tail_of_the_other() {
    let (a, b) = (numbered(10, 1), numbered(8, 2));
    let child = splice(&a, &b, 7);
    assert_eq!(child, [&a[..7], &b[7..]].concat());
    assert_eq!(child.len(), b.len());
}

/// G-26: a cut is within 1..=min − 1, each reached; the child has the second parent's length.
#[test]
fn crossover_cuts_everywhere_and_keeps_the_second_length() {
    let (a, b) = (with_regulatory(BodyKind::Crawler, 6, 0), with_regulatory(BodyKind::Crawler, 4, 1));
    let (mut cuts, mut betas) = (std::collections::BTreeSet::new(), [0; 2]);
    for place in 0..2000 {
        let child = Genotype::crossover(&a, &b, &mut stream(2, [0, 0, place], "variation test"));
        assert_eq!(child.proteins.len(), b.proteins.len());
        let matches = |cut| child.proteins == splice(&a.proteins, &b.proteins, cut);
        cuts.insert((1..b.proteins.len()).find(|&cut| matches(cut)).expect("a splice"));
        betas[usize::from(child.beta == a.beta)] += 1;
    }
    assert_eq!(cuts.len(), b.proteins.len() - 1, "{cuts:?}");
    assert!(betas[0] > 900 && betas[1] > 900, "{betas:?}");
}

#[test]
fn a_parent_crossed_with_itself_gives_a_copy() {
    let a = with_regulatory(BodyKind::Arm, 9, 0);
    assert_eq!(Genotype::crossover(&a, &a, &mut stream(3, [0, 0, 0], "variation test")), a);
}

/// G-27: each mutation does what it is named for and no more, at its share.
#[test]
fn mutations_do_what_they_say_at_their_shares() {
    let parent = with_regulatory(BodyKind::Hopper, 10, 0);
    let settings = Settings::default();
    let mut counts: std::collections::BTreeMap<_, i32> = std::collections::BTreeMap::new();
    for place in 0..10_000 {
        let mut child = parent.clone();
        let operator = child.mutate(&settings, &mut stream(4, [0, 0, place], "variation test"));
        *counts.entry(operator).or_insert(0) += 1;
        let same_scaling = (child.beta, child.delta) == (parent.beta, parent.delta);
        assert_eq!(same_scaling, operator != "scaling");
        let changed = parent.proteins.iter().zip(&child.proteins).filter(|(a, b)| a != b).count();
        match operator {
            "tag" => assert!(changed <= 1 && child.regulatory() == 10),
            "add" => assert!(changed == 0 && child.regulatory() == 11),
            "remove" => {
                assert_eq!(child.regulatory(), 9);
                assert_eq!(child.proteins[..23], parent.proteins[..23], "wired proteins stay");
            }
            _ => assert!(changed == 0 && (child.beta == parent.beta) != (child.delta == parent.delta)),
        }
    }
    for (operator, share) in [("tag", 6000_i32), ("add", 1500), ("remove", 1500), ("scaling", 1000)] {
        assert!((counts[operator] - share).abs() < 200, "{counts:?}");
    }
}

#[test]
fn at_the_limits_adding_and_removing_become_tag() {
    let settings = |add, remove| Settings { tag: 0.0, scaling: 0.0, add, remove, ..Settings::default() };
    for (regulatory, settings) in [(20, settings(1.0, 0.0)), (4, settings(0.0, 1.0))] {
        let mut genotype = with_regulatory(BodyKind::Runner, regulatory, 0);
        assert_eq!(genotype.mutate(&settings, &mut stream(5, [0, 0, 0], "variation test")), "tag");
        assert_eq!(genotype.regulatory(), regulatory);
    }
}

#[test]
fn settings_out_of_range_are_named() {
    let bad = [
        ("add", Settings { add: -0.1, ..Settings::default() }),
        ("scaling", Settings { scaling: f64::NAN, ..Settings::default() }),
        ("tag", Settings { tag: 0.0, add: 0.0, remove: 0.0, scaling: 0.0, ..Settings::default() }),
        ("p", Settings { p: 33, ..Settings::default() }),
        ("reg_max", Settings { reg_max: 21, ..Settings::default() }),
        ("reg_min", Settings { reg_min: 12, reg_max: 11, ..Settings::default() }),
        ("beta", Settings { beta: [1.0, 0.9], ..Settings::default() }),
        ("delta", Settings { delta: [0.4, 0.9], ..Settings::default() }),
    ];
    for (key, settings) in bad {
        assert_eq!(settings.check().unwrap_err().path, key);
    }
    Settings::default().check().unwrap();
}

proptest! {
    /// Whatever the draws, a line of descent stays legal and survives its encoding.
    #[test]
    fn descent_stays_legal(seed: u64, body in proptest::sample::select(BodyKind::ALL.to_vec())) {
        let settings = Settings::default();
        let mut stream = stream(seed, [0, 0, 0], "variation test");
        let mut first = Genotype::random(body, &settings, &mut stream);
        let mut second = Genotype::random(body, &settings, &mut stream);
        for _ in 0..40 {
            let mut child = Genotype::crossover(&first, &second, &mut stream);
            child.mutate(&settings, &mut stream);
            prop_assert_eq!(&Genotype::decode(&child.encode()).unwrap(), &child);
            (first, second) = (second, child);
        }
    }
}

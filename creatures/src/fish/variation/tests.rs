use super::*;
use crate::random::stream;
use proptest::prelude::*;

fn within_bounds(controller: &Controller) {
    controller.check("controller").unwrap();
    let inside = |values: &[f64], bounds: &Range<f64>| {
        values.iter().all(|value| (bounds.start..=bounds.end).contains(value))
    };
    assert!(inside(&controller.frequency, &FREQUENCY) && inside(&controller.offset, &OFFSET));
    assert!(inside(&controller.amplitude, &AMPLITUDE) && inside(&controller.phase, &PHASE));
}

fn tied(controller: &Controller) -> bool {
    let m = controller.oscillations();
    let alike = |values: &[f64], width: usize| {
        (0..MUSCLES).step_by(SEGMENT).all(|first| {
            let of = |corner: usize| &values[(first + corner) * width..][..width];
            of(0) == of(3) && of(1) == of(2)
        })
    };
    alike(&controller.offset, 1) && alike(&controller.amplitude, m) && alike(&controller.phase, m)
}

proptest! {
    ///
    #[test]
    fn descent_stays_within_bounds_and_tied(seed: u64, oscillations in 1..4u32, full: bool) {
        let encoding = if full { Encoding::Full } else { Encoding::Tied };
        let variation = Variation { encoding, oscillations, rate: 0.5, strength: 0.5 };
        let mut draws = stream(seed, [0, 0, 0], "descent");
        let [mut one, mut other] = [0; 2].map(|_| variation.random(&mut draws));
        for _ in 0..20 {
            let mut child = crossover(&one, &other, &mut draws);
            variation.mutate(&mut child, &mut draws);
            other = graft(&one, &child, &mut draws);
            one = child;
            for controller in [&one, &other] {
                within_bounds(controller);
                prop_assert!(full || tied(controller));
            }
        }
    }
}

#[test]
fn a_mutation_says_whether_it_came_true() {
    let mut draws = stream(1, [0, 0, 0], "mutation");
    let never = Variation { rate: 0.0, ..Variation::default() };
    let mut controller = never.random(&mut draws);
    let before = controller.clone();
    assert!(!never.mutate(&mut controller, &mut draws));
    assert_eq!(controller, before);
    assert!(Variation { rate: 1.0, ..never }.mutate(&mut controller, &mut draws));
    assert!(controller.phase.iter().zip(&before.phase).all(|(a, b)| a != b));
}

/// whole segments.
#[test]
fn a_child_has_whole_segments_of_either_parent() {
    let variation = Variation { encoding: Encoding::Full, oscillations: 2, ..Variation::default() };
    let mut draws = stream(2, [0, 0, 0], "mating");
    let [one, other] = [0; 2].map(|_| variation.random(&mut draws));
    let segment = |controller: &Controller, index: usize| {
        (controller.offset[4 * index..][..4].to_vec(), controller.phase[8 * index..][..8].to_vec())
    };
    let (mut from_other, mut moved) = (0, 0);
    for _ in 0..100 {
        let child = crossover(&one, &other, &mut draws);
        assert_eq!(child.frequency, one.frequency);
        for index in 0..3 {
            let found = segment(&child, index);
            assert!(found == segment(&one, index) || found == segment(&other, index));
            from_other += usize::from(found == segment(&other, index));
        }
        let child = graft(&one, &other, &mut draws);
        let foreign: Vec<usize> = (0..3).filter(|&i| segment(&child, i) != segment(&one, i)).collect();
        assert_eq!(foreign.len(), 1);
        moved += usize::from(segment(&child, foreign[0]) != segment(&other, foreign[0]));
    }
    assert!((110..190).contains(&from_other) && (45..90).contains(&moved), "{from_other} {moved}");
}

#[test]
fn rates_out_of_range_are_refused() {
    let refused = |variation: Variation| variation.check().unwrap_err().path;
    assert_eq!(refused(Variation { oscillations: 0, ..Variation::default() }), "oscillations");
    assert_eq!(refused(Variation { rate: 1.5, ..Variation::default() }), "rate");
    assert_eq!(refused(Variation { strength: f64::NAN, ..Variation::default() }), "strength");
}

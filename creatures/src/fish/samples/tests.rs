use super::*;
use crate::random::stream;
use proptest::prelude::*;

fn one_in_the_middle() -> Vec<f64> {
    (0..15).map(|i| if i == 7 { 1.0 } else { 0.0 }).collect()
}

/// T-13
#[test]
fn functions_go_through_their_samples_by_spline_or_by_lines() {
    let samples = one_in_the_middle();
    let bends = bends(&samples);
    for (place, curved, straight) in
        [(6.5, 0.600481, 0.5), (7.5, 0.600481, 0.5), (7.25, 0.881430, 0.75), (8.5, -0.127405, 0.0)]
    {
        assert!((spline(&samples, &bends, place) - curved).abs() < 1e-6, "{place}");
        assert_eq!(linear(&samples, place), straight, "{place}");
    }
}

/// T-13: −0.127405 counts as 0.
#[test]
fn what_a_spline_overshoots_is_clamped() {
    let values = one_in_the_middle().repeat(12);
    let samples = Samples { lesson: 0, encoding: Encoding::Full, count: 15, steps: 140, values };
    let functions = MuscleFunctions::new(&samples, Interpolation::Spline);
    assert_eq!(functions.at(85), [0.0; MUSCLES]);
    assert!((functions.at(65)[3] - 0.600481).abs() < 1e-6);
    assert_eq!(functions.at(70), [1.0; MUSCLES]);
}

/// at the end of a step, and again from the beginning after the last.
#[test]
fn samples_are_read_at_the_end_of_steps_and_repeated() {
    let mut samples = Samples::random(0, Encoding::Full, 15, 182, &mut stream(1, [0, 0, 0], "samples"));
    samples.values[14] = 0.25;
    let functions = MuscleFunctions::new(&samples, Interpolation::Linear);
    assert_eq!(functions.at(182)[0], 0.25);
    assert_eq!(functions.at(183), functions.at(1));
    assert!((samples.spacing() - 0.715).abs() < 1e-12);
}

///
#[test]
fn tied_samples_give_top_and_bottom_the_same_and_each_side_its_own() {
    let functions: Vec<usize> = (0..MUSCLES).map(|muscle| Encoding::Tied.function(muscle)).collect();
    assert_eq!(functions, [0, 1, 1, 0, 2, 3, 3, 2, 4, 5, 5, 4]);
    let samples = Samples::random(0, Encoding::Tied, 15, 182, &mut stream(1, [0, 0, 0], "samples"));
    assert_eq!(samples.values.len(), 90);
    assert_eq!(samples.of_muscle(11), &samples.values[60..75]);
}

/// AF-3
#[test]
fn samples_out_of_order_are_refused_with_their_index() {
    let refused = |change: &dyn Fn(&mut Samples)| {
        let mut samples = Samples::random(0, Encoding::Tied, 15, 182, &mut stream(1, [0, 0, 0], "samples"));
        change(&mut samples);
        samples.check().unwrap_err().to_string()
    };
    let at = |index: usize, value: f64| refused(&move |samples| samples.values[index] = value);
    assert_eq!(at(17, f64::NAN), "genotype field `samples.values[17]`: NaN is not within 0 to 1");
    assert_eq!(at(3, f64::INFINITY), "genotype field `samples.values[3]`: inf is not within 0 to 1");
    assert_eq!(at(89, -1e-9), "genotype field `samples.values[89]`: -0.000000001 is not within 0 to 1");
    assert_eq!(
        refused(&|samples| samples.values.truncate(89)),
        "genotype field `samples.values`: 89 values where 90 are needed"
    );
    assert_eq!(
        refused(&|samples| samples.count = 3),
        "genotype field `samples.count`: 3 is not within 4 to 1000"
    );
    assert_eq!(
        refused(&|samples| samples.steps = 1),
        "genotype field `samples.steps`: 1 is not within 2 to 100000"
    );
}

proptest! {
    #[test]
    fn a_spline_meets_its_samples_and_is_smooth(values in prop::collection::vec(0.0..1.0f64, 4..20)) {
        let bends = bends(&values);
        for (index, &value) in values.iter().enumerate() {
            prop_assert!((spline(&values, &bends, index as f64) - value).abs() < 1e-12);
        }
        for knot in 1..values.len() - 1 {
            let (place, d) = (knot as f64, 1e-5);
            let [l, m, r] = [place - d, place, place + d].map(|place| spline(&values, &bends, place));
            prop_assert!(((r - m) - (m - l)).abs() < 1e-8, "no kink at {}", knot);
        }
    }
}

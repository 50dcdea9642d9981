use super::*;
use crate::fish::turn::STRENGTH;
use std::f64::consts::FRAC_PI_6;

/// Steps of a command from a motor at rest; the bias after each.
fn biases(motor: &mut Motor, turn: Turn, steps: usize) -> Vec<f64> {
    let command = Command { swim: 0.5, turn, ..Command::default() };
    let step = |_| {
        motor.obey(&command, 0.0);
        motor.bias
    };
    (0..steps).map(step).collect()
}

/// T-10, the first step; A-23.
#[test]
fn sides_beat_against_each_other_and_the_posterior_lags_by_half_a_beat() {
    let actuation = Motor::default().beat(&Gait::swim(1.0));
    let (left, right) = (0.609114812, 0.390885188);
    let expected = [0.0, 0.0, 0.0, 0.0, left, right, right, left, right, left, left, right];
    for (found, expected) in actuation.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }
}

///
#[test]
fn a_bias_contracts_its_side_and_leaves_the_rest_to_swimming() {
    let straight = Motor::default().beat(&Gait::swim(1.0));
    let left = Motor { bias: 0.25, ..Motor::default() }.beat(&Gait::swim(1.0));
    let right = Motor { bias: -0.25, ..Motor::default() }.beat(&Gait::swim(1.0));
    assert_eq!(left[..4], [0.25, 0.0, 0.0, 0.25]);
    assert_eq!(right[..4], [0.0, 0.25, 0.25, 0.0]);
    assert_eq!(left[4], 0.25 + 0.75 * straight[4]);
    assert_eq!(left[5], 0.75 * straight[5]);
    assert_eq!(right[5], 0.25 + 0.75 * straight[5]);
    assert_eq!((left[8..].to_vec(), right[8..].to_vec()), (straight[8..].to_vec(), straight[8..].to_vec()));
}

///
#[test]
fn a_bias_grows_fast_and_shrinks_slowly() {
    let mut motor = Motor::default();
    let grows = biases(&mut motor, Turn::Bias(0.5), 8);
    assert!((grows[0] - 0.0825).abs() < 1e-15 && grows[7] == 0.5, "{grows:?}");
    let shrinks = biases(&mut motor, Turn::Bias(0.0), 1);
    assert!((shrinks[0] - (0.5 - 0.1875 * 0.055)).abs() < 1e-15, "{shrinks:?}");
    let changes_sides = biases(&mut motor, Turn::Bias(-0.1), 1);
    assert!((shrinks[0] - changes_sides[0] - 0.0825).abs() < 1e-15, "{changes_sides:?}");
}

/// a timed turn holds σ at 1 to its end, and is not begun anew by being asked for again.
#[test]
fn a_timed_turn_runs_once() {
    let mut motor = Motor::default();
    let command = Command { swim: 0.5, turn: Turn::Angle(FRAC_PI_6), ..Command::default() };
    let swims: Vec<f64> = (0..400).map(|_| motor.obey(&command, 0.0)).collect();
    let turning = swims.iter().take_while(|&&swim| swim == 1.0).count();
    assert!((162..=164).contains(&turning), "9.0 of time are {turning} steps");
    assert!(swims[turning..].iter().all(|&swim| swim == 0.5));
    let again = biases(&mut motor, Turn::Angle(-FRAC_PI_6), 20);
    assert_eq!(again[19], -STRENGTH);
    let other = biases(&mut motor, Turn::Bias(-STRENGTH), 1);
    assert_eq!(other, [-STRENGTH], "a bias goes on from where the turn was");
}

///
#[test]
fn a_mouth_opens_and_closes_in_half_a_unit_of_time() {
    let mut motor = Motor::default();
    let steps = |motor: &mut Motor, mouth_open, until: f64| {
        let command = Command { mouth_open, ..Command::default() };
        (1..)
            .find(|_| {
                motor.obey(&command, 0.0);
                motor.mouth == until
            })
            .unwrap()
    };
    assert_eq!(steps(&mut motor, true, 1.0), 10);
    assert_eq!(steps(&mut motor, false, 0.0), 10);
}

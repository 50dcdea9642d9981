//! The analytic cases T-1..T-7 and the properties of G-15.

use super::*;
use crate::random::stream;
use crate::walker::body::BodyKind;
use crate::walker::grn::Settings;

const T1: [(u8, u8, u8); 5] = [(8, 32, 17), (7, 23, 14), (31, 31, 25), (1, 10, 0), (31, 28, 25)];
const T3: [(u8, u8, u8); 5] = [(4, 0, 0), (20, 0, 0), (0, 6, 18), (0, 21, 9), (12, 3, 27)];
const T5: [(u8, u8, u8); 5] = [(0, 0, 0), (32, 0, 0), (5, 0, 32), (6, 0, 32), (16, 0, 32)];

/// Two inputs, two outputs, one regulatory protein.
fn small(tags: [(u8, u8, u8); 5], beta: f64, delta: f64) -> Network {
    Network::wire(2, 2, &tags.map(|(id, enh, inh)| Protein { id, enh, inh }), beta, delta)
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() < 1e-9, "{found:?} is not {expected:?}");
    }
}

/// T-1: the trajectory of ten steps, and eq. 5 along it.
#[test]
fn a_small_network_follows_the_equations() {
    let expected = [
        [0.374978528603, 0.321305207515, 0.303716263882, 0.077085415478],
        [0.419172844862, 0.305837784607, 0.274989370531, 0.156321929153],
        [0.465733782612, 0.286797055202, 0.247469162186, 0.237779926640],
        [0.514477224560, 0.264106511862, 0.221416263578, 0.321571978692],
        [0.565230876615, 0.237740802568, 0.197028320816, 0.407847602272],
        [0.617845551928, 0.207716304089, 0.174438143983, 0.496788029692],
        [0.672203585082, 0.174079953752, 0.153716461167, 0.588601347507],
        [0.728224142968, 0.136897639110, 0.134878217923, 0.683518223802],
        [0.785865608597, 0.096243221015, 0.117891170389, 0.781788328642],
        [0.845125498747, 0.052188943155, 0.102685558098, 0.883677469752],
    ];
    let mut network = small(T1, 1.0, 1.0);
    close(&network.regulated, &[1.0 / 3.0; 3]);
    for row in expected {
        network.step(&[0.25, 0.75]);
        close(&network.regulated, &row[..3]);
        close(&[speed(network.outputs()[0], network.outputs()[1]).unwrap()], &row[3..]);
    }
    for _ in 10..1000 {
        network.step(&[0.25, 0.75]);
    }
    close(&network.regulated, &[1.0, 0.0, 0.0]); // T-2
}

/// T-1: the weights are those of the differences to u⁺_max = 32 and u⁻_max = 26 (G-9).
#[test]
fn weights_are_taken_against_the_largest_affinity_that_acts() {
    let network = small(T1, 1.0, 1.0);
    // The regulated are O⁺ (enh 31, inh 25), O⁻ (10, 0), R (28, 25); the sources' ids 8, 7, 31.
    let enhance = |u: i32| exp(f64::from(u - 32));
    let inhibit = |u: i32| exp(f64::from(u - 26));
    let [first, _, last] = [0, 1, 2].map(|source| network.weights[source]);
    assert_eq!(first.enhance[..3], [enhance(32 - 23), enhance(32 - 2), enhance(32 - 20)]);
    assert_eq!(first.inhibit[..3], [inhibit(32 - 17), inhibit(32 - 8), inhibit(32 - 17)]);
    assert_eq!(last.enhance[..3], [1.0, enhance(32 - 21), enhance(32 - 3)]);
    assert_eq!(last.inhibit[..3], [1.0, inhibit(1), 1.0]);
}

/// T-2: varying inputs, and other scaling factors.
#[test]
fn inputs_and_scaling_factors_steer_the_network() {
    let mut network = small(T1, 1.0, 1.0);
    for t in 0..10 {
        let share = f64::from(t) / 10.0;
        network.step(&[share, 1.0 - share]);
    }
    close(&network.regulated, &[0.742303661927, 0.167507369400, 0.090188968673]);
    let mut network = small(T1, 0.5, 2.0);
    for _ in 0..10 {
        network.step(&[0.25, 0.75]);
    }
    close(&network.regulated, &[0.979900518709, 0.0, 0.020099481291]);
}

/// T-3
#[test]
fn negative_concentrations_are_cut_before_normalising() {
    let mut network = small(T3, 1.0, 1.0);
    let mut after = |steps| {
        for _ in 0..steps {
            network.step(&[0.25, 0.75]);
        }
        network.regulated.clone()
    };
    close(&after(1), &[0.193296521422, 0.438930827730, 0.367772650848]);
    close(&after(1), &[0.058667425657, 0.539422339963, 0.401910234380]);
    let third = after(1);
    close(&third, &[0.0, 0.593135784884, 0.406864215116]);
    assert_eq!(speed(third[0], third[1]), Some(-1.0));
    close(&after(7), &[0.0, 0.672115619923, 0.327884380077]);
}

/// T-5, X-9
#[test]
fn a_collapsed_network_starts_over_and_is_counted() {
    for (delta, collapses) in [(2.0, 1), (0.5, 0)] {
        let mut network = small(T5, 1.0, delta);
        network.step(&[0.0, 1.0]);
        close(&network.regulated, &[1.0 / 3.0; 3]);
        assert_eq!(network.collapses(), collapses);
    }
}

/// T-6: enh and inh of inputs and the id of outputs are inert.
#[test]
fn inert_tags_change_no_bit() {
    let trajectory = |tags| {
        let mut network = small(tags, 1.0, 1.0);
        (0..50).map(|_| (network.step(&[0.25, 0.75]), network.regulated.clone()).1).collect::<Vec<_>>()
    };
    let mut changed = T1;
    (changed[0].1, changed[0].2, changed[1].1, changed[1].2) = (0, 31, 8, 8);
    (changed[2].0, changed[3].0) = (17, 25);
    assert_eq!(trajectory(T1), trajectory(changed));
    changed[4].0 = 30;
    assert_ne!(trajectory(T1), trajectory(changed), "a regulatory protein's id does act");
}

/// T-7, X-10: eq. 5.
#[test]
fn two_silent_outputs_command_no_speed() {
    let cases = [(0.3, 0.1, Some(0.5)), (0.0, 0.2, Some(-1.0)), (0.25, 0.25, Some(0.0)), (0.0, 0.0, None)];
    for (positive, negative, expected) in cases {
        let found = speed(positive, negative);
        assert!(
            found.zip(expected).map_or(found == expected, |(f, e): (f64, f64)| (f - e).abs() < 1e-9),
            "({positive}, {negative}) gives {found:?}"
        );
    }
}

/// T-4: G-15 holds throughout on networks of every size.
#[test]
fn concentrations_stay_shares_of_one() {
    let settings = Settings::default();
    for index in 0..400 {
        let body = BodyKind::ALL[index as usize % 4];
        let mut stream = stream(4, [0, 0, index], "grn test");
        let genotype = Genotype::random(body, &settings, &mut stream);
        let mut network = Network::new(&genotype);
        assert_eq!(network.outputs().len(), 2 * body.degrees());
        let mut inputs: Vec<f64> = (0..body.inputs()).map(|_| stream.unit()).collect();
        for step in 0..1000 {
            if index % 2 == 1 {
                for (place, value) in inputs.iter_mut().enumerate() {
                    let phase = 0.05 * f64::from(step) * (1.0 + 0.1 * place as f64);
                    *value = 0.5 + 0.5 * crate::math::sin(phase);
                }
            }
            network.step(&inputs);
            assert!(network.regulated.iter().all(|c| (0.0..=1.0).contains(c)));
            let sum: f64 = network.regulated.iter().sum();
            assert!((sum - 1.0).abs() <= 1e-12, "the sum is {sum} at step {step} of {index}");
        }
    }
}

use super::*;
use crate::random::stream;

/// One or more oscillations, drawn.
pub(crate) fn random(oscillations: usize, seed: u64) -> Controller {
    let mut draws = stream(seed, [0, 0, 0], "controller");
    let mut draw = |count: usize, low: f64, high: f64| -> Vec<f64> {
        (0..count).map(|_| draws.between(low, high)).collect()
    };
    Controller {
        frequency: draw(oscillations, 1.0, 4.0),
        offset: draw(MUSCLES, 0.3, 0.7),
        amplitude: draw(MUSCLES * oscillations, 0.0, 0.5),
        phase: draw(MUSCLES * oscillations, -PI, PI),
    }
}

/// AF-4
#[test]
fn controllers_out_of_order_are_refused_with_their_field() {
    let refused = |change: &dyn Fn(&mut Controller)| {
        let mut controller = random(2, 1);
        change(&mut controller);
        controller.check("controller").unwrap_err().to_string()
    };
    let messages = [
        refused(&|c| c.frequency.clear()),
        refused(&|c| c.frequency = vec![1.0; 8]),
        refused(&|c| c.frequency[1] = 0.0),
        refused(&|c| c.frequency[0] = 58.0),
        refused(&|c| c.offset[3] = f64::NAN),
        refused(&|c| c.amplitude[23] = 1.5),
        refused(&|c| c.phase[0] = 4.0),
        refused(&|c| c.phase.truncate(23)),
    ];
    let expected = [
        "controller.frequency`: 0 oscillations where 1 to 7 are legal",
        "controller.frequency`: 8 oscillations where 1 to 7 are legal",
        "controller.frequency[1]`: 0 is not within 0 to 57.1, 0 left out",
        "controller.frequency[0]`: 58 is not within 0 to 57.1, 0 left out",
        "controller.offset[3]`: NaN is not within 0 to 1",
        "controller.amplitude[23]`: 1.5 is not within 0 to 1",
        "controller.phase[0]`: 4 is not within -3.141592653589793 to 3.141592653589793",
        "controller.phase`: 23 values where 24 are needed",
    ];
    assert_eq!(messages, expected.map(|message| format!("genotype field `{message}")));
}

///
#[test]
fn muscles_swing_about_their_offsets() {
    let mut controller = random(1, 1);
    (controller.offset[2], controller.amplitude[2], controller.phase[2]) = (0.5, 0.3, 0.7);
    let mut phases = [0.0; OSCILLATIONS_MAX];
    for step in 1..100 {
        advance(&mut phases, &controller.frequency);
        let time = f64::from(step) * TIME_STEP;
        let expected = 0.5 + 0.3 * cos(controller.frequency[0] * time + 0.7);
        assert!((controller.actuation(&phases)[2] - expected).abs() < 1e-12);
    }
    controller.amplitude[2] = 1.0;
    let clipped = controller.actuation(&[-0.7; OSCILLATIONS_MAX])[2];
    assert_eq!(clipped, 1.0);
}

///
#[test]
fn a_symmetrised_controller_is_its_own_mirror_image_half_a_beat_later() {
    for oscillations in [1, 2] {
        let straight = random(oscillations, 3).symmetrised();
        straight.check("controller").unwrap();
        let twice = straight.symmetrised();
        let image = straight.mirrored();
        for muscle in 0..MUSCLES {
            assert!((image.offset[muscle] - straight.offset[muscle]).abs() < 1e-15);
            for at in muscle * oscillations..(muscle + 1) * oscillations {
                assert!((image.amplitude[at] - straight.amplitude[at]).abs() < 1e-15);
                assert!((twice.amplitude[at] - straight.amplitude[at]).abs() < 1e-15);
                assert!((wrap_angle(image.phase[at] - straight.phase[at]).abs() - PI).abs() < 1e-12);
            }
        }
    }
    // A worked segment: z = ((1 + i) + 0 − (−1 + i) − 0) / 4 · 0.2 = 0.1.
    let mut controller = random(1, 4);
    controller.amplitude[..4].copy_from_slice(&[0.2 * 2f64.sqrt(), 0.2 * 2f64.sqrt(), 0.0, 0.0]);
    controller.phase[..4].copy_from_slice(&[PI / 4.0, 3.0 * PI / 4.0, 0.0, 0.0]);
    let straight = controller.symmetrised();
    assert!(straight.amplitude[..4].iter().all(|a| (a - 0.1).abs() < 1e-15), "{:?}", straight.amplitude);
    assert!(straight.phase[0].abs() < 1e-12 && (straight.phase[1].abs() - PI).abs() < 1e-12);
}

#[test]
fn a_mirror_image_of_a_mirror_image_and_two_half_beats_change_nothing() {
    let controller = random(2, 5);
    assert_eq!(controller.mirrored().mirrored(), controller);
    let round = random(1, 6).later(PI).later(PI);
    for (found, expected) in round.phase.iter().zip(&random(1, 6).phase) {
        assert!((found - expected).abs() < 1e-12);
    }
}

///
#[test]
fn phases_are_interpolated_along_the_shorter_arc() {
    let (mut a, mut b) = (random(1, 7), random(1, 8));
    (a.phase[0], b.phase[0]) = (3.0, -3.0);
    (a.offset[0], b.offset[0]) = (0.2, 0.6);
    let between = |share: f64| {
        let mut blended = a.clone();
        blended.blend(&a, &b, share);
        blended
    };
    let middle = between(0.5);
    assert!((middle.phase[0].abs() - PI).abs() < 1e-12, "{}", middle.phase[0]);
    assert!((middle.offset[0] - 0.4).abs() < 1e-15);
    assert!((between(0.0).phase[0] - 3.0).abs() < 1e-12);
    assert_eq!(a.amplified(100.0).amplitude.iter().fold(0.0f64, |most, &a| most.max(a)), 1.0);
}

///
#[test]
fn a_bent_swim_keeps_its_beat_and_leans_as_the_turn_does() {
    let (swim, mut turn) = (random(1, 9).symmetrised(), random(1, 10));
    turn.offset[4..8].copy_from_slice(&[0.8, 0.2, 0.4, 0.6]); // 2 d = 0.7 − 0.3
    let bent = swim.bent(&turn, 0.5);
    assert_eq!((&bent.amplitude, &bent.phase), (&swim.amplitude, &swim.phase));
    let change: Vec<f64> = (4..8).map(|muscle| bent.offset[muscle] - swim.offset[muscle]).collect();
    for (found, expected) in change.iter().zip([0.1, -0.1, -0.1, 0.1]) {
        assert!((found - expected).abs() < 1e-12, "{change:?}");
    }
    assert_eq!(
        swim.bent(&turn.symmetrised(), 1.0).offset,
        swim.offset,
        "a turn that leans nowhere bends nothing"
    );
    bent.check("controller").unwrap();
}

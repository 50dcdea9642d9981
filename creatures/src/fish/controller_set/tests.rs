use super::*;
use crate::fish::controller::{OSCILLATIONS_MAX, advance};
use crate::fish::mechanics::TIME_STEP;
use crate::math::wrap_angle;
use std::f64::consts::PI;

/// A controller that beats as the hand-made one does, bent to the left by an offset.
pub(crate) fn beating(amplitude: f64, bend: f64) -> Controller {
    let side = |muscle: usize| if [0, 3].contains(&(muscle % 4)) { 1.0 } else { -1.0 };
    let (mut offset, mut swing, mut phase) = (vec![], vec![], vec![]);
    for muscle in 0..12 {
        let segment = muscle / 4;
        let lean = if segment < 2 { bend * side(muscle) } else { 0.0 };
        offset.push((0.5 * amplitude + lean).clamp(0.0, 1.0));
        swing.push(if segment == 0 { 0.0 } else { 0.5 * amplitude });
        let lag = if segment == 2 { PI } else { 0.0 };
        phase.push(wrap_angle(if side(muscle) > 0.0 { lag } else { lag + PI }));
    }
    Controller { frequency: vec![4.0], offset, amplitude: swing, phase }
}

/// Two speeds and two turns, measured as they are.
pub(crate) fn set() -> ControllerSet {
    let entry = |name: &str, amplitude, bend, measured| Calibrated {
        name: name.to_owned(),
        controller: beating(amplitude, bend),
        measured,
    };
    ControllerSet {
        swims: vec![entry("slow", 0.5, 0.0, 0.0417), entry("fast", 1.0, 0.0, 0.0719)],
        turns: vec![entry("gentle", 1.0, 0.2, 0.025), entry("sharp", 1.0, 0.4, 0.05)],
    }
}

///
#[test]
fn maps_pass_through_what_was_measured_and_between() {
    let set = set();
    set.check().unwrap();
    assert_eq!(set.controller(1.0, 0.0), set.swims[1].controller);
    let slow = set.controller(0.0417 / 0.0719, 0.0);
    assert!((slow.amplitude[5] - 0.25).abs() < 1e-12);
    let slower = set.controller(0.5 * 0.0417 / 0.0719, 0.0);
    assert!((slower.amplitude[5] - 0.125).abs() < 1e-12, "amplitudes shrink toward rest");
    let sharp = set.controller(1.0, 0.75);
    assert_eq!((sharp.offset, sharp.amplitude), (beating(1.0, 0.4).offset, beating(1.0, 0.4).amplitude));
    let gentler = set.controller(1.0, 0.75 * 0.25);
    assert!((gentler.offset[0] - 0.6).abs() < 1e-12, "half way from straight to gentle");
}

/// right turns mirror left ones, and a bias that passes through 0 breaks no beat.
#[test]
fn right_turns_mirror_left_ones_and_the_beat_goes_on() {
    let set = set();
    let (left, right) = (set.controller(1.0, 0.5), set.controller(1.0, -0.5));
    assert_eq!(right.mirrored().offset, left.offset);
    let mut phases = [0.0; OSCILLATIONS_MAX];
    for _ in 0..50 {
        advance(&mut phases, &[4.0]);
        let at = |bias| set.controller(1.0, bias).actuation(&phases);
        for (a, b) in at(1e-9).into_iter().zip(at(-1e-9)) {
            assert!((a - b).abs() < 1e-6, "after {} of time", TIME_STEP);
        }
    }
}

///
#[test]
fn sets_out_of_order_are_refused_with_their_field() {
    let refused = |change: &dyn Fn(&mut ControllerSet)| {
        let mut set = set();
        change(&mut set);
        set.check().unwrap_err().to_string()
    };
    let messages = [
        refused(&|set| set.turns.clear()),
        refused(&|set| set.swims.swap(0, 1)),
        refused(&|set| set.turns[0].measured = -0.01),
        refused(&|set| set.swims[1].measured = f64::NAN),
        refused(&|set| set.turns[1].name = "slow".to_owned()),
        refused(&|set| set.turns[1].controller.offset[3] = 2.0),
        refused(&|set| set.turns[1].controller = beating(1.0, 0.0).clone().with_two_oscillations()),
    ];
    let expected = [
        "controller_set.turns`: has no controller",
        "controller_set.swims[1].measured`: 0.0417 is not above 0.0719",
        "controller_set.turns[0].measured`: -0.01 is not above 0",
        "controller_set.swims[1].measured`: NaN is not above 0.0417",
        "controller_set.turns[1].name`: `slow` is there twice",
        "controller_set.turns[1].controller.offset[3]`: 2 is not within 0 to 1",
        "controller_set.turns[1].controller.frequency`: 2 oscillations beside others",
    ];
    assert_eq!(messages, expected.map(|message| format!("genotype field `{message}")));
}

impl Controller {
    fn with_two_oscillations(mut self) -> Controller {
        self.frequency.push(2.0);
        self.amplitude = vec![0.1; 24];
        self.phase = vec![0.0; 24];
        self
    }
}

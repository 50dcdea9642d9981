use super::*;
use crate::fish::controller::{OSCILLATIONS_MAX, advance};
use crate::math::wrap_angle;
use std::f64::consts::PI;

/// A controller that beats as the hand-made one does, bent to the left by an offset.
pub(crate) fn beating(amplitude: f64, bend: f64) -> Controller {
    let side = |muscle: usize| if [0, 3].contains(&(muscle % 4)) { 1.0 } else { -1.0 };
    let (mut offset, mut swing, mut phase) = (vec![], vec![], vec![]);
    for muscle in 0..12 {
        let segment = muscle / 4;
        let lean = if segment < 2 { bend * side(muscle) } else { 0.0 };
        let swings = if segment == 0 { 0.0 } else { 0.5 * amplitude };
        offset.push((swings + lean).clamp(0.0, 1.0));
        swing.push(swings);
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

fn near(found: &[f64], expected: &[f64]) {
    let error = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error < 1e-12, "{found:?} is not {expected:?}");
}

///
#[test]
fn maps_pass_through_what_was_measured_and_between() {
    let set = set();
    set.check().unwrap();
    let mut maps = Maps::new(&set);
    let fast = maps.controller(1.0, 0.0);
    near(&fast.amplitude, &beating(1.0, 0.0).amplitude);
    near(&fast.phase, &beating(1.0, 0.0).phase);
    near(&maps.controller(0.0417 / 0.0719, 0.0).amplitude, &beating(0.5, 0.0).amplitude);
    let slower = maps.controller(0.5 * 0.0417 / 0.0719, 0.0);
    near(&slower.amplitude, &beating(0.25, 0.0).amplitude);
    let sharp = maps.controller(1.0, 0.75);
    near(&sharp.offset, &beating(1.0, 0.4).offset);
    near(&maps.controller(1.0, 2.0).offset, &beating(1.0, 0.4).offset);
    let gentler = maps.controller(1.0, 0.75 * 0.25);
    near(&gentler.offset, &beating(1.0, 0.1).offset);
    near(&maps.controller(0.0, 0.0).amplitude, &[0.0; 12]);
}

/// right turns mirror left ones, and a bias that passes through 0 breaks no beat.
#[test]
fn right_turns_mirror_left_ones_and_the_beat_goes_on() {
    let mut maps = Maps::new(&set());
    let left = maps.controller(1.0, 0.5).clone();
    let right = maps.controller(1.0, -0.5);
    near(&right.mirrored().offset, &left.offset);
    let later = right.mirrored().later(PI);
    for (found, expected) in later.phase.iter().zip(&left.phase) {
        assert!(wrap_angle(found - expected).abs() < 1e-12);
    }
    let mut phases = [0.0; OSCILLATIONS_MAX];
    for _ in 0..50 {
        advance(&mut phases, &[4.0]);
        let mut at = |bias| maps.controller(1.0, bias).actuation(&phases);
        let (left, right) = (at(1e-9), at(-1e-9));
        near_enough(&left, &right);
    }
}

fn near_enough(a: &[f64], b: &[f64]) {
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?} {b:?}");
}

///
#[test]
fn what_was_measured_is_sorted_and_brought_into_step() {
    let ControllerSet { swims, turns } = set();
    let late = |entry: &Calibrated| Calibrated { controller: entry.controller.later(2.0), ..entry.clone() };
    let backward = Calibrated { name: "backward".to_owned(), measured: -0.01, ..swims[0].clone() };
    let no_faster = Calibrated { name: "twin".to_owned(), ..swims[1].clone() };
    let unsorted = vec![swims[1].clone(), no_faster, late(&swims[0]), backward];
    let found = ControllerSet::assembled(unsorted, turns.iter().rev().map(late).collect()).unwrap();
    found.check().unwrap();
    for (found, expected) in found.swims.iter().chain(&found.turns).zip(swims.iter().chain(&turns)) {
        assert_eq!((&found.name, found.measured), (&expected.name, expected.measured));
        for (found, expected) in found.controller.phase.iter().zip(&expected.controller.phase) {
            assert!(wrap_angle(found - expected).abs() < 1e-12);
        }
    }
    assert_eq!(ControllerSet::assembled(swims, vec![]), None);
    assert_eq!(ControllerSet::assembled(vec![], turns), None);
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

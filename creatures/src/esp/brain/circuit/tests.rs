//! The circuit: delays of a tick, T-1's nodes with memory, T-3's nested groups, and what holds of every brain.

use super::*;
use crate::esp::brain::tests::{body, key, legal_brain, senses};
use crate::esp::brain::{Control, Node, Output, Seal, Source, Target};
use crate::esp::pandemonium::Winner;
use crate::esp::syllabus::tests::ten_skills;
use proptest::prelude::*;

const FORWARD: SkillId = SkillId(0);

fn syllabus() -> Syllabus {
    ten_skills().check().unwrap()
}

/// Outputs of one node over ticks, whose only input is a receptor with the given signals.
fn watch(kind: NodeKind, signals: &[f64]) -> Vec<f64> {
    let node = Node { kind, inputs: vec![Some(Source::Photo(key(9)))] };
    let outputs = vec![Output { node: 0, target: Target::Muscle(key(0)) }];
    let control = Control { skill: FORWARD, seal: Seal::Open, nodes: vec![node], outputs };
    let body = Instances { muscles: vec![key(0)], photos: vec![key(9)] };
    let forced = [Forced { skill: FORWARD, sigma: 1.0 }];
    let mut circuit = Circuit::new(&Brain { controls: vec![control] }, &body, &syllabus(), &forced);
    let mut tick = |signal: f64| {
        circuit.photos_mut()[0] = signal;
        circuit.tick();
        circuit.told[0] // y of this tick; the muscle follows in the next
    };
    signals.iter().map(|&signal| tick(signal)).collect()
}

/// T-1
#[test]
fn a_delay_gives_the_input_of_so_many_ticks_before_the_last() {
    let outputs = watch(NodeKind::Delay { ticks: 2 }, &[0.1, 0.2, 0.3, 0.9, 0.0, 0.0, 0.0]);
    assert_eq!(outputs, [0.0, 0.0, 0.0, 0.1, 0.2, 0.3, 0.9]);
}

/// T-1: the input of the tick before against that of two ticks before; silence before the first.
#[test]
fn a_derivative_gives_the_rise_between_the_last_two_ticks() {
    let outputs = watch(NodeKind::Derivative { tau: 0.25 }, &[0.0, 0.50, 0.52, 0.50, 0.9, 0.9, 0.9]);
    for (found, expected) in outputs.into_iter().zip([0.0, 0.0, 1.0, 0.3, 0.0, 1.0, 0.0]) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }
}

/// E-33: receptor, node, muscle input, muscle.
#[test]
fn a_signal_passes_one_node_a_tick() {
    let node = |source| Node { kind: NodeKind::Scale { factor: 1.0 }, inputs: vec![Some(source)] };
    let nodes = vec![node(Source::Node(1)), node(Source::Photo(key(9)))];
    let outputs = vec![Output { node: 0, target: Target::Muscle(key(0)) }];
    let control = Control { skill: FORWARD, seal: Seal::Open, nodes, outputs };
    let body = Instances { muscles: vec![key(0)], photos: vec![key(9)] };
    let forced = [Forced { skill: FORWARD, sigma: 1.0 }];
    let mut circuit = Circuit::new(&Brain { controls: vec![control] }, &body, &syllabus(), &forced);
    let mut activations = Vec::new();
    for tick in 0..6 {
        circuit.photos_mut()[0] = if tick == 0 { 0.6 } else { 0.0 };
        activations.push(circuit.tick()[0]);
    }
    assert_eq!(activations, [0.0, 0.0, 0.0, 0.6, 0.0, 0.0]);
}

#[test]
fn senses_are_limited_and_what_is_no_number_is_silence() {
    let outputs = watch(NodeKind::Complement, &[f64::NAN, 7.0, -7.0, 0.25, 0.0]);
    assert_eq!(outputs, [1.0, 1.0, 0.0, 1.0, 0.75]);
}

/// A control of constants, each driving one skill.
fn calls(skill: &str, called: &[(&str, f64)]) -> Control {
    let id = |name: &str| syllabus().find(name).unwrap();
    let constant = |value| Node { kind: NodeKind::Constant { value }, inputs: vec![] };
    Control {
        skill: id(skill),
        seal: Seal::Locked,
        nodes: called.iter().map(|&(_, value)| constant(value)).collect(),
        outputs: (0..)
            .zip(called)
            .map(|(node, (name, _))| Output { node, target: Target::Skill(id(name)) })
            .collect(),
    }
}

/// T-3: move_to_light at 0.6 against strike at 0.55, and what follows below.
#[test]
fn groups_are_decided_from_the_top() {
    let brain = Brain {
        controls: vec![
            calls("forward_locomotion", &[]),
            calls("left_turn", &[]),
            calls("right_turn", &[]),
            calls("turn_to_light", &[("left_turn", 0.1), ("right_turn", 0.4)]),
            calls("move_to_light", &[("turn_to_light", 0.3), ("forward_locomotion", 0.2)]),
            calls("strike", &[]),
            calls("attack", &[("move_to_light", 0.6), ("strike", 0.55)]),
        ],
    };
    let effective = |winner: Winner| {
        let mut table = ten_skills();
        for group in &mut table.pandemonium {
            group.winner = winner;
        }
        let syllabus = table.check().unwrap();
        brain.check(&syllabus).unwrap();
        let forced = [Forced { skill: syllabus.find("attack").unwrap(), sigma: 1.0 }];
        let mut circuit = Circuit::new(&brain, &body(), &syllabus, &forced);
        circuit.tick();
        let names =
            ["move_to_light", "strike", "turn_to_light", "forward_locomotion", "left_turn", "right_turn"];
        names.map(|name| circuit.effective(syllabus.find(name).unwrap()).unwrap())
    };
    assert_eq!(effective(Winner::Full), [1.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    for (found, expected) in effective(Winner::Own).into_iter().zip([0.6, 0.0, 0.18, 0.0, 0.0, 0.072]) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }
}

/// T-3, E-53: forward F against turn T, and against turn V.
#[test]
fn who_is_in_two_groups_has_to_win_in_both() {
    let names = ["forward_locomotion", "turn_to_light", "turn_from_light"];
    let brain = Brain { controls: names.map(|name| calls(name, &[])).to_vec() };
    let syllabus = syllabus();
    let on = |raw: [f64; 3]| {
        let forced: Vec<Forced> = names
            .iter()
            .zip(raw)
            .map(|(name, sigma)| Forced { skill: syllabus.find(name).unwrap(), sigma })
            .collect();
        let mut circuit = Circuit::new(&brain, &body(), &syllabus, &forced);
        circuit.tick();
        names.map(|name| circuit.effective(syllabus.find(name).unwrap()).unwrap())
    };
    assert_eq!(on([0.5, 0.3, 0.6]), [0.0, 0.0, 1.0]);
    assert_eq!(on([0.7, 0.3, 0.6]), [1.0, 0.0, 0.0]);
    assert_eq!(on([0.2, 0.3, 0.6]), [0.0, 1.0, 1.0]);
}

/// E-52
#[test]
fn a_tie_goes_to_whoever_won_before() {
    // left calls louder in the first tick, then both are equally loud.
    let mut caller = calls("turn_to_light", &[("left_turn", 0.4), ("right_turn", 0.4)]);
    caller.nodes[0] = Node { kind: NodeKind::Complement, inputs: vec![Some(Source::Photo(key(3)))] };
    let brain = Brain { controls: vec![calls("left_turn", &[]), calls("right_turn", &[]), caller] };
    let mut table = ten_skills();
    table.pandemonium[0].members.reverse();
    let syllabus = table.check().unwrap();
    let forced = [Forced { skill: syllabus.find("turn_to_light").unwrap(), sigma: 1.0 }];
    let mut circuit = Circuit::new(&brain, &body(), &syllabus, &forced);
    let mut left = Vec::new();
    for signal in [0.6, 0.9, 0.6, 0.6] {
        circuit.photos_mut()[0] = signal;
        circuit.tick();
        left.push(circuit.effective(syllabus.find("left_turn").unwrap()).unwrap());
    }
    // 1.0, 0.4, 0.1, 0.4 against 0.4: left, left by the tie, right, right by the tie.
    assert_eq!(left, [1.0, 1.0, 0.0, 0.0]);
}

/// EF-9
#[test]
fn locked_wires_to_what_is_not_there_are_inert_and_counted() {
    let node = |source| Node { kind: NodeKind::Complement, inputs: vec![Some(source)] };
    let product = Node {
        kind: NodeKind::Multiply,
        inputs: vec![Some(Source::Length(key(0))), Some(Source::Photo(key(66)))],
    };
    let mut control = Control {
        skill: FORWARD,
        seal: Seal::Locked,
        nodes: vec![node(Source::Photo(key(66))), product],
        outputs: [(0, 0), (0, 77), (1, 1)]
            .map(|(node, muscle)| Output { node, target: Target::Muscle(key(muscle)) })
            .to_vec(),
    };
    let run = |control: &Control| {
        let brain = Brain { controls: vec![control.clone()] };
        let forced = [Forced { skill: FORWARD, sigma: 1.0 }];
        let mut circuit = Circuit::new(&brain, &body(), &syllabus(), &forced);
        for _ in 0..3 {
            circuit.lengths_mut().fill(0.5);
            circuit.tick();
        }
        (circuit.inert(), circuit.activations[..2].to_vec())
    };
    assert_eq!(run(&control), (3, vec![1.0, 0.0]), "an inert input reads 0, in a product too");

    let mut locked = Brain { controls: vec![control.clone()] };
    assert_eq!(locked.prune(&body()), 3, "E-36: they stay");
    assert_eq!(locked.controls[0], control);
    control.seal = Seal::Open;
    let mut open = Brain { controls: vec![control] };
    assert_eq!(open.prune(&body()), 0, "E-36: they go");
    assert_eq!(open.controls[0].wires(), 3);
    assert_eq!(run(&open.controls[0]), (0, vec![1.0, 0.5]), "and one factor is left");
}

proptest! {
    #[test]
    fn no_brain_leaves_its_range_or_depends_on_what_it_is_not(seed in 0u64..1 << 40, top in 0u16..10) {
        let (syllabus, body) = (syllabus(), body());
        let brain = legal_brain(seed, &syllabus);
        let forced = [Forced { skill: SkillId(top), sigma: 1.0 }];
        let mut circuit = Circuit::new(&brain, &body, &syllabus, &forced);
        let mut again = Circuit::new(&brain, &body, &syllabus, &forced);
        for tick in 0..100 {
            senses(seed, tick, &mut circuit);
            senses(seed, tick, &mut again);
            let unit = |signal: &f64| (0.0..=1.0).contains(signal);
            prop_assert!(circuit.tick().iter().all(unit));
            prop_assert!(circuit.previous.iter().all(unit) && circuit.sigmas.gains().iter().all(unit));
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(again.tick()), bits(&circuit.activations));
        }
    }
}

//! Who reads whom (T-17), when (F-30), and what comes of it.

use super::*;
use crate::flyer::Function::*;
use crate::flyer::genotype::{BODY, WING_RADIUS, WING_ROOT, effectors};
use crate::flyer::{Effector, Node};

const LEFT: usize = FIRST_SEGMENT;

/// A genotype of plain bones without neurons, whose effectors have no inputs.
fn silent(segments: usize) -> Genotype {
    let node = |index| Node {
        length: 20.0,
        radius: if index == BODY { 1.0 } else { WING_RADIUS },
        lpercent: 0,
        theta: 0.0,
        psi: 0.0,
        neurons: Vec::new(),
        effectors: vec![Effector { inputs: Vec::new() }; effectors(index)],
    };
    Genotype { nodes: (0..FIRST_SEGMENT + segments).map(node).collect() }
}

fn neuron(function: Function, delay: u8, inputs: &[Source]) -> Neuron {
    Neuron { function, delay, inputs: inputs.to_vec() }
}

fn source(kind: Kind, node: usize, index: u8) -> Source {
    Source { node: node as u8, kind, index, cross: false }
}

fn from_sensor(node: usize, index: u8) -> Source {
    source(Kind::Sensor, node, index)
}

fn from_neuron(node: usize, index: u8) -> Source {
    source(Kind::Neuron, node, index)
}

fn crossed(source: Source) -> Source {
    Source { cross: true, ..source }
}

fn develop(genotype: &Genotype) -> Brain {
    Brain::new(&Genotype::decode(&genotype.encode()).unwrap())
}

/// The outputs of one neuron over brain steps of 0.025 s from time 0.
fn outputs(brain: &mut Brain, neuron: usize, steps: usize) -> Vec<f64> {
    let mut output = |step: usize| {
        brain.step(step as f64 * 0.025);
        brain.outputs[neuron]
    };
    (0..steps).map(&mut output).collect()
}

/// T-17: two segments; the wings' neurons are of nodes 2 and 3.
#[test]
fn a_central_neuron_reads_left_then_right_until_it_holds_three() {
    let roll = 6;
    let mut genotype = silent(2);
    for node in [2, 3] {
        genotype.nodes[node].neurons = vec![neuron(Average, 1, &[])];
    }
    let inputs = [from_neuron(2, 0), from_neuron(3, 0), from_sensor(WING_ROOT, roll)];
    genotype.nodes[BODY].neurons = vec![neuron(Average, 1, &inputs)];
    let brain = develop(&genotype);
    // Signals: 8 + 2 · 2 + 2 · 2 sensors, then the neurons of body, left 2, left 3, right 2, right 3.
    let [left_2, left_3, right_2] = [17, 18, 19];
    assert_eq!(brain.sensors, 16);
    assert_eq!(brain.neurons[0].inputs, Inputs { count: 3, signals: [left_2, right_2, left_3] });
}

/// T-17
#[test]
fn a_wing_neuron_reads_its_own_side_or_the_other_if_crossed() {
    let mut genotype = silent(2);
    let inputs = [from_neuron(2, 0), crossed(from_neuron(2, 0)), crossed(from_sensor(3, 1))];
    genotype.nodes[2].neurons = vec![neuron(Average, 1, &inputs)];
    let central = [from_sensor(WING_ROOT, 7), crossed(from_sensor(WING_ROOT, 7))];
    genotype.nodes[3].neurons = vec![neuron(Average, 1, &central)];
    let brain = develop(&genotype);
    // Sensors: wing-root 0..8, left 8..12, right 12..16. Neurons: left 2 and 3, right 2 and 3.
    let read = |cell: usize| brain.neurons[cell].inputs.signals;
    assert_eq!(read(0), [16, 18, 15], "left 2 reads left 2, right 2 and the stop of right 3");
    assert_eq!(read(2), [18, 16, 11], "right 2 reads right 2, left 2 and the stop of left 3");
    for wing in [1, 3] {
        assert_eq!(read(wing)[..2], [7, 7], "there is one wing-root for both wings");
    }
}

#[test]
fn sensors_and_effectors_come_by_body_left_before_right() {
    let mut genotype = silent(2);
    for (axis, effector) in genotype.nodes[WING_ROOT].effectors.iter_mut().enumerate() {
        effector.inputs = vec![from_sensor(WING_ROOT, axis as u8)];
    }
    for node in [2, 3] {
        genotype.nodes[node].effectors[0].inputs = vec![from_sensor(node, 0)];
    }
    let mut brain = develop(&genotype);
    assert_eq!(brain.effectors(), [0.0; 7]);
    let sensors = brain.sensors_mut();
    assert_eq!(sensors.len(), 8 + 4 + 4);
    for (reading, sensor) in sensors.iter_mut().enumerate() {
        *sensor = reading as f64 / 16.0;
    }
    brain.step(0.0);
    let expected = [0.0, 1.0, 2.0, 8.0, 10.0, 12.0, 14.0].map(|reading: f64| reading / 16.0);
    assert_eq!(brain.effectors(), expected);
}

/// F-31
#[test]
fn an_effector_gives_the_mean_of_its_inputs() {
    let mut genotype = silent(1);
    genotype.nodes[LEFT].effectors[0].inputs =
        vec![from_sensor(WING_ROOT, 6), from_sensor(WING_ROOT, 7), from_sensor(LEFT, 0)];
    let mut brain = develop(&genotype);
    brain.sensors_mut()[6..9].copy_from_slice(&[0.75, -0.25, 0.25]);
    brain.step(0.0);
    assert_eq!(brain.effectors(), [0.0, 0.0, 0.0, 0.25, 0.25 / 1.5]);
}

/// F-30: whatever their order, a signal passes one neuron a brain step, and every output starts at 0.
#[test]
fn a_signal_passes_one_neuron_a_brain_step() {
    let mut genotype = silent(1);
    // A chain against the order of evaluation, and one along it.
    genotype.nodes[BODY].neurons = vec![
        neuron(Average, 1, &[from_neuron(WING_ROOT, 0)]),
        neuron(Average, 1, &[from_sensor(WING_ROOT, 7)]),
        neuron(Average, 1, &[from_neuron(BODY, 1)]),
    ];
    genotype.nodes[WING_ROOT].neurons = vec![neuron(Average, 1, &[from_sensor(WING_ROOT, 7)])];
    let mut brain = develop(&genotype);
    brain.sensors_mut()[7] = 0.5;
    brain.step(0.0);
    assert_eq!(brain.outputs, [0.0, 0.5, 0.0, 0.5]);
    brain.step(0.025);
    assert_eq!(brain.outputs, [0.5; 4]);
}

/// F-29, F-30: buffers are empty at the start, and each neuron has its own, each copy too.
#[test]
fn memories_are_of_brain_steps_and_of_one_neuron_each() {
    let mut genotype = silent(1);
    let own = [from_sensor(LEFT, 0)];
    genotype.nodes[LEFT].neurons =
        vec![neuron(Mem, 2, &own), neuron(Differentiate, 40, &own), neuron(Mem, 3, &own)];
    let mut brain = develop(&genotype);
    let mut seen = Vec::new();
    for reading in [0.25, 0.5, -0.25, 0.0, 1.0, 0.75] {
        let sensors = brain.sensors_mut();
        (sensors[8], sensors[10]) = (reading, -reading);
        brain.step(0.0);
        seen.push(brain.outputs.clone());
    }
    let course = |cell: usize| seen.iter().map(|outputs| outputs[cell]).collect::<Vec<_>>();
    assert_eq!(course(0), [0.0, 0.0, 0.25, 0.5, -0.25, 0.0]);
    assert_eq!(course(1), [0.0, 0.25, -0.75, 0.25, 1.0, -0.25]);
    assert_eq!(course(2), [0.0, 0.0, 0.0, 0.25, 0.5, -0.25]);
    for (left, right) in (0..3).zip(3..6) {
        let mirrored: Vec<_> = course(left).iter().map(|value| -value).collect();
        assert_eq!(course(right), mirrored);
    }
}

#[test]
fn a_neuron_that_reads_itself_keeps_its_state() {
    let mut genotype = silent(1);
    // x ← cos(x) from 0 goes to its fixed point 0.739085.
    genotype.nodes[BODY].neurons = vec![neuron(Cos, 1, &[from_neuron(BODY, 0)])];
    let course = outputs(&mut develop(&genotype), 0, 60);
    assert_eq!(course[0], 1.0);
    assert!((course[59] - 0.739085133).abs() < 1e-8, "{course:?}");
}

/// F-29: at the largest input a saw wave has a period of 2π s.
#[test]
fn a_saw_wave_follows_the_time_in_seconds() {
    let mut genotype = silent(1);
    genotype.nodes[BODY].neurons = vec![neuron(Cos, 1, &[]), neuron(SawWave, 1, &[from_neuron(BODY, 0)])];
    let course = outputs(&mut develop(&genotype), 1, 252);
    assert!((course[20] - 0.5 * 20.0 * 0.025).abs() < 1e-12);
    let falls = |step: &usize| course[*step] < course[step - 1];
    assert_eq!((1..252).filter(falls).collect::<Vec<_>>(), [126], "π s are 125.7 brain steps");
}

/// a function may leave [−1, 1], a signal never does.
#[test]
fn signals_stay_within_one() {
    let mut genotype = silent(1);
    let inputs = [from_sensor(WING_ROOT, 0), from_sensor(WING_ROOT, 1)];
    genotype.nodes[BODY].neurons = vec![neuron(Divide, 1, &inputs), neuron(Ln, 1, &inputs[1..])];
    let mut brain = develop(&genotype);
    brain.sensors_mut()[..2].copy_from_slice(&[-0.9, 1e-4]);
    brain.step(0.0);
    assert_eq!(brain.outputs, [-1.0, -1.0]);
}

#[test]
fn equal_readings_of_both_wings_give_equal_commands() {
    let mut genotype = silent(2);
    genotype.nodes[2].neurons = vec![
        neuron(Sin, 1, &[from_sensor(3, 0), crossed(from_neuron(3, 0)), from_sensor(WING_ROOT, 6)]),
        neuron(Mem, 4, &[from_neuron(2, 0)]),
    ];
    genotype.nodes[3].neurons =
        vec![neuron(Interpolate, 1, &[from_neuron(2, 1), crossed(from_sensor(2, 0))])];
    for (node, index) in [(2, 1), (3, 0)] {
        genotype.nodes[node].effectors[0].inputs = vec![from_neuron(node, index)];
    }
    let mut brain = develop(&genotype);
    for step in 0..50 {
        let reading = f64::from(step % 7) / 7.0;
        let sensors = brain.sensors_mut();
        sensors[6] = -reading;
        for first in [8, 12] {
            sensors[first..first + 4].copy_from_slice(&[reading, 1.0, 0.5 * reading, -1.0]);
        }
        brain.step(f64::from(step) * 0.025);
        let [left, right] = [&brain.effectors()[3..5], &brain.effectors()[5..7]];
        assert_eq!(left, right);
    }
    assert!(brain.effectors()[3] != 0.0 && brain.effectors()[4] != 0.0);
}

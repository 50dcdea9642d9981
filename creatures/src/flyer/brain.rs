//! A flyer's brain at work: the neurons and effectors of every node, those of wing segments once for each
//! side (F-24), over flat arrays (F-28, F-30, F-31). A step allocates nothing and draws nothing; sensing the
//! creature and driving its joints are others' business.

use super::Function;
use super::function::{limit, mean};
use super::genotype::{FIRST_SEGMENT, Genotype, INPUTS_MAX, Kind, Neuron, Source, sensors};

/// A living brain.
///
/// Bodies come in the order body, wing-root, left wing segments, right wing segments, each wing from its
/// root to its tip; sensors, neurons and effectors in the order of their bodies.
#[derive(Debug, Clone)]
pub struct Brain {
    sensors: usize,
    /// Sensors, then the neurons' outputs of the last brain step.
    signals: Vec<f64>,
    /// The neurons' outputs of the brain step under way.
    outputs: Vec<f64>,
    neurons: Vec<Cell>,
    effectors: Vec<Inputs>,
    /// The effectors' values.
    commands: Vec<f64>,
    /// The means that neurons remember, each in its own ring.
    memories: Vec<f64>,
    /// Brain steps so far.
    steps: usize,
}

/// A neuron of the phenotype.
#[derive(Debug, Clone, Copy)]
struct Cell {
    function: Function,
    inputs: Inputs,
    /// Where its ring begins in the memories.
    ring: usize,
    /// How many brain steps the ring holds.
    memory: usize,
}

/// The inputs of a neuron or an effector: which signals, in the order a, b, c.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Inputs {
    count: usize,
    signals: [usize; INPUTS_MAX],
}

impl Brain {
    /// Develops a legal genotype. Every signal starts at 0.
    pub fn new(genotype: &Genotype) -> Brain {
        let wiring = Wiring::new(genotype);
        let (mut neurons, mut effectors) = (Vec::new(), Vec::new());
        let mut ring = 0;
        for (reader, body) in wiring.bodies.iter().enumerate() {
            let node = &genotype.nodes[body.node];
            for Neuron { function, delay, inputs } in &node.neurons {
                let memory = function.memory(*delay);
                neurons.push(Cell {
                    function: *function,
                    inputs: wiring.resolve(reader, inputs),
                    ring,
                    memory,
                });
                ring += memory;
            }
            effectors.extend(node.effectors.iter().map(|effector| wiring.resolve(reader, &effector.inputs)));
        }
        Brain {
            sensors: wiring.sensors,
            signals: vec![0.0; wiring.sensors + neurons.len()],
            outputs: vec![0.0; neurons.len()],
            commands: vec![0.0; effectors.len()],
            memories: vec![0.0; ring],
            neurons,
            effectors,
            steps: 0,
        }
    }

    /// Where the sensors' readings go, each within [−1, 1], before the first brain step of a physics step:
    /// of the wing-root three joint angles, three joint stops, roll and pitch; then of each left wing
    /// segment its joint angle and joint stop; then of each right one (F-25).
    pub fn sensors_mut(&mut self) -> &mut [f64] {
        &mut self.signals[..self.sensors]
    }

    /// One brain step at a time, s: every neuron reads the sensors and what the neurons gave in the step
    /// before (F-30), then the effectors read both.
    pub fn step(&mut self, time: f64) {
        let mut buffer = [0.0; INPUTS_MAX];
        for (cell, output) in self.neurons.iter().zip(&mut self.outputs) {
            let inputs = cell.inputs.read(&self.signals, &mut buffer);
            let mut past = None;
            if cell.memory > 0 {
                let now = &mut self.memories[cell.ring + self.steps % cell.memory];
                let before = std::mem::replace(now, mean(inputs));
                past = (self.steps >= cell.memory).then_some(before);
            }
            *output = cell.function.output(inputs, past, time);
        }
        self.signals[self.sensors..].copy_from_slice(&self.outputs);
        self.steps += 1;
        for (inputs, command) in self.effectors.iter().zip(&mut self.commands) {
            *command = limit(mean(inputs.read(&self.signals, &mut buffer)));
        }
    }

    /// The effectors' values after the last brain step, each within [−1, 1], 0 for one without inputs
    /// (F-31): the wing-root's for the body's x, y and z axes, then one of each left wing segment, then of
    /// each right one.
    pub fn effectors(&self) -> &[f64] {
        &self.commands
    }
}

impl Inputs {
    fn read<'a>(&self, signals: &[f64], into: &'a mut [f64; INPUTS_MAX]) -> &'a [f64] {
        let into = &mut into[..self.count];
        for (value, &signal) in into.iter_mut().zip(&self.signals) {
            *value = signals[signal];
        }
        into
    }
}

/// Which signal is whose, while a brain develops.
struct Wiring {
    bodies: Vec<Body>,
    /// Wing segments a side.
    segments: usize,
    sensors: usize,
}

/// What stands for a node on one side, or for a central node.
struct Body {
    node: usize,
    /// Its first signal of either kind.
    sensors: usize,
    neurons: usize,
}

impl Wiring {
    fn new(genotype: &Genotype) -> Wiring {
        let count = genotype.nodes.len();
        let mut bodies: Vec<Body> = Vec::with_capacity(2 * count - FIRST_SEGMENT);
        let (mut sensor, mut neuron) = (0, 0);
        for node in (0..count).chain(FIRST_SEGMENT..count) {
            bodies.push(Body { node, sensors: sensor, neurons: neuron });
            sensor += sensors(node);
            neuron += genotype.nodes[node].neurons.len();
        }
        // The neurons' signals stand behind those of all sensors.
        bodies.iter_mut().for_each(|body| body.neurons += sensor);
        Wiring { bodies, segments: genotype.segments(), sensors: sensor }
    }

    /// The signals that a copy of a neuron or effector reads. A central one that reads a wing segment reads
    /// the left copy, then the right one; beyond three signals the rest is dropped. This is where the limit
    /// breaks the wings' symmetry (F-24).
    fn resolve(&self, reader: usize, sources: &[Source]) -> Inputs {
        let mut inputs = Inputs { count: 0, signals: [0; INPUTS_MAX] };
        for source in sources {
            for body in self.copies(reader, source).into_iter().flatten() {
                if inputs.count < INPUTS_MAX {
                    inputs.signals[inputs.count] = self.signal(body, source);
                    inputs.count += 1;
                }
            }
        }
        inputs
    }

    /// The bodies on which a reader finds a source.
    fn copies(&self, reader: usize, source: &Source) -> [Option<usize>; 2] {
        let left = usize::from(source.node);
        let right = left + self.segments;
        let first_right = FIRST_SEGMENT + self.segments;
        if left < FIRST_SEGMENT {
            [Some(left), None]
        } else if reader < FIRST_SEGMENT {
            [Some(left), Some(right)]
        } else {
            let reads_right = (reader >= first_right) != source.cross;
            [Some(if reads_right { right } else { left }), None]
        }
    }

    fn signal(&self, body: usize, source: &Source) -> usize {
        let first = match source.kind {
            Kind::Sensor => self.bodies[body].sensors,
            Kind::Neuron => self.bodies[body].neurons,
        };
        first + usize::from(source.index)
    }
}

#[cfg(test)]
mod tests;

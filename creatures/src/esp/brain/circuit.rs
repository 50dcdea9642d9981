//! A brain at work: flat arrays compiled before the run, one tick a physics step (E-33, E-47..E-53). It draws
//! nothing, and a tick allocates nothing.

mod sigma;
mod wiring;

use super::genotype::{Brain, Instances};
use super::node::{NodeKind, SLOTS_MAX, clamp};
use crate::esp::syllabus::{Sensor, SkillId, Syllabus};
use sigma::{Link, Sigmas};
use wiring::Wiring;

/// A skill that is switched on from outside (E-49).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forced {
    /// Which.
    pub skill: SkillId,
    /// Its raw sigma, within [0, 1]; of a skill under evolution, the strength of its outputs.
    pub sigma: f64,
}

/// A compiled brain and its state.
#[derive(Debug, Clone)]
pub struct Circuit {
    muscles: usize,
    photos: usize,
    /// Signals of the last tick: silence, muscle lengths, photoreceptors, sensors, then every control's nodes.
    previous: Vec<f64>,
    /// Those of this tick, in the same order.
    current: Vec<f64>,
    cells: Vec<Cell>,
    /// Indices into `previous`; a cell has a range of them.
    inputs: Vec<u32>,
    /// What cells with a memory have seen; a cell has a range of them.
    memory: Vec<f64>,
    sigmas: Sigmas,
    /// What drives each muscle; a muscle has a range of them.
    links: Vec<Link>,
    /// (muscles + 1), where each muscle's links start.
    link_starts: Vec<u32>,
    /// (muscles), what muscles do in this tick.
    activations: Vec<f64>,
    /// (muscles), what they are told to do in the next.
    told: Vec<f64>,
    tick: u32,
    inert: usize,
}

/// One node.
#[derive(Debug, Clone, Copy)]
struct Cell {
    kind: NodeKind,
    /// Its first input, and how many.
    input: u32,
    inputs: u32,
    /// Its first remembered value, and how many.
    memory: u32,
    memories: u32,
}

/// How many nodes and wires a circuit has, gates and sigmas included (E-34, E-46).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Census {
    /// Evolvable nodes, gates, sigmas and muscle inputs.
    pub nodes: usize,
    /// Wires among them, and from the senses.
    pub wires: usize,
}

impl Circuit {
    /// Compiles a brain for a body. It starts silent (E-49).
    ///
    /// The brain has passed [`Brain::check`] for the syllabus. `forced` skills are on; what is under evolution
    /// and not forced is off; every other skill is on as far as its users call it.
    pub fn new(brain: &Brain, body: &Instances, syllabus: &Syllabus, forced: &[Forced]) -> Circuit {
        let Wiring { cells, inputs, memory, links, link_starts, signals, nodes } = Wiring::of(brain, body);
        Circuit {
            muscles: body.muscles.len(),
            photos: body.photos.len(),
            previous: vec![0.0; signals],
            current: vec![0.0; signals],
            cells,
            inputs,
            memory: vec![0.0; memory],
            sigmas: Sigmas::of(brain, syllabus, forced, &nodes),
            links,
            link_starts,
            activations: vec![0.0; body.muscles.len()],
            told: vec![0.0; body.muscles.len()],
            tick: 0,
            inert: brain.inert(body),
        }
    }

    /// The muscles' lengths as felt, to be filled in before a tick; in the body's order, within [0, 1] (E-27).
    pub fn lengths_mut(&mut self) -> &mut [f64] {
        &mut self.current[1..1 + self.muscles]
    }

    /// The photoreceptors' signals, to be filled in before a tick; in the body's order, within [0, 1] (E-29).
    pub fn photos_mut(&mut self) -> &mut [f64] {
        &mut self.current[1 + self.muscles..][..self.photos]
    }

    /// The other sensors, to be filled in before a tick; in the order of [`Sensor::ALL`], within [0, 1] (E-32).
    pub fn sensors_mut(&mut self) -> &mut [f64] {
        &mut self.current[1 + self.muscles + self.photos..][..Sensor::ALL.len()]
    }

    /// One tick: from the senses that were filled in to the muscles' activations, in the order of E-33.
    ///
    /// Gives what every muscle does during this step, in the body's order, within [0, 1].
    pub fn tick(&mut self) -> &[f64] {
        let senses = self.current.len() - self.cells.len();
        for sense in &mut self.current[..senses] {
            *sense = clamp(*sense);
        }
        for (cell, signal) in self.cells.iter().zip(&mut self.current[senses..]) {
            *signal = cell.output(&self.inputs, &self.previous, &mut self.memory, self.tick);
        }
        self.sigmas.decide(&self.current);
        std::mem::swap(&mut self.activations, &mut self.told);
        for (muscle, told) in self.told.iter_mut().enumerate() {
            let links = self.link_starts[muscle] as usize..self.link_starts[muscle + 1] as usize;
            *told = self.sigmas.sum(&self.links[links], &self.current);
        }
        std::mem::swap(&mut self.previous, &mut self.current);
        self.tick += 1;
        &self.activations
    }

    /// Whether a skill was heard in the last tick: its effective sigma; none for a skill without control.
    pub fn effective(&self, skill: SkillId) -> Option<f64> {
        self.sigmas.effective(skill)
    }

    /// How many wires end at muscles or receptors that the body does not express (EF-9).
    pub fn inert(&self) -> usize {
        self.inert
    }
}

impl Cell {
    fn output(&self, inputs: &[u32], previous: &[f64], memory: &mut [f64], tick: u32) -> f64 {
        let mut values = [0.0; SLOTS_MAX];
        let count = self.inputs as usize;
        for (value, &input) in values.iter_mut().zip(&inputs[self.input as usize..][..count]) {
            *value = previous[input as usize];
        }
        let past = match self.memories {
            0 => 0.0,
            memories => {
                let seen = &mut memory[(self.memory + tick % memories) as usize];
                std::mem::replace(seen, values[0])
            }
        };
        self.kind.output(&values[..count], past, tick)
    }
}

impl Brain {
    /// How many nodes and wires the brain makes of a body with so many muscles (E-46): every skill that is
    /// encapsulated has a sigma and a gate an output, and brings a sigma in front of every muscle.
    pub fn census(&self, muscles: usize) -> Census {
        let mut census = Census { nodes: muscles, wires: 0 };
        for control in &self.controls {
            census.nodes += control.nodes.len();
            census.wires += control.wires();
            if control.is_encapsulated() {
                census.nodes += 1 + control.outputs.len();
                census.wires += 2 * control.outputs.len(); // into each gate from the sigma, and out of it
            }
        }
        if self.controls.iter().any(|control| control.is_encapsulated()) {
            census.nodes += muscles;
            census.wires += muscles;
        }
        census
    }
}

#[cfg(test)]
mod tests;

//! The dynamics of a gene regulatory network (G-6..G-15). Weights are computed once; a step allocates
//! nothing, draws nothing and keeps the paper's order of summation.

use super::{Genotype, Protein, TAG_MAX};
use crate::math::exp;

/// Regulated proteins that one block of weights serves: enough independent sums to keep a core's adders
/// busy while each sum stays in ascending order of sources (G-10).
const LANES: usize = 8;

/// Below this sum of concentrations the network has collapsed (G-12).
const COLLAPSE: f64 = 1e-12;

/// Weights of one source for [`LANES`] regulated proteins; those beyond the last are zero.
#[derive(Debug, Clone, Copy)]
struct Block {
    enhance: [f64; LANES],
    inhibit: [f64; LANES],
}

/// A living network.
#[derive(Debug, Clone)]
pub struct Network {
    inputs: usize,
    outputs: usize,
    /// N of G-10.
    proteins: f64,
    delta: f64,
    /// By block of regulated proteins, then by source.
    weights: Vec<Block>,
    /// Concentrations of the sources: inputs, then regulatory proteins.
    sources: Vec<f64>,
    /// Concentrations of the regulated: outputs, then regulatory proteins. Sums to 1.
    regulated: Vec<f64>,
    collapses: u32,
}

impl Network {
    /// Develops a legal genotype.
    pub fn new(genotype: &Genotype) -> Network {
        let body = genotype.body;
        Network::wire(body.inputs(), 2 * body.degrees(), &genotype.proteins, genotype.beta, genotype.delta)
    }

    /// Wires inputs, outputs and regulatory proteins, in this order, in the uniform state (G-13).
    pub(super) fn wire(
        inputs: usize,
        outputs: usize,
        proteins: &[Protein],
        beta: f64,
        delta: f64,
    ) -> Network {
        let targets = &proteins[inputs..];
        let sources = || proteins[..inputs].iter().chain(&proteins[inputs + outputs..]);
        let count = sources().count();
        let enhancing = Match::new(targets.iter().map(|target| target.enh), sources, beta);
        let inhibiting = Match::new(targets.iter().map(|target| target.inh), sources, beta);
        let mut weights = Vec::with_capacity(targets.len().div_ceil(LANES) * count);
        for lanes in targets.chunks(LANES) {
            for source in sources() {
                let mut block = Block { enhance: [0.0; LANES], inhibit: [0.0; LANES] };
                for (lane, target) in lanes.iter().enumerate() {
                    block.enhance[lane] = enhancing.weight(target.enh, source.id);
                    block.inhibit[lane] = inhibiting.weight(target.inh, source.id);
                }
                weights.push(block);
            }
        }
        let uniform = 1.0 / targets.len() as f64;
        let mut start = vec![uniform; count];
        start[..inputs].fill(0.0);
        Network {
            inputs,
            outputs,
            proteins: proteins.len() as f64,
            delta,
            weights,
            sources: start,
            regulated: vec![uniform; targets.len()],
            collapses: 0,
        }
    }

    /// One synchronous step under input concentrations in [0, 1] (eq. 2 and 3, G-10..G-12).
    pub fn step(&mut self, inputs: &[f64]) {
        self.sources[..self.inputs].copy_from_slice(inputs);
        let count = self.sources.len();
        for (targets, weights) in self.regulated.chunks_mut(LANES).zip(self.weights.chunks_exact(count)) {
            let mut g = [0.0; LANES];
            let mut h = [0.0; LANES];
            for (c, block) in self.sources.iter().zip(weights) {
                for lane in 0..LANES {
                    g[lane] += c * block.enhance[lane];
                    h[lane] += c * block.inhibit[lane];
                }
            }
            for (c, (g, h)) in targets.iter_mut().zip(g.iter().zip(&h)) {
                let next = *c + self.delta * (g / self.proteins - h / self.proteins);
                *c = if next > 0.0 { next } else { 0.0 };
            }
        }
        let total: f64 = self.regulated.iter().sum();
        if total <= COLLAPSE {
            let uniform = 1.0 / self.regulated.len() as f64;
            self.regulated.fill(uniform);
            self.collapses += 1;
        } else {
            self.regulated.iter_mut().for_each(|c| *c /= total);
        }
        self.sources[self.inputs..].copy_from_slice(&self.regulated[self.outputs..]);
    }

    /// Concentrations of the output proteins, two per degree of freedom: O⁺, O⁻.
    pub fn outputs(&self) -> &[f64] {
        &self.regulated[..self.outputs]
    }

    /// How often every concentration was cut to zero (G-12).
    pub fn collapses(&self) -> u32 {
        self.collapses
    }
}

/// Speed command of one pair of outputs (eq. 5, G-19); `None` for the frequent case of two zeros, which
/// commands speed 0.
pub fn speed(positive: f64, negative: f64) -> Option<f64> {
    let sum = positive + negative;
    (sum != 0.0).then(|| (positive - negative) / sum)
}

/// One kind of tag of the regulated against the ids of the sources (eq. 1, G-7..G-9).
struct Match {
    /// Weight by |tag − id|, since u differs by nothing else.
    by_distance: [f64; TAG_MAX as usize + 1],
}

impl Match {
    /// Takes the largest affinity over all pairs that act (G-8), and the weights against it (G-9).
    fn new<'a, I: Iterator<Item = &'a Protein>>(
        tags: impl Iterator<Item = u8>,
        sources: impl Fn() -> I,
        beta: f64,
    ) -> Match {
        let pairs = tags.flat_map(|tag| sources().map(move |source| affinity(tag.abs_diff(source.id))));
        let u_max = pairs.max().expect("a network has outputs and inputs");
        let by_distance =
            std::array::from_fn(|distance| exp(beta * f64::from(affinity(distance as u8) - u_max)));
        Match { by_distance }
    }

    fn weight(&self, tag: u8, id: u8) -> f64 {
        self.by_distance[usize::from(tag.abs_diff(id))]
    }
}

/// u of eq. 1 from |tag − id|.
fn affinity(distance: u8) -> i32 {
    i32::from(TAG_MAX) - i32::from(distance)
}

#[cfg(test)]
mod tests;

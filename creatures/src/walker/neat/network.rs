//! NEAT's network at work (G-43, G-46): nodes in topological order over flat arrays. A step allocates
//! nothing and draws nothing.

use super::genotype::{Genotype, Layout};
use crate::math::exp;
use std::collections::BTreeMap;

/// A living network.
#[derive(Debug, Clone)]
pub struct Network {
    sensors: usize,
    outputs: usize,
    /// Values of this step (sensors, bias, outputs, hidden), then those of the previous step.
    values: Vec<f64>,
    nodes: Vec<Node>,
    /// Enabled links, by node in order of evaluation, then by innovation.
    links: Vec<Incoming>,
}

/// A node to evaluate: where its value goes, and the end of its stretch of links.
#[derive(Debug, Clone, Copy)]
struct Node {
    value: usize,
    links_end: usize,
}

#[derive(Debug, Clone, Copy)]
struct Incoming {
    /// Index into `values`; of the previous step for recurrent links.
    source: usize,
    weight: f64,
}

impl Network {
    /// Develops a legal genotype. Every value starts at 0, the bias at 1.
    pub fn new(genotype: &Genotype) -> Network {
        let layout = Layout::of(genotype.body);
        let first_hidden = layout.first_hidden();
        let count = first_hidden as usize + genotype.hidden.len();
        let place = |node: u32| match node.checked_sub(first_hidden) {
            None => node as usize,
            Some(_) => {
                let hidden = genotype.hidden.binary_search(&node);
                first_hidden as usize + hidden.expect("links of a legal genotype join its nodes")
            }
        };
        let mut incoming: BTreeMap<u32, Vec<Incoming>> = BTreeMap::new();
        for link in genotype.links.iter().filter(|link| link.enabled) {
            let source = place(link.from) + if link.recurrent { count } else { 0 };
            incoming.entry(link.to).or_default().push(Incoming { source, weight: link.weight });
        }
        let (mut nodes, mut links) = (Vec::new(), Vec::new());
        for node in genotype.order().expect("a legal genotype is acyclic") {
            links.extend(incoming.remove(&node).into_iter().flatten());
            nodes.push(Node { value: place(node), links_end: links.len() });
        }
        let mut values = vec![0.0; 2 * count];
        values[layout.bias() as usize] = 1.0;
        Network { sensors: layout.sensors as usize, outputs: layout.outputs as usize, values, nodes, links }
    }

    /// One pass (G-46): a link brings its source's value of this step, a recurrent one that of the
    /// previous step. Sensors come as [−1, 1].
    pub fn step(&mut self, sensors: &[f64]) {
        let count = self.values.len() / 2;
        let (now, before) = self.values.split_at_mut(count);
        before.copy_from_slice(now);
        now[..self.sensors].copy_from_slice(sensors);
        let mut start = 0;
        for node in &self.nodes {
            let mut sum = 0.0;
            for link in &self.links[start..node.links_end] {
                sum += link.weight * self.values[link.source];
            }
            self.values[node.value] = activation(sum);
            start = node.links_end;
        }
    }

    /// Values of the output nodes, one per degree of freedom, each within [−1, 1].
    pub fn outputs(&self) -> &[f64] {
        &self.values[self.sensors + 1..][..self.outputs]
    }

    /// Values of the hidden nodes, ascending by number.
    pub fn hidden(&self) -> &[f64] {
        &self.values[self.sensors + 1 + self.outputs..self.values.len() / 2]
    }
}

/// The node function, `2/(1+e^(−x)) − 1` (G-43).
pub fn activation(x: f64) -> f64 {
    2.0 / (1.0 + exp(-x)) - 1.0
}

#[cfg(test)]
mod tests;

//! How NEAT's genotypes vary: founders, distance, crossover, mutation (G-30, G-32, G-39..G-42). It selects
//! nobody and keeps every genotype legal: no mutation closes a cycle or outgrows the limits.

use super::genotype::{Genotype, LINKS_MAX, Layout, Link, NODES_MAX, WEIGHT_MAX};
use super::register::Register;
use crate::SpecError;
use crate::random::Stream;
use crate::walker::body::BodyKind;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// How often a place for a new link is sought (G-42).
const LINK_DRAWS: usize = 20;

/// Probabilities of the mutations, ranges of the draws, coefficients of the distance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Probability that a child gets a node.
    pub add_node: f64,
    /// Probability that a child gets a link.
    pub add_link: f64,
    /// Probability that a child's weights are mutated.
    pub weights: f64,
    /// In that case, probability that a weight is drawn anew.
    pub replace: f64,
    /// In that case, probability that a weight is moved; with `replace` at most 1, the rest stay.
    pub perturb: f64,
    /// New weights are uniform within ± this.
    pub start: f64,
    /// Weights are moved uniformly within ± this.
    pub step: f64,
    /// Weights are clamped to ± this, at most 8.
    pub limit: f64,
    /// Probability that a matching gene disabled in either parent is disabled in the child.
    pub keep_disabled: f64,
    /// Weight of excess genes in the distance.
    pub c1: f64,
    /// Weight of disjoint genes.
    pub c2: f64,
    /// Weight of the mean weight difference of matching genes.
    pub c3: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            add_node: 0.03,
            add_link: 0.07,
            weights: 0.10,
            replace: 0.10,
            perturb: 0.90,
            start: 1.0,
            step: 0.5,
            limit: WEIGHT_MAX,
            keep_disabled: 0.75,
            c1: 1.0,
            c2: 1.0,
            c3: 0.4,
        }
    }
}

impl Settings {
    /// Checks that every draw gives a legal genotype.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        let probabilities = [
            ("add_node", self.add_node),
            ("add_link", self.add_link),
            ("weights", self.weights),
            ("replace", self.replace),
            ("perturb", self.perturb),
            ("keep_disabled", self.keep_disabled),
        ];
        let lengths = [("start", self.start), ("step", self.step), ("limit", self.limit)];
        let coefficients = [("c1", self.c1), ("c2", self.c2), ("c3", self.c3)];
        let within = |most: f64, values: &[(&str, f64)]| match values
            .iter()
            .find(|(_, value)| !(0.0..=most).contains(value))
        {
            Some((key, value)) => Err(SpecError::new(*key, format!("{value} is not within [0, {most}]"))),
            None => Ok(()),
        };
        within(1.0, &probabilities)?;
        within(WEIGHT_MAX, &lengths)?;
        within(1e6, &coefficients)?;
        if self.replace + self.perturb > 1.0 {
            return Err(SpecError::new("perturb", "replace and perturb add up to more than 1"));
        }
        if self.start > self.limit {
            return Err(SpecError::new("start", format!("{} is above limit", self.start)));
        }
        Ok(())
    }

    fn weight(&self, stream: &mut Stream) -> f64 {
        stream.between(-self.start, self.start)
    }
}

impl Layout {
    /// Ends of the links of generation 1 in order of innovation: o·(n_in + 1) + i (G-30).
    pub(super) fn start(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.outputs).flat_map(move |o| (0..=self.bias()).map(move |i| (i, self.output(o))))
    }
}

impl Genotype {
    /// A founder: every sensor and the bias linked to every output (G-30). Its innovations are those with
    /// which [`Register::new`] begins.
    pub fn random(body: BodyKind, settings: &Settings, stream: &mut Stream) -> Genotype {
        let links = Layout::of(body).start().enumerate().map(|(innovation, (from, to))| Link {
            innovation: innovation as u32,
            from,
            to,
            weight: settings.weight(stream),
            enabled: true,
            recurrent: false,
        });
        Genotype { body, hidden: Vec::new(), links: links.collect() }
    }

    /// Compatibility distance D (G-32); G is the larger number of links, whatever it is.
    pub fn distance(&self, other: &Genotype, settings: &Settings) -> f64 {
        let last = |links: &[Link]| links.last().map(|link| link.innovation);
        let shared_range = last(&self.links).min(last(&other.links));
        let (mut excess, mut disjoint, mut matching, mut difference) = (0u32, 0u32, 0u32, 0.0);
        for pair in align(&self.links, &other.links) {
            match pair {
                (Some(a), Some(b)) => {
                    matching += 1;
                    difference += (a.weight - b.weight).abs();
                }
                (Some(link), None) | (None, Some(link)) if Some(link.innovation) > shared_range => {
                    excess += 1;
                }
                _ => disjoint += 1,
            }
        }
        let genes = self.links.len().max(other.links.len()).max(1) as f64;
        let mean = if matching == 0 { 0.0 } else { difference / f64::from(matching) };
        settings.c1 * f64::from(excess) / genes
            + settings.c2 * f64::from(disjoint) / genes
            + settings.c3 * mean
    }

    /// Whether this parent gives the child's structure (G-39): the fitter does, among equals the one with
    /// fewer links, then this one; so ask the parent of the lower place.
    pub fn leads(&self, fitness: f64, other: &Genotype, other_fitness: f64) -> bool {
        match fitness.total_cmp(&other_fitness) {
            Ordering::Greater => true,
            Ordering::Less => false,
            Ordering::Equal => self.links.len() <= other.links.len(),
        }
    }

    /// The child of a parent that gives the structure and one that may change its matching genes (G-39);
    /// [`Genotype::leads`] says which is which. Both are of one body and one run.
    pub fn crossover(
        structure: &Genotype,
        other: &Genotype,
        settings: &Settings,
        stream: &mut Stream,
    ) -> Genotype {
        debug_assert_eq!(structure.body, other.body);
        let links = align(&structure.links, &other.links).filter_map(|pair| match pair {
            (Some(gene), Some(match_)) => {
                let weight = if stream.chance(0.5) { gene.weight } else { match_.weight };
                let both = gene.enabled && match_.enabled;
                Some(Link { weight, enabled: both || !stream.chance(settings.keep_disabled), ..*gene })
            }
            (gene, _) => gene.copied(),
        });
        Genotype { body: structure.body, hidden: structure.hidden.clone(), links: links.collect() }
    }

    /// Applies each mutation with its probability and names those that happened, in order: `add_node`,
    /// `add_link`, `weights` (G-40). The list may be empty.
    pub fn mutate(
        &mut self,
        settings: &Settings,
        register: &mut Register,
        stream: &mut Stream,
    ) -> Vec<&'static str> {
        let mut applied = Vec::new();
        if stream.chance(settings.add_node) && self.add_node(register, stream) {
            applied.push("add_node");
        }
        if stream.chance(settings.add_link) && self.add_link(settings, register, stream) {
            applied.push("add_link");
        }
        if stream.chance(settings.weights) && self.move_weights(settings, stream) {
            applied.push("weights");
        }
        applied
    }

    /// Splits a uniformly drawn enabled link by a new node (G-41), if there is a link to split and room.
    fn add_node(&mut self, register: &mut Register, stream: &mut Stream) -> bool {
        let enabled: Vec<usize> = (0..self.links.len()).filter(|&at| self.links[at].enabled).collect();
        let nodes = Layout::of(self.body).first_hidden() as usize + self.hidden.len();
        if enabled.is_empty() || nodes >= NODES_MAX || self.links.len() + 2 > LINKS_MAX {
            return false;
        }
        let split = enabled[stream.below(enabled.len())];
        self.split(split, register);
        true
    }

    /// Splits the link at an index; the numbers are the register's (G-31).
    pub(super) fn split(&mut self, at: usize, register: &mut Register) {
        let old = self.links[at];
        self.links[at].enabled = false;
        let numbers = (0..)
            .map(|k| register.split(old.innovation, k))
            .find(|numbers| self.hidden.binary_search(&numbers.node).is_err())
            .expect("a genotype has finitely many nodes");
        let place = self.hidden.partition_point(|&node| node < numbers.node);
        self.hidden.insert(place, numbers.node);
        self.insert(Link { innovation: numbers.into, to: numbers.node, weight: 1.0, enabled: true, ..old });
        self.insert(Link {
            innovation: numbers.out,
            from: numbers.node,
            enabled: true,
            recurrent: false,
            ..old
        });
    }

    /// Links two nodes that no gene links yet (G-42), if a few draws find such and there is room.
    fn add_link(&mut self, settings: &Settings, register: &mut Register, stream: &mut Stream) -> bool {
        if self.links.len() >= LINKS_MAX {
            return false;
        }
        let layout = Layout::of(self.body);
        let fixed = layout.first_hidden() as usize;
        let node = |index: usize| match index.checked_sub(fixed) {
            Some(hidden) => self.hidden[hidden],
            None => index as u32,
        };
        let (targets, nodes) = (layout.output(0) as usize, fixed + self.hidden.len());
        let free = (0..LINK_DRAWS)
            .map(|_| (node(stream.below(nodes)), node(stream.within(targets, nodes - 1))))
            .find(|&(from, to)| !self.links.iter().any(|link| (link.from, link.to) == (from, to)));
        let Some((from, to)) = free else { return false };
        let recurrent = self.closes_cycle(from, to);
        let innovation = register.link(from, to, recurrent);
        let weight = settings.weight(stream);
        self.insert(Link { innovation, from, to, weight, enabled: true, recurrent });
        true
    }

    /// Whether a link would have to be recurrent: its source is its target or can be reached from it over
    /// links that are not recurrent, disabled ones included (G-42).
    pub(super) fn closes_cycle(&self, from: u32, to: u32) -> bool {
        let mut reached = vec![to];
        let mut next = 0;
        while let Some(&node) = reached.get(next) {
            if node == from {
                return true;
            }
            for link in self.links.iter().filter(|link| !link.recurrent && link.from == node) {
                if !reached.contains(&link.to) {
                    reached.push(link.to);
                }
            }
            next += 1;
        }
        false
    }

    /// Draws each weight anew or moves it (G-40), if there is any.
    fn move_weights(&mut self, settings: &Settings, stream: &mut Stream) -> bool {
        for link in &mut self.links {
            let draw = stream.unit();
            if draw < settings.replace {
                link.weight = settings.weight(stream);
            } else if draw < settings.replace + settings.perturb {
                let moved = link.weight + stream.between(-settings.step, settings.step);
                link.weight = moved.clamp(-settings.limit, settings.limit);
            }
        }
        !self.links.is_empty()
    }

    fn insert(&mut self, link: Link) {
        let place = self.links.partition_point(|other| other.innovation < link.innovation);
        self.links.insert(place, link);
    }
}

/// Two lists of links side by side, matched by innovation, in ascending order.
fn align<'a>(a: &'a [Link], b: &'a [Link]) -> impl Iterator<Item = (Option<&'a Link>, Option<&'a Link>)> {
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    std::iter::from_fn(move || match (a.peek(), b.peek()) {
        (None, None) => None,
        (Some(_), None) => Some((a.next(), None)),
        (None, Some(_)) => Some((None, b.next())),
        (Some(left), Some(right)) => Some(match left.innovation.cmp(&right.innovation) {
            Ordering::Less => (a.next(), None),
            Ordering::Greater => (None, b.next()),
            Ordering::Equal => (a.next(), b.next()),
        }),
    })
}

#[cfg(test)]
mod tests;

//! The genotype of NEAT: hidden nodes and links by innovation (G-29). It refuses whatever is not legal for
//! its body (X-4..X-7), and never varies itself.

use crate::walker::{
    body::BodyKind,
    genotype::{VERSION, expect_header},
};
use crate::{DecodeError, encoding};
use serde::{Deserialize, Deserializer, Serialize, de};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::marker::PhantomData;

/// The word for this controller in a payload.
pub const CONTROLLER: &str = "neat";
/// The most links of a genotype.
pub const LINKS_MAX: usize = 10_000;
/// The most nodes of a genotype, sensors and outputs included.
pub const NODES_MAX: usize = 2_000;
/// The largest magnitude of a weight (X-7, G-40).
pub const WEIGHT_MAX: f64 = 8.0;

/// One link gene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Its historical mark, one number for the same structure anywhere in a run.
    pub innovation: u32,
    /// Source node.
    pub from: u32,
    /// Target node: an output or hidden one.
    pub to: u32,
    /// Within ±[`WEIGHT_MAX`].
    pub weight: f64,
    /// Disabled links keep their place and carry nothing.
    pub enabled: bool,
    /// Whether it brings the source's value of the previous step.
    pub recurrent: bool,
}

/// A network's plan. Nodes are numbered: sensors 0.., bias, outputs, then hidden ones (see `Layout`).
#[derive(Debug, Clone, PartialEq)]
pub struct Genotype {
    /// The body whose sensors and motors it is wired to.
    pub body: BodyKind,
    /// Hidden nodes, ascending; numbered per run.
    pub hidden: Vec<u32>,
    /// Ascending by innovation; none is ever deleted.
    pub links: Vec<Link>,
}

/// How a body's fixed nodes are numbered (G-29).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) sensors: u32,
    pub(super) outputs: u32,
}

impl Layout {
    pub(super) fn of(body: BodyKind) -> Layout {
        Layout { sensors: body.inputs() as u32, outputs: body.degrees() as u32 }
    }

    /// The node whose value is always 1.
    pub(super) fn bias(self) -> u32 {
        self.sensors
    }

    pub(super) fn output(self, index: u32) -> u32 {
        self.sensors + 1 + index
    }

    /// The lowest number of a hidden node; all below are fixed.
    pub(super) fn first_hidden(self) -> u32 {
        self.output(self.outputs)
    }
}

#[derive(Serialize)]
struct Written<'a> {
    version: u32,
    body: BodyKind,
    controller: &'static str,
    hidden: &'a [u32],
    links: &'a [Link],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Read {
    #[serde(rename = "version")]
    _version: u32,
    #[serde(rename = "body")]
    _body: String,
    #[serde(rename = "controller")]
    _controller: String,
    #[serde(deserialize_with = "at_most::<NODES_MAX, _, _>")]
    hidden: Vec<u32>,
    #[serde(deserialize_with = "at_most::<LINKS_MAX, _, _>")]
    links: Vec<Link>,
}

/// Reads a list and stops at the first item too many, before it is kept.
fn at_most<'de, const MAX: usize, T, D>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    struct Items<T, const MAX: usize>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>, const MAX: usize> de::Visitor<'de> for Items<T, MAX> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a list of at most {MAX}")
        }

        fn visit_seq<A: de::SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
            let announced = list.size_hint().unwrap_or(0);
            let mut items = Vec::with_capacity(announced.min(MAX));
            if announced > MAX {
                return Err(de::Error::invalid_length(announced, &self));
            }
            while let Some(item) = list.next_element()? {
                if items.len() == MAX {
                    return Err(de::Error::invalid_length(MAX + 1, &self));
                }
                items.push(item);
            }
            Ok(items)
        }
    }

    deserializer.deserialize_seq(Items::<T, MAX>(PhantomData))
}

impl Genotype {
    /// The canonical bytes (G-73).
    pub fn encode(&self) -> Vec<u8> {
        encoding::encode(&Written {
            version: VERSION,
            body: self.body,
            controller: CONTROLLER,
            hidden: &self.hidden,
            links: &self.links,
        })
    }

    /// Reads a genotype and checks that it is legal.
    ///
    /// # Errors
    /// X-4..X-7: the field or gene that is wrong and what is allowed.
    pub fn decode(bytes: &[u8]) -> Result<Genotype, DecodeError> {
        let body = expect_header(bytes, CONTROLLER)?;
        let Read { hidden, links, .. } = encoding::decode(bytes)?;
        let genotype = Genotype { body, hidden, links };
        genotype.check()?;
        Ok(genotype)
    }

    fn check(&self) -> Result<(), DecodeError> {
        let layout = Layout::of(self.body);
        let first_hidden = layout.first_hidden();
        let nodes = first_hidden as usize + self.hidden.len();
        if nodes > NODES_MAX {
            return Err(DecodeError::illegal(
                "hidden",
                format!("{nodes} nodes where {NODES_MAX} are allowed"),
            ));
        }
        for (index, &node) in self.hidden.iter().enumerate() {
            if node < first_hidden || index > 0 && node <= self.hidden[index - 1] {
                let problem = format!("node {node} where hidden nodes ascend from {first_hidden}");
                return Err(DecodeError::illegal(format!("hidden[{index}]"), problem));
            }
        }
        let mut ends = BTreeSet::new();
        let mut last = None;
        for (index, link) in self.links.iter().enumerate() {
            let refuse = |field: &str, problem: String| {
                let gene = link.innovation;
                let problem = format!("{problem} (innovation {gene})");
                Err(DecodeError::illegal(format!("links[{index}].{field}"), problem))
            };
            if last.is_some_and(|last| link.innovation <= last) {
                return refuse("innovation", "links do not ascend by innovation, each once".to_owned());
            }
            last = Some(link.innovation);
            for (field, node) in [("from", link.from), ("to", link.to)] {
                if node >= first_hidden && self.hidden.binary_search(&node).is_err() {
                    return refuse(field, format!("there is no node {node}"));
                }
            }
            if link.to <= layout.bias() {
                return refuse("to", format!("node {} is a sensor or the bias and takes no link", link.to));
            }
            if !ends.insert((link.from, link.to)) {
                return refuse("to", format!("a second link from {} to {}", link.from, link.to));
            }
            if !(-WEIGHT_MAX..=WEIGHT_MAX).contains(&link.weight) {
                return refuse("weight", format!("{} is not within [-8, 8]", link.weight));
            }
        }
        self.order().map(drop).map_err(|node| {
            let problem = format!("links that are not recurrent form a cycle through node {node}");
            DecodeError::illegal("links", problem)
        })
    }

    /// Output and hidden nodes in topological order of the links that are not recurrent, disabled ones
    /// included; among the free the lowest comes first (G-46).
    ///
    /// # Errors
    /// The lowest node on or behind a cycle.
    pub(super) fn order(&self) -> Result<Vec<u32>, u32> {
        let layout = Layout::of(self.body);
        let computed = || (layout.output(0)..layout.first_hidden()).chain(self.hidden.iter().copied());
        let mut waiting: BTreeMap<u32, usize> = computed().map(|node| (node, 0)).collect();
        let mut targets: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for link in self.links.iter().filter(|link| !link.recurrent && link.from > layout.bias()) {
            *waiting.get_mut(&link.to).expect("links end at outputs or hidden nodes") += 1;
            targets.entry(link.from).or_default().push(link.to);
        }
        let mut free: BTreeSet<u32> = computed().filter(|node| waiting[node] == 0).collect();
        let mut order = Vec::with_capacity(waiting.len());
        while let Some(node) = free.pop_first() {
            waiting.remove(&node);
            order.push(node);
            for target in targets.get(&node).into_iter().flatten() {
                let count = waiting.get_mut(target).expect("a node waits until all its sources are placed");
                *count -= 1;
                if *count == 0 {
                    free.insert(*target);
                }
            }
        }
        waiting.first_key_value().map_or(Ok(order), |(&node, _)| Err(node))
    }

    /// The number of links that bring the previous step's value.
    pub fn recurrent(&self) -> usize {
        self.links.iter().filter(|link| link.recurrent).count()
    }

    /// What people ask about (G-75); the species is the search's to add.
    pub fn traits(&self) -> serde_json::Value {
        serde_json::json!({
            "hidden": self.hidden.len(),
            "links": self.links.len(),
            "recurrent": self.recurrent(),
        })
    }
}

#[cfg(test)]
mod tests;

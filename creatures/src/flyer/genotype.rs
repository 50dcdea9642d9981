//! A flyer's genotype: an ordered list of nodes, each a cylinder with the neurons and effectors that belong
//! to it (F-6..F-10). It refuses whatever is not legal, and never varies itself.

use super::Function;
use crate::{DecodeError, encoding};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

/// The payload version that this program writes and reads.
pub const VERSION: u32 = 1;

/// The node of the central body.
pub const BODY: usize = 0;
/// The node of the wing-root, inside the body; both wings leave it.
pub const WING_ROOT: usize = 1;
/// The first of the wing segments, which stand for a left and a right one each.
pub const FIRST_SEGMENT: usize = 2;
/// Legal numbers of nodes: body, wing-root and 1 to 8 wing segments (F-6).
pub const NODES: RangeInclusive<usize> = 3..=10;

/// Legal lengths of a cylinder, caps not counted, m (F-7).
pub const LENGTH: RangeInclusive<f64> = 20.0..=80.0;
/// Legal radii of the body, m (F-7).
pub const BODY_RADIUS: RangeInclusive<f64> = 1.0..=5.0;
/// The radius of wing-root and wing segments, m (F-7).
pub const WING_RADIUS: f64 = 0.5;
/// Legal neutral azimuths of a wing segment about its parent, rad (F-7).
pub const THETA: RangeInclusive<f64> = -FRAC_PI_2..=FRAC_PI_2;
/// Legal angles between a wing segment and its parent, rad (F-7).
pub const PSI: RangeInclusive<f64> = 0.0..=FRAC_PI_2;

/// The most neurons of a node (F-7).
pub const NEURONS_MAX: usize = 4;
/// The most inputs of a neuron or an effector (F-9).
pub const INPUTS_MAX: usize = 3;
/// Legal delays of a neuron, brain steps (F-9).
pub const DELAY: RangeInclusive<u8> = 1..=40;

/// Body, wing-root, then wing segments from the root to the tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Genotype {
    /// As many as [`NODES`] allows; node k hangs from node k − 1.
    pub nodes: Vec<Node>,
}

/// One cylinder, how it hangs from the node before, and its part of the brain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// Length of the cylinder, m. That of the wing-root is cut to the body's when it is built
    /// ([`Genotype::wing_root_length`]).
    pub length: f64,
    /// Radius of the cylinder and its caps, m.
    pub radius: f64,
    /// 0 if a wing segment leaves its parent's start, 1 if it leaves the end; 0 for the first two nodes.
    pub lpercent: u8,
    /// θ: the neutral azimuth of a wing segment about its parent, rad; 0 for the first two nodes.
    pub theta: f64,
    /// Ψ: the fixed angle between a wing segment and its parent, rad; 0 for the first two nodes.
    pub psi: f64,
    /// At most [`NEURONS_MAX`].
    pub neurons: Vec<Neuron>,
    /// As many as [`effectors`] says.
    pub effectors: Vec<Effector>,
}

/// One neuron. It has neither weights nor a bias.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Neuron {
    /// What it makes of its inputs.
    #[serde(rename = "func")]
    pub function: Function,
    /// How long [`Function::Mem`] remembers, brain steps; without meaning for the others.
    pub delay: u8,
    /// At most [`INPUTS_MAX`], in the order a, b, c.
    pub inputs: Vec<Source>,
}

/// One effector: what a joint motor is told is the mean of its inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Effector {
    /// At most [`INPUTS_MAX`].
    pub inputs: Vec<Source>,
}

/// Where an input comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The node that has the sensor or neuron.
    pub node: u8,
    /// Which of the two it is.
    pub kind: Kind,
    /// Which of the node's sensors or neurons.
    pub index: u8,
    /// Whether a link between wing segments goes to the other wing; without meaning for other links.
    pub cross: bool,
}

/// What an input may come from: effectors feed nothing (F-10).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A reading of the creature's state.
    Sensor,
    /// A neuron's last output.
    Neuron,
}

/// The number of sensors of a node (F-25): none for the body; three joint angles, three joint stops, roll
/// and pitch for the wing-root; joint angle and joint stop for a wing segment.
pub fn sensors(node: usize) -> usize {
    match node {
        BODY => 0,
        WING_ROOT => 8,
        _ => 2,
    }
}

/// The number of effectors of a node (F-7): one a degree of freedom of the joint to its parent.
pub fn effectors(node: usize) -> usize {
    match node {
        BODY => 0,
        WING_ROOT => 3,
        _ => 1,
    }
}

#[derive(Serialize)]
struct Written<'a> {
    version: u32,
    nodes: &'a [Node],
}

/// What stands in front; the rest is skipped.
#[derive(Deserialize)]
struct Header {
    version: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Read {
    #[serde(rename = "version")]
    _version: u32,
    nodes: Vec<Node>,
}

impl Genotype {
    /// The canonical bytes: version, then the nodes with their fields as F-7 and F-9 name them.
    pub fn encode(&self) -> Vec<u8> {
        encoding::encode(&Written { version: VERSION, nodes: &self.nodes })
    }

    /// Reads a genotype and checks that it is legal; nothing is clamped.
    ///
    /// # Errors
    /// X-1..X-5: the node and field that is wrong and what is allowed.
    pub fn decode(bytes: &[u8]) -> Result<Genotype, DecodeError> {
        let Header { version } = encoding::decode(bytes)?;
        if version != VERSION {
            return Err(DecodeError::version(version, VERSION));
        }
        let Read { nodes, .. } = encoding::decode(bytes)?;
        let genotype = Genotype { nodes };
        genotype.check()?;
        Ok(genotype)
    }

    /// The number of wing segments, each of which is built twice.
    pub fn segments(&self) -> usize {
        self.nodes.len() - FIRST_SEGMENT
    }

    /// Length of the wing-root as built, m: it has to fit inside the body (F-7).
    pub fn wing_root_length(&self) -> f64 {
        self.nodes[WING_ROOT].length.min(self.nodes[BODY].length)
    }

    fn check(&self) -> Result<(), DecodeError> {
        let found = self.nodes.len();
        if !NODES.contains(&found) {
            let problem =
                format!("{found} nodes where a body, a wing-root and 1 to 8 wing segments are legal");
            return Err(DecodeError::illegal("nodes", problem));
        }
        for (index, node) in self.nodes.iter().enumerate() {
            node.check(index).and_then(|()| node.check_brain(index, &self.nodes)).map_err(
                |(field, problem)| DecodeError::illegal(format!("nodes[{index}].{field}"), problem),
            )?;
        }
        Ok(())
    }
}

/// A field of a node and what is wrong with it.
type Fault = (String, String);

impl Node {
    /// Every input of the node: those of its neurons, then those of its effectors.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        let neurons = self.neurons.iter().flat_map(|neuron| &neuron.inputs);
        neurons.chain(self.effectors.iter().flat_map(|effector| &effector.inputs))
    }

    /// The genes of the body plan.
    fn check(&self, index: usize) -> Result<(), Fault> {
        within("length", self.length, LENGTH)?;
        match index {
            BODY => within("radius", self.radius, BODY_RADIUS)?,
            _ => within("radius", self.radius, WING_RADIUS..=WING_RADIUS)?,
        }
        let (lpercent_max, theta, psi) = match index {
            BODY | WING_ROOT => (0, 0.0..=0.0, 0.0..=0.0),
            _ => (1, THETA, PSI),
        };
        if self.lpercent > lpercent_max {
            return Err(fault("lpercent", format!("{} is above {lpercent_max}", self.lpercent)));
        }
        within("theta", self.theta, theta)?;
        within("psi", self.psi, psi)
    }

    /// The neurons and effectors (X-2..X-4); sources are looked up in all nodes.
    fn check_brain(&self, index: usize, nodes: &[Node]) -> Result<(), Fault> {
        let found = self.neurons.len();
        if found > NEURONS_MAX {
            return Err(fault("neurons", format!("{found} neurons where {NEURONS_MAX} are the most")));
        }
        let (found, expected) = (self.effectors.len(), effectors(index));
        if found != expected {
            return Err(fault("effectors", format!("{found} effectors where this node has {expected}")));
        }
        for (place, neuron) in self.neurons.iter().enumerate() {
            if !DELAY.contains(&neuron.delay) {
                let problem = format!("{} is not within 1 to 40", neuron.delay);
                return Err(fault(&format!("neurons[{place}].delay"), problem));
            }
            check_inputs(&format!("neurons[{place}].inputs"), &neuron.inputs, nodes)?;
        }
        for (place, effector) in self.effectors.iter().enumerate() {
            check_inputs(&format!("effectors[{place}].inputs"), &effector.inputs, nodes)?;
        }
        Ok(())
    }
}

fn check_inputs(field: &str, inputs: &[Source], nodes: &[Node]) -> Result<(), Fault> {
    let found = inputs.len();
    if found > INPUTS_MAX {
        return Err(fault(field, format!("{found} inputs where {INPUTS_MAX} are the most")));
    }
    for (place, source) in inputs.iter().enumerate() {
        let node = usize::from(source.node);
        let Some(owner) = nodes.get(node) else {
            let problem = format!("there is no node {node}, the last is {}", nodes.len() - 1);
            return Err(fault(&format!("{field}[{place}].node"), problem));
        };
        let (count, what) = match source.kind {
            Kind::Sensor => (sensors(node), "sensors"),
            Kind::Neuron => (owner.neurons.len(), "neurons"),
        };
        if usize::from(source.index) >= count {
            let problem = format!("node {node} has {count} {what}, and none of index {}", source.index);
            return Err(fault(&format!("{field}[{place}].index"), problem));
        }
    }
    Ok(())
}

fn within(field: &str, value: f64, range: RangeInclusive<f64>) -> Result<(), Fault> {
    if range.contains(&value) {
        return Ok(());
    }
    let (least, most) = range.into_inner();
    let allowed = if least == most { format!("{least}") } else { format!("within {least} to {most}") };
    Err(fault(field, format!("{value} is not {allowed}")))
}

fn fault(field: &str, problem: String) -> Fault {
    (field.to_owned(), problem)
}

#[cfg(test)]
mod tests;

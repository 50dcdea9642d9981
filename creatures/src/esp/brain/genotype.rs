//! A brain's genotype: one block of control a skill, in the order of learning (E-33..E-36, E-45). Whatever
//! stands in a block has its owner and its lock. It refuses whatever is not legal, and mends nothing but what
//! E-36 says.

use super::node::NodeKind;
use crate::DecodeError;
use crate::esp::key::InstanceKey;
use crate::esp::syllabus::{Sensor, SkillId, Syllabus};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The most nodes of a skill's control (E-17).
pub const NODES_MAX: usize = 40;
/// The most wires of a skill's control, outputs included (E-17).
pub const WIRES_MAX: usize = 120;

/// The control of every skill that was learned or is being learned.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Brain {
    /// In the order of learning, so that a later skill never comes before what an earlier one adds up.
    pub controls: Vec<Control>,
}

/// The nodes and wires that belong to one skill.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Control {
    /// Their owner.
    pub skill: SkillId,
    /// Whether they are closed to variation, and behind gates.
    pub seal: Seal,
    /// In ascending id, which is their index.
    pub nodes: Vec<Node>,
    /// What they drive.
    pub outputs: Vec<Output>,
}

/// How far a skill is learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Seal {
    /// Under evolution, and without gates.
    Open,
    /// Encapsulated: behind gates, and closed to every operator.
    Locked,
    /// Encapsulated and open once more, for reconciliation (E-67).
    Reopened,
}

/// One node with its input wires.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    /// What it makes of its inputs.
    pub kind: NodeKind,
    /// In the order of its slots; an empty slot reads 0. At most [`NodeKind::slots`].
    pub inputs: Vec<Option<Source>>,
}

/// Where an input wire comes from: nodes of the same skill and every source node (E-35).
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// A node of the same skill, by its id.
    Node(u16),
    /// The length of a muscle (E-27).
    Length(InstanceKey),
    /// A photoreceptor's signal (E-29).
    Photo(InstanceKey),
    /// A sense that the skill declares (E-32).
    Sensor(Sensor),
}

/// A wire that leaves a skill.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// The node that drives.
    pub node: u16,
    /// What is driven.
    pub target: Target,
}

/// What a skill may drive (E-35).
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// The activation of a muscle.
    Muscle(InstanceKey),
    /// The sigma of a skill that the driving one uses.
    Skill(SkillId),
}

/// The muscle and receptor instances that a body expresses, each in the body's order: what wires can end at.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Instances {
    /// Muscles.
    pub muscles: Vec<InstanceKey>,
    /// Photoreceptors.
    pub photos: Vec<InstanceKey>,
}

impl Instances {
    /// Whether an input from here reads something.
    pub fn has_source(&self, source: &Source) -> bool {
        match source {
            Source::Length(key) => self.muscles.contains(key),
            Source::Photo(key) => self.photos.contains(key),
            Source::Node(_) | Source::Sensor(_) => true,
        }
    }

    /// Whether an output to there drives something.
    pub fn has_target(&self, target: &Target) -> bool {
        match target {
            Target::Muscle(key) => self.muscles.contains(key),
            Target::Skill(_) => true,
        }
    }
}

impl Brain {
    /// The control of a skill, if there is one.
    pub fn control(&self, skill: SkillId) -> Option<&Control> {
        self.controls.iter().find(|control| control.skill == skill)
    }

    /// The control that is not locked, if there is one.
    pub fn open(&self) -> Option<&Control> {
        self.controls.iter().find(|control| control.seal != Seal::Locked)
    }

    /// The control of a skill, if there is one, to change it.
    pub fn control_mut(&mut self, skill: SkillId) -> Option<&mut Control> {
        self.controls.iter_mut().find(|control| control.skill == skill)
    }

    /// Checks that the brain is legal for a syllabus (EF-8, E-17, E-34, E-35). Keys of muscles and receptors
    /// are not looked up: a body may have lost them (E-36).
    ///
    /// # Errors
    /// The field that is wrong, below `controls`, and what is allowed.
    pub fn check(&self, syllabus: &Syllabus) -> Result<(), DecodeError> {
        let mut seen = BTreeSet::new();
        for (index, control) in self.controls.iter().enumerate() {
            let illegal =
                |(field, problem): Fault| DecodeError::illegal(format!("controls[{index}].{field}"), problem);
            if !seen.insert(control.skill) {
                let problem = format!("skill {} has a control already", control.skill.0);
                return Err(illegal(("skill".to_owned(), problem)));
            }
            control.check(syllabus).map_err(illegal)?;
            self.check_uses(control).map_err(illegal)?;
        }
        let open = self.controls.iter().filter(|control| control.seal != Seal::Locked).count();
        if open > 1 {
            let problem = format!("{open} skills are open where one at a time may be");
            return Err(DecodeError::illegal("controls", problem));
        }
        Ok(())
    }

    /// A driven skill has to have a sigma.
    fn check_uses(&self, control: &Control) -> Result<(), Fault> {
        for (index, output) in control.outputs.iter().enumerate() {
            let Target::Skill(used) = output.target else { continue };
            if !self.control(used).is_some_and(Control::is_encapsulated) {
                let problem = format!("skill {} is not encapsulated", used.0);
                return Err((format!("outputs[{index}].target"), problem));
            }
        }
        Ok(())
    }

    /// Removes the wires of open controls to instances that the body does not express, and counts those of
    /// locked ones, which stay and are inert (E-36, EF-9).
    pub fn prune(&mut self, body: &Instances) -> usize {
        for control in self.controls.iter_mut().filter(|control| control.seal != Seal::Locked) {
            for node in &mut control.nodes {
                for slot in &mut node.inputs {
                    *slot = slot.take().filter(|source| body.has_source(source));
                }
                node.trim();
            }
            control.outputs.retain(|output| body.has_target(&output.target));
        }
        self.inert(body)
    }

    /// How many wires end at instances that the body does not express.
    pub fn inert(&self, body: &Instances) -> usize {
        let inert = |control: &Control| {
            let inputs = control.sources().filter(|source| !body.has_source(source)).count();
            inputs + control.outputs.iter().filter(|output| !body.has_target(&output.target)).count()
        };
        self.controls.iter().map(inert).sum()
    }
}

/// A field of a control and what is wrong with it.
type Fault = (String, String);

impl Control {
    /// Nothing yet, open.
    pub fn new(skill: SkillId) -> Control {
        Control { skill, seal: Seal::Open, nodes: Vec::new(), outputs: Vec::new() }
    }

    /// Every input that is there.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        self.nodes.iter().flat_map(Node::sources)
    }

    /// Every key of a muscle or receptor at which a wire ends, to rename it.
    pub fn keys_mut(&mut self) -> impl Iterator<Item = &mut InstanceKey> {
        let sources = self.nodes.iter_mut().flat_map(|node| node.inputs.iter_mut().flatten());
        let read = sources.filter_map(|source| match source {
            Source::Length(key) | Source::Photo(key) => Some(key),
            Source::Node(_) | Source::Sensor(_) => None,
        });
        let driven = self.outputs.iter_mut().filter_map(|output| match &mut output.target {
            Target::Muscle(key) => Some(key),
            Target::Skill(_) => None,
        });
        read.chain(driven)
    }

    /// Whether the skill has a sigma, and gates.
    pub fn is_encapsulated(&self) -> bool {
        self.seal != Seal::Open
    }

    /// Input wires and outputs together.
    pub fn wires(&self) -> usize {
        self.sources().count() + self.outputs.len()
    }

    fn check(&self, syllabus: &Syllabus) -> Result<(), Fault> {
        let Some(skill) = syllabus.skill(self.skill) else {
            let problem = format!("{} where there are {} skills", self.skill.0, syllabus.skills().len());
            return Err(fault("skill", problem));
        };
        if self.nodes.len() > NODES_MAX {
            let problem = format!("{} nodes where {NODES_MAX} are the most", self.nodes.len());
            return Err(fault("nodes", problem));
        }
        if self.wires() > WIRES_MAX {
            let problem = format!("{} wires in all where {WIRES_MAX} are the most", self.wires());
            return Err(fault("outputs", problem));
        }
        for (index, node) in self.nodes.iter().enumerate() {
            node.check(self.nodes.len(), skill.sensors())
                .map_err(|(field, problem)| (format!("nodes[{index}].{field}"), problem))?;
        }
        let mut driven = BTreeSet::new();
        for (index, output) in self.outputs.iter().enumerate() {
            let refuse = |field: &str, problem| Err((format!("outputs[{index}].{field}"), problem));
            if usize::from(output.node) >= self.nodes.len() {
                return refuse("node", missing(output.node, self.nodes.len()));
            }
            match &output.target {
                Target::Muscle(_) if !skill.drives_body() => {
                    return refuse("target", "a skill that uses others drives no muscle".to_owned());
                }
                Target::Muscle(_) if !driven.insert(&output.target) => {
                    return refuse("target", "the skill drives this muscle already".to_owned());
                }
                Target::Skill(used) if !skill.uses().contains(used) => {
                    return refuse("target", format!("the skill does not use skill {}", used.0));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

impl Node {
    /// The inputs that are there.
    pub fn sources(&self) -> impl Iterator<Item = &Source> {
        self.inputs.iter().flatten()
    }

    /// Drops empty slots at the end, and all of them where slots do not count.
    pub fn trim(&mut self) {
        if self.kind.is_variadic() {
            self.inputs.retain(Option::is_some);
        }
        while self.inputs.last().is_some_and(Option::is_none) {
            self.inputs.pop();
        }
    }

    fn check(&self, nodes: usize, sensors: &[Sensor]) -> Result<(), Fault> {
        let mut out = None;
        self.kind.map_parameters(|name, value, range| {
            if !range.contains(&value) {
                let problem = format!("{value} is not within {} to {}", range.start(), range.end());
                out.get_or_insert((format!("kind.{name}"), problem));
            }
            value
        });
        if let Some(fault) = out {
            return Err(fault);
        }
        let (found, most) = (self.inputs.len(), self.kind.slots());
        if found > most {
            return Err(fault("inputs", format!("{found} inputs where this type has {most} at most")));
        }
        for (slot, source) in self.inputs.iter().enumerate() {
            match source {
                Some(Source::Node(node)) if usize::from(*node) >= nodes => {
                    return Err((format!("inputs[{slot}]"), missing(*node, nodes)));
                }
                Some(Source::Sensor(sensor)) if !sensors.contains(sensor) => {
                    let problem = format!("the skill does not declare the sensor {}", sensor.name());
                    return Err((format!("inputs[{slot}]"), problem));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

fn missing(node: u16, nodes: usize) -> String {
    format!("there is no node {node} among the skill's {nodes}")
}

fn fault(field: &str, problem: String) -> Fault {
    (field.to_owned(), problem)
}

#[cfg(test)]
mod tests;

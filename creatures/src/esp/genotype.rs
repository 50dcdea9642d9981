//! A creature's genotype: its body's graph and its brain. It refuses whatever is not legal, and never varies itself.

use super::body::genotype::{Edge, Segment};
use super::body::{Body, Phenotype};
use super::brain::{Brain, Control};
use super::syllabus::{SkillId, Syllabus};
use crate::{DecodeError, encoding};
use serde::{Deserialize, Serialize};

/// The payload version that this program writes and reads.
pub const VERSION: u32 = 1;

/// All that is inherited.
#[derive(Debug, Clone, PartialEq)]
pub struct Genotype {
    /// Parts, joints, muscles and receptors.
    pub body: Body,
    /// The control of every skill that was learned or is being learned.
    pub brain: Brain,
}

#[derive(Serialize)]
struct Written<'a> {
    version: u32,
    body: &'a Body,
    brain: &'a Brain,
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
    body: Body,
    brain: Brain,
}

impl Genotype {
    /// The canonical bytes: version, body, brain.
    pub fn encode(&self) -> Vec<u8> {
        encoding::encode(&Written { version: VERSION, body: &self.body, brain: &self.brain })
    }

    /// Reads a genotype and checks its graph. What depends on a syllabus is for [`Genotype::check`].
    ///
    /// # Errors
    /// EF-8: the field that is wrong and what is allowed.
    pub fn decode(bytes: &[u8]) -> Result<Genotype, DecodeError> {
        let Header { version } = encoding::decode(bytes)?;
        if version != VERSION {
            return Err(DecodeError::version(version, VERSION));
        }
        let Read { body, brain, .. } = encoding::decode(bytes)?;
        body.check().map_err(|error| within("body", error))?;
        Ok(Genotype { body, brain })
    }

    /// Checks that the creature is legal for a syllabus, and gives the body that it has.
    ///
    /// # Errors
    /// EF-7, EF-8: the field that is wrong and what is allowed; `body` where only the expressed one shows it.
    pub fn check(&self, syllabus: &Syllabus) -> Result<Phenotype, DecodeError> {
        let skills = syllabus.skills().len();
        if let Some((field, owner)) = self.body.owners().find(|(_, owner)| owner.index() >= skills) {
            let problem = format!("{} where there are {skills} skills", owner.0);
            return Err(DecodeError::illegal(format!("body.{field}"), problem));
        }
        self.brain.check(syllabus).map_err(|error| within("brain", error))?;
        self.body.develop().map_err(|illegal| DecodeError::illegal("body", illegal.to_string()))
    }

    /// Encapsulates a skill, and locks the muscles and receptors that were grown for it (E-46).
    pub fn encapsulate(&mut self, skill: SkillId) {
        self.brain.encapsulate(skill);
        self.body.lock(skill);
    }

    /// What people ask about: a flat JSON object of `parts`, `joints` (those that move), `muscles`, `receptors`
    /// and `mass` (kg) of the expressed body, `nodes` and `wires` of all controls, and `skeleton`, which two
    /// creatures share if they differ in muscles, receptors and brain alone. An illegal body has no parts.
    pub fn traits(&self) -> serde_json::Value {
        let body = self.body.develop().unwrap_or_default();
        let joints = body.parts.iter().filter_map(|part| part.joint);
        let controls = &self.brain.controls;
        serde_json::json!({
            "parts": body.parts.len(),
            "joints": joints.filter(|joint| joint.kind.freedoms() > 0).count(),
            "muscles": body.muscles.len(),
            "receptors": body.receptors.len(),
            "mass": body.mass(),
            "nodes": controls.iter().map(|control| control.nodes.len()).sum::<usize>(),
            "wires": controls.iter().map(Control::wires).sum::<usize>(),
            "skeleton": self.body.skeleton(),
        })
    }
}

impl Body {
    /// Locks the muscles and receptors that were grown for a skill (E-46).
    pub fn lock(&mut self, skill: SkillId) {
        let receptors = self.segments.iter_mut().flat_map(|gene| &mut gene.receptors);
        receptors.filter(|gene| gene.owner == skill).for_each(|gene| gene.locked = true);
        let muscles = self.edges.iter_mut().flat_map(|gene| &mut gene.muscles);
        muscles.filter(|gene| gene.owner == skill).for_each(|gene| gene.locked = true);
    }

    /// A fingerprint of segments and joints, without what is grown on them: 16 hexadecimal digits.
    pub fn skeleton(&self) -> String {
        let bare = Body {
            next_id: 0,
            root: self.root,
            segments: self.segments.iter().map(Segment::bare).collect(),
            edges: self.edges.iter().map(Edge::bare).collect(),
        };
        blake3::hash(&encoding::encode(&bare)).to_hex()[..16].to_owned()
    }

    fn owners(&self) -> impl Iterator<Item = (String, SkillId)> + '_ {
        let receptors = self.segments.iter().enumerate().flat_map(|(index, gene)| {
            let place = move |at| format!("segments[{index}].receptors[{at}].owner");
            gene.receptors.iter().enumerate().map(move |(at, gene)| (place(at), gene.owner))
        });
        let muscles = self.edges.iter().enumerate().flat_map(|(index, gene)| {
            let place = move |at| format!("edges[{index}].muscles[{at}].owner");
            gene.muscles.iter().enumerate().map(move |(at, gene)| (place(at), gene.owner))
        });
        receptors.chain(muscles)
    }
}

/// An error in a part of the genotype, with the part's name in front.
fn within(part: &str, error: DecodeError) -> DecodeError {
    match error {
        DecodeError::Illegal { field, problem } => DecodeError::illegal(format!("{part}.{field}"), problem),
        error => error,
    }
}

#[cfg(test)]
mod tests;

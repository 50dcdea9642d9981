//! The genotype of a gene regulatory network: a list of proteins and two scaling factors (G-5, G-22). It
//! refuses whatever is not legal for its body, and never varies itself.

use crate::walker::{
    body::BodyKind,
    genotype::{VERSION, expect_header},
};
use crate::{DecodeError, encoding};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// The word for this controller in a payload.
pub const CONTROLLER: &str = "grn";
/// The largest tag, P: tags are 0..=32 (G-5).
pub const TAG_MAX: u8 = 32;
/// Legal numbers of regulatory proteins (G-22).
pub const REGULATORY: RangeInclusive<usize> = 4..=20;
/// Legal values of β and δ (G-22).
pub const SCALING: RangeInclusive<f64> = 0.5..=2.0;

/// One protein: three tags, each 0..=[`TAG_MAX`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Protein {
    /// What it is known by to those that it regulates.
    pub id: u8,
    /// The id that enhances it most.
    pub enh: u8,
    /// The id that inhibits it most.
    pub inh: u8,
}

/// Two chromosomes (G-22): the proteins and the scaling factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Genotype {
    /// The body whose sensors and motors it is wired to.
    pub body: BodyKind,
    /// β: how much a better match of tags counts.
    pub beta: f64,
    /// δ: how far one step goes.
    pub delta: f64,
    /// Inputs, then outputs, each wired for good to the sensor or motor of its position, then regulatory
    /// ones.
    pub proteins: Vec<Protein>,
}

#[derive(Serialize)]
struct Written<'a> {
    version: u32,
    body: BodyKind,
    controller: &'static str,
    beta: f64,
    delta: f64,
    proteins: &'a [Protein],
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
    beta: f64,
    delta: f64,
    proteins: Vec<Protein>,
}

impl Genotype {
    /// The canonical bytes (G-73).
    pub fn encode(&self) -> Vec<u8> {
        encoding::encode(&Written {
            version: VERSION,
            body: self.body,
            controller: CONTROLLER,
            beta: self.beta,
            delta: self.delta,
            proteins: &self.proteins,
        })
    }

    /// Reads a genotype and checks that it is legal.
    ///
    /// # Errors
    /// X-1..X-4: the field that is wrong and what is allowed.
    pub fn decode(bytes: &[u8]) -> Result<Genotype, DecodeError> {
        let body = expect_header(bytes, CONTROLLER)?;
        let Read { beta, delta, proteins, .. } = encoding::decode(bytes)?;
        let genotype = Genotype { body, beta, delta, proteins };
        genotype.check()?;
        Ok(genotype)
    }

    fn check(&self) -> Result<(), DecodeError> {
        for (field, value) in [("beta", self.beta), ("delta", self.delta)] {
            if !SCALING.contains(&value) {
                return Err(DecodeError::illegal(field, format!("{value} is not within [0.5, 2]")));
            }
        }
        let wired = wired(self.body);
        let (least, most) = (wired + REGULATORY.start(), wired + REGULATORY.end());
        let found = self.proteins.len();
        if !(least..=most).contains(&found) {
            let body = self.body.name();
            let problem = format!("{found} proteins where {body} has {least} to {most}");
            return Err(DecodeError::illegal("proteins", problem));
        }
        for (index, protein) in self.proteins.iter().enumerate() {
            for (tag, value) in [("id", protein.id), ("enh", protein.enh), ("inh", protein.inh)] {
                if value > TAG_MAX {
                    let field = format!("proteins[{index}].{tag}");
                    return Err(DecodeError::illegal(field, format!("{value} is not within 0..=32")));
                }
            }
        }
        Ok(())
    }

    /// The number of regulatory proteins, n_reg.
    pub fn regulatory(&self) -> usize {
        self.proteins.len() - wired(self.body)
    }

    /// What people ask about (G-75).
    pub fn traits(&self) -> serde_json::Value {
        serde_json::json!({ "regulatory": self.regulatory(), "beta": self.beta, "delta": self.delta })
    }
}

/// Proteins wired to sensors and motors: inputs and two outputs per degree of freedom (G-19).
pub(super) fn wired(body: BodyKind) -> usize {
    body.inputs() + 2 * body.degrees()
}

#[cfg(test)]
mod tests;

//! A walker's genotype as it travels: version, body and controller in front, then what the controller
//! needs (G-73). It decides nothing about variation, which belongs to each controller.

use super::{body::BodyKind, grn, neat};
use crate::{DecodeError, encoding};
use serde::Deserialize;

/// The payload version that this program writes and reads.
pub const VERSION: u32 = 1;

/// A genotype of either controller.
#[derive(Debug, Clone, PartialEq)]
pub enum Genotype {
    /// Gene regulatory network.
    Grn(grn::Genotype),
    /// Neural network of NEAT.
    Neat(neat::Genotype),
}

impl Genotype {
    /// Reads any walker's genotype and checks that it is legal.
    ///
    /// # Errors
    /// X-1..X-7: the field that is wrong and what is allowed.
    pub fn decode(bytes: &[u8]) -> Result<Genotype, DecodeError> {
        match Header::read(bytes)?.controller.as_str() {
            grn::CONTROLLER => grn::Genotype::decode(bytes).map(Genotype::Grn),
            neat::CONTROLLER => neat::Genotype::decode(bytes).map(Genotype::Neat),
            other => Err(unknown_controller(other)),
        }
    }

    /// The canonical bytes.
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Genotype::Grn(genotype) => genotype.encode(),
            Genotype::Neat(genotype) => genotype.encode(),
        }
    }

    /// The body it is made for.
    pub fn body(&self) -> BodyKind {
        match self {
            Genotype::Grn(genotype) => genotype.body,
            Genotype::Neat(genotype) => genotype.body,
        }
    }

    /// What people ask about, a flat JSON object (G-75).
    pub fn traits(&self) -> serde_json::Value {
        match self {
            Genotype::Grn(genotype) => genotype.traits(),
            Genotype::Neat(genotype) => genotype.traits(),
        }
    }
}

/// What stands in front of every walker's payload; the rest is skipped.
#[derive(Debug, Deserialize)]
struct Header {
    version: u32,
    body: String,
    controller: String,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Header, DecodeError> {
        let header: Header = encoding::decode(bytes)?;
        if header.version != VERSION {
            return Err(DecodeError::version(header.version, VERSION));
        }
        Ok(header)
    }
}

/// Checks the front of a payload that ought to be of one controller and gives its body.
///
/// # Errors
/// Another version, an unknown body, another controller.
pub(super) fn expect_header(bytes: &[u8], controller: &str) -> Result<BodyKind, DecodeError> {
    let header = Header::read(bytes)?;
    if header.controller != controller {
        return Err(unknown_controller(&header.controller));
    }
    BodyKind::named(&header.body).ok_or_else(|| {
        let known = BodyKind::ALL.map(BodyKind::name).join(", ");
        let problem =
            format!("`{}` is none of {known}; if a newer program made it, upgrade the receiver", header.body);
        DecodeError::illegal("body", problem)
    })
}

fn unknown_controller(found: &str) -> DecodeError {
    let problem = format!(
        "`{found}` is not {} or {} as expected here; if a newer program made it, upgrade the receiver",
        grn::CONTROLLER,
        neat::CONTROLLER
    );
    DecodeError::illegal("controller", problem)
}

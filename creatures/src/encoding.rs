//! The one byte encoding of a genotype: CBOR maps with fields in their declared order, floats by their
//! bits. It carries its own field names, so that a notebook reads it without this code. It refuses
//! oversized payloads before it allocates.

use serde::{Serialize, de::DeserializeOwned};

/// The largest genotype accepted, bytes.
pub const SIZE_MAX: usize = 1 << 20;

/// Why bytes are not a genotype of the system they are meant for.
#[derive(Debug, thiserror::Error)]
pub enum DecodeError {
    /// Refused by its size alone.
    #[error("genotype of {found} bytes is over the limit of {SIZE_MAX}")]
    TooLarge {
        /// Its size in bytes.
        found: usize,
    },
    /// No CBOR, or not of the expected shape.
    #[error("genotype encoding is malformed")]
    Malformed(#[source] ciborium::de::Error<std::io::Error>),
    /// Bytes behind the genotype.
    #[error("genotype encoding has {0} bytes too many")]
    Trailing(usize),
    /// Made by another version of this program.
    #[error("genotype version {found} is not {known}: upgrade the {side}")]
    Version {
        /// The version in the payload.
        found: u32,
        /// The version that this program knows.
        known: u32,
        /// Who has to be upgraded: `sender` or `receiver`.
        side: &'static str,
    },
    /// Well-formed, but no legal genotype.
    #[error("genotype field `{field}`: {problem}")]
    Illegal {
        /// Where: a path such as `proteins[3].id`.
        field: String,
        /// What is wrong, and what is allowed.
        problem: String,
    },
}

impl DecodeError {
    /// An illegal value in a named field.
    pub fn illegal(field: impl Into<String>, problem: impl Into<String>) -> Self {
        DecodeError::Illegal { field: field.into(), problem: problem.into() }
    }

    /// A version other than the known one, with the side to upgrade.
    pub fn version(found: u32, known: u32) -> Self {
        DecodeError::Version { found, known, side: if found > known { "receiver" } else { "sender" } }
    }
}

/// The canonical bytes of a genotype.
pub fn encode<T: Serialize>(genotype: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    ciborium::into_writer(genotype, &mut bytes)
        .expect("a genotype serialises, and a vector takes every byte");
    bytes
}

/// Reads a genotype's shape; whether it is legal is for its system to say.
///
/// # Errors
/// Size, malformed CBOR, unknown or missing fields, trailing bytes.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, DecodeError> {
    if bytes.len() > SIZE_MAX {
        return Err(DecodeError::TooLarge { found: bytes.len() });
    }
    let mut rest = bytes;
    let value =
        ciborium::de::from_reader_with_recursion_limit(&mut rest, 16).map_err(DecodeError::Malformed)?;
    if rest.is_empty() { Ok(value) } else { Err(DecodeError::Trailing(rest.len())) }
}

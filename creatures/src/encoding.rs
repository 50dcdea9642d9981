//! The one byte encoding of a genotype: CBOR maps with fields in their declared order, floats by their
//! bits. It carries its own field names, so that a notebook reads it without this code. It refuses
//! oversized payloads before it allocates.

use serde::{Deserialize, Deserializer, Serialize, de::DeserializeOwned};
use std::marker::PhantomData;

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
    /// No CBOR.
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
/// Size, malformed CBOR, unknown, missing or mistyped fields by name, trailing bytes.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, DecodeError> {
    if bytes.len() > SIZE_MAX {
        return Err(DecodeError::TooLarge { found: bytes.len() });
    }
    let mut rest = bytes;
    let value = read(&mut rest).map_err(|error| match error {
        ciborium::de::Error::Semantic(_, problem) => {
            // Read once more, to learn where: bad genotypes are rare, and good ones pay nothing.
            let field = read::<Misfit<T>>(&mut &*bytes).map(|misfit| misfit.field).unwrap_or_default();
            DecodeError::illegal(field, problem)
        }
        error => DecodeError::Malformed(error),
    })?;
    if rest.is_empty() { Ok(value) } else { Err(DecodeError::Trailing(rest.len())) }
}

fn read<T: DeserializeOwned>(bytes: &mut &[u8]) -> Result<T, ciborium::de::Error<std::io::Error>> {
    ciborium::de::from_reader_with_recursion_limit(bytes, 16)
}

/// Where bytes are not of type `T`; empty where they are, or where no field is to blame.
struct Misfit<T> {
    field: String,
    of: PhantomData<T>,
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Misfit<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut track = serde_path_to_error::Track::new();
        let tracked = serde_path_to_error::Deserializer::new(deserializer, &mut track);
        let field = match T::deserialize(tracked) {
            Ok(_) => String::new(),
            Err(_) => track.path().to_string(),
        };
        Ok(Misfit { field, of: PhantomData })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Gene {
        tags: Vec<u8>,
        weight: f64,
    }

    fn genes() -> Vec<Gene> {
        vec![Gene { tags: vec![1, 2], weight: -0.0 }, Gene { tags: vec![3], weight: 0.1 }]
    }

    #[test]
    fn what_was_encoded_is_decoded_bit_for_bit() {
        let genes = genes();
        let decoded: Vec<Gene> = decode(&encode(&genes)).unwrap();
        assert_eq!(decoded, genes);
        assert_eq!(decoded[0].weight.to_bits(), (-0.0f64).to_bits());
    }

    #[test]
    fn a_mistyped_field_is_named() {
        let bytes = encode(&serde_json::json!([{"tags": [1], "weight": 1.0}, {"tags": [1, 2, 1.5]}]));
        let error = decode::<Vec<Gene>>(&bytes).unwrap_err();
        assert!(matches!(&error, DecodeError::Illegal { field, .. } if field == "[1].tags[2]"), "{error}");
    }

    #[test]
    fn truncated_oversized_and_trailing_bytes_are_refused() {
        let mut bytes = encode(&genes());
        let cut = &bytes[..bytes.len() - 1];
        assert!(matches!(decode::<Vec<Gene>>(cut), Err(DecodeError::Malformed(_))));
        bytes.push(0);
        assert!(matches!(decode::<Vec<Gene>>(&bytes), Err(DecodeError::Trailing(1))));
        bytes.resize(SIZE_MAX + 1, 0);
        assert!(matches!(decode::<Vec<Gene>>(&bytes), Err(DecodeError::TooLarge { .. })));
    }
}

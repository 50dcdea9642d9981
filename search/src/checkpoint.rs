//! Checkpoints: a search's whole state as bytes, with its kind and version in front. It knows no search;
//! what the state is, and whether its genotypes are legal, each search says itself.

use creatures::DecodeError;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de, de::DeserializeOwned};
use std::fmt;

/// The layout of the checkpoints that this program writes and reads.
const VERSION: u32 = 1;

/// Why bytes are no checkpoint to go on from.
#[derive(Debug, thiserror::Error)]
pub enum RestoreError {
    /// No CBOR, or not of the expected shape: the lineage file is damaged.
    #[error("checkpoint is malformed: {0}")]
    Malformed(String),
    /// Written by another version of this program.
    #[error("checkpoint version {found} is not {VERSION}: go on with the program that wrote it")]
    Version {
        /// The version in the checkpoint.
        found: u32,
    },
    /// Of another kind of search.
    #[error("checkpoint is of a `{found}` search, not `{expected}`")]
    Kind {
        /// The kind in the checkpoint.
        found: String,
        /// The kind that was to be restored.
        expected: &'static str,
    },
    /// Well-formed, but no state that this search can be in: made with other settings, or damaged.
    #[error("checkpoint does not fit its search: {0}")]
    Unfit(&'static str),
    /// It holds a genotype that is not legal.
    #[error("checkpoint holds an illegal genotype at index {index}")]
    Genotype {
        /// Which of its population.
        index: usize,
        /// What is wrong with it.
        #[source]
        source: DecodeError,
    },
}

/// The bytes of a state.
pub(crate) fn write<T: Serialize>(kind: &str, state: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    ciborium::into_writer(&(VERSION, kind, state), &mut bytes)
        .expect("a search's state serialises, and a vector takes every byte");
    bytes
}

/// Reads the state of a kind of search.
///
/// # Errors
/// All of [`RestoreError`] but `Unfit` and `Genotype`, which are the search's to raise.
pub(crate) fn read<T: DeserializeOwned>(kind: &'static str, bytes: &[u8]) -> Result<T, RestoreError> {
    let malformed = |error: ciborium::de::Error<std::io::Error>| RestoreError::Malformed(error.to_string());
    // The state is read only once its version and kind are known to be ours.
    let (version, found, state): (u32, String, ciborium::Value) =
        ciborium::from_reader(bytes).map_err(malformed)?;
    if version != VERSION {
        return Err(RestoreError::Version { found: version });
    }
    if found != kind {
        return Err(RestoreError::Kind { found, expected: kind });
    }
    state.deserialized().map_err(|error| RestoreError::Malformed(error.to_string()))
}

/// Checks what a state must be like, so that nobody who goes on from it checks again.
///
/// # Errors
/// What is not so.
pub(crate) fn require(holds: bool, otherwise: &'static str) -> Result<(), RestoreError> {
    if holds { Ok(()) } else { Err(RestoreError::Unfit(otherwise)) }
}

/// Canonical bytes of a genotype inside a checkpoint; CBOR writes them as one string of bytes.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GenotypeBytes(pub(crate) Vec<u8>);

impl fmt::Debug for GenotypeBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes", self.0.len())
    }
}

impl Serialize for GenotypeBytes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for GenotypeBytes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = GenotypeBytes;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("bytes")
            }
            fn visit_bytes<E: de::Error>(self, bytes: &[u8]) -> Result<GenotypeBytes, E> {
                Ok(GenotypeBytes(bytes.to_vec()))
            }
            fn visit_byte_buf<E: de::Error>(self, bytes: Vec<u8>) -> Result<GenotypeBytes, E> {
                Ok(GenotypeBytes(bytes))
            }
        }
        deserializer.deserialize_byte_buf(Visitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_survives_and_every_other_input_is_named() {
        let state = vec![GenotypeBytes(vec![1, 2, 3]), GenotypeBytes(vec![])];
        let bytes = write("grn", &state);
        assert_eq!(read::<Vec<GenotypeBytes>>("grn", &bytes).unwrap(), state);

        let problem = |kind, bytes: &[u8]| read::<Vec<GenotypeBytes>>(kind, bytes).unwrap_err().to_string();
        assert_eq!(problem("neat", &bytes), "checkpoint is of a `grn` search, not `neat`");
        assert!(problem("grn", &bytes[..5]).starts_with("checkpoint is malformed"));
        assert!(problem("grn", &write("grn", &"text")).starts_with("checkpoint is malformed"));
        let mut newer = Vec::new();
        ciborium::into_writer(&(9, "grn", &state), &mut newer).unwrap();
        assert!(problem("grn", &newer).starts_with("checkpoint version 9 is not 1"));
    }
}

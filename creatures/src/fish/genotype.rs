//! A fish's genotype: what is varied of it, one of several kinds. It refuses whatever is not legal, and
//! never varies itself.

use super::{Controller, ControllerSet, Samples};
use crate::{DecodeError, encoding};
use serde::{Deserialize, Serialize};

/// The payload version that this program writes and reads.
pub const VERSION: u32 = 1;

/// What is varied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Genotype {
    /// Muscle functions in practice.
    MuscleSamples(Samples),
    /// One abstracted controller.
    Controller(Controller),
    /// All that was learned.
    ControllerSet(ControllerSet),
}

#[derive(Serialize)]
struct Written<'a> {
    version: u32,
    genotype: &'a Genotype,
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
    genotype: Genotype,
}

impl Genotype {
    /// The canonical bytes: version, then the kind with its fields.
    pub fn encode(&self) -> Vec<u8> {
        encoding::encode(&Written { version: VERSION, genotype: self })
    }

    /// Reads a genotype and checks that it is legal; nothing is clamped.
    ///
    /// # Errors
    /// AF-3, AF-4: the field that is wrong, of values with their index.
    pub fn decode(bytes: &[u8]) -> Result<Genotype, DecodeError> {
        let Header { version } = encoding::decode(bytes)?;
        if version != VERSION {
            return Err(DecodeError::version(version, VERSION));
        }
        let Read { genotype, .. } = encoding::decode(bytes)?;
        genotype.check()?;
        Ok(genotype)
    }

    /// What kind it is, as it stands in the payload.
    pub fn kind(&self) -> &'static str {
        match self {
            Genotype::MuscleSamples(_) => "muscle_samples",
            Genotype::Controller(_) => "controller",
            Genotype::ControllerSet(_) => "controller_set",
        }
    }

    fn check(&self) -> Result<(), DecodeError> {
        match self {
            Genotype::MuscleSamples(samples) => samples.check(),
            Genotype::Controller(controller) => controller.check("controller"),
            Genotype::ControllerSet(set) => set.check(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::samples::Encoding;
    use crate::fish::{controller, controller_set};
    use crate::random::stream;
    use proptest::prelude::*;

    fn every_kind(seed: u64) -> [Genotype; 3] {
        let samples = Samples::random(0, Encoding::Tied, 15, 182, &mut stream(seed, [0, 0, 0], "samples"));
        [
            Genotype::MuscleSamples(samples),
            Genotype::Controller(controller::tests::random(1 + seed as usize % 7, seed)),
            Genotype::ControllerSet(controller_set::tests::set()),
        ]
    }

    proptest! {
        #[test]
        fn every_kind_survives_its_encoding_bit_for_bit(seed: u64) {
            for genotype in every_kind(seed) {
                let bytes = genotype.encode();
                let decoded = Genotype::decode(&bytes).unwrap();
                prop_assert_eq!(&decoded, &genotype);
                prop_assert_eq!(decoded.encode(), bytes);
            }
        }

        #[test]
        fn damaged_bytes_are_refused_or_another_legal_genotype(seed: u64, at: usize, byte: u8) {
            for genotype in every_kind(seed) {
                let mut bytes = genotype.encode();
                let at = at % bytes.len();
                bytes[at] = byte;
                if let Ok(other) = Genotype::decode(&bytes) {
                    prop_assert!(other.check().is_ok());
                }
            }
        }
    }

    /// AF-3, AF-4
    #[test]
    fn an_illegal_field_of_a_payload_is_named() {
        let [samples, ..] = every_kind(1);
        let mut value: ciborium::Value = ciborium::from_reader(samples.encode().as_slice()).unwrap();
        let genotype = &mut value.as_map_mut().unwrap()[1].1;
        let fields = genotype.as_map_mut().unwrap()[0].1.as_map_mut().unwrap();
        fields[4].1.as_array_mut().unwrap()[7] = ciborium::Value::Float(1.25);
        let mut bytes = Vec::new();
        ciborium::into_writer(&value, &mut bytes).unwrap();
        let error = Genotype::decode(&bytes).unwrap_err().to_string();
        assert_eq!(error, "genotype field `samples.values[7]`: 1.25 is not within 0 to 1");
        let newer = encoding::encode(&serde_json::json!({ "version": 2 }));
        assert!(matches!(Genotype::decode(&newer), Err(DecodeError::Version { found: 2, .. })));
    }
}

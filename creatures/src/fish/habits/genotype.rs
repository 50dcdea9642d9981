//! Habits as a genotype: one vector for each kind of fish under test. It refuses whatever is not legal,
//! and says all that is wrong at once (AF-5).

use super::{Habits, Nature, Sex};
use crate::{DecodeError, encoding};
use serde::{Deserialize, Serialize};

/// The payload version that this program writes and reads.
pub const VERSION: u32 = 1;
/// More kinds of fish than any scenario tests.
const VECTORS_MAX: usize = 16;

/// What is inherited in a world: habits.
#[derive(Debug, Clone, PartialEq)]
pub struct Genotype {
    /// One vector for each kind of fish under test.
    pub habits: Vec<Habits>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Payload {
    version: u32,
    genotype: Tagged,
}

/// Told from a fish's other genotypes by its name.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Tagged {
    Habits(Vec<Vector>),
}

/// What stands in front; the rest is skipped.
#[derive(Deserialize)]
struct Header {
    version: u32,
}

/// Habits as they are written: words are still words, so that an unknown one is told with all that is wrong.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Vector {
    nature: String,
    species: u32,
    sex: String,
    schooling: bool,
    brightness_min: f64,
    brightness_max: f64,
    temperature_min: f64,
    temperature_max: f64,
    size: f64,
    appetite: f64,
    digestion: f64,
    ardour: f64,
    fear_min: f64,
    panic: f64,
    urge: f64,
    sensitivity: f64,
    persistence: f64,
    vision: f64,
    cruise: f64,
}

impl Genotype {
    /// The canonical bytes: version, then the vectors with their fields as A-60 orders them.
    pub fn encode(&self) -> Vec<u8> {
        let habits = self.habits.iter().map(Vector::from).collect();
        encoding::encode(&Payload { version: VERSION, genotype: Tagged::Habits(habits) })
    }

    /// Reads habits and checks that they are legal; nothing is clamped.
    ///
    /// # Errors
    /// AF-5: every violation of every vector, at once.
    pub fn decode(bytes: &[u8]) -> Result<Genotype, DecodeError> {
        let Header { version } = encoding::decode(bytes)?;
        if version != VERSION {
            return Err(DecodeError::version(version, VERSION));
        }
        let Payload { genotype: Tagged::Habits(vectors), .. } = encoding::decode(bytes)?;
        if !(1..=VECTORS_MAX).contains(&vectors.len()) {
            let problem = format!("{} vectors where 1 to {VECTORS_MAX} are legal", vectors.len());
            return Err(DecodeError::illegal("habits", problem));
        }
        let (mut habits, mut faults) = (Vec::with_capacity(vectors.len()), Vec::new());
        for (index, vector) in vectors.into_iter().enumerate() {
            match vector.checked() {
                Ok(legal) => habits.push(legal),
                Err(found) => faults.extend(found.into_iter().map(|fault| format!("[{index}] {fault}"))),
            }
        }
        if faults.is_empty() {
            Ok(Genotype { habits })
        } else {
            Err(DecodeError::illegal("habits", faults.join("; ")))
        }
    }
}

impl Vector {
    fn checked(self) -> Result<Habits, Vec<String>> {
        let nature = read_word::<Nature>("nature", &self.nature, "`predator`, `prey` or `pacifist`");
        let sex = read_word::<Sex>("sex", &self.sex, "`male` or `female`");
        let words: Vec<String> = nature.clone().err().into_iter().chain(sex.clone().err()).collect();
        let habits = Habits {
            nature: nature.unwrap_or(Nature::Prey), // not used where the word is unknown
            species: self.species,
            sex: sex.unwrap_or(Sex::Male),
            schooling: self.schooling,
            brightness_min: self.brightness_min,
            brightness_max: self.brightness_max,
            temperature_min: self.temperature_min,
            temperature_max: self.temperature_max,
            size: self.size,
            appetite: self.appetite,
            digestion: self.digestion,
            ardour: self.ardour,
            fear_min: self.fear_min,
            panic: self.panic,
            urge: self.urge,
            sensitivity: self.sensitivity,
            persistence: self.persistence,
            vision: self.vision,
            cruise: self.cruise,
        };
        let faults: Vec<String> = words.into_iter().chain(habits.violations()).collect();
        if faults.is_empty() { Ok(habits) } else { Err(faults) }
    }
}

impl From<&Habits> for Vector {
    fn from(habits: &Habits) -> Vector {
        Vector {
            nature: write_word(&habits.nature),
            species: habits.species,
            sex: write_word(&habits.sex),
            schooling: habits.schooling,
            brightness_min: habits.brightness_min,
            brightness_max: habits.brightness_max,
            temperature_min: habits.temperature_min,
            temperature_max: habits.temperature_max,
            size: habits.size,
            appetite: habits.appetite,
            digestion: habits.digestion,
            ardour: habits.ardour,
            fear_min: habits.fear_min,
            panic: habits.panic,
            urge: habits.urge,
            sensitivity: habits.sensitivity,
            persistence: habits.persistence,
            vision: habits.vision,
            cruise: habits.cruise,
        }
    }
}

fn read_word<'de, T: Deserialize<'de>>(field: &str, word: &'de str, known: &str) -> Result<T, String> {
    let word_of = serde::de::value::BorrowedStrDeserializer::<serde::de::value::Error>::new(word);
    T::deserialize(word_of).map_err(|_| format!("`{field}` `{word}` is none of {known}"))
}

fn write_word<T: Serialize>(word: &T) -> String {
    match serde_json::to_value(word) {
        Ok(serde_json::Value::String(word)) => word,
        _ => unreachable!("a unit variant is written as its name"),
    }
}

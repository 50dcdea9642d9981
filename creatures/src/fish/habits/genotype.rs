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
struct Payload<V> {
    version: u32,
    genotype: Tagged<V>,
}

/// Told from a fish's other genotypes by its name.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Tagged<V> {
    Habits(V),
}

/// What stands in front; the rest is skipped.
#[derive(Deserialize)]
struct Header {
    version: u32,
}

impl Genotype {
    /// The canonical bytes: version, then the vectors with their fields as A-60 orders them.
    pub fn encode(&self) -> Vec<u8> {
        encoding::encode(&Payload { version: VERSION, genotype: Tagged::Habits(&self.habits) })
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
        let Payload::<Vec<Worded>> { genotype: Tagged::Habits(vectors), .. } = encoding::decode(bytes)?;
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

/// Habits as they are read: words are still words, so that an unknown one is told with all that is wrong.
type Worded = Habits<String, String>;

impl Worded {
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

fn read_word<'de, T: Deserialize<'de>>(field: &str, word: &'de str, known: &str) -> Result<T, String> {
    let word_of = serde::de::value::BorrowedStrDeserializer::<serde::de::value::Error>::new(word);
    T::deserialize(word_of).map_err(|_| format!("`{field}` `{word}` is none of {known}"))
}

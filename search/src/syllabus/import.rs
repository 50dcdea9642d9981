//! A creature from elsewhere that has learned the first skill already (ESP E-90): its genotype inside the
//! experiment, in hexadecimal, so that the resolved file is the whole experiment. It reads no file.

use creatures::SpecError;
use creatures::esp::genotype::Genotype;
use creatures::esp::syllabus::{SkillId, Syllabus};
use serde::{Deserialize, Serialize};

/// The skill that an imported creature knows.
const FIRST: SkillId = SkillId(0);

/// The value of `search.import`: the canonical bytes of a genotype in hexadecimal; empty for none.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Import(String);

impl Import {
    /// The value for the canonical bytes of a genotype, as `search.import` takes it.
    pub fn of(genotype: &[u8]) -> String {
        genotype.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    pub(super) fn is_none(&self) -> bool {
        self.0.is_empty()
    }

    /// Checks that it is a legal creature with control of the first skill.
    pub(super) fn check(&self, syllabus: &Syllabus) -> Result<(), SpecError> {
        self.creature(syllabus).map(|_| ())
    }

    /// The creature as if it had just finished the first skill: its control of that is encapsulated, and whatever
    /// it has learned beyond is left out, since this syllabus need not have it.
    pub(super) fn creature(&self, syllabus: &Syllabus) -> Result<Option<Genotype>, SpecError> {
        if self.is_none() {
            return Ok(None);
        }
        let bytes = bytes(&self.0).ok_or_else(|| SpecError::new("", "is no genotype in hexadecimal"))?;
        let illegal = |error: creatures::DecodeError| SpecError::new("", error.to_string());
        let mut genotype = Genotype::decode(&bytes).map_err(illegal)?;
        genotype.brain.controls.retain(|control| control.skill == FIRST);
        if genotype.brain.controls.is_empty() {
            return Err(SpecError::new("", "is a creature without control of a first skill"));
        }
        let muscles = genotype.body.edges.iter_mut().flat_map(|edge| &mut edge.muscles);
        muscles.for_each(|muscle| muscle.owner = FIRST);
        let receptors = genotype.body.segments.iter_mut().flat_map(|segment| &mut segment.receptors);
        receptors.for_each(|receptor| receptor.owner = FIRST);
        genotype.encapsulate(FIRST);
        genotype.check(syllabus).map_err(illegal)?;
        Ok(Some(genotype))
    }
}

fn bytes(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> =
        text.chars().map(|digit| digit.to_digit(16).map(|digit| digit as u8)).collect::<Option<_>>()?;
    digits.len().is_multiple_of(2).then(|| digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect())
}

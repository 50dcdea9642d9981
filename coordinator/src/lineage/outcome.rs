//! Outcomes as columns, and back to the same bits. Measures stand in number columns in the order of names that
//! the stage holds once; what does not fit those is text, where a value that is no number has its bits.

use super::SetAside;
use creatures::{Interim, Outcome, Reason, Status};
use serde_json::Value;
use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;
use std::fmt::Write as _;

/// Number columns of an outcome's measures: `m0`, `m1`, …
pub(crate) const MEASURES: usize = 12;

/// The word of an individual that the service set aside.
pub(crate) const FAILED: &str = "failed";

/// The word of a status.
pub(crate) fn word(status: Status) -> String {
    match status {
        Status::Completed => "completed".to_owned(),
        Status::Culled => "culled".to_owned(),
        Status::Aborted(reason) => format!("aborted:{}", reason.word()),
    }
}

fn status(word: &str) -> Option<Status> {
    match word {
        "completed" => Some(Status::Completed),
        "culled" => Some(Status::Culled),
        _ => {
            let reason = word.strip_prefix("aborted:")?;
            Reason::ALL.into_iter().find(|known| known.word() == reason).map(Status::Aborted)
        }
    }
}

/// The names of an outcome's measures: a JSON array.
pub(crate) fn names(outcome: &Outcome) -> String {
    let names = outcome.measures.iter().map(|(name, _)| Value::String(name.clone())).collect();
    Value::Array(names).to_string()
}

/// The measures of an outcome as they are stored.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Measures {
    /// Values for the stage's names.
    pub(crate) numbers: [Option<f64>; MEASURES],
    /// Pairs of name and value as JSON, of an outcome that does not fit `numbers`.
    pub(crate) pairs: Option<String>,
}

impl Measures {
    /// Of an outcome in a stage that measures `stage_names`.
    pub(crate) fn of(outcome: &Outcome, stage_names: &[String]) -> Measures {
        let measures = &outcome.measures;
        let fits = measures.len() <= MEASURES
            && measures.iter().map(|(name, _)| name).eq(stage_names)
            && measures.iter().all(|(_, value)| is_kept(*value));
        let mut stored = Measures::default();
        if fits {
            for (column, (_, value)) in stored.numbers.iter_mut().zip(measures) {
                *column = Some(*value);
            }
        } else if !measures.is_empty() {
            stored.pairs = Some(pairs(measures));
        }
        stored
    }

    /// Names and values in their order, given the stage's names as stored.
    ///
    /// # Errors
    /// What makes no sense.
    pub(crate) fn read(&self, stage_names: Option<&str>) -> Result<Vec<(String, f64)>, String> {
        if let Some(pairs) = self.pairs.as_deref() {
            let wrong = || format!("measures `{pairs}` make no sense");
            let values: Vec<(String, Value)> = serde_json::from_str(pairs).map_err(|_| wrong())?;
            let number = |(name, value)| Some((name, read_number(&value)?));
            return values.into_iter().map(number).collect::<Option<_>>().ok_or_else(wrong);
        }
        let numbers: Vec<f64> = self.numbers.iter().map_while(|number| *number).collect();
        if numbers.is_empty() {
            return Ok(Vec::new());
        }
        let names = stage_names.and_then(read_names).unwrap_or_default();
        if names.len() != numbers.len() {
            return Err(format!("{} measures have {} names", numbers.len(), names.len()));
        }
        Ok(names.into_iter().zip(numbers).collect())
    }
}

/// Whether SQLite gives a number back to the bit: it takes NaN for NULL, and drops the sign of zero.
fn is_kept(value: f64) -> bool {
    !value.is_nan() && value.to_bits() != (-0.0f64).to_bits()
}

fn pairs(measures: &[(String, f64)]) -> String {
    let mut text = String::from("[");
    for (i, (name, value)) in measures.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        let _ = write!(text, "{comma}[{},", Value::from(name.as_str())); // a string takes every write
        write_number(&mut text, *value);
        text.push(']');
    }
    text.push(']');
    text
}

/// Measures as a JSON object in their order, for people.
pub(crate) fn object(measures: &[(String, f64)]) -> String {
    let mut text = String::from("{");
    for (i, (name, value)) in measures.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        let _ = write!(text, "{comma}{}:", Value::from(name.as_str())); // a string takes every write
        write_number(&mut text, *value);
    }
    text.push('}');
    text
}

/// The shortest decimal that reads back to the same bits, or the bits as text.
fn write_number(text: &mut String, value: f64) {
    let _ = if value.is_finite() {
        write!(text, "{value:?}")
    } else {
        write!(text, "\"{value} 0x{:016x}\"", value.to_bits())
    };
}

fn read_number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64(),
        Value::String(text) => {
            let (_, bits) = text.split_once(" 0x")?;
            u64::from_str_radix(bits, 16).ok().map(f64::from_bits)
        }
        _ => None,
    }
}

/// The columns of an outcome's row, joined with its stage's names.
#[derive(Debug)]
pub(crate) struct Columns {
    pub(crate) status: Option<String>,
    pub(crate) fitness_bits: Option<i64>,
    pub(crate) steps: Option<i64>,
    pub(crate) interim_step: Option<i64>,
    pub(crate) interim_measure: Option<f64>,
    pub(crate) note: Option<String>,
    pub(crate) measure_names: Option<String>,
    pub(crate) measures: Measures,
}

impl sqlx::FromRow<'_, SqliteRow> for Columns {
    fn from_row(row: &SqliteRow) -> Result<Self, sqlx::Error> {
        let mut numbers = [None; MEASURES];
        let pairs = row.try_get("measures")?;
        for (at, number) in numbers.iter_mut().enumerate() {
            *number = row.try_get(format!("m{at}").as_str())?;
            if number.is_none() {
                break;
            }
        }
        Ok(Columns {
            status: row.try_get("status")?,
            fitness_bits: row.try_get("fitness_bits")?,
            steps: row.try_get("steps")?,
            interim_step: row.try_get("interim_step")?,
            interim_measure: row.try_get("interim_measure")?,
            note: row.try_get("note")?,
            measure_names: row.try_get("measure_names")?,
            measures: Measures { numbers, pairs },
        })
    }
}

/// What became of an individual; `None` for one that is pending.
pub(crate) type Known = Option<Result<Outcome, SetAside>>;

impl Columns {
    /// What they say.
    ///
    /// # Errors
    /// The column that makes no sense.
    pub(crate) fn read(&self) -> Result<Known, String> {
        let Some(word) = self.status.as_deref() else { return Ok(None) };
        let note = self.note.clone().unwrap_or_default();
        if word == FAILED {
            return Ok(Some(Err(SetAside { reason: note })));
        }
        let status = status(word).ok_or_else(|| format!("status `{word}` is unknown"))?;
        let interim = self.interim_step.map(|step| -> Result<Interim, String> {
            // NULL beside a step is the NaN that was. Nothing depends on the sign of a zero here.
            let measure = self.interim_measure.unwrap_or(f64::NAN);
            Ok(Interim { step: small(step, "interim_step")?, measure })
        });
        Ok(Some(Ok(Outcome {
            status,
            fitness: f64::from_bits(self.fitness_bits.ok_or("fitness_bits is missing")?.cast_unsigned()),
            steps: small(self.steps.unwrap_or(0), "steps")?,
            measures: self.measures.read(self.measure_names.as_deref())?,
            interim: interim.transpose()?,
            note,
        })))
    }
}

/// The names of a stage's measures, or traits.
pub(crate) fn read_names(text: &str) -> Option<Vec<String>> {
    serde_json::from_str(text).ok()
}

fn small(column: i64, name: &str) -> Result<u32, String> {
    u32::try_from(column).map_err(|_| format!("{name} {column} is out of range"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn columns(outcome: &Outcome, stage_names: &[String]) -> Columns {
        Columns {
            status: Some(word(outcome.status)),
            fitness_bits: Some(outcome.fitness.to_bits().cast_signed()),
            steps: Some(outcome.steps.into()),
            measures: Measures::of(outcome, stage_names),
            measure_names: Some(serde_json::to_string(stage_names).unwrap()),
            interim_step: outcome.interim.map(|interim| interim.step.into()),
            interim_measure: outcome.interim.map(|interim| interim.measure),
            note: Some(outcome.note.clone()),
        }
    }

    proptest! {
        #[test]
        fn an_outcome_comes_back_bit_for_bit(
            fitness: u64,
            values in proptest::collection::vec(any::<u64>(), 0..15),
            own_names: bool,
            steps: u32,
        ) {
            let named: Vec<_> =
                values.iter().enumerate().map(|(i, bits)| (format!("m\"{i}"), f64::from_bits(*bits))).collect();
            let stage_names: Vec<_> = named.iter().map(|(name, _)| name.clone()).collect();
            let outcome = Outcome {
                status: Status::Aborted(Reason::BlowUp),
                fitness: f64::from_bits(fitness),
                steps,
                measures: named,
                interim: Some(Interim { step: 3, measure: -0.0 }),
                note: "x".to_owned(),
            };
            let back = columns(&outcome, if own_names { &[] } else { &stage_names }).read().unwrap();
            prop_assert_eq!(back.unwrap().unwrap().digest(), outcome.digest());
        }
    }

    #[test]
    fn a_row_that_makes_no_sense_is_an_error() {
        let outcome = Outcome {
            status: Status::Completed,
            fitness: 1.0,
            steps: 1,
            measures: vec![("dis".to_owned(), 2.0)],
            interim: None,
            note: String::new(),
        };
        let names = ["dis".to_owned()];
        let good = || columns(&outcome, &names);
        assert!(good().read().is_ok());
        assert!(Columns { status: Some("eaten".into()), ..good() }.read().is_err());
        let measures = |pairs: &str| Measures { pairs: Some(pairs.to_owned()), ..Measures::default() };
        assert!(Columns { measures: measures("[[\"dis\",1]]"), ..good() }.read().is_ok());
        assert!(Columns { measures: measures("[1,2]"), ..good() }.read().is_err());
        assert!(Columns { measures: measures("{"), ..good() }.read().is_err());
        assert!(Columns { measure_names: None, ..good() }.read().is_err());
        assert!(Columns { steps: Some(-1), ..good() }.read().is_err());
        assert!(Columns { fitness_bits: None, ..good() }.read().is_err());
    }
}

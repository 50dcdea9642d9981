//! Outcomes as columns, and back to the same bits. Measures are an array of numbers in the order of names
//! that the stage holds once; where JSON has no number (NaN, infinities) the bits stand as text.

use super::SetAside;
use creatures::{Interim, Outcome, Reason, Status};
use serde_json::Value;
use std::fmt::Write as _;

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

/// The measures of an outcome: numbers if they are the stage's (`names`), else pairs of name and number.
/// Nothing for an outcome that measured nothing.
pub(crate) fn measures(outcome: &Outcome, stage_names: &[String]) -> Option<String> {
    if outcome.measures.is_empty() {
        return None;
    }
    let alike = outcome.measures.iter().map(|(name, _)| name).eq(stage_names);
    let mut text = String::with_capacity(20 * outcome.measures.len());
    for (i, (name, value)) in outcome.measures.iter().enumerate() {
        text.push(if i == 0 { '[' } else { ',' });
        if alike {
            write_number(&mut text, *value);
        } else {
            let _ = write!(text, "[{},", Value::String(name.clone())); // a string takes every write
            write_number(&mut text, *value);
            text.push(']');
        }
    }
    text.push(']');
    Some(text)
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
#[derive(Debug, sqlx::FromRow)]
pub(crate) struct Columns {
    pub(crate) status: Option<String>,
    pub(crate) fitness_bits: Option<i64>,
    pub(crate) steps: Option<i64>,
    pub(crate) measures: Option<String>,
    pub(crate) measure_names: Option<String>,
    pub(crate) interim_step: Option<i64>,
    pub(crate) interim_measure: Option<f64>,
    pub(crate) note: Option<String>,
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
            // SQLite keeps no NaN; NULL beside a step is one.
            let measure = self.interim_measure.unwrap_or(f64::NAN);
            Ok(Interim { step: small(step, "interim_step")?, measure })
        });
        Ok(Some(Ok(Outcome {
            status,
            fitness: f64::from_bits(self.fitness_bits.ok_or("fitness_bits is missing")?.cast_unsigned()),
            steps: small(self.steps.unwrap_or(0), "steps")?,
            measures: self.pairs()?,
            interim: interim.transpose()?,
            note,
        })))
    }

    /// Names and values of the measures, in their order.
    pub(crate) fn pairs(&self) -> Result<Vec<(String, f64)>, String> {
        let Some(measures) = self.measures.as_deref() else { return Ok(Vec::new()) };
        let wrong = || format!("measures `{measures}` make no sense");
        let values: Vec<Value> = serde_json::from_str(measures).map_err(|_| wrong())?;
        if values.first().is_some_and(Value::is_array) {
            let pair =
                |value: &Value| Some((value.get(0)?.as_str()?.to_owned(), read_number(value.get(1)?)?));
            return values.iter().map(|value| pair(value).ok_or_else(wrong)).collect();
        }
        let names = self.measure_names.as_deref().map_or(Ok(Vec::new()), read_names).map_err(|()| wrong())?;
        if names.len() != values.len() {
            return Err(wrong());
        }
        let numbers = values.iter().map(|value| read_number(value).ok_or_else(wrong));
        names.into_iter().zip(numbers).map(|(name, number)| Ok((name, number?))).collect()
    }
}

/// The names of a stage's measures.
pub(crate) fn read_names(text: &str) -> Result<Vec<String>, ()> {
    serde_json::from_str(text).map_err(|_| ())
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
            measures: measures(outcome, stage_names),
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
            values in proptest::collection::vec(any::<u64>(), 0..10),
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
        assert!(Columns { measures: Some("[1,2]".into()), ..good() }.read().is_err());
        assert!(Columns { measures: Some("{".into()), ..good() }.read().is_err());
        assert!(Columns { steps: Some(-1), ..good() }.read().is_err());
        assert!(Columns { fitness_bits: None, ..good() }.read().is_err());
    }
}

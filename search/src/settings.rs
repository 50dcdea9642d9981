//! What the `[search]` tables of the searches have in common: sizes, and tables that hold keys of a search
//! beside those of a genotype's variation. It knows the defaults of no search.

use creatures::walker::BodyKind;
use creatures::{SpecError, read_spec};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::{Map, Value};
use std::ops::RangeInclusive;

/// Individuals of a generation; the most that one transaction of the lineage is meant for.
pub(crate) const POPULATION: RangeInclusive<u32> = 1..=1_000_000;
/// Generations of a stage.
pub(crate) const GENERATIONS: RangeInclusive<u32> = 1..=10_000_000;

/// Checks that a number is within its range.
///
/// # Errors
/// The key and what is allowed.
pub(crate) fn check<T: PartialOrd + std::fmt::Display>(
    key: &str,
    value: T,
    range: RangeInclusive<T>,
) -> Result<(), SpecError> {
    if range.contains(&value) {
        return Ok(());
    }
    let (least, most) = range.into_inner();
    Err(SpecError::new(key, format!("{value} is not within {least} to {most}")))
}

/// Reads one table into two structs, each with its own keys.
///
/// # Errors
/// A key that neither knows, in serde's words with the keys of both; whatever either refuses.
pub(crate) fn read_joined<A, B>(table: Map<String, Value>) -> Result<(A, B), SpecError>
where
    A: Default + Serialize + DeserializeOwned,
    B: Default + Serialize + DeserializeOwned,
{
    let (keys_a, keys_b) = (write(&A::default()), write(&B::default()));
    let (mut table_a, mut table_b) = (Map::new(), Map::new());
    for (key, value) in table {
        if keys_a.contains_key(&key) {
            table_a.insert(key, value);
        } else if keys_b.contains_key(&key) {
            table_b.insert(key, value);
        } else {
            let allowed: Vec<_> = keys_a.keys().chain(keys_b.keys()).map(|key| format!("`{key}`")).collect();
            let problem = format!("unknown field `{key}`, expected one of {}", allowed.join(", "));
            return Err(SpecError::new(key, problem));
        }
    }
    Ok((read_spec(Value::Object(table_a))?, read_spec(Value::Object(table_b))?))
}

/// The table that a value has to be.
///
/// # Errors
/// Any other value.
pub(crate) fn object(table: Value) -> Result<Map<String, Value>, SpecError> {
    match table {
        Value::Object(table) => Ok(table),
        other => Err(SpecError::new("", format!("{other} is no table"))),
    }
}

/// The inverse of [`read_joined`].
pub(crate) fn write_joined<A: Serialize, B: Serialize>(a: &A, b: &B) -> Map<String, Value> {
    let mut table = write(a);
    table.append(&mut write(b));
    table
}

/// A plain struct as a table.
pub(crate) fn write<T: Serialize>(settings: &T) -> Map<String, Value> {
    match serde_json::to_value(settings) {
        Ok(Value::Object(table)) => table,
        other => unreachable!("settings are plain structs with named fields, not {other:?}"),
    }
}

/// An error within a table of a table.
pub(crate) fn within(table: &str, error: SpecError) -> SpecError {
    let path = if error.path.is_empty() { table.to_owned() } else { format!("{table}.{}", error.path) };
    SpecError { path, ..error }
}

/// The body of a resolved walker task.
///
/// # Errors
/// A task without one; a resolved task has one.
pub(crate) fn walker_body(task: &Value) -> Result<BodyKind, SpecError> {
    let name = task.get("body").and_then(Value::as_str).unwrap_or_default();
    BodyKind::named(name).ok_or_else(|| SpecError::new("kind", "needs a task with a walker's body"))
}

//! What parameters of a fitness may be. Each check names the key and what is allowed (EF-4, EF-16).

use super::setup::SECONDS_MAX;
use crate::SpecError;

/// Within (0, most].
pub(super) fn positive(key: &str, value: f64, most: f64) -> Result<(), SpecError> {
    if value > 0.0 && value <= most {
        return Ok(());
    }
    Err(SpecError::new(key, format!("{value} is not within (0, {most}]")))
}

/// Within [0, most].
pub(super) fn within(key: &str, value: f64, most: f64) -> Result<(), SpecError> {
    if (0.0..=most).contains(&value) {
        return Ok(());
    }
    Err(SpecError::new(key, format!("{value} is not within [0, {most}]")))
}

/// Length of a trial, s: at least a tenth of a second, so that every window of it has a step.
pub(super) fn seconds(value: f64) -> Result<(), SpecError> {
    if (0.1..=SECONDS_MAX).contains(&value) {
        return Ok(());
    }
    Err(SpecError::new("seconds", format!("{value} is not within [0.1, {SECONDS_MAX}]")))
}

/// Of a light, m.
pub(super) fn distance(value: f64) -> Result<(), SpecError> {
    positive("distance", value, 1000.0)
}

/// At least one and at most a hundred, each within ±180°, and none that is refused for a reason.
pub(super) fn headings(values: &[f64], refused: Option<(f64, &str)>) -> Result<(), SpecError> {
    if values.is_empty() || values.len() > 100 {
        return Err(SpecError::new(
            "headings",
            format!("{} headings where 1 to 100 are legal", values.len()),
        ));
    }
    for (place, &value) in values.iter().enumerate() {
        let refuse = |problem| Err(SpecError::new(format!("headings[{place}]"), problem));
        if !(-180.0..=180.0).contains(&value) {
            return refuse(format!("{value} is not within [-180, 180]"));
        }
        if let Some((_, reason)) = refused.filter(|(at, _)| value.abs() == *at) {
            return refuse(format!("{value} is not legal: {reason}"));
        }
    }
    Ok(())
}

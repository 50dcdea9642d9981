//! Domain ↔ wire, both ways and bit for bit. What comes off the wire is checked here, once, and an error
//! names the field; nothing here knows who sent it or what becomes of it.

use crate::v1;
use bytes::Bytes;
use creatures::{Cull, Interim, Outcome, Reason, Status};
use std::fmt;

/// The most measures an outcome may carry.
pub const MEASURES_MAX: usize = 256;
/// The longest name of a measure, bytes.
pub const MEASURE_NAME_SIZE_MAX: usize = 128;
/// The longest note of an outcome and the longest reason of a failure, bytes.
pub const NOTE_SIZE_MAX: usize = 4 << 10;
/// The longest name of a system, bytes.
pub const SYSTEM_NAME_SIZE_MAX: usize = 64;
/// The longest spec of a task, bytes.
pub const SPEC_SIZE_MAX: usize = 1 << 20;

/// Why a message means nothing in the domain. Fields are named as in the .proto files, from the message
/// that was converted: `interim.measure`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ConvertError {
    /// A field that must be there is absent.
    #[error("`{field}` is missing")]
    Missing {
        /// The field.
        field: String,
    },
    /// A number outside of what is allowed.
    #[error("`{field}` is {found}, must be {allowed}")]
    Number {
        /// The field.
        field: String,
        /// Its value.
        found: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// An enum's number that this side does not know: the other side is newer, or broken.
    #[error("`{field}` has the unknown value {found}")]
    Unknown {
        /// The field.
        field: String,
        /// Its number.
        found: i32,
    },
    /// Over its size limit, in bytes or, for lists, in elements.
    #[error("`{field}` has the size {found}, the limit is {limit}")]
    TooLarge {
        /// The field.
        field: String,
        /// Its size.
        found: usize,
        /// The limit.
        limit: usize,
    },
    /// Bytes that are of a fixed length, and are not.
    #[error("`{field}` has {found} bytes, must have {expected}")]
    Length {
        /// The field.
        field: String,
        /// Its length in bytes.
        found: usize,
        /// The length that it must have.
        expected: usize,
    },
    /// A task's hash that is not the hash of the task.
    #[error("`{field}` is {found}, the task's is {computed}")]
    Hash {
        /// The field.
        field: String,
        /// As sent, in hexadecimal.
        found: String,
        /// As computed.
        computed: TaskHash,
    },
}

impl ConvertError {
    /// The same error seen from the message that holds the converted one in `place`.
    #[must_use]
    pub fn within(mut self, place: &str) -> Self {
        let (ConvertError::Missing { field }
        | ConvertError::Number { field, .. }
        | ConvertError::Unknown { field, .. }
        | ConvertError::TooLarge { field, .. }
        | ConvertError::Length { field, .. }
        | ConvertError::Hash { field, .. }) = &mut self;
        *field = format!("{place}.{field}");
        self
    }
}

/// A message that cannot be converted is its sender's mistake: INVALID_ARGUMENT, and the field in the text.
impl From<ConvertError> for tonic::Status {
    fn from(error: ConvertError) -> Self {
        tonic::Status::invalid_argument(error.to_string())
    }
}

fn missing(field: &str) -> ConvertError {
    ConvertError::Missing { field: field.to_owned() }
}

fn number(field: &str, found: f64, allowed: &'static str) -> ConvertError {
    ConvertError::Number { field: field.to_owned(), found, allowed }
}

fn within_size(field: &str, found: usize, limit: usize) -> Result<(), ConvertError> {
    if found <= limit {
        return Ok(());
    }
    Err(ConvertError::TooLarge { field: field.to_owned(), found, limit })
}

impl From<Status> for v1::Status {
    fn from(status: Status) -> Self {
        match status {
            Status::Completed => v1::Status::Completed,
            Status::Culled => v1::Status::Culled,
            Status::Aborted(Reason::NonFinite) => v1::Status::AbortedNonFinite,
            Status::Aborted(Reason::BlowUp) => v1::Status::AbortedBlowUp,
            Status::Aborted(Reason::SelfIntersecting) => v1::Status::AbortedSelfIntersecting,
            Status::Aborted(Reason::JointSeparation) => v1::Status::AbortedJointSeparation,
            Status::Aborted(Reason::Sinking) => v1::Status::AbortedSinking,
            Status::Aborted(Reason::EnergyFromNothing) => v1::Status::AbortedEnergyFromNothing,
            Status::Aborted(Reason::Unsettled) => v1::Status::AbortedUnsettled,
        }
    }
}

/// Fails for an unspecified status: proto3 gives it to a message that names none.
impl TryFrom<v1::Status> for Status {
    type Error = ConvertError;

    fn try_from(status: v1::Status) -> Result<Self, ConvertError> {
        match status {
            v1::Status::Unspecified => Err(missing("status")),
            v1::Status::Completed => Ok(Status::Completed),
            v1::Status::Culled => Ok(Status::Culled),
            v1::Status::AbortedNonFinite => Ok(Status::Aborted(Reason::NonFinite)),
            v1::Status::AbortedBlowUp => Ok(Status::Aborted(Reason::BlowUp)),
            v1::Status::AbortedSelfIntersecting => Ok(Status::Aborted(Reason::SelfIntersecting)),
            v1::Status::AbortedJointSeparation => Ok(Status::Aborted(Reason::JointSeparation)),
            v1::Status::AbortedSinking => Ok(Status::Aborted(Reason::Sinking)),
            v1::Status::AbortedEnergyFromNothing => Ok(Status::Aborted(Reason::EnergyFromNothing)),
            v1::Status::AbortedUnsettled => Ok(Status::Aborted(Reason::Unsettled)),
        }
    }
}

impl From<Interim> for v1::Interim {
    fn from(Interim { step, measure }: Interim) -> Self {
        v1::Interim { step, measure: Some(measure) }
    }
}

/// Fails without a measure. Any measure will do: each has a verdict, NaN passes.
impl TryFrom<v1::Interim> for Interim {
    type Error = ConvertError;

    fn try_from(v1::Interim { step, measure }: v1::Interim) -> Result<Self, ConvertError> {
        Ok(Interim { step, measure: measure.ok_or_else(|| missing("measure"))? })
    }
}

impl From<Cull> for v1::Cull {
    fn from(Cull { at, cutoff, control }: Cull) -> Self {
        v1::Cull { at, cutoff, control }
    }
}

/// Fails for a share outside of (0, 1) and for a cutoff that is NaN, below which nothing is.
impl TryFrom<v1::Cull> for Cull {
    type Error = ConvertError;

    fn try_from(v1::Cull { at, cutoff, control }: v1::Cull) -> Result<Self, ConvertError> {
        if !(at > 0.0 && at < 1.0) {
            return Err(number("at", at, "within (0, 1)"));
        }
        if let Some(cutoff) = cutoff.filter(|cutoff| cutoff.is_nan()) {
            return Err(number("cutoff", cutoff, "a number"));
        }
        Ok(Cull { at, cutoff, control })
    }
}

impl From<Outcome> for v1::Outcome {
    fn from(outcome: Outcome) -> Self {
        let measures = outcome.measures.into_iter();
        v1::Outcome {
            status: v1::Status::from(outcome.status).into(),
            fitness: Some(outcome.fitness),
            steps: outcome.steps,
            measures: measures.map(|(name, value)| v1::Measure { name, value: Some(value) }).collect(),
            interim: outcome.interim.map(Into::into),
            note: outcome.note,
        }
    }
}

/// Fails for an unknown status and a missing number, and where the outcome is not [`admissible`].
impl TryFrom<v1::Outcome> for Outcome {
    type Error = ConvertError;

    fn try_from(outcome: v1::Outcome) -> Result<Self, ConvertError> {
        let status = v1::Status::try_from(outcome.status)
            .map_err(|_| ConvertError::Unknown { field: "status".to_owned(), found: outcome.status })?;
        let measures =
            outcome.measures.into_iter().enumerate().map(|(index, v1::Measure { name, value })| {
                value.map(|value| (name, value)).ok_or_else(|| missing(&format!("measures[{index}].value")))
            });
        let interim = outcome.interim.map(Interim::try_from).transpose();
        let outcome = Outcome {
            status: status.try_into()?,
            fitness: outcome.fitness.ok_or_else(|| missing("fitness"))?,
            steps: outcome.steps,
            measures: measures.collect::<Result<_, _>>()?,
            interim: interim.map_err(|error| error.within("interim"))?,
            note: outcome.note,
        };
        admissible(&outcome)?;
        Ok(outcome)
    }
}

/// Whether an outcome may travel: a completed one has a finite fitness, any other the fitness 0, and its
/// texts and measures are within their limits. A worker asks before it sends, a coordinator gets no other.
///
/// # Errors
/// The field, as [`Outcome::try_from`] would name it.
pub fn admissible(outcome: &Outcome) -> Result<(), ConvertError> {
    let fitness = outcome.fitness;
    match outcome.status {
        Status::Completed if !fitness.is_finite() => {
            return Err(number("fitness", fitness, "finite in a completed outcome"));
        }
        Status::Culled | Status::Aborted(_) if fitness != 0.0 => {
            return Err(number("fitness", fitness, "0 unless completed"));
        }
        _ => {}
    }
    within_size("note", outcome.note.len(), NOTE_SIZE_MAX)?;
    within_size("measures", outcome.measures.len(), MEASURES_MAX)?;
    for (index, (name, _)) in outcome.measures.iter().enumerate() {
        within_size("name", name.len(), MEASURE_NAME_SIZE_MAX)
            .map_err(|error| error.within(&format!("measures[{index}]")))?;
    }
    Ok(())
}

/// A task's name on the wire: the first 16 bytes of BLAKE3 over its system, version and spec.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TaskHash(pub [u8; 16]);

/// The name of a task. `spec` is the JSON text of the resolved `[task]` table.
pub fn task_hash(system: &str, version: u32, spec: &str) -> TaskHash {
    let mut hasher = blake3::Hasher::new();
    for text in [system, spec] {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    }
    hasher.update(&version.to_le_bytes());
    let mut hash = [0; 16];
    hash.copy_from_slice(&hasher.finalize().as_bytes()[..16]);
    TaskHash(hash)
}

impl fmt::Display for TaskHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl From<TaskHash> for Bytes {
    fn from(hash: TaskHash) -> Self {
        Bytes::copy_from_slice(&hash.0)
    }
}

/// An assignment's `task`. Fails unless it is 16 bytes.
impl TryFrom<&Bytes> for TaskHash {
    type Error = ConvertError;

    fn try_from(bytes: &Bytes) -> Result<Self, ConvertError> {
        bytes[..].try_into().map(TaskHash).map_err(|_| ConvertError::Length {
            field: "task".to_owned(),
            found: bytes.len(),
            expected: 16,
        })
    }
}

impl v1::Task {
    /// The message that makes a task known.
    pub fn named(system: &str, version: u32, spec: &str) -> Self {
        let hash = task_hash(system, version, spec).into();
        v1::Task { hash, system: system.to_owned(), version, spec: spec.to_owned() }
    }

    /// The hash of a task off the wire, once its sizes are within their limits and its own word for the
    /// hash, unless left empty, agrees.
    ///
    /// # Errors
    /// The field that is too large, or both hashes.
    pub fn verified(&self) -> Result<TaskHash, ConvertError> {
        within_size("system", self.system.len(), SYSTEM_NAME_SIZE_MAX)?;
        within_size("spec", self.spec.len(), SPEC_SIZE_MAX)?;
        let computed = task_hash(&self.system, self.version, &self.spec);
        if self.hash.is_empty() || self.hash[..] == computed.0 {
            return Ok(computed);
        }
        let found = self.hash.iter().take(32).map(|byte| format!("{byte:02x}")).collect();
        Err(ConvertError::Hash { field: "hash".to_owned(), found, computed })
    }
}

#[cfg(test)]
mod tests;

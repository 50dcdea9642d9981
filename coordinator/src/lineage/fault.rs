//! What SQLite's refusals mean for us: the one table from result code to consequence.

use super::ReadError;
use libsqlite3_sys as ffi;

/// What can be done about a refusal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// A row contradicts another: a fault in this program.
    Contradiction,
    /// Pages that make no sense: time does not mend it.
    Damaged,
    /// The file or its folder may not be written.
    Unwritable,
    /// Something that passes, or that people can mend: a full disk, a lock, an unplugged disk.
    Passing,
}

/// What a refusal means.
pub(crate) fn fault(error: &sqlx::Error) -> Fault {
    match code(error) {
        Some(ffi::SQLITE_CONSTRAINT | ffi::SQLITE_MISMATCH) => Fault::Contradiction,
        Some(ffi::SQLITE_CORRUPT | ffi::SQLITE_NOTADB) => Fault::Damaged,
        Some(ffi::SQLITE_READONLY | ffi::SQLITE_PERM) => Fault::Unwritable,
        _ => Fault::Passing,
    }
}

/// SQLite's primary result code.
pub(crate) fn code(error: &sqlx::Error) -> Option<i32> {
    let extended: i32 = error.as_database_error()?.code()?.parse().ok()?;
    Some(extended & 0xff)
}

/// A refusal in words for people.
pub(crate) fn words(error: &sqlx::Error) -> String {
    match code(error) {
        Some(ffi::SQLITE_FULL) => "the disk is full".to_owned(),
        Some(ffi::SQLITE_READONLY | ffi::SQLITE_PERM) => "the file may not be written".to_owned(),
        Some(ffi::SQLITE_BUSY | ffi::SQLITE_LOCKED) => "another program holds it locked".to_owned(),
        Some(ffi::SQLITE_CORRUPT | ffi::SQLITE_NOTADB) => format!("the file is damaged: {error}"),
        _ => error.to_string(),
    }
}

impl From<sqlx::Error> for ReadError {
    fn from(error: sqlx::Error) -> Self {
        match fault(&error) {
            Fault::Damaged => ReadError::Corrupt { problem: words(&error) },
            _ => ReadError::Unavailable(error),
        }
    }
}

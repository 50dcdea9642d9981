//! Why the lineage could not be opened, written or read: one enum each, variants by what the caller can do.

use std::path::PathBuf;

/// Why a file does not open as a lineage.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Another coordinator writes it: stop that one, or take another file.
    #[error("{path}: in use by another coordinator ({holder})")]
    Held {
        /// The database.
        path: PathBuf,
        /// What the lock file says of the holder.
        holder: String,
    },
    /// There is no such file.
    #[error("{path}: no such file")]
    Missing {
        /// The database.
        path: PathBuf,
    },
    /// Some other file; it is left as it is.
    #[error("{path}: not a lineage ({found})")]
    Foreign {
        /// The database.
        path: PathBuf,
        /// What it seems to be.
        found: String,
    },
    /// Written by a newer program; it is left as it is. Upgrade this one.
    #[error(
        "{path}: lineage schema {found} is newer than {known}, the newest that this program knows: upgrade it"
    )]
    Newer {
        /// The database.
        path: PathBuf,
        /// The file's schema version.
        found: i64,
        /// The newest known one.
        known: i64,
    },
    /// Written by an older program. Only a coordinator may bring it up to date.
    #[error(
        "{path}: lineage schema {found} is older than {known}: open it once with `hatchery-coordinator` or `hatchery run`"
    )]
    Older {
        /// The database.
        path: PathBuf,
        /// The file's schema version.
        found: i64,
        /// The version that this program reads.
        known: i64,
    },
    /// Its pages do not make sense. Restore a copy; `sqlite3 FILE .recover` may save some of it.
    #[error("{path}: the file is damaged: {problem}")]
    Corrupt {
        /// The database.
        path: PathBuf,
        /// SQLite's words.
        problem: String,
    },
    /// It, or its folder, may not be written.
    #[error("{path}: may not be written: {problem}")]
    ReadOnly {
        /// The database.
        path: PathBuf,
        /// The system's words.
        problem: String,
    },
    /// The disk or the system refused.
    #[error("{path}: {problem}")]
    Unavailable {
        /// The database.
        path: PathBuf,
        /// The system's words.
        problem: String,
    },
}

/// Why something was not written. A full disk or a read-only file is no error here: the writer waits until
/// that is mended, and says so in its [`Health`](super::Health).
#[derive(Debug, Clone, thiserror::Error)]
pub enum WriteError {
    /// The lineage was closed, or can never be written again.
    #[error("the lineage is closed: {reason}")]
    Closed {
        /// Why.
        reason: String,
    },
    /// It contradicts what stands in the lineage already: a fault of the caller. Nothing was written.
    #[error("the lineage refused to {what}: {problem}")]
    Contradiction {
        /// What was asked for.
        what: String,
        /// What it collides with.
        problem: String,
    },
}

/// Why something could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// A reference that names nothing.
    #[error("{what} `{reference}` is not in this lineage")]
    NotFound {
        /// `experiment`, `individual`, …
        what: &'static str,
        /// As it was asked for.
        reference: String,
    },
    /// A reference that names several, where one is wanted.
    #[error("`{reference}` names {} experiments: {}", names.len(), names.join(", "))]
    Ambiguous {
        /// As it was asked for.
        reference: String,
        /// What it could mean.
        names: Vec<String>,
    },
    /// What is stored does not make sense.
    #[error("the lineage is damaged: {problem}")]
    Corrupt {
        /// Where, and what is wrong.
        problem: String,
    },
    /// SQLite refused, for the moment.
    #[error("the lineage could not be read")]
    Unavailable(#[source] sqlx::Error),
}

/// Why a user's SQL was refused or stopped.
#[derive(Debug, thiserror::Error)]
pub enum QueryError {
    /// It does not parse, or names what is not there.
    #[error("{0}")]
    Malformed(String),
    /// It would write, attach, or call what is not allowed.
    #[error("{0}")]
    Forbidden(String),
    /// Over the row, byte or time limit.
    #[error("{0}")]
    TooMuch(String),
    /// The lineage itself could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
}

//! The database file: who may write it, what it must be, and how it is opened. It refuses what is no lineage,
//! or a newer one, without touching it.
//!
//! **Whoever closes any descriptor of a file ends all POSIX locks of his process on it.** SQLite's are such locks:
//! without them the next program that opens the database takes itself for the only one, and deletes the write-ahead log
//! when it closes. So nothing here opens the file beside SQLite once SQLite has it open, nor may anybody else.

use super::OpenError;
use super::fault::{Fault, fault};
use super::sql::sql;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqliteSynchronous};
use sqlx::{ConnectOptions as _, Connection as _, Executor as _};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::os::unix::fs::{FileExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// `HATC`, in the file's header.
const APPLICATION_ID: u32 = u32::from_be_bytes(*b"HATC");

/// The schema, in the order in which it grew: a file of version n has seen the first n.
const MIGRATIONS: [&str; 3] = [
    include_str!("../../../migrations/0001_tables.sql"),
    include_str!("../../../migrations/0002_views.sql"),
    include_str!("../../../migrations/0003_audits.sql"),
];

/// The schema version that this program reads and writes.
pub(crate) const SCHEMA: i64 = MIGRATIONS.len() as i64;

/// A tenth of a million individuals' rows, pages of which the writer keeps in memory, KiB.
const CACHE_KIB: u32 = 64 << 10;

/// The right to write a file, as long as this lives: as long as SQLite has it open. The operating system takes it back
/// from a process that dies, so that nobody has to clean up after a kill.
pub(crate) struct Lock {
    _beside: File,
    path: PathBuf,
    database: File,
}

impl Lock {
    /// Takes the lock of a database: `FILE-lock`, beside it, which says who holds it; and one on the file itself,
    /// which it makes if need be, since a file may have several names.
    pub(crate) fn take(database: &Path) -> Result<Lock, OpenError> {
        let named = std::fs::canonicalize(database).unwrap_or_else(|_| database.to_owned());
        let path = beside(&named, "-lock");
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(|error| refused(database, &error))?;
        match lock(&file) {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                let _ = file.read_to_string(&mut holder); // for the message alone
                return Err(OpenError::Held { path: database.to_owned(), holder: holder.trim().to_owned() });
            }
            Err(TryLockError::Error(error)) => return Err(refused(database, &error)),
        }
        let host = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let host = if host.trim().is_empty() { String::new() } else { format!(" on {}", host.trim()) };
        file.set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| writeln!(file, "process {}{host}", std::process::id()))
            .map_err(|error| refused(database, &error))?;
        let itself = match File::open(database) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => File::create_new(database),
            opened => opened,
        };
        let itself = itself.map_err(|error| refused(database, &error))?;
        match lock(&itself) {
            // A file system without such locks has the one beside it all the same.
            Ok(()) | Err(TryLockError::Error(_)) => {
                Ok(Lock { _beside: file, path: database.to_owned(), database: itself })
            }
            Err(TryLockError::WouldBlock) => {
                let holder = "a process that knows it by another name".to_owned();
                Err(OpenError::Held { path: database.to_owned(), holder })
            }
        }
    }

    /// What stands in the file, by its first bytes.
    pub(crate) fn look(&self) -> Result<Found, OpenError> {
        let mut header = [0; HEADER_SIZE];
        let read = self.database.read_at(&mut header, 0).map_err(|error| refused(&self.path, &error))?;
        recognised(&header[..read], &self.path)
    }

    /// Which files stand at the path and, as its write-ahead log, beside it.
    ///
    /// # Errors
    /// One is missing, or the path leads to another file than the one that is locked.
    pub(crate) fn files(&self) -> io::Result<Files> {
        let at = |path: &Path| {
            let found = std::fs::metadata(path);
            found.map_err(|error| io::Error::other(format!("{}: {error}", path.display())))
        };
        let (here, held) = (at(&self.path)?, self.database.metadata()?);
        if (here.dev(), here.ino()) != (held.dev(), held.ino()) {
            return Err(io::Error::other(format!(
                "{} has been replaced by another file",
                self.path.display()
            )));
        }
        let log = at(&beside(&self.path, "-wal"))?;
        Ok(Files { log: (log.dev(), log.ino()) })
    }
}

/// See [`Lock::files`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Files {
    log: (u64, u64),
}

/// Locks a file. Who asks whether it is locked has it for a moment: that is waited for.
fn lock(file: &File) -> Result<(), TryLockError> {
    for _ in 0..5 {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(10)),
            other => return other,
        }
    }
    file.try_lock()
}

/// Whether somebody has the right to write a lineage, and so is at work on it.
///
/// Not for a process that has the file open already: closing a file here ends all locks of SQLite on it.
pub fn is_at_work(database: &Path) -> bool {
    let named = std::fs::canonicalize(database).unwrap_or_else(|_| database.to_owned());
    let is_locked = |path: &Path| {
        File::open(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    };
    is_locked(&beside(&named, "-lock")) || is_locked(&named)
}

/// What stands at a path.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// Nothing, or an empty file.
    Nothing,
    /// A database without marks: a lineage that was not finished making, or another program's.
    Unmarked,
    /// A lineage of a schema version that is not newer than ours.
    Lineage,
}

/// SQLite's, bytes.
const HEADER_SIZE: usize = 100;

/// Looks at the first bytes of a file, and at nothing else. Not once this process has it open.
pub(crate) fn look(path: &Path) -> Result<Found, OpenError> {
    let mut header = Vec::new();
    match File::open(path).and_then(|file| file.take(HEADER_SIZE as u64).read_to_end(&mut header)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Found::Nothing),
        Err(error) => Err(refused(path, &error)),
        Ok(_) => recognised(&header, path),
    }
}

fn recognised(header: &[u8], path: &Path) -> Result<Found, OpenError> {
    if header.is_empty() {
        return Ok(Found::Nothing);
    }
    if header.len() < HEADER_SIZE || !header.starts_with(b"SQLite format 3\0") {
        return Err(foreign(path, "not an SQLite database"));
    }
    let word =
        |at: usize| u32::from_be_bytes(header[at..at + 4].try_into().expect("four bytes of a hundred"));
    // Offsets of the database header: user_version 60, application_id 68.
    // A coordinator killed while it made the file leaves pages that no schema has marked yet: whether they are
    // empty is for `migrate` to see.
    if word(68) == 0 && word(60) == 0 {
        return Ok(Found::Unmarked);
    }
    if word(68) != APPLICATION_ID {
        return Err(foreign(path, "an SQLite database of another program"));
    }
    check_version(path, i64::from(word(60))).map(|()| Found::Lineage)
}

pub(crate) fn foreign(path: &Path, found: &str) -> OpenError {
    OpenError::Foreign { path: path.to_owned(), found: found.to_owned() }
}

fn check_version(path: &Path, found: i64) -> Result<(), OpenError> {
    if found > SCHEMA {
        return Err(OpenError::Newer { path: path.to_owned(), found, known: SCHEMA });
    }
    Ok(())
}

/// How the one writer opens its file.
pub(crate) fn writing(path: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(path)
        .create_if_missing(true)
        .page_size(16 << 10)
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Full)
        .busy_timeout(Duration::from_secs(1))
        .statement_cache_capacity(256)
        .thread_name(|_| "lineage".to_owned())
        .pragma("cache_size", format!("-{CACHE_KIB}"))
        // Checkpoints are made beside the writer: see `checkpoint.rs`.
        .pragma("wal_autocheckpoint", "0")
        .pragma("journal_size_limit", (64 << 20).to_string())
        .disable_statement_logging()
}

/// How readers open it. `immutable` is for a file that nobody writes, in a folder that may not be written.
pub(crate) fn reading(path: &Path, immutable: bool) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(path)
        .read_only(true)
        .immutable(immutable)
        .busy_timeout(Duration::from_secs(5))
        .thread_name(|_| "lineage-reader".to_owned())
        .pragma("query_only", "1")
        .disable_statement_logging()
}

/// Brings an open file up to date: creates everything in an empty one.
pub(crate) async fn migrate(connection: &mut SqliteConnection, lock: &Lock) -> Result<(), OpenError> {
    let path = &lock.path;
    let refused = |error: sqlx::Error| refused_by_sqlite(path, &error);
    let version = schema_version(connection).await.map_err(refused)?;
    check_version(path, version)?;
    if version == SCHEMA {
        // A coordinator that was killed here may have left the marks in the log.
        if lock.look()? == Found::Unmarked {
            connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").await.map_err(refused)?;
        }
        return Ok(());
    }
    let mut transaction = connection.begin_with("BEGIN IMMEDIATE").await.map_err(refused)?;
    let seen = usize::try_from(version).unwrap_or(0);
    for migration in &MIGRATIONS[seen..] {
        transaction.execute(sqlx::raw_sql(*migration)).await.map_err(refused)?;
    }
    let marks = format!("PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {SCHEMA};");
    transaction.execute(sqlx::raw_sql(sqlx::AssertSqlSafe(marks))).await.map_err(refused)?;
    transaction.commit().await.map_err(refused)?;
    // The marks belong in the main file before anybody looks at its first bytes.
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").await.map_err(refused)?;
    Ok(())
}

/// Looks into a database without marks, and writes nothing: only one that is empty, or whose marks are still
/// in its write-ahead log, is a lineage that a killed coordinator did not finish making.
pub(crate) async fn recognise(path: &Path) -> Result<(), OpenError> {
    let refused = |error: sqlx::Error| refused_by_sqlite(path, &error);
    let mut connection = reading(path, false).connect().await.map_err(refused)?;
    let ours = schema_version(&mut connection).await.map_err(refused)? == SCHEMA;
    let empty: bool =
        sqlx::query_scalar(sql!("is_empty")).fetch_one(&mut connection).await.map_err(refused)?;
    connection.close().await.map_err(refused)?;
    if ours || empty { Ok(()) } else { Err(foreign(path, "an SQLite database of another program")) }
}

/// The version in an open file; 0 in an empty one.
pub(crate) async fn schema_version(connection: &mut SqliteConnection) -> Result<i64, sqlx::Error> {
    sqlx::query_scalar("PRAGMA user_version").fetch_one(connection).await
}

/// `FILE` with a suffix.
pub(crate) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

fn refused(path: &Path, error: &io::Error) -> OpenError {
    let (path, problem) = (path.to_owned(), error.to_string());
    match error.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            OpenError::ReadOnly { path, problem }
        }
        _ => OpenError::Unavailable { path, problem },
    }
}

/// SQLite's refusal, as what the caller can do about it.
pub(crate) fn refused_by_sqlite(path: &Path, error: &sqlx::Error) -> OpenError {
    let (path, problem) = (path.to_owned(), error.to_string());
    match fault(error) {
        Fault::Damaged => OpenError::Corrupt { path, problem },
        Fault::Unwritable => OpenError::ReadOnly { path, problem },
        _ => OpenError::Unavailable { path, problem },
    }
}

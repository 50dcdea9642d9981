//! The walls around users' SQL: what SQLite itself can be told to refuse. The one place that calls SQLite's C
//! interface. It keeps no state of its own: a connection that was confined stays so until it is closed.
#![allow(unsafe_code, reason = "sqlx has no call for limits, the authorizer, or the end of a statement")]

use libsqlite3_sys as ffi;
use sqlx::sqlite::LockedSqliteHandle;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Text of a statement, bytes.
const SQL_MAX: usize = 64 << 10;

/// Limits of a connection for users, and why.
const LIMITS: [(c_int, c_int); 8] = [
    (ffi::SQLITE_LIMIT_ATTACHED, 0),     // no other file
    (ffi::SQLITE_LIMIT_LENGTH, 4 << 20), // of one value or row, bytes: genotypes have 1 MiB at most
    (ffi::SQLITE_LIMIT_SQL_LENGTH, SQL_MAX as c_int),
    (ffi::SQLITE_LIMIT_COLUMN, 100),     // a row is held whole
    (ffi::SQLITE_LIMIT_EXPR_DEPTH, 200), // the C stack
    (ffi::SQLITE_LIMIT_COMPOUND_SELECT, 50),
    (ffi::SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 1000), // matching is quadratic
    (ffi::SQLITE_LIMIT_WORKER_THREADS, 0),         // a question has one core at most
];

/// Instructions of SQLite's machine between two looks at the clock: about a millisecond.
const LOOK: i32 = 20_000;

/// What the walls of one connection have seen.
#[derive(Debug, Clone)]
pub(super) struct Sandbox {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    until: Instant,
    abandoned: Arc<AtomicBool>,
    forbidden: Mutex<Option<String>>,
}

impl Sandbox {
    /// Walls for so long, or until the question is abandoned.
    pub(super) fn new(time: Duration, abandoned: Arc<AtomicBool>) -> Sandbox {
        let now = Instant::now();
        let until = now.checked_add(time).unwrap_or(now + Duration::from_secs(1 << 30));
        Sandbox { shared: Arc::new(Shared { until, abandoned, forbidden: Mutex::default() }) }
    }

    /// What was tried first that is not allowed: `write to outcome`.
    pub(super) fn forbidden(&self) -> Option<String> {
        self.shared.forbidden.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Puts the walls up.
pub(super) fn confine(handle: &mut LockedSqliteHandle<'_>, sandbox: Sandbox) {
    let seen = Arc::as_ptr(&sandbox.shared);
    let database = handle.as_raw_handle().as_ptr();
    // SAFETY: the handle is locked, so nothing else uses the connection. `seen` lives as long as the
    // connection, since the progress handler set below owns a share of it and is dropped with it.
    unsafe {
        for (limit, value) in LIMITS {
            ffi::sqlite3_limit(database, limit, value);
        }
        ffi::sqlite3_set_authorizer(database, Some(authorize), seen.cast_mut().cast());
    }
    handle.set_progress_handler(LOOK, move || {
        let shared = &sandbox.shared;
        Instant::now() < shared.until && !shared.abandoned.load(Ordering::Relaxed)
    });
}

/// Checks that a text is one statement that reads, and nothing behind it.
///
/// # Errors
/// SQLite's result code and words.
pub(super) fn examine(handle: &mut LockedSqliteHandle<'_>, sql: &str) -> Result<(), (i32, String)> {
    if sql.len() > SQL_MAX {
        return Err((ffi::SQLITE_TOOBIG, format!("a statement of more than {SQL_MAX} bytes")));
    }
    if sql.contains('\0') {
        return Err((ffi::SQLITE_ERROR, "a statement with a NUL character".to_owned()));
    }
    let mut rest = sql;
    let mut statements = 0;
    while !rest.is_empty() {
        let prepared = prepare(handle, rest)?;
        rest = &rest[rest.len() - prepared.rest..];
        statements += usize::from(prepared.is_statement);
        if statements > 1 {
            return Err((ffi::SQLITE_ERROR, "more than one statement".to_owned()));
        }
    }
    if statements == 0 {
        return Err((ffi::SQLITE_ERROR, "no statement".to_owned()));
    }
    Ok(())
}

struct Prepared {
    is_statement: bool, // else blanks and comments alone
    rest: usize,        // bytes behind it
}

fn prepare(handle: &mut LockedSqliteHandle<'_>, sql: &str) -> Result<Prepared, (i32, String)> {
    let database = handle.as_raw_handle().as_ptr();
    let length = c_int::try_from(sql.len()).expect("no longer than SQL_MAX");
    let mut statement = std::ptr::null_mut();
    let mut tail = std::ptr::null();
    // SAFETY: the handle is locked, so nothing else uses the connection. SQLite reads `length` bytes at most
    // and leaves `tail` within them, or untouched. A statement is finalised before anything else; NULL may be.
    unsafe {
        let start = sql.as_ptr().cast::<c_char>();
        let code = ffi::sqlite3_prepare_v2(database, start, length, &raw mut statement, &raw mut tail);
        if code != ffi::SQLITE_OK {
            let message = CStr::from_ptr(ffi::sqlite3_errmsg(database)).to_string_lossy().into_owned();
            ffi::sqlite3_finalize(statement);
            return Err((code & 0xff, message));
        }
        let is_statement = !statement.is_null();
        ffi::sqlite3_finalize(statement);
        let read = if tail.is_null() { sql.len() } else { tail.offset_from_unsigned(start) };
        // Whatever it read, we get on.
        let read = if sql.is_char_boundary(read) { read.max(1) } else { sql.len() };
        Ok(Prepared { is_statement, rest: sql.len() - read.min(sql.len()) })
    }
}

/// SQLite asks this of everything that a statement would do.
unsafe extern "C" fn authorize(
    seen: *mut c_void,
    action: c_int,
    first: *const c_char,
    second: *const c_char,
    _database: *const c_char,
    _view: *const c_char,
) -> c_int {
    // SAFETY: SQLite gives NUL-terminated text or NULL, alive during the call; `seen` is the one of `confine`.
    let (first, second, shared) = unsafe { (text(first), text(second), &*seen.cast::<Shared>()) };
    let what = match action {
        ffi::SQLITE_SELECT | ffi::SQLITE_READ | ffi::SQLITE_RECURSIVE => return ffi::SQLITE_OK,
        // Of the functions that are built in, these reach beyond the database.
        ffi::SQLITE_FUNCTION if !matches!(second.as_str(), "load_extension" | "fts3_tokenizer") => {
            return ffi::SQLITE_OK;
        }
        ffi::SQLITE_FUNCTION => format!("call {second}"),
        ffi::SQLITE_INSERT | ffi::SQLITE_UPDATE | ffi::SQLITE_DELETE => format!("write to {first}"),
        ffi::SQLITE_ATTACH | ffi::SQLITE_DETACH => "attach another database".to_owned(),
        ffi::SQLITE_PRAGMA => format!("use PRAGMA {first}"),
        ffi::SQLITE_TRANSACTION | ffi::SQLITE_SAVEPOINT => "hold a transaction".to_owned(),
        ffi::SQLITE_ANALYZE | ffi::SQLITE_REINDEX => "write to the database".to_owned(),
        _ => "change the schema".to_owned(),
    };
    shared.forbidden.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(what);
    ffi::SQLITE_DENY
}

/// # Safety
/// `text` is NUL-terminated, or NULL.
unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

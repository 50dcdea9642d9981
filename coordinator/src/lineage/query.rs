//! Users' SQL: one SELECT, on a connection of its own that can do nothing else, within limits of rows, bytes
//! and time. It never trusts the text.

use super::fault::{Fault, code, fault};
use super::sandbox::{Sandbox, confine, examine};
use super::sql::sql;
use super::summary::id_list;
use super::{ExperimentId, QueryError, ReadError, Reader};
use libsqlite3_sys as ffi;
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{AssertSqlSafe, ConnectOptions as _, Executor as _, Row as _, SqlStr, Statement as _};
use sqlx::{Column as _, SqlSafeStr as _, TypeInfo as _, ValueRef as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio_stream::StreamExt as _;

/// The documented views: the public interface of the file.
pub const VIEWS: [&str; 16] = [
    "v_experiments",
    "v_stages",
    "v_generations",
    "v_individuals",
    "v_parents",
    "v_evaluations",
    "v_culls",
    "v_best",
    "v_ancestors",
    "v_species",
    "v_workers",
    "v_checkpoints",
    "v_candidates",
    "v_picks",
    "v_audits",
    "v_events",
];

/// How much a question may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Rows answered.
    pub rows: u64,
    /// Bytes answered, as they are held here.
    pub bytes: u64,
    /// From its turn to its last row.
    pub time: Duration,
}

/// One value of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// No value.
    Null,
    /// A 64-bit integer.
    Integer(i64),
    /// A number.
    Real(f64),
    /// Text; bytes that are no UTF-8 are replaced.
    Text(String),
    /// Bytes.
    Blob(Vec<u8>),
}

/// The answer to a question, as it comes. When it is dropped, the question is stopped.
#[derive(Debug)]
pub struct Answer {
    /// Their names, in order.
    pub columns: Vec<String>,
    chunks: mpsc::Receiver<Result<Vec<Vec<Cell>>, QueryError>>,
    abandoned: Arc<AtomicBool>,
}

impl Answer {
    /// The next rows: some, or `None` after the last.
    ///
    /// # Errors
    /// [`QueryError::TooMuch`] once a limit is reached; nothing follows.
    pub async fn next(&mut self) -> Option<Result<Vec<Vec<Cell>>, QueryError>> {
        self.chunks.recv().await
    }

    /// As [`Answer::next`], for those who are polled themselves.
    pub fn poll_next(
        &mut self,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Vec<Vec<Cell>>, QueryError>>> {
        self.chunks.poll_recv(context)
    }
}

impl Drop for Answer {
    fn drop(&mut self) {
        self.abandoned.store(true, Ordering::Relaxed);
    }
}

/// Rows and bytes of one chunk, about.
const CHUNK: (usize, usize) = (256, 256 << 10);

impl Reader {
    /// Answers a user's SELECT.
    ///
    /// # Errors
    /// See [`QueryError`].
    pub async fn query(&self, sql: &str, limits: Limits) -> Result<Answer, QueryError> {
        self.ask(sql.to_owned(), None, limits).await
    }

    /// All rows of one of the documented [`VIEWS`], or those of some experiments. Workers belong to none.
    ///
    /// # Errors
    /// See [`QueryError`].
    pub async fn view(
        &self,
        name: &str,
        of: Option<&[ExperimentId]>,
        limits: Limits,
    ) -> Result<Answer, QueryError> {
        if !VIEWS.contains(&name) {
            let known = VIEWS.join(", ");
            return Err(QueryError::Malformed(format!("no view `{name}`; the views are {known}")));
        }
        let of = of.filter(|_| name != "v_workers");
        let template = if of.is_some() { sql!("view_of_experiments") } else { sql!("view") };
        self.ask(template.replace("{view}", name), of.map(id_list), limits).await
    }

    async fn ask(&self, sql: String, bound: Option<String>, limits: Limits) -> Result<Answer, QueryError> {
        let turn = self.turn().await;
        let mut connection =
            self.options().clone().row_buffer_size(1).connect().await.map_err(ReadError::from)?;
        let abandoned = Arc::new(AtomicBool::new(false));
        let sandbox = Sandbox::new(limits.time, abandoned.clone());
        let examined = {
            let mut handle = connection.lock_handle().await.map_err(ReadError::from)?;
            confine(&mut handle, sandbox.clone());
            examine(&mut handle, &sql)
        };
        examined.map_err(|(code, message)| explain(code, message, &sandbox, limits))?;
        let sql = AssertSqlSafe(sql).into_sql_str(); // what it may do is settled above
        let statement = connection.prepare(sql).await.map_err(|error| refuse(error, &sandbox, limits))?;
        let columns = statement.columns().iter().map(|column| column.name().to_owned()).collect();
        let sql = statement.into_sql();
        let (rows, chunks) = mpsc::channel(1);
        tokio::spawn(async move {
            if let Err(error) = answer(connection, sql, bound, limits, &sandbox, &rows).await {
                let _ = rows.send(Err(error)).await; // unless nobody listens any more
            }
            drop(turn);
        });
        Ok(Answer { columns, chunks, abandoned })
    }
}

async fn answer(
    mut connection: SqliteConnection,
    sql: SqlStr,
    bound: Option<String>,
    limits: Limits,
    sandbox: &Sandbox,
    out: &mpsc::Sender<Result<Vec<Vec<Cell>>, QueryError>>,
) -> Result<(), QueryError> {
    let mut query = sqlx::query(sql).persistent(false);
    if let Some(bound) = bound {
        query = query.bind(bound);
    }
    let mut stream = connection.fetch(query);
    let (mut rows, mut bytes) = (0, 0);
    let (mut chunk, mut chunk_bytes) = (Vec::new(), 0);
    while let Some(row) = stream.next().await {
        let cells = cells(&row.map_err(|error| refuse(error, sandbox, limits))?)?;
        let size: usize = cells.iter().map(size).sum();
        rows += 1;
        bytes += size as u64;
        let over = if rows > limits.rows {
            Some(format!("more than {} rows: add a LIMIT or a condition", limits.rows))
        } else if bytes > limits.bytes {
            Some(format!("more than {} bytes: ask for fewer rows or columns", limits.bytes))
        } else {
            None
        };
        if over.is_none() {
            chunk.push(cells);
            chunk_bytes += size;
        }
        if over.is_some() || chunk.len() >= CHUNK.0 || chunk_bytes >= CHUNK.1 {
            chunk_bytes = 0;
            if out.send(Ok(std::mem::take(&mut chunk))).await.is_err() {
                return Ok(());
            }
        }
        if let Some(over) = over {
            return Err(QueryError::TooMuch(over));
        }
    }
    if !chunk.is_empty() {
        let _ = out.send(Ok(chunk)).await; // unless nobody listens any more
    }
    Ok(())
}

fn cells(row: &SqliteRow) -> Result<Vec<Cell>, QueryError> {
    (0..row.len()).map(|at| cell(row, at).map_err(|error| ReadError::from(error).into())).collect()
}

fn cell(row: &SqliteRow, at: usize) -> Result<Cell, sqlx::Error> {
    let value = row.try_get_raw(at)?;
    if value.is_null() {
        return Ok(Cell::Null);
    }
    // The type of the value, whatever its column declares.
    let kind = value.type_info().name().to_owned();
    Ok(match kind.as_str() {
        "INTEGER" => Cell::Integer(row.try_get_unchecked(at)?),
        "REAL" => Cell::Real(row.try_get_unchecked(at)?),
        "BLOB" => Cell::Blob(row.try_get_unchecked(at)?),
        _ => {
            let bytes: Vec<u8> = row.try_get_unchecked(at)?;
            Cell::Text(String::from_utf8_lossy(&bytes).into_owned())
        }
    })
}

fn size(cell: &Cell) -> usize {
    8 + match cell {
        Cell::Text(text) => text.len(),
        Cell::Blob(bytes) => bytes.len(),
        _ => 0,
    }
}

fn refuse(error: sqlx::Error, sandbox: &Sandbox, limits: Limits) -> QueryError {
    match (fault(&error), code(&error), error.as_database_error()) {
        (Fault::Damaged, ..) => ReadError::from(error).into(),
        (_, Some(code), Some(refused)) => explain(code, refused.message().to_owned(), sandbox, limits),
        _ => ReadError::from(error).into(),
    }
}

/// SQLite's refusal of a user's statement, as what the user can do about it.
fn explain(code: i32, message: String, sandbox: &Sandbox, limits: Limits) -> QueryError {
    // A forbidden function is an error like any other to SQLite, so the code alone does not tell.
    if let Some(what) = sandbox.forbidden() {
        return QueryError::Forbidden(format!("only reading is allowed, and this would {what}"));
    }
    match code {
        ffi::SQLITE_AUTH | ffi::SQLITE_READONLY => {
            QueryError::Forbidden(format!("only reading is allowed: {message}"))
        }
        ffi::SQLITE_INTERRUPT => {
            QueryError::TooMuch(format!("stopped after {} s: ask for less", limits.time.as_secs_f64()))
        }
        ffi::SQLITE_TOOBIG => QueryError::TooMuch(format!("too large: {message}")),
        ffi::SQLITE_NOMEM | ffi::SQLITE_FULL => {
            QueryError::TooMuch(format!("needs more memory or temporary space than there is: {message}"))
        }
        ffi::SQLITE_BUSY | ffi::SQLITE_LOCKED | ffi::SQLITE_IOERR | ffi::SQLITE_CANTOPEN => {
            ReadError::Unavailable(sqlx::Error::Protocol(message)).into()
        }
        _ => QueryError::Malformed(message),
    }
}

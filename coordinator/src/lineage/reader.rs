//! Reading what is committed, beside the writer or without one. It never writes, and never waits for a writer.

use super::file::{self, Found, beside, reading};
use super::sql::sql;
use super::{ExperimentId, OpenError, ReadError};
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool, SqlitePoolOptions};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Connections for questions of our own.
const CONNECTIONS: u32 = 4;

/// Users' questions answered at once; others wait their turn.
const QUESTIONS: usize = 4;

/// A reader of a lineage. Clones share its connections.
#[derive(Clone)]
pub struct Reader {
    shared: Arc<Shared>,
}

struct Shared {
    path: PathBuf,
    pool: SqlitePool,
    options: SqliteConnectOptions,
    questions: Arc<Semaphore>,
}

impl Reader {
    /// Opens a lineage for reading alone, also while another process writes it.
    ///
    /// # Errors
    /// As [`super::Lineage::open`], but for who holds it: that does not matter here.
    pub async fn open(path: &Path) -> Result<Reader, OpenError> {
        match file::look(path)? {
            Found::Lineage => {}
            Found::Nothing => return Err(OpenError::Missing { path: path.to_owned() }),
            Found::Unmarked => {
                let found = "an SQLite database of another program, or a lineage that was not finished making: \
                             a coordinator finishes it";
                return Err(file::foreign(path, found));
            }
        }
        Reader::connect(path).await
    }

    /// Opens a file that is a lineage.
    pub(super) async fn connect(path: &Path) -> Result<Reader, OpenError> {
        let options = reading(path, false);
        let (options, pool) = match connect(&options).await {
            Ok(pool) => (options, pool),
            // A finished file in a folder that may not be written: SQLite cannot put its index of the log
            // there, and needs none, since there is no log.
            Err(_) if std::fs::metadata(beside(path, "-wal")).map_or(0, |log| log.len()) == 0 => {
                let options = reading(path, true);
                let pool = connect(&options).await;
                (options, pool.map_err(|error| file::refused_by_sqlite(path, &error))?)
            }
            Err(error) => return Err(file::refused_by_sqlite(path, &error)),
        };
        let refused = |error: sqlx::Error| file::refused_by_sqlite(path, &error);
        let mut connection = pool.acquire().await.map_err(refused)?;
        let found = file::schema_version(&mut connection).await.map_err(refused)?;
        drop(connection);
        if found > file::SCHEMA {
            return Err(OpenError::Newer { path: path.to_owned(), found, known: file::SCHEMA });
        }
        if found < file::SCHEMA {
            return Err(OpenError::Older { path: path.to_owned(), found, known: file::SCHEMA });
        }
        let questions = Arc::new(Semaphore::new(QUESTIONS));
        Ok(Reader { shared: Arc::new(Shared { path: path.to_owned(), pool, options, questions }) })
    }

    /// The file that it reads.
    pub fn path(&self) -> &Path {
        &self.shared.path
    }

    /// What a reference names: `last`, a number, or a name; the name of a matrix names its cells. In order of
    /// number, never empty.
    ///
    /// # Errors
    /// [`ReadError::NotFound`] if it names nothing.
    pub async fn find(&self, reference: &str) -> Result<Vec<ExperimentId>, ReadError> {
        let query = sqlx::query_scalar(sql!("find_experiments")).bind(reference);
        let ids: Vec<i64> = query.fetch_all(self.pool()).await?;
        if ids.is_empty() {
            return Err(ReadError::NotFound { what: "experiment", reference: reference.to_owned() });
        }
        Ok(ids.into_iter().map(ExperimentId::of).collect())
    }

    /// As [`Reader::find`], for a reference that may name one alone.
    ///
    /// # Errors
    /// [`ReadError::Ambiguous`] if it names several.
    pub async fn find_one(&self, reference: &str) -> Result<ExperimentId, ReadError> {
        let ids = self.find(reference).await?;
        if let [id] = ids[..] {
            return Ok(id);
        }
        let mut names = Vec::with_capacity(ids.len());
        for id in ids {
            names.push(self.experiment(id).await?.name);
        }
        Err(ReadError::Ambiguous { reference: reference.to_owned(), names })
    }

    /// Ends its connections; clones then find nothing to read with.
    pub async fn close(&self) {
        self.shared.pool.close().await;
    }

    pub(super) fn pool(&self) -> &SqlitePool {
        &self.shared.pool
    }

    /// How a connection of one's own is opened.
    pub(super) fn options(&self) -> &SqliteConnectOptions {
        &self.shared.options
    }

    /// The turn of a user's question.
    pub(super) async fn turn(&self) -> tokio::sync::OwnedSemaphorePermit {
        let turn = self.shared.questions.clone().acquire_owned();
        turn.await.expect("the semaphore is never closed")
    }
}

async fn connect(options: &SqliteConnectOptions) -> Result<SqlitePool, sqlx::Error> {
    let pool = SqlitePoolOptions::new().max_connections(CONNECTIONS).connect_with(options.clone()).await?;
    // Opening alone touches nothing; this shows whether the file can be read.
    sqlx::query("PRAGMA schema_version").fetch_one(&pool).await?;
    Ok(pool)
}

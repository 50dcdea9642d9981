//! The statements of the lineage, each a file of `queries/`, and rows of them inserted many at a time. No
//! statement is put together from anything but these files.

use sqlx::query::Query;
use sqlx::sqlite::{Sqlite, SqliteArguments, SqliteConnection};
use sqlx::{AssertSqlSafe, Executor as _};

/// The text of a statement in `queries/`.
macro_rules! sql {
    ($name:literal) => {
        include_str!(concat!("queries/", $name, ".sql"))
    };
}
pub(crate) use sql;

/// Rows of one `VALUES`. More gain nothing, one a statement costs seven times as much.
const ROWS: usize = 32;

/// An `INSERT` of one row, to be run for many.
pub(crate) struct Insert {
    head: &'static str,  // up to and with `VALUES`
    tuple: &'static str, // `(?, ?, …)`
    tail: &'static str,  // what follows: a conflict clause
    full: String,        // with ROWS tuples
}

impl Insert {
    /// From the text of a statement with one tuple of `?`.
    pub(crate) fn of(text: &'static str) -> Self {
        let (head, rest) = text
            .find("VALUES (")
            .map(|at| text.split_at(at + "VALUES ".len()))
            .expect("an insert of this crate has a tuple; a test prepares each");
        let end = rest.find(')').expect("a tuple ends") + 1;
        let (tuple, tail) = rest.split_at(end);
        let mut insert = Insert { head, tuple, tail, full: String::new() };
        insert.full = insert.text(ROWS);
        insert
    }

    fn text(&self, rows: usize) -> String {
        let tuples = vec![self.tuple; rows].join(", ");
        format!("{}{tuples}{}", self.head, self.tail)
    }

    /// Inserts rows in order; `bind` gives one row its values. Says how many rows there are more.
    pub(crate) async fn run<T>(
        &'static self,
        connection: &mut SqliteConnection,
        rows: &[T],
        bind: impl for<'q> Fn(Bound<'q>, &T) -> Bound<'q>,
    ) -> Result<u64, sqlx::Error> {
        let mut inserted = 0;
        for chunk in rows.chunks(ROWS) {
            let mut query = if chunk.len() == ROWS {
                sqlx::query(self.full.as_str())
            } else {
                sqlx::query(AssertSqlSafe(self.text(chunk.len()))).persistent(false)
            };
            for row in chunk {
                query = bind(query, row);
            }
            inserted += connection.execute(query).await?.rows_affected();
        }
        Ok(inserted)
    }
}

/// A statement with some of its values.
pub(crate) type Bound<'q> = Query<'q, Sqlite, SqliteArguments>;

//! Rows of a query as they arrive: columns once, then rows. It holds one message at a time and knows nothing
//! of what the columns mean.

use std::collections::VecDeque;

use anyhow::anyhow;
use proto::v1::value::Kind;
use proto::v1::{QueryReply, QueryRequest, Value, View, query_request::What};
use tonic::Streaming;

use super::{Connection, PATIENT, within};
use crate::exit::Failure;

/// The rows of one query, streamed.
#[derive(Debug)]
pub(crate) struct Rows {
    columns: Vec<String>,
    stream: Streaming<QueryReply>,
    arrived: VecDeque<Vec<Value>>,
}

impl Connection {
    /// A whole view, of one experiment (or the cells of a matrix), or of all.
    pub(crate) async fn view(&self, name: &str, experiment: Option<&str>) -> Result<Rows, Failure> {
        let view = View { name: name.to_owned(), experiment: experiment.unwrap_or_default().to_owned() };
        // A view is read whole, whatever its size: its rows are passed on as they come.
        let request = QueryRequest {
            what: Some(What::View(view)),
            row_limit: u64::MAX,
            timeout_ms: u32::try_from(PATIENT.as_millis()).unwrap_or(u32::MAX),
        };
        self.query(request).await
    }

    /// The rows of a query. The deadline is the query's own, with room for the way.
    pub(crate) async fn query(&self, request: QueryRequest) -> Result<Rows, Failure> {
        let deadline = match request.timeout_ms {
            0 => PATIENT,
            asked => std::time::Duration::from_millis(u64::from(asked) + 5_000),
        };
        let mut stream = self.lineage().query(within(deadline, request)).await?.into_inner();
        let first = stream.message().await?.unwrap_or_default();
        let mut rows = Rows { columns: first.columns, stream, arrived: VecDeque::new() };
        rows.arrived.extend(first.rows.into_iter().map(|row| row.values));
        Ok(rows)
    }
}

impl Rows {
    /// The names of the columns.
    pub(crate) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The next row: as many values as there are columns.
    pub(crate) async fn next(&mut self) -> Result<Option<Vec<Value>>, Failure> {
        while self.arrived.is_empty() {
            match self.stream.message().await? {
                Some(reply) => self.arrived.extend(reply.rows.into_iter().map(|row| row.values)),
                None => return Ok(None),
            }
        }
        match self.arrived.pop_front() {
            Some(row) if row.len() != self.columns.len() => {
                Err(anyhow!("a row of {} values in {} columns", row.len(), self.columns.len()).into())
            }
            row => Ok(row),
        }
    }

    /// All rows, each with its cells by name.
    pub(crate) async fn collect(mut self) -> Result<Vec<Cells>, Failure> {
        let columns: std::sync::Arc<[String]> = self.columns.clone().into();
        let mut all = Vec::new();
        while let Some(values) = self.next().await? {
            all.push(Cells { columns: columns.clone(), values });
        }
        Ok(all)
    }
}

/// One row with its cells by name.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    columns: std::sync::Arc<[String]>,
    values: Vec<Value>,
}

impl Cells {
    /// A row for tests.
    #[cfg(test)]
    pub(crate) fn new(cells: &[(&str, Kind)]) -> Cells {
        Cells {
            columns: cells.iter().map(|(name, _)| (*name).to_owned()).collect(),
            values: cells.iter().map(|(_, kind)| Value { kind: Some(kind.clone()) }).collect(),
        }
    }

    /// The same row with a cell more, or with another value in it, for tests.
    #[cfg(test)]
    pub(crate) fn with(self, column: &str, kind: Kind) -> Cells {
        let cells = self.columns.iter().cloned().zip(self.values).filter(|(name, _)| name != column);
        let (columns, values): (Vec<_>, Vec<_>) =
            cells.chain([(column.to_owned(), Value { kind: Some(kind) })]).unzip();
        Cells { columns: columns.into(), values }
    }

    /// Makes a cell NULL, for tests.
    #[cfg(test)]
    pub(crate) fn clear(&mut self, column: &str) {
        let place = self.columns.iter().position(|name| name == column).unwrap();
        self.values[place].kind = None;
    }

    fn kind(&self, column: &str) -> Result<Option<&Kind>, Failure> {
        let place = self.columns.iter().position(|name| name == column);
        let place = place.ok_or_else(|| {
            anyhow!("the lineage has no column `{column}` here; it may be of another release")
        })?;
        Ok(self.values[place].kind.as_ref())
    }

    fn mismatch(column: &str, expected: &str) -> Failure {
        anyhow!("column `{column}` of the lineage holds no {expected}").into()
    }

    /// An integer; `None` for NULL.
    pub(crate) fn integer(&self, column: &str) -> Result<Option<i64>, Failure> {
        match self.kind(column)? {
            None => Ok(None),
            Some(Kind::Integer(value)) => Ok(Some(*value)),
            Some(_) => Err(Self::mismatch(column, "integer")),
        }
    }

    /// A count or a number of something; NULL and negatives are errors.
    pub(crate) fn count(&self, column: &str) -> Result<u64, Failure> {
        self.integer(column)?
            .and_then(|value| u64::try_from(value).ok())
            .ok_or_else(|| Self::mismatch(column, "count"))
    }

    /// A number; `None` for NULL.
    pub(crate) fn real(&self, column: &str) -> Result<Option<f64>, Failure> {
        match self.kind(column)? {
            None => Ok(None),
            Some(Kind::Real(value)) => Ok(Some(*value)),
            Some(Kind::Integer(value)) => Ok(Some(*value as f64)),
            Some(_) => Err(Self::mismatch(column, "number")),
        }
    }

    /// A text; empty for NULL.
    pub(crate) fn text(&self, column: &str) -> Result<&str, Failure> {
        match self.kind(column)? {
            None => Ok(""),
            Some(Kind::Text(value)) => Ok(value),
            Some(_) => Err(Self::mismatch(column, "text")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_read_by_its_name_and_a_wrong_kind_or_name_is_named() {
        let row = Cells::new(&[
            ("run", Kind::Integer(3)),
            ("best", Kind::Real(1.5)),
            ("name", Kind::Text("crawler".into())),
        ]);
        assert_eq!(row.count("run").unwrap(), 3);
        assert_eq!(row.real("run").unwrap(), Some(3.0), "an integer is a number");
        assert_eq!(row.real("best").unwrap(), Some(1.5));
        assert_eq!(row.text("name").unwrap(), "crawler");
        assert!(row.count("name").unwrap_err().to_string().contains("`name`"));
        assert!(row.text("cell").unwrap_err().to_string().contains("`cell`"));
    }
}

//! `hatchery sql`: one SELECT of the user's on the documented views, answered as a table or as one object a
//! line. It holds no more rows than a table's columns are measured by.

use proto::v1::{QueryRequest, Value, query_request::What, value::Kind};

use crate::arguments::Sql;
use crate::connect::{Connection, Source};
use crate::exit::Failure;
use crate::render::table::Aligned;
use crate::render::{Output, json, number};

/// So many rows say how wide the columns are; a later cell that is wider moves what is to its right.
const MEASURED: usize = 1000;

pub(super) async fn sql(arguments: Sql, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let request = QueryRequest {
        what: Some(What::Sql(arguments.statement)),
        row_limit: arguments.rows,
        timeout_ms: arguments.timeout.unwrap_or(0) * 1000,
    };
    let mut rows = connection.query(request).await?;
    if output.json {
        while let Some(values) = rows.next().await? {
            output.object(&json::row(rows.columns(), &values))?;
        }
        return Ok(());
    }
    let mut first = vec![rows.columns().to_vec()];
    while first.len() <= MEASURED
        && let Some(values) = rows.next().await?
    {
        first.push(values.iter().map(cell).collect());
    }
    let columns = Aligned::by(&first);
    for row in &first {
        output.line(columns.line(row))?;
    }
    if first.len() == 1 {
        output.line("(no rows)")?;
    }
    while let Some(values) = rows.next().await? {
        output.line(columns.line(&values.iter().map(cell).collect::<Vec<_>>()))?;
    }
    Ok(())
}

/// A value as it is, every digit of it: what was asked for may be compared.
fn cell(value: &Value) -> String {
    match &value.kind {
        None => "NULL".to_owned(),
        Some(Kind::Integer(value)) => value.to_string(),
        Some(Kind::Real(value)) => value.to_string(),
        Some(Kind::Text(value)) => value.replace(['\n', '\r'], " "),
        Some(Kind::Blob(value)) => number::hex(value),
    }
}

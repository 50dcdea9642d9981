//! `hatchery export`: a view of the lineage as CSV or NDJSON, streamed row by row. A file is whole or not
//! there.

use std::io::{BufWriter, Write};

use proto::v1::{Value, value::Kind};

use crate::arguments::{Export, Format};
use crate::connect::{Connection, Rows, Source};
use crate::exit::Failure;
use crate::render::whole::Whole;
use crate::render::{Output, json, number};

pub(super) async fn export(arguments: Export, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let rows = connection.view(&arguments.view, arguments.experiment.as_deref()).await?;
    let Some(path) = &arguments.output else {
        write(rows, arguments.format, &mut BufWriter::new(std::io::stdout())).await?;
        return Ok(());
    };
    let mut file = Whole::begin(path)?;
    let count = write(rows, arguments.format, &mut file).await?;
    file.end()?;
    if output.json {
        let file = path.display().to_string();
        return output.document(&serde_json::json!({ "view": arguments.view, "file": file, "rows": count }));
    }
    output.line(format!("{}: {} rows of {}", path.display(), number::count(count), arguments.view))
}

/// Writes rows and gives their number.
async fn write(mut rows: Rows, format: Format, to: &mut impl Write) -> Result<u64, Failure> {
    let mut count = 0;
    match format {
        Format::Csv => {
            let mut csv = csv::Writer::from_writer(to);
            csv.write_record(rows.columns()).map_err(written)?;
            while let Some(values) = rows.next().await? {
                csv.write_record(values.iter().map(field)).map_err(written)?;
                count += 1;
            }
            csv.flush()?;
        }
        Format::Ndjson => {
            while let Some(values) = rows.next().await? {
                serde_json::to_writer(&mut *to, &json::row(rows.columns(), &values))
                    .map_err(std::io::Error::from)?;
                to.write_all(b"\n")?;
                count += 1;
            }
            to.flush()?;
        }
    }
    Ok(count)
}

/// The system's own error, so that a reader that went away is known as such.
fn written(error: csv::Error) -> Failure {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error.into(),
        kind => anyhow::anyhow!("cannot write CSV: {kind:?}").into(),
    }
}

fn field(value: &Value) -> String {
    match &value.kind {
        None => String::new(),
        Some(Kind::Integer(value)) => value.to_string(),
        Some(Kind::Real(value)) => value.to_string(),
        Some(Kind::Text(value)) => value.clone(),
        Some(Kind::Blob(value)) => number::hex(value),
    }
}

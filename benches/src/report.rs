//! What a bench prints: a table for people on standard error, one JSON object a row on standard output. It
//! measures nothing.

use serde_json::{Map, Value, json};

/// Rows of one bench, printed when it is dropped.
#[derive(Debug)]
pub struct Report {
    bench: &'static str,
    columns: Vec<&'static str>,
    rows: Vec<Vec<Value>>,
}

impl Report {
    /// A report with named columns.
    pub fn new(bench: &'static str, columns: &[&'static str]) -> Report {
        Report { bench, columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Adds a row, one value a column.
    ///
    /// # Panics
    /// When a value is missing or too many.
    pub fn row(&mut self, values: &[Value]) {
        assert_eq!(values.len(), self.columns.len(), "one value a column");
        let mut fields = Map::from_iter([("bench".to_owned(), json!(self.bench))]);
        fields.extend(self.columns.iter().map(|column| (*column).to_owned()).zip(values.iter().cloned()));
        println!("{}", Value::Object(fields));
        self.rows.push(values.to_vec());
    }
}

impl Drop for Report {
    fn drop(&mut self) {
        let header: Vec<String> = self.columns.iter().map(|column| (*column).to_owned()).collect();
        let rows = std::iter::once(header).chain(self.rows.iter().map(|row| row.iter().map(shown).collect()));
        let rows: Vec<Vec<String>> = rows.collect();
        let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
        eprintln!("\n{}", self.bench);
        for row in &rows {
            let cells =
                row.iter().enumerate().map(|(column, cell)| format!("{cell:>width$}", width = width(column)));
            eprintln!("  {}", cells.collect::<Vec<_>>().join("  "));
        }
    }
}

/// A value with as many digits as a measurement deserves.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or(f64::NAN);
            if number.abs() >= 1000.0 { format!("{number:.0}") } else { format!("{number:.3}") }
        }
        Value::Null => "–".to_owned(),
        other => other.to_string(),
    }
}

//! Tables for people: a header, columns two spaces apart, numbers to the right, the same on a terminal and in
//! a pipe. Programs read `--json`.

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

/// A column's heading and the side that its cells keep to.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Column {
    /// Text, to the left.
    Left(&'static str),
    /// Numbers, to the right.
    Right(&'static str),
    /// A `|` between what belongs together; its cells are given as such.
    Bar,
}

/// Renders rows of as many cells as there are columns.
pub(crate) fn table(columns: &[Column], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let headings = columns.iter().map(|column| match column {
        Column::Left(heading) | Column::Right(heading) => *heading,
        Column::Bar => "|",
    });
    let mut table = plain(headings);
    for (place, drawn) in table.column_iter_mut().enumerate() {
        if let Column::Right(_) = columns[place] {
            drawn.set_cell_alignment(CellAlignment::Right);
        }
        if columns[place..].iter().take(2).any(|column| matches!(column, Column::Bar)) {
            drawn.set_padding((0, 1));
        }
    }
    for row in rows {
        table.add_row(row);
    }
    text(&table)
}

/// A table whose headings are known only when it runs; everything to the left.
pub(crate) fn plain<T: Into<comfy_table::Cell>>(headings: impl IntoIterator<Item = T>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(headings.into_iter().map(Into::into).collect::<Vec<comfy_table::Cell>>());
    for column in table.column_iter_mut() {
        column.set_padding((0, 2));
    }
    table
}

/// A table's text, without the blanks that would pad its lines.
pub(crate) fn text(table: &Table) -> String {
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

/// Facts under one another: names to the left, what they are beside.
pub(crate) fn facts(facts: &[(&str, String)]) -> String {
    let width = facts.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let line = |(name, what): &(&str, String)| format!("{name:width$}  {what}").trim_end().to_owned();
    facts.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_to_the_right_and_no_line_ends_in_blanks() {
        let columns = [Column::Left("name"), Column::Right("best"), Column::Left("state")];
        let rows =
            [vec!["crawler".into(), "9.5".into(), "".into()], vec!["a".into(), "100.25".into(), "ok".into()]];
        assert_eq!(table(&columns, rows), "name       best  state\ncrawler     9.5\na        100.25  ok");
    }
}

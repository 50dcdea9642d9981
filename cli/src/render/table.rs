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
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(headings);
    for (place, drawn) in table.column_iter_mut().enumerate() {
        drawn.set_padding((0, 2));
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
    // Without the blanks that would pad its lines.
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

/// Columns of a table that is printed as it comes, everything to the left.
#[derive(Debug)]
pub(crate) struct Aligned {
    /// In characters.
    widths: Vec<usize>,
}

impl Aligned {
    /// As wide as the cells of some rows.
    pub(crate) fn by(rows: &[Vec<String>]) -> Aligned {
        let mut widths = Vec::new();
        for row in rows {
            widths.resize(widths.len().max(row.len()), 0);
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = cell.chars().count().max(*width);
            }
        }
        Aligned { widths }
    }

    /// One row.
    pub(crate) fn line(&self, row: &[String]) -> String {
        let cells = self.widths.iter().zip(row).map(|(&width, cell)| format!("{cell:width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    }
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
    fn rows_that_come_later_keep_to_the_columns_and_a_wide_cell_moves_its_neighbours() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let columns = Aligned::by(&[row(["id", "name"]), row(["12", "ö"])]);
        assert_eq!(columns.line(&row(["12", "ö"])), "12  ö");
        assert_eq!(columns.line(&row(["1", ""])), "1");
        assert_eq!(columns.line(&row(["1234", "a"])), "1234  a");
    }

    #[test]
    fn numbers_stand_to_the_right_and_no_line_ends_in_blanks() {
        let columns = [Column::Left("name"), Column::Right("best"), Column::Left("state")];
        let rows =
            [vec!["crawler".into(), "9.5".into(), "".into()], vec!["a".into(), "100.25".into(), "ok".into()]];
        assert_eq!(table(&columns, rows), "name       best  state\ncrawler     9.5\na        100.25  ok");
    }
}

//! The cells of a `[matrix]`: lists of values of dotted keys, crossed into one experiment each. It reads no
//! other table.

use super::overrides::put;
use super::problem::Problem;
use super::tree::{Content, Node};
use serde_json::Value;
use std::collections::BTreeMap;

/// The most cells of one file.
const CELLS_MAX: usize = 1000;

/// Keys that the cells have in common.
const OF_THE_WHOLE: [&str; 6] = ["name", "group", "cell", "matrix", "profile", "published"];

/// One choice of a value for every key of the matrix.
#[derive(Debug)]
pub(super) struct Cell {
    /// What follows the matrix's name and a slash: the values joined by `-`.
    pub(super) name: String,
    /// Value by dotted key.
    pub(super) coordinates: BTreeMap<String, Value>,
    choices: Vec<(String, Node)>,
}

impl Cell {
    /// Puts the cell's values into an experiment.
    pub(super) fn apply(&self, tree: &mut Node, text: &str) -> Result<(), Problem> {
        for (key, value) in &self.choices {
            let keys: Vec<String> = key.split('.').map(str::to_owned).collect();
            put(tree, &keys, value.clone()).map_err(|problem| problem.at(text, value.span.clone()))?;
        }
        Ok(())
    }
}

/// Every cell of a matrix; the last key varies fastest. Keys count in the order in which they are written.
pub(super) fn cells(matrix: &Node, text: &str) -> Result<Vec<Cell>, Vec<Problem>> {
    let refuse = |node: &Node, key: &str, message: String| {
        vec![Problem::new(super::problem::join("matrix", key), message).at(text, node.span.clone())]
    };
    let Some(table) = matrix.table() else {
        return Err(refuse(matrix, "", "expected a table of lists, by dotted key".to_owned()));
    };
    let mut axes: Vec<(&String, &Node, &[Node])> = Vec::new();
    for (key, node) in table {
        if OF_THE_WHOLE.contains(&key.split('.').next().unwrap_or_default()) {
            return Err(refuse(node, key, format!("`{key}` is of the whole file, not of a cell")));
        }
        match &node.content {
            Content::List(list) if !list.is_empty() => axes.push((key, node, list)),
            Content::Table(_) => {
                let message = format!("is a table: write the key in quotes, as in \"{key}.KEY\" = [...]");
                return Err(refuse(node, key, message));
            }
            _ => return Err(refuse(node, key, "expected a list of values, at least one".to_owned())),
        }
    }
    axes.sort_by_key(|(_, node, _)| node.span.as_ref().map_or(usize::MAX, |span| span.start));
    let count = axes.iter().try_fold(1usize, |count, (_, _, list)| count.checked_mul(list.len()));
    if count.is_none_or(|count| count > CELLS_MAX) {
        return Err(refuse(matrix, "", format!("has more than {CELLS_MAX} cells")));
    }
    if axes.is_empty() {
        return Err(refuse(matrix, "", "has no keys".to_owned()));
    }
    let mut cells = vec![Cell { name: String::new(), coordinates: BTreeMap::new(), choices: Vec::new() }];
    for (key, _, list) in &axes {
        let extend = |cell: &Cell, node: &Node| {
            let value = node.value();
            let separator = if cell.name.is_empty() { "" } else { "-" };
            let mut coordinates = cell.coordinates.clone();
            coordinates.insert((*key).clone(), value.clone());
            let mut choices = cell.choices.clone();
            choices.push(((*key).clone(), node.clone()));
            Cell { name: format!("{}{separator}{}", cell.name, word(&value)), coordinates, choices }
        };
        cells = cells.iter().flat_map(|cell| list.iter().map(move |node| extend(cell, node))).collect();
    }
    let mut names: Vec<&str> = cells.iter().map(|cell| cell.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(refuse(matrix, "", format!("has two cells named `{}`", pair[0]))),
        None => Ok(cells),
    }
}

/// A value as part of a name.
fn word(value: &Value) -> String {
    let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let clean =
        |letter: char| if letter.is_ascii_alphanumeric() || ".-".contains(letter) { letter } else { '_' };
    text.chars().map(clean).collect()
}

//! What is laid over an experiment file: a profile of its own, then assignments from outside. It changes the
//! tree and knows no key by name but `profile` and `search`.

use super::problem::{Problem, nearest};
use super::tree::{Content, Node};
use crate::registry;
use serde_json::Value;
use toml::de::{DeTable, DeValue};

/// A chosen profile, and keys set from outside.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Overrides {
    /// The `[profile.NAME]` to lay over the file.
    pub profile: Option<String>,
    /// Dotted keys with values, in order, laid over the profile. A value that is no TOML value is a string.
    pub set: Vec<(String, String)>,
}

/// Takes the profiles out of a file and lays the chosen one over it. Gives the name of the profile that the
/// text is now of: `profile` is a table of profiles in a file as it is written, and that name in one that is
/// resolved.
pub(super) fn lay_profile(
    tree: &mut Node,
    chosen: Option<&str>,
    text: &str,
) -> Result<Option<String>, Problem> {
    let profiles = tree.table_mut().and_then(|table| table.remove("profile"));
    let span = profiles.as_ref().and_then(|node| node.span.clone());
    let mut profiles = match profiles.map(|node| node.content) {
        None => Default::default(),
        Some(Content::Table(profiles)) => profiles,
        Some(Content::Scalar(Value::String(name))) => {
            return match chosen {
                None => Ok(Some(name)),
                Some(chosen) => {
                    let message = format!("the file is already resolved with profile `{name}`");
                    Err(Problem::new("profile", message).help(format!("leave out `{chosen}`")).at(text, span))
                }
            };
        }
        Some(_) => {
            let message = "expected tables, as in [profile.smoke]";
            return Err(Problem::new("profile", message).at(text, span));
        }
    };
    let Some(chosen) = chosen else { return Ok(None) };
    let Some(profile) = profiles.remove(chosen) else {
        let names: Vec<&str> = profiles.keys().map(String::as_str).collect();
        let problem = Problem::new(format!("profile.{chosen}"), "there is no such profile");
        return Err(match (nearest(chosen, &names), names.is_empty()) {
            (Some(meant), _) => {
                problem.help(format!("did you mean `{meant}`? there are: {}", names.join(", ")))
            }
            (None, false) => problem.help(format!("there are: {}", names.join(", "))),
            (None, true) => problem.help("the file has none"),
        });
    };
    if profile.table().is_none() {
        let message = "expected a table of keys to override";
        return Err(Problem::new(format!("profile.{chosen}"), message).at(text, profile.span));
    }
    let span = profile.span.clone();
    if let Some(search) = profile.table().and_then(|table| table.get("search")).and_then(Node::table) {
        search.keys().for_each(|key| hold_for_every_row(tree, key));
    }
    tree.overlay(profile, "").map_err(|problem| problem.at(text, span))?;
    Ok(Some(chosen.to_owned()))
}

/// Puts a value under a path of keys. What is put into `[search]` holds for every row of a list that would override
/// it (ESP E-88).
pub(super) fn put(tree: &mut Node, keys: &[String], value: Node) -> Result<(), Problem> {
    if let [search, key, ..] = keys
        && search == "search"
    {
        hold_for_every_row(tree, key);
    }
    tree.set(keys, value)
}

/// Takes a key out of the rows of every list at the top, so that what `[search]` says of it holds for them all.
fn hold_for_every_row(tree: &mut Node, key: &str) {
    let lists = registry::KINDS.iter().flat_map(|kind| kind.lists);
    for list in lists {
        let rows = tree.table_mut().and_then(|table| table.get_mut(*list));
        if let Some(Content::List(rows)) = rows.map(|rows| &mut rows.content) {
            rows.iter_mut().filter_map(Node::table_mut).for_each(|row| {
                row.remove(key);
            });
        }
    }
}

/// Sets one key from outside.
pub(super) fn assign(tree: &mut Node, key: &str, value: &str) -> Result<(), Problem> {
    let keys = dotted(key).ok_or_else(|| {
        Problem::new(key, "is no dotted key").help("write key=value, as in search.generations=5")
    })?;
    if keys[0] == "profile" {
        return Err(Problem::new(key, "profiles are chosen, not set"));
    }
    put(tree, &keys, Node::parse_value(key, value)?)
}

/// The parts of a dotted key, read as TOML reads it: quoted parts may hold dots.
fn dotted(key: &str) -> Option<Vec<String>> {
    if key.contains(['\n', '\r', '=', '#']) {
        return None;
    }
    let text = format!("{key} = 0");
    let table = DeTable::parse(&text).ok()?;
    let mut here = table.get_ref();
    let mut keys = Vec::new();
    loop {
        let (name, value) = here.iter().next()?;
        keys.push(name.get_ref().as_ref().to_owned());
        match value.get_ref() {
            DeValue::Table(table) => here = table,
            _ => return Some(keys),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_read_as_toml_reads_them() {
        assert_eq!(dotted("a.b-c").unwrap(), ["a", "b-c"]);
        assert_eq!(dotted(" matrix.\"task.body\" ").unwrap(), ["matrix", "task.body"]);
        for wrong in ["", ".", "a..b", "a b", "[a]", "a\nb", "a # b"] {
            assert_eq!(dotted(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn a_value_that_is_no_toml_is_a_string() {
        let mut tree = Node::empty();
        for (key, value) in [("a", "1"), ("b", "fast"), ("c", "[1, 2]"), ("d", "\"1\""), ("e", "1.5e3")] {
            assign(&mut tree, key, value).unwrap();
        }
        let read = serde_json::json!({"a": 1, "b": "fast", "c": [1, 2], "d": "1", "e": 1500.0});
        assert_eq!(tree.value(), read);
    }
}

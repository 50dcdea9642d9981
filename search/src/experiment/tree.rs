//! The experiment file as a tree of values that remember where in the text they stand. It knows TOML and
//! nothing of experiments.

use super::problem::{Problem, join, nearest};
use serde_json::{Map, Number, Value};
use std::collections::BTreeMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// The largest file taken, bytes.
const SIZE_MAX: usize = 1 << 20;

/// A value with its place in the text; none if an override put it there.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) span: Option<Range<usize>>,
    /// Where the key of a table's value stands.
    pub(super) key: Option<Range<usize>>,
    pub(super) content: Content,
}

#[derive(Debug, Clone)]
pub(super) enum Content {
    Table(Table),
    List(Vec<Node>),
    Scalar(Value),
}

pub(super) type Table = BTreeMap<String, Node>;

impl Node {
    /// An empty table that stands nowhere.
    pub(super) fn empty() -> Node {
        Node { span: None, key: None, content: Content::Table(Table::new()) }
    }

    /// Reads a whole file.
    pub(super) fn parse(text: &str) -> Result<Node, Vec<Problem>> {
        if text.len() > SIZE_MAX {
            let problem = format!("a file of {} bytes is over the limit of {SIZE_MAX}", text.len());
            return Err(vec![Problem::new("", problem).at(text, Some(0..0))]);
        }
        let table = DeTable::parse(text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            vec![Problem::new("", error.message().replace('\n', ", ")).at(text, Some(span))]
        })?;
        let mut problems = Vec::new();
        let root = table_node(table.get_ref(), Some(0..0), "", text, &mut problems);
        if problems.is_empty() { Ok(root) } else { Err(problems) }
    }

    /// Reads one value of an override; what is no TOML is a string.
    pub(super) fn parse_value(key: &str, text: &str) -> Result<Node, Problem> {
        let Ok(value) = DeValue::parse(text) else {
            return Ok(Node { span: None, key: None, content: Content::Scalar(text.into()) });
        };
        let mut problems = Vec::new();
        let mut node = value_node(value.get_ref(), None, key, text, &mut problems);
        node.forget_spans();
        // Places in the override's own text would be taken for places in the file.
        problems.pop().map_or(Ok(node), |problem| Err(Problem { span: None, line: 0, column: 0, ..problem }))
    }

    pub(super) fn table(&self) -> Option<&Table> {
        match &self.content {
            Content::Table(table) => Some(table),
            _ => None,
        }
    }

    pub(super) fn table_mut(&mut self) -> Option<&mut Table> {
        match &mut self.content {
            Content::Table(table) => Some(table),
            _ => None,
        }
    }

    /// The values without their places.
    pub(super) fn value(&self) -> Value {
        match &self.content {
            Content::Table(table) => Value::Object(
                table.iter().map(|(key, node)| (key.clone(), node.value())).collect::<Map<_, _>>(),
            ),
            Content::List(list) => Value::Array(list.iter().map(Node::value).collect()),
            Content::Scalar(value) => value.clone(),
        }
    }

    /// What stands at a path such as `world.friction_limb` or `beta[1]`, or at as much of it as there is.
    pub(super) fn find(&self, path: &str) -> &Node {
        match self.step(path).and_then(|(key, rest)| Some((self.child(key)?, rest))) {
            Some((child, rest)) => child.find(rest),
            None => self,
        }
    }

    /// Removes the key of a path from the innermost table on the way; false if there is none.
    pub(super) fn remove(&mut self, path: &str) -> bool {
        let Some((key, rest)) = self.step(path).map(|(key, rest)| (key.to_owned(), rest)) else {
            return false;
        };
        match self.child_mut(&key) {
            Some(child) if !rest.is_empty() && child.has_tables() => child.remove(rest),
            _ => self.table_mut().is_some_and(|table| table.remove(&key).is_some()),
        }
    }

    /// Whether it is a table, or a list of them.
    fn has_tables(&self) -> bool {
        match &self.content {
            Content::Table(_) => true,
            Content::List(list) => list.iter().any(|node| node.table().is_some()),
            Content::Scalar(_) => false,
        }
    }

    /// Puts a value under a path of keys, with tables on the way where there are none. In a list of tables with an
    /// `id` each a key names the one with that id.
    pub(super) fn set(&mut self, keys: &[String], value: Node) -> Result<(), Problem> {
        let Some((last, way)) = keys.split_last() else { return Ok(()) };
        let mut here = self;
        for (depth, key) in way.iter().enumerate() {
            here = match here.content {
                Content::Table(ref mut table) => table.entry(key.clone()).or_insert_with(Node::empty),
                Content::List(ref mut list) => row(list, key, &keys[..depth].join("."))?,
                Content::Scalar(_) => return Err(no_table(&keys[..depth])),
            };
        }
        let table = here.table_mut().ok_or_else(|| no_table(way))?;
        table.insert(last.clone(), value);
        Ok(())
    }

    /// Lays another tree over this one: tables are merged, all else is replaced. A table over a list of tables with
    /// an `id` each names some of them by that id.
    pub(super) fn overlay(&mut self, over: Node, path: &str) -> Result<(), Problem> {
        match (&mut self.content, over.content) {
            (Content::Table(under), Content::Table(table)) => {
                for (key, node) in table {
                    match under.get_mut(&key) {
                        Some(present) => present.overlay(node, &join(path, &key))?,
                        None => {
                            under.insert(key, node);
                        }
                    }
                }
            }
            (Content::List(list), Content::Table(table)) => {
                for (key, node) in table {
                    row(list, &key, path)?.overlay(node, &join(path, &key))?;
                }
            }
            (under, over_content) => {
                *under = over_content;
                (self.span, self.key) = (over.span, over.key);
            }
        }
        Ok(())
    }

    fn child_mut(&mut self, key: &str) -> Option<&mut Node> {
        match &mut self.content {
            Content::Table(table) => table.get_mut(key),
            Content::List(list) => list.get_mut(key.parse::<usize>().ok()?),
            Content::Scalar(_) => None,
        }
    }

    fn child(&self, key: &str) -> Option<&Node> {
        match &self.content {
            Content::Table(table) => table.get(key),
            Content::List(list) => list.get(key.parse::<usize>().ok()?),
            Content::Scalar(_) => None,
        }
    }

    /// The first key of a path and the rest of it, if this node has that key. Keys may hold dots, so that
    /// the longest that fits is meant.
    fn step<'p>(&self, path: &'p str) -> Option<(&'p str, &'p str)> {
        match &self.content {
            Content::Table(table) => {
                let fits = |key: &&String| {
                    path.strip_prefix(key.as_str())
                        .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
                };
                let key = table.keys().filter(fits).max_by_key(|key| key.len())?;
                let (key, rest) = path.split_at(key.len());
                Some((key, rest.strip_prefix('.').unwrap_or(rest)))
            }
            Content::List(list) => {
                let (index, rest) = path.strip_prefix('[')?.split_once(']')?;
                list.get(index.parse::<usize>().ok()?)?;
                Some((index, rest.strip_prefix('.').unwrap_or(rest)))
            }
            Content::Scalar(_) => None,
        }
    }

    fn forget_spans(&mut self) {
        (self.span, self.key) = (None, None);
        match &mut self.content {
            Content::Table(table) => table.values_mut().for_each(Node::forget_spans),
            Content::List(list) => list.iter_mut().for_each(Node::forget_spans),
            Content::Scalar(_) => {}
        }
    }
}

/// The table of a list that has an id.
fn row<'a>(list: &'a mut [Node], id: &str, path: &str) -> Result<&'a mut Node, Problem> {
    let id_of = |node: &Node| match &node.table()?.get("id")?.content {
        Content::Scalar(Value::String(id)) => Some(id.clone()),
        _ => None,
    };
    let ids: Vec<Option<String>> = list.iter().map(id_of).collect();
    if let Some(place) = ids.iter().position(|known| known.as_deref() == Some(id)) {
        return Ok(&mut list[place]);
    }
    let ids: Vec<&str> = ids.iter().flatten().map(String::as_str).collect();
    let problem = Problem::new(join(path, id), format!("there is no `{id}` in the list `{path}`"));
    Err(match (nearest(id, &ids), ids.is_empty()) {
        (Some(meant), _) => problem.help(format!("did you mean `{meant}`? there are: {}", ids.join(", "))),
        (None, false) => problem.help(format!("there are: {}", ids.join(", "))),
        (None, true) => problem.help("none of its tables has an `id`"),
    })
}

fn no_table(way: &[String]) -> Problem {
    let key = way.join(".");
    Problem::new(key.clone(), format!("is not a table, so that it has no key to set below `{key}`"))
}

fn table_node(
    table: &DeTable<'_>,
    span: Option<Range<usize>>,
    path: &str,
    text: &str,
    problems: &mut Vec<Problem>,
) -> Node {
    let content = table
        .iter()
        .map(|(key, child)| {
            // A table is pointed at by its key: the span of its value may be all that stands in it.
            let span = match child.get_ref() {
                DeValue::Table(_) => key.span(),
                _ => child.span(),
            };
            let name = key.get_ref().as_ref();
            let node = value_node(child.get_ref(), Some(span), &join(path, name), text, problems);
            (name.to_owned(), Node { key: Some(key.span()), ..node })
        })
        .collect();
    Node { span, key: None, content: Content::Table(content) }
}

fn value_node(
    value: &DeValue<'_>,
    span: Option<Range<usize>>,
    path: &str,
    text: &str,
    problems: &mut Vec<Problem>,
) -> Node {
    let scalar = match value {
        DeValue::Table(table) => return table_node(table, span, path, text, problems),
        DeValue::Array(list) => {
            let items = list
                .iter()
                .enumerate()
                .map(|(index, item)| {
                    let path = format!("{path}[{index}]");
                    value_node(item.get_ref(), Some(item.span()), &path, text, problems)
                })
                .collect();
            return Node { span, key: None, content: Content::List(items) };
        }
        DeValue::String(string) => Ok(Value::from(string.as_ref())),
        DeValue::Boolean(boolean) => Ok(Value::from(*boolean)),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .map(Value::from)
            .map_err(|_| "is beyond 64 bits"),
        DeValue::Float(float) => float
            .as_str()
            .parse()
            .ok()
            .and_then(Number::from_f64)
            .map(Value::Number)
            .ok_or("is not a finite number"),
        DeValue::Datetime(_) => Err("is a date, and no key takes one"),
    };
    let scalar = scalar.unwrap_or_else(|message| {
        problems.push(Problem::new(path, message).at(text, span.clone()));
        Value::Null
    });
    Node { span, key: None, content: Content::Scalar(scalar) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_remember_where_they_stand() {
        let text = "a = 1\n[b]\nc = [0.5, \"x\"]\n\"d.e\" = true\n";
        let tree = Node::parse(text).unwrap();
        let at = |path| tree.find(path).span.clone().map(|span| &text[span]);
        assert_eq!(at("a"), Some("1"));
        assert_eq!(at("b.c[1]"), Some("\"x\""));
        assert_eq!(at("b.d.e"), Some("true"));
        assert_eq!(at("b"), Some("b"));
        assert_eq!(tree.find("b.c").key.clone().map(|span| &text[span]), Some("c"));
        assert_eq!(at("b.nothing"), Some("b"), "as much of the path as there is");
        assert_eq!(tree.value(), serde_json::json!({"a": 1, "b": {"c": [0.5, "x"], "d.e": true}}));
    }

    #[test]
    fn an_overlay_merges_tables_and_replaces_all_else() {
        let mut tree = Node::parse("a = 1\n[t]\nx = [1, 2]\ny = 3\n").unwrap();
        tree.overlay(Node::parse("[t]\nx = [9]\nz = 4\n").unwrap(), "").unwrap();
        assert_eq!(tree.value(), serde_json::json!({"a": 1, "t": {"x": [9], "y": 3, "z": 4}}));
        tree.set(&["t".into(), "u".into(), "v".into()], Node::parse_value("k", "7").unwrap()).unwrap();
        assert_eq!(tree.value()["t"]["u"]["v"], 7);
        assert!(tree.set(&["a".into(), "b".into()], Node::empty()).is_err());
        assert!(tree.remove("t.x[0]"), "a key goes as a whole");
        assert!(!tree.remove("t.x"));
    }

    #[test]
    fn a_key_names_a_table_of_a_list_by_its_id() {
        let mut tree = Node::parse("[[s]]\nid = \"one\"\n[[s]]\nid = \"two\"\na = 1\nb = [2]\n").unwrap();
        tree.overlay(Node::parse("s.two.a = 7\n").unwrap(), "").unwrap();
        tree.set(&["s".into(), "one".into(), "a".into()], Node::parse_value("k", "8").unwrap()).unwrap();
        let rows = |tree: &Node| tree.value()["s"].clone();
        let one = serde_json::json!({ "id": "one", "a": 8 });
        assert_eq!(rows(&tree), serde_json::json!([one, { "id": "two", "a": 7, "b": [2] }]));
        let problem = tree.overlay(Node::parse("s.tow.a = 7\n").unwrap(), "").unwrap_err();
        assert_eq!(
            problem.to_string(),
            "`s.tow`: there is no `tow` in the list `s`; did you mean `two`? there are: one, two"
        );
        assert!(tree.set(&["s".into(), "three".into(), "a".into()], Node::empty()).is_err());
        assert!(tree.remove("s[1].b[0]"), "from its own table");
        assert_eq!(rows(&tree), serde_json::json!([one, { "id": "two", "a": 7 }]));
    }
}

//! What is wrong with an experiment file, and where: every error names its place in the text, its key and
//! what is allowed. It prints one line; pointing into the file is the command line's.

use creatures::SpecError;
use std::fmt;
use std::ops::Range;

/// One problem of an experiment file or of what overrides it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Bytes of the text that it concerns; none if it comes from an override, not from the file.
    pub span: Option<Range<usize>>,
    /// From 1; 0 if it does not come from the file.
    pub line: u32,
    /// In characters, from 1; 0 if it does not come from the file.
    pub column: u32,
    /// The key, dotted: `search.neat.threshold`. Empty for the file as a whole.
    pub key: String,
    /// What is wrong, in lower case, without a full stop.
    pub message: String,
    /// What is allowed, or what was meant.
    pub help: Option<String>,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}, column {}: ", self.line, self.column)?;
        }
        if !self.key.is_empty() {
            write!(f, "`{}`: ", self.key)?;
        }
        f.write_str(&self.message)?;
        self.help.iter().try_for_each(|help| write!(f, "; {help}"))
    }
}

impl Problem {
    /// A problem with a key, as yet without a place.
    pub(super) fn new(key: impl Into<String>, message: impl Into<String>) -> Problem {
        let (key, message) = (key.into(), message.into());
        Problem { span: None, line: 0, column: 0, key, message, help: None }
    }

    pub(super) fn help(self, help: impl Into<String>) -> Problem {
        Problem { help: Some(help.into()), ..self }
    }

    /// The problem at a place of the text; without a span it stays an override's.
    pub(super) fn at(self, text: &str, span: Option<Range<usize>>) -> Problem {
        let Some(span) = span else { return self };
        let before = text.get(..span.start).unwrap_or(text);
        let line = before.matches('\n').count() as u32 + 1;
        let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) as u32 + 1;
        Problem { span: Some(span), line, column, ..self }
    }

    /// A table's own error, in the words of an experiment file: serde's for shapes, each table's for ranges.
    pub(super) fn of_table(prefix: &str, error: &SpecError) -> Problem {
        let key = join(prefix, &error.path);
        let said = error.problem.as_str();
        if let Some(rest) = said.strip_prefix("unknown field ") {
            return unknown(key, "key", rest);
        }
        if let Some(rest) = said.strip_prefix("unknown variant ") {
            return unknown(key, "value", rest);
        }
        if let Some(field) = said.strip_prefix("missing field ") {
            return Problem::new(join(&key, field.trim_matches('`')), "is missing");
        }
        for wrong in ["invalid type: ", "invalid value: ", "invalid length "] {
            if let Some((found, expected)) =
                said.strip_prefix(wrong).and_then(|rest| rest.rsplit_once(", expected "))
            {
                let found = found.replace("floating point", "number").replace("sequence", "list");
                let found = found.replace("map", "table");
                return Problem::new(key, format!("expected {}, found {found}", plain(expected)));
            }
        }
        // A reader's own words: what is wrong, then what is allowed.
        match said.split_once("; ") {
            Some((message, help)) => Problem::new(key, message).help(help),
            None => Problem::new(key, said),
        }
    }
}

/// An unknown key or value, with the one that was probably meant. `rest` is what serde says after
/// `unknown field `: the word found, then the words expected, each in backticks.
fn unknown(key: String, what: &str, rest: &str) -> Problem {
    let mut words = rest.split('`').skip(1).step_by(2);
    let found = words.next().unwrap_or_default();
    let allowed: Vec<&str> = words.collect();
    let problem = Problem::new(key, format!("unknown {what} `{found}`"));
    if allowed.is_empty() {
        return problem.help("no key is allowed here");
    }
    let list = format!("allowed: {}", allowed.join(", "));
    problem.help(match nearest(found, &allowed) {
        Some(meant) => format!("did you mean `{meant}`? {list}"),
        None => list,
    })
}

/// The word of a list that was probably meant.
pub(super) fn nearest<'a>(found: &str, allowed: &[&'a str]) -> Option<&'a str> {
    let distance = |word: &str| strsim::damerau_levenshtein(&found.to_lowercase(), word);
    let nearest = allowed.iter().copied().min_by_key(|word| distance(word))?;
    let length = found.chars().count();
    (distance(nearest) <= 1 + length / 4 && distance(nearest) < length).then_some(nearest)
}

/// Two parts of a dotted key.
pub(super) fn join(prefix: &str, path: &str) -> String {
    match (prefix, path) {
        ("", path) => path.to_owned(),
        (prefix, "") => prefix.to_owned(),
        (prefix, path) => format!("{prefix}.{path}"),
    }
}

/// A Rust type in plain words.
fn plain(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, not negative",
        "i64" => "a whole number",
        other if other.starts_with("struct ") || other == "a map" => "a table",
        "a sequence" => "a list",
        other => other,
    }
}

//! The command `hatchery`, started as a person would, in a folder of the test's.

use std::path::Path;
use std::process::{Command, Output};

use crate::process::Process;
use crate::programs::program;

/// The command with arguments, in a folder, without the settings of whoever runs the tests.
pub fn hatchery(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(program("hatchery"));
    command.current_dir(folder).args(arguments);
    for variable in
        ["HATCHERY_JOIN", "HATCHERY_JOIN_FILE", "HATCHERY_COORDINATOR", "HATCHERY_DB", "HATCHERY_LOG"]
    {
        command.env_remove(variable);
    }
    command.env("NO_COLOR", "1");
    command
}

/// Starts it, to be signalled or killed.
pub fn start(folder: &Path, arguments: &[&str]) -> Process {
    Process::start(&mut hatchery(folder, arguments), &folder.join("hatchery.log"))
}

/// Runs it to its end.
pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    hatchery(folder, arguments).output().expect("the binary was built")
}

/// Runs it, which must succeed; what it printed.
///
/// # Panics
/// With all that it printed when it fails.
pub fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "hatchery {arguments:?}: {}\n{}", output.status, printed(&output));
    String::from_utf8(output.stdout).expect("it prints text")
}

/// What a command printed, out and err, for messages.
pub fn printed(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The JSON document that a command prints with `--json`.
pub fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let text = succeed(folder, &[arguments, &["--json"]].concat());
    serde_json::from_str(&text)
        .unwrap_or_else(|error| panic!("hatchery {arguments:?} --json: {error}\n{text}"))
}

/// The JSON objects that a command prints, one a line, with `--json`.
pub fn json_lines(folder: &Path, arguments: &[&str]) -> Vec<serde_json::Value> {
    let text = succeed(folder, &[arguments, &["--json"]].concat());
    let read =
        |line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{arguments:?}: {error}\n{line}"));
    text.lines().map(read).collect()
}

/// The lineage hash of one experiment in the folder's `hatchery.db`.
pub fn hash(folder: &Path, experiment: &str) -> String {
    let answer = json(folder, &["hash", experiment]);
    let found = find(&answer, "hash").and_then(serde_json::Value::as_str);
    found.unwrap_or_else(|| panic!("no hash in {answer}")).to_owned()
}

/// The one whole number that a question in SQL comes to.
pub fn count(folder: &Path, sql: &str) -> i64 {
    let rows = json_lines(folder, &["sql", sql]);
    let number = rows.first().and_then(|row| row.as_object()?.values().next()?.as_i64());
    number.unwrap_or_else(|| panic!("{sql}: expected one whole number, found {rows:?}"))
}

/// The first value of a key, however deep.
fn find<'a>(value: &'a serde_json::Value, key: &str) -> Option<&'a serde_json::Value> {
    match value {
        serde_json::Value::Object(fields) => {
            fields.get(key).or_else(|| fields.values().find_map(|v| find(v, key)))
        }
        serde_json::Value::Array(items) => items.iter().find_map(|item| find(item, key)),
        _ => None,
    }
}

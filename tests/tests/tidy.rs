//! The rules of the house that a program can check. Each failure names the file and the line.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use hatchery_tests::programs::workspace;

/// What a crate of this workspace may depend on, of this workspace. Nothing may depend on a crate that is only
/// on the left.
const ARROWS: [(&str, &[&str]); 9] = [
    ("creatures", &[]),
    ("search", &["creatures"]),
    ("proto", &["creatures"]),
    ("coordinator", &["creatures", "search", "proto"]),
    ("worker", &["creatures", "proto"]),
    ("cli", &["creatures", "search", "proto", "coordinator", "worker"]),
    ("tests", &["creatures", "search", "proto", "coordinator", "worker"]),
    ("benches", &["creatures", "search", "proto", "coordinator", "worker", "tests"]),
    ("fuzz", &["creatures", "search", "proto", "coordinator"]),
];

/// What a pure crate may depend on: values in, values out. Whoever adds one has made sure that it has no
/// runtime, no clock, no thread and no hash order that shows.
const PURE_DEPENDENCIES: [&str; 15] = [
    "blake3",
    "ciborium",
    "creatures",
    "glam",
    "libm",
    "parry3d-f64",
    "rand",
    "rand_chacha",
    "rapier3d",
    "serde",
    "serde_json",
    "serde_path_to_error",
    "strsim",
    "thiserror",
    "toml",
];

/// What pure code does not say, tests apart. Clippy catches most of it by path; this catches it by word.
const IMPURE: [&str; 13] = [
    "HashMap",
    "HashSet",
    "std::fs",
    "std::net",
    "std::env",
    "std::process",
    "std::thread",
    "std::time",
    "async fn",
    "static mut",
    "thread_local!",
    "println!",
    "eprintln!",
];

/// The longest file that can still be one idea, lines.
const LINES_MAX: usize = 600;

#[test]
fn crates_depend_on_each_other_along_the_arrows_alone() {
    let packages: BTreeMap<String, &str> = ARROWS
        .iter()
        .map(|&(folder, _)| (manifest(folder)["package"]["name"].as_str().unwrap().to_owned(), folder))
        .collect();
    assert_eq!(
        members(),
        ARROWS.iter().map(|&(folder, _)| folder.to_owned()).collect(),
        "a crate without arrows"
    );
    for (folder, allowed) in ARROWS {
        let manifest = manifest(folder);
        for table in ["dependencies", "dev-dependencies", "build-dependencies"] {
            for name in keys(&manifest, table) {
                if let Some(other) = packages.get(&name) {
                    assert!(allowed.contains(other), "{folder}/Cargo.toml: {table} must not name {name}");
                }
            }
        }
    }
}

#[test]
fn pure_crates_name_no_runtime() {
    for folder in ["creatures", "search"] {
        for name in keys(&manifest(folder), "dependencies") {
            assert!(PURE_DEPENDENCIES.contains(&name.as_str()), "{folder}/Cargo.toml: is {name} pure?");
        }
    }
}

#[test]
fn pure_code_has_no_clock_no_file_no_thread_and_no_hash_order() {
    let mut found = Vec::new();
    for folder in ["creatures/src", "search/src"] {
        for file in files(folder, "rs").into_iter().filter(|file| !is_test(file)) {
            let text = read(&file);
            for (number, line) in product_lines(&text) {
                let code = line.split("//").next().unwrap();
                found.extend(
                    IMPURE.iter().filter(|word| code.contains(**word)).map(|word| at(&file, number, word)),
                );
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn versions_and_lints_are_said_once_for_the_whole_workspace() {
    for (folder, _) in ARROWS {
        let manifest = manifest(folder);
        assert_eq!(manifest["lints"]["workspace"].as_bool(), Some(true), "{folder}/Cargo.toml: lints");
        for table in ["dependencies", "dev-dependencies", "build-dependencies"] {
            for name in keys(&manifest, table) {
                let said = &manifest[table][&name];
                let inherited = said.get("workspace").and_then(toml::Value::as_bool) == Some(true);
                assert!(inherited, "{folder}/Cargo.toml: {name} says its version here, not in the workspace");
            }
        }
    }
}

#[test]
fn sql_stands_in_migrations_and_queries_alone() {
    let statements = [
        "SELECT ",
        "INSERT INTO",
        "INSERT OR ",
        "UPDATE ",
        "DELETE FROM",
        "CREATE TABLE",
        "CREATE VIEW",
        "DROP ",
    ];
    let mut found = Vec::new();
    for folder in ["creatures/src", "search/src", "proto/src", "coordinator/src", "worker/src", "cli/src"] {
        for file in files(folder, "rs").into_iter().filter(|file| !is_test(file)) {
            let text = read(&file);
            for (number, line) in product_lines(&text) {
                let trimmed = line.trim_start();
                // A statement begins a string; help texts may quote what a user types.
                let quoted = statements
                    .iter()
                    .find(|s| trimmed.contains(&format!("\"{s}")) && !trimmed.contains("hatchery sql"));
                if let Some(statement) = quoted.filter(|_| !trimmed.starts_with("//")) {
                    found.push(at(&file, number, statement));
                }
            }
        }
    }
    assert!(found.is_empty(), "SQL in code:\n{}", found.join("\n"));
}

#[test]
fn every_query_says_what_it_is_for() {
    let queries = files("coordinator/src/lineage/queries", "sql");
    assert!(!queries.is_empty(), "the lineage has queries");
    for file in queries {
        let text = read(&file);
        let name = file.file_stem().unwrap().to_str().unwrap();
        assert!(text.starts_with(&format!("-- {name}: ")), "{}: starts with `-- {name}: why`", shown(&file));
    }
}

#[test]
fn a_file_is_one_idea() {
    for file in files("", "rs") {
        let lines = read(&file).lines().count();
        assert!(lines < LINES_MAX, "{}: {lines} lines; what are its two ideas?", shown(&file));
    }
}

#[test]
fn a_file_says_on_top_what_it_is() {
    // Tests that outgrew their module are that module's.
    for file in files("", "rs").into_iter().filter(|file| file.file_name().unwrap() != "tests.rs") {
        let text = read(&file);
        // Inner attributes of a crate may come first.
        let first = text.lines().find(|line| !line.starts_with("#!") && !line.is_empty());
        assert!(first.is_some_and(|line| line.starts_with("//! ")), "{}: no `//!` on top", shown(&file));
    }
}

#[test]
fn nothing_is_left_for_later() {
    // In pieces, so that this file does not find itself.
    let words = [
        concat!("to", "do!"),
        concat!("unimple", "mented!"),
        concat!("TO", "DO"),
        concat!("FIX", "ME"),
        concat!("db", "g!("),
    ];
    let mut found = Vec::new();
    for extension in ["rs", "sql", "proto", "toml", "md", "py"] {
        for file in files("", extension) {
            for (number, line) in read(&file).lines().enumerate() {
                found.extend(
                    words.iter().filter(|word| line.contains(**word)).map(|word| at(&file, number + 1, word)),
                );
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn every_ready_experiment_has_a_smoke_profile() {
    let experiments = files("experiments", "toml");
    assert!(!experiments.is_empty(), "there are ready experiments");
    for file in experiments {
        let table: toml::Table =
            toml::from_str(&read(&file)).unwrap_or_else(|e| panic!("{}: {e}", shown(&file)));
        let smoke = table.get("profile").and_then(|profiles| profiles.get("smoke"));
        assert!(smoke.is_some_and(toml::Value::is_table), "{}: no [profile.smoke]", shown(&file));
    }
}

#[test]
fn links_of_the_documents_lead_somewhere() {
    let mut broken = Vec::new();
    for file in files("", "md") {
        for (number, line) in read(&file).lines().enumerate() {
            for target in links(line).into_iter().filter(|target| !target.contains("://")) {
                let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
                let goal = if path.is_empty() { file.clone() } else { file.parent().unwrap().join(path) };
                let missing =
                    !goal.exists() || (!anchor.is_empty() && !anchors(&read(&goal)).contains(anchor));
                broken.extend(missing.then(|| at(&file, number + 1, target)));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// Systems whose pages are held to their specifications' numbers: requirements, analytic tests, failure inputs.
const REQUIRED: [(&str, char, [u32; 3]); 2] = [("walkers", 'G', [77, 20, 23]), ("flyers", 'F', [73, 23, 16])];

#[test]
fn every_requirement_is_documented_and_cited_where_it_is_met() {
    let mut cited = BTreeSet::new();
    for folder in ["creatures", "search", "cli", "coordinator", "tests", "benches", "experiments"] {
        for extension in ["rs", "toml"] {
            for file in files(folder, extension) {
                cited.extend(citations(&read(&file)));
            }
        }
    }
    for (system, letter, [requirements, tests, failures]) in REQUIRED {
        let page = format!("docs/systems/{system}.md");
        let documented = citations(&read(&workspace().join(&page)));
        let required = [(letter, requirements), ('T', tests), ('X', failures)];
        for (letter, number) in required.into_iter().flat_map(|(l, most)| (1..=most).map(move |n| (l, n))) {
            assert!(documented.contains(&(letter, number)), "{page} lacks {letter}-{number}");
            assert!(cited.contains(&(letter, number)), "{letter}-{number} is cited nowhere in the code");
        }
    }
}

/// The members of the workspace, by folder.
fn members() -> BTreeSet<String> {
    let root: toml::Table = toml::from_str(&read(&workspace().join("Cargo.toml"))).unwrap();
    let members = root["workspace"]["members"].as_array().unwrap();
    members.iter().map(|member| member.as_str().unwrap().to_owned()).collect()
}

fn manifest(folder: &str) -> toml::Table {
    toml::from_str(&read(&workspace().join(folder).join("Cargo.toml"))).unwrap()
}

fn keys(manifest: &toml::Table, table: &str) -> Vec<String> {
    manifest.get(table).and_then(toml::Value::as_table).into_iter().flat_map(|t| t.keys().cloned()).collect()
}

/// Every file of an extension under a folder of the workspace, in order; built and hidden things left out.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![workspace().join(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap().to_str().unwrap();
            if path.is_dir() && !name.starts_with('.') && !["target", "results"].contains(&name) {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A file of tests: those of a crate, or those that outgrew their module.
fn is_test(file: &Path) -> bool {
    let relative = file.strip_prefix(workspace()).unwrap();
    relative.components().any(|part| part.as_os_str() == "tests") || file.file_name().unwrap() == "tests.rs"
}

/// The numbered lines of a file above its tests.
fn product_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line))
        .take_while(|(_, line)| *line != "#[cfg(test)]")
}

fn shown(file: &Path) -> String {
    file.strip_prefix(workspace()).unwrap_or(file).display().to_string()
}

fn at(file: &Path, line: usize, what: &str) -> String {
    format!("{}:{line}: {what}", shown(file))
}

/// The targets of `[words](target)` in a line of Markdown, code spans left out.
fn links(line: &str) -> Vec<&str> {
    let text = line.split('`').step_by(2);
    text.flat_map(|part| part.split("](").skip(1).filter_map(|rest| rest.split_once(')')))
        .map(|(t, _)| t)
        .collect()
}

/// The anchors of a page's headings, as the forges make them.
fn anchors(page: &str) -> BTreeSet<String> {
    let headings =
        page.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let letters = |heading: &str| {
        let kept = heading
            .to_lowercase()
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
            .collect::<String>();
        kept.replace(' ', "-")
    };
    headings.map(letters).collect()
}

/// Every requirement that a text names: `G-12`, and ranges such as `G-1..G-23` or `G-63..72` in full.
fn citations(text: &str) -> BTreeSet<(char, u32)> {
    let mut found = BTreeSet::new();
    let mut rest = text;
    let mut before = ' ';
    while let Some(at) = rest.find(['F', 'G', 'T', 'X']) {
        let letter = rest[at..].chars().next().unwrap();
        if at > 0 {
            before = rest[..at].chars().next_back().unwrap();
        }
        rest = &rest[at + 1..];
        let Some((first, after)) = number(rest.strip_prefix('-')).filter(|_| !before.is_alphanumeric())
        else {
            before = letter;
            continue;
        };
        let range_end =
            after.strip_prefix("..").map(|end| end.strip_prefix(&format!("{letter}-")).unwrap_or(end));
        let last = number(range_end).map_or(first, |(last, _)| last);
        found.extend((first..=last).map(|n| (letter, n)));
        (rest, before) = (after, '0');
    }
    found
}

/// The whole number that a text starts with, and what follows it.
fn number(text: Option<&str>) -> Option<(u32, &str)> {
    let text = text?;
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    Some((text[..end].parse().ok()?, &text[end..]))
}

#[test]
fn citations_are_found_alone_and_in_ranges() {
    let found = citations("G-12, (X-5) walker T-1..T-3 G-63..65 flyer F-7 EF-8 AG-9 G-x");
    let expected =
        [('F', 7), ('G', 12), ('G', 63), ('G', 64), ('G', 65), ('T', 1), ('T', 2), ('T', 3), ('X', 5)];
    assert_eq!(found, BTreeSet::from(expected));
}

//! The bits of every system, against files: the same from debug and release builds, from this release and the
//! next. `HATCHERY_BIN_DIR=target/release` tests the release build's binary; `UPDATE_GOLDEN=1` writes the files
//! anew, after a change that is meant to move them.

use std::fmt::Write;
use std::path::Path;

use hatchery_tests::command::{json, succeed};
use hatchery_tests::programs::workspace;

/// Four bodies under two controllers.
#[test]
fn every_body_and_controller_gives_the_golden_lineage() {
    compare("walkers", 8);
}

/// Thin air and the default one, with culling.
#[test]
fn flyers_give_the_golden_lineage() {
    compare("flyers", 2);
}

/// Practice with tied and with full samples.
#[test]
fn fishes_give_the_golden_lineage() {
    compare("fishes", 2);
}

/// Ten skills, small and short, each of a task of its own, learned by who was picked for the one before (ESP E-92).
#[test]
fn esp_creatures_give_the_golden_lineage() {
    let file = workspace().join("experiments/fight-or-flight.toml");
    compare_file("esp", &file, &["--profile", "smoke"], "fight-or-flight", 1);
}

/// Runs `golden/NAME.toml`, a matrix called `golden`, and compares the hash of each cell with `golden/NAME.hashes`.
fn compare(name: &str, cells: usize) {
    compare_file(name, &workspace().join(format!("tests/golden/{name}.toml")), &[], "golden", cells);
}

/// The same for any file, run with further arguments, and the experiment or matrix that it names.
fn compare_file(name: &str, file: &Path, arguments: &[&str], named: &str, cells: usize) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = file.to_str().expect("a path of letters");
    succeed(folder.path(), &[&["run", file, "--workers", "2"], arguments].concat());
    let answer = json(folder.path(), &["hash", named]);
    let mut found = String::new();
    for cell in answer.as_array().unwrap_or_else(|| panic!("a list of hashes: {answer}")) {
        let name = cell["name"].as_str().expect("a cell has a name");
        writeln!(found, "{} {name}", cell["hash"].as_str().expect("in hexadecimal"))
            .expect("a string takes all");
    }
    assert_eq!(found.lines().count(), cells, "{found}");
    let hashes = workspace().join(format!("tests/golden/{name}.hashes"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&hashes, &found).expect("the workspace is writable");
    }
    let expected = std::fs::read_to_string(&hashes).expect("committed with the sources");
    assert_eq!(found, expected, "the same experiment no longer gives the same lineage");
}

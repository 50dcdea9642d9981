//! The bits of every system, against files: the same from debug and release builds, from this release and the
//! next. `HATCHERY_BIN_DIR=target/release` tests the release build's binary; `UPDATE_GOLDEN=1` writes the files
//! anew, after a change that is meant to move them.

use std::fmt::Write;

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

/// Runs `golden/NAME.toml`, a matrix called `golden`, and compares the hash of each cell with `golden/NAME.hashes`.
fn compare(name: &str, cells: usize) {
    let golden = workspace().join("tests/golden");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = golden.join(format!("{name}.toml"));
    succeed(folder.path(), &["run", file.to_str().expect("a path of letters"), "--workers", "2"]);
    let answer = json(folder.path(), &["hash", "golden"]);
    let mut found = String::new();
    for cell in answer.as_array().unwrap_or_else(|| panic!("a list of hashes: {answer}")) {
        let name = cell["name"].as_str().expect("a cell has a name");
        writeln!(found, "{} {name}", cell["hash"].as_str().expect("in hexadecimal"))
            .expect("a string takes all");
    }
    assert_eq!(found.lines().count(), cells, "{found}");
    let hashes = golden.join(format!("{name}.hashes"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&hashes, &found).expect("the workspace is writable");
    }
    let expected = std::fs::read_to_string(&hashes).expect("committed with the sources");
    assert_eq!(found, expected, "the same experiment no longer gives the same lineage");
}

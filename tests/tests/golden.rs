//! The bits of every walker under both controllers, against a file: the same from debug and release builds, from
//! this release and the next. `HATCHERY_BIN_DIR=target/release` tests the release build's binary;
//! `UPDATE_GOLDEN=1` writes the file anew, after a change that is meant to move it.

use std::fmt::Write;

use hatchery_tests::command::{json, succeed};
use hatchery_tests::programs::workspace;

#[test]
fn every_body_and_controller_gives_the_golden_lineage() {
    let golden = workspace().join("tests/golden");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = golden.join("walkers.toml");
    succeed(folder.path(), &["run", file.to_str().expect("a path of letters"), "--workers", "2"]);
    let answer = json(folder.path(), &["hash", "golden"]);
    let mut found = String::new();
    for cell in answer.as_array().unwrap_or_else(|| panic!("a list of hashes: {answer}")) {
        let name = cell["name"].as_str().expect("a cell has a name");
        writeln!(found, "{} {name}", cell["hash"].as_str().expect("in hexadecimal"))
            .expect("a string takes all");
    }
    assert_eq!(found.lines().count(), 8, "four bodies under two controllers:\n{found}");
    let hashes = golden.join("walkers.hashes");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&hashes, &found).expect("the workspace is writable");
    }
    let expected = std::fs::read_to_string(&hashes).expect("committed with the sources");
    assert_eq!(found, expected, "the same experiment no longer gives the same lineage");
}

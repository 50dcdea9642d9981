//! The binaries under test: those of this workspace, built once a test process with the profile of the tests
//! themselves, so that they are never stale; or, with `HATCHERY_BIN_DIR`, those of a folder, built beforehand.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// The folder of the workspace.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests are a folder of the workspace")
}

/// The path of a binary: `hatchery`, `hatchery-coordinator`, `hatchery-worker` or `fragile-worker`.
///
/// # Panics
/// When the workspace does not build, or has no binary of that name.
pub fn program(name: &str) -> PathBuf {
    static BUILT: LazyLock<PathBuf> = LazyLock::new(build);
    // The fragile worker is a tool of these tests, not under test: it is always built.
    let folder = match std::env::var_os("HATCHERY_BIN_DIR") {
        Some(folder) if name != "fragile-worker" => workspace().join(folder),
        _ => BUILT.clone(),
    };
    let path = folder.join(name);
    assert!(path.is_file(), "there is no binary {}", path.display());
    path
}

/// Builds every binary and gives the folder that holds them.
///
/// The workspace is built whole with its test targets, because that is the selection of `cargo test
/// --workspace`: the same features, so nothing is compiled again.
fn build() -> PathBuf {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(workspace()).args(["build", "--quiet", "--offline", "--bins"]);
    cargo.args(["-p", "hatchery", "-p", "coordinator", "-p", "worker", "-p", "hatchery-tests"]);
    if !cfg!(debug_assertions) {
        cargo.arg("--release");
    }
    let status = cargo.status().expect("cargo runs these tests, so it can be started");
    assert!(status.success(), "the binaries do not build");
    // Tests lie in `target/PROFILE/deps/`, benches in `target/PROFILE/`.
    let own = std::env::current_exe().expect("a running program has a path");
    let folder = own.parent().expect("a program lies in a folder");
    if folder.ends_with("deps") {
        folder.parent().expect("deps is a folder of the profile's")
    } else {
        folder
    }
    .to_owned()
}

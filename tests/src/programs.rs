//! The binaries under test: those of this workspace, built with the profile of the tests themselves and never
//! stale; or, with `HATCHERY_BIN_DIR`, those of a folder, built beforehand.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::time::SystemTime;

/// The folder of the workspace.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests are a folder of the workspace")
}

/// The path of a binary: one of [`PROGRAMS`].
///
/// # Panics
/// When the workspace does not build, or has no binary of that name.
pub fn program(name: &str) -> PathBuf {
    static BUILT: LazyLock<PathBuf> = LazyLock::new(build);
    // Workers with something wrong with them are tools of these tests, not under test: they are always built.
    let folder = match std::env::var_os("HATCHERY_BIN_DIR") {
        Some(folder) if !["fragile-worker", "lying-worker"].contains(&name) => workspace().join(folder),
        _ => BUILT.clone(),
    };
    let path = folder.join(name);
    assert!(path.is_file(), "there is no binary {}", path.display());
    path
}

/// The folder of the binaries, after building what is not there or older than its sources.
///
/// `cargo test --workspace` has built them all; a test of this crate alone may find them stale.
fn build() -> PathBuf {
    // Tests lie in `target/PROFILE/deps/`, benches in `target/PROFILE/`.
    let own = std::env::current_exe().expect("a running program has a path");
    let folder = own.parent().expect("a program lies in a folder");
    let folder = if folder.ends_with("deps") { folder.parent().expect("deps has a parent") } else { folder };
    let sources = CRATES.iter().map(|name| newest(&workspace().join(name))).max().flatten();
    let fresh = |name: &&str| modified(&folder.join(name)) >= sources;
    if !PROGRAMS.iter().all(fresh) {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        // All of the workspace, as everywhere: a part of it would be built anew with other features.
        cargo.current_dir(workspace()).args(["build", "--quiet", "--bins", "--workspace"]);
        if !cfg!(debug_assertions) {
            cargo.arg("--release");
        }
        let status = cargo.status().expect("cargo runs these tests, so it can be started");
        assert!(status.success(), "the binaries do not build");
    }
    folder.to_owned()
}

/// The binaries of this workspace that tests start.
pub const PROGRAMS: [&str; 5] =
    ["hatchery", "hatchery-coordinator", "hatchery-worker", "fragile-worker", "lying-worker"];

/// What the programs are made of.
const CRATES: [&str; 9] =
    ["creatures", "search", "proto", "coordinator", "worker", "cli", "migrations", "tests/src", "Cargo.lock"];

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().and_then(|metadata| metadata.modified()).ok()
}

/// When the youngest file under a path was written.
fn newest(path: &Path) -> Option<SystemTime> {
    let Ok(entries) = std::fs::read_dir(path) else { return modified(path) };
    entries.flatten().map(|entry| newest(&entry.path())).max().flatten()
}

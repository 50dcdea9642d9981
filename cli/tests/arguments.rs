//! The binary as a user meets it before any experiment runs: usage, exit codes, `check`, completions.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use assert_cmd::Command;
use tempfile::TempDir;

/// The binary in a folder of its own, with nothing in the environment that would answer for it.
fn hatchery(folder: &TempDir) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hatchery"));
    command.current_dir(folder.path());
    for name in ["HATCHERY_JOIN", "HATCHERY_JOIN_FILE", "HATCHERY_COORDINATOR", "HATCHERY_DB", "HATCHERY_LOG"]
    {
        command.env_remove(name);
    }
    command
}

fn folder() -> TempDir {
    TempDir::new().unwrap()
}

struct Ended {
    code: i32,
    out: String,
    err: String,
}

fn end(command: &mut Command) -> Ended {
    let output = command.output().unwrap();
    Ended {
        code: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

const PROBE: &str =
    "name = \"load\"\nsystem = \"probe\"\n[search]\nkind = \"probe\"\npopulation = 8\ngenerations = 3\n";

#[test]
fn wrong_usage_exits_with_2_and_help_with_0() {
    let folder = folder();
    for wrong in [&["frobnicate"][..], &["run"], &["best", "last", "--limit", "0"], &["export", "v_nothing"]]
    {
        assert_eq!(end(hatchery(&folder).args(wrong)).code, 2, "{wrong:?}");
    }
    let help = end(hatchery(&folder).arg("--help"));
    assert_eq!(help.code, 0);
    assert!(help.out.contains("hatchery run experiments/quickstart.toml"));
    assert!(!help.out.contains("leashed"), "the worker's subcommand is hidden");
}

#[test]
fn every_command_explains_itself() {
    let folder = folder();
    let commands = "run check submit list status watch pause resume cancel workers best show lineage sql hash export \
                    replay compare completions";
    for command in commands.split_whitespace() {
        let help = end(hatchery(&folder).args([command, "--help"]));
        assert_eq!(help.code, 0, "{command}");
        assert!(help.out.contains(&format!("Usage: hatchery {command}")), "{}", help.out);
    }
}

#[test]
fn a_good_file_is_good_and_its_resolved_text_is_a_file_of_the_same_experiment() {
    let folder = folder();
    let file = folder.path().join("load.toml");
    std::fs::write(&file, PROBE).unwrap();
    let good = end(hatchery(&folder).args(["check", "load.toml"]));
    assert_eq!((good.code, good.err.as_str()), (0, ""));
    assert!(
        good.out.starts_with("load.toml: good\n") && good.out.contains("= 24 individuals"),
        "{}",
        good.out
    );

    let set = ["--set", "search.population=16"];
    let resolved = end(hatchery(&folder).args(["check", "load.toml", "--resolved"]).args(set));
    assert!(resolved.out.contains("population = 16"), "{}", resolved.out);
    std::fs::write(&file, &resolved.out).unwrap();
    let again = end(hatchery(&folder).args(["check", "load.toml", "--resolved"]));
    assert_eq!(again.out, resolved.out);
}

#[test]
fn a_bad_file_names_file_line_and_column_and_creates_nothing() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.toml"), PROBE.replace("population", "populatoin")).unwrap();
    for command in ["check", "run"] {
        let bad = end(hatchery(&folder).args([command, "bad.toml"]));
        assert_eq!(bad.code, 2, "{command}: {}", bad.err);
        assert!(bad.err.contains("bad.toml:5:1: error: "), "{command}: {}", bad.err);
        assert!(bad.err.contains("populatoin") && bad.err.contains("population"), "{command}: {}", bad.err);
        assert_eq!(bad.out, "");
    }
    let left: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["bad.toml"], "nothing was created");
}

#[test]
fn problems_are_json_where_json_is_asked_for() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.toml"), PROBE.replace("= 8", "= \"many\"")).unwrap();
    let bad = end(hatchery(&folder).args(["--json", "check", "bad.toml"]));
    assert_eq!((bad.code, bad.out.as_str()), (2, ""));
    let error: serde_json::Value = serde_json::from_str(&bad.err).unwrap();
    assert_eq!(error["error"]["kind"], "problems");
    let problem = &error["error"]["problems"][0];
    assert_eq!((&problem["key"], &problem["line"]), (&"search.population".into(), &5.into()));
}

#[test]
fn a_file_that_is_not_there_exits_with_3() {
    let folder = folder();
    for arguments in [&["check", "none.toml"][..], &["run", "none.toml"], &["list", "--db", "none.db"]] {
        let ended = end(hatchery(&folder).args(arguments));
        assert_eq!(ended.code, 3, "{arguments:?}: {}", ended.err);
        assert!(ended.err.contains("no such file"), "{arguments:?}: {}", ended.err);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing was created");
}

#[test]
fn a_coordinator_that_does_not_answer_exits_with_4_and_one_that_is_no_url_with_2() {
    let folder = folder();
    // A port that was free a moment ago.
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let nobody = end(hatchery(&folder).args(["list", "--coordinator", &format!("http://127.0.0.1:{port}")]));
    assert_eq!(nobody.code, 4, "{}", nobody.err);
    assert!(nobody.err.contains("no coordinator answers"), "{}", nobody.err);
    let wrong = end(hatchery(&folder).env("HATCHERY_COORDINATOR", "ftp://head:1").arg("list"));
    assert_eq!(wrong.code, 2, "{}", wrong.err);
}

#[test]
fn a_file_that_is_no_lineage_is_refused_and_left_as_it_is() {
    let folder = folder();
    let path = folder.path().join("notes.db");
    std::fs::write(&path, "these are no pages of a database, but a text that is long enough to be read")
        .unwrap();
    let before = std::fs::read(&path).unwrap();
    std::fs::write(folder.path().join("probe.toml"), PROBE).unwrap();
    for command in [
        &["list"][..],
        &["status", "1"],
        &["best", "1"],
        &["sql", "SELECT 1"],
        &["hash", "1"],
        &["replay", "1"],
        &["compare", "1"],
        &["pick", "1", "1"],
        &["cancel", "1"],
        &["run", "probe.toml"],
    ] {
        let ended = end(hatchery(&folder).args(command).args(["--db", "notes.db"]));
        assert_eq!(ended.code, 2, "{command:?}: {}", ended.err);
        assert_eq!(ended.err.trim_end(), "error: notes.db: not a lineage (not an SQLite database)");
    }
    assert_eq!(std::fs::read(&path).unwrap(), before);
}

#[test]
fn a_usage_error_is_one_json_object_where_json_is_asked_for() {
    let folder = folder();
    for arguments in [&["frobnicate", "--json"][..], &["--json", "best"], &["list", "--json", "--port", "1"]]
    {
        let ended = end(hatchery(&folder).args(arguments));
        let error: serde_json::Value = serde_json::from_str(&ended.err).unwrap();
        assert_eq!((ended.code, &ended.out[..], &error["error"]["kind"]), (2, "", &"usage".into()));
        let message = error["error"]["message"].as_str().unwrap();
        assert!(message.contains("Usage: hatchery") && !message.starts_with("error"), "{message}");
    }
    let text = end(hatchery(&folder).args(["list", "--port", "1"]));
    assert!(text.err.starts_with("error: unexpected argument"), "{}", text.err);
    let help = end(hatchery(&folder).args(["list", "--json", "--help"]));
    assert!(help.code == 0 && help.out.contains("Usage: hatchery list"), "{}", help.out);
}

#[test]
fn check_reads_every_profile_unless_one_is_chosen() {
    let folder = folder();
    let profiles = "[profile.smoke.search]\ngenerations = 1\n[profile.large.search]\npopulation = 0\n\
                    [profile.long.search]\ngenerations = 1\ngenerationen = 2\n";
    std::fs::write(folder.path().join("a.toml"), format!("{PROBE}{profiles}")).unwrap();
    let ended = end(hatchery(&folder).args(["check", "a.toml"]));
    assert_eq!(ended.code, 2);
    let lines: Vec<&str> = ended.err.lines().collect();
    assert_eq!(lines.len(), 2, "{}", ended.err);
    assert!(lines[0].starts_with("a.toml:10:") && lines[0].contains("population"), "{}", ended.err);
    assert!(lines[1].starts_with("a.toml:13:") && lines[1].contains("generationen"), "{}", ended.err);
    let ended = end(hatchery(&folder).args(["check", "a.toml", "--profile", "smoke"]));
    assert_eq!((ended.code, ended.out.lines().next().unwrap()), (0, "a.toml: good"), "{}", ended.err);
}

#[test]
fn there_are_completions_for_five_shells() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = end(hatchery(&folder).args(["completions", shell]));
        assert_eq!(script.code, 0, "{shell}");
        for command in ["lineage", "compare"] {
            assert!(script.out.contains(command), "{shell} does not know {command}");
        }
    }
}

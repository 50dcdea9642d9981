//! `hatchery run` as a user meets it: what is said when it is killed, piped away, or begun again.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

const SHORT: &str =
    "name = \"load\"\nsystem = \"probe\"\n[search]\nkind = \"probe\"\npopulation = 8\ngenerations = 3\n";
/// Two milliseconds an evaluation: it is not over before a test has had its way.
const LONG: &str = "name = \"load\"\nsystem = \"probe\"\n[task]\nwork = 20000\n[search]\nkind = \"probe\"\n\
                    population = 8\ngenerations = 100000\n";

/// Fishes have muscles to be drawn, and forty steps are soon lived.
const FISH: &str = "name = \"fish\"\nsystem = \"fish\"\n[task]\nscenario = \"drill\"\nlesson.steps = 40\n[search]\n\
                    kind = \"anneal\"\nchains = 2\nsteps = 1\n";

/// A folder with an experiment file.
fn folder(text: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("a.toml"), text).unwrap();
    folder
}

fn hatchery(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hatchery"));
    command.current_dir(folder).args(arguments);
    for name in ["HATCHERY_JOIN", "HATCHERY_JOIN_FILE", "HATCHERY_COORDINATOR", "HATCHERY_DB", "HATCHERY_LOG"]
    {
        command.env_remove(name);
    }
    command
}

/// What a command printed; it must end with this exit code.
fn end(command: &mut Command, code: i32) -> String {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = format!("{}{}", String::from_utf8_lossy(&stdout), String::from_utf8_lossy(&stderr));
    assert_eq!(status.code(), Some(code), "{command:?}: {text}");
    text
}

fn status(folder: &Path) -> Value {
    serde_json::from_str(&end(&mut hatchery(folder, &["status", "last", "--json"]), 0)).unwrap()
}

/// A run under way, with outcomes on disk. Killed when it is dropped.
struct Run(Child);

impl Run {
    fn begin(folder: &Path) -> Run {
        let mut command = hatchery(folder, &["run", "a.toml", "--workers", "1"]);
        let run = Run(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());
        let deadline = Instant::now() + Duration::from_secs(60);
        let has_outcomes = || {
            let listed = hatchery(folder, &["status", "last", "--json"]).output().unwrap().stdout;
            serde_json::from_slice::<Value>(&listed).is_ok_and(|status| status["evaluated"] != 0)
        };
        while !has_outcomes() {
            assert!(Instant::now() < deadline, "nothing is evaluated");
        }
        run
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_killed_run_is_interrupted_and_is_cancelled_in_its_file() {
    let folder = folder(LONG);
    let folder = folder.path();
    let run = Run::begin(folder);
    assert_eq!(status(folder)["state"], "running");
    let at_work = end(&mut hatchery(folder, &["cancel", "last", "--db", "hatchery.db"]), 1);
    assert!(
        at_work.contains("in use by another coordinator") && at_work.contains("--coordinator"),
        "{at_work}"
    );
    drop(run);
    let listed = end(&mut hatchery(folder, &["list"]), 0);
    assert!(listed.contains("interrupted"), "{listed}");
    let killed = status(folder);
    assert_eq!(killed["state"], "interrupted");
    assert!(killed["reason"].as_str().unwrap().contains("run again"), "{killed}");
    let paused = end(&mut hatchery(folder, &["pause", "load", "--db", "hatchery.db"]), 0);
    assert!(paused.contains("paused"), "{paused}");
    end(&mut hatchery(folder, &["cancel", "load", "--db", "hatchery.db"]), 0);
    let cancelled = status(folder);
    assert_eq!((&cancelled["state"], &cancelled["evaluated"]), (&"cancelled".into(), &killed["evaluated"]));
    let refused = end(&mut hatchery(folder, &["resume", "load", "--db", "hatchery.db"]), 1);
    assert!(refused.contains("is cancelled"), "{refused}");
}

#[test]
fn a_run_that_nobody_reads_ends_in_order_and_says_how_to_go_on() {
    let folder = folder(LONG);
    let mut run = Run::begin(folder.path());
    let mut out = BufReader::new(run.0.stdout.take().unwrap());
    out.read_line(&mut String::new()).unwrap();
    drop(out);
    let mut said = String::new();
    run.0.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(run.0.wait().unwrap().code(), Some(130), "{said}");
    assert!(said.contains("goes on with it: hatchery run a.toml") && !said.contains("panicked"), "{said}");
}

#[test]
fn a_file_whose_experiment_is_over_begins_a_new_one_and_says_so() {
    let folder = folder(SHORT);
    let run = || end(&mut hatchery(folder.path(), &["run", "a.toml", "--workers", "1"]), 0);
    assert!(!run().contains("a new experiment"));
    let again = run();
    assert!(again.contains("load in this lineage is over: a new experiment begins, load-2\n"), "{again}");
}

#[test]
fn what_is_set_for_other_workers_does_not_reach_those_of_a_run() {
    let folder = folder(SHORT);
    let mut command = hatchery(folder.path(), &["run", "a.toml", "--workers", "1"]);
    for (name, value) in [
        ("HATCHERY_WORKER", "the only one"),
        ("HATCHERY_SLOTS", "none"),
        ("HATCHERY_TIME_LIMIT", "1s"),
        ("HATCHERY_IDLE_TIMEOUT", "soon"),
        ("HATCHERY_GRACE", "-"),
        ("HATCHERY_JOIN", "hatchery://elsewhere"),
        ("HATCHERY_JOIN_FILE", "nowhere"),
        ("HATCHERY_COORDINATOR", "http://127.0.0.1:1"),
    ] {
        command.env(name, value);
    }
    end(&mut command, 0);
    let sql = "SELECT slots, name = 'the only one' AS named FROM v_workers";
    let worker = end(&mut hatchery(folder.path(), &["sql", sql, "--json"]), 0);
    let worker: Value = serde_json::from_str(&worker).unwrap();
    assert_eq!(worker, serde_json::json!({ "slots": 1, "named": 0 }));
}

#[test]
fn a_fork_after_the_last_stage_is_refused() {
    let folder = folder(SHORT);
    end(&mut hatchery(folder.path(), &["run", "a.toml", "--workers", "1"]), 0);
    let refused = end(&mut hatchery(folder.path(), &["fork", "last", "--after", "0"]), 1);
    assert!(refused.contains("nothing comes after stage `0`") && refused.contains("--seed"), "{refused}");
    let count =
        end(&mut hatchery(folder.path(), &["sql", "SELECT count(*) AS n FROM v_experiments", "--json"]), 0);
    assert_eq!(count.trim_end(), "{\"n\":1}");
}

#[test]
fn lives_are_drawn_beside_each_other_and_files_are_whole_or_not_there() {
    let folder = folder(FISH);
    let folder = folder.path();
    end(&mut hatchery(folder, &["run", "a.toml", "--workers", "1"]), 0);
    let beside = ["replay", "1", "--beside", "2"];
    let drawn = ["--film", "f.png", "--muscles", "m.svg", "--from", "0.1", "--to", "1"];
    let said = end(&mut hatchery(folder, &[&beside[..], &drawn].concat()), 0);
    assert_eq!(said.matches("equal bit for bit").count(), 2, "{said}");
    assert!(std::fs::read(folder.join("f.png")).unwrap().starts_with(b"\x89PNG"));
    let chart = std::fs::read_to_string(folder.join("m.svg")).unwrap();
    for name in ["1 (", "2 ("] {
        assert!(chart.contains(&format!("{name}random, generation 1)")), "{name}");
    }
    let late = end(&mut hatchery(folder, &[&beside[..], &["--film", "g.png", "--from", "100"]].concat()), 3);
    assert!(late.contains("the trial ends at"), "{late}");
    for option in ["--film", "--picture", "--muscles", "--recording"] {
        let said = end(&mut hatchery(folder, &["replay", "1", option, "nowhere/g.png"]), 1);
        assert_eq!(said.trim_end(), "error: nowhere/g.png: No such file or directory (os error 2)");
    }
    let names =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(names.filter(|name| name.contains("g.png") || name.contains(".part")).count(), 0);
}

//! Every command of `hatchery`, on a finished lineage file: what it exits with, what `--json` gives, and what it
//! says of bad input.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use hatchery_tests::client::PATIENCE;
use hatchery_tests::command::{count, hatchery, json, json_lines, printed, run, start, succeed};
use hatchery_tests::programs::program;
use hatchery_tests::samples::{culled, probe, walkers};
use hatchery_tests::{Hatchery, local};
use rustix::process::Signal;
use tempfile::TempDir;

/// What the finished lineage holds.
static EXPERIMENT: LazyLock<String> = LazyLock::new(|| culled(&walkers("crawler", "grn", 41, 12, 3)));

/// A folder with a finished `hatchery.db`, made once a process.
fn finished() -> &'static Path {
    static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("experiment.toml"), &*EXPERIMENT).expect("the folder is writable");
        succeed(folder.path(), &["run", "experiment.toml", "--workers", "2"]);
        folder
    });
    FOLDER.path()
}

/// The number of the best individual.
fn best() -> String {
    let best = json(finished(), &["best", "last"]);
    let text = best.to_string();
    let individual = best.pointer("/0/id").unwrap_or_else(|| panic!("no best individual in {text}"));
    individual.to_string()
}

/// Runs a command that must fail in a certain way; what it printed.
fn refused(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(code), "hatchery {arguments:?}:\n{}", printed(&output));
    printed(&output)
}

#[test]
fn an_embedded_run_leaves_the_lineage_that_every_other_run_leaves() {
    assert_eq!(hatchery_tests::command::hash(finished(), "last"), local::lineage(&EXPERIMENT));
}

#[test]
fn commands_that_ask_answer_from_the_file_alone() {
    let best = best();
    for arguments in [
        vec!["list"],
        vec!["status", "last"],
        vec!["best", "last", "--limit", "3"],
        vec!["show", &best],
        vec!["lineage", &best],
        vec!["lineage", &best, "--line"],
        vec!["lineage", &best, "--depth", "1"],
        vec!["sql", "SELECT generation, max(fitness) FROM v_individuals GROUP BY generation"],
        vec!["hash", "last"],
        vec!["replay", &best],
        vec!["export", "v_generations", "--format", "csv"],
    ] {
        assert!(!succeed(finished(), &arguments).is_empty(), "hatchery {arguments:?} printed nothing");
    }
}

#[test]
fn json_has_the_same_keys_whatever_it_tells_of() {
    let best = best();
    let status = json(finished(), &["status", "last"]);
    for key in
        ["id", "name", "system", "search", "state", "seed", "runs", "individuals", "evaluated", "culled"]
    {
        assert!(status.get(key).is_some(), "status lacks `{key}`: {status}");
    }
    assert_eq!(status["state"], "finished");
    assert_eq!(status["evaluated"], 216);
    let shown = json(finished(), &["show", &best]);
    for key in [
        "id",
        "run",
        "stage",
        "generation",
        "index",
        "operator",
        "status",
        "fitness",
        "traits",
        "genotype",
        "parents",
    ] {
        assert!(shown.get(key).is_some(), "show lacks `{key}`: {shown}");
    }
    assert_eq!(shown["id"].to_string(), best);
}

#[test]
fn a_replay_gives_the_recorded_fitness_bit_for_bit() {
    // Every individual that was evaluated, the culled ones too.
    for row in json_lines(finished(), &["sql", "SELECT id FROM v_individuals ORDER BY id LIMIT 12"]) {
        succeed(finished(), &["replay", &row["id"].to_string()]);
    }
    let culled =
        json_lines(finished(), &["sql", "SELECT id FROM v_individuals WHERE status = 'culled' LIMIT 3"]);
    assert!(!culled.is_empty(), "seed 41 has culls");
    for row in culled {
        succeed(finished(), &["replay", &row["id"].to_string()]);
    }
}

#[test]
fn a_replay_records_and_draws_what_it_lived() {
    let (folder, best) = (finished(), best());
    let files = ["--recording", "best.jsonl", "--picture", "best.png"];
    let said = json(folder, &[&["replay", &best][..], &files].concat());
    assert_eq!((&said["equal"], &said["recording"]), (&true.into(), &"best.jsonl".into()));
    let text = std::fs::read_to_string(folder.join("best.jsonl")).expect("a recording");
    let lines: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).expect("a JSON object a line")).collect();
    let (header, frames) = lines.split_first().expect("a header");
    assert_eq!(header["individual"].to_string(), best);
    assert_eq!(header["frames"], frames.len());
    assert_eq!(frames.len() as u64, 1 + said["replayed"]["steps"].as_u64().expect("steps"));
    assert!(std::fs::read(folder.join("best.png")).expect("a picture").starts_with(b"\x89PNG"));

    succeed(folder, &["replay", &best, "--recording", "tenth.jsonl", "--every", "10"]);
    let tenth = std::fs::read_to_string(folder.join("tenth.jsonl")).expect("a recording");
    assert_eq!(tenth.lines().nth(2), text.lines().nth(11), "the tenth step follows the start");
}

/// Every question of the findings (flyer Q-1 to Q-9, ESP R-1 to R-12) is a statement that the views answer.
#[test]
fn findings_are_asked_of_a_lineage_by_one_script() {
    let findings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments/findings");
    let ask = |questions: &str| {
        let output = std::process::Command::new("sh")
            .args([findings.join("ask.sh"), findings.join(questions), finished().join("hatchery.db")])
            .env("HATCHERY", program("hatchery"))
            .output()
            .expect("there is a shell");
        assert!(output.status.success(), "{questions}: {}", printed(&output));
        printed(&output)
    };
    let said = ask("flyers.sql");
    for question in ["Q-1:", "Q-2:", "Q-3:", "Q-4 and Q-9:", "Q-5:", "Q-6:", "Q-7:", "Q-8:"] {
        assert!(said.contains(question), "{question} in {said}");
    }
    assert_eq!(said.matches("rank_correlation").count(), 1, "the questions are answered: {said}");
    let said = ask("syllabus.sql");
    for (question, column) in
        [("R-1, R-3:", "reconciling"), ("R-2:", "spread"), ("R-6:", "first"), ("R-7, R-8, R-12:", "skeleton")]
    {
        assert!(said.contains(question) && said.contains(column), "{question} in {said}");
    }
}

#[test]
fn what_cannot_be_recorded_or_drawn_is_said() {
    let (folder, best) = (finished(), best());
    let said = refused(folder, &["replay", &best, "--picture", "b.png", "--trial", "2"], 3);
    assert!(said.contains("no trial 2, only 1"), "{said}");
    assert!(!folder.join("b.png").exists());
    refused(folder, &["replay", &best, "--picture", "b.svg"], 2);
    refused(folder, &["replay", &best, "--trial", "0"], 2);
    std::fs::write(
        folder.join("light.toml"),
        "point = [{ at = 0, ahead = 1, left = 0 }, { at = 1, ahead = 1, left = 1 }]",
    )
    .expect("the folder is writable");
    let said = refused(folder, &["replay", &best, "--light", "light.toml"], 2);
    assert!(said.contains("only esp creatures see lights"), "{said}");
    let said = refused(folder, &["replay", &best, "--recording", "nowhere/b.jsonl"], 1);
    assert!(said.contains("nowhere/b.jsonl"), "{said}");
}

#[test]
fn an_export_has_a_header_and_a_row_each_in_both_formats() {
    let csv = succeed(finished(), &["export", "v_individuals", "--format", "csv"]);
    let mut lines = csv.lines();
    assert!(lines.next().is_some_and(|header| header.starts_with("id,")), "{csv}");
    assert_eq!(lines.count(), 216);
    let ndjson =
        succeed(finished(), &["export", "v_individuals", "--format", "ndjson", "--experiment", "last"]);
    assert_eq!(ndjson.lines().count(), 216);
    for line in ndjson.lines() {
        let row: serde_json::Value = serde_json::from_str(line).expect("one JSON object a line");
        assert!(row["fitness"].is_number(), "{line}");
    }
    succeed(finished(), &["export", "v_parents", "--format", "csv", "-o", "parents.csv"]);
    assert!(finished().join("parents.csv").is_file());
}

#[test]
fn what_does_not_exist_is_not_found() {
    for arguments in [
        vec!["status", "99"],
        vec!["status", "nobody"],
        vec!["best", "99"],
        vec!["show", "999999"],
        vec!["lineage", "999999"],
        vec!["hash", "nobody"],
        vec!["replay", "999999"],
    ] {
        refused(finished(), &arguments, 3);
    }
}

#[test]
fn wrong_usage_exits_with_2_and_a_coordinator_that_is_away_with_4() {
    for arguments in
        [vec!["frobnicate"], vec!["best"], vec!["export", "v_nothing"], vec!["show", "last-but-one"]]
    {
        refused(finished(), &arguments, 2);
    }
    // A port that was free a moment ago.
    let port = std::net::TcpListener::bind("127.0.0.1:0")
        .and_then(|listener| listener.local_addr())
        .expect("a port");
    for command in ["list", "workers"] {
        let said = refused(finished(), &[command, "--coordinator", &format!("http://{port}")], 4);
        assert!(said.contains(&port.to_string()), "it says what it dialled: {said}");
    }
}

#[test]
fn a_bad_experiment_file_is_refused_by_line_and_column_and_nothing_is_made() {
    let good = walkers("crawler", "grn", 1, 12, 3);
    let cases = [
        ("an unknown key", good.replace("population", "popluation"), "popluation"),
        ("a wrong type", good.replace("generations = 3", "generations = \"three\""), "generations"),
        ("out of range", good.replace("population = 12", "population = 0"), "population"),
        ("no body", good.replace("body = \"crawler\"\n", ""), "body"),
        ("an unknown body", good.replace("body = \"crawler\"", "body = \"centipede\""), "centipede"),
        ("an unknown search", good.replace("kind = \"grn\"", "kind = \"gnr\""), "gnr"),
        ("no TOML", good.replace("[task]", "[task"), "unclosed table"),
    ];
    for (what, text, named) in cases {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("bad.toml"), text).expect("the folder is writable");
        for command in ["check", "run"] {
            let said = refused(folder.path(), &[command, "bad.toml"], 2);
            assert!(said.contains(named), "{what}: names the key: {said}");
            let placed = said.split("bad.toml:").skip(1).any(|rest| {
                let mut numbers = rest.split(':');
                let number = |text: Option<&str>| {
                    text.is_some_and(|t| {
                        t.trim_end_matches(|c: char| !c.is_ascii_digit()).parse::<u32>().is_ok()
                    })
                };
                number(numbers.next())
                    && numbers.next().is_some_and(|t| t.starts_with(|c: char| c.is_ascii_digit()))
            });
            assert!(placed, "{what}: file:line:column: {said}");
        }
        assert!(!folder.path().join("hatchery.db").exists(), "{what}: a lineage was made");
    }
}

#[test]
fn check_prints_every_default_and_its_output_is_an_experiment_of_its_own() {
    let resolved = succeed(finished(), &["check", "experiment.toml", "--resolved"]);
    assert!(resolved.contains("tournament = 3"), "the paper's default is there: {resolved}");
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("resolved.toml"), &resolved).expect("the folder is writable");
    assert_eq!(succeed(folder.path(), &["check", "resolved.toml", "--resolved"]), resolved);
}

#[test]
fn questions_that_write_are_refused() {
    for sql in ["DELETE FROM individual", "ATTACH 'x.db' AS x", "DROP VIEW v_individuals"] {
        refused(finished(), &["sql", sql], 2);
    }
    assert!(!finished().join("x.db").exists());
    assert_eq!(json(finished(), &["status", "last"])["evaluated"], 216);
}

#[test]
fn a_lineage_that_is_none_is_refused_with_a_word() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("text.db"), "this is no database, and long enough to be read as one")
        .unwrap();
    let said = refused(folder.path(), &["list", "--db", "text.db"], 2);
    assert!(said.contains("text.db"), "{said}");
    refused(folder.path(), &["list", "--db", "absent.db"], 3);
}

#[test]
fn ctrl_c_commits_says_how_to_resume_and_exits_with_130() {
    let text = walkers("crawler", "grn", 42, 40, 6);
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("experiment.toml"), &text).expect("the folder is writable");
    let arguments = ["run", "experiment.toml", "--workers", "2"];
    let mut process = start(folder.path(), &arguments);
    // The first generation has ended: there is something to commit, and more to come.
    let deadline = std::time::Instant::now() + hatchery_tests::client::PATIENCE;
    while !process.log().contains("generation") {
        assert!(process.ended().is_none() && std::time::Instant::now() < deadline, "{}", process.log());
        std::thread::sleep(Duration::from_millis(10));
    }
    process.signal(Signal::INT);
    assert_eq!(process.wait(Duration::from_secs(30)).code(), Some(130), "{}", process.log());
    assert!(process.log().contains("hatchery run"), "it says how to go on: {}", process.log());
    let committed = hatchery_tests::command::count(
        folder.path(),
        "SELECT count(*) FROM v_individuals WHERE status <> 'pending'",
    );
    assert!(committed >= 40, "the first generation is on disk: {committed}");
    succeed(folder.path(), &arguments);
    assert_eq!(hatchery_tests::command::hash(folder.path(), "last"), local::lineage(&text));
}

#[test]
fn a_matrix_goes_on_with_the_cells_that_have_not_finished() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = probe(9, 20, 1, 1000) + "[matrix]\n\"search.generations\" = [1, 60]\n";
    std::fs::write(folder.path().join("two.toml"), text).expect("writable");
    let again = ["run", "two.toml", "--workers", "1"];
    let mut first = start(folder.path(), &again);
    let deadline = Instant::now() + PATIENCE;
    let finished = || {
        let listed = run(folder.path(), &["list", "--json"]).stdout;
        let listed: serde_json::Value = serde_json::from_slice(&listed).unwrap_or_default();
        listed.as_array().is_some_and(|cells| cells.iter().any(|cell| cell["state"] == "finished"))
    };
    while !finished() {
        assert!(Instant::now() < deadline, "neither cell finished");
        std::thread::sleep(Duration::from_millis(20));
    }
    first.kill();
    succeed(folder.path(), &again);
    let cells = "SELECT count(*) FROM v_experiments";
    assert_eq!(
        (count(folder.path(), cells), count(folder.path(), &format!("{cells} WHERE state = 'finished'"))),
        (2, 2)
    );
    succeed(folder.path(), &again);
    assert_eq!(count(folder.path(), cells), 4, "a matrix that has finished as a whole is made anew");
}

#[test]
fn a_client_submits_watches_pauses_resumes_and_cancels() {
    let service = Hatchery::with_workers(2);
    service.wait_attached(2);
    let folder = service.folder();
    std::fs::write(folder.join("experiment.toml"), walkers("crawler", "grn", 43, 40, 20)).expect("writable");
    let client = |arguments: &[&str]| {
        let output =
            hatchery(folder, arguments).env("HATCHERY_COORDINATOR", service.url()).output().expect("built");
        assert!(output.status.success(), "hatchery {arguments:?}: {}", printed(&output));
        String::from_utf8(output.stdout).expect("text")
    };
    client(&["submit", "experiment.toml"]);
    client(&["pause", "last"]);
    let paused: serde_json::Value =
        serde_json::from_str(&client(&["status", "last", "--json"])).expect("JSON");
    assert_eq!(paused["state"], "paused");
    client(&["resume", "last"]);
    let workers = client(&["workers"]);
    assert!(workers.contains("w1") && workers.contains("w2"), "{workers}");
    client(&["cancel", "last"]);
    let cancelled: serde_json::Value =
        serde_json::from_str(&client(&["status", "last", "--json"])).expect("JSON");
    assert_eq!(cancelled["state"], "cancelled");
    // The second is watched to its end.
    std::fs::write(folder.join("short.toml"), walkers("crawler", "grn", 44, 8, 2)).expect("writable");
    client(&["submit", "short.toml"]);
    let watched = client(&["watch", "last", "--json"]);
    let generations = watched.lines().filter(|line| line.contains("\"generation\"")).count();
    assert!(generations >= 1, "one line a generation: {watched}");
    let status: serde_json::Value =
        serde_json::from_str(&client(&["status", "last", "--json"])).expect("JSON");
    assert_eq!(status["state"], "finished");
}

#[test]
fn completions_are_there_for_five_shells() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert!(succeed(finished(), &["completions", shell]).contains("hatchery"), "{shell}");
    }
}

#[test]
fn compare_prints_the_table_of_a_matrix() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = r#"
name = "small"
system = "walker"
seed = 1
runs = 2
[task]
seconds = 1.0
[search]
population = 8
generations = 2
[matrix]
"task.body" = ["crawler", "hopper"]
"search.kind" = ["grn", "neat"]
"#;
    std::fs::write(folder.path().join("small.toml"), text).expect("writable");
    succeed(folder.path(), &["run", "small.toml", "--workers", "2"]);
    let table = succeed(folder.path(), &["compare", "small", "--plot", "plots"]);
    for cell in ["crawler", "hopper", "GRN", "NEAT"] {
        assert!(table.to_lowercase().contains(&cell.to_lowercase()), "{table}");
    }
    let drawn: Vec<_> = std::fs::read_dir(folder.path().join("plots")).expect("drawn").flatten().collect();
    for extension in ["png", "svg"] {
        assert!(
            drawn.iter().any(|file| file.path().extension().is_some_and(|e| e == extension)),
            "{drawn:?}"
        );
    }
    let report = json(folder.path(), &["compare", "small"]);
    assert!(report.is_object(), "{report}");
}

//! Runs of several stages: each with a task of its own, picks between them by fitness or by a person, and the
//! same lineage whatever is killed in between (ESP E-82, E-84..E-86, EF-13, EF-14).

use std::path::Path;
use std::time::Duration;

use hatchery_tests::client::PATIENCE;
use hatchery_tests::samples::staged;
use hatchery_tests::{Client, Hatchery, command, local};
use tonic::Code;

/// The individual of a rank at the choice that is awaited in a run.
fn candidate(client: &Client, id: u64, run: u32, rank: usize) -> u64 {
    let choices = client.choices(id);
    let awaited = choices.iter().find(|choice| choice.run == run && choice.picked == 0);
    awaited.unwrap_or_else(|| panic!("no choice is awaited in run {run}: {choices:?}")).candidates[rank - 1]
        .individual
}

#[test]
fn stages_come_to_the_same_lineage_on_any_number_of_workers() {
    let text = staged(31, 40, 3, 4, "best").replace("runs = 1", "runs = 3");
    let expected = local::lineage(&text);
    for count in [1, 4] {
        let hatchery = Hatchery::with_workers(count);
        hatchery.wait_attached(count);
        let id = hatchery.submit(&text);
        let experiment = hatchery.client().wait(id);
        assert_eq!(hatchery.client().hash(id), expected, "on {count} workers");
        assert_eq!((experiment.evaluated, experiment.planned), (3 * 4 * 3 * 40, 3 * 4 * 3 * 40));
        assert!(
            experiment.progress.iter().all(|run| run.finished && run.stage_name == "s3"),
            "{experiment:?}"
        );
        let best = "SELECT count(*) FROM v_picks WHERE picked_by = 'best' AND rank = 1";
        assert_eq!(hatchery.client().count(best), 9, "each stage but the last of each run");
        // Each stage's evaluations are of its own task.
        let odd = "SELECT count(*) FROM v_individuals WHERE steps <> 3 + 2 * stage";
        assert_eq!(hatchery.client().count(odd), 0);
        let strangers = "SELECT count(*) FROM v_parents JOIN v_individuals AS c ON c.id = child \
            JOIN v_individuals AS p ON p.id = parent JOIN v_picks ON individual = parent WHERE p.stage <> c.stage - 1";
        assert_eq!(hatchery.client().count(strangers), 0);
    }
}

#[test]
fn a_coordinator_killed_at_every_stage_goes_on_to_the_same_lineage() {
    let text = staged(32, 300, 2, 6, "best");
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    for stage in 1..6 {
        hatchery.client().wait_until(id, |e| e.progress.iter().any(|run| run.stage >= stage));
        hatchery.kill_coordinator();
        hatchery.restart_coordinator();
    }
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
}

#[test]
fn a_pick_is_awaited_through_restarts_and_a_wrong_one_changes_nothing() {
    let text = staged(33, 30, 2, 3, "human");
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    for (stage, rank) in [("s0", 2), ("s1", 5)] {
        let waits = hatchery.client().wait_until(id, |e| e.state == "awaiting");
        assert!(waits.reason.contains(stage) && waits.reason.contains("hatchery pick"), "{}", waits.reason);
        hatchery.kill_coordinator();
        hatchery.restart_coordinator();
        let waits = hatchery.client().experiment(id).expect("it was submitted");
        assert_eq!(waits.state, "awaiting", "{}", waits.reason);
        for stranger in [1_000_000, 1] {
            let refused = hatchery.client().pick(id, stranger).expect_err("no candidate of this choice");
            assert_eq!(refused.code(), Code::FailedPrecondition, "{refused}");
        }
        assert_eq!(hatchery.client().experiment(id).expect("it is there").state, "awaiting");
        let picked = candidate(hatchery.client(), id, 1, rank);
        let goes_on = hatchery.client().pick(id, picked).expect("a candidate");
        assert_eq!(goes_on.state, "running");
        // The pick is on disk: killed at once, it goes on with it.
        hatchery.kill_coordinator();
        hatchery.restart_coordinator();
    }
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage_of_picks(&text, &[2, 5]));
    assert_ne!(hatchery.client().hash(id), local::lineage_of_picks(&text, &[2, 4]), "a pick counts");
    let refused = hatchery.client().pick(id, 1).expect_err("it is over");
    assert_eq!(refused.code(), Code::FailedPrecondition, "{refused}");
}

#[test]
fn each_run_waits_for_a_pick_of_its_own() {
    let text = staged(34, 20, 2, 2, "human").replace("runs = 1", "runs = 2");
    let hatchery = Hatchery::with_workers(1);
    hatchery.wait_attached(1);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.state == "awaiting");
    let second = candidate(hatchery.client(), id, 2, 3);
    hatchery.client().pick(id, second).expect("a candidate");
    let waits = hatchery.client().wait_until(id, |e| e.state == "awaiting");
    assert!(waits.reason.contains("run 1"), "{}", waits.reason);
    assert!(waits.progress[1].finished && !waits.progress[0].stage_name.is_empty(), "{waits:?}");
    let first = candidate(hatchery.client(), id, 1, 3);
    hatchery.client().pick(id, first).expect("a candidate");
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage_of_picks(&text, &[3]));
}

/// Starts `hatchery run`, which must end with an exit code; what it printed.
fn run(folder: &Path, code: i32) -> String {
    let output = command::run(folder, &["run", "staged.toml", "--workers", "2"]);
    let printed = command::printed(&output);
    assert_eq!(output.status.code(), Some(code), "{printed}");
    printed
}

#[test]
fn a_run_ends_for_a_pick_with_5_and_goes_on_with_it() {
    let text = staged(35, 30, 2, 2, "human");
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("staged.toml"), &text).expect("the folder is writable");
    let printed = run(folder.path(), 5);
    for word in ["`s0`", "hatchery candidates 1", "hatchery pick 1", "hatchery run staged.toml"] {
        assert!(printed.contains(word), "it says what to do: {printed}");
    }
    assert_eq!(run(folder.path(), 5).matches("evaluated before").count(), 0, "nothing is evaluated again");

    let table = command::succeed(folder.path(), &["candidates", "last"]);
    assert!(table.contains("run 1, stage s0: a pick is awaited"), "{table}");
    let choices = command::json(folder.path(), &["candidates", "last", "--stage", "s0"]);
    let candidates = choices[0]["candidates"].as_array().expect("candidates");
    assert_eq!(candidates.len(), 5);
    assert_eq!((&candidates[3]["rank"], &candidates[3]["notes"]["steps"]), (&4.into(), &3.into()));
    let absent = command::run(folder.path(), &["candidates", "last", "--stage", "nowhere"]);
    assert_eq!(absent.status.code(), Some(3));

    let wrong = command::run(folder.path(), &["pick", "last", "999"]);
    assert_eq!(wrong.status.code(), Some(1), "{}", command::printed(&wrong));
    assert_eq!(command::json(folder.path(), &["status", "last"])["state"], "awaiting");
    let picked = candidates[3]["individual"].to_string();
    command::succeed(folder.path(), &["pick", "last", &picked, "--note", "it turns"]);
    let again = command::run(folder.path(), &["pick", "last", &picked]);
    assert_eq!(again.status.code(), Some(1), "no second pick: {}", command::printed(&again));
    let note = "SELECT count(*) FROM v_picks WHERE picked_by = 'human' AND rank = 4 AND note = 'it turns'";
    assert_eq!(command::count(folder.path(), note), 1);

    run(folder.path(), 0);
    assert_eq!(command::hash(folder.path(), "last"), local::lineage_of_picks(&text, &[4]));
    assert_eq!(command::count(folder.path(), "SELECT count(*) FROM v_experiments"), 1);
    // One of the last stage lives again on that stage's task, and its line leads back through the pick.
    let best = command::json(folder.path(), &["best", "last"])[0]["id"].to_string();
    assert_eq!(command::json(folder.path(), &["show", &best])["task"]["work"], 5);
    command::succeed(folder.path(), &["replay", &best]);
    let line = command::succeed(folder.path(), &["lineage", &best, "--line"]);
    assert!(line.contains(&picked), "{line}");
}

#[test]
fn a_file_that_a_coordinator_writes_takes_no_pick_beside_it() {
    let text = staged(36, 10, 1, 2, "human");
    let hatchery = Hatchery::with_workers(1);
    hatchery.wait_attached(1);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.state == "awaiting");
    let picked = candidate(hatchery.client(), id, 1, 1).to_string();
    let output = command::run(hatchery.folder(), &["pick", "last", &picked, "--db", "lineage.db"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(command::printed(&output).contains("--coordinator"), "{}", command::printed(&output));
    let url = hatchery.url();
    command::succeed(hatchery.folder(), &["pick", "last", &picked, "--coordinator", &url]);
    hatchery.client().wait(id);
}

#[test]
fn a_search_that_gives_up_fails_its_experiment_with_its_reason() {
    let text = staged(37, 10, 2, 3, "best") + "fail_after = 1\n";
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("staged.toml"), &text).expect("the folder is writable");
    let printed = run(folder.path(), 1);
    assert!(printed.contains("stage `s1`: it was to fail"), "{printed}");
    let status = command::json(folder.path(), &["status", "last"]);
    assert_eq!((&status["state"], &status["evaluated"]), (&"failed".into(), &40.into()));
}

#[test]
fn a_paused_experiment_takes_a_pick_and_rests() {
    let text = staged(38, 10, 1, 2, "human");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let hatchery = Hatchery::with_workers(1);
    hatchery.wait_attached(1);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.state == "awaiting");
    let url = hatchery.url();
    command::succeed(folder.path(), &["pause", "last", "--coordinator", &url]);
    let picked = candidate(hatchery.client(), id, 1, 2);
    assert_eq!(hatchery.client().pick(id, picked).expect("a candidate").state, "paused");
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(hatchery.client().experiment(id).expect("it is there").state, "paused");
    command::succeed(folder.path(), &["resume", "last", "--coordinator", &url]);
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage_of_picks(&text, &[2]));
}

/// ESP EF-13: with the checkpoint truncated, or with a byte of it changed, while the coordinator is away.
#[test]
fn a_damaged_checkpoint_is_made_again_from_the_one_before() {
    let truncate = "UPDATE checkpoint SET state = substr(state, 1, length(state) - 4)";
    let change = "UPDATE checkpoint SET digest = zeroblob(32)";
    for (seed, damage) in [(39, truncate), (40, change)] {
        // The pick is awaited: the end of s0 is what it goes on from. Then, paused in the middle of s1.
        let text = staged(seed, 400, 40, 2, "human");
        let mut hatchery = Hatchery::with_workers(2);
        hatchery.wait_attached(2);
        let id = hatchery.submit(&text);
        hatchery.client().wait_until(id, |e| e.state == "awaiting");
        hatchery.kill_coordinator();
        sql(&hatchery.db(), &format!("{damage} WHERE generation = 41"));
        hatchery.restart_coordinator();
        let picked = candidate(hatchery.client(), id, 1, 2);
        hatchery.client().pick(id, picked).expect("a candidate");
        hatchery.client().wait_until(id, |e| e.progress[0].stage == 1 && e.progress[0].generation > 2);
        hatchery.kill_coordinator();
        sql(
            &hatchery.db(),
            &format!(
                "{damage} WHERE (stage, generation) IN \
            (SELECT stage, max(generation) FROM checkpoint GROUP BY stage HAVING stage = (SELECT max(id) FROM stage))"
            ),
        );
        hatchery.restart_coordinator();
        hatchery.client().wait(id);
        assert_eq!(hatchery.client().hash(id), local::lineage_of_picks(&text, &[2]));
        assert_eq!(said(&hatchery.db()), "2", "each damage is written down");
    }
}

#[test]
fn without_a_usable_checkpoint_an_experiment_fails_with_a_word() {
    let text = staged(41, 400, 60, 1, "best");
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.progress.iter().any(|run| run.generation > 2));
    hatchery.kill_coordinator();
    sql(&hatchery.db(), "UPDATE checkpoint SET digest = zeroblob(32)");
    hatchery.restart_coordinator();
    let failed = hatchery.client().wait_until(id, |e| e.state == "failed");
    assert!(
        failed.reason.contains("another checksum") && failed.reason.contains("generation"),
        "{}",
        failed.reason
    );
}

/// ESP EF-12: what other physics began is paused with a word, and nobody can make it go on.
#[test]
fn an_experiment_of_other_physics_does_not_go_on() {
    let text = staged(44, 400, 60, 1, "best");
    let mut hatchery = Hatchery::with_workers(1);
    hatchery.wait_attached(1);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.progress.iter().any(|run| run.generation > 2));
    hatchery.kill_coordinator();
    sql(&hatchery.db(), "UPDATE experiment SET fingerprint = zeroblob(32)");
    hatchery.restart_coordinator();
    let paused = hatchery.client().wait_until(id, |e| e.state == "paused");
    assert!(paused.reason.contains("physics fingerprint 000000000000"), "{}", paused.reason);
    let url = hatchery.url();
    let refused = command::run(hatchery.folder(), &["resume", "last", "--coordinator", &url]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(command::printed(&refused).contains("physics fingerprint"), "{}", command::printed(&refused));
    assert_eq!(hatchery.client().experiment(id).expect("it is there").state, "paused");
}

/// ESP E-86: the stages up to the fork are shared, and who goes on from there is picked anew.
#[test]
fn a_fork_shares_stages_and_picks_anew() {
    let text = staged(42, 20, 2, 3, "human");
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("staged.toml"), &text).expect("the folder is writable");
    let pick = |experiment: &str, rank: usize| {
        let choices = command::json(folder.path(), &["candidates", experiment]);
        let picked = choices[0]["candidates"][rank - 1]["individual"].to_string();
        command::succeed(folder.path(), &["pick", experiment, &picked]);
    };
    run(folder.path(), 5);
    pick("1", 1);
    run(folder.path(), 5);
    let early = command::run(folder.path(), &["fork", "1", "--after", "s2"]);
    assert_eq!(early.status.code(), Some(3), "s2 has not begun: {}", command::printed(&early));
    pick("1", 2);
    run(folder.path(), 0);

    command::succeed(folder.path(), &["fork", "1", "--after", "s1"]);
    run(folder.path(), 5);
    pick("2", 3);
    run(folder.path(), 0);
    assert_eq!(command::hash(folder.path(), "1"), local::lineage_of_picks(&text, &[1, 2]));
    assert_eq!(command::hash(folder.path(), "2"), local::lineage_of_picks(&text, &[1, 3]));
    let own = "SELECT count(*) FROM v_individuals WHERE experiment = 2";
    assert_eq!(command::count(folder.path(), own), 40, "what is shared is not copied");

    // A fork of the fork, from a stage that the first one holds, all of whose picks are its own.
    command::succeed(folder.path(), &["fork", "2", "--after", "s0"]);
    for rank in [4, 5] {
        run(folder.path(), 5);
        pick("3", rank);
    }
    run(folder.path(), 0);
    assert_eq!(command::hash(folder.path(), "3"), local::lineage_of_picks(&text, &[4, 5]));
    let best = command::json(folder.path(), &["best", "3"])[0]["id"].to_string();
    let line = command::succeed(folder.path(), &["lineage", &best, "--line", "--json"]);
    assert_eq!(line.lines().count(), 2, "it leads back to a founder of the first: {line}");
    let absent = command::run(folder.path(), &["fork", "1", "--after", "nowhere"]);
    assert_eq!(absent.status.code(), Some(3));
    assert!(command::printed(&absent).contains("`s0`, `s1`, `s2`"), "{}", command::printed(&absent));
}

/// ESP EF-11: a search that takes no differences says so, and nothing changes.
#[test]
fn a_changed_file_is_refused_where_it_changes_what_has_begun() {
    let text = staged(43, 10, 1, 2, "human");
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("staged.toml"), &text).expect("the folder is writable");
    run(folder.path(), 5);
    for (changed, word) in [
        (text.replace("seed = 43", "seed = 44"), "seed is 44, was 43"),
        (text.replace("work = 3", "work = 4"), "`syllabus`"),
    ] {
        std::fs::write(folder.path().join("changed.toml"), changed).expect("the folder is writable");
        let refused = command::run(folder.path(), &["amend", "last", "changed.toml"]);
        assert_eq!(refused.status.code(), Some(1), "{}", command::printed(&refused));
        assert!(command::printed(&refused).contains(word), "{}", command::printed(&refused));
        assert_eq!(command::json(folder.path(), &["status", "last"])["state"], "awaiting");
    }
}

/// Changes a lineage by hand, which nothing of ours does.
fn sql(db: &Path, statement: &str) {
    let (runtime, db) = (tokio::runtime::Runtime::new().expect("a runtime"), db.to_owned());
    let changed = runtime.block_on(async move {
        use sqlx::{ConnectOptions, Connection};
        let mut connection =
            sqlx::sqlite::SqliteConnectOptions::new().filename(db).busy_timeout(PATIENCE).connect().await?;
        let changed = sqlx::query(sqlx::AssertSqlSafe(statement.to_owned())).execute(&mut connection).await?;
        connection.close().await?;
        Ok::<_, sqlx::Error>(changed.rows_affected())
    });
    assert!(changed.expect("a lineage takes SQL") > 0, "{statement} changes something");
}

/// How many damaged checkpoints were written down.
fn said(db: &Path) -> String {
    let (runtime, db) = (tokio::runtime::Runtime::new().expect("a runtime"), db.to_owned());
    let count: Result<i64, sqlx::Error> = runtime.block_on(async move {
        use sqlx::ConnectOptions;
        let mut connection =
            sqlx::sqlite::SqliteConnectOptions::new().filename(db).read_only(true).connect().await?;
        sqlx::query_scalar("SELECT count(*) FROM event WHERE kind = 'checkpoint'")
            .fetch_one(&mut connection)
            .await
    });
    count.expect("a lineage answers").to_string()
}

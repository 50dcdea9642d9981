//! What goes wrong on real machines, and what it costs: time, and nothing else.

use std::time::{Duration, Instant};

use hatchery_tests::client::PATIENCE;
use hatchery_tests::command::printed;
use hatchery_tests::programs::program;
use hatchery_tests::samples::{probe, walkers};
use hatchery_tests::{Hatchery, Process, command, local};
use rustix::process::Signal;
use std::path::Path;

#[test]
fn a_frozen_worker_loses_its_leases_and_the_run_goes_on() {
    let text = walkers("crawler", "grn", 11, 20, 3);
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.evaluated >= 5);
    hatchery.freeze("w1");
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
    // It comes back, with reports that nobody waits for, and is of use again.
    hatchery.thaw("w1");
    hatchery.wait_attached(2);
    let text = walkers("crawler", "grn", 12, 8, 2);
    assert_eq!(hatchery.lineage_of(&text), local::lineage(&text));
}

#[test]
fn a_genotype_that_kills_three_workers_is_set_aside_and_the_run_goes_on() {
    let text = probe(13, 60, 3, 200);
    let mut hatchery = Hatchery::new();
    let names = ["f1", "f2"];
    // It dies of every genotype whose first byte is below 6: of about one in forty.
    let start =
        |hatchery: &mut Hatchery, name| hatchery.join_as(name, "fragile-worker", &["--fatal-below", "6"]);
    names.into_iter().for_each(|name| start(&mut hatchery, name));
    let id = hatchery.submit(&text);
    let mut deaths = 0;
    let deadline = Instant::now() + PATIENCE;
    let experiment = loop {
        for name in names {
            if hatchery.worker(name).ended().is_some() {
                deaths += 1;
                start(&mut hatchery, name);
            }
        }
        let experiment = hatchery.client().experiment(id).expect("it was submitted");
        if experiment.state != "running" {
            break experiment;
        }
        assert!(Instant::now() < deadline, "{experiment:#?}");
        std::thread::sleep(Duration::from_millis(10));
    };
    assert_eq!(experiment.state, "finished", "{}", experiment.reason);
    assert!(experiment.failed > 0, "seed 13 has fatal genotypes among its 180");
    assert!(deaths >= 3 * experiment.failed, "each fatal genotype takes three workers: {deaths} deaths");
    // Those set aside, and no others.
    let failed = hatchery.client().count("SELECT count(*) FROM v_individuals WHERE status = 'failed'");
    assert_eq!(failed as u64, experiment.failed);
    let innocent = hatchery
        .client()
        .count("SELECT count(*) FROM v_individuals WHERE status <> 'failed' AND status <> 'completed'");
    assert_eq!(innocent, 0, "everybody else was evaluated");
    let blamed = "SELECT min(n) FROM (SELECT count(*) AS n FROM v_evaluations JOIN v_individuals ON v_individuals.id = \
                  v_evaluations.individual WHERE v_individuals.status = 'failed' GROUP BY v_individuals.id)";
    assert!(hatchery.client().count(blamed) >= 3, "three workers were tried");
}

/// SQLite's locks are the process's, and go with any descriptor of the file that it closes.
#[test]
fn other_programs_may_read_a_lineage_during_a_run_and_a_kill_loses_nothing_by_it() {
    let text = probe(15, 60, 12, 2000);
    let mut hatchery = Hatchery::with_workers(2);
    let id = hatchery.submit(&text);
    for evaluated in [60, 120, 180] {
        hatchery.client().wait_until(id, move |experiment| experiment.evaluated >= evaluated);
        let rows = read_as_others_do(&hatchery.db());
        assert!(rows >= evaluated as i64, "{rows} rows after {evaluated} evaluations");
    }
    let before = hatchery.client().wait_until(id, |experiment| experiment.evaluated >= 300).evaluated;
    hatchery.kill_coordinator();
    let kept = read_as_others_do(&hatchery.db());
    assert!(kept as u64 >= before, "{kept} individuals of {before} that had been evaluated");
    hatchery.restart_coordinator();
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
}

/// Counts individuals over a connection that could write, and that closes as if it were the last one.
fn read_as_others_do(db: &Path) -> i64 {
    use sqlx::{ConnectOptions as _, Connection as _};
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(db).busy_timeout(PATIENCE);
    let counted = async {
        let mut connection = options.connect().await?;
        let rows = sqlx::query_scalar("SELECT count(*) FROM individual").fetch_one(&mut connection).await?;
        connection.close().await?;
        Ok::<i64, sqlx::Error>(rows)
    };
    tokio::runtime::Runtime::new().expect("a runtime").block_on(counted).expect("a lineage answers")
}

#[test]
fn a_worker_that_is_told_to_stop_finishes_what_it_runs_and_leaves() {
    let text = walkers("crawler", "grn", 14, 30, 3);
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.evaluated >= 5);
    hatchery.worker("w1").signal(Signal::TERM);
    let status = hatchery.worker("w1").wait(Duration::from_secs(20));
    assert_eq!(status.code(), Some(0), "{}", hatchery.worker("w1").log());
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
    let lost = hatchery
        .client()
        .count("SELECT count(*) FROM v_evaluations WHERE fate LIKE 'lost%' AND fate <> 'lost:returned'");
    assert_eq!(lost, 0, "nothing that it ran was thrown away");
}

#[test]
fn a_coordinator_that_is_told_to_stop_commits_and_goes_on_later() {
    let text = walkers("hopper", "neat", 15, 30, 3);
    let mut hatchery = Hatchery::with_workers(2);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.evaluated >= 20);
    hatchery.coordinator().signal(Signal::TERM);
    let status = hatchery.coordinator().wait(Duration::from_secs(20));
    assert_eq!(status.code(), Some(0), "{}", hatchery.coordinator().log());
    hatchery.restart_coordinator();
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
}

/// Fishes AF-2.
#[test]
fn a_worker_of_other_physics_or_another_release_is_refused_with_both_shown() {
    let mut hatchery = Hatchery::new();
    let hexadecimal =
        |bytes: [u8; 32]| bytes[..4].iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    let ours = creatures::fingerprint();
    let mut theirs = ours;
    theirs[0] ^= 1;
    hatchery.join_as("foreign", "fragile-worker", &["--foreign-physics"]);
    assert_eq!(hatchery.worker("foreign").wait(Duration::from_secs(20)).code(), Some(1));
    let said = hatchery.worker("foreign").log();
    for fingerprint in [ours, theirs] {
        assert!(said.contains(&hexadecimal(fingerprint)), "{said}");
    }
    hatchery.join_as("old", "fragile-worker", &["--release", "0.0.1"]);
    assert_eq!(hatchery.worker("old").wait(Duration::from_secs(20)).code(), Some(1));
    let said = hatchery.worker("old").log();
    assert!(said.contains("0.0.1") && said.contains(env!("CARGO_PKG_VERSION")), "{said}");
    assert!(hatchery.client().workers().iter().all(|worker| worker.state != "attached"));
}

#[test]
fn a_coordinator_that_would_lose_every_worker_does_not_start() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut command = std::process::Command::new(program("hatchery-coordinator"));
    command.args(["--heartbeat-ms", "1000", "--timeout-ms", "1500", "--listen", "127.0.0.1:0", "--db"]);
    let output = command.arg(folder.path().join("none.db")).output().expect("it was built");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains("--timeout-ms 1500"), "{said}");
    assert!(!folder.path().join("none.db").exists());
}

#[test]
fn a_second_coordinator_on_the_same_lineage_is_refused() {
    let hatchery = Hatchery::new();
    let mut command = std::process::Command::new(program("hatchery-coordinator"));
    command.arg("--db").arg(hatchery.db()).args(["--listen", "127.0.0.1:0"]);
    let mut second = Process::start(&mut command, &hatchery.folder().join("second.log"));
    assert_eq!(second.wait(Duration::from_secs(20)).code(), Some(1));
    let log = second.log();
    assert!(log.contains("lineage.db") && log.contains("another"), "it says who holds the file: {log}");
    assert!(hatchery.client().workers().is_empty(), "the first one is unharmed");
}

#[test]
fn a_lineage_of_a_newer_program_is_refused_and_left_as_it_is() {
    let mut hatchery = Hatchery::new();
    hatchery.coordinator().signal(Signal::TERM);
    hatchery.coordinator().wait(Duration::from_secs(20));
    // `user_version` is the big-endian word at byte 60 of the file.
    let mut bytes = std::fs::read(hatchery.db()).expect("the lineage is a file");
    bytes[60..64].copy_from_slice(&9999u32.to_be_bytes());
    std::fs::write(hatchery.db(), &bytes).expect("the folder is writable");
    let mut command = std::process::Command::new(program("hatchery-coordinator"));
    command.arg("--db").arg(hatchery.db()).args(["--listen", "127.0.0.1:0"]);
    let mut newer = Process::start(&mut command, &hatchery.folder().join("newer.log"));
    assert_eq!(newer.wait(Duration::from_secs(20)).code(), Some(1));
    assert!(newer.log().contains("9999"), "{}", newer.log());
    let output = command::run(hatchery.folder(), &["list", "--db", "lineage.db"]);
    assert_eq!(output.status.code(), Some(1), "{}", command::printed(&output));
    assert!(std::fs::read(hatchery.db()).expect("still there") == bytes, "not one byte has changed");
}

#[test]
fn a_read_only_lineage_is_refused_by_name_can_be_read_and_goes_on_once_it_is_writable() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(disk) = Disk::mount(&folder, "64m") else { return };
    let mut hatchery = Hatchery::in_folder(folder);
    hatchery.join("w1");
    let text = probe(17, 200, 20, 500);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.evaluated >= 300);
    hatchery.coordinator().signal(Signal::TERM);
    hatchery.coordinator().wait(Duration::from_secs(20));
    // What still runs keeps its log open, and with it the disk.
    hatchery.kill("w1");
    assert!(disk.remount("ro"), "nobody writes to it any more");
    let elsewhere = tempfile::tempdir().expect("a temporary folder");
    let mut command = std::process::Command::new(program("hatchery-coordinator"));
    command.arg("--db").arg(hatchery.db()).args(["--listen", "127.0.0.1:0"]);
    let mut refused = Process::start(&mut command, &elsewhere.path().join("refused.log"));
    assert_eq!(refused.wait(Duration::from_secs(20)).code(), Some(1));
    assert!(refused.log().contains("lineage.db") && refused.log().contains("written"), "{}", refused.log());
    let db = hatchery.db().to_string_lossy().into_owned();
    let listed = command::succeed(elsewhere.path(), &["status", "last", "--db", &db]);
    assert!(listed.contains("interrupted"), "{listed}");
    assert!(disk.remount("rw"));
    hatchery.restart_coordinator();
    hatchery.join("w1");
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
}

#[test]
fn a_full_disk_pauses_the_run_with_a_word_and_room_lets_it_go_on() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(disk) = Disk::mount(&folder, "3m") else { return };
    let mut hatchery = Hatchery::in_folder(folder);
    hatchery.join("w1");
    hatchery.wait_attached(1);
    let ballast = hatchery.folder().join("ballast");
    let text = probe(16, 2000, 3, 0);
    let id = hatchery.submit(&text);
    // Whatever room is left is taken away.
    std::fs::write(&ballast, vec![0u8; 64 << 20]).expect_err("the disk is smaller");
    let stuck = hatchery.client().wait_until(id, |e| e.reason.contains("full") || e.state == "finished");
    assert!(stuck.reason.contains("full"), "it says what holds it up: {stuck:#?}");
    let (alive, ready) = (hatchery.health(&[]), hatchery.health(&["--ready"]));
    assert_eq!((alive.status.code(), ready.status.code()), (Some(0), Some(1)));
    assert!(printed(&ready).contains("cannot write its lineage"), "{}", printed(&ready));
    let serves = |service| hatchery.client().serves(service);
    assert!(!serves("hatchery.v1.Fleet") && serves(""), "no use for now, and no reason to be restarted");
    std::fs::remove_file(&ballast).expect("it was written");
    assert!(disk.remount("size=256m"));
    hatchery.client().wait(id);
    assert!(serves("hatchery.v1.Fleet"));
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
}

/// A small disk of our own, taken away when the test ends, however it does.
struct Disk(std::path::PathBuf);

impl Disk {
    /// Mounts one on a folder; where that is not permitted it says so, and the test is skipped.
    fn mount(folder: &tempfile::TempDir, size: &str) -> Option<Disk> {
        let options = format!("size={size}");
        let mounted = std::process::Command::new("mount")
            .args(["-t", "tmpfs", "-o", &options, "tmpfs"])
            .arg(folder.path())
            .output()
            .is_ok_and(|output| output.status.success());
        if !mounted {
            eprintln!("SKIPPED: mounting a small tmpfs is not permitted here");
            return None;
        }
        Some(Disk(folder.path().to_owned()))
    }

    fn remount(&self, option: &str) -> bool {
        let options = format!("remount,{option}");
        let mut command = std::process::Command::new("mount");
        let output = command.args(["-o", &options]).arg(&self.0).output().expect("mount was there before");
        output.status.success()
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg("--lazy").arg(&self.0).status();
    }
}

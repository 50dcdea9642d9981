//! One lineage, whatever befalls the machines: the hash of an experiment is that of its evaluation in this
//! process, one individual after the other (design: determinism; walker X-18..X-20, T-20).

use std::path::Path;
use std::time::Duration;

use creatures::random::stream;
use hatchery_tests::samples::{culled, curriculum, fishes, flyers, probe, walkers};
use hatchery_tests::{Hatchery, command, local};

#[test]
fn a_lineage_is_the_same_for_any_number_of_workers() {
    let experiments = [
        culled(&walkers("crawler", "grn", 1, 12, 4)),
        walkers("hopper", "neat", 2, 12, 4),
        walkers("runner", "grn", 3, 8, 3),
        walkers("arm", "neat", 4, 8, 3),
        culled(&flyers(10, 12, 4)),
        fishes(11, 4, 30),
        curriculum(12, 2, 10),
        probe(5, 300, 5, 0),
    ];
    let expected: Vec<String> = experiments.iter().map(|text| local::lineage(text)).collect();
    for count in [1, 2, 5] {
        let hatchery = Hatchery::with_workers(count);
        hatchery.wait_attached(count);
        // All at once, so that evaluations of all of them are under way together, in any order.
        let ids: Vec<u64> = experiments.iter().map(|text| hatchery.submit(text)).collect();
        for (id, expected) in ids.into_iter().zip(&expected) {
            let experiment = hatchery.client().wait(id);
            assert_eq!(&hatchery.client().hash(id), expected, "{} on {count} workers", experiment.name);
        }
    }
}

#[test]
fn killed_workers_cost_time_and_nothing_else() {
    let text = culled(&walkers("crawler", "neat", 6, 40, 8));
    let mut hatchery = Hatchery::with_workers(3);
    hatchery.wait_attached(3);
    let id = hatchery.submit(&text);
    let mut draws = stream(6, [0, 0, 0], "kills");
    for _ in 0..10 {
        advance(&hatchery, id, draws.within(40, 120) as i64);
        let name = format!("w{}", draws.within(1, 3));
        hatchery.kill(&name);
        hatchery.join(&name);
    }
    hatchery.client().wait(id);
    let lost = hatchery.client().count("SELECT count(*) FROM v_evaluations WHERE fate LIKE 'lost%'");
    assert!(lost > 0, "no kill met an evaluation under way");
    assert_eq!(hatchery.client().count("SELECT count(*) FROM v_individuals WHERE status = 'failed'"), 0);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
}

#[test]
fn a_coordinator_killed_ten_times_goes_on_to_the_same_lineage() {
    let text = culled(&walkers("hopper", "grn", 7, 40, 10));
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    let mut progress = stream(7, [0, 0, 0], "kills");
    for _ in 0..10 {
        advance(&hatchery, id, progress.within(60, 180) as i64);
        hatchery.kill_coordinator();
        hatchery.restart_coordinator();
    }
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
    for name in ["w1", "w2"] {
        assert!(hatchery.worker(name).ended().is_none(), "{name} outlives every coordinator");
    }
}

/// Fishes T-25: a chain goes on from its last step, and a curriculum from its phase.
#[test]
fn chains_go_on_after_their_coordinator_is_killed() {
    let texts = [fishes(13, 4, 300), curriculum(14, 2, 150)];
    let mut hatchery = Hatchery::with_workers(4);
    hatchery.wait_attached(4);
    let ids = texts.each_ref().map(|text| hatchery.submit(text));
    let mut progress = stream(13, [0, 0, 0], "kills");
    for _ in 0..3 {
        advance(&hatchery, ids[0], progress.within(60, 180) as i64);
        hatchery.kill_coordinator();
        hatchery.restart_coordinator();
    }
    for (id, text) in ids.into_iter().zip(&texts) {
        hatchery.client().wait(id);
        assert_eq!(hatchery.client().hash(id), local::lineage(text));
    }
}

/// Outcomes of a microsecond come back while the generation is still being handed out: none may be missed.
#[test]
fn an_outcome_that_comes_at_once_finds_its_run_waiting() {
    let text = probe(9, 2, 40, 0).replace("runs = 1", "runs = 120");
    let hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
}

#[test]
fn a_run_killed_and_taken_up_again_ends_as_an_unbroken_one() {
    let text = culled(&walkers("crawler", "grn", 8, 40, 6));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("experiment.toml");
    std::fs::write(&file, &text).expect("the folder is writable");
    let mut progress = stream(8, [0, 0, 0], "kills");
    let mut settled = 0;
    for _ in 0..4 {
        // Killed after some progress, not after some time: how fast this machine is must not matter.
        let goal = settled + progress.within(100, 250) as i64;
        let mut run = command::start(folder.path(), &["run", "experiment.toml", "--workers", "2"]);
        while settled < goal {
            assert!(run.ended().is_none(), "the run ended before it could be killed");
            settled = settled_in(folder.path());
        }
        run.kill();
        settled = settled_in(folder.path());
    }
    command::succeed(folder.path(), &["run", "experiment.toml", "--workers", "2"]);
    assert_eq!(command::hash(folder.path(), "last"), local::lineage(&text));
    let count = command::count(folder.path(), "SELECT count(*) FROM v_experiments");
    assert_eq!(count, 1, "the run was taken up, not begun again");
}

/// Waits for some progress, not for some time: how fast this machine is must not matter.
fn advance(hatchery: &Hatchery, id: u64, individuals: i64) {
    let settled = "SELECT count(*) FROM v_individuals WHERE status <> 'pending'";
    let goal = hatchery.client().count(settled) + individuals;
    while hatchery.client().count(settled) < goal {
        std::thread::sleep(Duration::from_millis(5));
    }
    let state = hatchery.client().experiment(id).expect("it was submitted").state;
    assert_eq!(state, "running", "the run is too short to prove anything");
}

/// How many individuals of a folder's lineage are settled; none before there is a lineage.
fn settled_in(folder: &Path) -> i64 {
    let count = "SELECT count(*) FROM v_individuals WHERE status <> 'pending'";
    match command::run(folder, &["sql", count]).status.success() {
        true => command::count(folder, count),
        false => 0,
    }
}

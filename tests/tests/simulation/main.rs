//! The fleet and its workers, real code over a simulated network and clock: a seed draws the machines and what
//! befalls them, and whatever it draws, nothing is lost, nothing counts twice, every lease ends, workers that take
//! leave give back what they have not begun, and the lineage is the undisturbed one. A seed that fails is printed, and
//! replays with `HATCHERY_SEED=…`.
//!
//! ```text
//! plan    what a seed draws: machines, latencies, and a list of faults
//! world   the hosts that the plan asks for, and the faults at their time
//! owner   who submits and takes outcomes, as the driver does, with a disk that survives kills
//! leave   what workers that go may leave behind
//! wire    gRPC over the simulated network
//! ```

mod leave;
mod owner;
mod plan;
mod wire;
mod world;

use plan::Plan;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{available_parallelism, scope};
use world::{Failure, run};

/// How many seeds a run of the tests takes, unless `HATCHERY_SEEDS` says otherwise.
const SEEDS: u64 = 1000;

#[test]
fn whatever_befalls_the_machines_the_lineage_is_the_same() {
    let expected = Arc::new(owner::Undisturbed::live());
    if let Some(seed) = number("HATCHERY_SEED") {
        match run(&Plan::draw(seed), &expected) {
            Ok(trace) => println!("{trace}"),
            Err(failure) => panic!("{}", report(seed, &failure)),
        }
        return;
    }
    let (next, end) = (AtomicU64::new(0), number("HATCHERY_SEEDS").unwrap_or(SEEDS));
    let failed: Mutex<Vec<(u64, Failure)>> = Mutex::default();
    scope(|scope| {
        for _ in 0..available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= end || !failed.lock().expect("nobody panics with it").is_empty() {
                        return;
                    }
                    if let Err(failure) = run(&Plan::draw(seed), &expected) {
                        failed.lock().expect("nobody panics with it").push((seed, failure));
                    }
                }
            });
        }
    });
    let mut failed = failed.into_inner().expect("nobody panics with it");
    failed.sort_by_key(|(seed, _)| *seed);
    if let Some((seed, failure)) = failed.first() {
        panic!("{}", report(*seed, failure));
    }
}

/// A seed that failed would be of no use if it did not fail again.
#[test]
fn a_seed_replays_to_the_event() {
    let expected = Arc::new(owner::Undisturbed::live());
    for seed in 0..12 {
        let plan = Plan::draw(seed);
        let [first, again] = [run(&plan, &expected), run(&plan, &expected)];
        let (first, again) = (first.expect("a sound seed"), again.expect("a sound seed"));
        let parting = first.lines().zip(again.lines()).find(|(first, again)| first != again);
        assert_eq!(parting, None, "seed {seed} parts from itself");
        assert_eq!(first, again, "seed {seed} ends elsewhere");
    }
}

/// The seeds are worth something only if they bring about what they are to survive.
#[test]
fn the_seeds_bring_about_every_kind_of_fault_and_loss() {
    let expected = Arc::new(owner::Undisturbed::live());
    let mut all = String::new();
    for seed in 0..40 {
        let plan = Plan::draw(seed);
        all.push_str(&format!("{plan:?}\n{}", run(&plan, &expected).expect("a sound seed")));
    }
    let words = ["Kill", "KillCoordinator", "Cut", "Stall", "Drain", "stream broke", "silent", "returned"];
    for word in words.into_iter().chain(["Duplicate", "Counted", "Culled"]) {
        assert!(all.contains(word), "forty seeds bring about no `{word}`");
    }
}

fn number(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{variable} is `{text}`, must be a number")))
}

fn report(seed: u64, failure: &Failure) -> String {
    format!(
        "seed {seed}: {}\n{:#?}\n{}\nreplay with HATCHERY_SEED={seed} cargo test -p hatchery-tests --test simulation whatever",
        failure.reason,
        Plan::draw(seed),
        failure.trace
    )
}

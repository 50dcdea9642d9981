//! The coordinator's memory over a long run: a million individuals through real processes, its resident memory read
//! at every tenth of them. Flat is what it has to be: nothing that grows with the history is held.
//!
//! `memory [INDIVIDUALS]`

use std::time::{Duration, Instant};

use hatchery_benches::load::Load;
use hatchery_benches::processes::{resident_bytes, resident_bytes_most};
use hatchery_benches::report::Report;
use hatchery_tests::Hatchery;
use serde_json::json;

const INDIVIDUALS: u32 = 1_000_000;
const POPULATION: u32 = 1_000;
const WORKERS: usize = 2;
/// Between two looks, which cost the coordinator something too.
const PAUSE: Duration = Duration::from_secs(2);
const MIB: f64 = 1024.0 * 1024.0;

fn main() {
    let individuals =
        std::env::args().nth(1).map_or(INDIVIDUALS, |count| count.parse().expect("a number of individuals"));
    let load = Load { work: 0, population: POPULATION, generations: individuals / POPULATION };
    let mut hatchery = Hatchery::with_workers(WORKERS);
    hatchery.wait_attached(WORKERS);
    let id = hatchery.coordinator().id();
    let mut report = Report::new("memory", &["individuals", "seconds", "resident_mib", "peak_mib"]);
    let (experiment, start) = (hatchery.submit(&load.text()), Instant::now());
    let mut next = 0;
    loop {
        let now = hatchery.client().experiment(experiment).expect("it was submitted");
        if now.evaluated >= next {
            report.row(&[
                json!(now.evaluated),
                json!(start.elapsed().as_secs_f64()),
                json!(resident_bytes(id) as f64 / MIB),
                json!(resident_bytes_most(id) as f64 / MIB),
            ]);
            next += u64::from(load.count() / 10);
        }
        if now.state != "running" {
            assert_eq!(now.state, "finished", "{}", now.reason);
            return;
        }
        std::thread::sleep(PAUSE);
    }
}

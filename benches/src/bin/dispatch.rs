//! Evaluations a second through everything (search, coordinator, socket, worker, lineage), from submission to
//! the last committed row, with a real coordinator and real workers. Efficiency is the time that the same
//! evaluations take on bare threads over the time that they take so. Its peers, a Python process pool and Ray,
//! are in `benches/peers/`; they store nothing.
//!
//! `dispatch [MS]…` measures evaluations of so many milliseconds alone.

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use creatures::{Nobody, System, Task, probe};
use hatchery_benches::load::{Load, PAYLOAD_BYTES, Taken};
use hatchery_benches::report::Report;
use hatchery_tests::Hatchery;
use serde_json::{Value, json};

const REPEATS: usize = 3;
const ANY_BYTES: &str = "any bytes are a probe";

fn main() {
    let unit = seconds_of_work(100_000) / 100_000.0;
    let columns = [
        "work_ms",
        "workers",
        "evaluations",
        "per_second",
        "efficiency",
        "coordinator_us",
        "workers_us",
        "speedup",
    ];
    let mut report = Report::new("dispatch", &columns);
    let mut measure =
        |work_ms: f64, workers: usize, population: u32, generations: u32, alone: Option<f64>| {
            let work = (work_ms / 1000.0 / unit).round() as u32;
            // Turn by turn, so that a busy moment of the machine falls on both.
            let (mut bare, mut best) = (f64::INFINITY, None::<Taken>);
            for _ in 0..REPEATS {
                bare = bare.min(bare_threads(work, workers, population * generations));
                let load = Load { work, population, generations };
                let taken = load.run(&mut Hatchery::with_workers(workers), workers);
                if best.as_ref().is_none_or(|best| taken.seconds < best.seconds) {
                    best = Some(taken);
                }
            }
            let best = best.expect("repeated at least once");
            let count = f64::from(population * generations);
            let rate = count / best.seconds;
            let efficiency = if work > 0 { json!(bare / best.seconds) } else { Value::Null };
            let speedup = alone.map_or(Value::Null, |alone| json!(rate / alone));
            report.row(&[
                json!(work_ms),
                json!(workers),
                json!(count as u64),
                json!(rate),
                efficiency,
                json!(best.coordinator / count * 1e6),
                json!(best.workers / count * 1e6),
                speedup,
            ]);
            rate
        };
    let named: Vec<f64> = std::env::args().skip(1).map(|ms| ms.parse().expect("milliseconds")).collect();
    let is_wanted = |work_ms| named.is_empty() || named.contains(&work_ms);
    for (work_ms, population, generations) in [(0.0, 20_000, 10), (1.0, 1000, 4), (10.0, 200, 4)] {
        if is_wanted(work_ms) {
            measure(work_ms, 2, population, generations, None);
        }
    }
    if is_wanted(5.0) {
        let alone = measure(5.0, 1, 200, 4, None);
        measure(5.0, 2, 200, 4, Some(alone));
    }
}

/// Seconds that so many evaluations take on bare threads of this process.
fn bare_threads(work: u32, threads: usize, count: u32) -> f64 {
    let task = probe_task(work);
    let next = AtomicU32::new(0);
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while next.fetch_add(1, Ordering::Relaxed) < count {
                    task.evaluate(&[0; PAYLOAD_BYTES as usize], 1, None, &mut Nobody).expect(ANY_BYTES);
                }
            });
        }
    });
    start.elapsed().as_secs_f64()
}

fn probe_task(work: u32) -> Box<dyn Task> {
    probe::Probe.task(&format!("{{\"work\":{work}}}")).expect("a legal task")
}

/// How long one probe of so much work takes here, s: the best of several.
fn seconds_of_work(work: u32) -> f64 {
    let task = probe_task(work);
    let once = || {
        let start = Instant::now();
        task.evaluate(&[0; PAYLOAD_BYTES as usize], 1, None, &mut Nobody).expect(ANY_BYTES);
        start.elapsed().as_secs_f64()
    };
    (0..9).map(|_| once()).fold(f64::INFINITY, f64::min)
}

//! What our layer costs: the evaluations of one real experiment, once in a bare loop on as many threads, once
//! through coordinator, sockets, workers and lineage. The overhead is the share of time by which the second
//! takes longer. The cost of an evaluation is G-77.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use hatchery_benches::report::Report;
use hatchery_tests::local::{Lived, experiment, history};
use hatchery_tests::{Hatchery, samples};
use serde_json::{Value, json};

const REPEATS: usize = 5;
const RUNS: u32 = 4;

fn main() {
    let columns = ["body", "search", "threads", "path", "episodes_per_second", "ms_per_episode", "overhead"];
    let mut report = Report::new("evaluation", &columns);
    for (body, kind) in [("crawler", "grn"), ("hopper", "neat")] {
        // Full episodes, 7.5 s of life, and runs side by side, as in the paper's experiments.
        let text = samples::walkers(body, kind, 1, 80, 5)
            .replace("seconds = 1.0\n", "")
            .replace("runs = 1", &format!("runs = {RUNS}"));
        let parsed = experiment(&text);
        let lived: Vec<Lived> =
            history(&parsed).into_iter().filter(|lived| lived.individual.inherits.is_none()).collect();
        let spec = parsed.task_json();
        for threads in [1, 2] {
            // Turn by turn, so that a busy moment of the machine falls on both.
            let (mut bare, mut whole) = (f64::INFINITY, f64::INFINITY);
            for _ in 0..REPEATS {
                bare = bare.min(alone(&lived, &spec, threads));
                whole = whole.min(through_everything(&text, threads));
            }
            let mut row = |path: &str, seconds: f64, overhead: Value| {
                let rate = lived.len() as f64 / seconds;
                let ms = 1000.0 * threads as f64 / rate;
                report.row(&[
                    json!(body),
                    json!(kind),
                    json!(threads),
                    json!(path),
                    json!(rate),
                    json!(ms),
                    overhead,
                ]);
            };
            row("bare loop", bare, Value::Null);
            row("whole layer", whole, json!(whole / bare - 1.0));
        }
    }
}

/// Seconds for every evaluation, on threads that share nothing but a counter.
fn alone(lived: &[Lived], spec: &str, threads: usize) -> f64 {
    let next = AtomicUsize::new(0);
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                let system = creatures::system("walker").expect("registered");
                let task = system.task(spec).expect("a parsed experiment has a legal task");
                while let Some(one) = lived.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let outcome = task.evaluate(
                        &one.individual.genotype,
                        one.seed,
                        one.cull.as_ref(),
                        &mut creatures::Nobody,
                    );
                    let outcome = outcome.expect("a search makes legal genotypes");
                    assert_eq!(outcome.digest(), one.outcome.digest(), "the same bits every time");
                }
            });
        }
    });
    start.elapsed().as_secs_f64()
}

/// Seconds from the beginning of the first generation to the end of the last, with that many workers of one
/// slot.
fn through_everything(text: &str, workers: usize) -> f64 {
    let hatchery = Hatchery::with_workers(workers);
    hatchery.wait_attached(workers);
    let id = hatchery.submit(text);
    hatchery.client().wait(id);
    hatchery.client().count("SELECT max(ended_ms) - min(begun_ms) FROM v_generations") as f64 / 1000.0
}

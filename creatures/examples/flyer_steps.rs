//! What a flyer's step costs, and what becomes of random ones in thin and thick air (F-73).
//!
//! `cargo run --release -p creatures --example flyer_steps`

#![allow(clippy::disallowed_types, reason = "an example that measures needs a clock")]

use creatures::flyer::{Flyer, FlyerTask, Genotype, Settings};
use creatures::random::stream;
use creatures::{Nobody, Outcome, Reason, Status, System, Task};
use std::time::Instant;

const FOUNDERS: u32 = 300;

fn founders(seed: u64) -> impl Iterator<Item = Genotype> {
    (0..)
        .map(move |place| Genotype::random(&Settings::default(), &mut stream(seed, [0, 0, place], "founder")))
}

fn live(task: &dyn Task, genotype: &Genotype) -> Outcome {
    task.evaluate(&genotype.encode(), 0, None, &mut Nobody).expect("founders are legal")
}

/// Microseconds a step of the least disturbed of some evaluations, whole: from bytes to outcome.
fn cost(segments: usize) -> f64 {
    let task = FlyerTask { start_height: 1e5, alpha: 3e-4, ..FlyerTask::default() };
    let flying = founders(7).filter(|founder| founder.segments() == segments).filter_map(|founder| {
        let steps = live(&task, &founder).steps;
        (steps == task.steps).then_some(founder)
    });
    let each = flying.take(10).map(|founder| {
        let time = || {
            let start = Instant::now();
            let steps = live(&task, &founder).steps;
            start.elapsed().as_secs_f64() * 1e6 / f64::from(steps)
        };
        (0..5).map(|_| time()).fold(f64::INFINITY, f64::min)
    });
    each.sum::<f64>() / 10.0
}

fn main() {
    println!("segments  bodies  us/step");
    for segments in [1, 2, 4, 6, 8] {
        println!("{segments:8}  {:6}  {:7.2}", 2 + 2 * segments, cost(segments));
    }
    println!("\nof {FOUNDERS} founders:");
    println!("alpha    blown up  median hover  longest");
    for alpha in [1e-4, 3e-4, 1e-3, 3e-3, 1e-2] {
        let resolved = Flyer.resolve(serde_json::json!({ "alpha": alpha })).expect("legal").to_string();
        let task = Flyer.task(&resolved).expect("legal");
        let outcomes: Vec<Outcome> =
            founders(1).take(FOUNDERS as usize).map(|founder| live(&*task, &founder)).collect();
        let blown = outcomes.iter().filter(|outcome| blown_up(outcome)).count();
        let mut hovers: Vec<u32> =
            outcomes.iter().filter(|outcome| outcome.status == Status::Completed).map(|o| o.steps).collect();
        hovers.sort_unstable();
        let share = 100.0 * blown as f64 / outcomes.len() as f64;
        let (median, longest) = (hovers[hovers.len() / 2], hovers[hovers.len() - 1]);
        println!("{alpha:<7}  {share:6.1} %  {median:12}  {longest:7}");
    }
}

fn blown_up(outcome: &Outcome) -> bool {
    matches!(outcome.status, Status::Aborted(Reason::BlowUp | Reason::NonFinite))
}

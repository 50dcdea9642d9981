//! How many evaluations a second the bare scheduler gets through: handed out, reported, settled, delivered.
//!
//! `cargo run --release -p coordinator --example scheduler_rate`

use bytes::Bytes;
use coordinator::fleet::{Evaluation, TaskText};
use coordinator::scheduler::{AttemptId, Hello, Limits, Millis, News, Order, Report, Scheduler, WorkerId};
use creatures::{Outcome, Status};
use std::sync::Arc;
use std::time::Instant;

const GENERATION: u64 = 10_000;
const GENERATIONS: u64 = 30;

fn main() {
    println!("workers  queues  evaluations/s  microseconds each");
    for (workers, queues) in [(2, 1), (2, 16), (64, 1), (1_000, 16), (10_000, 1)] {
        let rate = rate(workers, queues);
        println!("{workers:7}  {queues:6}  {rate:13.0}  {:17.3}", 1e6 / rate);
    }
}

/// Evaluations a second, with as many reports a round as one message of a worker would carry.
fn rate(workers: u32, queues: usize) -> f64 {
    let limits = Limits { heartbeat_ms: 1_000, timeout_ms: 5_000, overdue_ms: 900_000, parole_ms: 60_000 };
    let mut scheduler = Scheduler::new(limits, Millis(0));
    let ids: Vec<WorkerId> = (0..workers)
        .map(|number| {
            let name = format!("worker-{number}");
            let (host, version) = ("here".to_owned(), "1".to_owned());
            let hello = Hello {
                name,
                host,
                incarnation: number as u64,
                version,
                slots: 2,
                window: 128,
                holding: vec![],
                labels: Default::default(),
            };
            scheduler.attach(hello, Millis(0)).expect("names differ")
        })
        .collect();
    let queues: Vec<_> = (0..queues).map(|_| scheduler.open(1)).collect();
    let task = Arc::new(TaskText::new("probe", 1, "{}"));
    let genotype = Bytes::from(vec![0; 2048]);
    let outcome = Outcome {
        status: Status::Completed,
        fitness: 1.0,
        steps: 1,
        measures: vec![("echo".to_owned(), 1.0)],
        interim: None,
        note: String::new(),
    };

    let start = Instant::now();
    let (mut settled_count, mut round) = (0, 0);
    for generation in 0..GENERATIONS {
        for (at, queue) in queues.iter().enumerate() {
            let evaluations = (0..GENERATION / queues.len() as u64).map(|index| Evaluation {
                id: ((generation * queues.len() as u64) + at as u64) * GENERATION + index,
                order: (1, generation as u32, index as u32),
                task: task.clone(),
                genotype: genotype.clone(),
                seed: index,
                cull: None,
                audit: false,
                attempts_before: 0,
            });
            scheduler.submit(*queue, evaluations.collect());
        }
        let mut held: Vec<(WorkerId, Vec<AttemptId>)> = Vec::new();
        loop {
            let now = Millis(start.elapsed().as_millis() as u64);
            round += 1;
            for order in scheduler.dispatch(now) {
                match order {
                    Order::Tell { worker, assigned, .. } => {
                        let attempts = assigned
                            .into_iter()
                            .map(|one| AttemptId { evaluation: one.evaluation.id, number: one.number });
                        held.push((worker, attempts.collect()));
                    }
                    Order::Deliver { settled, .. } => settled_count += settled.len(),
                    Order::Dismiss { .. } => unreachable!("nobody is silent"),
                    Order::Quarantine(_) => unreachable!("nothing is audited"),
                }
            }
            // Heartbeats come in between.
            scheduler.heard(ids[round % ids.len()], now);
            let Some((worker, attempts)) = held.pop() else { break };
            for attempt in attempts {
                let news = News::Outcome(outcome.clone());
                scheduler.report(worker, Report { attempt, seconds: 1e-6, news }, now);
            }
        }
    }
    assert_eq!(settled_count as u64, GENERATIONS * (GENERATION / queues.len() as u64) * queues.len() as u64);
    settled_count as f64 / start.elapsed().as_secs_f64()
}

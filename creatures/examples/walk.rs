//! Evaluates random walkers of every body and controller: `cargo run --release -p creatures --example walk
//! [COUNT]`. Prints milliseconds an evaluation on one core, the range of fitness, and a hash of the outcomes,
//! which is the same on every machine and in every profile.

#![allow(clippy::disallowed_types, reason = "an example may look at the clock; the library may not")]

use creatures::random::stream;
use creatures::walker::{BodyKind, Genotype, WalkerTask, grn, neat};
use creatures::{Nobody, Task};
use std::time::Instant;

fn main() {
    let count: u32 = std::env::args().nth(1).and_then(|count| count.parse().ok()).unwrap_or(100);
    println!(
        "{:8} {:5} {:>8} {:>7} {:>7} {:>8} {:>7}  outcomes",
        "body", "", "ms", "mean", "best", "peak m/s", "aborted"
    );
    for body in BodyKind::ALL {
        for controller in [grn::CONTROLLER, neat::CONTROLLER] {
            let task = WalkerTask::new(body);
            let genotypes: Vec<Vec<u8>> =
                (0..count).map(|index| founder(body, controller, index).encode()).collect();
            let start = Instant::now();
            let outcomes: Vec<_> = genotypes
                .iter()
                .map(|genotype| task.evaluate(genotype, 0, None, &mut Nobody).expect("a legal genotype"))
                .collect();
            let ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(count);
            let mean = outcomes.iter().map(|outcome| outcome.fitness).sum::<f64>() / f64::from(count);
            let best = outcomes.iter().fold(0.0, |best, outcome| f64::max(best, outcome.fitness));
            let speed = outcomes.iter().flat_map(|outcome| &outcome.measures);
            let speed = speed.filter(|(name, _)| name == "speed_max").fold(0.0, |s, (_, v)| f64::max(s, *v));
            let aborted = outcomes.iter().filter(|outcome| !outcome.note.is_empty()).count();
            let mut hasher = blake3::Hasher::new();
            for outcome in &outcomes {
                hasher.update(&outcome.digest());
            }
            let hash = &hasher.finalize().to_hex()[..8];
            let body = body.name();
            println!(
                "{body:8} {controller:5} {ms:8.3} {mean:7.2} {best:7.2} {speed:8.2} {aborted:7}  {hash}"
            );
        }
    }
}

fn founder(body: BodyKind, controller: &str, index: u32) -> Genotype {
    let mut stream = stream(1, [0, 1, index], controller);
    match controller {
        grn::CONTROLLER => Genotype::Grn(grn::Genotype::random(body, &grn::Settings::default(), &mut stream)),
        _ => Genotype::Neat(neat::Genotype::random(body, &neat::Settings::default(), &mut stream)),
    }
}

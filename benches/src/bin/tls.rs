//! What TLS costs: the same evaluations, which do nothing, through a plain coordinator and through one with
//! credentials, turn by turn, so that a busy moment of the machine falls on both. Each pair is a ratio of its own.
//!
//! `tls [PAIRS]`

use hatchery_benches::load::{Load, Taken};
use hatchery_benches::report::Report;
use hatchery_tests::Hatchery;
use serde_json::json;

const PAIRS: usize = 9;
const WORKERS: usize = 2;
const LOAD: Load = Load { work: 0, population: 20_000, generations: 5 };

fn main() {
    let pairs = std::env::args().nth(1).map_or(PAIRS, |pairs| pairs.parse().expect("a number of pairs"));
    let columns =
        ["pair", "plain_per_second", "tls_per_second", "ratio", "plain_processor_us", "tls_processor_us"];
    let mut report = Report::new("tls", &columns);
    let mut ratios = Vec::new();
    for pair in 1..=pairs {
        // Each goes first every other time.
        let (plain, tls) = if pair % 2 == 0 {
            let tls = run(Hatchery::with_credentials());
            (run(Hatchery::new()), tls)
        } else {
            (run(Hatchery::new()), run(Hatchery::with_credentials()))
        };
        let ratio = plain.seconds / tls.seconds;
        ratios.push((ratio, processor_us(plain) / processor_us(tls)));
        report.row(&[
            json!(pair),
            json!(f64::from(LOAD.count()) / plain.seconds),
            json!(f64::from(LOAD.count()) / tls.seconds),
            json!(ratio),
            json!(processor_us(plain)),
            json!(processor_us(tls)),
        ]);
    }
    drop(report);
    let (by_clock, by_processor) = ratios.into_iter().unzip();
    println!(
        "median ratio: {:.3} of the rate, {:.3} by processor time",
        median(by_clock),
        median(by_processor)
    );
}

fn run(mut hatchery: Hatchery) -> Taken {
    (1..=WORKERS).for_each(|number| hatchery.join(&format!("w{number}")));
    LOAD.run(&mut hatchery, WORKERS)
}

/// Of an evaluation, both ends of the stream.
fn processor_us(taken: Taken) -> f64 {
    (taken.coordinator + taken.workers) / f64::from(LOAD.count()) * 1e6
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

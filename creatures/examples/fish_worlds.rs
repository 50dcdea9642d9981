//! What a step of a world costs (B-1, B-4): the published world of ten fishes, then ten to three hundred in a large
//! tank, from bytes to outcome.
//!
//! `cargo run --release -p creatures --example fish_worlds`

#![allow(clippy::disallowed_types, reason = "an example that measures needs a clock")]

use creatures::fish::Fish;
use creatures::fish::habits::{Genotype, Habits, Nature, Sex};
use creatures::{Nobody, System};
use serde_json::json;
use std::time::Instant;

fn main() {
    let prey = Genotype { habits: vec![Habits::published(Nature::Prey, Sex::Male)] }.encode();
    let (published, large) = ([400.0, 400.0, 200.0], [1600.0, 1600.0, 400.0]);
    for (fishes, tank, duration) in [
        (10u32, published, 110.0),
        (10, large, 110.0),
        (30, large, 110.0),
        (100, large, 27.5),
        (300, large, 27.5),
    ] {
        let (predators, courting) = (fishes / 10, fishes / 10 * 4);
        let table = json!({
            "scenario": "prey", "trials": 1, "duration": duration, "tank": tank,
            "predators": predators, "prey": fishes - predators - courting,
            "males": courting / 2, "females": courting / 2,
        });
        let resolved = Fish.resolve(table).expect("the world is legal");
        let task = Fish.task(&resolved.to_string()).expect("a resolved task is legal");
        let start = Instant::now();
        let outcome = task.evaluate(&prey, 1, None, &mut Nobody).expect("the habits are legal");
        let steps = f64::from(outcome.steps) / start.elapsed().as_secs_f64();
        let each = 1e6 / steps / f64::from(fishes);
        println!("{fishes:3} fishes in {tank:?}: {steps:.0} steps/s, {each:.1} us a fish and step");
    }
}

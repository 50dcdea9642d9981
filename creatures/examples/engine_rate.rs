//! What a step of the articulated-body engine costs: microseconds and rounds a step of each walker under
//! its open-loop commands and of a flyer-like chain. `cargo run --release -p creatures --example engine_rate`

#![allow(clippy::disallowed_types, reason = "an example that measures needs a clock")]
#![allow(missing_docs, reason = "the bodies are shared with the engine's tests")]

use creatures::physics::articulated;
use glam::DVec3;
use std::time::Instant;

#[path = "../src/physics/articulated/tests/bodies.rs"]
mod bodies;
#[path = "../src/physics/articulated/tests/gaits.rs"]
mod gaits;

/// Steps of a measured life; the shortest of several lives counts, as the least disturbed.
const STEPS: u32 = 1800;
const LIVES: u32 = 15;

fn main() {
    println!(
        "{:10} {:>9} {:>12} {:>11} {:>9}",
        "creature", "us/step", "rounds/step", "most rounds", "advance"
    );
    for gait in gaits::ALL {
        measure(
            gait.name,
            || (gait.body)(bodies::earth()),
            |creature, step| {
                if step % 4 == 0 {
                    (gait.commands)(creature, f64::from(step) / 240.0);
                }
                1.0 / 240.0
            },
        );
    }
    measure(
        "flyer",
        || bodies::flyer(articulated::Settings { gravity: DVec3::NEG_Y * 9.81, ..bodies::space() }),
        |creature, step| {
            gaits::flap(creature, f64::from(step) * 0.05);
            0.05
        },
    );
}

fn measure(
    name: &str,
    body: impl Fn() -> bodies::Creature,
    mut command: impl FnMut(&mut bodies::Creature, u32) -> f64,
) {
    let (mut best, mut rounds, mut most, mut advance) = (f64::INFINITY, 0, 0, 0.0);
    for _ in 0..LIVES {
        let mut creature = body();
        (rounds, most) = (0, 0);
        let start = Instant::now();
        for step in 0..STEPS {
            let dt = command(&mut creature, step);
            creature.world.step(dt).expect("a sound creature");
            rounds += creature.world.rounds();
            most = most.max(creature.world.rounds());
        }
        best = start.elapsed().as_secs_f64().min(best);
        advance = -creature.torso().y;
    }
    let steps = f64::from(STEPS);
    println!(
        "{name:10} {:9.3} {:12.2} {most:11} {advance:9.3}",
        best / steps * 1e6,
        f64::from(rounds) / steps
    );
}

//! What a step of the articulated-body engine costs: microseconds and rounds a step of each walker under a
//! gait and under random commands, and of a flyer-like chain. The shortest of several lives counts, as the
//! least disturbed one.
//!
//! `cargo run --release -p creatures --example engine_rate`

#![allow(clippy::disallowed_types, reason = "an example that measures needs a clock")]

use creatures::physics::articulated;
use creatures::random::stream;
use std::time::Instant;

#[allow(dead_code, reason = "shared with the engine's tests, which use more of it")]
#[path = "../src/physics/articulated/tests/bodies.rs"]
mod bodies;
#[path = "../src/physics/articulated/tests/gaits.rs"]
mod gaits;

const STEPS: u32 = 1800;
const LIVES: u32 = 15;

fn main() {
    println!("{:24} {:>8} {:>12} {:>6} {:>9}", "creature", "µs/step", "rounds/step", "most", "over 12");
    for gait in gaits::ALL {
        let commands = |creature: &mut bodies::Creature, step: u32| {
            if step.is_multiple_of(4) {
                (gait.commands)(creature, f64::from(step) / 240.0);
            }
        };
        measure(gait.name, 1.0 / 240.0, |_| (gait.body)(bodies::earth()), commands);
        let mut draws = stream(1, [0; 3], "commands");
        let random = |creature: &mut bodies::Creature, step: u32| {
            if step.is_multiple_of(40) {
                creature.command_all(|| if draws.chance(0.3) { 0.0 } else { draws.between(-1.2, 1.2) });
            }
        };
        let name = format!("{}, random commands", gait.name);
        measure(&name, 1.0 / 240.0, |_| (gait.body)(bodies::earth()), random);
    }
    let fall = articulated::Settings { gravity: glam::DVec3::NEG_Y * 9.81, ..bodies::space() };
    let flap = |creature: &mut bodies::Creature, step: u32| gaits::flap(creature, f64::from(step) * 0.05);
    measure("flyer", 0.05, |_| bodies::flyer(fall), flap);
}

fn measure(
    name: &str,
    dt: f64,
    body: impl Fn(u32) -> bodies::Creature,
    mut command: impl FnMut(&mut bodies::Creature, u32),
) {
    let (mut best, mut rounds, mut most, mut long) = (f64::INFINITY, 0, 0, 0);
    for life in 0..LIVES {
        let mut creature = body(life);
        let start = Instant::now();
        for step in 0..STEPS {
            command(&mut creature, step);
            creature.world.step(dt).expect("a sound creature");
            rounds += creature.world.rounds();
            most = most.max(creature.world.rounds());
            long += u32::from(creature.world.rounds() > 12);
        }
        best = start.elapsed().as_secs_f64().min(best);
    }
    let steps = f64::from(STEPS * LIVES);
    let share = 100.0 * f64::from(long) / steps;
    let rate = best / f64::from(STEPS) * 1e6;
    println!("{name:24} {rate:8.3} {:12.2} {most:6} {share:8.2}%", f64::from(rounds) / steps);
}

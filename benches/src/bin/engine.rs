//! Microseconds a step of every walker on rapier3d and on our engine: the same body, the same 1800 steps under
//! the same open-loop commands. MuJoCo's are in `benches/peers/mujoco_walkers.py`.

use std::time::Instant;

use creatures::walker::BodyKind;
use creatures::walker::phenotype::{Footing, Phenotype};
use hatchery_benches::commands::open_loop;
use hatchery_benches::rapier;
use hatchery_benches::report::Report;
use serde_json::json;

const CONTROL_HZ: f64 = 60.0;
const PHYSICS_HZ: f64 = 240.0;
const CONTROL_STEPS: usize = 450;
/// Physics steps under one command.
const HELD: usize = 4;
/// The best of so many counts: a machine is only ever slowed down by others.
const REPEATS: usize = 15;

/// One simulation: microseconds a step, and how far the body got, m.
type Measured = (f64, f64);

fn main() {
    let mut report = Report::new("engine", &["body", "engine", "us_per_step", "advance_m", "times_rapier"]);
    for body in BodyKind::ALL {
        let commands: Vec<Vec<f64>> =
            (0..CONTROL_STEPS).map(|k| open_loop(body, k as f64 / CONTROL_HZ)).collect();
        // Turn by turn, so that a busy moment of the machine falls on both.
        let (mut rapier, mut ours) = ((f64::INFINITY, 0.0), (f64::INFINITY, 0.0));
        for _ in 0..REPEATS {
            rapier = faster(rapier, on_rapier(body, &commands));
            ours = faster(ours, on_ours(body, &commands));
        }
        for (engine, measured) in [("rapier3d", rapier), ("ours", ours)] {
            let rate = rapier.0 / measured.0;
            report.row(&[
                json!(body.name()),
                json!(engine),
                json!(measured.0),
                json!(measured.1),
                json!(rate),
            ]);
        }
    }
}

fn faster(a: Measured, b: Measured) -> Measured {
    if b.0 < a.0 { b } else { a }
}

fn on_rapier(body: BodyKind, commands: &[Vec<f64>]) -> Measured {
    let mut walker = rapier::Walker::new(body, PHYSICS_HZ);
    let start = Instant::now();
    for command in commands {
        walker.drive(command);
        for _ in 0..HELD {
            walker.step();
        }
    }
    (microseconds_per_step(start), walker.advance())
}

fn on_ours(body: BodyKind, commands: &[Vec<f64>]) -> Measured {
    let mut walker = Phenotype::develop(body, &Footing::default());
    let start = Instant::now();
    for command in commands {
        walker.drive(command);
        for _ in 0..HELD {
            walker.step(1.0 / PHYSICS_HZ).expect("these commands blow no body up; a test says so (T-19)");
        }
    }
    (microseconds_per_step(start), -walker.world().position(walker.torso()).y)
}

fn microseconds_per_step(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e6 / (CONTROL_STEPS * HELD) as f64
}

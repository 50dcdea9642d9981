//! Microseconds a step of every walker on rapier3d and on our engine: the same body, the same 1800 steps under
//! the same open-loop commands. MuJoCo's are in `benches/peers/mujoco_walkers.py`.

use std::time::Instant;

use creatures::walker::BodyKind;
use hatchery_benches::commands::open_loop;
use hatchery_benches::rapier;
use hatchery_benches::report::Report;
use serde_json::json;

const CONTROL_HZ: f64 = 60.0;
const PHYSICS_HZ: f64 = 240.0;
const CONTROL_STEPS: usize = 450;
const HELD: usize = 4;
const REPEATS: usize = 9;

fn main() {
    let mut report = Report::new("engine", &["body", "engine", "us_per_step", "advance_m", "times_rapier"]);
    for body in BodyKind::ALL {
        let commands: Vec<Vec<f64>> = (0..CONTROL_STEPS).map(|k| open_loop(body, k as f64 / CONTROL_HZ)).collect();
        let mut rapier = (f64::INFINITY, 0.0);
        for _ in 0..REPEATS {
            rapier = faster(rapier, on_rapier(body, &commands));
        }
        report.row(&[json!(body.name()), json!("rapier3d"), json!(rapier.0), json!(rapier.1), json!(1.0)]);
    }
}

/// The quicker of two measurements: a machine is only ever slowed down by others.
fn faster(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.0 < a.0 { b } else { a }
}

/// Microseconds a step, and how far the body got, m.
fn on_rapier(body: BodyKind, commands: &[Vec<f64>]) -> (f64, f64) {
    let mut walker = rapier::Walker::new(body, PHYSICS_HZ);
    let start = Instant::now();
    for command in commands {
        walker.drive(command);
        for _ in 0..HELD {
            walker.step();
        }
    }
    (start.elapsed().as_secs_f64() * 1e6 / (CONTROL_STEPS * HELD) as f64, walker.advance())
}

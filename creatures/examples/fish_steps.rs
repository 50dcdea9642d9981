//! What a fish's step costs (B-2): a drill of the published length, whole, from bytes to outcome, a swim by motor
//! commands, and of such a step the solving of its equations and the search for faces that push water.
//!
//! `cargo run --release -p creatures --example fish_steps`

#![allow(clippy::disallowed_types, reason = "an example that measures needs a clock")]

use creatures::fish::hydrodynamics::pressed;
use creatures::fish::samples::{COUNT, STEPS};
use creatures::fish::skyline::Skyline;
use creatures::fish::{Body, Command, Encoding, Fish, Genotype, Samples, Still, Swimmer, Turn};
use creatures::random::stream;
use creatures::{Nobody, Status, System};
use glam::DVec3;
use std::sync::Arc;
use std::time::Instant;

/// Microseconds a step of the least disturbed of some runs, each of which gives its steps.
fn cost(mut run: impl FnMut() -> u32) -> f64 {
    let time = |_| {
        let start = Instant::now();
        let steps = run();
        start.elapsed().as_secs_f64() * 1e6 / f64::from(steps)
    };
    (0..50).map(time).fold(f64::INFINITY, f64::min)
}

fn main() {
    let task = Fish.task(r#"{"scenario":"drill"}"#).expect("the drill has defaults");
    let samples = Samples::random(0, Encoding::Tied, COUNT, STEPS, &mut stream(1, [0, 0, 0], "samples"));
    let genotype = Genotype::MuscleSamples(samples).encode();
    let drill = cost(|| {
        let outcome = task.evaluate(&genotype, 0, None, &mut Nobody).expect("samples are legal");
        assert_eq!(outcome.status, Status::Completed, "a drill is swum to its end");
        outcome.steps
    });
    println!("drill: {drill:.2} µs a step, {:.0} drills a second and core", 1e6 / (drill * f64::from(STEPS)));

    let mut fish = Swimmer::new(Arc::new(Body::published(1.0)), DVec3::ZERO, 0.0);
    let command = Command { swim: 1.0, turn: Turn::Bias(0.2), ..Command::default() };
    let swim = cost(|| {
        for _ in 0..1000 {
            fish.step(&command, &Still, &[]).expect("a swim stays within bounds");
        }
        1000
    });
    println!("swim: {swim:.2} µs a step, {:.0} steps a second and core", 1e6 / swim);

    let lattice = &fish.body.lattice;
    let nodes = lattice.masses.len();
    let mut matrix = Skyline::new(nodes, lattice.couplings());
    let mut right = vec![1.0; 3 * nodes];
    let solving = cost(|| {
        for _ in 0..1000 {
            matrix.clear();
            for node in 0..nodes {
                let inertia = [[1e3, 0.0, 0.0], [0.0, 1e3, 0.0], [0.0, 0.0, 1e3]];
                matrix.add_diagonal(matrix.block(node, node), &inertia);
            }
            matrix.factorise().expect("inertia is positive");
            matrix.solve(&mut right);
        }
        1000
    });
    let pressing = cost(|| {
        let count = || lattice.faces.iter().filter_map(|face| pressed(face, &fish.motion, &Still)).count();
        let pushing: usize = (0..1000).map(|_| std::hint::black_box(count())).sum();
        assert!(pushing > 0, "a moving fish pushes water");
        1000
    });
    let rest = swim - solving - pressing;
    for (what, time) in [("solving", solving), ("water", pressing), ("assembly and control", rest)] {
        println!("  {what}: {time:.2} µs, {:.0} %", 100.0 * time / swim);
    }
}

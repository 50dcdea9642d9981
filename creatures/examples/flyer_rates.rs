//! What a flyer's step costs against the number of wing segments, and where the time goes: in the brain, in the
//! air or in the solver.
//!
//! `cargo run --release -p creatures --example flyer_rates`
//!
//! With the argument `bodies` it prints those that it times, one JSON line each, and with `once` the rates of one
//! pass over them, both for `benches/peers/mujoco_flyers.py`.

#![allow(clippy::disallowed_types, reason = "an example that measures needs a clock")]

use creatures::flyer::phenotype::Phenotype;
use creatures::flyer::skeleton::{grow, motor_torque};
use creatures::flyer::{Brain, FlyerTask, Genotype, Settings};
use creatures::math::sin;
use creatures::random::stream;
use creatures::{Nobody, Task};
use glam::{DMat3, DQuat};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};
use std::time::Instant;

/// Wing segments a side.
const SEGMENTS: [usize; 5] = [1, 2, 4, 6, 8];
/// Bodies of each size.
const BODIES: usize = 5;
/// Lives of each body.
const LIVES: usize = 7;
/// Steps between two looks at the clock. A life is the same every time, and of each stretch of it the fastest
/// counts: others are at work on the machine, and hardly leave a whole life alone.
const STRETCH: u32 = 50;
/// Strokes a second of the open loop.
const STROKES: f64 = 0.5;

/// Thin air and height enough to stay in it for all steps.
fn task() -> FlyerTask {
    FlyerTask { start_height: 1e5, alpha: 3e-4, ..FlyerTask::default() }
}

/// The first founders of so many wing segments that fly all their steps.
fn flyers(segments: usize, task: &FlyerTask) -> Vec<Genotype> {
    (0..)
        .map(|place| Genotype::random(&Settings::default(), &mut stream(7, [0, 0, place], "founder")))
        .filter(|founder| founder.segments() == segments)
        .filter(|founder| {
            let outcome = task.evaluate(&founder.encode(), 0, None, &mut Nobody).expect("founders are legal");
            outcome.steps == task.steps
        })
        .take(BODIES)
        .collect()
}

/// Seconds of each stretch of a life.
fn stretches(task: &FlyerTask, mut step: impl FnMut(u32)) -> Vec<f64> {
    let times = (0..task.steps / STRETCH).map(|stretch| {
        let start = Instant::now();
        (stretch * STRETCH..(stretch + 1) * STRETCH).for_each(&mut step);
        start.elapsed().as_secs_f64()
    });
    times.collect()
}

/// Microseconds a step of the fastest stretches of some lives.
fn fastest(task: &FlyerTask, mut live: impl FnMut() -> Vec<f64>) -> f64 {
    let best = (1..LIVES).fold(live(), |best, _| {
        let found = live();
        best.iter().zip(found).map(|(best, found)| best.min(found)).collect()
    });
    best.iter().sum::<f64>() * 1e6 / f64::from(task.steps)
}

/// A life as an evaluation lives it: senses, two brain steps, motors, air, solver, survey.
fn whole(genotype: &Genotype, task: &FlyerTask) -> Vec<f64> {
    let (mut body, mut brain) = develop(genotype, task);
    let mut speed = 0.0_f64;
    let times = stretches(task, |step| {
        body.sense(brain.sensors_mut());
        think(&mut brain, step, task);
        body.drive(brain.effectors());
        body.step().expect("it flies all its steps");
        speed = speed.max(body.survey().speed);
    });
    assert!(speed > 1.0, "it moves");
    times
}

/// A life of the body alone under open-loop motors, and how far its first hinge swings about its mean, rad. Angles
/// are sensed, since motors stop short of their stops.
fn open_loop(genotype: &Genotype, task: &FlyerTask) -> (Vec<f64>, f64) {
    let (mut body, mut brain) = develop(genotype, task);
    let mut commands = vec![0.0; brain.effectors().len()];
    let mut flaps = Vec::with_capacity(task.steps as usize);
    let times = stretches(task, |step| {
        let now = f64::from(step) * task.dt;
        body.sense(brain.sensors_mut());
        for (index, command) in commands.iter_mut().enumerate() {
            *command = sin(TAU * (STROKES * now + 0.25 * index as f64));
        }
        body.drive(&commands);
        body.step().expect("it flies all its steps");
        flaps.push(body.flap());
    });
    let mean = flaps.iter().sum::<f64>() / flaps.len() as f64;
    let square = flaps.iter().map(|flap| (flap - mean) * (flap - mean)).sum::<f64>();
    (times, (square / flaps.len() as f64).sqrt())
}

/// What a life as in [`whole`] goes to, in shares: solver, air, brain, the rest. The clock is looked at after each
/// part, and what that takes is taken off; of each step the fastest of some lives counts.
fn shares(genotype: &Genotype, task: &FlyerTask) -> [f64; 4] {
    let mut best = vec![[f64::INFINITY; 4]; task.steps as usize];
    let tick = tick();
    for _ in 0..LIVES {
        let (mut body, mut brain) = develop(genotype, task);
        for (step, best) in (0..).zip(&mut best) {
            let begin = Instant::now();
            body.sense(brain.sensors_mut());
            let sensed = Instant::now();
            think(&mut brain, step, task);
            let thought = Instant::now();
            body.drive(brain.effectors());
            let driven = Instant::now();
            body.blow();
            let blown = Instant::now();
            body.advance().expect("it flies all its steps");
            let advanced = Instant::now();
            let speed = body.survey().speed;
            let end = Instant::now();
            assert!(speed.is_finite(), "it flies all its steps");
            let spent = |from: Instant, to: Instant| (to - from).as_secs_f64() - tick;
            let rest = spent(begin, sensed) + spent(thought, driven) + spent(advanced, end);
            let found = [spent(blown, advanced), spent(driven, blown), spent(sensed, thought), rest];
            best.iter_mut().zip(found).for_each(|(best, found)| *best = best.min(found));
        }
    }
    let sums: [f64; 4] = std::array::from_fn(|part| best.iter().map(|step| step[part]).sum());
    sums.map(|part| part / sums.iter().sum::<f64>())
}

/// Rounds of the solver a step in a life as in [`whole`]: the more motors and stops there are, the more often some
/// of them have been guessed wrong.
fn rounds(genotype: &Genotype, task: &FlyerTask) -> f64 {
    let (mut body, mut brain) = develop(genotype, task);
    let mut rounds = 0;
    for step in 0..task.steps {
        body.sense(brain.sensors_mut());
        think(&mut brain, step, task);
        body.drive(brain.effectors());
        body.step().expect("it flies all its steps");
        rounds += body.world().rounds();
    }
    f64::from(rounds) / f64::from(task.steps)
}

fn develop(genotype: &Genotype, task: &FlyerTask) -> (Phenotype, Brain) {
    (Phenotype::develop(&grow(genotype, task.start_height), task), Brain::new(genotype))
}

/// The brain steps of a step (F-30).
fn think(brain: &mut Brain, step: u32, task: &FlyerTask) {
    for substep in 0..task.brain_substeps {
        brain.step((f64::from(step) + f64::from(substep) / f64::from(task.brain_substeps)) * task.dt);
    }
}

/// What it takes to look at the clock, s: the least of some runs of looks.
fn tick() -> f64 {
    let looks = 1000;
    let run = || {
        let (start, mut last) = (Instant::now(), Instant::now());
        (0..looks).for_each(|_| last = Instant::now());
        (last - start).as_secs_f64() / f64::from(looks)
    };
    (0..100).map(|_| run()).fold(f64::INFINITY, f64::min)
}

/// What MuJoCo needs to know of a body; parts are named by their place among its bones.
fn body(name: &str, genotype: &Genotype, task: &FlyerTask) -> Value {
    let bones = grow(genotype, task.start_height);
    let mass = |radius: f64, length: f64| task.density * PI * radius * radius * (length + 4.0 / 3.0 * radius);
    let parts = bones.iter().map(|bone| {
        let hold = bone.hold.map(|hold| {
            let base = &bones[hold.parent];
            let masses = (mass(base.radius, base.length), mass(bone.radius, bone.length));
            json!({
                "parent": hold.parent,
                "at": hold.at,
                "hinge": hold.hinge,
                "torque": motor_torque(task.motor_k, masses, (base.length, bone.length)),
            })
        });
        let turn = DQuat::from_mat3(&DMat3::from_cols(bone.axes.x_axis, bone.axes.y_axis, bone.axes.z_axis));
        json!({
            "length": bone.length,
            "radius": bone.radius,
            "centre": bone.centre,
            "quaternion": [turn.w, turn.x, turn.y, turn.z],
            "hold": hold,
        })
    });
    json!({
        "name": name,
        "segments": genotype.segments(),
        "steps": task.steps,
        "dt": task.dt,
        "gravity": task.gravity,
        "density": task.density,
        "alpha": task.alpha,
        "strokes": STROKES,
        "hinge": [task.hinge_rate, task.hinge_limit],
        "ball": [task.ball_rate, task.ball_limit],
        "parts": parts.collect::<Vec<_>>(),
    })
}

/// Means over the bodies of one size.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    values.sum::<f64>() / BODIES as f64
}

fn main() {
    let task = task();
    let sizes = SEGMENTS.map(|segments| (segments, flyers(segments, &task)));
    match std::env::args().nth(1).as_deref() {
        Some("bodies") => {
            for (segments, flyers) in &sizes {
                for (index, flyer) in flyers.iter().enumerate() {
                    println!("{}", body(&format!("{segments}.{index}"), flyer, &task));
                }
            }
        }
        Some("once") => {
            for (segments, flyers) in &sizes {
                for (index, flyer) in flyers.iter().enumerate() {
                    let name = format!("{segments}.{index}");
                    let (mut swing, whole) = (0.0, fastest(&task, || whole(flyer, &task)));
                    let open = fastest(&task, || {
                        let (times, found) = open_loop(flyer, &task);
                        swing = found;
                        times
                    });
                    println!("{}", json!({ "name": name, "open": open, "whole": whole, "swing": swing }));
                }
            }
        }
        _ => table(&sizes, &task),
    }
}

fn table(sizes: &[(usize, Vec<Genotype>)], task: &FlyerTask) {
    println!(
        "segments  bodies  us/step  open loop  rounds |  solver     air   brain  senses, motors, survey"
    );
    for (segments, flyers) in sizes {
        let lives = mean(flyers.iter().map(|flyer| fastest(task, || whole(flyer, task))));
        let open = mean(flyers.iter().map(|flyer| fastest(task, || open_loop(flyer, task).0)));
        let rounds = mean(flyers.iter().map(|flyer| rounds(flyer, task)));
        let shares: Vec<[f64; 4]> = flyers.iter().map(|flyer| shares(flyer, task)).collect();
        let [solver, air, brain, rest] =
            std::array::from_fn(|part| 100.0 * mean(shares.iter().map(|shares| shares[part])));
        println!(
            "{segments:8}  {:6}  {lives:7.2}  {open:9.2}  {rounds:6.2} | {solver:5.0} % {air:5.0} % {brain:5.0} %  {rest:5.0} %",
            2 + 2 * segments,
        );
    }
}

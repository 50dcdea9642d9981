//! What a step of an ESP creature costs, and how step and rounds of the solver hold its joints, its energy and
//! its muscles (E-22, E-23, E-25).
//!
//! `cargo run --release -p creatures --example esp_steps`
//!
//! With the argument `bodies` it prints those that it times, one JSON line each, and with `once` the rates of one
//! pass over them, both for `benches/peers/mujoco_esp.py`.

#![allow(clippy::disallowed_types, reason = "an example that measures needs a clock")]

use creatures::esp::Genotype;
use creatures::esp::body::genotype::Joint;
use creatures::esp::body::{Body, Phenotype, Shape};
use creatures::esp::brain::{Circuit, Forced};
use creatures::esp::creature::Creature;
use creatures::esp::fitness::Start;
use creatures::esp::physics::Physics;
use creatures::esp::sample::{self, FRONT};
use creatures::esp::syllabus::{SkillId, Syllabus, SyllabusTable};
use creatures::esp::trial::{Light, Living};
use creatures::math::sin;
use glam::DVec3;
use serde_json::json;
use std::f64::consts::TAU;
use std::time::Instant;

/// Brain steps of a life: 10 s.
const STEPS: usize = 600;
/// Lives of each body in which rates are measured.
const LIVES: usize = 5;

/// What one life came to.
#[derive(Debug, Default, Clone, Copy)]
struct Life {
    /// Worst separation of a joint, m.
    apart: f64,
    /// Worst surplus of energy, as a height to which it lifts the creature, m.
    surplus: f64,
    /// Horizontal way, m.
    way: f64,
    /// Of all steps, s.
    seconds: f64,
    faults: usize,
}

/// Muscles fully on and off in turns of so many steps, neighbours against each other; a period of 0 is slack.
fn live(body: &Phenotype, physics: Physics, period: usize) -> Life {
    let mut life = Life::default();
    let Ok(mut creature) = Creature::spawn(body, physics, Start::Rest) else {
        return Life { faults: 1, ..life };
    };
    let begun = creature.state().centre;
    let mut activations = vec![0.0; body.muscles.len()];
    let start = Instant::now();
    for step in 0..STEPS {
        for (muscle, activation) in activations.iter_mut().enumerate() {
            let on = period > 0 && (step / period + muscle).is_multiple_of(2);
            *activation = f64::from(u8::from(on));
        }
        if creature.step(&activations).is_err() {
            life.faults = 1;
            break;
        }
        life.apart = life.apart.max(creature.separation());
        life.surplus = life.surplus.max(creature.surplus() / creature.weight());
    }
    life.seconds = start.elapsed().as_secs_f64();
    life.way = (creature.state().centre - begun).with_z(0.0).length();
    life
}

/// How far a slack body creeps in 10 s, once it has lain down, m (E-23); nothing of one that does not come to rest
/// (E-20), which counts as a fault.
fn creep(body: &Phenotype, physics: Physics) -> f64 {
    let Ok(mut creature) = Creature::spawn(body, physics, Start::Rest) else { return 0.0 };
    let slack = vec![0.0; body.muscles.len()];
    (0..240).for_each(|_| creature.step(&slack).expect("it lies down"));
    let before = creature.state().centre;
    (0..STEPS).for_each(|_| creature.step(&slack).expect("it lies there"));
    (creature.state().centre - before).length()
}

/// Hand-made bodies with joints of several kinds.
fn bodies() -> Vec<(&'static str, Phenotype)> {
    let with = |joint, axis| {
        let mut body = sample::quadruped_body();
        body.edges.iter_mut().for_each(|edge| (edge.joint, edge.axis) = (joint, axis));
        body
    };
    let mut thin = sample::body(&[FRONT, 0.0, -FRONT], true);
    thin.edges.iter_mut().for_each(|edge| edge.scale = 0.6);
    let bodies = [
        ("quadruped", sample::quadruped_body()),
        ("balls", with(Joint::Spherical, DVec3::Y)),
        ("sliders", with(Joint::Cylindrical, DVec3::Z)),
        ("thin", thin),
    ];
    bodies.map(|(name, body)| (name, develop(&body))).into()
}

/// Those that are timed: 4, 9 and 16 parts. With its middle legs right in the middle the last does not come to rest
/// within its time (E-20).
fn timed() -> [(&'static str, Body); 3] {
    [
        ("tail", sample::body(&[], true)),
        ("quadruped", sample::quadruped_body()),
        ("hexapod", sample::body(&[FRONT, -0.02, -FRONT], true)),
    ]
}

fn develop(body: &Body) -> Phenotype {
    body.develop().expect("hand-made bodies are legal")
}

fn table() {
    let bodies = bodies();
    println!(
        "substeps rounds | joint mm | surplus mm | faults | slack way mm | way m at 1, 2, 4 Hz | µs a step"
    );
    let tried = [(4, 1, 8), (4, 2, 1), (4, 2, 2), (4, 2, 4), (4, 2, 6), (4, 4, 2), (8, 1, 4), (16, 2, 4)];
    for (substeps, rounds, sweeps) in tried {
        let physics = Physics { substeps, rounds, sweeps, ..Physics::default() };
        let (mut worst, mut slack, mut cost) = (Life::default(), 0.0_f64, f64::INFINITY);
        let mut ways = Vec::new();
        for (name, body) in &bodies {
            slack = slack.max(creep(body, physics));
            for period in [30, 15, 8] {
                let life = live(body, physics, period);
                worst.apart = worst.apart.max(life.apart);
                worst.surplus = worst.surplus.max(life.surplus);
                worst.faults += life.faults;
                if *name == "quadruped" {
                    ways.push(format!("{:.2}", life.way));
                    cost = cost.min(life.seconds / STEPS as f64 * 1e6);
                }
            }
        }
        println!(
            "{substeps:8} {rounds:6} {sweeps:6} | {:8.1} | {:10.2} | {:6} | {:12.1} | {:20} | {cost:8.1}",
            worst.apart * 1e3,
            worst.surplus * 1e3,
            worst.faults,
            slack * 1e3,
            ways.join(" "),
        );
    }
}

fn syllabus() -> Syllabus {
    let skill = serde_json::json!({ "skill": [{ "id": "it", "fitness": { "kind": "locomotion" } }] });
    serde_json::from_value::<SyllabusTable>(skill).expect("it is a table").check().expect("it is legal")
}

/// Seconds of each step of a life with oscillating muscles under the same open loop, or with a brain and so many
/// lights; and of that what the brain and the senses take.
fn driven(genotype: &Genotype, body: &Phenotype, lights: Option<usize>) -> [Vec<f64>; 2] {
    let forced = [Forced { skill: SkillId(0), sigma: 1.0 }];
    let seen = &[Light { position: DVec3::new(5.0, 1.0, 0.3), strength: 0.3 }; 3][..lights.unwrap_or(0)];
    let mut creature = Creature::spawn(body, Physics::default(), Start::Rest).expect("it settles");
    let mut circuit = Circuit::new(&genotype.brain, &body.instances(), &syllabus(), &forced);
    let mut activations = vec![0.0; body.muscles.len()];
    let (mut times, mut minding) = (Vec::with_capacity(STEPS), Vec::with_capacity(STEPS));
    for step in 0..STEPS {
        let begun = Instant::now();
        if lights.is_some() {
            creature.feel(circuit.lengths_mut());
            creature.see(seen, circuit.photos_mut());
            activations.copy_from_slice(circuit.tick());
        } else {
            for (muscle, activation) in activations.iter_mut().enumerate() {
                let strides = 1.5 / 60.0 * step as f64 + 0.25 * muscle as f64;
                *activation = 0.5 + 0.5 * sin(TAU * strides);
            }
        }
        minding.push(begun.elapsed().as_secs_f64());
        creature.step(&activations).expect("it lives");
        times.push(begun.elapsed().as_secs_f64());
    }
    [times, minding]
}

/// Seconds of each step of a slack life: of the engine alone, four steps at a time, or with our face, state and
/// checks.
fn slack(body: &Phenotype, alone: bool) -> [Vec<f64>; 1] {
    let slack = vec![0.0; body.muscles.len()];
    let mut creature = Creature::spawn(body, Physics::default(), Start::Rest).expect("it settles");
    let times = (0..STEPS).map(|_| {
        let begun = Instant::now();
        if alone {
            (0..Physics::default().substeps).for_each(|_| creature.world_mut().step());
        } else {
            creature.step(&slack).expect("it lies there");
        }
        begun.elapsed().as_secs_f64()
    });
    [times.collect()]
}

/// Microseconds a step. A life is the same every time, and of each of its steps the fastest of some lives counts:
/// others are at work on the machine, and leave no whole life alone.
fn fastest<const N: usize>(live: impl Fn() -> [Vec<f64>; N]) -> [f64; N] {
    let best = (1..LIVES).fold(live(), |mut best, _| {
        for (best, found) in best.iter_mut().flatten().zip(live().iter().flatten()) {
            *best = best.min(*found);
        }
        best
    });
    best.map(|times| times.iter().sum::<f64>() / STEPS as f64 * 1e6)
}

/// Microseconds a step of a body, each in lives of its own.
#[derive(Debug, Clone, Copy)]
struct Rates {
    /// Of the engine alone, slack.
    engine: f64,
    /// Of the whole, slack.
    slack: f64,
    /// Of the whole, its muscles driven by an open loop.
    open: f64,
    /// Of the whole, with a brain that sees three lights.
    whole: f64,
    /// Of that, brain and senses.
    mind: f64,
}

impl Rates {
    fn of(genotype: &Genotype, body: &Phenotype) -> Rates {
        let [engine] = fastest(|| slack(body, true));
        let [slack] = fastest(|| slack(body, false));
        let [open, _] = fastest(|| driven(genotype, body, None));
        let [whole, mind] = fastest(|| driven(genotype, body, Some(3)));
        Rates { engine, slack, open, whole, mind }
    }
}

/// Those that are timed, with their brains and their rates.
fn rates() -> impl Iterator<Item = (&'static str, Phenotype, Rates)> {
    timed().into_iter().map(|(name, body)| {
        let genotype = sample::walking(body);
        let body = develop(&genotype.body);
        let rates = Rates::of(&genotype, &body);
        (name, body, rates)
    })
}

fn print_table_of_rates() {
    println!(
        "\nµs a step | parts | engine slack | ours slack | open loop | with brain, 3 lights | of it brain and senses | trials of 10 s a second"
    );
    for (name, body, Rates { engine, slack, open, whole, mind }) in rates() {
        println!(
            "{name:9} | {:5} | {engine:12.1} | {slack:10.1} | {open:9.1} | {whole:20.1} | {mind:22.1} | {:.1}",
            body.parts.len(),
            1e6 / (whole * STEPS as f64)
        );
    }
}

/// One JSON line a body.
fn print_rates() {
    for (name, _, Rates { engine, slack, open, whole, mind }) in rates() {
        let rates = json!({
            "name": name, "engine": engine, "slack": slack, "open": open, "whole": whole, "mind": mind,
        });
        println!("{rates}");
    }
}

/// One JSON line a body.
fn print_bodies() {
    for (name, body) in timed() {
        let body = develop(&body);
        let bottom = body.parts.iter().map(|part| part.position.z - part.shape.reach(DVec3::Z));
        let parts: Vec<_> = body
            .parts
            .iter()
            .map(|part| {
                let Shape::Box(half) = part.shape else { unreachable!("they are made of boxes") };
                let joint = part.joint.map(|joint| {
                    json!({
                        "parent": joint.parent,
                        "parent_anchor": joint.parent_anchor,
                        "child_anchor": joint.child_anchor,
                        "axis": joint.axis,
                    })
                });
                json!({ "half": half, "joint": joint })
            })
            .collect();
        let muscles = body.muscles.iter().map(|muscle| {
            json!({
                "parts": muscle.parts,
                "ends": muscle.ends,
                "rest_length": muscle.rest_length,
                "force_max": muscle.force_max,
            })
        });
        let height = 0.01 - bottom.fold(f64::INFINITY, f64::min);
        let muscles: Vec<_> = muscles.collect();
        println!("{}", json!({ "name": name, "height": height, "parts": parts, "muscles": muscles }));
    }
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("bodies") => print_bodies(),
        Some("once") => print_rates(),
        _ => {
            table();
            print_table_of_rates();
        }
    }
}

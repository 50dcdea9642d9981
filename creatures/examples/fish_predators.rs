//! A persistent predator beside a fickle one: the same hunts by predators that stick to a prey more or
//! less, how often each goes from one prey to another, and what it catches.
//!
//! `cargo run --release -p creatures --example fish_predators [HUNTS]`

use creatures::fish::Body;
use creatures::fish::habits::{Habits, Nature, Sex};
use creatures::fish::mind::Target;
use creatures::fish::world::{Aquarium, Climate, Currents, Environment, FishId, Inhabitant, Tank, tank};
use creatures::random::stream;
use glam::DVec3;
use std::sync::Arc;

/// What came of a hunt.
struct Hunt {
    /// Prey caught.
    catches: u32,
    /// From one living prey to another.
    changes: u32,
    /// Time of the first catch, if there was one.
    first: Option<f64>,
}

/// Prey of a hunt, and how long it lasts.
const PREY: u32 = 8;
const DURATION: f64 = 300.0;

fn main() {
    let hunts: u64 = std::env::args().nth(1).and_then(|hunts| hunts.parse().ok()).unwrap_or(10);
    println!("persistence  prey caught  changes of prey  first catch, mean time of those with one");
    for persistence in [0.0, 40.0, 200.0] {
        let results: Vec<Hunt> = (0..hunts).map(|seed| hunt(seed, persistence)).collect();
        let mean = |of: &dyn Fn(&Hunt) -> f64| results.iter().map(of).sum::<f64>() / results.len() as f64;
        let first: Vec<f64> = results.iter().filter_map(|hunt| hunt.first).collect();
        println!(
            "{persistence:11} {:12.1} {:16.1}  {:.0} ({} of {hunts})",
            mean(&|hunt| f64::from(hunt.catches)),
            mean(&|hunt| f64::from(hunt.changes)),
            first.iter().sum::<f64>() / first.len().max(1) as f64,
            first.len()
        );
    }
}

fn hunt(seed: u64, persistence: f64) -> Hunt {
    let mut draws = stream(seed, [0, 0, 0], "hunt");
    let prey = Habits::published(Nature::Prey, Sex::Male);
    let predator = Habits { appetite: 20.0, persistence, ..Habits::published(Nature::Predator, Sex::Male) };
    let all = std::iter::once(predator).chain(std::iter::repeat_n(prey, PREY as usize));
    let fishes = (0..).map(FishId).zip(all).map(|(id, habits)| {
        let place = match id {
            FishId(0) => DVec3::new(0.0, -150.0, 0.0),
            _ => DVec3::new(
                draws.between(-120.0, 120.0),
                draws.between(-40.0, 120.0),
                draws.between(-50.0, 50.0),
            ),
        };
        let heading = draws.between(-std::f64::consts::PI, std::f64::consts::PI);
        let body = Arc::new(Body::published(habits.size));
        Inhabitant::new(id, habits, body, place, heading, seed, 0)
    });
    let environment = Environment {
        tank: Tank::new(tank::PUBLISHED),
        currents: Currents::default(),
        climate: Climate::default(),
        obstacles: Vec::new(),
    };
    let mut aquarium = Aquarium::new(environment, fishes.collect(), Vec::new());
    let (mut held, mut changes, mut first) = (None, 0, None);
    while aquarium.time() < DURATION {
        aquarium.step().expect("a hunt stays within the model");
        let caught = aquarium.fishes[0].deeds.meals;
        if caught > 0 && first.is_none() {
            first = Some(aquarium.time());
        }
        if let Some(Target::Fish(now)) = aquarium.fishes[0].mind.target {
            let given_up =
                held.is_some_and(|before: FishId| before != now && aquarium.figures[before.index()].alive);
            changes += u32::from(given_up);
            held = Some(now);
        }
    }
    Hunt { catches: aquarium.fishes[0].deeds.meals, changes, first }
}

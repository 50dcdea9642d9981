//! How a pair courts (A-80..A-84): four pairs alone in the published tank, each stage as it begins, and of the
//! nuzzling where he is to her.
//!
//! `cargo run --release -p creatures --example fish_courtship [EVERY]` prints a line every so many steps; 0, the
//! default, prints the stages alone.

use creatures::fish::Body;
use creatures::fish::behaviour::Stage;
use creatures::fish::habits::{Habits, Nature, Sex};
use creatures::fish::world::{Aquarium, Climate, Currents, Environment, FishId, Inhabitant, Tank, tank};
use creatures::random::stream;
use glam::DVec3;
use std::sync::Arc;

fn main() {
    let every: u32 = std::env::args().nth(1).and_then(|every| every.parse().ok()).unwrap_or(0);
    for seed in 0..4 {
        pair(seed, every);
    }
}

fn pair(seed: u32, every: u32) {
    let mut draws = stream(u64::from(seed), [0, 0, 0], "pair");
    let fish = |id: u32, sex: Sex, place: DVec3, heading: f64| {
        let habits = Habits { digestion: 0.0003, ..Habits::published(Nature::Pacifist, sex) };
        let body = Arc::new(Body::published(habits.size));
        let mut fish = Inhabitant::new(FishId(id), habits, body, place, heading, 1, 0);
        (fish.mind.drives.meals, fish.mind.drives.since_mating) = (5, 400.0);
        fish
    };
    let [his, aside, hers] = [180.0, 80.0, 180.0].map(|most| draws.between(-most, most));
    let fishes = vec![
        fish(0, Sex::Male, DVec3::ZERO, f64::to_radians(his)),
        fish(1, Sex::Female, DVec3::new(aside, 80.0, -20.0), f64::to_radians(hers)),
    ];
    let environment = Environment {
        tank: Tank::new(tank::PUBLISHED),
        currents: Currents::default(),
        climate: Climate::default(),
        obstacles: Vec::new(),
    };
    let mut aquarium = Aquarium::new(environment, fishes, Vec::new());
    let mut last = [Stage::Search; 2];
    while aquarium.time() < 1500.0 && aquarium.fishes[0].deeds.matings == 0 {
        aquarium.step().expect("a courting fish stays within the model");
        let stages = [aquarium.figures[0].stage, aquarium.figures[1].stage];
        let due = every > 0 && aquarium.steps.is_multiple_of(every) && stages[0] >= Stage::Ascend;
        if stages != last || due {
            tell(seed, &aquarium);
        }
        last = stages;
    }
    println!("pair {seed}: {} matings at {:.0}", aquarium.fishes[0].deeds.matings, aquarium.time());
}

/// Where he is to her: in her plane how far ahead of her abdomen and to its left his mouth is, and how far below,
/// by L; speeds by L.
fn tell(seed: u32, aquarium: &Aquarium) {
    let [him, her] = [&aquarium.figures[0], &aquarium.figures[1]];
    let level = DVec3::new(her.forward.x, her.forward.y, 0.0).normalize_or_zero();
    let way = (him.mouth - her.abdomen) / her.length();
    let left = DVec3::Z.cross(level);
    let pitch = |forward: DVec3| creatures::math::asin(forward.z.clamp(-1.0, 1.0)).to_degrees();
    println!(
        "pair {seed} t {:6.1} him {:?} {:?} her {:?} {:?}: ahead {:5.2} left {:5.2} above {:5.2}, headings {:3.0} \
         apart, pitch {:3.0} {:3.0}, roll {:3.0}, speed {:.3} {:.3}",
        aquarium.time(),
        aquarium.fishes[0].mind.intention,
        him.stage,
        aquarium.fishes[1].mind.intention,
        her.stage,
        way.dot(level),
        way.dot(left),
        way.z,
        him.forward.angle_between(her.forward).to_degrees(),
        pitch(him.forward),
        pitch(her.forward),
        aquarium.fishes[0].swimmer.posture().roll().to_degrees(),
        him.velocity.length() / him.length(),
        her.velocity.length() / her.length(),
    );
}

//! What is seen of a world: the tank, what stands in it, the fishes and what they feed on. It moves and
//! measures nothing.

use super::{Aquarium, Event, Inhabitant, Obstacle};
use crate::fish::habits::{Nature, Sex};
use crate::fish::scene::{add_fish, nodes, water};
use crate::record::{self, Frame, Happening, Mind, Part, Pose, Prop, Scene, Shape};
use glam::DVec3;

/// Everything of a trial: fishes in order of id, then particles.
pub(super) fn scene(aquarium: &Aquarium) -> Scene {
    let mut scene = water();
    for (id, fish) in aquarium.fishes.iter().enumerate() {
        let kind = match (fish.habits.nature, fish.habits.sex) {
            (Nature::Predator, _) => "predator",
            (Nature::Prey, _) => "prey",
            (Nature::Pacifist, Sex::Male) => "male",
            (Nature::Pacifist, Sex::Female) => "female",
        };
        add_fish(&mut scene, format!("{kind}_{id}"), &fish.swimmer.body);
    }
    let specks = (0..aquarium.particles.len()).map(|id| Part {
        name: speck(id),
        creature: None,
        shapes: vec![Shape::Point],
    });
    scene.parts.extend(specks);
    let environment = &aquarium.environment;
    scene.props.push(Prop {
        name: "tank".to_owned(),
        shape: Shape::Room { half: environment.tank.half },
        pose: Pose::at(DVec3::ZERO),
    });
    scene.props.extend(environment.obstacles.iter().map(|obstacle| Prop {
        name: "obstacle".to_owned(),
        shape: shape(obstacle),
        pose: Pose::at(obstacle.center()),
    }));
    scene
}

fn shape(obstacle: &Obstacle) -> Shape {
    match *obstacle {
        Obstacle::Sphere { radius, .. } => Shape::Sphere { radius },
        Obstacle::Cylinder { radius, half_height, .. } => {
            Shape::Cylinder { radius, half_length: half_height }
        }
        Obstacle::Box { half, .. } => Shape::Box { half: DVec3::from_array(half) },
    }
}

/// Where everything is now. Who was eaten is absent, its centre where it was last.
pub(super) fn frame(aquarium: &Aquarium) -> Frame {
    let fish = aquarium.fishes.iter().map(|fish| match fish.deeds.died {
        None => nodes(&fish.swimmer),
        Some(_) => Pose::Absent,
    });
    let specks = aquarium
        .particles
        .iter()
        .map(|speck| if speck.present { Pose::at(speck.position) } else { Pose::Absent });
    Frame {
        centers: aquarium.fishes.iter().map(|fish| fish.swimmer.center_of_mass()).collect(),
        poses: fish.chain(specks).collect(),
        muscles: aquarium.fishes.iter().map(|fish| fish.swimmer.actuation().to_vec()).collect(),
        minds: aquarium.fishes.iter().map(mind).collect(),
    }
}

fn mind(fish: &Inhabitant) -> Option<Mind> {
    let [hunger, libido, fear] = fish.mind.felt;
    let intention = word(fish.mind.intention);
    let courtship = word(fish.routines.courtship.stage);
    fish.deeds.died.is_none().then_some(Mind { intention, hunger, libido, fear, courtship })
}

/// What happened in a step, as it is told.
pub(super) fn event(aquarium: &Aquarium, event: Event) -> record::Event {
    let (fish, happening) = match event {
        Event::Change { fish, from, to, cause } => {
            (fish, Happening::Intention { from: word(from), to: word(to), cause: word(cause) })
        }
        Event::Meal(fish, particle) => (fish, Happening::Meal { of: speck(particle.index()) }),
        Event::Kill(by, fish) => (fish, Happening::Death { by: by.0 }),
        Event::Mating(fish, with) => (fish, Happening::Mating { with: with.0 }),
    };
    record::Event { time: aquarium.time(), creature: fish.0, happening }
}

/// The name of a variant, in small letters.
fn word(variant: impl std::fmt::Debug) -> String {
    format!("{variant:?}").to_lowercase()
}

fn speck(id: usize) -> String {
    format!("food_{id}")
}

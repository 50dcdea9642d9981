//! A world is built once and stepped for ever: no step allocates, shown by an allocator that counts what each
//! thread asks for, since the test harness allocates on its own.

use creatures::esp::brain::{Circuit, Forced};
use creatures::esp::creature::Creature;
use creatures::esp::fitness::Start;
use creatures::esp::physics::Physics;
use creatures::esp::sample;
use creatures::esp::syllabus::{SkillId, SyllabusTable};
use creatures::esp::trial::{Light, Living};
use creatures::fish::habits::{Habits, Nature, Sex};
use creatures::fish::samples::{COUNT, STEPS};
use creatures::fish::world::{
    Aquarium, Climate, Currents, Environment, FishId, Inhabitant, Obstacle, Particle, ParticleId, Stuff, Tank,
};
use creatures::fish::{
    Body as FishBody, Calibrated, Chase, ControllerSet, Encoding, Samples, Still, Swimmer, abstracted,
};
use creatures::flyer::phenotype::Phenotype;
use creatures::flyer::{self, Brain, FlyerTask, skeleton, variation};
use creatures::physics::articulated::{Body, Ground, Joint, JointKind, ModelBuilder, Motor, Settings};
use creatures::random::stream;
use glam::DVec3;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::collections::BTreeSet;
use std::sync::Arc;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator as it came.
#[allow(unsafe_code, reason = "a global allocator cannot be written without")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn a_step_allocates_nothing() {
    let settings = Settings { gravity: DVec3::NEG_Z * 9.81, erp: 0.2, ground: Some(Ground::level(0.9)) };
    let mut model = ModelBuilder::new(settings);
    let size = DVec3::new(0.1, 0.1, 0.05);
    let mut parent = model.root(Body::cuboid(size, 100.0, DVec3::Z * 0.3));
    let mut joints = vec![];
    let kinds = [
        JointKind::Hinge { axis: DVec3::X },
        JointKind::Ball,
        JointKind::Slider { axis: DVec3::Y },
        JointKind::Fixed,
    ];
    for (k, kind) in kinds.into_iter().enumerate() {
        let joint = Joint {
            kind,
            parent_anchor: DVec3::Y * 0.05,
            child_anchor: DVec3::Y * -0.05,
            stops: std::array::from_fn(|dof| (dof < kind.degrees()).then_some((-0.05, 0.05))),
        };
        let at = DVec3::new(0.0, 0.1 * (k + 1) as f64, 0.3);
        let (body, joint) = model.attach(parent, Body::cuboid(size, 100.0, at), joint).unwrap();
        parent = body;
        joints.push(joint);
    }
    let built = ALLOCATIONS.get();
    let mut world = model.build().unwrap();
    assert!(ALLOCATIONS.get() > built, "the allocator counts");
    let (mut touched, mut rounds) = (false, 0);
    let before = ALLOCATIONS.get();
    for step in 0..2000_u32 {
        for &joint in &joints {
            for dof in 0..world.degrees(joint) {
                let rate = if step / 100 % 2 == 0 { 3.0 } else { -3.0 };
                world.drive(joint, dof, Motor { rate, effort: 0.5 });
            }
        }
        world.push(parent, DVec3::X * 0.01, DVec3::ZERO);
        world.step(1.0 / 240.0).unwrap();
        touched |= world.touches(parent, 0.0);
        rounds = rounds.max(world.rounds());
    }
    let after = ALLOCATIONS.get();
    assert!(touched && rounds > 2, "the life is eventful: touched {touched}, {rounds} rounds");
    assert_eq!(after - before, 0);
}

#[test]
fn a_brain_step_of_a_flyer_allocates_nothing() {
    let settings = variation::Settings::default();
    let mut draws = stream(1, [0, 0, 0], "allocation test");
    for _ in 0..20 {
        let genotype = flyer::Genotype::random(&settings, &mut draws);
        let built = ALLOCATIONS.get();
        let mut brain = Brain::new(&genotype);
        assert!(ALLOCATIONS.get() > built, "the allocator counts");
        let (before, mut moved) = (ALLOCATIONS.get(), 0.0);
        for step in 0..100_u32 {
            let reading = if step / 20 % 2 == 0 { 0.5 } else { -0.5 };
            brain.sensors_mut().fill(reading);
            brain.step(f64::from(step) * 0.025);
            moved += brain.effectors().iter().map(|command| command.abs()).sum::<f64>();
        }
        assert_eq!(ALLOCATIONS.get() - before, 0);
        assert!(moved > 0.0, "the brain is alive");
    }
}

#[test]
fn a_flyers_step_in_the_air_allocates_nothing() {
    let task = FlyerTask { alpha: 3e-4, ..FlyerTask::default() };
    let mut draws = stream(2, [0, 0, 0], "allocation test");
    for _ in 0..20 {
        let genotype = flyer::Genotype::random(&variation::Settings::default(), &mut draws);
        let built = ALLOCATIONS.get();
        let mut phenotype = Phenotype::develop(&skeleton::grow(&genotype, task.start_height), &task);
        let mut brain = Brain::new(&genotype);
        assert!(ALLOCATIONS.get() > built, "the allocator counts");
        let (before, mut fastest) = (ALLOCATIONS.get(), 0.0);
        for step in 0..100_u32 {
            phenotype.sense(brain.sensors_mut());
            brain.step(f64::from(step) * task.dt);
            phenotype.drive(brain.effectors());
            phenotype.step().unwrap();
            fastest = phenotype.survey().speed.max(fastest);
        }
        assert_eq!(ALLOCATIONS.get() - before, 0);
        assert!(fastest > 1.0, "it falls");
    }
}

#[test]
fn a_fishs_step_allocates_nothing_whether_hand_made_or_learned() {
    let stream = &mut stream(3, [0, 0, 0], "allocation test");
    let controller = abstracted(&Samples::random(0, Encoding::Tied, COUNT, STEPS, stream), 1);
    let entry =
        |name: &str, measured| Calibrated { name: name.to_owned(), controller: controller.clone(), measured };
    let set = ControllerSet { swims: vec![entry("swim", 0.05)], turns: vec![entry("turn", 0.02)] };
    let built = ALLOCATIONS.get();
    let fish = Swimmer::new(Arc::new(FishBody::published(1.0)), DVec3::ZERO, 0.0);
    assert!(ALLOCATIONS.get() > built, "the allocator counts");
    for mut fish in [fish.clone(), fish.taught(&set)] {
        let mut chase = Chase::default();
        let (start, before) = (fish.center_of_mass(), ALLOCATIONS.get());
        for _ in 0..400 {
            let command = chase.toward(DVec3::new(-40.0, 30.0, 10.0), 1.0, &fish.posture(), 1.0);
            fish.step(&command, &Still, &[]).unwrap();
        }
        assert_eq!(ALLOCATIONS.get() - before, 0);
        assert!((fish.center_of_mass() - start).length() > 0.1, "the fish is alive");
    }
}

/// All that a world's step lists (who is near, who is seen, what there is to eat) it lists in room that is there.
#[test]
fn a_step_of_a_fishes_world_allocates_nothing() {
    let tank = Tank::new([400.0, 400.0, 200.0]);
    let built = ALLOCATIONS.get();
    let kinds = [(Nature::Predator, 1), (Nature::Prey, 6), (Nature::Pacifist, 4)];
    let natures = kinds.into_iter().flat_map(|(nature, count)| std::iter::repeat_n(nature, count));
    let fishes: Vec<Inhabitant> = natures
        .zip(0..)
        .map(|(nature, id)| {
            let sex = if id % 2 == 0 { Sex::Male } else { Sex::Female };
            let habits = Habits::published(nature, sex);
            let place = DVec3::new(30.0 * f64::from(id) - 150.0, 40.0 * f64::from(id % 3), 0.0);
            let body = Arc::new(FishBody::published(habits.size));
            let mut fish = Inhabitant::new(FishId(id), habits, body, place, 0.0, 1, 0);
            fish.mind.drives.since_mating = 400.0;
            fish
        })
        .collect();
    let stuff = Stuff { respawn: Some(1.0), ..Stuff::default() };
    let food = |id| Particle::new(ParticleId(id), stuff, &tank, 1, 0, |_| true);
    let obstacles = vec![Obstacle::Sphere { center: [0.0, 120.0, 0.0], radius: 15.0 }];
    let (currents, climate) = (Currents::default(), Climate::default());
    let environment = Environment { tank, currents, climate, obstacles };
    let mut aquarium = Aquarium::new(environment, fishes, (0..40).map(food).collect());
    assert!(ALLOCATIONS.get() > built, "the allocator counts");
    let (mut intentions, mut events) = (BTreeSet::new(), 0);
    for _ in 0..3000 {
        let before = ALLOCATIONS.get();
        aquarium.step().unwrap();
        assert_eq!(ALLOCATIONS.get() - before, 0, "step {}", aquarium.steps);
        events += aquarium.events.len();
        intentions.extend(aquarium.fishes.iter().map(|fish| fish.mind.intention));
    }
    assert!(intentions.len() >= 5 && events > 20, "it is a busy world: {intentions:?}, {events} events");
}

/// The engine may allocate as it likes; what is ours of a step does not.
#[test]
fn an_esp_creatures_step_allocates_no_more_than_its_engine() {
    let skill = serde_json::json!({ "skill": [{ "id": "it", "fitness": { "kind": "locomotion" } }] });
    let syllabus = serde_json::from_value::<SyllabusTable>(skill).unwrap().check().unwrap();
    let seeker = sample::seeker();
    let body = seeker.body.develop().unwrap();
    let forced = [Forced { skill: SkillId(0), sigma: 1.0 }];
    let mut circuit = Circuit::new(&seeker.brain, &body.instances(), &syllabus, &forced);
    let mut creature = Creature::spawn(&body, Physics::default(), Start::Rest).unwrap();
    let lights = [Light { position: DVec3::new(3.0, 1.0, 0.3), strength: 0.3 }; 3];
    let built = ALLOCATIONS.get();
    drop(vec![0u8; 16]);
    assert!(ALLOCATIONS.get() > built, "the allocator counts");
    let (mut ours, mut bright) = (0, 0.0);
    for _ in 0..300 {
        let before = ALLOCATIONS.get();
        creature.feel(circuit.lengths_mut());
        creature.see(&lights, circuit.photos_mut());
        bright += circuit.photos_mut().iter().sum::<f64>();
        let activations = circuit.tick();
        ours += ALLOCATIONS.get() - before;
        creature.step(activations).unwrap();
    }
    assert!(bright > 1.0, "it sees");
    assert_eq!(ours, 0);
    // Slack, it lies still after a while: steps of the engine are then as good as those of ours that they make.
    let slack = vec![0.0; body.muscles.len()];
    (0..600).for_each(|_| creature.step(&slack).unwrap());
    let count = |run: &mut dyn FnMut()| {
        let before = ALLOCATIONS.get();
        run();
        ALLOCATIONS.get() - before
    };
    let engine =
        count(&mut || (0..100 * Physics::default().substeps).for_each(|_| creature.world_mut().step()));
    let whole = count(&mut || (0..100).for_each(|_| creature.step(&slack).unwrap()));
    // The engine's lists may grow once in a while; what allocates in each step would come to a hundred.
    assert!(whole.abs_diff(engine) < 10, "{whole} of ours, {engine} of the engine alone");
}

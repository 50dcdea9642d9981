//! Contact with the ground: depth at rest, sliding, the cone, tipping, landing.

use super::articulated::{Body, BodyId, Ground, ModelBuilder, Settings, World};
use super::bodies::{Creature, earth};
use super::gaits;
use glam::{DQuat, DVec3};

const DT: f64 = 1.0 / 240.0;
const GRAVITY: f64 = 9.81;

fn alone(settings: Settings, body: Body) -> (World, BodyId) {
    let mut model = ModelBuilder::new(settings);
    let id = model.root(body);
    (model.build().unwrap(), id)
}

fn steps(world: &mut World, count: u32) {
    for _ in 0..count {
        world.step(DT).unwrap();
    }
}

#[test]
fn a_box_comes_to_rest_at_the_depth_of_its_weight_and_stays() {
    let (mut world, id) = alone(earth(), Body::cuboid(DVec3::new(0.1, 0.1, 0.05), 200.0, DVec3::Z * 0.1));
    steps(&mut world, 240);
    let depth = 0.025 - world.position(id).z;
    let expected = world.mass(id) * GRAVITY / (4.0 * Ground::level(0.9).stiffness);
    assert!((depth - expected).abs() < 1e-9, "{depth} against {expected}");
    assert!(world.touches(id, 0.0) && world.kinetic_energy() < 1e-20);
    let place = world.position(id);
    steps(&mut world, 1800);
    assert!((world.position(id) - place).length() < 1e-9);
}

/// G-50: 0.2 to 1 mm from the lightest to the heaviest walker, on four to eight points.
#[test]
fn walkers_rest_between_a_fifth_of_a_millimetre_and_one() {
    for gait in gaits::ALL {
        let mut creature: Creature = (gait.body)(earth());
        creature.command_all(|| 0.0);
        steps(&mut creature.world, 480);
        let world = &creature.world;
        let touches = |tolerance: f64| creature.bodies.iter().any(|&id| world.touches(id, tolerance));
        assert!(touches(-0.0002) && !touches(-0.001), "{}", gait.name);
    }
}

#[test]
fn a_sliding_box_is_slowed_by_friction_times_gravity() {
    for (body_friction, coefficient) in [(0.3, 0.3), (2.0, 0.9)] {
        let settings = earth();
        let depth = 0.005 * 200.0 * 0.1 * 0.1 * GRAVITY / (4.0 * 1000.0);
        let size = DVec3::new(0.1, 0.1, 0.005);
        let body = Body { friction: body_friction, ..Body::cuboid(size, 200.0, DVec3::Z * (0.0025 - depth)) };
        let (mut world, id) = alone(settings, body);
        world.set_velocity(id, DVec3::new(1.2, 1.6, 0.0), DVec3::ZERO);
        steps(&mut world, 24);
        let slowed = (2.0 - world.velocity(id).length()) / 0.1;
        assert!((slowed / (coefficient * GRAVITY) - 1.0).abs() < 0.012, "{slowed}");
        let along = world.velocity(id).normalize();
        assert!((along - DVec3::new(0.6, 0.8, 0.0)).length() < 1e-3, "it slides straight: {along}");
    }
}

#[test]
fn a_box_on_a_slope_stays_below_the_friction_angle_and_slides_above() {
    for (slope, slides) in [(0.5_f64, false), (0.6, false), (1.0, true)] {
        let normal = DVec3::new(-slope, 0.0, 1.0).normalize();
        let ground = Ground { normal, ..Ground::level(0.7) };
        let up = DQuat::from_rotation_arc(DVec3::Z, normal);
        let settings = Settings { ground: Some(ground), ..earth() };
        let body = Body { orientation: up, ..Body::cuboid(DVec3::new(0.1, 0.1, 0.02), 200.0, normal * 0.01) };
        let (mut world, id) = alone(settings, body);
        steps(&mut world, 240);
        let (start, speed) = (world.position(id), world.velocity(id).length());
        steps(&mut world, 240);
        let way = (world.position(id) - start).length();
        if slides {
            // g (sin − μ cos) for one second from the speed it had.
            let pull = GRAVITY * (slope - 0.7) / (1.0 + slope * slope).sqrt();
            assert!((way - speed - 0.5 * pull).abs() < 0.03 * way, "{way}");
        } else {
            assert!(way < 2.1 * 0.002 * 240.0 * DT, "it creeps no faster than the slip speed: {way}");
        }
    }
}

#[test]
fn a_tall_box_that_is_pushed_at_its_top_tips_and_a_flat_one_slides() {
    for (height, tips) in [(0.4, true), (0.03, false)] {
        let size = DVec3::new(0.1, 0.1, height);
        let (mut world, id) = alone(earth(), Body::cuboid(size, 50.0, DVec3::Z * 0.5 * height));
        steps(&mut world, 60);
        for _ in 0..120 {
            // More than the friction of a sliding box, at the height of its top.
            let force = DVec3::X * (world.mass(id) * GRAVITY * 1.1);
            world.push(id, force, (DVec3::Z * 0.5 * height).cross(force));
            world.step(DT).unwrap();
        }
        let upright = (world.orientation(id) * DVec3::Z).z;
        assert_eq!(upright < 0.5, tips, "height {height}: {upright}");
    }
}

#[test]
fn a_fall_ends_without_a_bounce_whatever_the_step() {
    for hz in [120.0, 240.0, 480.0] {
        let (mut world, id) = alone(earth(), Body::cuboid(DVec3::splat(0.1), 150.0, DVec3::Z * 0.55));
        let mut rebound = 0.0_f64;
        let mut landed = false;
        for _ in 0..(2.0 * hz) as u32 {
            world.step(1.0 / hz).unwrap();
            landed |= world.touches(id, 0.0);
            if landed {
                rebound = rebound.max(world.velocity(id).z);
            }
        }
        assert!(landed);
        assert!(rebound < 0.25 * (2.0 * GRAVITY * 0.5).sqrt(), "at {hz} Hz it rebounds at {rebound} m/s");
    }
}

#[test]
fn a_point_that_would_enter_the_ground_within_the_step_is_met_on_the_way() {
    let (gap, fall) = (0.001, 3.0);
    let (mut world, id) = alone(earth(), Body::cuboid(DVec3::splat(0.1), 150.0, DVec3::Z * (0.05 + gap)));
    world.set_velocity(id, DVec3::Z * -fall, DVec3::ZERO);
    world.step(DT).unwrap();
    // The way to the surface is free; what goes beyond is shared with four points' γ = h (k h + c).
    let free = -(fall + GRAVITY * DT);
    let gain = DT * (1000.0 * DT + 12.0);
    let met = -gap / DT + (free + gap / DT) * world.mass(id) / (world.mass(id) + 4.0 * gain);
    assert!((world.velocity(id).z - met).abs() < 1e-12, "{} against {met}", world.velocity(id).z);
}

#[test]
fn a_capsule_lies_on_its_caps() {
    let lying = DQuat::from_rotation_arc(DVec3::Z, DVec3::X);
    let capsule = Body { orientation: lying, ..Body::capsule(0.02, 0.1, 200.0, DVec3::Z * 0.03) };
    let (mut world, id) = alone(earth(), capsule);
    steps(&mut world, 240);
    let depth = world.mass(id) * GRAVITY / (2.0 * 1000.0);
    assert!((world.position(id).z - (0.02 - depth)).abs() < 1e-9, "{}", world.position(id).z);
}

/// What the laws allow, whatever becomes of the search for their solution.
fn obeys_every_bound(creature: &Creature, place: &str) -> usize {
    let world = &creature.world;
    let mut sliding = 0;
    for contact in &world.contacts {
        let [x, y] = contact.shear;
        let share = (x * x + y * y).sqrt();
        let cone = world.bodies[contact.body].friction * contact.pressure;
        assert!(contact.pressure >= 0.0, "{place}: {contact:?} pulls");
        assert!(share <= cone * (1.0 + 1e-12), "{place}: {contact:?} leaves the cone {cone}");
        sliding += usize::from(share > 0.98 * cone);
    }
    for (link, id) in world.links.iter().zip(world.joints()) {
        for (dof, degree) in link.dofs().iter().enumerate().filter(|(_, degree)| degree.stops.is_none()) {
            let bound = degree.motor.effort * DT;
            assert!(world.impulse(id, dof).abs() <= bound * (1.0 + 1e-8), "{place}: {degree:?}");
        }
    }
    sliding
}

/// Every contact of every step of every walker: nothing pulls, and friction lies in Coulomb's cone.
#[test]
fn contacts_push_only_and_friction_stays_in_the_cone() {
    for gait in gaits::ALL {
        let mut creature: Creature = (gait.body)(earth());
        let (mut seen, mut sliding) = (0, 0);
        for step in 0..1800 {
            if step % 4 == 0 {
                (gait.commands)(&mut creature, f64::from(step) * DT);
            }
            creature.world.step(DT).unwrap();
            seen += creature.world.contacts.len();
            sliding += obeys_every_bound(&creature, &format!("{} at step {step}", gait.name));
        }
        assert!(seen > 1000 && sliding > 100, "{}: {seen} contacts, {sliding} sliding", gait.name);
    }
}

/// Flyer F-38: then clamp.
#[test]
fn a_step_that_runs_out_of_rounds_obeys_every_bound_all_the_same() {
    for gait in gaits::ALL {
        let mut creature: Creature = (gait.body)(earth());
        let mut clamped = 0;
        for step in 0..900 {
            if step % 4 == 0 {
                (gait.commands)(&mut creature, f64::from(step) * DT);
            }
            // One step out of rounds, from every state of a life that is not.
            let going = creature.world.clone();
            creature.world.rounds_max = 1;
            creature.world.step(DT).unwrap();
            clamped += u32::from(creature.world.rounds() == 2);
            obeys_every_bound(&creature, &format!("{} at step {step}", gait.name));
            creature.world = going;
            creature.world.step(DT).unwrap();
        }
        assert!(clamped > 20, "{}: only {clamped} steps were clamped", gait.name);
    }
}

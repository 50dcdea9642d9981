//! What no joint and no motor may change, and what only motors may raise.

use super::articulated::{BodyId, Motor, Settings};
use super::bodies::{self, Creature, space};
use super::gaits;
use crate::random::{Stream, stream};
use glam::DVec3;

const BODIES: [fn(Settings) -> Creature; 5] =
    [bodies::crawler, bodies::arm, bodies::hopper, bodies::runner, bodies::flyer];

fn vector(draws: &mut Stream, size: f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| draws.between(-size, size)))
}

/// Motors at random rates, redrawn now and then.
fn stir(creature: &mut Creature, draws: &mut Stream, effort: f64) {
    for id in creature.joints.clone() {
        for dof in 0..creature.world.degrees(id) {
            creature.world.drive(id, dof, Motor { rate: draws.between(-5.0, 5.0), effort });
        }
    }
}

#[test]
fn momentum_is_exact_in_free_flight_whatever_the_motors_do() {
    for (k, body) in BODIES.into_iter().enumerate() {
        let mut creature = body(space());
        let draws = &mut stream(1, [k as u32, 0, 0], "momentum");
        let (dt, effort, size) = if k == 4 { (0.05, 300.0, 1.0) } else { (1.0 / 240.0, 0.08, 0.3) };
        for &id in &creature.bodies.clone() {
            creature.world.set_velocity(id, vector(draws, size), vector(draws, size));
        }
        creature.world.step(dt).unwrap();
        let (linear, angular) = (creature.world.linear_momentum(), creature.world.angular_momentum());
        // The parts' momenta are larger than their sum, and rounding is by the parts.
        let center = creature.world.center_of_mass();
        let scale = creature.bodies.iter().fold((0.0, 0.0), |(p, l), &id| {
            let part = creature.world.mass(id) * creature.world.velocity(id).length();
            (p + part, l + part * (creature.world.position(id) - center).length())
        });
        for step in 0..1000 {
            if step % 20 == 0 {
                stir(&mut creature, draws, effort);
            }
            creature.world.step(dt).unwrap();
        }
        let (p, l) = (creature.world.linear_momentum(), creature.world.angular_momentum());
        assert!((p - linear).length() <= 1e-12 * scale.0, "body {k}: {linear} became {p}");
        assert!((l - angular).length() <= 1e-12 * scale.1, "body {k}: {angular} became {l}");
    }
}

/// Flyer T-11.
#[test]
fn every_creature_falls_alike_whatever_its_motors_do() {
    for body in BODIES {
        let mut creature = body(Settings { gravity: DVec3::NEG_Y * 9.81, ..space() });
        let start = creature.world.center_of_mass();
        for step in 0..20 {
            gaits::flap(&mut creature, f64::from(step) * 0.05);
            creature.world.step(0.05).unwrap();
        }
        let mass: f64 = creature.bodies.iter().map(|&id| creature.world.mass(id)).sum();
        assert!((start.y - creature.world.center_of_mass().y - 5.15025).abs() < 1e-9);
        assert!((creature.world.linear_momentum().y / mass + 9.81).abs() < 1e-9);
    }
}

/// A free body's spin moves about the constant angular momentum; the energy stays in first order, and the
/// spin within |L| over the least moment.
#[test]
fn a_tumbling_body_keeps_its_angular_momentum_and_nearly_its_energy() {
    let mut worst = vec![];
    for hz in [240.0, 480.0, 960.0] {
        let mut creature = bodies::Growth::new(
            space(),
            super::articulated::Body::cuboid(DVec3::new(0.1, 0.2, 0.3), 500.0, DVec3::ZERO),
        )
        .done();
        let root = creature.bodies[0];
        creature.world.set_velocity(root, DVec3::ZERO, DVec3::new(0.01, 6.0, 0.01));
        let (energy, momentum) = (creature.world.kinetic_energy(), creature.world.angular_momentum());
        let mut change = 0.0_f64;
        let mut flipped = false;
        for _ in 0..(4.0 * hz) as u32 {
            creature.world.step(1.0 / hz).unwrap();
            change = change.max((creature.world.kinetic_energy() / energy - 1.0).abs());
            flipped |= (creature.world.orientation(root) * DVec3::Y).dot(DVec3::Y) < 0.0;
        }
        assert!(flipped, "spin about the middle axis turns over");
        assert!((creature.world.angular_momentum() - momentum).length() < 1e-13 * momentum.length());
        worst.push(change);
    }
    assert!(worst[0] < 0.1 && worst[1] < 0.6 * worst[0] && worst[2] < 0.6 * worst[1], "{worst:?}");
}

#[test]
fn without_motors_a_creature_on_the_ground_loses_energy_until_it_lies_still() {
    for body in [bodies::crawler, bodies::arm, bodies::hopper, bodies::runner] {
        let mut creature = body(bodies::earth());
        let root: BodyId = creature.bodies[0];
        creature.world.set_velocity(root, DVec3::new(0.5, 0.3, 0.5), DVec3::new(3.0, -2.0, 1.0));
        creature.world.step(1.0 / 960.0).unwrap();
        let energy = |c: &Creature| c.world.kinetic_energy() + c.world.potential_energy();
        let start = energy(&creature);
        let mut last = start;
        for _ in 0..40 {
            for _ in 0..96 {
                creature.world.step(1.0 / 960.0).unwrap();
            }
            let now = energy(&creature);
            // The ground's springs give back what they hold, and the joints take back their drift.
            assert!(now <= last + 0.01 * start, "{last} rose to {now}, from {start}");
            last = now;
        }
        assert!(last < 0.7 * start, "{start} is still {last}");
        assert!(creature.world.kinetic_energy() < 1e-7, "{}", creature.world.kinetic_energy());
    }
}

#[test]
fn motors_that_want_rest_only_brake() {
    for body in BODIES {
        let mut creature = body(space());
        let draws = &mut stream(3, [0; 3], "brake");
        for &id in &creature.bodies.clone() {
            creature.world.set_velocity(id, vector(draws, 0.5), vector(draws, 2.0));
        }
        for id in creature.joints.clone() {
            for dof in 0..creature.world.degrees(id) {
                creature.world.drive(id, dof, Motor { rate: 0.0, effort: 0.01 });
            }
        }
        creature.world.step(1e-4).unwrap();
        let mut last = creature.world.kinetic_energy();
        for _ in 0..2000 {
            creature.world.step(1e-4).unwrap();
            let energy = creature.world.kinetic_energy();
            assert!(energy <= last * (1.0 + 1e-4), "{last} rose to {energy}");
            last = energy;
        }
    }
}

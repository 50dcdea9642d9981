//! Pendulums against their closed forms and a fine reference: the scheme is of first order, and converges.

use super::articulated::{Body, Joint, JointId, JointKind, ModelBuilder, Settings, World};
use crate::math::{cos, sin};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

const GRAVITY: f64 = 9.81;
const MASS: f64 = 0.3;
const MOMENT: f64 = 0.002;
/// From a rod's hinge to its centre and to the next hinge, m.
const CENTER: f64 = 0.25;
const LENGTH: f64 = 0.5;

/// A chain of rods that hang from a stand, each at an angle from the vertical.
fn chain(angles: &[f64]) -> (World, Vec<JointId>) {
    let settings = Settings { gravity: DVec3::NEG_Z * GRAVITY, erp: 0.2, ground: None };
    let mut model = ModelBuilder::new(settings);
    let stand = Body { shape: None, ..Body::cuboid(DVec3::splat(0.1), 1.0, DVec3::ZERO) };
    let mut parent = (model.fixture(stand), DVec3::ZERO);
    let mut hinge_at = DVec3::ZERO;
    let mut joints = vec![];
    for &angle in angles {
        // A rotation about x by the angle takes down, −z, to (0, sin, −cos).
        let orientation = DQuat::from_xyzw(sin(angle / 2.0), 0.0, 0.0, cos(angle / 2.0));
        let rod = Body {
            mass: MASS,
            inertia: DVec3::new(MOMENT, MOMENT, 1e-4),
            position: hinge_at + orientation * DVec3::NEG_Z * CENTER,
            orientation,
            shape: None,
            friction: 0.0,
        };
        let joint = Joint {
            kind: JointKind::Hinge { axis: DVec3::X },
            parent_anchor: parent.1,
            child_anchor: DVec3::Z * CENTER,
            stops: [None; 3],
        };
        let (id, joint) = model.attach(parent.0, rod, joint).unwrap();
        joints.push(joint);
        parent = (id, DVec3::NEG_Z * (LENGTH - CENTER));
        hinge_at += orientation * DVec3::NEG_Z * LENGTH;
    }
    (model.build().unwrap(), joints)
}

#[test]
fn a_pendulum_swings_with_the_period_of_the_closed_form() {
    let omega = (MASS * GRAVITY * CENTER / (MOMENT + MASS * CENTER * CENTER)).sqrt();
    let start = 0.02;
    let (mut world, joints) = chain(&[start]);
    let dt = 1e-4;
    let (mut crossings, mut last) = (vec![], start);
    for step in 0..200_000 {
        world.step(dt).unwrap();
        let angle = start + world.coordinate(joints[0], 0);
        if last > 0.0 && angle <= 0.0 {
            crossings.push((f64::from(step) + last / (last - angle)) * dt);
        }
        last = angle;
    }
    let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    // The closed form for a small amplitude a is T (1 + a²/16).
    let closed = TAU / omega * (1.0 + start * start / 16.0);
    assert!((period / closed - 1.0).abs() < 2e-5, "{period} against {closed}");
}

/// Accelerations of one or two rods on hinges from the textbook's equations.
fn accelerations(angles: [f64; 2], rates: [f64; 2], rods: usize) -> [f64; 2] {
    let [a, b] = angles;
    let own = MOMENT + MASS * CENTER * CENTER;
    let weight = -MASS * GRAVITY;
    if rods == 1 {
        return [weight * CENTER * sin(a) / own, 0.0];
    }
    let m11 = own + MASS * LENGTH * LENGTH;
    let m12 = MASS * LENGTH * CENTER * cos(a - b);
    let turn = MASS * LENGTH * CENTER * sin(a - b);
    let f1 = -turn * rates[1] * rates[1] + weight * (CENTER + LENGTH) * sin(a);
    let f2 = turn * rates[0] * rates[0] + weight * CENTER * sin(b);
    let determinant = m11 * own - m12 * m12;
    [(f1 * own - f2 * m12) / determinant, (m11 * f2 - m12 * f1) / determinant]
}

/// The angles after `seconds`, by the classical method of fourth order.
fn reference(start: [f64; 2], rods: usize, seconds: f64) -> [f64; 2] {
    let steps = 20_000;
    let h = seconds / f64::from(steps);
    let (mut q, mut u) = (start, [0.0; 2]);
    let along = |x: [f64; 2], d: [f64; 2], s: f64| [x[0] + d[0] * s, x[1] + d[1] * s];
    for _ in 0..steps {
        let (q1, u1) = (u, accelerations(q, u, rods));
        let (q2, u2) =
            (along(u, u1, h / 2.0), accelerations(along(q, q1, h / 2.0), along(u, u1, h / 2.0), rods));
        let (q3, u3) =
            (along(u, u2, h / 2.0), accelerations(along(q, q2, h / 2.0), along(u, u2, h / 2.0), rods));
        let (q4, u4) = (along(u, u3, h), accelerations(along(q, q3, h), along(u, u3, h), rods));
        for i in 0..2 {
            q[i] += h / 6.0 * (q1[i] + 2.0 * q2[i] + 2.0 * q3[i] + q4[i]);
            u[i] += h / 6.0 * (u1[i] + 2.0 * u2[i] + 2.0 * u3[i] + u4[i]);
        }
    }
    q
}

fn errors(start: [f64; 2], rods: usize, seconds: f64) -> Vec<f64> {
    let exact = reference(start, rods, seconds);
    [500.0, 1000.0, 2000.0, 4000.0]
        .into_iter()
        .map(|hz: f64| {
            let (mut world, joints) = chain(&start[..rods]);
            for _ in 0..(seconds * hz) as u32 {
                world.step(1.0 / hz).unwrap();
            }
            let mut sum = 0.0;
            let mut worst = 0.0_f64;
            for k in 0..rods {
                // A hinge turns against its parent, an angle is from the vertical.
                sum += world.coordinate(joints[k], 0);
                worst = worst.max((start[k] + sum - exact[k]).abs());
            }
            worst
        })
        .collect()
}

#[test]
fn a_wide_swing_converges_to_the_fine_reference_in_first_order() {
    let errors = errors([1.5, 0.0], 1, 2.0);
    assert!(errors[3] < 2e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((0.4..0.6).contains(&(pair[1] / pair[0])), "{errors:?}");
    }
}

#[test]
fn a_double_pendulum_converges_to_the_fine_reference_in_first_order() {
    let errors = errors([1.2, 0.4], 2, 2.0);
    assert!(errors[3] < 5e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((0.4..0.6).contains(&(pair[1] / pair[0])), "{errors:?}");
    }
}

#[test]
fn a_pendulums_energy_error_vanishes_with_the_step() {
    let mut worst = vec![];
    for hz in [240.0, 480.0, 960.0, 1920.0] {
        let (mut world, _) = chain(&[1.5]);
        let start = world.potential_energy();
        let mut change = 0.0_f64;
        for _ in 0..(5.0 * hz) as u32 {
            world.step(1.0 / hz).unwrap();
            change = change.max((world.kinetic_energy() + world.potential_energy() - start).abs());
        }
        worst.push(change);
    }
    for pair in worst.windows(2) {
        assert!(pair[1] < 0.6 * pair[0], "{worst:?}");
    }
}

#[test]
fn a_stand_does_not_move_and_its_joints_do_not_drift() {
    let (mut world, _) = chain(&[1.0, 0.5]);
    for _ in 0..1000 {
        world.step(1.0 / 240.0).unwrap();
    }
    let stand = world.bodies().next().unwrap();
    assert_eq!((world.position(stand), world.velocity(stand)), (DVec3::ZERO, DVec3::ZERO));
    assert!(world.separation() < 1e-3, "{}", world.separation());
}

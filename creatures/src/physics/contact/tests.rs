//! The face keeps what it says.

use super::*;
use glam::{DQuat, DVec3};

fn settings() -> Settings {
    Settings {
        step: 1.0 / 240.0,
        rounds: 2,
        sweeps: 6,
        gravity: 9.81,
        friction: 0.8,
        restitution: 0.1,
        rolling_resistance: 0.0,
        linear_damping: 0.0,
        angular_damping: 0.0,
        density: 1000.0,
    }
}

/// Far above the ground, without gravity.
fn afloat() -> World {
    World::new(Settings { gravity: 0.0, ..settings() })
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose { position: DVec3::new(x, y, z), rotation: DQuat::IDENTITY }
}

/// Mass and moments of inertia of a shape, summed over a fine grid of points, at unit density.
fn by_points(shape: Shape, holds: impl Fn(DVec3) -> bool) -> (f64, DVec3) {
    const CELLS: i32 = 120;
    let size = shape.radius() / f64::from(CELLS);
    let (mut volume, mut inertia) = (0.0, DVec3::ZERO);
    for x in -CELLS..CELLS {
        for y in -CELLS..CELLS {
            for z in -CELLS..CELLS {
                let point = size * (DVec3::new(x.into(), y.into(), z.into()) + 0.5);
                if holds(point) {
                    let square = point * point;
                    volume += 1.0;
                    inertia += DVec3::splat(square.element_sum()) - square;
                }
            }
        }
    }
    let cell = size * size * size;
    (volume * cell, inertia * cell)
}

/// E-2: what parts weigh, and how hard they are to turn.
#[test]
fn mass_and_inertia_are_those_of_the_solid() {
    let half = DVec3::new(0.1, 0.2, 0.3);
    let (r, l) = (0.1, 0.2);
    let check = |shape: Shape, holds: &dyn Fn(DVec3) -> bool| {
        let (volume, inertia) = by_points(shape, holds);
        assert!((shape.volume() / volume - 1.0).abs() < 2e-2, "{shape:?}: {volume}");
        assert!((shape.inertia() / inertia - 1.0).abs().max_element() < 3e-2, "{shape:?}: {inertia}");
    };
    check(Shape::Cuboid(half), &|p| p.abs().cmple(half).all());
    check(Shape::Ball(r), &|p| p.length() <= r);
    check(Shape::Capsule { radius: r, half_length: l }, &|p| (p - DVec3::X * p.x.clamp(-l, l)).length() <= r);
}

/// A push lasts one step, and gives what it says.
#[test]
fn a_push_lasts_one_step() {
    let mut world = afloat();
    let part = world.insert(Shape::Cuboid(DVec3::splat(0.1)), &at(0.0, 0.0, 1.0));
    world.push(part, DVec3::new(24.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 0.1));
    let expected = world.mobility(part, &world.pose(part), DVec3::Z * 0.1, DVec3::X) * 24.0 / 240.0;
    for _ in 0..100 {
        world.step();
        let twist = world.twist(part);
        assert!((twist.linear.x - 0.1 / 8.0).abs() < 1e-6, "{}", twist.linear);
        assert!(
            (twist.at(DVec3::Z * 0.1).x - expected).abs() < 1e-4,
            "{} {expected}",
            twist.at(DVec3::Z * 0.1)
        );
    }
}

/// A fall is one, and its energy stays.
#[test]
fn energy_is_conserved_in_free_fall() {
    let mut world = World::new(settings());
    let part = world.insert(Shape::Cuboid(DVec3::new(0.1, 0.2, 0.3)), &at(0.0, 0.0, 50.0));
    world.push(part, DVec3::new(3000.0, 1000.0, 500.0), DVec3::new(0.0, 0.1, 0.2));
    world.step();
    let before = world.energy();
    for _ in 0..240 {
        world.step();
    }
    let fallen = 50.0 - world.pose(part).position.z;
    let turning = 0.5 * world.mass(part) * world.twist(part).angular.length_squared() * 0.01;
    assert!(turning > 1.0 && fallen > 4.0);
    assert!((world.energy() / before - 1.0).abs() < 2e-3, "{} is not {before}", world.energy());
}

/// E-22: what lies there presses with its weight, and stays where it lies.
#[test]
fn the_ground_carries_what_lies_on_it() {
    for shape in [
        Shape::Cuboid(DVec3::new(0.1, 0.1, 0.1)),
        Shape::Ball(0.2),
        Shape::Capsule { radius: 0.1, half_length: 0.2 },
    ] {
        let mut world = World::new(settings());
        let height = shape.reach(DVec3::Z);
        let part = world.insert(shape, &at(0.0, 0.0, height));
        for _ in 0..480 {
            world.step();
        }
        let weight = world.mass(part) * 9.81;
        assert!((world.ground_force() / weight - 1.0).abs() < 0.01, "{shape:?}: {}", world.ground_force());
        let sunk = height - world.pose(part).position.z;
        assert!(sunk.abs() < 1e-3, "{shape:?} is {sunk} m deep");
        assert!(world.twist(part).linear.length() < 1e-3);
    }
}

/// E-22: a ball that rolls at v stops after 7 v² / (10 μ g), as its two equations of motion have it; without the
/// resistance it goes on, and what has edges is left alone.
#[test]
fn what_rolls_comes_to_rest() {
    let way = |shape: Shape, rolling_resistance: f64| {
        let mut world = World::new(Settings { rolling_resistance, ..settings() });
        let ball = world.insert(shape, &at(0.0, 0.0, 0.2));
        let inertia = world.mass(ball) * 0.4 * 0.2 * 0.2;
        world.push(ball, DVec3::X * world.mass(ball) * 240.0, DVec3::ZERO);
        world.push(ball, DVec3::Z * inertia * 5.0 * 240.0 / 0.1, DVec3::X * -0.1); // 5 rad/s about y
        world.push(ball, DVec3::Z * inertia * -5.0 * 240.0 / 0.1, DVec3::ZERO);
        for _ in 0..1200 {
            world.step();
        }
        (world.pose(ball).position.x, world.twist(ball).linear.length())
    };
    let (stopped, left) = way(Shape::Ball(0.2), 0.05);
    assert!((stopped / (0.7 / (0.05 * 9.81)) - 1.0).abs() < 0.02, "{stopped} m");
    assert!(left < 1e-3, "{left} m/s");
    let (rolled, left) = way(Shape::Ball(0.2), 0.0);
    assert!((rolled / 5.0 - 1.0).abs() < 0.02 && left > 0.95, "{rolled} m, {left} m/s");
    assert_eq!(way(Shape::Cuboid(DVec3::splat(0.2)), 0.05), way(Shape::Cuboid(DVec3::splat(0.2)), 0.0));
}

/// E-4: each kind of joint holds what it locks and leaves what it frees, whichever way its axis points.
#[test]
fn joints_lock_all_but_their_free_axes() {
    let third = (1.0f64 / 3.0).sqrt();
    for axis in [DVec3::Z, -DVec3::X, DVec3::splat(third), DVec3::X] {
        for (kind, slides, turns, tilts) in [
            (JointKind::Fixed, false, false, false),
            (JointKind::Revolute, false, true, false),
            (JointKind::Spherical, false, true, true),
            (JointKind::Prismatic(0.1), true, false, false),
            (JointKind::Cylindrical(0.1), true, true, false),
        ] {
            let mut world = afloat();
            let way = axis.any_orthonormal_vector();
            let parent = world.insert(Shape::Ball(0.1), &at(0.0, 0.0, 5.0));
            let child =
                Pose { position: DVec3::Z * 5.0 + 0.5 * way, rotation: DQuat::from_xyzw(0.6, 0.0, 0.8, 0.0) };
            let child = world.insert(Shape::Ball(0.1), &child);
            let back = world.pose(child).rotation.inverse() * (-0.25 * way);
            world.join(parent, child, Joint { kind, parent_anchor: 0.25 * way, child_anchor: back, axis });
            let (mut slid, mut turned, mut tilted) = (0.0f64, 0.0f64, 0.0f64);
            for _ in 0..240 {
                let bend = axis.cross(way);
                // Along the axis, and round about every one.
                world.push(child, 4.0 * axis, DVec3::ZERO);
                world.push(parent, -4.0 * axis, DVec3::ZERO);
                for torque in [axis, bend] {
                    let lever = torque.any_orthonormal_vector();
                    world.push(child, 0.05 * torque.cross(lever), lever);
                    world.push(child, -0.05 * torque.cross(lever), DVec3::ZERO);
                }
                world.step();
                let (p, c) = (world.pose(parent), world.pose(child));
                slid = slid.max((c.point(back) - p.point(0.25 * way)).dot(p.rotation * axis).abs());
                let turn =
                    (p.rotation.inverse() * c.rotation) * DQuat::from_xyzw(0.6, 0.0, 0.8, 0.0).inverse();
                let turn = 2.0 * DVec3::new(turn.x, turn.y, turn.z);
                turned = turned.max(turn.dot(axis).abs());
                tilted = tilted.max((turn - turn.dot(axis) * axis).length());
            }
            let seen = [slid > 0.05, turned > 0.1, tilted > 0.1];
            assert_eq!(seen, [slides, turns, tilts], "{kind:?} {axis}: {slid} {turned} {tilted}");
            assert!(slid < 0.11, "the stop holds: {slid}");
            assert!(world.separation() < 5e-3, "{kind:?}: {}", world.separation());
        }
    }
}

/// T-9: a gap between flat faces is the only limit of an angle.
#[test]
fn neighbours_stop_each_other_where_the_gap_closes() {
    for (gap, degrees) in [(0.05, 53.13), (0.02, 22.62), (0.1, 90.0)] {
        let mut world = afloat();
        let half = DVec3::new(0.1, 0.1, 0.1);
        let parent = world.insert(Shape::Cuboid(half), &at(0.0, 0.0, 5.0));
        let child = world.insert(Shape::Cuboid(half), &at(0.2 + 2.0 * gap, 0.0, 5.0));
        let anchor = (0.1 + gap) * DVec3::X;
        let joint =
            Joint { kind: JointKind::Revolute, parent_anchor: anchor, child_anchor: -anchor, axis: DVec3::Z };
        world.join(parent, child, joint);
        let mut angle = 0.0;
        for _ in 0..960 {
            let push = DVec3::new(0.0, 4.0, 0.0);
            for (part, side) in [(parent, -1.0), (child, 1.0)] {
                let tip = world.pose(part).rotation * (side * 0.1 * DVec3::X);
                world.push(part, world.pose(part).rotation * push, tip);
            }
            world.step();
            let turn = world.pose(parent).rotation.inverse() * world.pose(child).rotation;
            angle = 2.0 * crate::math::atan2(turn.z, turn.w).to_degrees();
        }
        assert!((angle.abs() - degrees).abs() < 2.0, "gap {gap}: {angle}°");
    }
}

/// E-78: a disc is felt and pushes nothing.
#[test]
fn a_disc_is_felt_and_pushes_nothing() {
    let fall = |disc: bool| {
        let mut world = World::new(settings());
        let part = world.insert(Shape::Ball(0.1), &at(0.3, 0.0, 0.5));
        if disc {
            world.place_disc(DVec3::new(0.0, 0.0, 0.25), 0.25, 0.1);
        }
        let mut touched = Vec::new();
        for _ in 0..240 {
            world.step();
            touched.push(world.touches_disc());
        }
        (world.pose(part), touched)
    };
    let ((free, untouched), (through, touched)) = (fall(false), fall(true));
    assert_eq!(free, through, "to the bit");
    assert!(!untouched.contains(&true));
    let first = touched.iter().position(|&touches| touches).expect("it falls through the disc");
    // 0.05 m beside the rim, it meets its upper edge from 0.0866 m above: after a fall of 0.1134 m, 36 steps.
    assert!((36..=38).contains(&first), "{first}");
    assert!(!touched[239], "and leaves it again");
}

/// EF-10
#[test]
fn a_part_that_is_nowhere_is_noticed() {
    let mut world = World::new(settings());
    let part = world.insert(Shape::Ball(0.1), &at(0.0, 0.0, 1.0));
    world.step();
    assert!(world.is_finite());
    world.push(part, DVec3::splat(f64::NAN), DVec3::ZERO);
    world.step();
    assert!(!world.is_finite());
}

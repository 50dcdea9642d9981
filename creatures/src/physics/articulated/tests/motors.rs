//! Motors and stops, one at a time, against the specifications' figures.

use super::articulated::{Body, Joint, JointKind, ModelBuilder, Motor, Settings, StepFault, StopRule, World};
use super::bodies::{self, HINGE_EFFORT, SLIDER_EFFORT, space};
use glam::{DQuat, DVec3};

const DT: f64 = 1.0 / 240.0;

fn weighty() -> Settings {
    Settings { gravity: DVec3::new(0.0, 0.0, -9.81), ..space() }
}

/// One box on a parent that never moves.
fn on_a_stand(settings: Settings, size: DVec3, density: f64, joint: Joint) -> World {
    let mut model = ModelBuilder::new(settings);
    let stand = model.fixture(Body::cuboid(DVec3::splat(0.1), 1000.0, DVec3::ZERO));
    let child = Body::cuboid(size, density, joint.parent_anchor - joint.child_anchor);
    model.attach(stand, child, joint).unwrap();
    model.build().unwrap()
}

fn crawler_arm(settings: Settings) -> World {
    let hinge = JointKind::Hinge { axis: DVec3::X };
    let shoulder = bodies::joint(hinge, DVec3::new(0.045, -0.10, 0.0), DVec3::new(0.0, 0.075, 0.0), None);
    on_a_stand(settings, DVec3::new(0.02, 0.15, 0.02), 300.0, shoulder)
}

fn shoulder(world: &World) -> super::articulated::JointId {
    world.joints().next().unwrap()
}

/// Walker T-10.
#[test]
fn a_hinge_motor_gives_all_its_effort_until_its_rate_is_reached() {
    let mut world = crawler_arm(space());
    let joint = shoulder(&world);
    world.drive(joint, 0, Motor { rate: 10.0, effort: HINGE_EFFORT });
    world.step(DT).unwrap();
    let first = world.rate(joint, 0);
    world.step(DT).unwrap();
    let second = world.rate(joint, 0);
    assert!((second - first - 2.4107).abs() < 0.01 * 2.4107, "rose by {}", second - first);
    assert!((world.impulse(joint, 0) - HINGE_EFFORT * DT).abs() < 1e-15);
    for _ in 0..60 {
        world.step(DT).unwrap();
    }
    assert!((world.rate(joint, 0) - 10.0).abs() < 1e-9, "ends at {}", world.rate(joint, 0));
    assert!(world.impulse(joint, 0).abs() < 0.01 * HINGE_EFFORT * DT, "at its rate it has nothing to do");
}

/// Walker T-10.
#[test]
fn a_slider_extends_at_its_motors_force_and_ends_on_its_stop() {
    for rule in [StopRule::Anticipated, StopRule::Reached] {
        let mut model = ModelBuilder::new(space());
        let stand = model.fixture(Body::cuboid(DVec3::splat(0.1), 1000.0, DVec3::ZERO));
        let kind = JointKind::Slider { axis: DVec3::NEG_Z };
        let leg = bodies::joint(kind, DVec3::new(0.0, 0.0, -0.04), DVec3::ZERO, Some((0.0, 0.08)));
        let foot = Body::cuboid(DVec3::new(0.024, 0.06, 0.08), 3000.0, leg.parent_anchor);
        let (_, joint) = model.attach(stand, foot, leg).unwrap();
        let mut world = model.stop_rule(rule).build().unwrap();
        world.drive(joint, 0, Motor { rate: 1.0, effort: SLIDER_EFFORT });
        world.step(DT).unwrap();
        assert!((world.rate(joint, 0) - 0.1419).abs() < 5e-5, "{}", world.rate(joint, 0));
        let mut furthest = 0.0_f64;
        for _ in 0..240 {
            world.step(DT).unwrap();
            furthest = furthest.max(world.coordinate(joint, 0));
        }
        assert!((world.coordinate(joint, 0) - 0.08).abs() < 1e-9, "{}", world.coordinate(joint, 0));
        match rule {
            StopRule::Anticipated => assert!(furthest <= 0.08 + 1e-12, "passed its stop: {furthest}"),
            StopRule::Reached => assert!(furthest > 0.0801, "should pass by one step's motion: {furthest}"),
        }
    }
}

/// Walker T-11.
#[test]
fn a_motor_at_rate_zero_holds_against_gravity() {
    let mut world = crawler_arm(weighty());
    let joint = shoulder(&world);
    world.drive(joint, 0, Motor { rate: 0.0, effort: HINGE_EFFORT });
    for _ in 0..240 {
        world.step(DT).unwrap();
        assert!(world.rate(joint, 0).abs() <= 1e-9);
    }
    assert!(world.coordinate(joint, 0).abs() <= 1e-9, "sagged by {}", world.coordinate(joint, 0));
    let weight = 0.018 * 9.81 * 0.075 * DT;
    assert!((world.impulse(joint, 0).abs() - weight).abs() < 1e-9, "holds the arm's weight and no more");
}

/// Two free cylinders on a hinge (flyer T-12).
fn two_cylinders(effort: f64) -> (World, super::articulated::JointId) {
    let mut model = ModelBuilder::new(space());
    let parent = model.root(Body::capsule(0.5, 20.0, 0.01, DVec3::ZERO));
    let along_x = DQuat::from_rotation_arc(DVec3::Z, DVec3::X);
    let child = Body { orientation: along_x, ..Body::capsule(0.5, 40.0, 0.01, DVec3::new(20.0, 0.0, 10.0)) };
    let hinge = JointKind::Hinge { axis: DVec3::Z };
    let joint = bodies::joint(hinge, DVec3::new(0.0, 0.0, 10.0), DVec3::new(0.0, 0.0, -20.0), None);
    let (_, joint) = model.attach(parent, child, joint).unwrap();
    let mut world = model.build().unwrap();
    world.drive(joint, 0, Motor { rate: 2.0, effort });
    (world, joint)
}

/// Flyer T-12.
#[test]
fn a_flyers_hinge_motor_reaches_its_rate_in_one_step_if_its_torque_allows() {
    let effort = 385.368699;
    let (mut world, joint) = two_cylinders(effort);
    world.step(0.05).unwrap();
    assert!((world.rate(joint, 0) - 2.0).abs() < 1e-8);
    assert!((world.impulse(joint, 0) - 0.0403034).abs() < 1e-7, "{}", world.impulse(joint, 0));
    for (share, rate) in [(1e-3, 0.956170), (1e-4, 0.0956170)] {
        let (mut world, joint) = two_cylinders(effort * share);
        world.step(0.05).unwrap();
        assert!((world.rate(joint, 0) / rate - 1.0).abs() < 1e-6, "{}", world.rate(joint, 0));
    }
}

/// Flyer T-12: the torque limit by F-32, from the masses that F-19 gives.
#[test]
fn capsules_have_the_masses_of_the_flyers_table() {
    let mass = |radius, length| Body::capsule(radius, length, 0.01, DVec3::ZERO).mass;
    let effort = |pair: [(f64, f64); 2]| {
        let [(r1, l1), (r2, l2)] = pair;
        (mass(r1, l1) + mass(r2, l2)) * l1 * l2
    };
    assert!((effort([(0.5, 20.0), (0.5, 40.0)]) - 385.368699).abs() < 1e-6);
    assert!((effort([(0.5, 40.0), (0.5, 25.0)]) - 520.980782).abs() < 1e-6);
    assert!((effort([(2.0, 30.0), (0.5, 20.0)]) - 2560.398013).abs() < 1e-6);
    let capsule = Body::capsule(0.5, 20.0, 0.01, DVec3::ZERO);
    assert!((capsule.mass - 0.162316).abs() < 5e-7);
    assert!((capsule.inertia - DVec3::new(5.789563, 5.789563, 0.020159)).abs().max_element() < 5e-7);
}

/// A joint of the runner's: three motors about the parent's axes (G-18).
#[test]
fn each_axis_of_a_ball_has_its_own_motor() {
    for dof in 0..3 {
        let ball = bodies::joint(JointKind::Ball, DVec3::X * 0.04, DVec3::X * -0.11, None);
        let mut world = on_a_stand(space(), DVec3::new(0.22, 0.02, 0.02), 200.0, ball);
        let joint = shoulder(&world);
        for other in 0..3 {
            let rate = if other == dof { 3.0 } else { 0.0 };
            world.drive(joint, other, Motor { rate, effort: 10.0 });
        }
        for _ in 0..24 {
            world.step(DT).unwrap();
        }
        for other in 0..3 {
            let angle = if other == dof { 0.3 } else { 0.0 };
            assert!((world.coordinate(joint, other) - angle).abs() < 1e-9, "axis {dof}, about {other}");
            assert!((world.rate(joint, other) - angle * 10.0).abs() < 1e-9);
        }
    }
}

#[test]
fn a_stop_is_one_sided_and_never_pulls() {
    let hinge = JointKind::Hinge { axis: DVec3::X };
    let stopped = bodies::joint(hinge, DVec3::ZERO, DVec3::Y * 0.1, Some((-0.2, 0.3)));
    let mut world = on_a_stand(weighty(), DVec3::new(0.02, 0.2, 0.02), 300.0, stopped);
    let joint = shoulder(&world);
    for _ in 0..480 {
        world.step(DT).unwrap();
        assert!(world.impulse(joint, 0) <= 0.0, "the arm falls onto its high stop, which only pushes back");
        assert!(world.coordinate(joint, 0) <= 0.3 + 1e-9);
    }
    assert!((world.coordinate(joint, 0) - 0.3).abs() < 1e-9);
    world.drive(joint, 0, Motor { rate: -1.0, effort: 1.0 });
    for _ in 0..24 {
        world.step(DT).unwrap();
    }
    assert!((world.coordinate(joint, 0) - 0.2).abs() < 1e-6, "and lets go at once");
}

#[test]
fn a_fixed_joint_carries_its_child_along() {
    let fixed = bodies::joint(JointKind::Fixed, DVec3::X * 0.1, DVec3::X * -0.1, None);
    let mut model = ModelBuilder::new(space());
    let root = model.root(Body::cuboid(DVec3::splat(0.2), 100.0, DVec3::ZERO));
    let child = Body::cuboid(DVec3::splat(0.2), 100.0, DVec3::X * 0.2);
    let (child, joint) = model.attach(root, child, fixed).unwrap();
    let mut world = model.build().unwrap();
    assert_eq!(world.degrees(joint), 0);
    for _ in 0..240 {
        world.push(root, DVec3::Y, DVec3::new(0.3, 0.0, 0.2));
        world.step(DT).unwrap();
    }
    let relative = world.orientation(root).inverse() * world.orientation(child);
    assert!(relative.xyz().length() < 1e-3, "{relative}");
    assert!(world.separation() < 1e-3, "{}", world.separation());
}

/// Flyer F-39, walker X-11.
#[test]
fn what_is_not_finite_is_a_fault_and_not_a_pose() {
    let mut world = crawler_arm(weighty());
    let joint = shoulder(&world);
    assert_eq!(world.step(0.0), Err(StepFault::Duration));
    assert_eq!(world.step(f64::NAN), Err(StepFault::Duration));
    world.drive(joint, 0, Motor { rate: f64::NAN, effort: 1.0 });
    let fault = world.step(DT).unwrap_err();
    assert_eq!(fault, StepFault::NonFinite { body: 1 });
    assert!(world.position(world.bodies().nth(1).unwrap()).is_finite());
}

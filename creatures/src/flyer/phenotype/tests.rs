//! Mass (T-1, T-2), hinges and stops (T-3, F-33), air on a free body (T-10), momentum (T-11), symmetry and
//! anchors (T-22), on whole creatures.

use super::*;
use crate::flyer::skeleton::grow;
use crate::flyer::skeleton::tests::{creature, wing, worked_example};
use crate::flyer::{Brain, Function, Genotype};
use crate::random::{Stream, stream};

fn vacuum() -> FlyerTask {
    FlyerTask { alpha: 0.0, ..FlyerTask::default() }
}

fn developed(genotype: &Genotype, task: &FlyerTask) -> Phenotype {
    Phenotype::develop(&grow(genotype, task.start_height), task)
}

fn founder(place: u32) -> Genotype {
    Genotype::random(&crate::flyer::Settings::default(), &mut stream(1, [0, 0, place], "phenotype test"))
}

/// One step under the given effectors.
fn step(phenotype: &mut Phenotype, effectors: &[f64]) -> Result<(), StepFault> {
    let mut readings = vec![0.0; 8 + 2 * (phenotype.joints.len() - 1)];
    phenotype.sense(&mut readings);
    phenotype.drive(effectors);
    phenotype.step()
}

fn draw_effectors(phenotype: &Phenotype, draws: &mut Stream) -> Vec<f64> {
    phenotype.actuators.iter().map(|_| draws.between(-1.0, 1.0)).collect()
}

/// T-1, T-2
#[test]
fn bones_weigh_what_their_size_says() {
    for (radius, length, mass, across, along) in [
        (0.5, 20.0, 0.162316, 5.789563, 0.020159),
        (0.5, 40.0, 0.319395, 44.041726, 0.039794),
        (2.0, 30.0, 4.105014, 369.987461, 8.075988),
    ] {
        let body = Body::capsule(radius, length, FlyerTask::default().density, DVec3::ZERO);
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found}");
        close(body.mass, mass);
        close(body.inertia.x, across);
        close(body.inertia.y, across);
        close(body.inertia.z, along);
    }
    let heaviest = Body::capsule(5.0, 80.0, FlyerTask::default().density, DVec3::ZERO);
    assert!((heaviest.mass - 68.067841).abs() < 1e-6);
    assert!((developed(&worked_example(), &vacuum()).mass() - 5.309292).abs() < 1e-6);
}

#[test]
fn the_world_starts_in_the_skeletons_pose() {
    for place in 0..20 {
        let genotype = founder(place);
        let bones = grow(&genotype, 250.0);
        let phenotype = Phenotype::develop(&bones, &vacuum());
        for (limb, bone) in phenotype.limbs.iter().zip(&bones) {
            assert_eq!(phenotype.world.position(limb.body), bone.centre);
            let axes = phenotype.world.rotation(limb.body);
            assert!((axes.z_axis - bone.axes.z_axis).length() < 1e-12);
            assert!((axes.x_axis - bone.axes.x_axis).length() < 1e-12);
        }
        assert!(phenotype.world.separation() < 1e-9);
    }
}

/// T-3, F-16: driven by the same effector, both first hinges turn by the same q, and the pose is that of an
/// azimuth of θ + q.
#[test]
fn equal_effectors_raise_both_wings_to_the_pose_of_the_worked_example() {
    let task = FlyerTask { dt: 1e-3, gravity: 0.0, motor_k: 1e4, ..vacuum() };
    let mut phenotype = developed(&worked_example(), &task);
    let goal = 10f64.to_radians();
    // x, y, z; left 1, left 2; right 1, right 2.
    for _ in 0..1000 {
        let rate = (goal - phenotype.world.coordinate(phenotype.joints[1], 0)) * 10.0;
        step(&mut phenotype, &[0.0, 0.0, 0.0, rate, 0.0, rate, 0.0]).unwrap();
    }
    for (joint, angle) in [(1, goal), (2, 0.0), (3, goal), (4, 0.0)] {
        let found = phenotype.world.coordinate(phenotype.joints[joint], 0);
        assert!((found - angle).abs() < 1e-4, "joint {joint} is at {found}");
    }
    let mut turned = worked_example();
    turned.nodes[2].theta += goal;
    let bones = grow(&turned, 0.0);
    let from_root = |k: usize| bones[1].axes.transpose() * (bones[k].centre - bones[1].centre);
    for k in 2..6 {
        let (world, limbs) = (&phenotype.world, &phenotype.limbs);
        let apart = world.position(limbs[k].body) - world.position(limbs[1].body);
        let found = world.rotation(limbs[1].body).transpose() * apart;
        assert!((found - from_root(k)).length() < 1e-2, "limb {k}: {found} is not {}", from_root(k));
    }
}

/// F-18, F-33: under full effort for ever a joint comes to its stop, and stays there.
#[test]
fn joints_stop_at_their_stops() {
    let task = FlyerTask { gravity: 0.0, ..vacuum() };
    for sign in [1.0, -1.0] {
        let mut phenotype = developed(&worked_example(), &task);
        let effectors = vec![sign; phenotype.actuators.len()];
        for _ in 0..60 {
            step(&mut phenotype, &effectors).unwrap();
        }
        let mut readings = vec![0.0; 16];
        phenotype.sense(&mut readings);
        let angles: Vec<f64> = readings[..3].iter().chain(readings[8..].iter().step_by(2)).copied().collect();
        assert!(angles.iter().all(|angle| (angle - sign).abs() < 0.02), "{angles:?}");
        assert!(readings[3..6].iter().chain(readings[9..].iter().step_by(2)).all(|&stop| stop == -1.0));
    }
}

/// F-18, F-31: read off the motors, since sensors tell angles as shares of whatever the stops are.
#[test]
fn ball_and_hinges_have_stops_and_rates_of_their_own() {
    let task = FlyerTask::default();
    let phenotype = developed(&worked_example(), &task);
    let (ball, hinges) = phenotype.actuators.split_at(3);
    assert!(ball.iter().all(|axis| (axis.stop, axis.rate) == (task.ball_limit, task.ball_rate)));
    assert!(hinges.iter().all(|hinge| (hinge.stop, hinge.rate) == (task.hinge_limit, task.hinge_rate)));
}

/// F-70
#[test]
fn the_flap_is_that_of_the_first_left_hinge() {
    let mut phenotype = developed(&worked_example(), &FlyerTask { gravity: 0.0, ..vacuum() });
    for _ in 0..2 {
        step(&mut phenotype, &[0.0, 0.0, 0.0, 1.0, -0.5, -1.0, 0.5]).unwrap();
    }
    assert!((phenotype.flap() - 0.1).abs() < 1e-6, "one step at 2 rad/s, not {}", phenotype.flap());
}

/// F-33
#[test]
fn a_motor_asks_for_no_more_than_brings_it_to_its_stop() {
    let stop = 1.0;
    let phenotype = developed(&worked_example(), &vacuum());
    let actuator = Actuator { stop, ..phenotype.actuators[3] };
    let cases = [
        (2.0, 0.0, 2.0),
        (2.0, 0.95, 1.0),
        (-2.0, 0.95, -2.0),
        (-2.0, -0.99, -0.2),
        (2.0, 1.01, 0.0),
        (-2.0, 1.01, -2.0),
        (-2.0, -1.01, 0.0),
        (2.0, -1.01, 2.0),
    ];
    for (rate, angle, expected) in cases {
        let found = actuator.wanted(rate, angle, 0.05);
        assert!((found - expected).abs() < 1e-9, "{rate} at {angle} gives {found}, not {expected}");
    }
}

/// F-32, T-12
#[test]
fn motors_have_the_torque_of_the_effective_lengths() {
    let genotype = creature((30.0, 2.0), 70.0, &[wing(40.0, 1, 30.0, 60.0)]);
    let phenotype = developed(&genotype, &vacuum());
    let mass = |radius, length| Body::capsule(radius, length, 0.01, DVec3::ZERO).mass;
    let root = (mass(2.0, 30.0) + mass(0.5, 30.0)) * 30.0 * 30.0;
    let hinge = (mass(0.5, 30.0) + mass(0.5, 40.0)) * 30.0 * 40.0;
    let torques: Vec<f64> = phenotype.actuators.iter().map(|actuator| actuator.torque).collect();
    for (found, expected) in torques.into_iter().zip([root, root, root, hinge, hinge]) {
        assert!((found - expected).abs() < 1e-9 * expected, "{found} is not {expected}");
    }
}

/// F-47: tail feathers are the body's alone.
#[test]
fn the_body_alone_has_tail_feathers() {
    let task = FlyerTask::default();
    let phenotype = developed(&worked_example(), &task);
    for (k, limb) in phenotype.limbs.iter().enumerate() {
        let bare = Hull::new(Air::scaled(task.alpha), limb.radius, 2.0 * limb.half_length);
        assert_eq!(limb.hull, if k == BODY { bare.with_tail(1.75) } else { bare }, "limb {k}");
    }
}

/// F-50: it is the lowest end of a cylinder, less its radius, that touches.
#[test]
fn a_creature_lands_on_its_lowest_cap() {
    let landed = |genotype: &Genotype, start_height| {
        developed(genotype, &FlyerTask { start_height, ..vacuum() }).survey().landed
    };
    let raised = creature((30.0, 2.0), 20.0, &[wing(40.0, 1, 10.0, 60.0)]);
    assert!(landed(&raised, 1.99) && !landed(&raised, 2.01), "on its body");
    let lowered = creature((30.0, 2.0), 20.0, &[wing(40.0, 1, -30.0, 60.0)]);
    let depth = -grow(&lowered, 0.0)[2].end().y;
    assert!((depth - 17.3205).abs() < 1e-4);
    assert!(landed(&lowered, depth + 0.49) && !landed(&lowered, depth + 0.51), "on its wing-tips");
}

/// F-37: a limp wing passes its stop by no more than one step's motion, and is taken back.
#[test]
fn a_stop_acts_from_the_step_that_begins_beyond_it() {
    let task = FlyerTask { gravity: 0.0, motor_k: 0.0, ..vacuum() };
    let genotype = creature((30.0, 2.0), 20.0, &[wing(40.0, 1, 10.0, 60.0)]);
    let mut phenotype = developed(&genotype, &task);
    let (joint, anchor) = (phenotype.joints[1], DVec3::new(0.0, 250.0, 5.0));
    let (wing, spin) = (phenotype.limbs[2].body, DVec3::Z * 1.7);
    let arm = phenotype.world.position(wing) - anchor;
    phenotype.world.set_velocity(wing, spin.cross(arm), spin);
    let (mut highest, mut fastest, mut last) = (0.0f64, 0.0f64, 0.0);
    for _ in 0..60 {
        phenotype.step().unwrap();
        let angle = phenotype.world.coordinate(joint, 0);
        fastest = fastest.max(angle - last);
        highest = highest.max(angle);
        last = angle;
    }
    let beyond = highest - task.hinge_limit;
    assert!(beyond > 1e-3 && beyond < fastest, "{beyond} rad beyond, {fastest} rad a step");
    assert!(last < highest - 1e-3, "it is taken back");
}

/// T-10
#[test]
fn a_free_cylinder_stops_turning_as_the_scheme_says() {
    let task = FlyerTask { gravity: 0.0, ..FlyerTask::default() };
    let mut model = ModelBuilder::new(Settings { gravity: DVec3::ZERO, erp: task.erp, ground: None });
    let body = model.root(Body { shape: None, ..Body::capsule(0.5, 40.0, task.density, DVec3::ZERO) });
    let mut world = model.build().unwrap();
    world.set_velocity(body, DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0));
    let hull = Hull::new(Air::scaled(task.alpha), 0.5, 40.0);
    let mut spins = vec![];
    for _ in 0..20 {
        let axes = world.rotation(body);
        let drag = hull.drag(DVec3::ZERO, axes.transpose() * world.spin(body));
        world.push(body, DVec3::ZERO, axes * drag.torque);
        world.step(task.dt).unwrap();
        spins.push(world.spin(body).x);
    }
    assert!((spins[0] - 0.4699245).abs() < 1e-7, "{}", spins[0]);
    assert!((spins[19] - 0.2219318).abs() < 1e-7, "{}", spins[19]);
}

/// T-11: whatever the motors do, they move no centre of mass.
#[test]
fn in_a_vacuum_every_creature_falls_like_a_stone() {
    let mut draws = stream(2, [0; 3], "phenotype test");
    for place in 0..30 {
        let genotype = founder(place);
        let mut falling = developed(&genotype, &vacuum());
        let mut floating = developed(&genotype, &FlyerTask { gravity: 0.0, ..vacuum() });
        let start = falling.world.center_of_mass();
        for _ in 0..20 {
            let effectors = draw_effectors(&falling, &mut draws);
            step(&mut falling, &effectors).unwrap();
            step(&mut floating, &effectors).unwrap();
        }
        let fallen = falling.world.center_of_mass() - start;
        assert!((fallen - DVec3::new(0.0, -5.15025, 0.0)).length() < 1e-9, "{place}: {fallen}");
        assert!((falling.survey().velocity.y + 9.81).abs() < 1e-9);
        assert!(floating.world.linear_momentum().length() < 1e-9, "{place}");
    }
}

/// T-22: with a brain that cannot tell left from right, the wings beat alike.
#[test]
fn a_symmetric_brain_beats_the_wings_symmetrically() {
    let mut flown = 0;
    for place in 0..60 {
        let mut genotype = founder(place);
        genotype.nodes[1].effectors.iter_mut().for_each(|effector| effector.inputs.clear());
        for neuron in genotype.nodes.iter_mut().flat_map(|node| &mut node.neurons) {
            if matches!(neuron.function, Function::SumThreshold | Function::SignOf | Function::If) {
                neuron.function = Function::Average; // these amplify rounding
            }
        }
        let mut phenotype = developed(&genotype, &FlyerTask::default());
        let mut brain = Brain::new(&genotype);
        let segments = genotype.segments();
        let mut fastest = 0.0f64;
        let mut worst = (0.0f64, 0.0f64);
        for k in 0..100 {
            phenotype.sense(brain.sensors_mut());
            for (left, right) in (3..3 + segments).map(|left| (left, left + segments)) {
                worst.1 = worst.1.max((phenotype.angles[left] - phenotype.angles[right]).abs());
            }
            brain.step(f64::from(k) * 0.05);
            brain.step(f64::from(k) * 0.05 + 0.025);
            phenotype.drive(brain.effectors());
            if phenotype.step().is_err() {
                fastest = f64::INFINITY;
                break;
            }
            fastest = fastest.max(phenotype.survey().speed);
            worst.0 = worst.0.max(phenotype.world.center_of_mass().x.abs());
        }
        if fastest < 100.0 {
            flown += 1;
            assert!(worst.0 < 1e-6 && worst.1 < 1e-9, "{place}: {worst:?}");
        }
    }
    assert!(flown > 20, "{flown} flown");
}

/// T-22
#[test]
fn joints_of_creatures_that_do_not_blow_up_hold_together() {
    let mut worst = 0.0f64;
    for place in 0..40 {
        let genotype = founder(place);
        let mut phenotype = developed(&genotype, &FlyerTask::default());
        let mut brain = Brain::new(&genotype);
        let (mut apart, mut sound) = (0.0f64, true);
        for k in 0..400 {
            phenotype.sense(brain.sensors_mut());
            brain.step(f64::from(k) * 0.05);
            brain.step(f64::from(k) * 0.05 + 0.025);
            phenotype.drive(brain.effectors());
            sound = phenotype.step().is_ok() && phenotype.survey().speed < 1000.0;
            if !sound {
                break;
            }
            apart = apart.max(phenotype.world.separation());
        }
        if sound {
            worst = worst.max(apart);
            assert!(apart < 1.0, "{place}: {apart} m");
        }
    }
    assert!(worst > 0.0);
}

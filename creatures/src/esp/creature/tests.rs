//! Creatures made by hand: what the physics does to them.

use super::*;
use crate::esp::body::phenotype::{Muscle, Receptor};
use crate::esp::brain::tests::key;
use crate::esp::key::GeneId;
use crate::esp::sample;

/// A body of one part.
pub(in crate::esp) fn lump(shape: Shape) -> Phenotype {
    let root = Part {
        key: Vec::new(),
        segment: GeneId(0),
        shape,
        position: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        joint: None,
    };
    Phenotype { parts: vec![root], ..Phenotype::default() }
}

/// Hangs an unturned part on another, in one direction from centre to centre (E-14).
pub(in crate::esp) fn attach(
    body: &mut Phenotype,
    parent: usize,
    shape: Shape,
    direction: DVec3,
    gap: f64,
    kind: genotype::Joint,
    axis: DVec3,
) -> usize {
    let anchor = |shape: Shape, direction| shape.surface_point(direction) + gap * direction;
    let parent_anchor = anchor(body.parts[parent].shape, direction);
    let child_anchor = anchor(shape, -direction);
    body.parts.push(Part {
        key: Vec::new(),
        segment: GeneId(body.parts.len() as u32),
        shape,
        position: body.parts[parent].position + parent_anchor - child_anchor,
        rotation: DQuat::IDENTITY,
        joint: Some(PartJoint { parent, kind, parent_anchor, child_anchor, axis, travel: 0.1 }),
    });
    body.parts.len() - 1
}

/// Ties a muscle between two parts, at surface points in given directions (E-6).
pub(in crate::esp) fn tie(body: &mut Phenotype, parts: [usize; 2], directions: [DVec3; 2], strength: f64) {
    let ends = [0, 1].map(|end| body.parts[parts[end]].shape.surface_point(directions[end].normalize()));
    let places = [0, 1].map(|end| body.parts[parts[end]].position + ends[end]);
    let area = parts.map(|part| body.parts[part].shape.cross_section()).into_iter().fold(1.0, f64::min);
    let id = 1000 + body.muscles.len() as u32;
    body.muscles.push(Muscle {
        key: key(id),
        parts,
        ends,
        rest_length: (places[1] - places[0]).length(),
        force_max: strength * 2e4 * area,
    });
}

fn spawn(body: &Phenotype) -> Creature<'_> {
    Creature::spawn(body, Physics::default(), Start::Rest).unwrap()
}

/// A muscle or receptor too many, whose activation stays 0, changes no bit (T-13, E-26).
#[test]
fn an_undriven_muscle_or_a_receptor_changes_no_bit() {
    let body = sample::quadruped_body().develop().unwrap();
    let run = |body: &Phenotype| {
        let mut creature = spawn(body);
        let mut activations = vec![0.0; body.muscles.len()];
        let states = (0..300).map(|step| {
            for (muscle, activation) in activations.iter_mut().enumerate().take(16) {
                *activation = if (step / 15 + muscle) % 2 == 0 { 1.0 } else { 0.0 };
            }
            creature.step(&activations).unwrap();
            creature.state()
        });
        states.collect::<Vec<State>>()
    };
    let before = run(&body);
    assert!((before[299].centre - before[0].centre).length() > 0.02, "it moves");
    let mut more = body.clone();
    tie(&mut more, [0, 4], [DVec3::NEG_X, DVec3::Y], 1.0);
    more.receptors.push(Receptor { key: key(7), part: 2, point: DVec3::X * 0.05, axis: DVec3::X });
    assert_eq!(run(&more), before);
}

/// E-20: trials begin with clones of one settled creature, which has to be as good as settling anew. So has one
/// taken in full swing, while the first goes another way.
#[test]
fn a_clone_goes_on_to_the_same_bits() {
    let body = sample::quadruped_body().develop().unwrap();
    let live = |creature: &mut Creature, phase: usize| -> Vec<State> {
        let states = (0..150_usize).map(|step| {
            let on = |muscle: usize| if (step / 15 + muscle + phase).is_multiple_of(2) { 1.0 } else { 0.0 };
            creature.step(&(0..16).map(on).collect::<Vec<f64>>()).unwrap();
            creature.state()
        });
        states.collect()
    };
    let settled = spawn(&body);
    let (mut clone, mut fresh) = (settled.clone(), spawn(&body));
    let walked = live(&mut fresh, 0);
    assert!((walked[149].centre - walked[0].centre).length() > 0.01, "it moves");
    assert_eq!(live(&mut clone, 0), walked);
    let mut other = clone.clone();
    live(&mut clone, 1);
    assert_eq!(live(&mut other, 0), live(&mut fresh, 0));
    assert_ne!(clone.state(), other.state(), "they share nothing");
}

/// A trunk and one limb of a kind of joint, with a muscle across the gap: above it, where a hinge about y bends
/// and a slide along x shortens.
fn limb(kind: genotype::Joint) -> Phenotype {
    use genotype::Joint::{Cylindrical, Prismatic};
    let axis = if matches!(kind, Prismatic | Cylindrical) { DVec3::X } else { DVec3::Y };
    let mut body = lump(Shape::Box([0.2, 0.2, 0.1]));
    let leg = Shape::Capsule { radius: 0.06, half_length: 0.15 };
    let leg = attach(&mut body, 0, leg, DVec3::X, 0.03, kind, axis);
    tie(&mut body, [0, leg], [DVec3::new(1.0, 0.0, 1.0), DVec3::new(-0.2, 0.0, 1.0)], 1.0);
    body
}

fn kinds() -> [genotype::Joint; 5] {
    use genotype::Joint::{Cylindrical, Fixed, Prismatic, Revolute, Spherical};
    [Fixed, Revolute, Spherical, Prismatic, Cylindrical]
}

/// E-20: at rest above the ground, then settled upon it; its back up or down, ahead along x.
#[test]
fn a_creature_spawns_above_the_ground_and_settles_on_it() {
    let body = sample::quadruped_body().develop().unwrap();
    for (start, up) in [(Start::Rest, 1.0), (Start::UpsideDown, -1.0)] {
        let placed = Creature::place(&body, Physics::default(), start);
        let bottom = (0..placed.world.len()).map(|part| {
            let pose = placed.world.pose(part);
            pose.position.z - placed.world.shape(part).reach(pose.rotation.inverse() * DVec3::Z)
        });
        assert!((bottom.fold(f64::INFINITY, f64::min) - CLEARANCE).abs() < 1e-6);
        assert!((placed.state.up - up).abs() < 1e-6 && placed.state.heading.abs() < 1e-6);
        let settled = Creature::spawn(&body, Physics::default(), start).unwrap();
        assert!(settled.state.up * up > 0.0);
        assert!((settled.state.ground_force / settled.weight() - 1.0).abs() < 0.1, "{:?}", settled.state);
    }
}

/// E-23: what lies still goes on lying still, for ten seconds.
#[test]
fn a_slack_creature_stays_where_it_settled() {
    let mut bodies: Vec<Phenotype> = kinds().into_iter().map(limb).collect();
    // It comes to lie on its own folded legs.
    bodies.push(sample::quadruped_body().develop().unwrap());
    for body in &bodies {
        let mut creature = spawn(body);
        // What is still toppling after 2 s is let down before it is measured.
        let slack = vec![0.0; body.muscles.len()];
        (0..240).for_each(|_| creature.step(&slack).unwrap());
        let start = creature.state.centre;
        (0..600).for_each(|_| creature.step(&slack).unwrap());
        let drift = (creature.state.centre - start).length();
        assert!(drift <= 0.05, "{:?}: {drift} m", body.parts.last().map(|part| part.joint));
        assert!(creature.separation() < 0.005, "{}", creature.separation());
    }
}

/// E-23: as founders are drawn, whoever settles goes on lying where it settled.
#[test]
fn twenty_random_bodies_stay_where_they_settled() {
    let syllabus = crate::esp::syllabus::tests::ten_skills().check().unwrap();
    let first = crate::esp::syllabus::SkillId(0);
    let (mut measured, mut drifts) = (0, Vec::new());
    for index in 0..200 {
        let draws = &mut crate::random::stream(1, [0, 0, index], "drift test");
        let founder = crate::esp::Genotype::founder(first, &syllabus, draws).genotype;
        let body = founder.body.develop().unwrap();
        let Ok(mut creature) = Creature::spawn(&body, Physics::default(), Start::Rest) else { continue };
        let slack = vec![0.0; body.muscles.len()];
        let start = creature.state.centre;
        (0..600).for_each(|_| creature.step(&slack).unwrap());
        let drift = (creature.state.centre - start).length();
        if drift > 0.05 {
            drifts.push((index, drift));
        }
        measured += 1;
        if measured == 20 {
            break;
        }
    }
    assert_eq!((measured, drifts), (20, vec![]), "founders that drifted, m");
}

/// E-20: what rolls by itself when its trial should begin has no trial, and what is at rest begins it at rest.
#[test]
fn a_roll_from_the_spawn_does_not_score() {
    let body = lump(Shape::Capsule { radius: 0.2, half_length: 0.2 });
    let physics = Physics { rolling_resistance: 0.0, ..Physics::default() };
    let roll_in = |start, speed: f64| {
        let mut creature = Creature::place(&body, physics, start);
        creature.world.push(0, DVec3::Y * speed * creature.mass / physics.settings().step, DVec3::ZERO);
        creature.settle(start).map(|()| creature)
    };
    let roll = |speed| roll_in(Start::Rest, speed);
    let fault = roll(1.0).err().unwrap();
    assert!(
        matches!(fault, Fault { kind: FaultKind::Unsettled(speed), step: 120, settled: false } if speed > 0.05)
    );
    assert_eq!(fault.kind.reason().word(), "unsettled");
    let mut slow = roll(0.03).unwrap();
    let place = slow.state.centre;
    assert!(place.y > 0.005, "it had rolled");
    (0..600).for_each(|_| slow.step(&[]).unwrap());
    assert!((slow.state.centre - place).length() < 1e-4, "{}", slow.state.centre);
    assert!(roll_in(Start::UpsideDown, 1.0).unwrap().fastest() < 1e-9, "on its back it is stopped");
}

/// E-24, E-25: a muscle across a joint of any kind pulls its limb, and no joint comes apart.
#[test]
fn a_muscle_moves_what_its_joint_leaves_free() {
    for kind in kinds() {
        let body = limb(kind);
        let mut creature = spawn(&body);
        let before = creature.pulls[0].stretch.length;
        let mut apart = 0.0_f64;
        for _ in 0..60 {
            creature.step(&[1.0]).unwrap();
            apart = apart.max(creature.separation());
        }
        let shortened = before - creature.pulls[0].stretch.length;
        assert_eq!(shortened > 0.005, kind != genotype::Joint::Fixed, "{kind:?}: {shortened}");
        assert!(apart < 0.01, "{kind:?}: {apart}");
        let mut felt = [0.0];
        creature.feel(&mut felt);
        assert_eq!(felt[0], body.muscles[0].feel(creature.pulls[0].stretch.length));
    }
}

/// E-21: the heading is the root's, and the last valid one where the root looks up.
#[test]
fn the_heading_is_where_the_root_looks() {
    let body = lump(Shape::Box([0.3, 0.1, 0.05]));
    let mut creature = Creature::place(&body, Physics::default(), Start::Rest);
    creature.state.heading = 2.0;
    creature.observe(0.0);
    assert!(creature.state.heading.abs() < 1e-9);
    let upright = Pose { position: DVec3::Z, rotation: crate::math::from_rotation_vector(DVec3::Y * -1.56) };
    creature.world = World::new(Physics::default().settings());
    creature.world.insert(contact::Shape::Ball(0.1), &upright);
    creature.state.heading = 2.0;
    creature.observe(0.0);
    assert_eq!(creature.state.heading, 2.0);
}

/// E-23: each fault has its limit and its name.
#[test]
fn faults_are_seen_and_named() {
    let body = lump(Shape::Box([0.1; 3]));
    let fault_of = |shift: f64, speed: f64, energy: f64| {
        let mut creature = spawn(&body);
        creature.world = World::new(Physics::default().settings());
        let pose = Pose { position: DVec3::Z * (0.1 + shift), rotation: DQuat::IDENTITY };
        creature.world.insert(contact::Shape::Cuboid(DVec3::splat(0.1)), &pose);
        let force = speed * creature.mass / Physics::default().settings().step;
        creature.world.push(0, DVec3::X * force, DVec3::ZERO);
        creature.world.step();
        creature.balance = Balance::open(creature.world.energy() - energy);
        creature.examine(0.0).unwrap_err()
    };
    assert!(matches!(fault_of(5.0, 31.0, 0.0), FaultKind::Speed(speed) if speed > 30.0));
    assert!(matches!(fault_of(5.0, f64::NAN, 0.0), FaultKind::NonFinite));
    assert!(matches!(fault_of(-0.25, 0.0, 0.0), FaultKind::Sinking(depth) if depth > 0.2));
    // 8 kg: a quarter of a metre is worth 19.6 J.
    assert!(matches!(fault_of(5.0, 1.0, 20.0), FaultKind::Energy(surplus) if surplus > 19.6));
    let fault = Fault { kind: FaultKind::Separation(0.06), step: 7, settled: true };
    assert_eq!(fault.to_string(), "a joint is 0.060 m apart, over 0.05 at step 7 of the trial");
}

/// The energy balance holds for hard work, and is not fooled by it: muscles at full strength, back and forth.
#[test]
fn hard_work_is_no_gain_from_nothing() {
    let body = sample::quadruped_body().develop().unwrap();
    for period in [4, 10, 30] {
        let mut creature = spawn(&body);
        let mut most = 0.0_f64;
        for step in 0..600 {
            let on = |muscle: usize| f64::from(u8::from((step / period + muscle).is_multiple_of(2)));
            let activations: Vec<f64> = (0..body.muscles.len()).map(on).collect();
            creature.step(&activations).unwrap();
            most = most.max(creature.surplus());
        }
        assert!(most < 0.5 * creature.surplus_max, "{most} J of {}", creature.surplus_max);
    }
}

/// What is recorded of a muscle leads from one of its ends to the other, on boxes and capsules alike.
#[test]
fn recorded_muscles_are_where_they_pull() {
    let body = limb(genotype::Joint::Spherical);
    let mut creature = spawn(&body);
    (0..30).for_each(|_| creature.step(&[0.7]).unwrap());
    let (scene, frame) = (creature.scene(), creature.frame());
    let cord = &scene.cords[0];
    let end = |end: usize| match frame.poses[cord.parts[end] as usize] {
        crate::record::Pose::Rigid { position, orientation } => position + orientation * cord.ends[end],
        _ => panic!("a segment is rigid"),
    };
    let length = (end(1) - end(0)).length();
    assert!((length - creature.pulls[0].stretch.length).abs() < 1e-9, "{length}");
    assert_eq!((scene.muscles.len(), scene.cords.len(), frame.muscles), (1, 1, vec![vec![0.7]]));
}

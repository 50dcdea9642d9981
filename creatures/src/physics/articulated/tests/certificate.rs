//! Every step against a dense reference: the velocities that the tree elimination found are those of the
//! whole system in maximal coordinates, solved without any structure, and every motor, stop and contact
//! obeys its law at them. Since the laws are monotone, that certifies the solution.
//!
//! The reference shares nothing with the engine but the poses before the step: it writes each joint as six
//! constraint rows, each body about its own centre of mass.

use super::super::contact::{Contact, Hold};
use super::super::staircase::Demand;
use super::articulated::{Body, Joint, JointKind, ModelBuilder, Motor, Settings, Shape, StopRule, World};
use super::bodies::{self, Creature};
use super::gaits;
use crate::math;
use crate::random::{Stream, stream};
use glam::{DMat3, DQuat, DVec3};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

const ERP: f64 = 0.2;

/// A row of the reference: a linear form on the velocities of two bodies (or one).
struct Row {
    terms: Vec<(usize, DVec3, DVec3)>,
}

impl Row {
    /// Relative velocity of the material points of child and parent at `at`, along `d`.
    fn point(parent: Option<usize>, child: usize, at: DVec3, d: DVec3, world: &World) -> Row {
        let center = |k: usize| world.bodies[k].pose.position;
        let mut terms = vec![(child, d, (at - center(child)).cross(d))];
        terms.extend(parent.map(|p| (p, -d, -(at - center(p)).cross(d))));
        Row { terms }
    }

    /// Relative angular velocity of child and parent along `d`.
    fn turn(parent: usize, child: usize, d: DVec3) -> Row {
        Row { terms: vec![(child, DVec3::ZERO, d), (parent, DVec3::ZERO, -d)] }
    }

    fn times(&self, after: &World) -> f64 {
        let part = |(k, v, w): &(usize, DVec3, DVec3)| {
            v.dot(after.bodies[*k].velocity) + w.dot(after.bodies[*k].spin)
        };
        self.terms.iter().map(part).sum()
    }

    fn add_to(&self, column: &mut DVector<f64>, scale: f64) {
        for (k, v, w) in &self.terms {
            for i in 0..3 {
                column[6 * k + i] += v[i] * scale;
                column[6 * k + 3 + i] += w[i] * scale;
            }
        }
    }
}

/// What the specification of a joint says, kept from the model.
struct Spec {
    parent: usize,
    joint: Joint,
    base: DQuat,
    tip: DQuat,
}

/// Locked rows with their wanted velocities, and driven rows.
fn rows(spec: &Spec, child: usize, world: &World, dt: f64) -> (Vec<(Row, f64)>, Vec<Row>) {
    let (p, c) = (&world.bodies[spec.parent].pose, &world.bodies[child].pose);
    let back = -ERP / dt;
    let at = c.position + c.rotation * spec.joint.child_anchor;
    let gap = at - (p.position + p.rotation * spec.joint.parent_anchor);
    let (mut locked, mut driven) = (vec![], vec![]);
    let point = |d: DVec3| Row::point(Some(spec.parent), child, at, d, world);
    let turn = |d: DVec3| Row::turn(spec.parent, child, d);
    let pair = |axis: DVec3| {
        let (a, b) = axis.any_orthonormal_pair();
        [a, b]
    };
    let start = spec.base.inverse() * spec.tip;
    let twisted = p.orientation.inverse() * c.orientation * start.inverse();
    let error = p.rotation * (2.0 * twisted.xyz() * twisted.w.signum());
    match spec.joint.kind {
        JointKind::Slider { axis } => {
            let axis = p.rotation * axis;
            locked.extend(pair(axis).map(|d| (point(d), back * gap.dot(d))));
            locked.extend(DVec3::AXES.map(|d| (turn(d), back * error.dot(d))));
            driven.push(point(axis));
        }
        JointKind::Fixed => {
            locked.extend(DVec3::AXES.map(|d| (point(d), back * gap.dot(d))));
            locked.extend(DVec3::AXES.map(|d| (turn(d), back * error.dot(d))));
        }
        JointKind::Ball => {
            locked.extend(DVec3::AXES.map(|d| (point(d), back * gap.dot(d))));
            driven.extend(DVec3::AXES.map(|d| turn(p.rotation * d)));
        }
        JointKind::Hinge { axis } => {
            let (mine, theirs) = (p.rotation * axis, c.rotation * (start.inverse() * axis));
            locked.extend(DVec3::AXES.map(|d| (point(d), back * gap.dot(d))));
            locked.extend(pair(mine).map(|d| (turn(d), -back * theirs.cross(mine).dot(d))));
            driven.push(turn(mine));
        }
    }
    (locked, driven)
}

/// Checks one step that has been made from `before` to `after`.
fn certify(before: &World, after: &World, specs: &[Spec], dt: f64) -> Result<(), TestCaseError> {
    let count = before.bodies.len();
    let mut mass = DMatrix::zeros(6 * count, 6 * count);
    let mut momentum = DVector::zeros(6 * count);
    for (k, body) in before.bodies.iter().enumerate() {
        let rotation = DMat3::from_quat(body.pose.orientation);
        let inertia = rotation * DMat3::from_diagonal(body.moments) * rotation.transpose();
        let linear = body.mass * body.velocity + dt * (body.mass * before.settings.gravity + body.force);
        let angular = body.angular_momentum + dt * body.torque;
        for i in 0..3 {
            mass[(6 * k + i, 6 * k + i)] = body.mass;
            for j in 0..3 {
                mass[(6 * k + 3 + i, 6 * k + 3 + j)] = inertia.col(j)[i];
            }
            momentum[6 * k + i] = linear[i];
            momentum[6 * k + 3 + i] = angular[i];
        }
    }
    let mut locked = vec![];
    for (index, spec) in specs.iter().enumerate() {
        let (rows, driven) = rows(spec, index + 1, before, dt);
        locked.extend(rows);
        for (dof, row) in driven.into_iter().enumerate() {
            let degree = &after.links[index].dofs()[dof];
            let joint = before.joints().nth(index).unwrap();
            let coordinate = before.coordinate(joint, dof);
            let law = Law {
                motor: degree.motor,
                stops: spec.joint.stops[dof],
                rule: before.stop_rule,
                coordinate,
                dt,
            };
            law.check(row.times(after), degree.impulse)?;
            match degree.demand() {
                Demand::Locked(rate) => locked.push((row, rate)),
                Demand::Free(impulse) => row.add_to(&mut momentum, impulse),
            }
        }
    }
    for contact in &after.contacts {
        check_contact(before, after, contact, dt)?;
        add_contact(before, contact, dt, &mut mass, &mut momentum);
    }
    // [M −Jᵀ; J 0] [v; λ] = [P; b]
    let size = 6 * count + locked.len();
    let mut system = DMatrix::zeros(size, size);
    system.view_mut((0, 0), (6 * count, 6 * count)).copy_from(&mass);
    let mut right = DVector::zeros(size);
    right.rows_mut(0, 6 * count).copy_from(&momentum);
    for (k, (row, wanted)) in locked.iter().enumerate() {
        let mut column = DVector::zeros(6 * count);
        row.add_to(&mut column, 1.0);
        system.view_mut((0, 6 * count + k), (6 * count, 1)).copy_from(&-&column);
        system.view_mut((6 * count + k, 0), (1, 6 * count)).copy_from(&column.transpose());
        right[6 * count + k] = *wanted;
    }
    let solved = system.lu().solve(&right).expect("a tree of joints is regular");
    for (k, body) in after.bodies.iter().enumerate() {
        for i in 0..3 {
            for (mine, theirs) in
                [(body.velocity[i], solved[6 * k + i]), (body.spin[i], solved[6 * k + 3 + i])]
            {
                prop_assert!(
                    (mine - theirs).abs() <= 1e-9 * (1.0 + theirs.abs()),
                    "body {k}: {mine} against {theirs}"
                );
            }
        }
    }
    Ok(())
}

/// Writes a contact's piece of its law, the one that the engine settled on, into the dense system.
fn add_contact(
    world: &World,
    contact: &Contact,
    dt: f64,
    mass: &mut DMatrix<f64>,
    momentum: &mut DVector<f64>,
) {
    let ground = world.settings.ground.unwrap();
    let at = contact_place(world, contact.body, contact.point);
    let (first, second) = ground.normal.any_orthonormal_pair();
    let [normal, x, y] = [ground.normal, first, second].map(|d| {
        let mut column = DVector::zeros(momentum.len());
        Row::point(None, contact.body, at, d, world).add_to(&mut column, 1.0);
        column
    });
    let gap = ground.normal.dot(at) - ground.offset;
    let gain = dt * (ground.stiffness * dt + ground.damping);
    // The normal impulse is `constant − gain · v_n`.
    let constant = if gap <= 0.0 { -dt * ground.stiffness * gap } else { -gain * gap / dt };
    let mut push = normal.clone();
    match contact.hold {
        Hold::Open => return,
        Hold::Given => panic!("no step of these tests runs out of rounds"),
        Hold::Drag { drag } => *mass += (&x * x.transpose() + &y * y.transpose()) * drag,
        Hold::Slide { direction: [dx, dy], turning, fixed, follow } => {
            let (along, across) = (&x * dx + &y * dy, &y * dx - &x * dy);
            *mass += &across * across.transpose() * turning;
            push -= &along * follow;
            *momentum -= along * fixed;
        }
    }
    *mass += &push * normal.transpose() * gain;
    *momentum += push * constant;
}

/// Motor and stops, as the specification words them.
struct Law {
    motor: Motor,
    stops: Option<(f64, f64)>,
    rule: StopRule,
    coordinate: f64,
    dt: f64,
}

impl Law {
    fn check(&self, rate: f64, impulse: f64) -> Result<(), TestCaseError> {
        let bound = self.motor.effort * self.dt;
        let (near, slack) = (1e-7, 1e-7 * bound + 1e-12);
        // What the motor may give at this rate.
        let most = if rate > self.motor.rate + near { -bound } else { bound };
        let least = if rate < self.motor.rate - near { bound } else { -bound };
        let (mut most, mut least) = (most + slack, least - slack);
        if let Some((low, high)) = self.stops {
            let acts = |excess: f64| excess >= 0.0 || self.rule == StopRule::Anticipated;
            let share = |excess: f64| if excess >= 0.0 { ERP } else { 1.0 };
            let (under, over) = (low - self.coordinate, self.coordinate - high);
            if acts(under) {
                let least_rate = share(under) * under / self.dt;
                prop_assert!(rate >= least_rate - near, "{rate} passes the low stop's {least_rate}");
                most = if rate < least_rate + near { f64::INFINITY } else { most };
            }
            if acts(over) {
                let most_rate = -share(over) * over / self.dt;
                prop_assert!(rate <= most_rate + near, "{rate} passes the high stop's {most_rate}");
                least = if rate > most_rate - near { f64::NEG_INFINITY } else { least };
            }
        }
        prop_assert!(
            (least..=most).contains(&impulse),
            "impulse {impulse} at rate {rate} is not within {least}..={most} of {:?}",
            self.motor
        );
        Ok(())
    }
}

/// Where a contact point is before the step.
fn contact_place(world: &World, body: usize, point: usize) -> DVec3 {
    let pose = &world.bodies[body].pose;
    let ground = world.settings.ground.unwrap();
    pose.position + pose.rotation * world.points[point].local - ground.normal * world.bodies[body].radius
}

fn check_contact(before: &World, after: &World, contact: &Contact, dt: f64) -> Result<(), TestCaseError> {
    let ground = before.settings.ground.unwrap();
    let at = contact_place(before, contact.body, contact.point);
    let along = |d: DVec3| Row::point(None, contact.body, at, d, before).times(after);
    let gap = ground.normal.dot(at) - ground.offset;
    let normal = along(ground.normal);
    // Spring and damper at the step's end; a point above the ground meets it on the way.
    let (k, c) = (ground.stiffness, ground.damping);
    let force =
        if gap <= 0.0 { -k * (gap + dt * normal) - c * normal } else { -(k * dt + c) * (normal + gap / dt) };
    let pressure = dt * force.max(0.0);
    let near = 1e-9 * dt * (k * dt + c);
    prop_assert!(
        (contact.pressure - pressure).abs() <= near,
        "pressure {} is not the law's {pressure}",
        contact.pressure
    );
    let [first, second]: [DVec3; 2] = ground.normal.any_orthonormal_pair().into();
    let (slip_x, slip_y) = (along(first), along(second));
    let [x, y] = contact.shear;
    let (slip, share) = ((slip_x * slip_x + slip_y * slip_y).sqrt(), (x * x + y * y).sqrt());
    let cone = before.bodies[contact.body].friction * pressure;
    prop_assert!(share <= cone * (1.0 + 1e-9) + 1e-15, "friction {share} leaves the cone {cone}");
    let power = x * slip_x + y * slip_y;
    if slip > 1.1 * ground.slip_speed {
        prop_assert!(power <= -0.97 * cone * slip, "sliding at {slip}, friction {share} of {cone}: {power}");
    }
    prop_assert!(power <= 0.0, "friction drives: {power}");
    Ok(())
}

fn unit(draws: &mut Stream) -> DVec3 {
    let draw = DVec3::from_array(std::array::from_fn(|_| draws.between(-1.0, 1.0)));
    if draw.length() < 0.1 { DVec3::Z } else { draw.normalize() }
}

fn within(draws: &mut Stream, size: DVec3) -> DVec3 {
    size * DVec3::from_array(std::array::from_fn(|_| draws.between(-1.0, 1.0)))
}

/// A random tree in a random pose near the ground, with random velocities.
fn random_tree(seed: u64, count: usize, grounded: bool) -> (World, Vec<Spec>) {
    let draws = &mut stream(seed, [count as u32, 0, 0], "tree");
    let settings = Settings { erp: ERP, ..if grounded { bodies::earth() } else { bodies::space() } };
    let mut model = ModelBuilder::new(settings);
    let shape = |draws: &mut Stream, position: DVec3| {
        let rotation = math::from_rotation_vector(unit(draws) * draws.between(0.0, 3.0));
        let mut body = if draws.chance(0.7) {
            let size = DVec3::from_array(std::array::from_fn(|_| draws.between(0.02, 0.15)));
            Body::cuboid(size, draws.between(50.0, 400.0), position)
        } else {
            Body::capsule(
                draws.between(0.01, 0.04),
                draws.between(0.02, 0.2),
                draws.between(50.0, 400.0),
                position,
            )
        };
        (body.orientation, body.friction) = (rotation, draws.between(0.1, 1.2));
        body
    };
    let extent = |body: &Body| match body.shape {
        Some(Shape::Cuboid { half }) => half,
        Some(Shape::Capsule { radius, half_length }) => DVec3::new(radius, radius, half_length),
        None => DVec3::ZERO,
    };
    let height = draws.between(0.02, 0.15);
    let root = shape(draws, DVec3::new(0.3, -0.2, height));
    let mut all = vec![(model.root(root), root)];
    let mut specs = vec![];
    for _ in 1..count {
        let parent = draws.below(all.len());
        let (id, base) = all[parent];
        let mut body = shape(draws, DVec3::ZERO);
        let axis = unit(draws);
        let kind = match draws.below(4) {
            0 => JointKind::Fixed,
            1 => JointKind::Hinge { axis },
            2 => JointKind::Ball,
            _ => JointKind::Slider { axis },
        };
        let mut stops = [None; 3];
        for stop in stops.iter_mut().take(kind.degrees()) {
            let range = if matches!(kind, JointKind::Slider { .. }) { 0.05 } else { 0.8 };
            if draws.chance(0.6) {
                *stop = Some((draws.between(-range, 0.0), draws.between(0.0, range)));
            }
        }
        let (parent_anchor, child_anchor) = (within(draws, extent(&base)), within(draws, extent(&body)));
        body.position = base.position + base.orientation * parent_anchor - body.orientation * child_anchor;
        let joint = Joint { kind, parent_anchor, child_anchor, stops };
        let (child, _) = model.attach(id, body, joint).unwrap();
        all.push((child, body));
        specs.push(Spec { parent, joint, base: base.orientation, tip: body.orientation });
    }
    let rule = if draws.chance(0.5) { StopRule::Anticipated } else { StopRule::Reached };
    let mut world = model.stop_rule(rule).build().unwrap();
    for (id, _) in all {
        world.set_velocity(id, within(draws, DVec3::ONE), within(draws, DVec3::splat(6.0)));
    }
    (world, specs)
}

/// Motors and pushes redrawn, some joints limp.
fn disturb(world: &mut World, draws: &mut Stream) {
    for joint in world.joints() {
        for dof in 0..world.degrees(joint) {
            let effort = if draws.chance(0.2) { 0.0 } else { math::pow(10.0, draws.between(-3.0, 1.0)) };
            world.drive(joint, dof, Motor { rate: draws.between(-5.0, 5.0), effort });
        }
    }
    let body = world.bodies().nth(draws.below(world.bodies.len())).unwrap();
    world.push(body, within(draws, DVec3::ONE), within(draws, DVec3::splat(0.05)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn every_step_of_a_random_tree_is_the_dense_solution_and_obeys_every_law(
        seed in any::<u64>(),
        count in 2_usize..=8,
        grounded in any::<bool>(),
    ) {
        let (mut world, specs) = random_tree(seed, count, grounded);
        let draws = &mut stream(seed, [0; 3], "motors");
        let dt = 1.0 / 240.0;
        for step in 0..40 {
            if step % 8 == 0 {
                disturb(&mut world, draws);
            }
            let before = world.clone();
            world.step(dt).unwrap();
            certify(&before, &world, &specs, dt)?;
        }
    }
}

/// The joints of a creature in its start pose.
fn specs_of(creature: &Creature) -> Vec<Spec> {
    let orientation = |k: usize| creature.world.orientation(creature.bodies[k]);
    let spec = |(k, &(parent, joint)): (usize, &(usize, Joint))| Spec {
        parent,
        joint,
        base: orientation(parent),
        tip: orientation(k + 1),
    };
    creature.specs.iter().enumerate().map(spec).collect()
}

#[test]
fn every_step_of_a_walker_is_the_dense_solution_and_obeys_every_law() {
    for gait in gaits::ALL {
        let mut creature = (gait.body)(bodies::earth());
        let specs = specs_of(&creature);
        for step in 0..900 {
            if step % 4 == 0 {
                (gait.commands)(&mut creature, f64::from(step) / 240.0);
            }
            let before = creature.world.clone();
            creature.world.step(1.0 / 240.0).unwrap();
            certify(&before, &creature.world, &specs, 1.0 / 240.0)
                .unwrap_or_else(|why| panic!("{} at step {step}: {why}", gait.name));
        }
    }
}

/// Bodies of 30 m whose thin axes are a thousandth of that: all the digits that one reference point costs.
#[test]
fn every_step_of_a_flyer_is_the_dense_solution_and_obeys_every_law() {
    let mut creature = bodies::flyer(Settings { gravity: DVec3::NEG_Y * 9.81, ..bodies::space() });
    let specs = specs_of(&creature);
    for step in 0..300 {
        gaits::flap(&mut creature, f64::from(step) * 0.05);
        let before = creature.world.clone();
        creature.world.step(0.05).unwrap();
        certify(&before, &creature.world, &specs, 0.05).unwrap_or_else(|why| panic!("at step {step}: {why}"));
    }
}

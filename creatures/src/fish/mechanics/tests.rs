use super::*;
use crate::fish::body::Body;
use crate::fish::hydrodynamics::Still;
use crate::fish::lattice::{Face, Spring};
use crate::random::stream;

/// Two nodes and a spring, and one step of them.
fn step_pair(masses: [f64; 2], c: f64, l: f64, apart: DVec3, velocity: DVec3) -> [DVec3; 2] {
    let spring = Spring { ends: [0, 1], stiffness: c, rest_length: l };
    let lattice = Lattice { masses: masses.to_vec(), damping: 0.05, springs: vec![spring], faces: vec![] };
    let positions = vec![DVec3::ZERO, apart];
    let mut motion = Motion { positions: positions.clone(), velocities: vec![DVec3::ZERO, velocity] };
    let mut mechanics = Mechanics::new(&lattice, 1, 100.0);
    mechanics.step(&lattice, &mut motion, &[l], &[DVec3::ZERO; 2], &Still).unwrap();
    [0, 1].map(|node| motion.positions[node] - positions[node])
}

fn close(found: DVec3, expected: DVec3, tolerance: f64) {
    assert!((found - expected).length() < tolerance, "{found} is not {expected}");
}

/// T-3
#[test]
fn a_stretched_pair_comes_together() {
    let [first, second] = step_pair([6.6; 2], 28.0, 3.0, DVec3::new(3.6, 0.0, 0.0), DVec3::ZERO);
    close(first, DVec3::new(0.00750426379, 0.0, 0.0), 1e-11);
    close(second, -first, 1e-15);
    assert!((first.x / TIME_STEP - 0.13644115975).abs() < 1e-11);
}

/// T-4
#[test]
fn a_step_is_the_solution_of_the_linearised_equations() {
    let velocity = DVec3::new(0.3, 0.2, 0.0);
    let [first, second] = step_pair([1.1, 0.165], 30.0, 2.0, DVec3::new(0.0, 2.5, 0.0), velocity);
    close(first, DVec3::new(0.00023751190, 0.02589669328, 0.0), 1e-11);
    close(second, DVec3::new(0.01466815945, -0.15941924598, 0.0), 1e-11);
    let [first, second] = step_pair([1.1, 0.165], 30.0, 2.0, DVec3::new(0.0, 1.5, 0.0), velocity);
    close(first, DVec3::new(0.0, -0.02479966, 0.0), 1e-8);
    close(second, DVec3::new(0.01622951, 0.17384693, 0.0), 1e-8);
}

/// T-5, the implicit row.
#[test]
fn pressure_is_implicit_in_velocity() {
    let lattice = Lattice {
        masses: vec![1.1; 3],
        damping: 0.05,
        springs: vec![],
        faces: vec![Face { corners: [0, 1, 2], weight: 1.0 }],
    };
    let positions = vec![DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
    let mut motion = Motion { positions, velocities: vec![DVec3::new(0.0, 0.0, 0.4); 3] };
    let mut mechanics = Mechanics::new(&lattice, 1, 100.0);
    mechanics.step(&lattice, &mut motion, &[], &[DVec3::ZERO; 3], &Still).unwrap();
    for velocity in motion.velocities {
        close(velocity, DVec3::new(0.0, 0.0, 0.38004750594), 1e-11);
    }
}

/// T-6
#[test]
fn a_body_at_rest_shape_is_held_back_as_its_skin_says() {
    let body = Body::published(1.0);
    for (velocity, expected) in [
        (DVec3::X, DVec3::new(-68.924806, 2.462796, 0.0)),
        (DVec3::Y, DVec3::new(0.0, -4.924788, 0.0)),
        (-DVec3::Y, DVec3::new(0.0, 4.077652, 0.0)),
        (DVec3::Z, DVec3::new(0.0, -2.439840, -45.627515)),
    ] {
        let motion = Motion { positions: body.rest.clone(), velocities: vec![velocity; 23] };
        let faces = body.lattice.faces.iter();
        let total: DVec3 =
            faces.filter_map(|face| pressed(face, &motion, &Still)).map(|face| face.force(velocity)).sum();
        close(total, expected, 1e-6);
    }
}

/// columns hold 36 entries that rows would not, all of them zero.
#[test]
fn the_matrix_of_a_fish_keeps_to_its_envelope() {
    let body = Body::published(1.0);
    let mechanics = Mechanics::new(&body.lattice, 1, 100.0);
    assert_eq!(mechanics.matrix.size(), 1065 + 36);
}

fn passive(body: &Body) -> Vec<f64> {
    body.lattice.springs.iter().map(|spring| spring.rest_length).collect()
}

/// T-7
#[test]
fn a_body_at_rest_stays_exactly_where_it_is() {
    let body = Body::published(1.0);
    let (mut mechanics, mut motion) =
        (Mechanics::new(&body.lattice, 1, 100.0), Motion::at_rest(body.rest.clone()));
    for _ in 0..1000 {
        mechanics.step(&body.lattice, &mut motion, &passive(&body), &[DVec3::ZERO; 23], &Still).unwrap();
    }
    assert_eq!(motion.positions, body.rest);
}

/// T-8, A-13
#[test]
fn energy_never_rises_in_still_water() {
    let body = Body::published(1.0);
    let rest_lengths = passive(&body);
    for seed in 0..40 {
        let mut draws = stream(seed, [0, 0, 0], "perturbed");
        let mut draw = |scale: f64| DVec3::new(draws.normal(), draws.normal(), draws.normal()) * scale;
        let mut motion = Motion {
            positions: body.rest.iter().map(|&position| position + draw(0.5)).collect(),
            velocities: (0..23).map(|_| draw(1.0)).collect(),
        };
        let mut mechanics = Mechanics::new(&body.lattice, 1, 1e4);
        let energy = |motion: &Motion| {
            let energy = body.lattice.energy(motion, &rest_lengths);
            energy.kinetic + energy.elastic
        };
        let mut before = energy(&motion);
        for step in 0..100 {
            mechanics.step(&body.lattice, &mut motion, &rest_lengths, &[DVec3::ZERO; 23], &Still).unwrap();
            let after = energy(&motion);
            assert!(after <= before, "seed {seed}, step {step}: {before} rises to {after}");
            before = after;
        }
    }
}

/// T-8
#[test]
fn muscles_alone_move_nothing_away() {
    let body = Body::published(1.0);
    let lattice = Lattice { damping: 0.0, faces: vec![], ..body.lattice.clone() };
    let (mut mechanics, mut motion) =
        (Mechanics::new(&lattice, 1, 100.0), Motion::at_rest(body.rest.clone()));
    let mut draws = stream(1, [0, 0, 0], "actuation");
    for _ in 0..1000 {
        let mut rest_lengths = passive(&body);
        for muscle in body.muscles {
            rest_lengths[muscle] *= draws.between(0.5, 1.0);
        }
        mechanics.step(&lattice, &mut motion, &rest_lengths, &[DVec3::ZERO; 23], &Still).unwrap();
    }
    let momentum: DVec3 = lattice.masses.iter().zip(&motion.velocities).map(|(m, v)| *m * *v).sum();
    assert!(momentum.length() < 1e-11, "{momentum}");
}

/// AF-6, AF-7, AF-8
#[test]
fn what_is_out_of_bounds_is_named() {
    let body = Body::published(1.0);
    let fault = |change: &dyn Fn(&mut Motion)| {
        let mut motion = Motion::at_rest(body.rest.clone());
        change(&mut motion);
        let mut mechanics = Mechanics::new(&body.lattice, 1, 100.0);
        mechanics.step(&body.lattice, &mut motion, &passive(&body), &[DVec3::ZERO; 23], &Still).unwrap_err()
    };
    assert_eq!(fault(&|motion| motion.positions[2] = motion.positions[1]), Fault::Collapsed(4));
    assert!(matches!(fault(&|motion| motion.positions[2].x = f64::NAN), Fault::Pivot(_)));
    assert!(matches!(fault(&|motion| motion.velocities[21].x = f64::INFINITY), Fault::NonFinite(_)));
    let fast = fault(&|motion| motion.velocities.fill(DVec3::new(0.0, 400.0, 0.0)));
    assert!(matches!(fast, Fault::TooFast { .. }), "{fast}");
}

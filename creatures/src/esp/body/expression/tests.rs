//! Expression: how often a gene occurs (T-7), where its parts are (T-8), and what else hangs on them.

use super::*;
use crate::esp::body::Shape;
use crate::esp::body::tests::{body, edge, muscle, receptor, segment, side, swimmer};
use crate::math::from_rotation_vector;
use std::f64::consts::FRAC_PI_3;

#[track_caller]
fn near(found: DVec3, expected: [f64; 3]) {
    assert!((found - DVec3::from_array(expected)).length() < 1e-6, "{found} is not {expected:?}");
}

fn keys(phenotype: &Phenotype) -> Vec<Vec<(u32, u8)>> {
    let key = |part: &Part| part.key.iter().map(|&Step(edge, copy)| (edge.0, copy)).collect();
    phenotype.parts.iter().map(key).collect()
}

/// T-7: parts and joints of the example graphs.
#[test]
fn genes_occur_as_often_as_the_graph_says() {
    let segments = |limits: &[u8]| {
        limits.iter().enumerate().map(|(id, &limit)| segment(id as u32, limit)).collect::<Vec<_>>()
    };
    let terminal = |edge: Edge| Edge { terminal_only: true, ..edge };
    let symmetric = |edge: Edge| Edge { symmetric: true, ..edge };
    let to = |id, from, to| side(id, from, to, DVec3::Y);
    for (name, limits, edges, parts) in [
        ("a", vec![1, 1, 1], vec![edge(8, 0, 1), edge(9, 1, 2)], 3),
        (
            "b",
            vec![1, 1, 1],
            vec![edge(5, 0, 1), edge(6, 0, 1), edge(7, 0, 1), edge(8, 0, 1), edge(9, 1, 2)],
            9,
        ),
        ("c", vec![5], vec![edge(9, 0, 0)], 5),
        ("c'", vec![5, 1], vec![edge(8, 0, 0), terminal(edge(9, 0, 1))], 6),
        ("c''", vec![5, 1], vec![edge(8, 0, 0), edge(9, 0, 1)], 10),
        ("d", vec![3, 1, 1], vec![edge(7, 0, 0), symmetric(to(8, 0, 1)), to(9, 1, 2)], 15),
        (
            "d, with two edges",
            vec![3, 1, 1],
            vec![edge(6, 0, 0), to(7, 0, 1), side(8, 0, 1, -DVec3::Y), to(9, 1, 2)],
            15,
        ),
        ("e", vec![4], vec![edge(8, 0, 0), edge(9, 0, 0)], 15),
        ("f", vec![3], vec![symmetric(edge(9, 0, 0))], 7),
        ("h", vec![2, 2], vec![edge(8, 0, 1), edge(9, 1, 0)], 4),
        ("h, limits 3 and 1", vec![3, 1], vec![edge(8, 0, 1), edge(9, 1, 0)], 3),
    ] {
        let graph = body(segments(&limits), edges);
        graph.check().unwrap();
        let phenotype = graph.express().unwrap();
        assert_eq!(phenotype.parts.len(), parts, "{name}");
        let joints = phenotype.parts.iter().filter(|part| part.joint.is_some()).count();
        assert_eq!(joints, parts - 1, "{name}");
    }
}

/// T-7 (e), (g), EF-7
#[test]
fn a_graph_that_grows_past_the_cap_is_refused() {
    let twice = body(vec![segment(0, 5)], vec![edge(8, 0, 0), edge(9, 0, 0)]);
    assert_eq!(twice.develop(), Err(Illegal::TooManyParts), "31 parts");
    let thrice = body(vec![segment(0, 6)], vec![edge(7, 0, 0), edge(8, 0, 0), edge(9, 0, 0)]);
    assert_eq!(thrice.develop(), Err(Illegal::TooManyParts), "364 parts");
    let mut growth = Growth { body: &thrice, phenotype: Phenotype::default(), branches: vec![] };
    assert!(growth.plant().is_err());
    assert_eq!(growth.phenotype.parts.len(), PARTS_MAX, "nothing was built beyond");
}

/// E-9
#[test]
fn parts_come_depth_first_by_edge_and_copy() {
    let graph = body(
        vec![segment(0, 1), segment(1, 1), segment(2, 1)],
        vec![
            Edge { symmetric: true, ..side(3, 0, 1, DVec3::Y) },
            side(4, 1, 2, DVec3::Y),
            side(5, 0, 2, -DVec3::X),
        ],
    );
    let expected: [&[(u32, u8)]; 6] =
        [&[], &[(3, 0)], &[(3, 0), (4, 0)], &[(3, 1)], &[(3, 1), (4, 0)], &[(5, 0)]];
    assert_eq!(keys(&graph.develop().unwrap()), expected);
}

/// T-8
#[test]
fn a_child_is_placed_by_its_joint_and_mirrored_by_symmetry() {
    let mut child = segment(1, 1);
    child.shape = Shape::Capsule { radius: 0.1, half_length: 0.3 };
    let mut root = segment(0, 1);
    root.shape = Shape::Box([0.5, 0.3, 0.2]);
    let orientation = from_rotation_vector(DVec3::new(0.0, 0.0, FRAC_PI_3));
    let joint = Edge { parent_dir: DVec3::Y, orientation, symmetric: true, axis: DVec3::Y, ..edge(2, 0, 1) };
    let phenotype = body(vec![root, child], vec![joint]).develop().unwrap();
    let [_, left, right] = &phenotype.parts[..] else { panic!("three parts") };
    let joints = [left, right].map(|part| part.joint.unwrap());
    near(joints[0].parent_anchor, [0.0, 0.35, 0.0]);
    near(left.position, [0.225, 0.739711, 0.0]);
    near(joints[1].parent_anchor, [0.0, -0.35, 0.0]);
    near(right.position, [0.225, -0.739711, 0.0]);
    near(joints[1].axis, [0.0, -1.0, 0.0]);
    assert!(left.rotation.abs_diff_eq(orientation, 1e-12));
    assert!(right.rotation.abs_diff_eq(orientation.conjugate(), 1e-12));
    for (part, joint) in [left, right].into_iter().zip(joints) {
        near(part.place(joint.child_anchor), phenotype.parts[0].place(joint.parent_anchor).to_array());
    }
}

/// E-12: mirrored twice is not mirrored.
#[test]
fn parity_is_inherited_and_cancels() {
    let turn = from_rotation_vector(DVec3::new(0.3, -0.2, 0.4));
    let arm = |reflect_first, reflect_second| {
        let graph = body(
            vec![segment(0, 1), segment(1, 1), segment(2, 1)],
            vec![
                Edge { reflect: reflect_first, orientation: turn, ..edge(3, 0, 1) },
                Edge { reflect: reflect_second, orientation: turn, ..edge(4, 1, 2) },
            ],
        );
        graph.express().unwrap().parts
    };
    let (plain, mirrored, back) = (arm(false, false), arm(true, false), arm(true, true));
    for (part, image) in plain.iter().zip(&mirrored) {
        near(image.position, [part.position.x, -part.position.y, part.position.z]);
    }
    assert!(plain[2].position.y.abs() > 0.01, "there is something to mirror");
    let wrist = |parts: &[Part]| parts[1].rotation.conjugate() * parts[2].rotation;
    assert!(wrist(&plain).abs_diff_eq(turn, 1e-12) && wrist(&back).abs_diff_eq(turn, 1e-12));
    assert!(!wrist(&mirrored).abs_diff_eq(turn, 0.1), "the hand of a mirrored arm is mirrored");
}

/// E-13
#[test]
fn scales_multiply_down_the_path_and_lengths_stay_legal() {
    let mut root = segment(0, 4);
    root.shape = Shape::Box([0.2, 0.1, 0.05]);
    let graph = body(vec![root], vec![Edge { scale: 0.5, ..edge(1, 0, 0) }]);
    let shapes: Vec<Shape> = graph.develop().unwrap().parts.iter().map(|part| part.shape).collect();
    let expected = [[0.2, 0.1, 0.05], [0.1, 0.05, 0.03], [0.05, 0.03, 0.03], [0.03, 0.03, 0.03]];
    assert_eq!(shapes, expected.map(Shape::Box), "0.2 m four times halved, not clamped on the way");
}

/// E-16, E-24, T-10
#[test]
fn muscles_and_receptors_are_expressed_with_their_parts() {
    let mut graph = swimmer();
    graph.segments[1].shape = Shape::Box([0.1, 0.1, 0.05]);
    let phenotype = graph.develop().unwrap();
    let names: Vec<_> = phenotype.muscles.iter().map(|muscle| (muscle.key.gene.0, muscle.parts)).collect();
    assert_eq!(names, [(5, [0, 1]), (6, [1, 2]), (5, [0, 3]), (6, [3, 4])]);
    let instances = phenotype.instances();
    assert_eq!(instances.muscles[2].part, [Step(GeneId(3), 1)]);
    assert_eq!(instances.photos[1].part, [Step(GeneId(3), 1), Step(GeneId(4), 0)]);
    let shoulder = &phenotype.muscles[0];
    assert!((shoulder.force_max - 200.0).abs() < 1e-9, "half of 0.1 × 0.2 m at 2e4 N/m²: T-10");
    let expected = (0.3f64 * 0.3 + 0.05 * 0.05).sqrt(); // top of the torso to top of the thinner arm
    assert!((shoulder.rest_length - expected).abs() < 1e-12);
}

/// E-18
#[test]
fn a_muscle_that_is_too_short_is_left_out_and_named() {
    let mut joint = Edge { gap: 0.02, muscles: vec![muscle(2), muscle(3)], ..edge(4, 0, 1) };
    joint.muscles[0].parent_dir = DVec3::X;
    joint.muscles[0].child_dir = -DVec3::X; // straight across: 0.04 m
    let phenotype = body(vec![segment(0, 1), segment(1, 1)], vec![joint]).develop().unwrap();
    assert_eq!(phenotype.muscles.len(), 1);
    assert_eq!(phenotype.muscles[0].key.gene, GeneId(3));
    assert_eq!(phenotype.too_short, [InstanceKey { part: vec![Step(GeneId(4), 0)], gene: GeneId(2) }]);
}

/// E-12: vectors of the child's genes are mirrored with it.
#[test]
fn receptors_of_a_mirrored_part_look_to_the_other_side() {
    let mut graph = swimmer();
    graph.segments[2].receptors[0].direction = DVec3::Y;
    let phenotype = graph.develop().unwrap();
    let axes: Vec<DVec3> = phenotype.receptors.iter().map(|receptor| receptor.axis).collect();
    assert_eq!(axes, [DVec3::Y, -DVec3::Y]);
    assert_eq!(phenotype.receptors[1].point, DVec3::new(0.0, -0.1, 0.0));
}

/// T-13: names are of paths, so that a gene that is added renames nothing.
#[test]
fn an_added_muscle_or_receptor_changes_nothing_else() {
    let before = swimmer().develop().unwrap();
    let mut graph = swimmer();
    graph.edges[0].muscles.push(muscle(20));
    graph.segments[0].receptors.push(receptor(21));
    graph.next_id = 22;
    graph.check().unwrap();
    let after = graph.develop().unwrap();
    assert_eq!(after.parts, before.parts);
    let known = after.muscles.iter().filter(|muscle| muscle.key.gene != GeneId(20));
    assert!(known.eq(&before.muscles));
    let known = after.receptors.iter().filter(|receptor| receptor.key.gene != GeneId(21));
    assert!(known.eq(&before.receptors));
}

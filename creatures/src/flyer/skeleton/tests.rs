//! T-2..T-4, X-6 and the mirror of F-15, on creatures built by hand.

use super::*;
use crate::flyer::{Effector, Settings};
use crate::random::stream;

const TOLERANCE: f64 = 1e-4;

/// A wing segment of length, lpercent, θ and Ψ in degrees, without a brain.
pub(crate) fn wing(length: f64, lpercent: u8, theta: f64, psi: f64) -> Node {
    Node {
        length,
        radius: 0.5,
        lpercent,
        theta: theta.to_radians(),
        psi: psi.to_radians(),
        neurons: vec![],
        effectors: vec![Effector { inputs: vec![] }],
    }
}

/// A creature without a brain: a body of length and radius, a wing-root of length, wing segments.
pub(crate) fn creature(body: (f64, f64), wing_root: f64, segments: &[Node]) -> Genotype {
    let bone = |length, radius, effectors| Node {
        length,
        radius,
        lpercent: 0,
        theta: 0.0,
        psi: 0.0,
        neurons: vec![],
        effectors: vec![Effector { inputs: vec![] }; effectors],
    };
    let mut nodes = vec![bone(body.0, body.1, 0), bone(wing_root, 0.5, 3)];
    nodes.extend_from_slice(segments);
    let genotype = Genotype { nodes };
    Genotype::decode(&genotype.encode()).expect("a test's creature is legal")
}

/// The creature of T-2.
pub(crate) fn worked_example() -> Genotype {
    creature((30.0, 2.0), 20.0, &[wing(40.0, 1, 30.0, 60.0), wing(25.0, 0, -20.0, 45.0)])
}

fn close(found: DVec3, expected: [f64; 3]) {
    assert!((found - DVec3::from_array(expected)).abs().max_element() <= TOLERANCE, "{found} {expected:?}");
}

/// T-2
#[test]
fn a_creature_is_built_as_in_the_worked_example() {
    let bones = grow(&worked_example(), 250.0);
    assert_eq!(bones.len(), 6);
    let [body, root, left_1, left_2, right_1, right_2] = bones[..] else { unreachable!("six bones") };
    close(body.centre, [0.0, 250.0, 0.0]);
    close(root.start(), [0.0, 250.0, -15.0]);
    close(root.end(), [0.0, 250.0, 5.0]);

    close(left_1.start(), [0.0, 250.0, 5.0]);
    close(left_1.end(), [30.0, 267.3205, -15.0]);
    close(left_1.axes.x_axis, [0.4330, 0.25, 0.8660]);
    close(left_1.axes.y_axis, [0.5, -0.8660, 0.0]);
    close(left_1.axes.z_axis, [0.75, 0.4330, -0.5]);
    close(left_2.start(), [0.0, 250.0, 5.0]);
    close(left_2.end(), [17.4282, 267.0436, 10.5472]);
    close(left_2.axes.x_axis, [-0.3635, 0.0694, 0.9290]);
    close(right_1.end(), [-30.0, 267.3205, -15.0]);
    close(right_1.axes.x_axis, [-0.4330, 0.25, 0.8660]);
    close(right_1.axes.y_axis, [0.5, 0.8660, 0.0]);
    close(right_2.end(), [-17.4282, 267.0436, 10.5472]);

    let axis = |bone: &Bone| {
        let hold = bone.hold.unwrap();
        bones[hold.parent].axes * hold.hinge.unwrap()
    };
    close(axis(&left_1), [0.0, 0.0, 1.0]);
    close(axis(&left_2), [0.75, 0.4330, -0.5]);
    close(axis(&right_1), [0.0, 0.0, -1.0]);
    close(axis(&right_2), [0.75, -0.4330, 0.5]);
    assert_eq!(root.hold.unwrap().hinge, None);

    let films: Vec<Film> = films(&bones).collect();
    for (film, area) in films.iter().zip([346.4102, 353.5534, 346.4102, 353.5534]) {
        assert!((film.area() - area).abs() < TOLERANCE);
    }
    close(films[0].corners[2], [0.0, 250.0, -15.0]);
    close(films[1].corners[2], [30.0, 267.3205, -15.0]);
    assert!(!intersects_itself(&bones));
    assert!((span(&bones) - 60.0).abs() < TOLERANCE);
}

/// T-3: a hinge that turns by q moves its wing as a neutral azimuth of θ + q would hold it (F-16).
#[test]
fn a_turned_hinge_raises_both_wings_alike() {
    let mut genotype = worked_example();
    genotype.nodes[2].theta += 10f64.to_radians();
    let bones = grow(&genotype, 250.0);
    close(bones[2].end(), [26.5366, 272.2668, -15.0]);
    close(bones[4].end(), [-26.5366, 272.2668, -15.0]);
    close(bones[3].end(), [14.2038, 269.8111, 10.5472]);
}

/// T-4
#[test]
fn films_that_cross_at_the_start_are_found() {
    let intersects =
        |segments: &[Node]| intersects_itself(&grow(&creature((30.0, 2.0), 20.0, segments), 250.0));
    assert!(intersects(&[wing(40.0, 0, 90.0, 60.0)]), "both films coincide");
    assert!(!intersects(&[wing(40.0, 0, 89.0, 60.0)]));
    let inner = wing(20.0, 0, 60.0, 90.0);
    assert!(intersects(&[inner.clone(), wing(60.0, 1, 90.0, 60.0)]), "left 2 passes right 2");
    assert!(!intersects(&[inner, wing(60.0, 1, -90.0, 60.0)]));
}

/// F-15: for any genotype, and its axes are a right-handed frame.
#[test]
fn the_right_wing_is_the_mirror_image_of_the_left() {
    for place in 0..200 {
        let mut draws = stream(1, [0, 0, place], "skeleton test");
        let genotype = Genotype::random(&Settings::default(), &mut draws);
        let bones = grow(&genotype, 250.0);
        assert_eq!(bones.len(), 2 + 2 * genotype.segments());
        let mirrored = |v: DVec3| DVec3::new(-v.x, v.y, v.z);
        let (left, right) = bones[2..].split_at(genotype.segments());
        for (left, right) in left.iter().zip(right) {
            let close = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-9, "{a} {b}");
            close(mirrored(left.axes.x_axis), right.axes.x_axis);
            close(mirrored(left.axes.y_axis), -right.axes.y_axis);
            close(mirrored(left.axes.z_axis), right.axes.z_axis);
            close(mirrored(left.end()), right.end());
            for bone in [left, right] {
                assert!((bone.axes.determinant() - 1.0).abs() < 1e-9);
                let hold = bone.hold.unwrap();
                let parent = &bones[hold.parent];
                close(parent.centre + parent.axes.z_axis * hold.at, bone.start());
            }
        }
    }
}

///
#[test]
fn a_bone_along_its_parent_has_no_film_and_a_long_wing_root_is_cut() {
    let genotype = creature((30.0, 2.0), 70.0, &[wing(40.0, 0, 10.0, 0.0)]);
    let bones = grow(&genotype, 250.0);
    assert_eq!(bones[1].length, 30.0);
    assert_eq!(films(&bones).count(), 0);
    assert_eq!(span(&bones), 0.0);
    assert!(!intersects_itself(&bones));
}

/// T-12: motor torques of pairs.
#[test]
fn a_motor_is_as_strong_as_its_bones_are_heavy_and_long() {
    use crate::physics::articulated::Body;
    let torque = |(r, l): (f64, f64), (radius, length): (f64, f64)| {
        let mass = |radius, length| Body::capsule(radius, length, 0.01, DVec3::ZERO).mass;
        motor_torque(1.0, (mass(r, l), mass(radius, length)), (l, length))
    };
    let cases = [
        ((0.5, 20.0), (0.5, 40.0), 385.368699),
        ((0.5, 40.0), (0.5, 25.0), 520.980782),
        ((2.0, 30.0), (0.5, 20.0), 2560.398013),
    ];
    for (parent, child, expected) in cases {
        let found = torque(parent, child);
        assert!((found - expected).abs() < 1e-5, "{found} is not {expected}");
    }
}

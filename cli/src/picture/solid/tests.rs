use super::*;
use creatures::record::Scene;

fn side() -> View {
    View::side(&Scene {
        length_unit: "m".into(),
        time_unit: "s".into(),
        step: 0.1,
        up: DVec3::Z,
        forward: DVec3::Y,
        creatures: vec![],
        parts: vec![],
        props: vec![],
        muscles: vec![],
        cords: vec![],
    })
}

fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

#[test]
fn of_a_box_the_faces_that_look_this_way_are_seen_at_their_size() {
    let shape = Shape::Box { half: DVec3::new(1.0, 2.0, 3.0) };
    let level = faces(&shape, &Pose::at(DVec3::new(5.0, 1.0, 0.0)), &side());
    assert_eq!(level.len(), 1, "the others are seen from their edges or from behind");
    assert!((area(&level[0].corners).abs() - 24.0).abs() < 1e-9);
    assert_eq!(level[0].nearness, 6.0, "the side looks along x, and the near face is at x = 6");
    let turned =
        Pose::Rigid { position: DVec3::ZERO, orientation: DQuat::from_xyzw(0.1, 0.2, 0.3, 0.927362) };
    assert_eq!(faces(&shape, &turned, &side()).len(), 3);
}

#[test]
fn a_capsule_across_the_view_is_as_long_as_it_is() {
    let shape = Shape::Capsule { radius: 0.5, half_length: 2.0 };
    let [face] = &faces(&shape, &Pose::at(DVec3::ZERO), &side())[..] else { panic!("one outline") };
    let (low, high) = extent(&face.corners);
    assert!((high - low - DVec2::new(1.0, 5.0)).length() < 1e-9);
    let whole = 4.0 + std::f64::consts::PI * 0.25;
    assert!((area(&face.corners) - whole).abs() < 0.02 * whole, "{}", area(&face.corners));
}

#[test]
fn a_ball_in_front_of_another_is_nearer_and_a_film_shows_from_both_sides() {
    let ball = |x: f64| faces(&Shape::Sphere { radius: 1.0 }, &Pose::at(DVec3::X * x), &side())[0].nearness;
    assert!(ball(2.0) > ball(-2.0));
    let plate = |corners: Vec<DVec3>| faces(&Shape::Plate { corners }, &Pose::at(DVec3::ZERO), &side());
    let (front, back) = (vec![DVec3::ZERO, DVec3::Y, DVec3::Z], vec![DVec3::Z, DVec3::Y, DVec3::ZERO]);
    let (front, back) = (plate(front), plate(back));
    assert_eq!((front.len(), back.len()), (1, 1));
    assert_eq!(front[0].light, back[0].light);
}

#[test]
fn a_closed_skin_covers_its_shadow_once() {
    let nodes = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let seen = faces(&Shape::Skin { triangles }, &Pose::Nodes(nodes), &side());
    let covered: f64 = seen.iter().map(|face| area(&face.corners).abs()).sum();
    assert!((covered - 0.5).abs() < 1e-9, "{covered}");
}

#[test]
fn what_is_absent_or_lacks_its_nodes_is_not_drawn() {
    let ball = Shape::Sphere { radius: 1.0 };
    assert_eq!(faces(&ball, &Pose::Absent, &side()), []);
    assert_eq!(extremes(&ball, &Pose::Absent), []);
    let skin = Shape::Skin { triangles: vec![[0, 1, 9]] };
    assert_eq!(faces(&skin, &Pose::at(DVec3::ZERO), &side()), []);
}

fn extent(corners: &[DVec2]) -> (DVec2, DVec2) {
    corners
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &at| (low.min(at), high.max(at)))
}

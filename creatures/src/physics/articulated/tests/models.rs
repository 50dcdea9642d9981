//! Models that are refused, each with its place.

use super::articulated::{Body, Joint, JointKind, ModelBuilder, ModelError, Settings};
use super::bodies::{earth, joint, space};
use glam::DVec3;

fn cube(x: f64) -> Body {
    Body::cuboid(DVec3::splat(0.1), 1000.0, DVec3::X * x)
}

fn hinge() -> Joint {
    joint(JointKind::Hinge { axis: DVec3::Z }, DVec3::X * 0.05, DVec3::X * -0.05, None)
}

/// What a model that differs from a legal one in one thing is refused for.
fn refusal(settings: Settings, child: Body, joint: Joint) -> String {
    let mut model = ModelBuilder::new(settings);
    let root = model.root(cube(0.0));
    match model.attach(root, child, joint) {
        Err(error) => error.to_string(),
        Ok(_) => model.build().expect_err("an illegal model").to_string(),
    }
}

#[test]
fn each_illegal_number_is_refused_with_its_place() {
    let massless = Body { mass: 0.0, ..cube(0.1) };
    assert_eq!(refusal(space(), massless, hinge()), "body 1: mass 0 is not positive and finite");
    let thin = Body { inertia: DVec3::new(1.0, f64::NAN, 1.0), ..cube(0.1) };
    assert_eq!(refusal(space(), thin, hinge()), "body 1: moment of inertia NaN is not positive and finite");
    let slippery = Body { friction: -1.0, ..cube(0.1) };
    assert_eq!(refusal(space(), slippery, hinge()), "body 1: friction -1 is not finite and at least 0");
    let long = Joint { kind: JointKind::Hinge { axis: DVec3::Z * 2.0 }, ..hinge() };
    assert_eq!(refusal(space(), cube(0.1), long), "joint 0: axis of length 2 is not 1");
    let crossed = Joint { stops: [Some((1.0, -1.0)), None, None], ..hinge() };
    assert_eq!(refusal(space(), cube(0.1), crossed), "joint 0: low stop 1 is not at most the high one");
    let surplus = Joint { stops: [None, Some((-1.0, 1.0)), None], ..hinge() };
    assert_eq!(
        refusal(space(), cube(0.1), surplus),
        "joint 0: stop of degree of freedom 1 is not one that it has"
    );
    let mut soft = earth();
    soft.ground.as_mut().unwrap().stiffness = 0.0;
    assert_eq!(refusal(soft, cube(0.1), hinge()), "ground: stiffness 0 is not positive and finite");
    let eager = Settings { erp: 1.5, ..space() };
    assert_eq!(refusal(eager, cube(0.1), hinge()), "settings: erp 1.5 is not within [0, 1]");
}

#[test]
fn anchors_have_to_meet_except_along_a_sliders_axis() {
    let mut model = ModelBuilder::new(space());
    let root = model.root(cube(0.0));
    let apart = model.attach(root, cube(0.2), hinge()).unwrap_err();
    assert!(matches!(apart, ModelError::Apart { joint: 0, gap } if (gap - 0.1).abs() < 1e-12), "{apart}");
    let slider = Joint { kind: JointKind::Slider { axis: DVec3::X }, ..hinge() };
    let (_, slider) = model.attach(root, cube(0.2), slider).unwrap();
    let world = model.build().unwrap();
    assert!((world.coordinate(slider, 0) - 0.1).abs() < 1e-12);
}

#[test]
fn a_model_is_one_tree() {
    let mut model = ModelBuilder::new(space());
    assert_eq!(model.build().unwrap_err(), ModelError::Roots { found: 0 });
    let root = model.root(cube(0.0));
    let (child, _) = model.attach(root, cube(0.1), hinge()).unwrap();
    let mut other = ModelBuilder::new(space());
    other.root(cube(0.0));
    let stranger = other.attach(child, cube(0.2), hinge()).unwrap_err();
    assert_eq!(stranger, ModelError::Parent { body: 1, parent: 1 });
    model.root(cube(0.0));
    assert_eq!(model.build().unwrap_err(), ModelError::Roots { found: 2 });
}

//! Creatures to test with: the four walkers of G-51 and a flyer-like chain. No controllers, no tasks.

use super::articulated::{
    Body, BodyId, Ground, Joint, JointId, JointKind, ModelBuilder, Motor, Settings, World,
};
use glam::DVec3;

/// A creature's world, and the joints in the order of G-51.
pub(super) struct Creature {
    pub(super) world: World,
    pub(super) joints: Vec<JointId>,
    pub(super) bodies: Vec<BodyId>,
    /// Each joint with the place of its parent.
    pub(super) specs: Vec<(usize, Joint)>,
}

/// Most a hinge, a slider and one axis of a ball may give, N·m or N (G-18).
pub(super) const HINGE_EFFORT: f64 = 0.0784532;
pub(super) const SLIDER_EFFORT: f64 = 11.76798;
pub(super) const BALL_EFFORT: f64 = 0.0588399;

pub(super) const LIMB_FRICTION: f64 = 0.9;
pub(super) const TORSO_FRICTION: f64 = 0.3;

impl Creature {
    /// Drives a degree of freedom by a command in [−1, 1] (G-18).
    pub(super) fn command(&mut self, joint: usize, dof: usize, command: f64) {
        let id = self.joints[joint];
        let command = command.clamp(-1.0, 1.0);
        let motor = match (self.world.degrees(id), self.is_slider(joint)) {
            (3, _) => Motor { rate: 10.0 * command, effort: BALL_EFFORT },
            (_, true) => Motor { rate: command, effort: SLIDER_EFFORT },
            _ => Motor { rate: 10.0 * command, effort: HINGE_EFFORT },
        };
        self.world.drive(id, dof, motor);
    }

    /// Drives every degree of freedom by a command of its own.
    pub(super) fn command_all(&mut self, mut command: impl FnMut() -> f64) {
        for joint in 0..self.joints.len() {
            for dof in 0..self.world.degrees(self.joints[joint]) {
                self.command(joint, dof, command());
            }
        }
    }

    fn is_slider(&self, joint: usize) -> bool {
        matches!(self.specs[joint].1.kind, JointKind::Slider { .. })
    }

    pub(super) fn torso(&self) -> DVec3 {
        self.world.position(self.bodies[0])
    }
}

/// Earth's gravity over asphalt (G-47, G-48).
pub(super) fn earth() -> Settings {
    Settings { gravity: DVec3::new(0.0, 0.0, -9.81), erp: 0.2, ground: Some(Ground::level(0.9)) }
}

/// No gravity, no ground.
pub(super) fn space() -> Settings {
    Settings { gravity: DVec3::ZERO, erp: 0.2, ground: None }
}

/// Grows a creature part by part.
pub(super) struct Growth {
    pub(super) model: ModelBuilder,
    pub(super) bodies: Vec<(BodyId, Body)>,
    pub(super) joints: Vec<JointId>,
    pub(super) specs: Vec<(usize, Joint)>,
}

impl Growth {
    pub(super) fn new(settings: Settings, root: Body) -> Growth {
        let mut model = ModelBuilder::new(settings);
        let id = model.root(root);
        Growth { model, bodies: vec![(id, root)], joints: vec![], specs: vec![] }
    }

    /// Attaches a box, axes along the parent's start axes, and returns its place.
    pub(super) fn limb(&mut self, parent: usize, size: DVec3, density: f64, joint: Joint) -> usize {
        self.specs.push((parent, joint));
        let (parent, base) = self.bodies[parent];
        let position = base.position + joint.parent_anchor - joint.child_anchor;
        let body = Body { friction: LIMB_FRICTION, ..Body::cuboid(size, density, position) };
        let (id, joint) = self.model.attach(parent, body, joint).expect("a legal joint");
        self.bodies.push((id, body));
        self.joints.push(joint);
        self.bodies.len() - 1
    }

    pub(super) fn done(self) -> Creature {
        let world = self.model.build().expect("a legal model");
        let bodies = self.bodies.into_iter().map(|(id, _)| id).collect();
        Creature { world, joints: self.joints, bodies, specs: self.specs }
    }
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

pub(super) fn joint(
    kind: JointKind,
    parent_anchor: DVec3,
    child_anchor: DVec3,
    stop: Option<(f64, f64)>,
) -> Joint {
    Joint { kind, parent_anchor, child_anchor, stops: [stop, None, None] }
}

fn torso(size: DVec3, density: f64, lowest: f64) -> Body {
    // The lowest point of the creature starts 1 mm above the ground.
    Body { friction: TORSO_FRICTION, ..Body::cuboid(size, density, v(0.0, 0.0, lowest + 0.001)) }
}

pub(super) fn crawler(settings: Settings) -> Creature {
    let mut growth = Growth::new(settings, torso(v(0.12, 0.20, 0.05), 100.0, 0.025));
    for side in [-1.0, 1.0] {
        let hinge = JointKind::Hinge { axis: DVec3::X };
        let shoulder = joint(hinge, v(0.045 * side, -0.10, 0.0), v(0.0, 0.075, 0.0), None);
        growth.limb(0, v(0.02, 0.15, 0.02), 300.0, shoulder);
    }
    growth.done()
}

pub(super) fn arm(settings: Settings) -> Creature {
    let mut growth = Growth::new(settings, torso(v(0.12, 0.24, 0.04), 150.0, 0.02));
    let hinge = JointKind::Hinge { axis: DVec3::X };
    let (elbow, wrist) = (2.0 * std::f64::consts::FRAC_PI_3, std::f64::consts::FRAC_PI_2);
    for side in [-1.0, 1.0] {
        let shoulder = joint(hinge, v(0.04 * side, -0.09, 0.03), v(0.0, 0.045, 0.0), None);
        let upper = growth.limb(0, v(0.02, 0.09, 0.02), 200.0, shoulder);
        let bend = joint(hinge, v(0.0, -0.045, 0.0), v(0.0, 0.045, 0.0), Some((-elbow, elbow)));
        let fore = growth.limb(upper, v(0.02, 0.09, 0.02), 200.0, bend);
        let twist = joint(hinge, v(0.0, -0.045, 0.0), v(0.0, 0.03, 0.0), Some((-wrist, wrist)));
        growth.limb(fore, v(0.06, 0.06, 0.01), 200.0, twist);
    }
    growth.done()
}

pub(super) fn hopper(settings: Settings) -> Creature {
    let mut growth = Growth::new(settings, torso(v(0.12, 0.12, 0.06), 150.0, 0.15));
    for side in [-1.0, 1.0] {
        let hinge = JointKind::Hinge { axis: DVec3::X };
        let hip = joint(hinge, v(0.045 * side, 0.0, -0.03), v(0.0, 0.0, 0.04), None);
        let thigh = growth.limb(0, v(0.03, 0.03, 0.08), 300.0, hip);
        let slider = JointKind::Slider { axis: v(0.0, 0.0, -1.0) };
        let leg = joint(slider, v(0.0, 0.0, -0.04), DVec3::ZERO, Some((0.0, 0.08)));
        growth.limb(thigh, v(0.024, 0.06, 0.08), 300.0, leg);
    }
    growth.done()
}

pub(super) fn runner(settings: Settings) -> Creature {
    let mut growth = Growth::new(settings, torso(v(0.08, 0.16, 0.04), 100.0, 0.02));
    for side in [-1.0, 1.0] {
        let shoulder = joint(JointKind::Ball, v(0.04 * side, -0.04, 0.01), v(-0.11 * side, 0.0, 0.0), None);
        growth.limb(0, v(0.22, 0.02, 0.02), 200.0, shoulder);
    }
    growth.done()
}

/// Ten bodies of a flyer's size: a body, a wing-root on a ball, and two wings of four hinged segments.
pub(super) fn flyer(settings: Settings) -> Creature {
    let body = Body { shape: None, ..Body::capsule(2.0, 30.0, 0.01, v(0.0, 250.0, 0.0)) };
    let mut growth = Growth::new(settings, body);
    let bone = |length: f64, position: DVec3, orientation| Body {
        shape: None,
        orientation,
        ..Body::capsule(0.5, length, 0.01, position)
    };
    let mut attach = |parent: usize, body: Body, joint: Joint| {
        growth.specs.push((parent, joint));
        let (id, joint) = growth.model.attach(growth.bodies[parent].0, body, joint).expect("a legal joint");
        growth.bodies.push((id, body));
        growth.joints.push(joint);
        growth.bodies.len() - 1
    };
    let stops = |limit: f64| Some((-limit, limit));
    let ball = Joint {
        kind: JointKind::Ball,
        parent_anchor: v(0.0, 0.0, -15.0),
        child_anchor: v(0.0, 0.0, -10.0),
        stops: [stops(0.349); 3],
    };
    let root = attach(0, bone(20.0, v(0.0, 250.0, -5.0), glam::DQuat::IDENTITY), ball);
    for side in [1.0, -1.0] {
        let mut parent = (root, v(0.0, 0.0, -10.0), v(0.0, 250.0, -15.0));
        for (k, length) in [30.0, 25.0, 20.0, 15.0].into_iter().enumerate() {
            let ahead = v(side, if k % 2 == 0 { 0.2 } else { -0.2 }, 0.1).normalize();
            let orientation = glam::DQuat::from_rotation_arc(DVec3::Z, ahead);
            let child = bone(length, parent.2 + ahead * (0.5 * length), orientation);
            let child_anchor = v(0.0, 0.0, -0.5 * length);
            let kind = JointKind::Hinge { axis: DVec3::Z };
            let kind = if k == 0 { kind } else { JointKind::Hinge { axis: DVec3::Y } };
            let place = attach(parent.0, child, joint(kind, parent.1, child_anchor, stops(1.047)));
            parent = (place, v(0.0, 0.0, 0.5 * length), parent.2 + ahead * length);
        }
    }
    growth.done()
}

//! Models: bodies and the joints that make a tree of them, checked once, so that nothing behind this door
//! checks again. It moves nothing.

use super::{Ground, World};
use glam::{DQuat, DVec3};
use std::f64::consts::PI;

/// A body of one [`World`], by its place in the order of attachment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct BodyId(pub(super) usize);

/// A joint of one [`World`], by its place in the order of attachment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct JointId(pub(super) usize);

impl BodyId {
    /// Its place in the order of attachment; the root is 0.
    pub fn index(self) -> usize {
        self.0
    }
}

impl JointId {
    /// Its place in the order of attachment.
    pub fn index(self) -> usize {
        self.0
    }
}

/// What touches the ground. Bodies do not touch each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A box; its eight corners touch.
    Cuboid {
        /// Half its size along the body's axes, m.
        half: DVec3,
    },
    /// A capped cylinder along the body's z; its two caps touch.
    Capsule {
        /// Radius, m.
        radius: f64,
        /// Half the distance of the caps' centres, m.
        half_length: f64,
    },
}

/// A rigid body as it starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// kg.
    pub mass: f64,
    /// Principal moments of inertia about the centre of mass, kg·m², along the body's axes.
    pub inertia: DVec3,
    /// Centre of mass, m, world frame.
    pub position: DVec3,
    /// Body axes to world axes, unit length.
    pub orientation: DQuat,
    /// What of it touches the ground; nothing if none.
    pub shape: Option<Shape>,
    /// Coulomb's coefficient; the lesser of this and the ground's holds (G-48).
    pub friction: f64,
}

impl Body {
    /// A solid box of a full size in m and a density in kg/m³, axes along the world's, friction 1.
    pub fn cuboid(size: DVec3, density: f64, position: DVec3) -> Body {
        let mass = density * size.x * size.y * size.z;
        let square = size * size;
        Body {
            mass,
            inertia: DVec3::new(square.y + square.z, square.x + square.z, square.x + square.y)
                * (mass / 12.0),
            position,
            orientation: DQuat::IDENTITY,
            shape: Some(Shape::Cuboid { half: 0.5 * size }),
            friction: 1.0,
        }
    }

    /// A solid capped cylinder along z, of a radius and a length without the caps in m and a density in
    /// kg/m³, axes along the world's, friction 1 (flyer F-19).
    pub fn capsule(radius: f64, length: f64, density: f64, position: DVec3) -> Body {
        let (r2, l) = (radius * radius, length);
        let cylinder = density * PI * r2 * l;
        let caps = density * (4.0 / 3.0) * PI * r2 * radius;
        let across = cylinder * (r2 / 4.0 + l * l / 12.0)
            + caps * (2.0 * r2 / 5.0 + 3.0 * radius * l / 8.0 + l * l / 4.0);
        let along = (cylinder / 2.0 + 2.0 * caps / 5.0) * r2;
        Body {
            mass: cylinder + caps,
            inertia: DVec3::new(across, across, along),
            position,
            orientation: DQuat::IDENTITY,
            shape: Some(Shape::Capsule { radius, half_length: 0.5 * length }),
            friction: 1.0,
        }
    }
}

/// Which relative motions a joint leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// None.
    Fixed,
    /// Rotation about one axis.
    Hinge {
        /// Unit length, in the parent's axes.
        axis: DVec3,
    },
    /// Rotation about all axes; its degrees of freedom are the parent's x, y and z.
    Ball,
    /// Translation along one axis.
    Slider {
        /// Unit length, in the parent's axes.
        axis: DVec3,
    },
}

impl JointKind {
    /// How many degrees of freedom it leaves.
    pub fn degrees(&self) -> usize {
        match self {
            JointKind::Fixed => 0,
            JointKind::Hinge { .. } | JointKind::Slider { .. } => 1,
            JointKind::Ball => 3,
        }
    }
}

/// A joint between a body and its parent. The pose in which the two start is its coordinate 0, except that
/// a slider starts at the distance of its anchors along the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Which motions it leaves.
    pub kind: JointKind,
    /// In the parent's axes from its centre of mass, m.
    pub parent_anchor: DVec3,
    /// In the child's axes from its centre of mass, m.
    pub child_anchor: DVec3,
    /// Lowest and highest coordinate of each degree of freedom, rad or m.
    pub stops: [Option<(f64, f64)>; 3],
}

/// What holds for a whole world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// m/s², world frame.
    pub gravity: DVec3,
    /// The share of a joint's drift, or of a coordinate's excess beyond its stop, that one step takes back,
    /// within [0, 1] (flyer F-36).
    pub erp: f64,
    /// The ground, if there is one.
    pub ground: Option<Ground>,
}

/// When a stop begins to act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StopRule {
    /// In the step that would pass it: the coordinate comes to lie exactly on the stop, whatever the step.
    #[default]
    Anticipated,
    /// In the first step that starts on it or beyond, so that a coordinate may pass it by one step's motion
    /// (flyer F-37).
    Reached,
}

/// Why a model is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A world holds exactly one tree.
    #[error("a model has exactly one root, found {found}")]
    Roots {
        /// How often a root was given.
        found: usize,
    },
    /// A parent that was not attached before its child.
    #[error("body {body}: parent {parent} is not a body of this model")]
    Parent {
        /// The body that was to be attached.
        body: usize,
        /// The parent it names.
        parent: usize,
    },
    /// The two anchors do not meet in the start pose.
    #[error("joint {joint}: its anchors start {gap} m apart")]
    Apart {
        /// The joint's place in the order of attachment.
        joint: usize,
        /// Their distance off the joint's free axis, m.
        gap: f64,
    },
    /// A number that is not what it has to be.
    #[error("{part}: {quantity} {found} is not {wanted}")]
    Quantity {
        /// `body 2`, `joint 1`, `settings` or `ground`.
        part: String,
        /// Which quantity.
        quantity: &'static str,
        /// Its value.
        found: f64,
        /// What it has to be.
        wanted: &'static str,
    },
}

/// Builds a tree of bodies from the root outwards.
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    pub(super) settings: Settings,
    pub(super) stop_rule: StopRule,
    pub(super) fixture: bool,
    pub(super) bodies: Vec<Body>,
    /// Joint `k` attaches body `k + 1` to a body of a lower index.
    pub(super) joints: Vec<(usize, Joint)>,
    roots: usize,
}

impl ModelBuilder {
    /// An empty model.
    pub fn new(settings: Settings) -> ModelBuilder {
        ModelBuilder {
            settings,
            stop_rule: StopRule::default(),
            fixture: false,
            bodies: vec![],
            joints: vec![],
            roots: 0,
        }
    }

    /// Chooses when stops begin to act.
    pub fn stop_rule(&mut self, rule: StopRule) -> &mut ModelBuilder {
        self.stop_rule = rule;
        self
    }

    /// The body from which the tree grows; give it first, and once.
    pub fn root(&mut self, body: Body) -> BodyId {
        self.roots += 1;
        self.bodies = vec![body];
        self.joints.clear();
        self.fixture = false;
        BodyId(0)
    }

    /// A root that never moves, such as the stand of a pendulum.
    pub fn fixture(&mut self, body: Body) -> BodyId {
        let id = self.root(body);
        self.fixture = true;
        id
    }

    /// Hangs a body on another by a joint.
    ///
    /// # Errors
    /// A parent of another model, an axis that is not of unit length, anchors that do not meet, stops that
    /// are out of order or belong to no degree of freedom.
    pub fn attach(
        &mut self,
        parent: BodyId,
        body: Body,
        joint: Joint,
    ) -> Result<(BodyId, JointId), ModelError> {
        let index = self.bodies.len();
        let Some(base) = self.bodies.get(parent.0) else {
            return Err(ModelError::Parent { body: index, parent: parent.0 });
        };
        check_joint(self.joints.len(), base, &body, &joint)?;
        self.bodies.push(body);
        self.joints.push((parent.0, joint));
        Ok((BodyId(index), JointId(index - 1)))
    }

    /// A world in which the model rests in its start pose, every joint limp.
    ///
    /// # Errors
    /// No root or several, or the first number that is not what it has to be, with its place.
    pub fn build(&self) -> Result<World, ModelError> {
        if self.roots != 1 {
            return Err(ModelError::Roots { found: self.roots });
        }
        check_settings(&self.settings)?;
        for (index, body) in self.bodies.iter().enumerate() {
            check_body(index, body)?;
        }
        Ok(World::new(self))
    }
}

/// Reports a quantity that is not what it has to be.
fn require(
    holds: bool,
    part: &dyn Fn() -> String,
    quantity: &'static str,
    found: f64,
    wanted: &'static str,
) -> Result<(), ModelError> {
    if holds { Ok(()) } else { Err(ModelError::Quantity { part: part(), quantity, found, wanted }) }
}

fn is_positive(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}

fn is_share(x: f64) -> bool {
    (0.0..=1.0).contains(&x)
}

fn is_unit(square: f64) -> bool {
    (square - 1.0).abs() < 1e-9
}

fn check_settings(settings: &Settings) -> Result<(), ModelError> {
    let part = || "settings".to_owned();
    let gravity = settings.gravity.length();
    require(gravity.is_finite(), &part, "gravity", gravity, "finite")?;
    require(is_share(settings.erp), &part, "erp", settings.erp, "within [0, 1]")?;
    let Some(ground) = &settings.ground else { return Ok(()) };
    let part = || "ground".to_owned();
    let normal = ground.normal.length();
    require(is_unit(normal * normal), &part, "normal of length", normal, "1")?;
    require(ground.offset.is_finite(), &part, "offset", ground.offset, "finite")?;
    let friction = ground.friction;
    require(friction >= 0.0 && friction.is_finite(), &part, "friction", friction, "finite and at least 0")?;
    require(is_positive(ground.stiffness), &part, "stiffness", ground.stiffness, "positive and finite")?;
    let damping = ground.damping;
    require(damping >= 0.0 && damping.is_finite(), &part, "damping", damping, "finite and at least 0")?;
    require(is_positive(ground.slip_speed), &part, "slip speed", ground.slip_speed, "positive and finite")
}

fn check_body(index: usize, body: &Body) -> Result<(), ModelError> {
    let part = || format!("body {index}");
    let positive = "positive and finite";
    require(is_positive(body.mass), &part, "mass", body.mass, positive)?;
    for moment in body.inertia.to_array() {
        require(is_positive(moment), &part, "moment of inertia", moment, positive)?;
    }
    for coordinate in body.position.to_array() {
        require(coordinate.is_finite(), &part, "position", coordinate, "finite")?;
    }
    let norm = body.orientation.length();
    require(is_unit(norm * norm), &part, "orientation of length", norm, "1")?;
    let friction = body.friction;
    require(friction >= 0.0 && friction.is_finite(), &part, "friction", friction, "finite and at least 0")?;
    let extents = match body.shape {
        None => return Ok(()),
        Some(Shape::Cuboid { half }) => half.to_array(),
        Some(Shape::Capsule { radius, half_length }) => [radius, radius, half_length],
    };
    extents.into_iter().try_for_each(|extent| {
        require(extent >= 0.0 && extent.is_finite(), &part, "extent", extent, "finite and at least 0")
    })
}

fn check_joint(index: usize, parent: &Body, child: &Body, joint: &Joint) -> Result<(), ModelError> {
    let part = || format!("joint {index}");
    let gap = child.position + child.orientation * joint.child_anchor
        - (parent.position + parent.orientation * joint.parent_anchor);
    let off = match joint.kind {
        JointKind::Hinge { axis } | JointKind::Slider { axis } => {
            let square = axis.length_squared();
            require(is_unit(square), &part, "axis of length", axis.length(), "1")?;
            let axis = parent.orientation * axis;
            let slides = matches!(joint.kind, JointKind::Slider { .. });
            if slides { gap - axis * axis.dot(gap) } else { gap }
        }
        JointKind::Fixed | JointKind::Ball => gap,
    };
    let tolerance = 1e-6 * (1.0 + joint.parent_anchor.length() + joint.child_anchor.length());
    let distance = off.length();
    if distance.is_nan() || distance > tolerance {
        return Err(ModelError::Apart { joint: index, gap: distance });
    }
    for (dof, stops) in joint.stops.iter().enumerate() {
        let Some((low, high)) = *stops else { continue };
        require(
            dof < joint.kind.degrees(),
            &part,
            "stop of degree of freedom",
            dof as f64,
            "one that it has",
        )?;
        require(low <= high && low < f64::INFINITY, &part, "low stop", low, "at most the high one")?;
        require(high > f64::NEG_INFINITY, &part, "high stop", high, "above −∞")?;
    }
    Ok(())
}

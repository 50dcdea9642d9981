//! The world: parts on the ground, stepped.

use super::{Joint, Shape};
use glam::{DQuat, DVec3};
use rapier3d::math::{Pose as EnginePose, Rotation, Vector};
use rapier3d::parry::query::Ray;
use rapier3d::prelude::{
    ColliderBuilder, ColliderHandle, CollisionPipeline, MassProperties, PhysicsPipeline, PhysicsWorld,
    RigidBody, RigidBodyBuilder, RigidBodyHandle, SharedShape,
};

/// The size of what is built, m: the engine's tolerances follow it. At 0.1 a contact may be half a millimetre
/// deep, and is looked for 2 mm ahead.
const LENGTH_UNIT: f32 = 0.1;

/// What holds for a whole world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Length of a step, s.
    pub step: f64,
    /// Rounds of the solver in a step, each of which moves the parts by its share of the step.
    pub rounds: usize,
    /// Sweeps over all joints and contacts in a round.
    pub sweeps: usize,
    /// Downwards, m/s².
    pub gravity: f64,
    /// Of everything on everything.
    pub friction: f64,
    /// Of everything on everything.
    pub restitution: f64,
    /// Of what is round on the ground: the lever of the ground's normal force against its spin, as a share of its
    /// radius.
    pub rolling_resistance: f64,
    /// 1/s.
    pub linear_damping: f64,
    /// 1/s.
    pub angular_damping: f64,
    /// kg/m³.
    pub density: f64,
}

/// Where a part is: its centre of mass, m, and the rotation from its frame to the world's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// m.
    pub position: DVec3,
    /// Unit.
    pub rotation: DQuat,
}

/// How a part moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Of its centre of mass, m/s.
    pub linear: DVec3,
    /// rad/s, world frame.
    pub angular: DVec3,
}

/// Level ground at z = 0 and parts that stand on it.
pub struct World {
    settings: Settings,
    engine: PhysicsWorld,
    ground: ColliderHandle,
    parts: Vec<Part>,
    tethers: Vec<Tether>,
    discs: Vec<ColliderHandle>,
}

#[derive(Debug, Clone)]
struct Part {
    body: RigidBodyHandle,
    collider: ColliderHandle,
    shape: Shape,
    mass: f64,
    inertia: DVec3,
}

#[derive(Debug, Clone)]
struct Tether {
    parent: usize,
    child: usize,
    joint: Joint,
}

impl World {
    /// Nothing but the ground.
    pub fn new(settings: Settings) -> World {
        let mut engine = PhysicsWorld::new();
        engine.gravity = Vector::new(0.0, 0.0, -settings.gravity as f32);
        let parameters = &mut engine.integration_parameters;
        parameters.dt = settings.step as f32;
        parameters.num_solver_iterations = settings.rounds;
        parameters.num_internal_pgs_iterations = settings.sweeps;
        parameters.max_ccd_substeps = 0;
        parameters.length_unit = LENGTH_UNIT;
        parameters.warmstart_joints = true;
        let ground = ColliderBuilder::new(SharedShape::halfspace(Vector::Z))
            .friction(settings.friction as f32)
            .restitution(settings.restitution as f32);
        let ground = engine.insert_collider(ground, None);
        World { settings, engine, ground, parts: Vec::new(), tethers: Vec::new(), discs: Vec::new() }
    }

    /// Puts a part at rest into the world; gives its index, counted from 0.
    pub fn insert(&mut self, shape: Shape, pose: &Pose) -> usize {
        let Settings { friction, restitution, linear_damping, angular_damping, density, .. } = self.settings;
        let (mass, inertia) = (density * shape.volume(), density * shape.inertia());
        let body = RigidBodyBuilder::dynamic()
            .pose(pose.engine())
            .linear_damping(linear_damping as f32)
            .angular_damping(angular_damping as f32)
            .can_sleep(false)
            .allow_fast_rotation(true);
        let weight = MassProperties::new(Vector::ZERO, mass as f32, vector(inertia));
        let collider = ColliderBuilder::new(shape.shared())
            .mass_properties(weight)
            .friction(friction as f32)
            .restitution(restitution as f32);
        let (body, collider) = self.engine.insert(body, collider);
        self.parts.push(Part { body, collider, shape, mass, inertia });
        self.parts.len() - 1
    }

    /// Joins two parts, which go on colliding, as they stand.
    pub fn join(&mut self, parent: usize, child: usize, joint: Joint) {
        let turn = self.pose(parent).rotation.inverse() * self.pose(child).rotation;
        let (body, other) = (self.parts[parent].body, self.parts[child].body);
        self.engine.insert_impulse_joint(body, other, joint.build(turn));
        self.tethers.push(Tether { parent, child, joint });
    }

    /// Puts an upright disc into the world that feels what touches it, and pushes nothing.
    pub fn place_disc(&mut self, centre: DVec3, radius: f64, height: f64) {
        let upright = Rotation::from_xyzw(HALF_ROOT, 0.0, 0.0, HALF_ROOT); // the engine's cylinder is along y
        let disc = ColliderBuilder::cylinder(0.5 * height as f32, radius as f32)
            .position(EnginePose::from_parts(vector(centre), upright))
            .sensor(true);
        self.discs.push(self.engine.insert_collider(disc, None));
    }

    /// How many parts there are.
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// Whether there is no part.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// A part's shape.
    pub fn shape(&self, part: usize) -> Shape {
        self.parts[part].shape
    }

    /// A part's mass, kg.
    pub fn mass(&self, part: usize) -> f64 {
        self.parts[part].mass
    }

    /// Where a part is.
    pub fn pose(&self, part: usize) -> Pose {
        let pose = self.body(part).position();
        Pose { position: double(pose.translation), rotation: quaternion(pose.rotation) }
    }

    /// How a part moves.
    pub fn twist(&self, part: usize) -> Twist {
        let body = self.body(part);
        Twist { linear: double(body.linvel()), angular: double(body.angvel()) }
    }

    /// How fast a point of a part, given by its offset from the centre of mass in the world's frame, follows a
    /// unit force there, if nothing else held it: its inverse mass along a unit direction, 1/kg.
    pub fn mobility(&self, part: usize, pose: &Pose, offset: DVec3, direction: DVec3) -> f64 {
        let Part { mass, inertia, .. } = self.parts[part];
        let lever = pose.rotation.inverse() * offset.cross(direction);
        1.0 / mass + (lever * lever / inertia).element_sum()
    }

    /// Pushes a part during the next step, N, at an offset from its centre of mass, m; both in the world's
    /// frame.
    pub fn push(&mut self, part: usize, force: DVec3, offset: DVec3) {
        let body = self.parts[part].body;
        let body = self.engine.bodies.get_mut(body).expect("parts stay");
        body.add_force(vector(force), false);
        body.add_torque(vector(offset.cross(force)), false);
    }

    /// One step.
    pub fn step(&mut self) {
        self.engine.step();
        for part in &self.parts {
            let body = self.engine.bodies.get_mut(part.body).expect("parts stay");
            body.reset_forces(false);
            body.reset_torques(false);
            let lever = self.settings.rolling_resistance * part.shape.rounding();
            if lever > 0.0
                && let Some(pair) = self.engine.narrow_phase.contact_pair(self.ground, part.collider)
            {
                part.brake(body, lever * f64::from(pair.total_impulse_magnitude()));
            }
        }
    }

    /// Takes all motion out of the world.
    pub fn stop(&mut self) {
        for part in &self.parts {
            let body = self.engine.bodies.get_mut(part.body).expect("parts stay");
            body.set_linvel(Vector::ZERO, false);
            body.set_angvel(Vector::ZERO, false);
        }
    }

    /// Whether every part is where numbers are. The engine takes others out of the world.
    pub fn is_finite(&self) -> bool {
        self.engine.quarantine().is_empty()
            && (0..self.len()).all(|part| {
                let (pose, twist) = (self.pose(part), self.twist(part));
                pose.position.is_finite() && pose.rotation.is_finite() && twist.linear.is_finite()
            })
    }

    /// Sum of the ground's normal forces during the last step, N.
    pub fn ground_force(&self) -> f64 {
        let pairs = self.engine.narrow_phase.contact_pairs_with(self.ground);
        pairs.map(|pair| f64::from(pair.total_impulse_magnitude())).sum::<f64>() / self.settings.step
    }

    /// Whether any part touches a disc.
    pub fn touches_disc(&self) -> bool {
        let narrow = &self.engine.narrow_phase;
        self.discs.iter().any(|&disc| narrow.intersection_pairs_with(disc).any(|(.., touches)| touches))
    }

    /// Whether nothing solid stands between two points: no part, and not the ground.
    pub fn is_clear(&self, from: DVec3, to: DVec3) -> bool {
        let (way, above) = (to - from, from.z > 0.0 && to.z > 0.0);
        let length = way.length();
        let ray = Ray::new(vector(from), vector(way / length));
        above
            && self.parts.iter().all(|part| {
                let pose = self.engine.bodies[part.body].position();
                let offset = double(pose.translation) - from;
                let along = (offset.dot(way) / length).clamp(0.0, length);
                let nearest = (offset - way * (along / length)).length_squared();
                let radius = part.shape.radius();
                nearest > radius * radius
                    || !self.engine.colliders[part.collider].shape().intersects_ray(pose, &ray, length as f32)
            })
    }

    /// How far the worst joint's anchors are apart where they should not be, m.
    pub fn separation(&self) -> f64 {
        self.tethers.iter().fold(0.0, |worst: f64, Tether { parent, child, joint }| {
            worst.max(joint.separation(&self.pose(*parent), &self.pose(*child)))
        })
    }

    /// Kinetic energy, and potential energy above the ground, J.
    pub fn energy(&self) -> f64 {
        let of = |(index, part): (usize, &Part)| {
            let (pose, twist) = (self.pose(index), self.twist(index));
            let spin = pose.rotation.inverse() * twist.angular;
            let kinetic = part.mass * twist.linear.length_squared() + (part.inertia * spin).dot(spin);
            0.5 * kinetic + part.mass * self.settings.gravity * pose.position.z
        };
        self.parts.iter().enumerate().map(of).sum()
    }

    fn body(&self, part: usize) -> &RigidBody {
        &self.engine.bodies[self.parts[part].body]
    }
}

impl Part {
    /// Takes angular momentum, N·m·s, out of the spin, along its axis: no more than stops that. It never adds energy.
    fn brake(&self, body: &mut RigidBody, momentum: f64) {
        let spin = double(body.angvel());
        let Some(axis) = spin.try_normalize() else {
            return;
        };
        let rotation = quaternion(*body.rotation());
        let local = rotation.inverse() * axis;
        let give = (local * local / self.inertia).element_sum();
        let taken = momentum.min(spin.length() / give);
        body.set_angvel(vector(spin - rotation * (local / self.inertia) * taken), false);
    }
}

/// A world of its own that goes on to the same bits. What the engine's pipelines hold is of use within a step
/// alone, but for the parts that the last step took out of the world: do not clone what is not finite.
impl Clone for World {
    fn clone(&self) -> World {
        let engine = &self.engine;
        World {
            settings: self.settings,
            engine: PhysicsWorld {
                gravity: engine.gravity,
                integration_parameters: engine.integration_parameters,
                physics_pipeline: PhysicsPipeline::new(),
                collision_pipeline: CollisionPipeline::new(),
                islands: engine.islands.clone(),
                broad_phase: engine.broad_phase.clone(),
                narrow_phase: engine.narrow_phase.clone(),
                bodies: engine.bodies.clone(),
                colliders: engine.colliders.clone(),
                impulse_joints: engine.impulse_joints.clone(),
                multibody_joints: engine.multibody_joints.clone(),
                soft_bodies: engine.soft_bodies.clone(),
                ccd_solver: engine.ccd_solver.clone(),
            },
            ground: self.ground,
            parts: self.parts.clone(),
            tethers: self.tethers.clone(),
            discs: self.discs.clone(),
        }
    }
}

/// √½
const HALF_ROOT: f32 = std::f32::consts::FRAC_1_SQRT_2;

impl Pose {
    /// A point of the part's frame in the world's, m.
    pub fn point(&self, local: DVec3) -> DVec3 {
        self.position + self.rotation * local
    }

    pub(super) fn engine(&self) -> EnginePose {
        let r = self.rotation;
        let rotation = Rotation::from_xyzw(r.x as f32, r.y as f32, r.z as f32, r.w as f32);
        EnginePose::from_parts(vector(self.position), rotation)
    }
}

impl Twist {
    /// How fast a point moves, m/s, given by its offset from the centre of mass in the world's frame.
    pub fn at(&self, offset: DVec3) -> DVec3 {
        self.linear + self.angular.cross(offset)
    }
}

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

fn double(v: Vector) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

fn quaternion(r: Rotation) -> DQuat {
    DQuat::from_xyzw(r.x.into(), r.y.into(), r.z.into(), r.w.into())
}

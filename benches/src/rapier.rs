//! The walkers on rapier3d with impulse joints: the same boxes, densities, friction, motors and stops as ours,
//! from the same plans. It shares none of our physics.

use creatures::walker::BodyKind;
use creatures::walker::body::{Drive, Link, Part, Surface};
use glam::DVec3;
use rapier3d::prelude::*;

/// Friction of the ground and of the parts, combined by minimum (walker G-48).
const GROUND: f32 = 0.9;
const RUBBER: f32 = 0.9;
const SHELL: f32 = 0.3;
/// Start height of the lowest point, m (walker G-51).
const CLEARANCE: f64 = 0.001;

/// One walker on the ground.
pub struct Walker {
    world: PhysicsWorld,
    torso: RigidBodyHandle,
    motors: Vec<(ImpulseJointHandle, JointAxis, f32)>,
}

impl Walker {
    /// A body in its start pose, stepped at a rate.
    pub fn new(body: BodyKind, physics_hz: f64) -> Walker {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, 0.0, -9.81);
        let parameters = &mut world.integration_parameters;
        parameters.dt = (1.0 / physics_hz) as f32;
        parameters.num_solver_iterations = 4;
        // The bodies are 0.1 m in size: the engine's tolerances are meant for metres.
        parameters.length_unit = 0.1;
        parameters.max_ccd_substeps = 0;
        let ground = ColliderBuilder::new(SharedShape::halfspace(Vector::Z))
            .friction(GROUND)
            .friction_combine_rule(CoefficientCombineRule::Min)
            .collision_groups(InteractionGroups::new(
                Group::GROUP_1,
                Group::GROUP_2,
                InteractionTestMode::And,
            ));
        world.insert_collider(ground, None);

        let plan = body.plan();
        let height = CLEARANCE + depth(&plan.torso, plan.limb);
        let start = DVec3::new(0.0, 0.0, height);
        let torso = insert(&mut world, &plan.torso, start);
        let mut motors = Vec::new();
        for side in [-1.0, 1.0] {
            let mirrored = |v: DVec3| DVec3::new(v.x * side, v.y, v.z);
            let (mut parent, mut center) = (torso, start);
            for link in plan.limb {
                let (on_parent, on_child) = (mirrored(link.parent_anchor), mirrored(link.child_anchor));
                center += on_parent - on_child;
                let part = insert(&mut world, &link.part, center);
                let joint = world.insert_impulse_joint(parent, part, joint(link, on_parent, on_child));
                motors.extend(axes(link.drive).iter().map(|&axis| (joint, axis, link.drive.speed() as f32)));
                parent = part;
            }
        }
        Walker { world, torso, motors }
    }

    /// Sets the wanted speeds, one command within ±1 a degree of freedom.
    pub fn drive(&mut self, commands: &[f64]) {
        for (&(joint, axis, speed), &command) in self.motors.iter().zip(commands) {
            let joint = self.world.impulse_joints.get_mut(joint, true).expect("joints stay");
            // A high factor reaches the speed within a step, up to the motor's effort.
            joint.data.set_motor_velocity(axis, command as f32 * speed, 1e4);
        }
    }

    /// One step.
    pub fn step(&mut self) {
        self.world.step();
    }

    /// How far the torso got forwards (−y), m.
    pub fn advance(&self) -> f64 {
        -f64::from(self.world.bodies[self.torso].translation().y)
    }
}

fn insert(world: &mut PhysicsWorld, part: &Part, center: DVec3) -> RigidBodyHandle {
    let body = RigidBodyBuilder::dynamic().translation(vector(center)).can_sleep(false);
    let handle = world.insert_body(body);
    let half = part.size * 0.5;
    let shape = ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32)
        .density(part.density as f32)
        .friction(match part.surface {
            Surface::Shell => SHELL,
            Surface::Rubber => RUBBER,
        })
        .friction_combine_rule(CoefficientCombineRule::Min)
        // With the ground alone (walker G-49).
        .collision_groups(InteractionGroups::new(Group::GROUP_2, Group::GROUP_1, InteractionTestMode::And));
    world.insert_collider(shape, Some(handle));
    handle
}

fn joint(link: &Link, on_parent: DVec3, on_child: DVec3) -> GenericJoint {
    let effort = link.drive.effort() as f32;
    let mut joint: GenericJoint = match link.drive {
        Drive::Hinge => RevoluteJointBuilder::new(Vector::X).build().into(),
        Drive::Slider => PrismaticJointBuilder::new(-Vector::Z).build().into(),
        Drive::Ball => SphericalJointBuilder::new().build().into(),
    };
    joint.set_local_anchor1(vector(on_parent)).set_local_anchor2(vector(on_child));
    for &axis in axes(link.drive) {
        joint.set_motor_model(axis, MotorModel::AccelerationBased).set_motor_max_force(axis, effort);
        if let Some((low, high)) = link.stops {
            joint.set_limits(axis, [low as f32, high as f32]);
        }
    }
    joint
}

fn axes(drive: Drive) -> &'static [JointAxis] {
    match drive {
        Drive::Hinge => &[JointAxis::AngX],
        Drive::Slider => &[JointAxis::LinX],
        Drive::Ball => &[JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ],
    }
}

/// Height of the torso's centre above the lowest point of the start pose, m.
fn depth(torso: &Part, limb: &[Link]) -> f64 {
    let mut center = 0.0;
    limb.iter().fold(torso.size.z / 2.0, |depth: f64, link| {
        center += link.parent_anchor.z - link.child_anchor.z;
        depth.max(link.part.size.z / 2.0 - center)
    })
}

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

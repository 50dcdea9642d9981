//! A creature in its world: parts, muscles and receptors at work (E-20..E-32). It spawns, settles and is stepped;
//! what its muscles are told to do is for its brain.

use super::body::phenotype::{Part, PartJoint};
use super::body::{Phenotype, Shape, genotype};
use super::brain::TICK;
use super::energy::Balance;
use super::eye;
use super::fault::{Fault, FaultKind, SEPARATION_MAX, SINKING_MAX, SPEED_MAX};
use super::fitness::Start;
use super::fitness::setup::{DISC_HEIGHT, DISC_RADIUS};
use super::muscle::Stretch;
use super::physics::Physics;
use super::trial::{Light, Living, State};
use crate::math::atan2;
use crate::physics::contact::{self, Joint, JointKind, Pose, World};
use crate::record::{Frame, Scene};
use glam::{DQuat, DVec3};

mod scene;

/// Height of the lowest point at the spawn, m (E-20).
const CLEARANCE: f64 = 0.01;
/// A segment slower than this is at rest, m/s (E-20).
const STILL: f64 = 0.05;
/// Steps at rest after which a creature is settled: 0.25 s (E-20).
const STILL_STEPS: u32 = 15;
/// Steps within which it has to settle: 2 s (E-20).
const SETTLING_STEPS: u32 = 120;
/// The shortest shadow of the forward axis on the ground that gives a heading (E-21).
const FORWARD_MIN: f64 = 0.1;

/// An expressed body, at work. A clone goes on as it does, to the bit.
#[derive(Clone)]
pub struct Creature<'a> {
    phenotype: &'a Phenotype,
    physics: Physics,
    world: World,
    mass: f64,
    /// (muscles), N.
    strengths: Vec<f64>,
    /// (muscles), as they are now.
    pulls: Vec<Pull>,
    state: State,
    balance: Balance,
    /// J of surplus that are a fault.
    surplus_max: f64,
    /// Centres of the discs that were placed, m.
    discs: Vec<DVec3>,
    steps: u32,
    settled: bool,
}

/// A muscle between its two ends.
#[derive(Debug, Clone, Copy, Default)]
struct Pull {
    stretch: Stretch,
    /// From the first end to the second, unit, world frame.
    direction: DVec3,
    /// Of the ends from their parts' centres, m, world frame.
    offsets: [DVec3; 2],
    /// As it was last told, 0 to 1.
    activation: f64,
    /// During the last substep, N.
    tension: f64,
}

impl<'a> Creature<'a> {
    /// Puts a body into an empty world and lets it settle with slack muscles (E-20): its time begins after that,
    /// at rest.
    ///
    /// # Errors
    /// What went wrong while it settled, or that it did not.
    pub fn spawn(phenotype: &'a Phenotype, physics: Physics, start: Start) -> Result<Creature<'a>, Fault> {
        let mut creature = Creature::place(phenotype, physics, start);
        creature.settle(start)?;
        Ok(creature)
    }

    /// The world that it is in, for who steps that alone.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// How far the worst joint is apart where it should not be, m (E-23).
    pub fn separation(&self) -> f64 {
        self.world.separation()
    }

    /// The energy that came from nothing so far, J (E-23).
    pub fn surplus(&self) -> f64 {
        self.balance.surplus()
    }

    fn place(phenotype: &'a Phenotype, physics: Physics, start: Start) -> Creature<'a> {
        let turn = match start {
            Start::Rest => DQuat::IDENTITY,
            Start::UpsideDown => DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0),
        };
        let pose = |part: &Part| Pose {
            position: turn * part.position,
            rotation: (turn * part.rotation).normalize(),
        };
        let bottom = phenotype.parts.iter().map(|part| {
            let pose = pose(part);
            pose.position.z - solid(part.shape).reach(pose.rotation.inverse() * DVec3::Z)
        });
        let lift = CLEARANCE - bottom.fold(f64::INFINITY, f64::min);
        let mut world = World::new(physics.settings());
        for part in &phenotype.parts {
            let pose = pose(part);
            world.insert(solid(part.shape), &Pose { position: pose.position + lift * DVec3::Z, ..pose });
        }
        for (index, part) in phenotype.parts.iter().enumerate() {
            if let Some(joint) = &part.joint {
                world.join(joint.parent, index, link(joint));
            }
        }
        let mass: f64 = (0..world.len()).map(|part| world.mass(part)).sum();
        let mut creature = Creature {
            phenotype,
            physics,
            world,
            mass,
            strengths: phenotype.muscles.iter().map(|muscle| muscle.force_max).collect(),
            pulls: vec![Pull::default(); phenotype.muscles.len()],
            state: State::default(),
            balance: Balance::default(),
            surplus_max: super::energy::TOLERANCE * mass * physics.gravity,
            discs: Vec::new(),
            steps: 0,
            settled: false,
        };
        creature.balance = Balance::open(creature.world.energy());
        creature.stretch();
        creature.observe(0.0);
        creature
    }

    /// What still falls or rolls when its time is over would score by that alone, and so would the last of a roll
    /// that counts as rest: the one is a fault, the other is stopped (E-20). On their backs bodies that are at rest
    /// otherwise may rock for long: they are stopped as well.
    fn settle(&mut self, start: Start) -> Result<(), Fault> {
        let mut still = 0;
        while still < STILL_STEPS {
            if self.steps == SETTLING_STEPS {
                match start {
                    Start::Rest => return Err(self.fault(FaultKind::Unsettled(self.fastest()))),
                    Start::UpsideDown => break,
                }
            }
            self.advance(&[])?;
            still = if self.fastest() < STILL { still + 1 } else { 0 };
        }
        self.world.stop();
        self.balance = Balance::open(self.world.energy());
        self.stretch();
        self.observe(self.state.ground_force);
        self.settled = true;
        self.steps = 0;
        Ok(())
    }

    fn fault(&self, kind: FaultKind) -> Fault {
        Fault { kind, step: self.steps, settled: self.settled }
    }

    /// One step; muscles without an activation are slack.
    fn advance(&mut self, activations: &[f64]) -> Result<(), Fault> {
        let substep = TICK / f64::from(self.physics.substeps);
        let (mut work, mut ground_force) = (0.0, 0.0);
        for _ in 0..self.physics.substeps {
            self.pull(activations);
            self.world.step();
            work += self.stretch() * substep;
            ground_force += self.world.ground_force();
        }
        self.steps += 1;
        self.examine(work).map_err(|kind| self.fault(kind))?;
        self.observe(ground_force / f64::from(self.physics.substeps));
        Ok(())
    }

    /// What the muscles do during the next substep. One that is not driven is not there at all (E-26).
    fn pull(&mut self, activations: &[f64]) {
        let muscles = self.phenotype.muscles.iter().zip(&mut self.pulls);
        for ((muscle, pull), &activation) in muscles.zip(activations) {
            pull.activation = activation;
            pull.tension = 0.0;
            if activation > 0.0 {
                pull.tension = muscle.tension(activation, pull.stretch, self.physics.muscle_damping);
                let force = pull.tension * pull.direction;
                self.world.push(muscle.parts[0], force, pull.offsets[0]);
                self.world.push(muscle.parts[1], -force, pull.offsets[1]);
            }
        }
    }

    /// Measures every muscle anew, and gives the power at which all of them worked since the last time, W: with
    /// the mean of the rates before and after, along the line in which they pulled.
    fn stretch(&mut self) -> f64 {
        let substep = TICK / f64::from(self.physics.substeps);
        let mut power = 0.0;
        for (muscle, pull) in self.phenotype.muscles.iter().zip(&mut self.pulls) {
            let [first, second] = muscle.parts;
            let poses = [self.world.pose(first), self.world.pose(second)];
            let twists = [self.world.twist(first), self.world.twist(second)];
            if pull.tension > 0.0 {
                let velocity = twists[1].at(pull.offsets[1]) - twists[0].at(pull.offsets[0]);
                power -= pull.tension * 0.5 * (pull.stretch.rate + velocity.dot(pull.direction));
            }
            let offsets = [poses[0].rotation * muscle.ends[0], poses[1].rotation * muscle.ends[1]];
            let way = poses[1].position + offsets[1] - poses[0].position - offsets[0];
            let length = way.length();
            // Ends that meet pull nowhere.
            let direction = if length > 1e-9 { way / length } else { DVec3::ZERO };
            let rate = (twists[1].at(offsets[1]) - twists[0].at(offsets[0])).dot(direction);
            let give = self.world.mobility(first, &poses[0], offsets[0], direction)
                + self.world.mobility(second, &poses[1], offsets[1], direction);
            pull.stretch = Stretch { length, rate, give: substep * give };
            pull.direction = direction;
            pull.offsets = offsets;
        }
        power
    }

    /// E-23
    fn examine(&mut self, work: f64) -> Result<(), FaultKind> {
        if !self.world.is_finite() {
            return Err(FaultKind::NonFinite);
        }
        let speed = self.fastest();
        if speed > SPEED_MAX {
            return Err(FaultKind::Speed(speed));
        }
        let apart = self.world.separation();
        if apart > SEPARATION_MAX {
            return Err(FaultKind::Separation(apart));
        }
        let depth = (0..self.world.len()).fold(0.0, |deepest: f64, part| {
            let pose = self.world.pose(part);
            let down = self.world.shape(part).reach(pose.rotation.inverse() * DVec3::Z);
            deepest.max(down - pose.position.z)
        });
        if depth > SINKING_MAX {
            return Err(FaultKind::Sinking(depth));
        }
        let surplus = self.balance.enter(self.world.energy(), work);
        if surplus > self.surplus_max {
            return Err(FaultKind::Energy(surplus));
        }
        Ok(())
    }

    fn fastest(&self) -> f64 {
        (0..self.world.len()).map(|part| self.world.twist(part).linear.length()).fold(0.0, f64::max)
    }

    /// Takes down the state.
    fn observe(&mut self, ground_force: f64) {
        let (mut centre, mut momentum, mut top) = (DVec3::ZERO, DVec3::ZERO, f64::NEG_INFINITY);
        for part in 0..self.world.len() {
            let (pose, mass) = (self.world.pose(part), self.world.mass(part));
            centre += mass * pose.position;
            momentum += mass * self.world.twist(part).linear;
            let up = self.world.shape(part).reach(pose.rotation.inverse() * DVec3::Z);
            top = top.max(pose.position.z + up);
        }
        let root = self.world.pose(0).rotation;
        let forward = (root * DVec3::X).with_z(0.0);
        let heading = if forward.length() < FORWARD_MIN {
            self.state.heading // the last that was valid
        } else {
            atan2(forward.y, forward.x)
        };
        self.state = State {
            centre: centre / self.mass,
            velocity: momentum / self.mass,
            heading,
            up: (root * DVec3::Z).z,
            top,
            ground_force,
            touches: self.world.touches_disc(),
        };
    }
}

impl Living for Creature<'_> {
    type Fault = Fault;

    fn strengths(&self) -> &[f64] {
        &self.strengths
    }

    fn weight(&self) -> f64 {
        self.mass * self.physics.gravity
    }

    fn state(&self) -> State {
        self.state
    }

    fn place_discs(&mut self, centre: DVec3, count: usize) {
        for disc in 0..count {
            let centre = centre.with_z((disc as f64 + 0.5) * DISC_HEIGHT);
            self.world.place_disc(centre, DISC_RADIUS, DISC_HEIGHT);
            self.discs.push(centre);
        }
    }

    fn feel(&self, lengths: &mut [f64]) {
        for ((felt, muscle), pull) in lengths.iter_mut().zip(&self.phenotype.muscles).zip(&self.pulls) {
            *felt = muscle.feel(pull.stretch.length);
        }
    }

    fn see(&self, lights: &[Light], signals: &mut [f64]) {
        for (signal, receptor) in signals.iter_mut().zip(&self.phenotype.receptors) {
            let pose = self.world.pose(receptor.part);
            let (point, axis) = (pose.point(receptor.point), pose.rotation * receptor.axis);
            let is_clear = |from, to| self.world.is_clear(from, to);
            *signal = eye::signal(point, axis, lights, self.physics.light_range, is_clear);
        }
    }

    fn step(&mut self, activations: &[f64]) -> Result<(), Fault> {
        self.advance(activations)
    }

    fn scene(&self) -> Scene {
        self.view()
    }

    fn frame(&self) -> Frame {
        self.shot()
    }
}

fn solid(shape: Shape) -> contact::Shape {
    match shape {
        Shape::Box(half) => contact::Shape::Cuboid(DVec3::from_array(half)),
        Shape::Sphere(radius) => contact::Shape::Ball(radius),
        Shape::Capsule { radius, half_length } => contact::Shape::Capsule { radius, half_length },
    }
}

fn link(joint: &PartJoint) -> Joint {
    let kind = match joint.kind {
        genotype::Joint::Fixed => JointKind::Fixed,
        genotype::Joint::Revolute => JointKind::Revolute,
        genotype::Joint::Spherical => JointKind::Spherical,
        genotype::Joint::Prismatic => JointKind::Prismatic(joint.travel),
        genotype::Joint::Cylindrical => JointKind::Cylindrical(joint.travel),
    };
    Joint { kind, parent_anchor: joint.parent_anchor, child_anchor: joint.child_anchor, axis: joint.axis }
}

#[cfg(test)]
mod tests;

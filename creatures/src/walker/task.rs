//! The walkers' task: go straight ahead for 7.5 seconds (G-21, G-56..G-62). One evaluation is a pure
//! function of genotype and task; it draws nothing.

use super::body::BodyKind;
use super::genotype::Genotype;
use super::phenotype::{Footing, Phenotype};
use super::{grn, neat, scene, sensors};
use crate::math::pow;
use crate::{Cull, DecodeError, Interim, Observer, Outcome, Reason, SpecError, Status, Task, Verdict};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Metres in a foot; scores are in feet (G-56).
const FOOT: f64 = 0.3048;
/// Physics steps that one evaluation may have at most.
const STEPS_MAX: f64 = 1e7;

/// Bounds beyond which the model means nothing.
const DISTANCE_MAX: f64 = 100.0;
const HEIGHT_MAX: f64 = 10.0;
const HEIGHT_MIN: f64 = -0.2;
const SPEED_MAX: f64 = 50.0;
const SEPARATION_MAX: f64 = 0.05;

/// The `[task]` table of a walker experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WalkerTask {
    /// Which body; the one key without a default.
    pub body: BodyKind,
    /// Score of a foot of progress, φ.
    #[serde(default = "defaults::phi")]
    pub phi: f64,
    /// Exponent of the drift in feet, θ.
    #[serde(default = "defaults::theta")]
    pub theta: f64,
    /// Length of an evaluation, s.
    #[serde(default = "defaults::seconds")]
    pub seconds: f64,
    /// Control steps a second.
    #[serde(default = "defaults::control_hz")]
    pub control_hz: u32,
    /// Physics steps a second, a multiple of `control_hz`.
    #[serde(default = "defaults::physics_hz")]
    pub physics_hz: u32,
    /// What the creature walks on.
    #[serde(default)]
    pub world: Footing,
}

mod defaults {
    pub(super) fn phi() -> f64 {
        10.0
    }
    pub(super) fn theta() -> f64 {
        2.0
    }
    pub(super) fn seconds() -> f64 {
        7.5
    }
    pub(super) fn control_hz() -> u32 {
        60
    }
    pub(super) fn physics_hz() -> u32 {
        240
    }
}

impl WalkerTask {
    /// The paper's task for a body.
    pub fn new(body: BodyKind) -> WalkerTask {
        WalkerTask {
            body,
            phi: defaults::phi(),
            theta: defaults::theta(),
            seconds: defaults::seconds(),
            control_hz: defaults::control_hz(),
            physics_hz: defaults::physics_hz(),
            world: Footing::default(),
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn checked(self) -> Result<WalkerTask, SpecError> {
        let refuse = |key: &str, problem: String| Err(SpecError::new(key, problem));
        for (key, value, high) in [("phi", self.phi, 1e6), ("theta", self.theta, 10.0)] {
            if !(value > 0.0 && value <= high) {
                return refuse(key, format!("{value} is not within (0, {high}]"));
            }
        }
        if self.control_hz == 0 {
            return refuse("control_hz", "0 is not positive".to_owned());
        }
        if self.physics_hz == 0 || !self.physics_hz.is_multiple_of(self.control_hz) {
            let problem = format!("{} is no positive multiple of control_hz", self.physics_hz);
            return refuse("physics_hz", problem);
        }
        let controls = self.seconds * f64::from(self.control_hz);
        if !(controls >= 0.5 && (controls - controls.round()).abs() < 1e-6) {
            let problem = format!("{} is no positive number of control steps", self.seconds);
            return refuse("seconds", problem);
        }
        if self.seconds * f64::from(self.physics_hz) > STEPS_MAX {
            return refuse("seconds", format!("more than {STEPS_MAX} physics steps"));
        }
        self.world.check().map_err(|error| error.below("world"))?;
        Ok(self)
    }

    /// Control steps of an evaluation.
    fn controls(&self) -> u32 {
        (self.seconds * f64::from(self.control_hz)).round() as u32
    }

    /// Physics steps of a control step.
    fn substeps(&self) -> u32 {
        self.physics_hz / self.control_hz
    }

    /// Eq. 6: progress towards −y in feet times φ, less the drift along x to the power θ (G-57).
    pub fn dis(&self, start: DVec3, end: DVec3) -> f64 {
        let moved = (end - start) / FOOT;
        -self.phi * moved.y - pow(moved.x.abs(), self.theta)
    }

    fn read(&self, genotype: &[u8]) -> Result<Genotype, DecodeError> {
        let genotype = Genotype::decode(genotype)?;
        if genotype.body() == self.body {
            return Ok(genotype);
        }
        let problem = format!("{} where the task has {}", genotype.body().name(), self.body.name());
        Err(DecodeError::illegal("body", problem))
    }
}

/// Eq. 7: fitness is never negative (G-58).
fn fitness(dis: f64) -> f64 {
    if dis > 0.0 { dis } else { 0.0 }
}

impl Task for WalkerTask {
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError> {
        self.read(genotype).map(drop)
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        _seed: u64, // a walker's life draws nothing (G-3)
        cull: Option<&Cull>,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        let genotype = self.read(genotype)?;
        let mut life = Life::new(self, &genotype);
        let end = life.live(cull, observer);
        Ok(life.outcome(end))
    }
}

/// Controller and body at work, and what is measured on the way.
struct Life<'a> {
    task: &'a WalkerTask,
    phenotype: Phenotype,
    controller: Controller,
    start: DVec3,
    steps: u32,
    interim: Option<Interim>,
    height_max: f64,
    speed_max: f64,
    /// ∫ω_x dt, rad; positive forwards.
    turned: f64,
    controls: u32,
    silent_pairs: u32,
}

/// How a life ended.
enum End {
    Completed,
    Culled,
    Aborted(Reason, String),
}

impl<'a> Life<'a> {
    fn new(task: &'a WalkerTask, genotype: &Genotype) -> Life<'a> {
        let phenotype = Phenotype::develop(task.body, &task.world);
        let start = phenotype.world().position(phenotype.torso());
        Life {
            task,
            controller: Controller::new(genotype),
            start,
            phenotype,
            steps: 0,
            interim: None,
            height_max: start.z,
            speed_max: 0.0,
            turned: 0.0,
            controls: 0,
            silent_pairs: 0,
        }
    }

    /// Control steps in the order of G-21: sense, decide, drive, move.
    fn live(&mut self, cull: Option<&Cull>, observer: &mut dyn Observer) -> End {
        let task = self.task;
        let mut readings = vec![0.0; task.body.inputs()];
        let mut commands = vec![0.0; task.body.degrees()];
        let dt = 1.0 / f64::from(task.physics_hz);
        let steps = task.controls() * task.substeps();
        let cull = cull.map(|cull| (cull, (cull.at * f64::from(steps)) as u32));
        observer.trial(0, &|| scene::scene(task.body, dt));
        self.show(dt, observer);
        for _ in 0..task.controls() {
            if let Err(fault) = self.phenotype.sense(&mut readings) {
                return self.abort(Reason::NonFinite, &fault);
            }
            self.silent_pairs += self.controller.decide(&mut readings, &mut commands);
            self.controls += 1;
            self.phenotype.drive(&commands);
            for _ in 0..task.substeps() {
                if let Some((cull, _)) = cull.filter(|&(_, step)| step == self.steps) {
                    let interim = Interim { step: self.steps, measure: self.dis() };
                    self.interim = Some(interim);
                    observer.interim(interim);
                    if cull.verdict(interim.measure) == Verdict::Cull {
                        return End::Culled;
                    }
                }
                if let Err(fault) = self.phenotype.step(dt) {
                    return self.abort(Reason::NonFinite, &fault);
                }
                self.steps += 1;
                self.measure(dt);
                self.show(dt, observer);
            }
            if let Some(excess) = self.excess() {
                return self.abort(Reason::BlowUp, &excess);
            }
        }
        End::Completed
    }

    /// Lets the observer see where everything is.
    fn show(&self, dt: f64, observer: &mut dyn Observer) {
        observer.frame(f64::from(self.steps) * dt, &|| scene::frame(&self.phenotype));
    }

    fn abort(&self, reason: Reason, what: &dyn std::fmt::Display) -> End {
        End::Aborted(reason, format!("{what} at step {}", self.steps))
    }

    fn position(&self) -> DVec3 {
        self.phenotype.world().position(self.phenotype.torso())
    }

    /// What the creature has made of its task so far; the interim measure (G-61).
    fn dis(&self) -> f64 {
        self.task.dis(self.start, self.position())
    }

    fn measure(&mut self, dt: f64) {
        let (world, torso) = (self.phenotype.world(), self.phenotype.torso());
        let (height, speed) = (world.position(torso).z, world.velocity(torso).length());
        self.turned += world.spin(torso).x * dt;
        self.height_max = if height > self.height_max { height } else { self.height_max };
        self.speed_max = if speed > self.speed_max { speed } else { self.speed_max };
    }

    /// The first quantity out of bounds, in words.
    fn excess(&self) -> Option<String> {
        let world = self.phenotype.world();
        let position = self.position();
        let distance = position.truncate().length();
        if distance > DISTANCE_MAX {
            return Some(format!("distance {distance:.3} m"));
        }
        if !(HEIGHT_MIN..=HEIGHT_MAX).contains(&position.z) {
            return Some(format!("torso height {:.3} m", position.z));
        }
        let speeds = self.phenotype.parts().iter().map(|&part| world.velocity(part).length());
        if let Some(speed) = speeds.into_iter().find(|&speed| speed > SPEED_MAX) {
            return Some(format!("speed {speed:.3} m/s"));
        }
        let separation = world.separation();
        (separation > SEPARATION_MAX).then(|| format!("joint separation {separation:.4} m"))
    }

    fn outcome(&self, end: End) -> Outcome {
        let (status, note) = match end {
            End::Completed => (Status::Completed, String::new()),
            End::Culled => (Status::Culled, String::new()),
            End::Aborted(reason, note) => (Status::Aborted(reason), note),
        };
        let dis = self.dis();
        let fitness = if status == Status::Completed { fitness(dis) } else { 0.0 };
        let moved = self.position() - self.start;
        let pairs = f64::from(self.controls) * self.task.body.degrees() as f64;
        let measures = [
            ("dis", dis),
            ("drift", moved.x),
            ("travel", moved.y),
            ("height_max", self.height_max),
            ("speed_max", self.speed_max),
            ("somersaults", self.turned / TAU),
            ("silent_pairs", f64::from(self.silent_pairs) / pairs),
            ("grn_collapse", f64::from(self.controller.collapses())),
        ];
        // What went wrong may have left infinities behind, which no table can hold; the note says it.
        let finite = measures.into_iter().filter(|(_, value)| value.is_finite());
        Outcome {
            status,
            fitness,
            steps: self.steps,
            measures: finite.map(|(name, value)| (name.to_owned(), value)).collect(),
            interim: self.interim,
            note,
        }
    }
}

/// Either controller at work.
enum Controller {
    Grn(grn::Network),
    Neat(neat::Network),
}

impl Controller {
    fn new(genotype: &Genotype) -> Controller {
        match genotype {
            Genotype::Grn(genotype) => Controller::Grn(grn::Network::new(genotype)),
            Genotype::Neat(genotype) => Controller::Neat(neat::Network::new(genotype)),
        }
    }

    /// One controller step: from readings in [0, 1], which it may overwrite, to speed commands in [−1, 1]
    /// (G-19, G-20). Gives how many pairs of output proteins were silent.
    fn decide(&mut self, readings: &mut [f64], commands: &mut [f64]) -> u32 {
        match self {
            Controller::Grn(network) => {
                network.step(readings);
                let mut silent = 0;
                for (command, pair) in commands.iter_mut().zip(network.outputs().chunks_exact(2)) {
                    let speed = grn::speed(pair[0], pair[1]);
                    silent += u32::from(speed.is_none());
                    *command = speed.unwrap_or(0.0);
                }
                silent
            }
            Controller::Neat(network) => {
                readings.iter_mut().for_each(|reading| *reading = sensors::signed(*reading));
                network.step(readings);
                commands.copy_from_slice(network.outputs());
                0
            }
        }
    }

    fn collapses(&self) -> u32 {
        match self {
            Controller::Grn(network) => network.collapses(),
            Controller::Neat(_) => 0,
        }
    }
}

#[cfg(test)]
mod tests;

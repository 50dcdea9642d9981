//! The flyers' task: stay in the air, and get on (F-48, F-66). Here are its parameters and what is legal; a
//! creature lives it in `life.rs`.

use super::Genotype;
use super::life::Life;
use crate::{Cull, DecodeError, Observer, Outcome, SpecError, Task};
use serde::{Deserialize, Serialize};

/// Physics steps that one evaluation may have at most.
const STEPS_MAX: u32 = 1_000_000;

/// The `[task]` table of a flyer experiment (F-66). Those of F-66's parameters that belong to the search, such
/// as rates and sizes, are in its table; the softness `cfm` has no meaning for exact joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FlyerTask {
    /// Physics steps of an evaluation, T (F-48).
    pub steps: u32,
    /// Length of a step, s (F-34).
    pub dt: f64,
    /// Height of the body's centre at the start, m (F-48).
    pub start_height: f64,
    /// m/s² (F-2).
    pub gravity: f64,
    /// Of the bones, kg/m³ (F-19).
    pub density: f64,
    /// α, the scale of the air's forces; 0 is a vacuum (F-42, X-12).
    pub alpha: f64,
    /// How much harder the air holds the body about x (F-47).
    pub tail_weight: f64,
    /// Stops of a hinge on either side, rad (F-18).
    pub hinge_limit: f64,
    /// Stops of the ball joint about each axis on either side, rad (F-18).
    pub ball_limit: f64,
    /// Rate of a hinge under full effort of its effector, rad/s (F-31).
    pub hinge_rate: f64,
    /// Rate of the ball joint about an axis under full effort of its effector, rad/s (F-31).
    pub ball_rate: f64,
    /// k of the motors' torque, 1/s² (F-32).
    pub motor_k: f64,
    /// The share of a joint's drift that one step takes back (F-36).
    pub erp: f64,
    /// Brain steps of a physics step (F-30).
    pub brain_substeps: u32,
    /// The share of a joint's range in which its stop is felt (F-26).
    pub stop_fraction: f64,
    /// Fitness of a step in the air (F-57).
    pub w_hover: f64,
    /// Fitness of a step's smooth speed in m/s (F-57).
    pub w_speed: f64,
    /// What a culling rule compares (F-54).
    pub interim: Measure,
    /// The speed of a body at which the evaluation ends, m/s (F-39).
    pub blow_up_speed: f64,
    /// Whether film drag gives way so as not to throw back what it slows (F-40).
    pub drag_limiter: bool,
}

/// The two readings of the paper's culling rule (F-54).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Horizontal distance from the start, as the rule is worded.
    Distance,
    /// Fitness so far, as its bracketed remark has it.
    Fitness,
}

impl Measure {
    /// What it is called in an outcome.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Distance => "distance",
            Measure::Fitness => "fitness",
        }
    }
}

impl Default for FlyerTask {
    fn default() -> Self {
        FlyerTask {
            steps: 1500,
            dt: 0.05,
            start_height: 250.0,
            gravity: 9.81,
            density: 0.01,
            alpha: 1e-3,
            tail_weight: 1.75,
            hinge_limit: std::f64::consts::FRAC_PI_3,
            ball_limit: std::f64::consts::PI / 9.0,
            hinge_rate: 2.0,
            ball_rate: 0.5,
            motor_k: 1.0,
            erp: 0.2,
            brain_substeps: 2,
            stop_fraction: 0.1,
            w_hover: 1.0,
            w_speed: 1.0,
            interim: Measure::Distance,
            blow_up_speed: 1000.0,
            drag_limiter: false,
        }
    }
}

impl FlyerTask {
    /// Checks every number.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn checked(self) -> Result<FlyerTask, SpecError> {
        let refuse = |key: &str, problem: String| Err(SpecError::new(key, problem));
        let positive = [
            ("dt", self.dt, 1.0),
            ("density", self.density, 1e3),
            ("hinge_limit", self.hinge_limit, 3.0),
            ("ball_limit", self.ball_limit, 1.5), // three of them stay below π, where angles are unique
            ("blow_up_speed", self.blow_up_speed, 1e6),
        ];
        for (key, value, most) in positive {
            if !(value > 0.0 && value <= most) {
                return refuse(key, format!("{value} is not within (0, {most}]"));
            }
        }
        let ranges = [
            ("start_height", self.start_height, 1e5),
            ("gravity", self.gravity, 1e3),
            ("alpha", self.alpha, 1e3),
            ("tail_weight", self.tail_weight, 100.0),
            ("hinge_rate", self.hinge_rate, 100.0),
            ("ball_rate", self.ball_rate, 100.0),
            ("motor_k", self.motor_k, 1e6),
            ("erp", self.erp, 1.0),
            ("stop_fraction", self.stop_fraction, 1.0),
            ("w_hover", self.w_hover, 1e6),
            ("w_speed", self.w_speed, 1e6),
        ];
        for (key, value, most) in ranges {
            if !(0.0..=most).contains(&value) {
                return refuse(key, format!("{value} is not within [0, {most}]"));
            }
        }
        if !(4..=STEPS_MAX).contains(&self.steps) {
            return refuse("steps", format!("{} is not within 4 to {STEPS_MAX}", self.steps));
        }
        if !(1..=100).contains(&self.brain_substeps) {
            return refuse("brain_substeps", format!("{} is not within 1 to 100", self.brain_substeps));
        }
        Ok(self)
    }
}

impl Task for FlyerTask {
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError> {
        Genotype::decode(genotype).map(drop)
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        _seed: u64, // a flyer's life draws nothing (F-5)
        cull: Option<&Cull>,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        let genotype = Genotype::decode(genotype)?;
        let mut life = Life::new(self, &genotype);
        let end = life.live(cull, observer);
        Ok(life.outcome(end))
    }
}

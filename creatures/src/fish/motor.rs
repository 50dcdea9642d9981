//! Motor controllers: what a behaviour may ask of a body, and the state that turns it into muscle actuations
//! (A-22..A-29). It moves no node.

use super::body::MUSCLES;
use super::controller::{self, Phases};
use super::controller_set::Maps;
use super::fins::{FinAngles, NEUTRAL};
use super::mechanics::TIME_STEP;
use super::turn::TimedTurn;
use crate::math::sin;
use std::f64::consts::{PI, TAU};

/// ŝ, the beat of swim-MC(σ), rad by time: the lower edge of where speed no longer rises with it.
pub const BEAT: f64 = 4.0;
/// Time in which a mouth opens or closes.
const MOUTH_TIME: f64 = 0.5;
/// The fastest change of a bias that grows or changes sides, and of one that shrinks, by time.
const BIAS_RISE: f64 = 1.5;
const BIAS_FALL: f64 = 0.1875;

/// u₁…u₁₂, each in [0, 1]: 0 is relaxed, 1 at minimum contraction.
pub type Actuation = [f64; MUSCLES];

/// What a behaviour routine writes: all that it may ask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// σ in [0, 1], how hard to swim.
    pub swim: f64,
    /// Where to turn.
    pub turn: Turn,
    /// γ asked of the fins, rad.
    pub fins: FinAngles,
    /// q, at most [`super::fins::STROKE_MAX`] either way.
    pub stroke: f64,
    /// Whether the mouth is to open or close.
    pub mouth_open: bool,
    /// Whether the fins keep the fish upright; they do unless told.
    pub balance: bool,
}

impl Default for Command {
    /// Drift.
    fn default() -> Self {
        Command {
            swim: 0.0,
            turn: Turn::Bias(0.0),
            fins: FinAngles::both(NEUTRAL),
            stroke: 0.0,
            mouth_open: false,
            balance: true,
        }
    }
}

/// Where to turn; the left is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn {
    /// e*, a bias within ±1 to move toward.
    Bias(f64),
    /// A timed turn by an angle, rad. It starts when this is first asked for, and the same angle
    /// asked for again goes on with it, through its end; any other turn ends it.
    Angle(f64),
}

/// How the two swimming segments beat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gait {
    /// r₁, r₂: amplitude of the anterior and the posterior swimming segment, in [0, 1].
    pub amplitudes: [f64; 2],
    /// s₁, s₂: beat of both, rad by time.
    pub beats: [f64; 2],
    /// How far the posterior segment lags, rad; π as published.
    pub lag: f64,
}

impl Gait {
    /// swim-MC(σ): {σ r̂₁, ŝ₁, σ r̂₂, ŝ₂} with r̂ = 1.
    pub fn swim(swim: f64) -> Gait {
        Gait { amplitudes: [swim; 2], beats: [BEAT; 2], lag: PI }
    }
}

/// What a motor controller remembers between steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// θ₁, θ₂: where the anterior and the posterior segment are in their beat, rad in [0, 2π).
    pub phases: [f64; 2],
    /// θ of a learned controller's oscillations, rad.
    pub oscillations: Phases,
    /// e, the bias at work.
    pub bias: f64,
    /// γ.
    pub fins: FinAngles,
    /// 0 closed to 1 open.
    pub mouth: f64,
    /// The timed turn begun last, and what asked for it.
    turn: Option<(f64, TimedTurn)>,
}

impl Default for Motor {
    /// At rest, with fins neutral and the mouth closed.
    fn default() -> Self {
        Motor {
            phases: [0.0; 2],
            oscillations: Phases::default(),
            bias: 0.0,
            fins: FinAngles::both(NEUTRAL),
            mouth: 0.0,
            turn: None,
        }
    }
}

impl Motor {
    /// Goes on by one step in all but the beat: fins, mouth and bias. Gives σ, which a timed turn holds at 1
    ///
    ///
    /// `roll` is the fish's, rad, for the balance reflex. Numbers out of range are taken as the nearest in it.
    pub fn obey(&mut self, command: &Command, roll: f64) -> f64 {
        let fins = if command.balance { command.fins.balanced(roll) } else { command.fins };
        self.fins = self.fins.turned(fins);
        let way = TIME_STEP / MOUTH_TIME;
        self.mouth = (self.mouth + if command.mouth_open { way } else { -way }).clamp(0.0, 1.0);
        let turning = self.steer(command.turn);
        if turning { 1.0 } else { command.swim.clamp(0.0, 1.0) }
    }

    /// Goes on by one step of a gait, and gives what the muscles are to do at its end, with the bias at work
    ///
    pub fn beat(&mut self, gait: &Gait) -> Actuation {
        for (phase, beat) in self.phases.iter_mut().zip(gait.beats) {
            *phase = (*phase + beat * TIME_STEP) % TAU;
        }
        let anterior = beat(gait.amplitudes[0], self.phases[0]);
        let posterior = beat(gait.amplitudes[1], self.phases[1] - gait.lag);
        turned(self.bias, anterior, posterior)
    }

    /// Goes on by one step of what was learned, in place of a gait.
    pub fn follow(&mut self, maps: &mut Maps, swim: f64) -> Actuation {
        let controller = maps.controller(swim, self.bias);
        controller::advance(&mut self.oscillations, &controller.frequency);
        controller.actuation(&self.oscillations)
    }

    /// Moves the bias by one step; whether a timed turn is under way.
    fn steer(&mut self, turn: Turn) -> bool {
        match turn {
            Turn::Bias(target) => {
                self.turn = None;
                self.bias = toward(self.bias, target.clamp(-1.0, 1.0));
                false
            }
            Turn::Angle(angle) => {
                let begun = self.turn.take().filter(|&(asked, _)| asked == angle);
                let (_, mut timed) = begun.unwrap_or_else(|| (angle, TimedTurn::new(angle)));
                timed.step();
                self.bias = timed.bias();
                let turning = !timed.over();
                self.turn = Some((angle, timed));
                turning
            }
        }
    }
}

/// Actuations of the left and the right side of a swimming segment.
fn beat(amplitude: f64, phase: f64) -> [f64; 2] {
    let sine = sin(phase);
    [0.5 * amplitude * (1.0 + sine), 0.5 * amplitude * (1.0 - sine)]
}

/// All twelve muscles: the side of the turn contracts in the anterior turning segment, and in the shared one as
/// far as swimming leaves it free.
fn turned(bias: f64, anterior: [f64; 2], posterior: [f64; 2]) -> Actuation {
    let turn = [if bias > 0.0 { bias } else { 0.0 }, if bias < 0.0 { -bias } else { 0.0 }];
    let free = 1.0 - bias.abs();
    let shared = [turn[0] + free * anterior[0], turn[1] + free * anterior[1]];
    let segment = |[left, right]: [f64; 2]| [left, right, right, left];
    let mut actuation = [0.0; MUSCLES];
    actuation[..4].copy_from_slice(&segment(turn));
    actuation[4..8].copy_from_slice(&segment(shared));
    actuation[8..].copy_from_slice(&segment(posterior));
    actuation
}

/// A step of a bias toward its target: fast when it grows or changes sides, slow when it shrinks.
fn toward(bias: f64, target: f64) -> f64 {
    let grows = target * bias < 0.0 || target.abs() > bias.abs();
    let most = if grows { BIAS_RISE } else { BIAS_FALL } * TIME_STEP;
    bias + (target - bias).clamp(-most, most)
}

#[cfg(test)]
mod tests;

//! The node types of a skill's control (E-34). They hold no state: what a node saw before is handed to them.
//! Gates and sigmas are no genes; the circuit adds them.

use crate::math::{floor, sin};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::ops::RangeInclusive;

/// Length of a brain tick, s: one physics step (E-22, E-33).
pub const TICK: f64 = 1.0 / 60.0;
/// The most inputs of any node.
pub const SLOTS_MAX: usize = 8;
/// Divisors below this are taken for 0.
const NEAR_ZERO: f64 = 1e-6;

const FREQUENCY: RangeInclusive<f64> = 0.1..=5.0; // Hz
const UNIT: RangeInclusive<f64> = 0.0..=1.0;
const FACTOR: RangeInclusive<f64> = 0.0..=4.0;
const TAU_SECONDS: RangeInclusive<f64> = 0.01..=1.0;
const DELAY_TICKS: RangeInclusive<f64> = 1.0..=120.0;

/// What a node makes of its inputs. Outputs are within [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum NodeKind {
    /// `0.5 + 0.5 sin 2π(f·t + φ)`.
    Sinusoidal {
        /// f, Hz, within 0.1 to 5.
        frequency: f64,
        /// φ, turns, within 0 to 1.
        phase: f64,
    },
    /// One value for ever.
    Constant {
        /// Within 0 to 1.
        value: f64,
    },
    /// `1 − x`.
    Complement,
    /// `k·x`.
    Scale {
        /// k, within 0 to 4.
        factor: f64,
    },
    /// The product of the inputs that are there; 0 if there are none.
    Multiply,
    /// `x1 / x2`; by 0, everything is 1 and nothing is 0.
    Divide,
    /// The sum.
    Sum,
    /// `x1 − x2`, 0 where x2 is larger.
    Difference,
    /// `|x1 − x2|`.
    AbsoluteDifference,
    /// `τ dx/dt`, 0 for a falling input.
    Derivative {
        /// τ, s, within 0.01 to 1.
        tau: f64,
    },
    /// 1 from a level on, else 0.
    Threshold {
        /// θ, within 0 to 1.
        level: f64,
    },
    /// x2 where x1 has reached a level, else x3.
    Switch {
        /// θ, within 0 to 1.
        level: f64,
    },
    /// The input of some ticks ago.
    Delay {
        /// d, within 1 to 120.
        ticks: u8,
    },
}

impl NodeKind {
    /// One node of every type, with the parameters in the middle of their ranges.
    pub const ALL: [NodeKind; 13] = [
        NodeKind::Sinusoidal { frequency: 2.55, phase: 0.5 },
        NodeKind::Constant { value: 0.5 },
        NodeKind::Complement,
        NodeKind::Scale { factor: 2.0 },
        NodeKind::Multiply,
        NodeKind::Divide,
        NodeKind::Sum,
        NodeKind::Difference,
        NodeKind::AbsoluteDifference,
        NodeKind::Derivative { tau: 0.505 },
        NodeKind::Threshold { level: 0.5 },
        NodeKind::Switch { level: 0.5 },
        NodeKind::Delay { ticks: 60 },
    ];

    /// The most inputs of this type.
    pub fn slots(&self) -> usize {
        match self {
            NodeKind::Sinusoidal { .. } | NodeKind::Constant { .. } => 0,
            NodeKind::Complement
            | NodeKind::Scale { .. }
            | NodeKind::Derivative { .. }
            | NodeKind::Threshold { .. }
            | NodeKind::Delay { .. } => 1,
            NodeKind::Divide | NodeKind::Difference | NodeKind::AbsoluteDifference => 2,
            NodeKind::Switch { .. } => 3,
            NodeKind::Multiply | NodeKind::Sum => SLOTS_MAX,
        }
    }

    /// Whether an input that is missing is one input less, instead of one that reads 0.
    pub fn is_variadic(&self) -> bool {
        matches!(self, NodeKind::Multiply | NodeKind::Sum)
    }

    /// How many ticks back the first input is remembered.
    pub fn memory(&self) -> usize {
        match *self {
            NodeKind::Derivative { .. } => 1,
            NodeKind::Delay { ticks } => usize::from(ticks),
            _ => 0,
        }
    }

    /// The output y(n) of tick n, within [0, 1] (E-34).
    ///
    /// `inputs` are x(n − 1): [`NodeKind::slots`] of them, or as many as there are if
    /// [`NodeKind::is_variadic`]. `past` is x1 of [`NodeKind::memory`] ticks earlier, 0 before tick 0.
    pub fn output(&self, inputs: &[f64], past: f64, tick: u32) -> f64 {
        let x = inputs;
        clamp(match *self {
            NodeKind::Sinusoidal { frequency, phase } => {
                let turns = frequency * f64::from(tick) * TICK + phase;
                0.5 + 0.5 * sin(TAU * (turns - floor(turns)))
            }
            NodeKind::Constant { value } => value,
            NodeKind::Complement => 1.0 - x[0],
            NodeKind::Scale { factor } => factor * x[0],
            NodeKind::Multiply if x.is_empty() => 0.0,
            NodeKind::Multiply => x.iter().product(),
            NodeKind::Divide if x[1] < NEAR_ZERO => step(x[0] >= NEAR_ZERO),
            NodeKind::Divide => x[0] / x[1],
            NodeKind::Sum => x.iter().sum(),
            NodeKind::Difference => x[0] - x[1],
            NodeKind::AbsoluteDifference => (x[0] - x[1]).abs(),
            NodeKind::Derivative { tau } => tau * (x[0] - past) / TICK,
            NodeKind::Threshold { level } => step(x[0] >= level),
            NodeKind::Switch { level } if x[0] >= level => x[1],
            NodeKind::Switch { .. } => x[2],
            NodeKind::Delay { .. } => past,
        })
    }

    /// Changes every parameter by a function of its name, value and range, which has to stay in the range.
    /// A delay is rounded to whole ticks.
    pub fn map_parameters(self, mut change: impl FnMut(&str, f64, RangeInclusive<f64>) -> f64) -> NodeKind {
        match self {
            NodeKind::Sinusoidal { frequency, phase } => NodeKind::Sinusoidal {
                frequency: change("frequency", frequency, FREQUENCY),
                phase: change("phase", phase, UNIT),
            },
            NodeKind::Constant { value } => NodeKind::Constant { value: change("value", value, UNIT) },
            NodeKind::Scale { factor } => NodeKind::Scale { factor: change("factor", factor, FACTOR) },
            NodeKind::Derivative { tau } => NodeKind::Derivative { tau: change("tau", tau, TAU_SECONDS) },
            NodeKind::Threshold { level } => NodeKind::Threshold { level: change("level", level, UNIT) },
            NodeKind::Switch { level } => NodeKind::Switch { level: change("level", level, UNIT) },
            NodeKind::Delay { ticks } => {
                let ticks = floor(change("ticks", f64::from(ticks), DELAY_TICKS) + 0.5);
                NodeKind::Delay { ticks: ticks as u8 }
            }
            plain => plain,
        }
    }
}

/// Limits a signal to [0, 1]; NaN and infinities become 0.
pub fn clamp(signal: f64) -> f64 {
    // Written so that a negative zero comes out positive: bits are compared.
    if signal > 0.0 && signal.is_finite() { if signal < 1.0 { signal } else { 1.0 } } else { 0.0 }
}

fn step(reached: bool) -> f64 {
    if reached { 1.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The output of inputs alone.
    fn plain(kind: NodeKind, inputs: &[f64]) -> f64 {
        kind.output(inputs, 0.0, 0)
    }

    #[track_caller]
    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
    }

    /// T-1, the node without inputs that varies.
    #[test]
    fn a_sinusoidal_node_follows_the_clock() {
        let sine = |frequency, phase, tick| NodeKind::Sinusoidal { frequency, phase }.output(&[], 0.0, tick);
        near(sine(5.0, 0.0, 0), 0.5);
        near(sine(5.0, 0.0, 1), 0.75);
        near(sine(5.0, 0.0, 3), 1.0);
        near(sine(1.25, 0.25, 7), 0.804381);
        near(sine(0.5, 0.9, 100), 0.002739);
    }

    /// T-1, the nodes without memory.
    #[test]
    fn nodes_follow_their_formulas() {
        near(plain(NodeKind::Complement, &[0.3]), 0.7);
        near(plain(NodeKind::Complement, &[0.0]), 1.0);
        let scale = |factor| plain(NodeKind::Scale { factor }, &[0.4]);
        near(scale(2.0), 0.8);
        near(scale(3.0), 1.0);
        near(scale(0.25), 0.1);
        near(plain(NodeKind::Multiply, &[0.5, 0.8]), 0.4);
        near(plain(NodeKind::Multiply, &[0.5, 0.8, 0.25]), 0.1);
        near(plain(NodeKind::Multiply, &[0.7]), 0.7);
        near(plain(NodeKind::Multiply, &[]), 0.0);
        for (inputs, expected) in [([0.3, 0.6], 0.5), ([0.6, 0.3], 1.0), ([0.2, 0.0], 1.0), ([0.0, 0.0], 0.0)]
        {
            near(plain(NodeKind::Divide, &inputs), expected);
        }
        near(plain(NodeKind::Sum, &[0.4, 0.35]), 0.75);
        near(plain(NodeKind::Sum, &[0.4, 0.35, 0.5]), 1.0);
        near(plain(NodeKind::Sum, &[]), 0.0);
        near(plain(NodeKind::Difference, &[0.9, 0.25]), 0.65);
        near(plain(NodeKind::Difference, &[0.25, 0.9]), 0.0);
        near(plain(NodeKind::AbsoluteDifference, &[0.25, 0.9]), 0.65);
        near(plain(NodeKind::Threshold { level: 0.5 }, &[0.5]), 1.0);
        near(plain(NodeKind::Threshold { level: 0.5 }, &[0.499]), 0.0);
        near(plain(NodeKind::Switch { level: 0.5 }, &[0.6, 0.2, 0.9]), 0.2);
        near(plain(NodeKind::Switch { level: 0.5 }, &[0.4, 0.2, 0.9]), 0.9);
        near(plain(NodeKind::Constant { value: 0.3 }, &[]), 0.3);
    }

    /// T-1, the nodes with memory; that they are handed the right past is tested in the circuit.
    #[test]
    fn a_derivative_is_the_rise_alone_and_a_delay_the_past() {
        let rise = |past, now| NodeKind::Derivative { tau: 0.25 }.output(&[now], past, 0);
        near(rise(0.50, 0.52), 0.3);
        near(rise(0.52, 0.50), 0.0);
        near(rise(0.5, 0.9), 1.0);
        near(NodeKind::Delay { ticks: 2 }.output(&[0.9], 0.2, 0), 0.2);
    }

    #[test]
    fn what_is_no_signal_is_silence() {
        for signal in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.5, -0.0] {
            assert_eq!(clamp(signal).to_bits(), 0.0f64.to_bits(), "{signal}");
        }
        assert_eq!((clamp(0.25), clamp(1.5)), (0.25, 1.0));
    }

    #[test]
    fn a_changed_delay_is_of_whole_ticks() {
        let later = NodeKind::Delay { ticks: 3 }.map_parameters(|_, ticks, _| ticks + 0.6);
        assert_eq!(later, NodeKind::Delay { ticks: 4 });
    }
}

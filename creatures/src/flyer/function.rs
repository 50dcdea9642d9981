//! The eighteen functions of a flyer's neurons (F-28, F-29). They hold no state: what a neuron saw before
//! is handed to them.

use crate::math::{atan, cos, exp, log, log10, sin, wrap_angle};
use serde::{Deserialize, Serialize};

/// Divisors and arguments of logarithms within this are taken for 0.
const NEAR_ZERO: f64 = 1e-5;

/// What a neuron makes of its inputs, named in a payload as in the paper's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Function {
    /// The mean.
    Average,
    /// The product.
    Product,
    /// The first input over the product of the others; 0 where that is near 0.
    Divide,
    /// Sine of the mean.
    Sin,
    /// Cosine of the mean.
    Cos,
    /// Arc tangent of the mean.
    Atan,
    /// 1 if the first two add up to more than the third, else −1.
    SumThreshold,
    /// 1 if the product is positive, else −1.
    SignOf,
    /// The least input.
    Min,
    /// The greatest input.
    Max,
    /// The second input if the first is positive, else the third.
    If,
    /// The mean of some brain steps ago.
    Mem,
    /// A saw wave of the mean's frequency, rad/s.
    SawWave,
    /// Decimal logarithm of the mean; −1 where that is not positive.
    Log,
    /// Natural logarithm of the mean; −1 where that is not positive.
    Ln,
    /// e to the mean.
    Expt,
    /// Between the second input and the first, as the third goes from −1 to 1.
    Interpolate,
    /// The change of the mean since the brain step before.
    Differentiate,
}

impl Function {
    /// Every function, in the order of the requirement's table.
    pub const ALL: [Function; 18] = [
        Function::Average,
        Function::Product,
        Function::Divide,
        Function::Sin,
        Function::Cos,
        Function::Atan,
        Function::SumThreshold,
        Function::SignOf,
        Function::Min,
        Function::Max,
        Function::If,
        Function::Mem,
        Function::SawWave,
        Function::Log,
        Function::Ln,
        Function::Expt,
        Function::Interpolate,
        Function::Differentiate,
    ];
    /// How many brain steps back the function looks, given its neuron's delay (F-29); 0 for most.
    pub fn memory(self, delay: u8) -> usize {
        match self {
            Function::Mem => usize::from(delay),
            Function::Differentiate => 1,
            _ => 0,
        }
    }

    /// The output, within [−1, 1] (F-28).
    ///
    /// `inputs` are those present, at most three, within [−1, 1]. `past` is the mean of
    /// [`Function::memory`] brain steps ago, if there was one; `time` is in s.
    pub fn output(self, inputs: &[f64], past: Option<f64>, time: f64) -> f64 {
        let input = |index: usize, absent: f64| inputs.get(index).copied().unwrap_or(absent);
        let (a, b, c) = (input(0, 0.0), input(1, 0.0), input(2, 0.0));
        limit(match self {
            Function::Average => mean(inputs),
            Function::Product => product(inputs),
            Function::Divide => {
                let divisor = input(1, 1.0) * input(2, 1.0);
                if divisor.abs() < NEAR_ZERO { 0.0 } else { a / divisor }
            }
            Function::Sin => sin(mean(inputs)),
            Function::Cos => cos(mean(inputs)),
            Function::Atan => atan(mean(inputs)),
            Function::SumThreshold => sign(a + b > c),
            Function::SignOf => sign(product(inputs) > 0.0),
            Function::Min => extreme(inputs, |next, least| next < least),
            Function::Max => extreme(inputs, |next, most| next > most),
            Function::If => match a > 0.0 {
                true => b,
                false => c,
            },
            Function::Mem => past.unwrap_or(0.0),
            Function::SawWave => saw_wave(mean(inputs) * time),
            Function::Log => logarithm(log10, mean(inputs)),
            Function::Ln => logarithm(log, mean(inputs)),
            Function::Expt => exp(mean(inputs)),
            Function::Interpolate => {
                let k = 0.5 * (c + 1.0);
                k * a + (1.0 - k) * b
            }
            Function::Differentiate => past.map_or(0.0, |past| mean(inputs) - past),
        })
    }
}

/// Limits a signal to [−1, 1]; what is no number becomes 0 (F-4, X-7). Every sensor, neuron and effector
/// passes through it.
pub fn limit(signal: f64) -> f64 {
    if signal.is_nan() { 0.0 } else { signal.clamp(-1.0, 1.0) }
}

/// The mean of the inputs present, 0 if there are none.
pub fn mean(inputs: &[f64]) -> f64 {
    if inputs.is_empty() { 0.0 } else { inputs.iter().sum::<f64>() / inputs.len() as f64 }
}

/// The product of the inputs present, 0 if there are none.
fn product(inputs: &[f64]) -> f64 {
    if inputs.is_empty() { 0.0 } else { inputs.iter().product() }
}

/// The first of the inputs that none surpasses, 0 if there are none. Not `f64::min` and `f64::max`, which
/// leave the sign of a zero to the machine.
fn extreme(inputs: &[f64], surpasses: impl Fn(f64, f64) -> bool) -> f64 {
    let keep = |kept, next| if surpasses(next, kept) { next } else { kept };
    inputs.iter().copied().reduce(keep).unwrap_or(0.0)
}

fn sign(positive: bool) -> f64 {
    if positive { 1.0 } else { -1.0 }
}

/// The infinite sum `Σ (−1)^(n+1) sin(n·phase) / n` in closed form: half the phase, wrapped to ±π (F-29).
fn saw_wave(phase: f64) -> f64 {
    0.5 * wrap_angle(phase)
}

/// A logarithm, and its limit −1 where there is none (F-29).
fn logarithm(of: fn(f64) -> f64, value: f64) -> f64 {
    if value <= NEAR_ZERO { -1.0 } else { of(value) }
}

#[cfg(test)]
mod tests {
    use super::Function::*;
    use super::*;

    /// The outputs of consecutive brain steps under the given means.
    fn over_time(function: Function, delay: u8, means: &[f64]) -> Vec<f64> {
        let past = |step: usize| step.checked_sub(function.memory(delay)).map(|past| means[past]);
        (0..means.len()).map(|step| function.output(&[means[step]], past(step), 0.0)).collect()
    }

    fn assert_close(found: f64, expected: f64, of: Function) {
        assert!((found - expected).abs() <= 1e-6, "{of:?} gave {found}, not {expected}");
    }

    /// T-15
    #[test]
    fn functions_of_three_inputs_have_the_tabled_outputs() {
        let table = [
            (Average, 0.35),
            (Product, -0.1),
            (Divide, -1.0),
            (Sin, 0.342898),
            (Cos, 0.939373),
            (Atan, 0.336675),
            (SumThreshold, -1.0),
            (SignOf, -1.0),
            (Min, -0.25),
            (Max, 0.8),
            (If, -0.25),
            (Log, -0.455932),
            (Ln, -1.0),
            (Expt, 1.0),
            (Interpolate, 0.425),
            (SawWave, 0.875),
        ];
        for (function, expected) in table {
            assert_close(function.output(&[0.5, -0.25, 0.8], None, 5.0), expected, function);
        }
        assert_eq!(SawWave.output(&[0.5, -0.25, 0.8], None, 12.0), -1.0);
        assert_eq!(Divide.output(&[1.0, 0.003, 0.003], None, 0.0), 0.0);
    }

    /// T-15: values before they are limited.
    #[test]
    fn a_saw_wave_jumps_at_half_its_period() {
        assert_close(saw_wave(0.35 * 12.0), -1.041593, SawWave);
        assert_close(logarithm(log, 0.35), -1.049822, Ln);
    }

    /// T-15
    #[test]
    fn mem_lets_the_mean_out_after_its_delay() {
        assert_eq!(over_time(Mem, 3, &[0.1, 0.2, 0.3, 0.4, 0.5]), [0.0, 0.0, 0.0, 0.1, 0.2]);
    }

    /// T-15
    #[test]
    fn differentiate_gives_the_change_since_the_step_before() {
        for (found, expected) in
            over_time(Differentiate, 9, &[0.2, 0.5, 0.1]).into_iter().zip([0.0, 0.3, -0.4])
        {
            assert_close(found, expected, Differentiate);
        }
    }

    /// T-16
    #[test]
    fn functions_of_no_inputs_have_the_tabled_outputs() {
        let ones = [(Cos, 1.0), (SumThreshold, -1.0), (SignOf, -1.0), (Log, -1.0), (Ln, -1.0), (Expt, 1.0)];
        for function in Function::ALL {
            let expected = ones.iter().find(|(one, _)| *one == function).map_or(0.0, |(_, value)| *value);
            assert_eq!(function.output(&[], None, 3.0), expected, "{function:?}");
        }
    }

    /// F-28: which functions skip an absent input, and what the others read in its place.
    #[test]
    fn an_absent_input_is_skipped_or_has_its_stand_in() {
        let cases = [
            (Average, 0.6, 0.6),
            (Product, -0.3, -0.3),
            (Min, 0.4, 0.4),
            (Max, -0.4, -0.4),
            (SignOf, 0.2, 1.0),
            (Divide, 0.5, 0.5),
            (SumThreshold, 0.1, 1.0),
            (SumThreshold, 0.0, -1.0),
            (If, 0.7, 0.0),
            (Interpolate, 0.8, 0.4),
        ];
        for (function, input, expected) in cases {
            assert_close(function.output(&[input], None, 0.0), expected, function);
        }
        assert_eq!(Divide.output(&[0.2, 0.5], None, 0.0), 0.4, "c stands at 1");
    }

    ///
    #[test]
    fn a_signal_is_limited_and_no_number_is_zero() {
        let cases =
            [(f64::NAN, 0.0), (f64::INFINITY, 1.0), (f64::NEG_INFINITY, -1.0), (1.5, 1.0), (-0.25, -0.25)];
        for (signal, limited) in cases {
            assert_eq!(limit(signal), limited);
        }
    }

    #[test]
    fn functions_are_named_as_in_the_text_of_the_paper() {
        let names = Function::ALL.map(|function| serde_json::to_value(function).unwrap());
        let expected = [
            "average",
            "product",
            "divide",
            "sin",
            "cos",
            "atan",
            "sum-threshold",
            "sign-of",
            "min",
            "max",
            "if",
            "mem",
            "saw-wave",
            "log",
            "ln",
            "expt",
            "interpolate",
            "differentiate",
        ];
        assert_eq!(names, expected);
    }
}

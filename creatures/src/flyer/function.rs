//! The eighteen functions of a flyer's neurons (F-28, F-29). They hold no state: what a neuron saw before
//! is handed to them.

use serde::{Deserialize, Serialize};

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
}

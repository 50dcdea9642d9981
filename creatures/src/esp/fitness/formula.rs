//! Formulas over what is recorded of a trial, such as `clamp01(0.5 + 0.5 * mean_last(up_z, 2.0))` (E-58). A
//! measure varies over the trial; a reducer makes one number of it. No loops, no names of one's own.

mod parse;

use super::record::{Moment, Record, least_of, mean_of, most_of};
use super::share;
use serde::{Deserialize, Serialize};

/// A formula as written, and what it means.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Formula {
    text: String,
    term: Term,
}

/// Why a text is not a formula.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{problem} (column {column})")]
pub struct FormulaError {
    /// Where in the text, in characters from 1.
    pub column: usize,
    /// What is wrong there.
    pub problem: String,
}

/// Part of a formula.
#[derive(Debug, Clone, PartialEq)]
enum Term {
    Number(f64),
    Reduced(Reducer, Quantity),
    /// The mean over so many last seconds.
    MeanLast(Quantity, f64),
    Negated(Box<Term>),
    Joined(Operator, Box<Term>, Box<Term>),
    Called(Function, Vec<Term>),
}

/// What makes one number of a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reducer {
    First,
    Last,
    Mean,
    Min,
    Max,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
}

/// A function of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Function {
    Clamp01,
    Abs,
    Min,
    Max,
}

/// What is measured at every moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// `com_x`: of the centre of mass, ahead of where it started, m.
    ComX,
    /// `com_y`: to the left of where it started, m.
    ComY,
    /// `com_z`: above the ground, m.
    ComZ,
    /// `speed`: of the centre of mass, m/s.
    Speed,
    /// `yaw`: turned to the left since the start, rad.
    Yaw,
    /// `up_z`: −1 upside down, 1 upright.
    UpZ,
    /// `top_z`: height of the highest point, m.
    TopZ,
    /// `ground_force_bw`: normal force of the ground, body weights.
    GroundForce,
    /// `light_distance`: horizontal, m.
    LightDistance,
    /// `light_angle`: from the forward axis, left positive, rad.
    LightAngle,
    /// `activation`: of the muscles, weighted by their strength.
    Activation,
    /// `touched`: 1 while a disc is touched, else 0.
    Touched,
}

impl Quantity {
    /// Every measure.
    const ALL: [Quantity; 12] = [
        Quantity::ComX,
        Quantity::ComY,
        Quantity::ComZ,
        Quantity::Speed,
        Quantity::Yaw,
        Quantity::UpZ,
        Quantity::TopZ,
        Quantity::GroundForce,
        Quantity::LightDistance,
        Quantity::LightAngle,
        Quantity::Activation,
        Quantity::Touched,
    ];

    /// Its name in formulas.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::ComX => "com_x",
            Quantity::ComY => "com_y",
            Quantity::ComZ => "com_z",
            Quantity::Speed => "speed",
            Quantity::Yaw => "yaw",
            Quantity::UpZ => "up_z",
            Quantity::TopZ => "top_z",
            Quantity::GroundForce => "ground_force_bw",
            Quantity::LightDistance => "light_distance",
            Quantity::LightAngle => "light_angle",
            Quantity::Activation => "activation",
            Quantity::Touched => "touched",
        }
    }

    fn of(self, moment: &Moment) -> f64 {
        match self {
            Quantity::ComX => moment.position.x,
            Quantity::ComY => moment.position.y,
            Quantity::ComZ => moment.position.z,
            Quantity::Speed => moment.speed,
            Quantity::Yaw => moment.yaw,
            Quantity::UpZ => moment.up,
            Quantity::TopZ => moment.top,
            Quantity::GroundForce => moment.ground_force,
            Quantity::LightDistance => moment.light_distance,
            Quantity::LightAngle => moment.light_angle,
            Quantity::Activation => moment.effort,
            Quantity::Touched => f64::from(u8::from(moment.touched)),
        }
    }
}

impl Formula {
    /// Reads a formula.
    ///
    /// # Errors
    /// EF-4: where the text stops being one, and what could stand there.
    pub fn new(text: impl Into<String>) -> Result<Formula, FormulaError> {
        let text = text.into();
        let term = parse::parse(&text)?;
        Ok(Formula { text, term })
    }

    /// Its value over a trial; 0 where that is not finite, as after a division by 0.
    pub fn value(&self, record: &Record) -> f64 {
        let value = self.term.value(record);
        if value.is_finite() { value } else { 0.0 }
    }

    /// Every measure in it.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut quantities = Vec::new();
        self.term.collect(&mut quantities);
        quantities
    }
}

impl TryFrom<String> for Formula {
    type Error = FormulaError;

    fn try_from(text: String) -> Result<Formula, FormulaError> {
        Formula::new(text)
    }
}

impl From<Formula> for String {
    fn from(formula: Formula) -> String {
        formula.text
    }
}

impl Term {
    fn value(&self, record: &Record) -> f64 {
        match self {
            Term::Number(number) => *number,
            Term::Reduced(reducer, quantity) => reducer.reduce(record, *quantity),
            Term::MeanLast(quantity, seconds) => {
                let count = super::setup::steps(*seconds).clamp(1, record.moments.len().max(1));
                let last = &record.moments[record.moments.len().saturating_sub(count)..];
                mean_of(last, |moment| quantity.of(moment))
            }
            Term::Negated(term) => -term.value(record),
            Term::Joined(operator, left, right) => {
                let (left, right) = (left.value(record), right.value(record));
                match operator {
                    Operator::Add => left + right,
                    Operator::Subtract => left - right,
                    Operator::Multiply => left * right,
                    Operator::Divide => left / right,
                }
            }
            Term::Called(function, arguments) => {
                let mut values = arguments.iter().map(|argument| argument.value(record));
                let first = values.next().unwrap_or(0.0);
                match function {
                    Function::Clamp01 => share(first),
                    Function::Abs => first.abs(),
                    Function::Min => {
                        values.fold(first, |least, next| if next < least { next } else { least })
                    }
                    Function::Max => values.fold(first, |most, next| if next > most { next } else { most }),
                }
            }
        }
    }

    fn collect(&self, quantities: &mut Vec<Quantity>) {
        match self {
            Term::Number(_) => {}
            Term::Reduced(_, quantity) | Term::MeanLast(quantity, _) => quantities.push(*quantity),
            Term::Negated(term) => term.collect(quantities),
            Term::Joined(_, left, right) => {
                [left, right].into_iter().for_each(|term| term.collect(quantities))
            }
            Term::Called(_, arguments) => arguments.iter().for_each(|term| term.collect(quantities)),
        }
    }
}

impl Reducer {
    /// Over every moment after the start; the first is that at the start.
    fn reduce(self, record: &Record, quantity: Quantity) -> f64 {
        let of = |moment: &Moment| quantity.of(moment);
        match self {
            Reducer::First => record.moments.first().map_or(0.0, of),
            Reducer::Last => of(&record.last()),
            Reducer::Mean => mean_of(record.lived(), of),
            Reducer::Min => least_of(record.lived(), of),
            Reducer::Max => most_of(record.lived(), of),
        }
    }
}

#[cfg(test)]
mod tests;

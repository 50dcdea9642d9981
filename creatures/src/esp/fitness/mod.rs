//! Fitness: the registry of kinds, one file each (E-58, E-70..E-79). A kind says which trials it wants and
//! scores what was recorded of them; it never steps a creature. Each score is a pure function.

mod attack;
mod avert_light;
mod expression;
mod face_light;
mod fight_or_flight;
mod flee_light;
mod formula;
mod high_reach;
mod locomotion;
mod ranges;
mod reach_light;
mod record;
pub mod setup;
mod strike;
mod turn;

pub use attack::Attack;
pub use avert_light::AvertLight;
pub use expression::Expression;
pub use face_light::FaceLight;
pub use fight_or_flight::FightOrFlight;
pub use flee_light::FleeLight;
pub use formula::Formula;
pub use high_reach::HighReach;
pub use locomotion::Locomotion;
pub use reach_light::ReachLight;
pub use record::{Moment, Record};
pub use setup::{End, Form, Setup, Start, Target};
pub use strike::Strike;
pub use turn::Turn;

use super::syllabus::Syllabus;
use crate::{SpecError, read_spec};
use serde::Serialize;
use std::collections::BTreeMap;

/// What a kind of fitness asks of trials and makes of them.
pub trait Scoring {
    /// Checks every parameter (EF-4, EF-16).
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    fn check(&self) -> Result<(), SpecError>;

    /// The trials, in order.
    fn trials(&self, context: &Context) -> Vec<Setup>;

    /// The score of one trial that came to its end.
    fn score(&self, setup: &Setup, record: &Record, context: &Context) -> f64;

    /// The score of one that the physics ended (E-23).
    fn score_of_fault(&self, setup: &Setup) -> f64 {
        let _ = setup; // it is 0 wherever no trial can cost anything
        0.0
    }

    /// The fitness, from the score of every trial in order.
    fn combine(&self, scores: &[f64]) -> f64 {
        mean(scores)
    }

    /// What else is worth knowing of one trial.
    fn gauge(&self, record: &Record) -> Option<(&'static str, f64)> {
        let _ = record; // most kinds have said everything with their score
        None
    }

    /// What else is worth knowing of all trials.
    fn measures(&self, scores: &[f64]) -> Vec<(&'static str, f64)> {
        let _ = scores; // most kinds have said everything with their fitness
        Vec::new()
    }

    /// Skills whose parameters or measures the kind needs.
    fn references(&self) -> Vec<Reference<'_>> {
        Vec::new()
    }
}

/// A skill that another skill's fitness refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reference<'a> {
    /// The parameter that names it.
    pub key: &'static str,
    /// Its name.
    pub name: &'a str,
    /// The kind of fitness that it has to have.
    pub kind: &'static str,
}

/// What a kind may know besides its own parameters.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// Where other skills' parameters are.
    pub syllabus: &'a Syllabus,
    /// The measured impact of skills that strike, body weights, by name (E-74).
    pub impacts: &'a BTreeMap<String, f64>,
}

impl<'a> Context<'a> {
    /// The fitness of a skill of a name.
    fn fitness(&self, name: &str) -> Option<&'a Fitness> {
        let id = self.syllabus.find(name)?;
        Some(self.syllabus.skills()[id.index()].fitness())
    }
}

/// The parameters of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Fitness {
    /// Straight ahead, fast and with little effort.
    Locomotion(Locomotion),
    /// Round, on the spot.
    Turn(Turn),
    /// Towards a light with the front.
    FaceLight(FaceLight),
    /// To a light.
    ReachLight(ReachLight),
    /// Hard on the ground.
    Strike(Strike),
    /// Hard on the ground, at a light.
    Attack(Attack),
    /// Away from a light with the front.
    AvertLight(AvertLight),
    /// Away from a light.
    FleeLight(FleeLight),
    /// To what is vulnerable, away from what is dangerous.
    FightOrFlight(FightOrFlight),
    /// High up.
    HighReach(HighReach),
    /// Whatever a formula says.
    Expression(Expression),
}

/// Reads the parameters of one kind.
type Reader = fn(serde_json::Value) -> Result<Fitness, SpecError>;

/// Every kind, by the name of its key in files.
const KINDS: [(&str, Reader); 11] = [
    ("locomotion", |table| Ok(Fitness::Locomotion(read_spec(table)?))),
    ("turn", |table| Ok(Fitness::Turn(read_spec(table)?))),
    ("face_light", |table| Ok(Fitness::FaceLight(read_spec(table)?))),
    ("reach_light", |table| Ok(Fitness::ReachLight(read_spec(table)?))),
    ("strike", |table| Ok(Fitness::Strike(read_spec(table)?))),
    ("attack", |table| Ok(Fitness::Attack(read_spec(table)?))),
    ("avert_light", |table| Ok(Fitness::AvertLight(read_spec(table)?))),
    ("flee_light", |table| Ok(Fitness::FleeLight(read_spec(table)?))),
    ("fight_or_flight", |table| Ok(Fitness::FightOrFlight(read_spec(table)?))),
    ("high_reach", |table| Ok(Fitness::HighReach(read_spec(table)?))),
    ("expression", |table| Ok(Fitness::Expression(read_spec(table)?))),
];

impl Fitness {
    /// The name of every kind.
    pub fn kinds() -> impl Iterator<Item = &'static str> {
        KINDS.iter().map(|(name, _)| *name)
    }

    /// Reads `kind` and its parameters, and checks them.
    ///
    /// # Errors
    /// EF-4: an unknown kind with those that are known, an unknown key, a wrong type, a value out of range.
    pub fn read(table: &serde_json::Value) -> Result<Fitness, SpecError> {
        let serde_json::Value::Object(mut table) = table.clone() else {
            return Err(SpecError::new("", "is not a table with a `kind`"));
        };
        let kind = table.remove("kind");
        let reader =
            kind.as_ref().and_then(|kind| KINDS.iter().find(|(name, _)| kind.as_str() == Some(name)));
        let Some((_, reader)) = reader else {
            let known = Fitness::kinds().collect::<Vec<_>>().join("`, `");
            let found = kind.map_or_else(|| "is missing".to_owned(), |kind| format!("{kind} is none"));
            return Err(SpecError::new("kind", format!("{found}; known are `{known}`")));
        };
        let fitness = reader(table.into())?;
        fitness.scoring().check()?;
        Ok(fitness)
    }

    /// Its kind's name.
    pub fn kind(&self) -> &'static str {
        match self {
            Fitness::Locomotion(_) => "locomotion",
            Fitness::Turn(_) => "turn",
            Fitness::FaceLight(_) => "face_light",
            Fitness::ReachLight(_) => "reach_light",
            Fitness::Strike(_) => "strike",
            Fitness::Attack(_) => "attack",
            Fitness::AvertLight(_) => "avert_light",
            Fitness::FleeLight(_) => "flee_light",
            Fitness::FightOrFlight(_) => "fight_or_flight",
            Fitness::HighReach(_) => "high_reach",
            Fitness::Expression(_) => "expression",
        }
    }

    /// What its kind does.
    pub fn scoring(&self) -> &dyn Scoring {
        match self {
            Fitness::Locomotion(kind) => kind,
            Fitness::Turn(kind) => kind,
            Fitness::FaceLight(kind) => kind,
            Fitness::ReachLight(kind) => kind,
            Fitness::Strike(kind) => kind,
            Fitness::Attack(kind) => kind,
            Fitness::AvertLight(kind) => kind,
            Fitness::FleeLight(kind) => kind,
            Fitness::FightOrFlight(kind) => kind,
            Fitness::HighReach(kind) => kind,
            Fitness::Expression(kind) => kind,
        }
    }

    /// Skills whose parameters or measures it needs.
    pub fn references(&self) -> Vec<Reference<'_>> {
        self.scoring().references()
    }
}

/// The plain mean, 0 of nothing.
fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// Limits a share to [0, 1]; what is no number is 0.
fn share(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}

#[cfg(test)]
pub(super) mod tests;

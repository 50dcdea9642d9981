//! What an evaluation comes to. A creature's misfortune is an outcome, never an error.

use serde::{Deserialize, Serialize};

/// How an evaluation ended. `failed` (a genotype that kills its workers) is the service's word, not a
/// creature's, and stands in the lineage alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Simulated to its end.
    Completed,
    /// Stopped at its interim report, since its measure was below the cutoff.
    Culled,
    /// Stopped by the physics; fitness 0, kept in the lineage, not tried again.
    Aborted(Reason),
}

/// The physical reasons that end one evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// A pose, a velocity or a sensor is NaN or infinite (walker X-11).
    NonFinite,
    /// A quantity has left the bounds within which the model means anything (walker X-12).
    BlowUp,
    /// Parts of the body pass through each other before it moves at all (flyer F-23, X-9).
    SelfIntersecting,
    /// A joint has come apart (ESP E-23).
    JointSeparation,
    /// A part has sunk into the ground (ESP E-23).
    Sinking,
    /// There is more energy than the muscles gave (ESP E-23).
    EnergyFromNothing,
    /// It still moves by itself when its trial should begin (ESP E-20).
    Unsettled,
}

impl Reason {
    /// Every reason, for those who list them.
    pub const ALL: [Reason; 7] = [
        Reason::NonFinite,
        Reason::BlowUp,
        Reason::SelfIntersecting,
        Reason::JointSeparation,
        Reason::Sinking,
        Reason::EnergyFromNothing,
        Reason::Unsettled,
    ];

    /// The word used in the lineage: `aborted:WORD`.
    pub fn word(self) -> &'static str {
        match self {
            Reason::NonFinite => "non_finite",
            Reason::BlowUp => "blow_up",
            Reason::SelfIntersecting => "self_intersecting",
            Reason::JointSeparation => "joint_separation",
            Reason::Sinking => "sinking",
            Reason::EnergyFromNothing => "energy_from_nothing",
            Reason::Unsettled => "unsettled",
        }
    }
}

/// What `evaluate` gives: the same bits on every machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Larger is better; 0 unless completed.
    pub fitness: f64,
    /// Physics steps simulated.
    pub steps: u32,
    /// What else was measured, in the task's fixed order.
    pub measures: Vec<(String, f64)>,
    /// The interim report, when one was asked for and reached.
    pub interim: Option<Interim>,
    /// For an aborted evaluation, which quantity at which step; empty otherwise.
    pub note: String,
}

impl Outcome {
    /// BLAKE3 over every field, floats by their bits: equal digests are equal outcomes.
    pub fn digest(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        let status = match self.status {
            Status::Completed => "completed".to_owned(),
            Status::Culled => "culled".to_owned(),
            Status::Aborted(reason) => format!("aborted:{}", reason.word()),
        };
        let mut text = |t: &str| {
            hasher.update(&(t.len() as u64).to_le_bytes());
            hasher.update(t.as_bytes());
        };
        text(&status);
        text(&self.note);
        for (name, _) in &self.measures {
            text(name);
        }
        hasher.update(&self.fitness.to_bits().to_le_bytes());
        hasher.update(&self.steps.to_le_bytes());
        for (_, value) in &self.measures {
            hasher.update(&value.to_bits().to_le_bytes());
        }
        if let Some(interim) = self.interim {
            hasher.update(&interim.step.to_le_bytes());
            hasher.update(&interim.measure.to_bits().to_le_bytes());
        }
        *hasher.finalize().as_bytes()
    }
}

/// A creature's standing at its interim report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interim {
    /// Physics steps simulated so far.
    pub step: u32,
    /// The task's interim measure; larger is better.
    pub measure: f64,
}

/// The culling rule as one evaluation gets it (design: culling). The cutoff comes from the completed
/// previous generation, so that it depends on places and never on arrival.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cull {
    /// The share of the task's steps after which the interim report is made, within (0, 1).
    pub at: f64,
    /// Measures below this are culled; none in a first generation.
    pub cutoff: Option<f64>,
    /// Of the control sample: ruled on, yet run to its end, to measure false culls.
    pub control: bool,
}

/// What the rule says of a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Goes on.
    Pass,
    /// Stops here.
    Cull,
    /// Would have been stopped, and goes on for the control sample.
    Spare,
}

impl Cull {
    /// Rules on a measure: strictly below the cutoff is culled.
    pub fn verdict(&self, measure: f64) -> Verdict {
        match self.cutoff {
            Some(cutoff) if measure < cutoff && self.control => Verdict::Spare,
            Some(cutoff) if measure < cutoff => Verdict::Cull,
            _ => Verdict::Pass,
        }
    }
}

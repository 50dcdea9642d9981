//! The published systems: genotype, variation, phenotype, simulation, task and fitness of one creature.
//!
//! Pure: no I/O, no async, no clock, no thread, no hash order, no platform floats. The one function that
//! the service exists to call is [`Task::evaluate`].

pub mod encoding;
pub mod esp;
pub mod fish;
pub mod flyer;
pub mod math;
pub mod observer;
pub mod outcome;
pub mod physics;
pub mod probe;
pub mod random;
pub mod record;
pub mod walker;

pub use encoding::DecodeError;
pub use observer::{Nobody, Observer};
pub use outcome::{Cull, Interim, Outcome, Reason, Status, Verdict};

/// Every published system, by name.
pub fn systems() -> [&'static dyn System; 5] {
    [&probe::Probe, &walker::Walker, &flyer::Flyer, &fish::Fish, &esp::Esp]
}

/// The system of a name.
pub fn system(name: &str) -> Option<&'static dyn System> {
    systems().into_iter().find(|system| system.name() == name)
}

/// One published system: how its tasks are read and its genotypes lived.
pub trait System: Send + Sync {
    /// Its name in experiment files, on the wire and in the lineage.
    fn name(&self) -> &'static str;

    /// Raised whenever the same genotype and task may give other bits. Outcomes of different versions are
    /// never mixed.
    fn version(&self) -> u32;

    /// The `[task]` table of an experiment with every default filled in.
    ///
    /// # Errors
    /// An unknown key, a wrong type or a value out of range, with the path of the key.
    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError>;

    /// A task ready to evaluate, from the JSON text of a resolved table. This is what travels on the wire.
    ///
    /// # Errors
    /// As [`System::resolve`].
    fn task(&self, resolved: &str) -> Result<Box<dyn Task>, SpecError>;

    /// What the interim measure of a resolved task is called at the end of an evaluation: `fitness`, or the
    /// name of one of the outcome's measures. The culling rule looks there for what the least fit reached.
    fn interim_measure(&self, task: &serde_json::Value) -> &'static str {
        let _ = task; // most systems have one measure for all their tasks
        "fitness"
    }

    /// The task and genotypes whose outcomes prove that a machine computes as every other does.
    fn proofs(&self) -> Vec<Proof>;
}

/// What a creature has to do: everything an evaluation needs besides genotype and seed.
pub trait Task: Send + Sync {
    /// Checks that bytes are a legal genotype for this task, without living it.
    ///
    /// # Errors
    /// The field that is wrong and what is allowed.
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError>;

    /// Lives one genotype: a pure function of its arguments, the same bits on every machine.
    ///
    /// With `cull`, the observer hears the interim report once, and a creature below the cutoff stops there,
    /// unless it is of the control sample. Whatever the observer does, the outcome is the same.
    ///
    /// # Errors
    /// Only for bytes that are no legal genotype; whatever befalls the creature is an outcome.
    fn evaluate(
        &self,
        genotype: &[u8],
        seed: u64,
        cull: Option<&Cull>,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError>;
}

/// One evaluation of a fingerprint.
#[derive(Debug, Clone)]
pub struct Proof {
    /// JSON text of a resolved task.
    pub task: String,
    /// A genotype for it.
    pub genotype: Vec<u8>,
    /// The evaluation's seed.
    pub seed: u64,
}

/// What is wrong with a table of an experiment file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{path}`: {problem}")]
pub struct SpecError {
    /// The key, dotted, relative to the table: `neat.threshold`.
    pub path: String,
    /// What is wrong, and what is allowed.
    pub problem: String,
}

impl SpecError {
    /// A problem with the key of a path.
    pub fn new(path: impl Into<String>, problem: impl Into<String>) -> Self {
        SpecError { path: path.into(), problem: problem.into() }
    }

    /// The same problem as seen from the table that holds this one under a key.
    #[must_use]
    pub fn below(self, key: &str) -> Self {
        let dot = if self.path.is_empty() || self.path.starts_with('[') { "" } else { "." };
        SpecError { path: format!("{key}{dot}{}", self.path), ..self }
    }
}

/// Reads a table of an experiment into its type; unknown keys are errors where the type says so.
///
/// # Errors
/// The path of the offending key and serde's words for the problem.
pub fn read_spec<T: serde::de::DeserializeOwned>(table: serde_json::Value) -> Result<T, SpecError> {
    serde_path_to_error::deserialize(table).map_err(|error| {
        let path = error.path().to_string();
        SpecError::new(if path == "." { String::new() } else { path }, error.inner().to_string())
    })
}

/// The physics fingerprint of this build on this machine: BLAKE3 over the outcomes of every system's
/// proofs (design: determinism). Two workers with equal fingerprints compute equal lineages.
pub fn fingerprint() -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for system in systems() {
        hasher.update(system.name().as_bytes());
        hasher.update(&system.version().to_le_bytes());
        for proof in system.proofs() {
            let task = system.task(&proof.task).expect("a proof's task is legal; a test says so");
            let outcome = task
                .evaluate(&proof.genotype, proof.seed, None, &mut Nobody)
                .expect("a proof's genotype is legal; a test says so");
            hasher.update(&outcome.digest());
        }
    }
    *hasher.finalize().as_bytes()
}

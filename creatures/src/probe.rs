//! The probe: a system without a creature, for measuring the service itself. Its genotype is any bytes,
//! its life a stretch of arithmetic, its fitness a number in [0, 1) drawn from the genotype's hash. It
//! touches no physics.

use crate::{
    Cull, DecodeError, Interim, Observer, Outcome, Proof, SpecError, Status, System, Task, Verdict, encoding,
    read_spec,
};
use serde::{Deserialize, Serialize};

/// The registry's entry.
#[derive(Debug)]
pub struct Probe;

/// The `[task]` table of a probe experiment.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProbeTask {
    /// BLAKE3 compressions an evaluation, about 0.1 microseconds each; 0 is a no-op.
    pub work: u32,
}

impl System for Probe {
    fn name(&self) -> &'static str {
        "probe"
    }

    fn version(&self) -> u32 {
        1
    }

    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError> {
        let task: ProbeTask = read_spec(task)?;
        Ok(serde_json::to_value(task).expect("a plain struct serialises"))
    }

    fn task(&self, resolved: &str) -> Result<Box<dyn Task>, SpecError> {
        let value = serde_json::from_str(resolved).map_err(|e| SpecError::new("", e.to_string()))?;
        Ok(Box::new(read_spec::<ProbeTask>(value)?))
    }

    fn proofs(&self) -> Vec<Proof> {
        vec![Proof { task: r#"{"work":8}"#.to_owned(), genotype: b"probe".to_vec(), seed: 1 }]
    }
}

impl Task for ProbeTask {
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError> {
        if genotype.len() > encoding::SIZE_MAX {
            return Err(DecodeError::TooLarge { found: genotype.len() });
        }
        Ok(())
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        seed: u64,
        cull: Option<&Cull>,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        self.check(genotype)?;
        let mut hasher = blake3::Hasher::new();
        hasher.update(&seed.to_le_bytes());
        let mut state = *hasher.update(genotype).finalize().as_bytes();
        let word = state[..8].try_into().expect("32 bytes hold 8");
        let fitness = (u64::from_le_bytes(word) >> 11) as f64 / (1u64 << 53) as f64;
        let mut outcome = Outcome {
            status: Status::Completed,
            fitness,
            steps: self.work,
            measures: vec![],
            interim: None,
            note: String::new(),
        };
        let interim_step = cull.map(|cull| (cull.at * f64::from(self.work)) as u32);
        for step in 0..=self.work {
            if let Some(cull) = cull.filter(|_| Some(step) == interim_step) {
                let interim = Interim { step, measure: fitness };
                outcome.interim = Some(interim);
                observer.interim(interim);
                if cull.verdict(interim.measure) == Verdict::Cull {
                    return Ok(Outcome { status: Status::Culled, fitness: 0.0, steps: step, ..outcome });
                }
            }
            state = *blake3::hash(&state).as_bytes();
        }
        outcome.measures.push(("echo".to_owned(), f64::from(state[0])));
        Ok(outcome)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Nobody;

    #[test]
    fn a_probe_is_culled_below_its_cutoff_and_spared_in_the_control_sample() {
        let task = ProbeTask { work: 100 };
        let free = task.evaluate(b"x", 1, None, &mut Nobody).unwrap();
        let cull = Cull { at: 0.25, cutoff: Some(1.0), control: false };
        let mut seen = None;
        let culled = task.evaluate(b"x", 1, Some(&cull), &mut |interim| seen = Some(interim)).unwrap();
        assert_eq!((culled.status, culled.steps, culled.fitness), (Status::Culled, 25, 0.0));
        assert_eq!(seen, Some(Interim { step: 25, measure: free.fitness }));
        let spared = task.evaluate(b"x", 1, Some(&Cull { control: true, ..cull }), &mut Nobody).unwrap();
        assert_eq!((spared.status, spared.fitness), (Status::Completed, free.fitness));
    }
}

//! An individual lived again on this machine, from what the lineage has of it alone, and every bit of its fitness
//! compared with what was recorded.

use anyhow::{Context, anyhow};
use creatures::record::{Keeper, Recording, Subject};
use creatures::{Cull, Nobody, Observer, Outcome, Status, System};
use proto::v1::{Genotype, IndividualReply};
use serde_json::{Value, json};

use crate::exit::Failure;
use crate::render::number;

/// What is recorded of a life: one trial, one step in so many.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watched {
    /// From 1.
    pub(super) trial: u32,
    pub(super) every: u32,
}

/// One life again.
pub(super) struct Life {
    pub(super) recorded: IndividualReply,
    outcome: Outcome,
    /// What came out differently; nothing if all bits are equal.
    pub(super) differences: Vec<String>,
    pub(super) seen: Option<Seen>,
}

/// What was seen of a life.
pub(super) struct Seen {
    pub(super) recording: Recording,
    pub(super) subject: Subject,
    /// How many the evaluation has.
    trials: u32,
}

impl Life {
    /// Lives an individual again, and records it if it is to be watched.
    ///
    /// # Errors
    /// It has no outcome, another version or system, no body to record, or no such trial.
    pub(super) fn again(recorded: IndividualReply, watched: Option<Watched>) -> Result<Life, Failure> {
        let Some(Watched { trial, every }) = watched else {
            let outcome = live(&recorded, &mut Nobody)?;
            let differences = differences(&recorded, &outcome);
            return Ok(Life { recorded, outcome, differences, seen: None });
        };
        let mut keeper = Keeper::new(trial - 1, every);
        let outcome = live(&recorded, &mut keeper)?;
        let (id, trials) = (recorded.id, keeper.trials());
        let recording = keeper.recording().ok_or_else(|| match trials {
            0 => Failure::Failed(anyhow!("individual {id} has no body: there is nothing to record")),
            _ => Failure::NotFound(format!("individual {id} has no trial {trial}, only {trials}")),
        })?;
        let subject = subject(&recorded, trial)?;
        let differences = differences(&recorded, &outcome);
        Ok(Life { recorded, outcome, differences, seen: Some(Seen { recording, subject, trials }) })
    }

    /// What was recorded and what came out, as JSON.
    pub(super) fn document(&self) -> Value {
        let Life { recorded, outcome, differences, .. } = self;
        json!({
            "individual": recorded.id,
            "equal": differences.is_empty(),
            "recorded": { "status": recorded.status, "fitness": recorded.fitness,
                "fitness_bits": recorded.fitness.map(number::bits), "steps": recorded.steps },
            "replayed": { "status": word(outcome.status), "fitness": outcome.fitness,
                "fitness_bits": number::bits(outcome.fitness), "steps": outcome.steps },
            "differences": differences,
        })
    }

    /// How it came out, and that it is what was recorded.
    pub(super) fn line(&self) -> String {
        format!(
            "individual {}: {}, fitness {} ({}), {} steps: equal bit for bit",
            self.recorded.id,
            word(self.outcome.status),
            number::figure(self.outcome.fitness),
            number::bits(self.outcome.fitness),
            number::count(self.outcome.steps.into())
        )
    }

    /// What a picture of it is headed with.
    pub(super) fn captions(&self, seen: &Seen) -> [String; 2] {
        let recorded = &self.recorded;
        let title = format!(
            "{} {} of {}, run {}, generation {}",
            seen.subject.system, recorded.id, recorded.experiment_name, recorded.run, recorded.generation
        );
        let mut parts =
            vec![word(self.outcome.status), format!("fitness {}", number::figure(self.outcome.fitness))];
        if seen.trials > 1 {
            parts.push(format!("trial {} of {}", seen.subject.trial, seen.trials));
        }
        let end = seen.recording.shots.last().map_or(0.0, |shot| shot.time);
        parts.push(format!("{end:.2} {}", seen.recording.scene.time_unit).trim_end().to_owned());
        [title, parts.join(", ")]
    }

    /// Who it is and how fit, in few words.
    pub(super) fn caption(&self) -> String {
        let Life { recorded, outcome, .. } = self;
        format!(
            "{} ({}, generation {}): fitness {}",
            recorded.id,
            recorded.operator,
            recorded.generation,
            number::figure(outcome.fitness)
        )
    }
}

/// What is said where the evaluation itself fails, which no genotype should bring about.
pub(super) fn died(id: u64, error: tokio::task::JoinError) -> anyhow::Error {
    anyhow!("individual {id} ends the evaluation that lives it: {error}")
}

pub(super) fn subject(recorded: &IndividualReply, trial: u32) -> Result<Subject, Failure> {
    let system = system(recorded)?;
    Ok(Subject {
        system: system.name().to_owned(),
        version: system.version(),
        individual: recorded.id,
        task: serde_json::from_str(&recorded.task)
            .with_context(|| format!("the task of individual {}", recorded.id))?,
        seed: recorded.seed,
        trial,
        light: None,
    })
}

/// Evaluates the recorded genotype under the recorded task, seed and culling rule.
fn live(recorded: &IndividualReply, observer: &mut dyn Observer) -> Result<Outcome, Failure> {
    let id = recorded.id;
    match recorded.status.as_str() {
        "pending" => {
            return Err(anyhow!("individual {id} has no outcome yet: there is nothing to compare").into());
        }
        "failed" => {
            return Err(anyhow!(
                "individual {id} was set aside, so there is no outcome to compare: {}",
                recorded.note
            )
            .into());
        }
        _ => {}
    }
    let genotype = genotype(recorded)?;
    let system = system(recorded)?;
    same_version(recorded, genotype, system)?;
    let task = system.task(&recorded.task).with_context(|| format!("the task of individual {id}"))?;
    let cull =
        recorded.cull.as_ref().map(|cull| Cull { at: cull.at, cutoff: cull.cutoff, control: cull.control });
    let outcome = task
        .evaluate(&genotype.payload, recorded.seed, cull.as_ref(), observer)
        .with_context(|| format!("the genotype of individual {id}"))?;
    Ok(outcome)
}

/// Outcomes of different versions are never compared (walker X-21).
pub(super) fn same_version(
    recorded: &IndividualReply,
    genotype: &Genotype,
    system: &dyn System,
) -> Result<(), Failure> {
    if genotype.version == system.version() {
        return Ok(());
    }
    let (id, lived, name) = (recorded.id, genotype.version, system.name());
    let now = system.version();
    Err(anyhow!("individual {id} lived in version {lived} of {name}, this release has version {now}").into())
}

pub(super) fn genotype(recorded: &IndividualReply) -> Result<&Genotype, Failure> {
    let genotype = recorded.genotype.as_ref();
    Ok(genotype.ok_or_else(|| anyhow!("individual {} comes without a genotype", recorded.id))?)
}

pub(super) fn system(recorded: &IndividualReply) -> Result<&'static dyn System, Failure> {
    let name = &genotype(recorded)?.system;
    Ok(creatures::system(name).ok_or_else(|| anyhow!("this release does not know the system `{name}`"))?)
}

/// What came out differently, with both values; floats by their bits.
fn differences(recorded: &IndividualReply, lived: &Outcome) -> Vec<String> {
    let mut differences = Vec::new();
    let mut compare = |what: &str, recorded: String, replayed: String| {
        if recorded != replayed {
            differences.push(format!("{what} recorded {recorded}, replayed {replayed}"));
        }
    };
    let shown = |value: Option<f64>| {
        value.map_or("none".to_owned(), |value| format!("{value} ({})", number::bits(value)))
    };
    compare("status", recorded.status.clone(), word(lived.status));
    compare("fitness", shown(recorded.fitness), shown(Some(lived.fitness)));
    compare("steps", recorded.steps.to_string(), lived.steps.to_string());
    if let (Some(then), Some(now)) = (&recorded.interim, &lived.interim) {
        compare("interim measure", shown(then.measure), shown(Some(now.measure)));
    }
    differences
}

/// A status as the lineage spells it.
fn word(status: Status) -> String {
    match status {
        Status::Completed => "completed".to_owned(),
        Status::Culled => "culled".to_owned(),
        Status::Aborted(reason) => format!("aborted:{}", reason.word()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A probe as a coordinator would record it.
    fn recorded() -> IndividualReply {
        let mut recorded = IndividualReply {
            id: 7,
            status: "completed".into(),
            genotype: Some(Genotype { system: "probe".into(), version: 1, payload: vec![1, 2, 3].into() }),
            task: r#"{"work":8}"#.into(),
            seed: 5,
            ..Default::default()
        };
        let lived = live(&recorded, &mut Nobody).unwrap();
        recorded.fitness = Some(lived.fitness);
        recorded.steps = lived.steps.into();
        recorded
    }

    #[test]
    fn an_individual_lives_again_to_the_same_bits() {
        let recorded = recorded();
        assert_eq!(differences(&recorded, &live(&recorded, &mut Nobody).unwrap()), [""; 0]);
    }

    #[test]
    fn one_bit_of_the_fitness_is_a_difference_and_both_patterns_are_shown() {
        let mut recorded = recorded();
        let truth = recorded.fitness.unwrap();
        let off = f64::from_bits(truth.to_bits() ^ 1);
        recorded.fitness = Some(off);
        let differences = differences(&recorded, &live(&recorded, &mut Nobody).unwrap());
        assert_eq!(differences.len(), 1);
        assert!(differences[0].contains(&number::bits(truth)) && differences[0].contains(&number::bits(off)));
    }

    #[test]
    fn what_has_no_outcome_or_is_of_another_version_is_not_compared() {
        for (status, word) in [("pending", "no outcome yet"), ("failed", "set aside")] {
            let failure =
                live(&IndividualReply { status: status.into(), ..recorded() }, &mut Nobody).unwrap_err();
            assert!(failure.to_string().contains(word), "{failure}");
        }
        let mut old = recorded();
        old.genotype.as_mut().unwrap().version = 0;
        assert!(live(&old, &mut Nobody).unwrap_err().to_string().contains("version 0 of probe"));
    }
}

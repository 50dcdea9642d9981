//! `hatchery replay`: lives an individual again on this machine, from the lineage alone, and compares every
//! bit of its fitness with what was recorded. It writes nothing.

use anyhow::{Context, anyhow};
use creatures::{Cull, Outcome, Status};
use proto::v1::IndividualReply;
use serde_json::json;

use super::show::fetch;
use crate::arguments::AskIndividual;
use crate::connect::{Connection, Source};
use crate::exit::Failure;
use crate::render::{Output, number};

pub(super) async fn replay(arguments: AskIndividual, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let recorded = fetch(&connection, arguments.individual).await?;
    let id = recorded.id;
    let (recorded, lived) =
        tokio::task::spawn_blocking(move || live(&recorded).map(|lived| (recorded, lived)))
            .await
            .map_err(|error| anyhow!("individual {id} ends the evaluation that lives it: {error}"))??;
    let differences = differences(&recorded, &lived);
    if output.json {
        output.document(&json!({
            "individual": recorded.id,
            "equal": differences.is_empty(),
            "recorded": { "status": recorded.status, "fitness": recorded.fitness,
                "fitness_bits": recorded.fitness.map(number::bits), "steps": recorded.steps },
            "replayed": { "status": word(lived.status), "fitness": lived.fitness,
                "fitness_bits": number::bits(lived.fitness), "steps": lived.steps },
            "differences": differences,
        }))?;
    } else if differences.is_empty() {
        output.line(format!(
            "individual {}: {}, fitness {} ({}), {} steps: equal bit for bit",
            recorded.id,
            word(lived.status),
            number::figure(lived.fitness),
            number::bits(lived.fitness),
            number::count(lived.steps.into())
        ))?;
    }
    if differences.is_empty() {
        Ok(())
    } else {
        Err(anyhow!("individual {} came out differently: {}", recorded.id, differences.join("; ")).into())
    }
}

/// Evaluates the recorded genotype under the recorded task, seed and culling rule.
fn live(recorded: &IndividualReply) -> Result<Outcome, Failure> {
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
    let genotype =
        recorded.genotype.as_ref().ok_or_else(|| anyhow!("individual {id} comes without a genotype"))?;
    let system = creatures::system(&genotype.system)
        .ok_or_else(|| anyhow!("this release does not know the system `{}`", genotype.system))?;
    if genotype.version != system.version() {
        // Outcomes of different versions are never compared (walker X-21).
        return Err(anyhow!(
            "individual {id} lived in version {} of {}, this release has version {}",
            genotype.version,
            system.name(),
            system.version()
        )
        .into());
    }
    let task = system.task(&recorded.task).with_context(|| format!("the task of individual {id}"))?;
    let cull =
        recorded.cull.as_ref().map(|cull| Cull { at: cull.at, cutoff: cull.cutoff, control: cull.control });
    let outcome = task
        .evaluate(&genotype.payload, recorded.seed, cull.as_ref(), &mut |_| {})
        .with_context(|| format!("the genotype of individual {id}"))?;
    Ok(outcome)
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
    use proto::v1::Genotype;

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
        let lived = live(&recorded).unwrap();
        recorded.fitness = Some(lived.fitness);
        recorded.steps = lived.steps.into();
        recorded
    }

    #[test]
    fn an_individual_lives_again_to_the_same_bits() {
        let recorded = recorded();
        assert_eq!(differences(&recorded, &live(&recorded).unwrap()), [""; 0]);
    }

    #[test]
    fn one_bit_of_the_fitness_is_a_difference_and_both_patterns_are_shown() {
        let mut recorded = recorded();
        let truth = recorded.fitness.unwrap();
        let off = f64::from_bits(truth.to_bits() ^ 1);
        recorded.fitness = Some(off);
        let differences = differences(&recorded, &live(&recorded).unwrap());
        assert_eq!(differences.len(), 1);
        assert!(differences[0].contains(&number::bits(truth)) && differences[0].contains(&number::bits(off)));
    }

    #[test]
    fn what_has_no_outcome_or_is_of_another_version_is_not_compared() {
        for (status, word) in [("pending", "no outcome yet"), ("failed", "set aside")] {
            let failure = live(&IndividualReply { status: status.into(), ..recorded() }).unwrap_err();
            assert!(failure.to_string().contains(word), "{failure}");
        }
        let mut old = recorded();
        old.genotype.as_mut().unwrap().version = 0;
        assert!(live(&old).unwrap_err().to_string().contains("version 0 of probe"));
    }
}

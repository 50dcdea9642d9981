//! What a checkpoint of an ESP syllabus costs: 200 creatures that have learned nine skills and are at the tenth
//! (ESP E-84). Their fitness is a digest of their genotypes, since it is not for what they can do.
//!
//! `cargo run --release -p search --example checkpoint`
#![allow(clippy::disallowed_types, clippy::disallowed_methods, reason = "an example measures time")]

use creatures::{Outcome, Status};
use search::{Experiment, Overrides};
use serde_json::Value;
use std::time::Instant;

const TEXT: &str = include_str!("../../experiments/fight-or-flight.toml");
/// How often each is measured.
const TIMES: usize = 50;

fn main() {
    for mode in ["fast", "general"] {
        let set = [("search.mode", mode), ("search.populations", "1"), ("search.generations", "4")];
        let set = set.into_iter().chain([("search.reconcile_generations", "2")]);
        let mut set: Vec<_> = set.map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
        for skill in ["forward_locomotion", "turn_to_light", "move_to_light", "fight_or_flight"] {
            set.push((format!("skill.{skill}.generations"), "4".to_owned()));
        }
        let experiment = Experiment::parse(TEXT, &Overrides { profile: None, set });
        let experiment = experiment.unwrap_or_else(|problems| panic!("{problems:?}")).remove(0);
        let mut search = experiment.start(1);
        let mut generation = 0;
        let individuals = loop {
            let asked = search.ask();
            if asked.is_empty() {
                let choice = search.choice().expect("the tenth skill comes before the end");
                search.pick(choice.candidates[0].place).expect("it is a candidate");
                continue;
            }
            let stage = search.stage();
            let task = stage.task.expect("a stage of a syllabus has a task");
            let outcomes: Vec<_> = asked.iter().map(|one| Some(outcome(&one.genotype, &task))).collect();
            search.tell(&outcomes);
            if stage.name == "fight_or_flight" {
                generation += 1;
                if generation == 3 {
                    break asked;
                }
            }
        };
        let bytes = search.checkpoint();
        let write = median(|| drop(search.checkpoint()));
        let read = median(|| drop(experiment.restore(1, &bytes).expect("its own checkpoint is understood")));
        let whole: usize = individuals.iter().map(|one| one.genotype.len()).sum();
        println!(
            "{mode}: {} individuals of {whole} bytes in all; checkpoint {} bytes, written in {write:.2} ms, read in {read:.2} ms",
            individuals.len(),
            bytes.len()
        );
    }
}

/// The median of many times, ms.
fn median(mut what: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..TIMES)
        .map(|_| {
            let start = Instant::now();
            what();
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[TIMES / 2]
}

/// As if it had been examined.
fn outcome(genotype: &[u8], task: &Value) -> Outcome {
    let digest = blake3::hash(genotype);
    let fitness = f64::from(digest.as_bytes()[0]) / 256.0;
    let mut measures = vec![("trial.0".to_owned(), fitness), ("stopped_by".to_owned(), -1.0)];
    for test in task["tests"].as_array().into_iter().flatten() {
        let skill = test["skill"].as_str().unwrap_or_default();
        measures.push((format!("score.{skill}"), fitness));
        if skill == "strike" {
            measures.push(("impact.strike".to_owned(), 3.0));
        }
    }
    Outcome { status: Status::Completed, fitness, steps: 1, measures, interim: None, note: String::new() }
}

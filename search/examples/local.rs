//! Runs an experiment in this process, on one thread, without service and lineage: `local FILE [PROFILE]`.
//! For trying out a search; it keeps nothing.
#![allow(clippy::disallowed_types, clippy::disallowed_methods, reason = "an example measures time")]

use search::{Experiment, Overrides};
use std::time::Instant;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let Some(file) = arguments.next() else {
        eprintln!("usage: local FILE [PROFILE]");
        std::process::exit(2);
    };
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let overrides = Overrides { profile: arguments.next(), set: Vec::new() };
    let experiments = Experiment::parse(&text, &overrides).unwrap_or_else(|problems| {
        problems.iter().for_each(|problem| eprintln!("{file}: {problem}"));
        std::process::exit(2);
    });
    for experiment in experiments {
        (1..=experiment.runs).for_each(|run| live(&experiment, run));
    }
}

fn live(experiment: &Experiment, run: u32) {
    let system = creatures::system(&experiment.system).expect("a parsed experiment has a system");
    let task = system.task(&experiment.task_json()).expect("a resolved task is legal");
    let mut search = experiment.start(run);
    let (mut asking, mut evaluating, mut individuals) = (0.0, 0.0, 0);
    for generation in 1.. {
        let begun = Instant::now();
        let asked = search.ask();
        asking += begun.elapsed().as_secs_f64();
        if asked.is_empty() {
            break;
        }
        individuals += asked.len();
        let begun = Instant::now();
        let outcomes: Vec<_> = asked
            .iter()
            .map(|one| {
                Some(
                    task.evaluate(&one.genotype, 0, None, &mut creatures::Nobody)
                        .expect("searches ask for legal genotypes"),
                )
            })
            .collect();
        evaluating += begun.elapsed().as_secs_f64();
        let fitness = outcomes.iter().flatten().map(|outcome| outcome.fitness);
        let best = fitness.clone().fold(0.0, f64::max);
        let mean = fitness.sum::<f64>() / outcomes.len() as f64;
        let begun = Instant::now();
        let record = search.tell(&outcomes);
        let checkpoint = search.checkpoint().len();
        asking += begun.elapsed().as_secs_f64();
        println!(
            "{} run {run} generation {generation}: best {best:.2} mean {mean:.2} species {} checkpoint {checkpoint} B",
            experiment.name,
            record.species.len(),
        );
    }
    println!(
        "{} run {run}: {individuals} individuals, search {:.1} us each, evaluation {:.1} us each",
        experiment.name,
        1e6 * asking / individuals as f64,
        1e6 * evaluating / individuals as f64,
    );
}

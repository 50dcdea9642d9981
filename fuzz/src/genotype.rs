//! Genotypes of every system, under the tasks of the ready experiments. Input: an experiment's file name
//! without its ending, a zero byte, the genotype.

use search::{Experiment, Overrides};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

/// What a genotype is checked and lived under.
struct Trial {
    task: Box<dyn creatures::Task>,
    /// The same task, over within milliseconds.
    short: Box<dyn creatures::Task>,
}

static TRIALS: LazyLock<BTreeMap<String, Trial>> = LazyLock::new(|| {
    let trials = tasks().into_iter().map(|(name, experiment)| {
        let system = creatures::system(&experiment.system).expect("a ready experiment names a system");
        let task = system.task(&experiment.task_json()).expect("a ready experiment has a legal task");
        let mut short = serde_json::from_str(&experiment.task_json()).expect("a task is JSON");
        shorten(&mut short);
        let short = system.task(&short.to_string()).expect("a shorter task is a legal one");
        (name, Trial { task, short })
    });
    trials.collect()
});

/// The ready experiments by name, the first cell of each.
pub fn tasks() -> BTreeMap<String, Experiment> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments");
    let files = std::fs::read_dir(folder).expect("the repository has ready experiments");
    let files = files.map(|entry| entry.expect("a folder can be listed").path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let read = |path: std::path::PathBuf| {
        let name = path.file_stem().expect("it has an ending").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a ready experiment is text");
        let cells = Experiment::parse(&text, &Overrides::default());
        (name, cells.expect("a test says so").remove(0))
    };
    files.map(read).collect()
}

/// Makes every time in a task a moment, whatever its system calls it.
fn shorten(task: &mut Value) {
    match task {
        Value::Object(table) => {
            for (key, value) in table {
                match key.as_str() {
                    "lesson" | "lessons" => {} // a genotype has a sample for each of its steps
                    "steps" => *value = json!(12),
                    key if key.ends_with("seconds") => *value = json!(0.2),
                    "duration" => *value = json!(0.5),
                    _ => shorten(value),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(shorten),
        _ => {}
    }
}

fn split(bytes: &[u8]) -> Option<(&'static Trial, &[u8])> {
    let end = bytes.iter().position(|byte| *byte == 0)?;
    let trial = TRIALS.get(std::str::from_utf8(&bytes[..end]).ok()?)?;
    Some((trial, &bytes[end + 1..]))
}

/// Whether bytes are a legal genotype is said without a panic, and without living it.
pub fn genotype(bytes: &[u8]) {
    let Some((trial, genotype)) = split(bytes) else { return };
    if let Err(error) = trial.task.check(genotype) {
        assert!(!error.to_string().is_empty(), "refused without a word");
    }
}

/// A genotype that was let in is lived, and comes to an outcome that the coordinator lets in.
pub fn life(bytes: &[u8]) {
    let Some((trial, genotype)) = split(bytes) else { return };
    let lived = trial.short.evaluate(genotype, 1, None, &mut creatures::Nobody);
    assert_eq!(trial.short.check(genotype).is_ok(), lived.is_ok(), "checked otherwise than lived");
    if let Ok(outcome) = lived {
        proto::convert::admissible(&outcome).expect("an outcome has finite numbers");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_founder_of_every_ready_experiment_is_lived() {
        for (name, experiment) in tasks() {
            let founders = experiment.start(1).ask();
            let founder = founders.first().expect("a search asks for somebody");
            let lived = TRIALS[&name].short.evaluate(&founder.genotype, 1, None, &mut creatures::Nobody);
            assert!(lived.is_ok(), "{name}: {lived:?}");
        }
    }
}

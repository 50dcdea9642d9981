//! Experiment files, and the task tables within them.

use crate::text;
use search::{Experiment, Overrides};

/// An experiment file, with overrides in lines that begin with `!`: `!task.work=3`. What is accepted resolves
/// to a text that means the same; what is refused is refused with a place.
pub fn experiment(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    let (overrides, file): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('!'));
    let set = overrides.iter().filter_map(|line| line[1..].split_once('='));
    let set = set.map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned())).collect();
    let file = file.join("\n");
    match Experiment::parse(&file, &Overrides { profile: None, set }) {
        Ok(experiments) => {
            assert!(!experiments.is_empty(), "a file makes one experiment at least");
            for experiment in experiments.iter().take(4) {
                let again = Experiment::parse_resolved(&experiment.resolved());
                let again = again.expect("a resolved text is an experiment");
                assert_eq!(experiment.digest(), again.digest());
            }
        }
        Err(problems) => {
            assert!(!problems.is_empty(), "refused without a word");
            for problem in problems {
                assert!(!problem.message.is_empty(), "refused without a word");
                if let Some(span) = problem.span {
                    assert!(file.get(span.clone()).is_some(), "{span:?} is no place in the file");
                }
            }
        }
    }
}

/// The JSON text of a task table, for every system. What resolves is a task.
pub fn task(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    for system in creatures::systems() {
        // Either may be refused; neither may panic.
        let _ = system.task(text);
        let Ok(table) = serde_json::from_str(text) else { continue };
        if let Ok(resolved) = system.resolve(table) {
            let text = resolved.to_string();
            assert!(system.task(&text).is_ok(), "{} does not read what it resolved: {text}", system.name());
            assert_eq!(system.resolve(resolved.clone()), Ok(resolved), "resolving twice changes a task");
        }
    }
}

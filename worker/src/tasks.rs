//! Tasks by their hash: each is read once, when it is first needed, and kept while it is in use. It
//! evaluates nothing.

use crate::config::Registry;
use crate::reports::Failure;
use creatures::Task;
use proto::{TaskHash, v1};
use std::any::Any;
use std::collections::BTreeMap;
use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Tasks that are kept ready; another one takes the place of the least recently used.
const READY_MAX: usize = 64;
/// Text of tasks that is kept, bytes.
const TEXT_SIZE_MAX: usize = 64 << 20;

/// The tasks of one stream.
pub(crate) struct Tasks {
    registry: Registry,
    /// Each is sent once, so its text has to stay as long as the stream does.
    texts: BTreeMap<TaskHash, v1::Task>,
    text_size: usize, // bytes
    /// Most recently used last.
    ready: Vec<(TaskHash, Ready)>,
}

/// A task to evaluate, or why there is none.
type Ready = Result<Arc<dyn Task>, Failure>;

impl Tasks {
    pub(crate) fn new(registry: Registry) -> Self {
        Tasks { registry, texts: BTreeMap::new(), text_size: 0, ready: Vec::new() }
    }

    /// Takes in a task under its hash.
    ///
    /// # Errors
    /// When this stream has brought more text than is kept. A new stream starts with nothing.
    pub(crate) fn learn(&mut self, hash: TaskHash, task: v1::Task) -> Result<(), String> {
        self.text_size += task.system.len() + task.spec.len();
        if self.text_size > TEXT_SIZE_MAX {
            return Err(format!("this stream's tasks are over {TEXT_SIZE_MAX} bytes"));
        }
        self.texts.insert(hash, task);
        Ok(())
    }

    /// The task of a hash, read if it is not ready.
    ///
    /// # Errors
    /// What to report of an evaluation that names it.
    pub(crate) fn find(&mut self, hash: TaskHash) -> Ready {
        match self.ready.iter().rposition(|(known, _)| *known == hash) {
            Some(at) => self.ready[at..].rotate_left(1),
            None => {
                let text = self.texts.get(&hash).ok_or_else(|| Failure {
                    reason: format!("task {hash} was not sent before its evaluation"),
                    last: false,
                })?;
                if self.ready.len() == READY_MAX {
                    drop(self.ready.remove(0));
                }
                self.ready.push((hash, read(self.registry, text)));
            }
        }
        self.ready.last().expect("the task was just put there").1.clone()
    }
}

/// Another release of this program may know the system or its version, so these are not the last word; a
/// spec that this version refuses is refused everywhere.
fn read(registry: Registry, text: &v1::Task) -> Ready {
    let failure = |reason, last| Err(Failure { reason, last });
    let Some(system) = registry(&text.system) else {
        return failure(format!("this worker knows no system `{}`", text.system), false);
    };
    if system.version() != text.version {
        let (name, known) = (&text.system, system.version());
        return failure(format!("system `{name}` has version {known} here, not {}", text.version), false);
    }
    match catch_unwind(AssertUnwindSafe(|| system.task(&text.spec))) {
        Ok(Ok(task)) => Ok(task.into()),
        Ok(Err(error)) => failure(format!("task of system `{}`: {}", text.system, chain(&error)), true),
        Err(panic) => failure(format!("task of system `{}`: panic: {}", text.system, words(&*panic)), false),
    }
}

/// An error and all its causes on one line. Causes that their error has told already are left out.
pub(crate) fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let told = error.to_string();
        if !text.ends_with(&told) {
            text = format!("{text}: {told}");
        }
        cause = error.source();
    }
    text
}

/// What a panic said.
pub(crate) fn words(panic: &(dyn Any + Send)) -> &str {
    let literal = panic.downcast_ref::<&'static str>().copied();
    literal.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("of unknown kind")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learned(tasks: &mut Tasks, task: v1::Task) -> TaskHash {
        let hash = task.verified().unwrap();
        tasks.learn(hash, task).unwrap();
        hash
    }

    fn refused(task: v1::Task) -> Failure {
        let mut tasks = Tasks::new(creatures::system);
        let hash = learned(&mut tasks, task);
        tasks.find(hash).map(drop).unwrap_err()
    }

    #[test]
    fn a_task_is_read_once() {
        let mut tasks = Tasks::new(creatures::system);
        let hash = learned(&mut tasks, v1::Task::named("probe", 1, "{}"));
        let [Ok(first), Ok(again)] = [tasks.find(hash), tasks.find(hash)] else { panic!("a legal task") };
        assert!(Arc::ptr_eq(&first, &again));
    }

    #[test]
    fn tasks_out_of_use_are_read_again_when_they_are_named_again() {
        let mut tasks = Tasks::new(creatures::system);
        let hashes: Vec<_> = (0..2 * READY_MAX)
            .map(|work| learned(&mut tasks, v1::Task::named("probe", 1, &format!("{{\"work\":{work}}}"))))
            .collect();
        assert!(hashes.iter().all(|hash| tasks.find(*hash).is_ok()));
        assert_eq!(tasks.ready.len(), READY_MAX);
        assert!(tasks.find(hashes[0]).is_ok());
        assert_eq!(tasks.ready.len(), READY_MAX);
    }

    #[test]
    fn what_cannot_be_read_says_why_and_whether_to_try_elsewhere() {
        let unknown = refused(v1::Task::named("unicorn", 1, "{}"));
        assert_eq!((&*unknown.reason, unknown.last), ("this worker knows no system `unicorn`", false));
        let other = refused(v1::Task::named("probe", 9, "{}"));
        assert_eq!((&*other.reason, other.last), ("system `probe` has version 1 here, not 9", false));
        let bad = refused(v1::Task::named("probe", 1, r#"{"wrk":1}"#));
        assert!(bad.last && bad.reason.contains("wrk"), "{}", bad.reason);
    }

    #[test]
    fn a_task_that_was_never_sent_is_named_in_the_failure() {
        let hash = proto::task_hash("probe", 1, "{}");
        let failure = Tasks::new(creatures::system).find(hash).map(drop).unwrap_err();
        assert_eq!(failure.reason, format!("task {hash} was not sent before its evaluation"));
    }

    #[test]
    fn an_error_is_told_with_each_cause_once() {
        #[derive(Debug, thiserror::Error)]
        enum Layer {
            #[error("no coordinator")]
            Outer(#[source] Box<Layer>),
            #[error("refused: {0}")]
            Repeating(#[source] Box<Layer>),
            #[error("port 9")]
            Inner,
        }
        let error = Layer::Outer(Box::new(Layer::Repeating(Box::new(Layer::Inner))));
        assert_eq!(chain(&error), "no coordinator: refused: port 9");
    }

    #[test]
    fn a_stream_cannot_fill_the_memory_with_tasks() {
        let mut tasks = Tasks::new(creatures::system);
        let big = "x".repeat(proto::convert::SPEC_SIZE_MAX);
        let learned = (0..100).map(|version| v1::Task::named("probe", version, &big));
        let learned = learned.take_while(|task| tasks.learn(task.verified().unwrap(), task.clone()).is_ok());
        assert_eq!(learned.count(), 63);
    }
}

//! What is held against evaluations that may have ended their workers, and when that is enough. A line that breaks
//! looks like a worker that has ended until the worker is back, so nobody is set aside before there was time for it.

use super::entry::Entry;
use super::{Millis, Scheduler, WorkerId};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Held against an evaluation for one of its attempts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Strike {
    /// The process of this incarnation was lost while it may have run it, and lives if it attaches again.
    Presumed(u64),
    /// The process has ended, or it is known to live and had this evaluation fail or hang.
    Certain,
}

/// Evaluations that some presumption is against, by the name of the worker that was lost.
#[derive(Debug, Default)]
pub(super) struct Presumptions(BTreeMap<Arc<str>, BTreeSet<u64>>);

impl Presumptions {
    pub(super) fn add(&mut self, name: &Arc<str>, evaluation: u64) {
        self.0.entry(name.clone()).or_default().insert(evaluation);
    }

    /// Forgets what was against an evaluation, once it is no longer open.
    pub(super) fn forget(&mut self, evaluation: u64, entry: &Entry) {
        for tried in &entry.attempts {
            if let Some(Strike::Presumed(_)) = tried.strike
                && let Some(evaluations) = self.0.get_mut(&tried.name)
            {
                evaluations.remove(&evaluation);
                if evaluations.is_empty() {
                    self.0.remove(&tried.name);
                }
            }
        }
    }

    #[cfg(test)]
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Scheduler {
    /// A process attaches. What was presumed for its own loss is taken back: nothing that it ran has ended it, be it
    /// still held or not. What was presumed for another one of its name is certain: that one has ended.
    pub(super) fn review(&mut self, worker: WorkerId, incarnation: u64, now: Millis) {
        let name = self.workers[&worker].name.clone();
        for evaluation in self.presumptions.0.remove(&name).unwrap_or_default() {
            self.withdraw(evaluation);
            let entry = self.evaluations.get_mut(&evaluation).expect("presumptions are against what is open");
            for tried in entry.attempts.iter_mut().filter(|tried| tried.name == name) {
                if let Some(Strike::Presumed(lost)) = tried.strike {
                    tried.strike = (lost != incarnation).then_some(Strike::Certain);
                }
            }
            self.retry(evaluation, now);
        }
    }

    /// Sets aside those for whose workers it was waited long enough.
    pub(super) fn pass_sentence(&mut self, now: Millis) {
        let over = self.condemned.iter().filter(|(_, since)| now.since(**since) > self.limits.parole_ms);
        for evaluation in over.map(|(&evaluation, _)| evaluation).collect::<Vec<_>>() {
            self.withdraw(evaluation);
            self.give_up(evaluation, now);
        }
    }
}

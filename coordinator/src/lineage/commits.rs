//! What the writer has done since it started, as counters that a scrape reads.

use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::histogram::{Histogram, exponential_buckets};
use prometheus_client::registry::Registry;
use std::time::Duration;

/// Counters of one writer. Clones share them.
#[derive(Debug, Clone)]
pub(crate) struct Commits {
    /// From the beginning of a transaction to its end on disk.
    seconds: Histogram,
    outcomes: Counter,
    failures: Counter,
}

impl Default for Commits {
    fn default() -> Commits {
        // Half a millisecond, a commit on a good disk, to 16 s.
        let seconds = Histogram::new(exponential_buckets(0.0005, 2.0, 16));
        Commits { seconds, outcomes: Counter::default(), failures: Counter::default() }
    }
}

impl Commits {
    pub(super) fn committed(&self, time: Duration, outcomes: usize) {
        self.seconds.observe(time.as_secs_f64());
        self.outcomes.inc_by(outcomes as u64);
    }

    pub(super) fn failed(&self) {
        self.failures.inc();
    }

    /// Names them for a scrape.
    pub(crate) fn register(&self, registry: &mut Registry) {
        registry.register("commit_seconds", "Time of one commit", self.seconds.clone());
        registry.register("outcomes_committed", "Outcomes on disk", self.outcomes.clone());
        registry.register("commit_failures", "Commits that the disk refused", self.failures.clone());
    }
}

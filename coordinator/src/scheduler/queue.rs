//! One queue: what is ready to be handed out, its share of the fleet, and how long its evaluations take. It
//! knows nothing of workers.

use super::{Conflict, Settled};
use std::collections::BTreeSet;

/// A queue's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct QueueId(pub u64);

/// What is handed out first: what was handed out before and came back, then by order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rank {
    pub(super) fresh: bool,
    pub(super) order: (u32, u32, u32),
    pub(super) evaluation: u64,
}

#[derive(Debug)]
pub(super) struct Queue {
    weight: u32,
    pub(super) paused: bool,
    pub(super) ready: BTreeSet<Rank>,
    /// Work handed out so far over weight, in nanoseconds: the queue with the least of it is served next.
    pub(super) pass: u128,
    pub(super) durations: Durations,
    /// What to tell its owner at the end of this round.
    pub(super) settled: Vec<Settled>,
    pub(super) conflicts: Vec<Conflict>,
    /// Its key among the queues that have something to hand out, while it stands there.
    pub(super) filed: Option<u128>,
}

impl Queue {
    pub(super) fn new(weight: u32) -> Queue {
        Queue {
            weight: weight.max(1),
            paused: false,
            ready: BTreeSet::new(),
            pass: 0,
            durations: Durations::default(),
            settled: Vec::new(),
            conflicts: Vec::new(),
            filed: None,
        }
    }

    /// Charges one evaluation handed out. The charge is the time that evaluations of this queue take of late:
    /// a fair share is one of the machines, not of the count.
    pub(super) fn charge(&mut self) {
        let nanoseconds = (self.durations.mean() * 1e9).clamp(1e3, 1e18) as u128;
        self.pass += (nanoseconds / u128::from(self.weight)).max(1);
    }

    pub(super) fn is_runnable(&self) -> bool {
        !self.paused && !self.ready.is_empty()
    }
}

/// Assumed of evaluations of which nothing is known yet, seconds.
const DURATION_UNKNOWN: f64 = 0.01;
/// How many of the latest durations are remembered.
const WINDOW: usize = 31;
/// So many must be known before a median says anything.
const MEDIAN_LEAST: usize = 3;

/// How long evaluations take of late.
#[derive(Debug, Default)]
pub(super) struct Durations {
    latest: Vec<f64>, // (≤ WINDOW), seconds, a ring once full
    next: usize,
}

impl Durations {
    /// Takes note of one, in seconds.
    pub(super) fn observe(&mut self, seconds: f64) {
        if self.latest.len() < WINDOW {
            self.latest.push(seconds);
        } else {
            self.latest[self.next] = seconds;
        }
        self.next = (self.next + 1) % WINDOW;
    }

    pub(super) fn mean(&self) -> f64 {
        if self.latest.is_empty() {
            return DURATION_UNKNOWN;
        }
        self.latest.iter().sum::<f64>() / self.latest.len() as f64
    }

    /// None until a few are known.
    pub(super) fn median(&self) -> Option<f64> {
        if self.latest.len() < MEDIAN_LEAST {
            return None;
        }
        let mut sorted = self.latest.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        Some(sorted[sorted.len() / 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_queue_is_charged_the_time_of_its_evaluations_over_its_weight() {
        let mut queue = Queue::new(4);
        queue.charge();
        assert_eq!(queue.pass, 2_500_000, "10 ms assumed");
        (0..WINDOW).for_each(|_| queue.durations.observe(2.0));
        queue.charge();
        assert_eq!(queue.pass, 502_500_000);
    }

    #[test]
    fn durations_are_those_of_late() {
        let mut durations = Durations::default();
        [9.0, 1.0].into_iter().for_each(|seconds| durations.observe(seconds));
        assert_eq!(durations.median(), None);
        durations.observe(2.0);
        assert_eq!((durations.median(), durations.mean()), (Some(2.0), 4.0));
        (0..WINDOW).for_each(|_| durations.observe(0.5));
        assert_eq!((durations.median(), durations.mean()), (Some(0.5), 0.5));
    }

    #[test]
    fn what_came_back_goes_first_then_run_generation_and_index() {
        let rank = |fresh, order, evaluation| Rank { fresh, order, evaluation };
        let ready =
            BTreeSet::from([rank(true, (1, 1, 0), 1), rank(true, (1, 2, 0), 2), rank(false, (2, 1, 1), 3)]);
        assert_eq!(ready.iter().map(|rank| rank.evaluation).collect::<Vec<_>>(), [3, 1, 2]);
    }
}

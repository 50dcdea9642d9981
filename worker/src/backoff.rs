//! How long to wait before the next try to attach: twice as long each time, with jitter, so that a fleet
//! does not come back all at once. It does not wait itself.

use creatures::random::{Stream, stream};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

const FIRST: Duration = Duration::from_millis(100);
const LONGEST: Duration = Duration::from_secs(5);

/// The waits between tries, for ever.
#[derive(Debug)]
pub(crate) struct Backoff {
    next: Duration,
    jitter: Stream,
}

impl Backoff {
    /// Workers of different names wait for different times; no outcome depends on it.
    pub(crate) fn new(name: &str) -> Self {
        let mut hasher = DefaultHasher::new();
        name.hash(&mut hasher);
        Backoff { next: FIRST, jitter: stream(hasher.finish(), [0; 3], "backoff") }
    }

    /// After a success: the next wait is a short one again.
    pub(crate) fn reset(&mut self) {
        self.next = FIRST;
    }

    /// The next wait, between half of the nominal one and the whole.
    pub(crate) fn wait(&mut self) -> Duration {
        let nominal = self.next;
        self.next = (nominal * 2).min(LONGEST);
        nominal.mul_f64(self.jitter.between(0.5, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_double_from_a_tenth_of_a_second_to_five() {
        let mut backoff = Backoff::new("ada");
        for nominal in [0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0] {
            let wait = backoff.wait().as_secs_f64();
            assert!((0.5 * nominal..=nominal).contains(&wait), "{wait} for {nominal}");
        }
        backoff.reset();
        assert!(backoff.wait() <= FIRST);
    }

    #[test]
    fn two_workers_do_not_come_back_at_once() {
        assert_ne!(Backoff::new("ada").wait(), Backoff::new("bob").wait());
    }
}

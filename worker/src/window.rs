//! How many evaluations a worker asks for at once, running ones included, and what that says of reports
//! underway. Pure: evaluation times come in, numbers go out.

use proto::hello::WINDOW_MAX;

/// What passes, at worst, between a report and the evaluation that takes its place: a round trip, a batch
/// read, a thread woken. Seconds. A slot that has so much work ahead of it never waits.
const TURNAROUND: f64 = 0.003;
/// What reports may wait for company, so that short evaluations share a wake-up and a message. Seconds.
const COMPANY: f64 = 0.010;
/// However short evaluations are, more of them a slot only grow messages and the loss when a worker dies.
const PER_SLOT_MAX: usize = 128;

/// How long evaluations take of late.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Pace {
    mean: Option<f64>, // seconds
}

impl Pace {
    /// Takes one evaluation's seconds into account: a running mean of the last 16 or so.
    pub(crate) fn observe(&mut self, seconds: f64) {
        let mean = self.mean.unwrap_or(seconds);
        self.mean = Some(mean + (seconds - mean) / 16.0);
    }

    /// The window for so many slots at this pace: one ahead at 10 ms and more (more for many slots, whose
    /// reports come closer together), 17 at 1 ms on two slots, 128 a slot in the microseconds. One ahead
    /// before anything was measured. What waits for company counts, since the coordinator does not know of it.
    pub(crate) fn window(&self, slots: usize) -> u32 {
        let ahead = match self.mean {
            Some(mean) => (slots as f64 * TURNAROUND / mean.max(1e-9)).ceil() as usize,
            None => 1,
        };
        let window = slots + (ahead + self.batch() - 1).clamp(1, slots * (PER_SLOT_MAX - 1));
        window.min(WINDOW_MAX as usize) as u32
    }

    /// How many reports are worth a wake-up while there is more to evaluate: 1 from 10 ms on.
    pub(crate) fn batch(&self) -> usize {
        self.mean.map_or(1, |mean| (COMPANY / mean.max(1e-9)) as usize).clamp(1, PER_SLOT_MAX / 4)
    }
}

/// Whether a window is so far from the announced one that it is worth a message.
pub(crate) fn is_news(announced: u32, window: u32) -> bool {
    4 * u64::from(announced.abs_diff(window)) >= u64::from(announced)
}

/// One stream's account of evaluations, from which a worker learns which of its reports have arrived: a
/// coordinator never has more than the window in hand, so each evaluation beyond it proves that a report
/// was read. No message has to say so.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Account {
    /// The largest window announced on this stream.
    pub(crate) window_max: u32,
    /// Evaluations taken on it.
    pub(crate) assigned: u64,
    /// Evaluations revoked or given back on it, which freed their places without a report.
    pub(crate) released: u64,
}

impl Account {
    /// How many of the reports sent on this stream, the first ones, have been read for sure.
    pub(crate) fn confirmed(&self) -> u64 {
        self.assigned.saturating_sub(self.released).saturating_sub(u64::from(self.window_max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(slots: usize, seconds: f64) -> u32 {
        let mut pace = Pace::default();
        pace.observe(seconds);
        pace.window(slots)
    }

    #[test]
    fn the_window_follows_the_evaluation_time() {
        assert_eq!(Pace::default().window(2), 3);
        assert_eq!(window(2, 10.0), 3);
        assert_eq!(window(2, 0.010), 3);
        assert_eq!(window(2, 0.001), 17);
        assert_eq!(window(2, 0.000_002), 256);
        assert_eq!(window(2, 0.0), 256);
        assert_eq!(window(64, 0.010), 84);
        assert_eq!(window(4096, 0.0), WINDOW_MAX);
    }

    #[test]
    fn the_pace_turns_within_a_few_dozen_evaluations() {
        let mut pace = Pace::default();
        (0..1000).for_each(|_| pace.observe(0.000_002));
        (0..3).for_each(|_| pace.observe(1.0));
        assert_eq!(pace.window(2), 3);
        (0..400).for_each(|_| pace.observe(0.000_002));
        assert_eq!(pace.window(2), 256);
    }

    #[test]
    fn only_short_evaluations_wait_for_company() {
        let batch = |seconds| {
            let mut pace = Pace::default();
            pace.observe(seconds);
            pace.batch()
        };
        assert_eq!([1.0, 0.010, 0.005, 0.001, 0.000_05, 0.0].map(batch), [1, 1, 2, 10, 32, 32]);
        assert_eq!(Pace::default().batch(), 1);
    }

    #[test]
    fn a_window_is_told_when_it_has_moved_by_a_quarter() {
        assert!(is_news(3, 4) && is_news(8, 6) && is_news(256, 3));
        assert!(!is_news(3, 3) && !is_news(8, 9) && !is_news(256, 200));
    }

    #[test]
    fn what_exceeds_the_window_confirms_reports() {
        let account = Account { window_max: 3, assigned: 3, released: 0 };
        assert_eq!(account.confirmed(), 0);
        assert_eq!(Account { assigned: 5, ..account }.confirmed(), 2);
        assert_eq!(Account { assigned: 5, released: 1, ..account }.confirmed(), 1);
    }
}

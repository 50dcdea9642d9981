//! What a worker has to tell: reports that wait to be sent, and sent ones that may not have arrived. It
//! sends nothing itself.

use bytes::Bytes;
use creatures::{Cull, Interim, Outcome, Task};
use proto::{REPORTS_MAX, WORKER_MESSAGE_SIZE_MAX, v1};
use std::collections::VecDeque;
use std::sync::Arc;

/// Which attempt at which evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Attempt {
    pub(crate) evaluation: u64,
    pub(crate) number: u32,
}

impl From<v1::Attempt> for Attempt {
    fn from(v1::Attempt { evaluation, number }: v1::Attempt) -> Self {
        Attempt { evaluation, number }
    }
}

impl From<Attempt> for v1::Attempt {
    fn from(Attempt { evaluation, number }: Attempt) -> Self {
        v1::Attempt { evaluation, number }
    }
}

/// One evaluation, ready to be lived.
pub(crate) struct Evaluation {
    pub(crate) attempt: Attempt,
    pub(crate) task: Arc<dyn Task>,
    pub(crate) genotype: Bytes,
    pub(crate) seed: u64,
    pub(crate) cull: Option<Cull>,
}

/// Why an attempt has no outcome.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Failure {
    pub(crate) reason: String,
    /// The same on every worker of this release: not worth another attempt.
    pub(crate) last: bool,
}

/// One thing to tell of an attempt.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Report {
    pub(crate) attempt: Attempt,
    /// Spent on it so far.
    pub(crate) seconds: f64,
    pub(crate) news: News,
}

/// What a report says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum News {
    /// The attempt goes on.
    Interim(Interim),
    /// The attempt has ended.
    Outcome(Outcome),
    /// The attempt has ended.
    Failure(Failure),
}

impl Report {
    fn ends_its_attempt(&self) -> bool {
        !matches!(self.news, News::Interim(_))
    }

    /// On the wire, bytes: about, and rather more.
    fn size(&self) -> usize {
        let fixed = 128;
        match &self.news {
            News::Interim(_) => fixed,
            News::Outcome(Outcome { measures, note, .. }) => {
                let names = measures.iter().map(|(name, _)| name.len() + 24);
                fixed + note.len() + names.sum::<usize>()
            }
            News::Failure(Failure { reason, .. }) => fixed + reason.len(),
        }
    }
}

impl From<Report> for v1::Report {
    fn from(report: Report) -> Self {
        let what = match report.news {
            News::Interim(interim) => v1::report::What::Interim(interim.into()),
            News::Outcome(outcome) => v1::report::What::Outcome(outcome.into()),
            News::Failure(Failure { reason, last }) => {
                v1::report::What::Failure(v1::Failure { reason, r#final: last })
            }
        };
        v1::Report { attempt: Some(report.attempt.into()), seconds: report.seconds, what: Some(what) }
    }
}

/// Shorter evaluations are cheaper to repeat than to remember. Seconds.
const WORTH_KEEPING: f64 = 0.001;
/// Of the reports in one message, bytes: one alone is far smaller.
const MESSAGE_SIZE: usize = WORKER_MESSAGE_SIZE_MAX / 2;

/// Reports on their way. It holds a report for each evaluation of the window at most, and as many interim
/// ones.
#[derive(Debug, Default)]
pub(crate) struct Outbox {
    waiting: VecDeque<Report>,
    /// Sent on this stream and perhaps not read, in order of sending; `None` for those that are not kept.
    sent: VecDeque<Option<Report>>,
    /// How many of this stream's were dropped from the front of `sent`.
    confirmed: u64,
}

impl Outbox {
    /// Takes a report in.
    pub(crate) fn push(&mut self, report: Report) {
        self.waiting.push_back(report);
    }

    /// How many wait to be sent.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// The next reports to send, oldest first: as many as fit in a message.
    pub(crate) fn take(&mut self) -> Vec<Report> {
        let mut size = 0;
        let fits = |report: &&Report| {
            size += report.size();
            size <= MESSAGE_SIZE
        };
        let count = self.waiting.iter().take(REPORTS_MAX).take_while(fits).count().max(1);
        let reports: Vec<Report> = self.waiting.drain(..count.min(self.waiting.len())).collect();
        let ended = reports.iter().filter(|report| report.ends_its_attempt());
        self.sent.extend(ended.map(|report| (report.seconds >= WORTH_KEEPING).then(|| report.clone())));
        reports
    }

    /// The first `count` reports of this stream that ended an attempt have arrived.
    pub(crate) fn confirm(&mut self, count: u64) {
        let arrived = count.saturating_sub(self.confirmed).min(self.sent.len() as u64);
        self.sent.drain(..arrived as usize);
        self.confirmed += arrived;
    }

    /// The stream is gone: what may not have arrived is to be sent again on the next one.
    pub(crate) fn recall(&mut self) {
        for report in self.sent.drain(..).rev().flatten() {
            self.waiting.push_front(report);
        }
        self.confirmed = 0;
    }

    /// Nobody needs an attempt any more.
    pub(crate) fn drop_attempt(&mut self, attempt: Attempt) {
        self.waiting.retain(|report| report.attempt != attempt);
    }

    /// Throws everything away.
    pub(crate) fn clear(&mut self) {
        *self = Outbox::default();
    }

    /// The attempts that have ended and whose reports are held here.
    pub(crate) fn ended(&self) -> impl Iterator<Item = Attempt> {
        let held = self.sent.iter().flatten().chain(&self.waiting);
        held.filter(|report| report.ends_its_attempt()).map(|report| report.attempt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(evaluation: u64, seconds: f64) -> Report {
        let failure = Failure { reason: String::new(), last: true };
        Report { attempt: Attempt { evaluation, number: 1 }, seconds, news: News::Failure(failure) }
    }

    fn interim(evaluation: u64) -> Report {
        Report { news: News::Interim(Interim { step: 1, measure: 0.0 }), ..report(evaluation, 1.0) }
    }

    fn evaluations(reports: &[Report]) -> Vec<u64> {
        reports.iter().map(|report| report.attempt.evaluation).collect()
    }

    #[test]
    fn what_may_not_have_arrived_is_sent_again_in_order() {
        let mut outbox = Outbox::default();
        for evaluation in 1..=4 {
            outbox.push(report(evaluation, 1.0));
        }
        assert_eq!(evaluations(&outbox.take()), [1, 2, 3, 4]);
        outbox.confirm(1);
        outbox.recall();
        assert_eq!(outbox.ended().map(|attempt| attempt.evaluation).collect::<Vec<_>>(), [2, 3, 4]);
        assert_eq!(evaluations(&outbox.take()), [2, 3, 4]);
        outbox.confirm(2);
        outbox.recall();
        assert_eq!(evaluations(&outbox.take()), [4]);
    }

    #[test]
    fn a_sent_report_that_is_cheap_to_repeat_is_counted_and_not_kept() {
        let mut outbox = Outbox::default();
        for report in [report(1, 1e-6), interim(2), report(2, 1.0)] {
            outbox.push(report);
        }
        outbox.take();
        outbox.confirm(1);
        outbox.recall();
        assert_eq!(evaluations(&outbox.take()), [2], "the cheap one was the first, the interim never counts");
    }

    #[test]
    fn a_message_has_so_many_reports_and_so_many_bytes() {
        let mut outbox = Outbox::default();
        (0..REPORTS_MAX as u64 + 5).for_each(|evaluation| outbox.push(report(evaluation, 1.0)));
        assert_eq!((outbox.take().len(), outbox.take().len(), outbox.take().len()), (REPORTS_MAX, 5, 0));
        let wordy = |size: usize| {
            let failure = Failure { reason: "x".repeat(size), last: true };
            Report { news: News::Failure(failure), ..report(1, 1.0) }
        };
        for size in [MESSAGE_SIZE / 4, MESSAGE_SIZE / 4, MESSAGE_SIZE / 2, 2 * MESSAGE_SIZE] {
            outbox.push(wordy(size));
        }
        let counts = [(); 4].map(|()| outbox.take().len());
        assert_eq!(counts, [2, 1, 1, 0], "none is too long for a message of its own");
    }

    #[test]
    fn nothing_is_told_of_a_dropped_attempt() {
        let mut outbox = Outbox::default();
        for report in [interim(1), report(1, 1.0), report(2, 1.0)] {
            outbox.push(report);
        }
        outbox.drop_attempt(Attempt { evaluation: 1, number: 1 });
        assert_eq!(outbox.waiting(), 1);
        assert_eq!(evaluations(&outbox.take()), [2]);
    }
}

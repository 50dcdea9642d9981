//! What becomes of an evaluation when a report comes or a worker goes: settled, put back, restored, or set
//! aside. It hands nothing out.

use super::entry::Standing;
use super::strikes::Strike;
use super::worker::Lease;
use super::{
    AttemptId, Conflict, Entry, Loss, Millis, News, QueueId, Report, Scheduler, Settled, WorkerId, ruling,
};
use crate::lineage::{Audited, Fate, Ruling, SetAside};
use creatures::{Outcome, Status};
use std::collections::VecDeque;
use std::sync::Arc;

/// An outcome that may be contradicted: whose evaluation had several attempts.
#[derive(Debug)]
pub(super) struct Remembered {
    evaluation: u64,
    pub(super) queue: QueueId,
    /// As reported.
    outcome: Outcome,
    worker: Arc<str>,
}

/// So many of them are remembered.
const REMEMBERED_MAX: usize = 1024;

impl Scheduler {
    /// Takes a worker's report. One on an attempt that was not made by a worker of its name changes nothing.
    ///
    /// An outcome settles its evaluation also when the lease was lost meanwhile: it is a pure function of the
    /// genotype, whoever computed it.
    pub fn report(&mut self, worker: WorkerId, report: Report, now: Millis) {
        let Some(state) = self.workers.get_mut(&worker).filter(|worker| !worker.quarantined) else { return };
        let Report { attempt: AttemptId { evaluation, number }, seconds, news } = report;
        let Some(entry) = self.evaluations.get_mut(&evaluation) else {
            if let News::Outcome(outcome) = news {
                let name = state.name.clone();
                self.compare(evaluation, outcome, &name);
            }
            return;
        };
        let Some(at) = entry.find(number, &state.name) else { return };
        if entry.has_opined(&state.name) {
            return;
        }
        let is_first = entry.attempts.len() == 1;
        let tried = &mut entry.attempts[at];
        tried.seconds = seconds.min(self.limits.overdue_ms as f64 / 1e3);
        let (cull, is_audited) = (entry.evaluation.cull.as_ref(), entry.evaluation.audit);
        match news {
            News::Interim(interim) => {
                tried.steps = u64::from(interim.step);
                if let (None, Some(cull)) = (tried.ruling, cull) {
                    tried.ruling = Some(ruling::rule(cull, interim));
                }
            }
            News::Outcome(outcome) => {
                tried.steps = u64::from(outcome.steps);
                let remembered = (!is_first).then(|| Remembered {
                    evaluation,
                    queue: entry.queue,
                    outcome: outcome.clone(),
                    worker: state.name.clone(),
                });
                match ruling::admit(outcome, cull, tried.ruling) {
                    Ok((outcome, ruling)) => {
                        tried.ruling = ruling;
                        state.completed += 1;
                        state.busy_seconds += seconds;
                        if is_audited {
                            self.opine(evaluation, at, Ok(outcome), now);
                        } else {
                            self.count(evaluation, at, outcome, now);
                            remember(&mut self.remembered, remembered);
                        }
                    }
                    Err(reason) => self.fail(evaluation, at, reason, false, now),
                }
            }
            News::Failure { reason, lasting } => {
                state.busy_seconds += seconds;
                if lasting && is_audited {
                    self.opine(evaluation, at, Err(SetAside { reason }), now);
                } else {
                    self.fail(evaluation, at, reason, lasting, now);
                }
            }
        }
    }

    /// Settles an evaluation with the outcome of one of its attempts.
    fn count(&mut self, evaluation: u64, at: usize, outcome: Outcome, now: Millis) {
        self.withdraw(evaluation);
        let entry = self.evaluations.get_mut(&evaluation).expect("the caller has found it open");
        let tried = &mut entry.attempts[at];
        let is_leased = tried.fate.is_none();
        let (worker, seat, ruling) = (tried.worker, tried.seat, tried.ruling);
        tried.fate = Some(Fate::Counted);
        let queue = self.queues.get_mut(&entry.queue).expect("queues outlive their evaluations");
        queue.durations.observe(tried.seconds);
        if is_leased {
            self.release(worker, seat, evaluation, now);
        }
        self.settle(evaluation, Ok(outcome), ruling, None, now);
    }

    /// Ends an attempt without an outcome, which is a strike for certain. Of one whose lease was lost, nothing
    /// is left to end.
    fn fail(&mut self, evaluation: u64, at: usize, reason: String, lasting: bool, now: Millis) {
        let entry = self.evaluations.get_mut(&evaluation).expect("the caller has found it open");
        let tried = &mut entry.attempts[at];
        if tried.fate.is_some() {
            return;
        }
        let (worker, seat) = (tried.worker, tried.seat);
        tried.strike = Some(Strike::Certain);
        tried.fate = Some(Fate::Failed(reason.clone()));
        self.release(worker, seat, evaluation, now);
        if lasting {
            self.set_aside(evaluation, reason, now);
        } else {
            self.retry(evaluation, now);
        }
    }

    /// Ends an attempt whose worker is gone already, and holds that against its evaluation if `strike` says so.
    pub(super) fn void(&mut self, lease: &Lease, loss: Loss, strike: Option<Strike>, now: Millis) {
        let attempt = lease.attempt;
        let entry = self.evaluations.get_mut(&attempt.evaluation).expect("what is leased is open");
        let is_suspect = entry.is_suspect();
        let tried = entry.attempts.iter_mut().find(|tried| tried.number == attempt.number);
        let tried = tried.expect("attempts whose lease lasts are kept");
        tried.fate = Some(Fate::Lost(loss.word().to_owned()));
        tried.restorable = strike != Some(Strike::Certain);
        tried.ran_ms = lease.ran_ms(now);
        // The last strike of a suspect falls only where no neighbour can have been the cause.
        tried.strike = strike.filter(|&strike| !is_suspect || tried.alone || strike == Strike::Certain);
        if let Some(Strike::Presumed(_)) = tried.strike {
            self.presumptions.add(&tried.name, attempt.evaluation);
        }
        self.retry(attempt.evaluation, now);
    }

    /// Puts back what a draining worker has not begun.
    pub(super) fn give_back(&mut self, worker: &str, attempt: AttemptId, now: Millis) {
        let Some(entry) = self.evaluations.get_mut(&attempt.evaluation) else { return };
        let Some(at) = entry.find(attempt.number, worker) else { return };
        let tried = &mut entry.attempts[at];
        if tried.fate.is_some() {
            return;
        }
        tried.fate = Some(Fate::Lost("returned".to_owned()));
        let (worker, seat) = (tried.worker, tried.seat);
        self.release(worker, seat, attempt.evaluation, now);
        self.retry(attempt.evaluation, now);
    }

    /// Restores the lease of an attempt that a worker has brought back, or revokes it if nobody needs it.
    pub(super) fn restore(&mut self, worker: WorkerId, attempt: AttemptId, now: Millis) {
        let state = self.workers.get_mut(&worker).expect("the caller has attached it");
        let entry = self.evaluations.get(&attempt.evaluation).filter(|_| !state.quarantined);
        let wanted =
            entry.and_then(|entry| Some((entry, entry.wants_back(attempt.number, worker, &state.name)?)));
        let Some((entry, at)) = wanted else {
            state.revoked.push(attempt);
            self.told.insert(worker);
            return;
        };
        let seat = state.seat(attempt, entry.queue, entry.attempts[at].ran_ms, now);
        self.withdraw(attempt.evaluation);
        let entry = self.evaluations.get_mut(&attempt.evaluation).expect("it was found above");
        let tried = &mut entry.attempts[at];
        // It has this worker not for itself.
        (tried.restorable, tried.alone) = (false, false);
        (tried.fate, tried.worker, tried.seat) = (None, worker, seat);
    }

    /// After an attempt has ended in vain: puts its evaluation where it belongs now.
    pub(super) fn retry(&mut self, evaluation: u64, now: Millis) {
        let entry = &self.evaluations[&evaluation];
        match entry.standing() {
            Standing::UnderWay => {}
            Standing::Convicted => self.give_up(evaluation, now),
            Standing::Condemned => {
                self.condemned.insert(evaluation, now);
            }
            Standing::Awaiting => self.await_opinion(evaluation),
            Standing::Suspect => {
                self.suspects.insert(evaluation, None);
            }
            Standing::Ready => {
                let (queue, rank) = (entry.queue, entry.rank());
                self.queues.get_mut(&queue).expect("queues outlive their evaluations").ready.insert(rank);
                self.file_queue(queue);
            }
        }
    }

    /// Risks no further worker: the opinion of one that has lived through it counts, else it is set aside.
    pub(super) fn give_up(&mut self, evaluation: u64, now: Millis) {
        let entry = &self.evaluations[&evaluation];
        if entry.opinions.is_empty() {
            let reason = entry.account();
            self.set_aside(evaluation, reason, now);
        } else {
            self.conclude(evaluation, 0, Audited::Skipped, now);
        }
    }

    /// Settles an evaluation without an outcome.
    fn set_aside(&mut self, evaluation: u64, reason: String, now: Millis) {
        let ruling = self.evaluations[&evaluation].attempts.iter().find_map(|tried| tried.ruling);
        self.settle(evaluation, Err(SetAside { reason }), ruling, None, now);
    }

    /// Settles an evaluation for its owner.
    pub(super) fn settle(
        &mut self,
        evaluation: u64,
        result: Result<Outcome, SetAside>,
        ruling: Option<Ruling>,
        audit: Option<Audited>,
        now: Millis,
    ) {
        let entry = self.close(evaluation, now);
        let culled = result.as_ref().ok().filter(|outcome| outcome.status == Status::Culled);
        let steps_spared = culled
            .zip(entry.evaluation.cull)
            .map_or(0, |(outcome, cull)| (f64::from(outcome.steps) * (1.0 / cull.at - 1.0)).round() as u64);
        let fate = if result.is_ok() { Fate::Duplicate } else { Fate::Lost("set aside".to_owned()) };
        let queue = self.queues.get_mut(&entry.queue).expect("queues outlive their evaluations");
        queue.settled.push(Settled {
            id: evaluation,
            result,
            ruling,
            audit,
            steps_spared,
            attempts: entry.attempts.into_iter().map(|tried| tried.record(&fate)).collect(),
        });
        self.delivered.insert(entry.queue);
    }

    /// Forgets an evaluation that waits no more, and revokes its leases.
    fn close(&mut self, evaluation: u64, now: Millis) -> Entry {
        let entry = self.evaluations.remove(&evaluation).expect("the caller has found it open");
        self.presumptions.forget(evaluation, &entry);
        for tried in entry.outstanding() {
            self.release(tried.worker, tried.seat, evaluation, now);
            self.revoke(tried.worker, AttemptId { evaluation, number: tried.number });
        }
        entry
    }

    /// Tells a worker that nobody needs an attempt any more.
    pub(super) fn revoke(&mut self, worker: WorkerId, attempt: AttemptId) {
        if let Some(state) = self.workers.get_mut(&worker) {
            state.revoked.push(attempt);
            self.told.insert(worker);
        }
    }

    /// Ends an evaluation that nobody asks for any more.
    pub(super) fn abandon(&mut self, evaluation: u64, now: Millis) {
        self.withdraw(evaluation);
        self.close(evaluation, now);
    }

    /// Takes an evaluation from where it waits to be handed out.
    pub(super) fn withdraw(&mut self, evaluation: u64) {
        if let Some(reserved) = self.suspects.remove(&evaluation) {
            if let Some(worker) = reserved
                && let Some(state) = self.workers.get_mut(&worker)
            {
                state.reserved = None;
                self.file_worker(worker);
            }
            return;
        }
        let Some(entry) = self.evaluations.get(&evaluation) else { return };
        // Most evaluations are settled while leased, and stand in no queue.
        if entry.outstanding().next().is_some()
            || self.condemned.remove(&evaluation).is_some()
            || self.awaiting.remove(entry)
        {
            return;
        }
        if let Some(queue) = self.queues.get_mut(&entry.queue)
            && queue.ready.remove(&entry.rank())
        {
            self.file_queue(entry.queue);
        }
    }

    /// Ends a lease at its worker.
    pub(super) fn release(&mut self, worker: WorkerId, seat: u64, evaluation: u64, now: Millis) {
        let Some(state) = self.workers.get_mut(&worker) else { return };
        state.release(seat, now);
        if state.reserved == Some(evaluation) {
            state.reserved = None;
        }
        self.file_worker(worker);
    }

    /// Compares a late outcome with the one that settled its evaluation, if that is remembered.
    fn compare(&mut self, evaluation: u64, late: Outcome, worker: &str) {
        let Some(first) = self.remembered.iter().find(|one| one.evaluation == evaluation) else { return };
        if first.outcome.digest() == late.digest() {
            return;
        }
        if let Some(queue) = self.queues.get_mut(&first.queue) {
            queue.conflicts.push(Conflict {
                id: evaluation,
                first: (first.outcome.clone(), first.worker.to_string()),
                second: (late, worker.to_owned()),
            });
            self.delivered.insert(first.queue);
        }
    }
}

fn remember(remembered: &mut VecDeque<Remembered>, one: Option<Remembered>) {
    let Some(one) = one else { return };
    if remembered.len() == REMEMBERED_MAX {
        remembered.pop_front();
    }
    remembered.push_back(one);
}

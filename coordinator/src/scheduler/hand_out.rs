//! Handing out: ready evaluations to the least loaded workers in fair shares, suspects to workers of their
//! own, and stragglers a second time. It ends no lease.

use super::queue::Queue;
use super::worker::Load;
use super::{Assignment, AttemptId, Millis, QueueId, Scheduler, WorkerId};
use std::collections::BTreeMap;

/// A lease younger than this is not worth a second attempt, milliseconds.
const STRAGGLER_LEAST_MS: u64 = 50;
/// A running evaluation is a straggler beyond so many times the median of its queue.
const STRAGGLER_MEDIANS: f64 = 2.0;
/// At most so many attempts at one evaluation at a time.
pub(super) const OUTSTANDING_MAX: usize = 2;
/// How often stragglers are looked for, milliseconds.
const LOOK_EVERY_MS: u64 = 20;

impl Scheduler {
    pub(super) fn hand_out(&mut self, now: Millis) {
        self.hand_out_audits(now);
        self.place_suspects(now);
        while let (Some(&(pass, queue)), Some(&(_, least_loaded))) =
            (self.runnable.first(), self.free.first())
        {
            let state = self.queues.get_mut(&queue).expect("a runnable queue is open");
            let rank = state.ready.pop_first().expect("a runnable queue has something ready");
            state.charge();
            self.pass = pass;
            self.file_queue(queue);
            let entry = &self.evaluations[&rank.evaluation];
            // After a strike rather somebody else: it may be the worker that is sick.
            let other = (entry.strikes() > 0)
                .then(|| self.free.iter().find(|(_, id)| !entry.has_struck(&self.workers[id].name)));
            let worker = other.flatten().map_or(least_loaded, |&(_, worker)| worker);
            self.lease(rank.evaluation, worker, false, now);
        }
        if self.runnable.is_empty() && now.since(self.looked) >= LOOK_EVERY_MS {
            self.looked = now;
            self.duplicate_stragglers(now);
        }
    }

    /// Reserves a worker for each suspect, and hands it out once that worker has nothing else.
    fn place_suspects(&mut self, now: Millis) {
        for suspect in self.suspects.keys().copied().collect::<Vec<_>>() {
            let entry = &self.evaluations[&suspect];
            if self.queues[&entry.queue].paused {
                continue;
            }
            let worker = self.suspects[&suspect].or_else(|| {
                // Somebody else than before as long as there is one: it may be the worker that is sick.
                let takers = || self.workers.values().filter(|worker| worker.takes());
                let others = takers().any(|worker| !entry.has_struck(&worker.name));
                let free = takers().filter(|worker| worker.reserved.is_none());
                let fit = free.filter(|worker| !(others && entry.has_struck(&worker.name)));
                fit.min_by_key(|worker| (worker.load(), worker.id)).map(|worker| worker.id)
            });
            self.suspects.insert(suspect, worker);
            let Some(worker) = worker else { continue };
            let state = self.workers.get_mut(&worker).expect("a reserved worker is attached");
            state.reserved = Some(suspect);
            if state.lease_count() == 0 {
                self.suspects.remove(&suspect);
                self.lease(suspect, worker, true, now);
            } else {
                self.file_worker(worker);
            }
        }
    }

    /// Gives the workers free that are being emptied for suspects of a queue. It comes before a round, which may have
    /// something for them.
    pub(super) fn release_reserved(&mut self, queue: QueueId) {
        let of_queue = |suspect: &u64| self.evaluations[suspect].queue == queue;
        let awaited = self.suspects.iter_mut().filter(|(suspect, _)| of_queue(suspect));
        for worker in awaited.filter_map(|(_, worker)| worker.take()).collect::<Vec<_>>() {
            self.workers.get_mut(&worker).expect("a reserved worker is attached").reserved = None;
            self.file_worker(worker);
        }
    }

    /// Hands the longest outstanding evaluations to idle slots as well. One that waits behind others has only
    /// to have waited for a moment; one that runs must have run for longer than most of its queue.
    fn duplicate_stragglers(&mut self, now: Millis) {
        if self.free.first().is_none_or(|&(load, _)| load >= Load::BUSY) {
            return;
        }
        // Asked once a queue and not once a lease: there may be many leases, and most are young.
        let due: BTreeMap<QueueId, u64> =
            self.queues.iter().filter_map(|(&id, queue)| Some((id, straggles_after_ms(queue)?))).collect();
        let mut stragglers = Vec::new();
        for lease in self.workers.values().flat_map(|worker| worker.leases()) {
            let is_late = match lease.begun {
                None => now.since(lease.since) >= STRAGGLER_LEAST_MS,
                Some(begun) => due.get(&lease.queue).is_some_and(|&due| now.since(begun) >= due),
            };
            if !is_late || self.queues[&lease.queue].paused {
                continue;
            }
            // What has a strike is not risked on a second worker.
            let entry = &self.evaluations[&lease.attempt.evaluation];
            if entry.strikes() == 0 && entry.outstanding().count() == 1 {
                stragglers.push((lease.since, lease.attempt.evaluation));
            }
        }
        stragglers.sort_unstable();
        for (_, evaluation) in stragglers {
            let entry = &self.evaluations[&evaluation];
            let idle = self.free.range(..(Load::BUSY, WorkerId(0)));
            let mut others = idle.filter(|(_, id)| {
                let has_it = entry.outstanding().any(|tried| tried.worker == *id);
                !has_it && !entry.has_opined(&self.workers[id].name)
            });
            if let Some(&(_, worker)) = others.next() {
                self.lease(evaluation, worker, false, now);
            }
        }
    }

    /// Hands an evaluation to a worker.
    pub(super) fn lease(&mut self, evaluation: u64, worker: WorkerId, alone: bool, now: Millis) {
        let entry = self.evaluations.get_mut(&evaluation).expect("what is handed out is open");
        let state = self.workers.get_mut(&worker).expect("evaluations go to attached workers");
        let number = entry.number();
        let seat = state.seat(AttemptId { evaluation, number }, entry.queue, 0, now);
        entry.attempt(number, worker, state.name.clone(), seat, alone);
        state.assigned.push(Assignment { number, evaluation: entry.evaluation.clone() });
        self.told.insert(worker);
        self.file_worker(worker);
    }
}

/// How long an evaluation of a queue may run before it is tried elsewhere as well, milliseconds. `None` while
/// too little is known of the queue.
fn straggles_after_ms(queue: &Queue) -> Option<u64> {
    let median = queue.durations.median()?;
    Some(((median * 1e3 * STRAGGLER_MEDIANS) as u64).max(STRAGGLER_LEAST_MS))
}

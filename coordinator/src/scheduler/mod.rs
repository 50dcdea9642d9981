//! The scheduler: who evaluates what until when. A plain state machine: events come in with the time, orders
//! go out. It has no clock, no socket, no thread and no memory of what is settled.
//!
//! ```text
//! evaluation   the words: what is asked for, reported and given back
//! queue        what is ready, and its fair share        worker   windows and leases of one worker
//! entry        the attempts at one open evaluation      ruling   the culling rule, as it counts
//! strikes      what is held against evaluations that may end their workers
//! hand_out     ready evaluations to free workers, suspects alone, stragglers twice
//! attendance   workers come, go, and fall silent
//! settle       what becomes of an evaluation when a report comes or a worker goes
//! audit        second opinions, and what becomes of a worker that is contradicted
//! ```
//!
//! **Leases.** An evaluation is handed to one worker until the worker falls silent; a report names the attempt.
//! A lease that is lost puts its evaluation back at the front of its queue. When the worker comes back and
//! still holds it, the lease is restored. The first outcome settles; what comes later changes nothing.
//!
//! **Strikes.** A worker that goes down gives a strike to what it may have been running then: the first
//! `slots` of its leases, since a worker works in order. Neighbours get strikes too, so two of them only make a
//! suspect: it gets a worker for itself alone, and the third strike falls only there, where no neighbour can have
//! been the cause. A failure that a worker lived to report is a strike as well.
//!
//! A process that is not heard of may be alive behind a line that is dead. Its strike is a presumption until
//! another process comes under its name, and is taken back when it comes itself. With the third strike an evaluation
//! is set aside at once if all are certain; else it waits for as long as a process may take to come back. Nobody is
//! set aside while an attempt is under way, or on whom two workers have an opinion.

mod attendance;
mod audit;
mod entry;
mod evaluation;
mod hand_out;
mod queue;
mod ruling;
mod settle;
mod strikes;
mod worker;

pub use attendance::{Loss, NameTaken};
pub use audit::Quarantine;
pub use entry::ATTEMPTS_KEPT;
pub use evaluation::{Assignment, AttemptId, Conflict, Evaluation, News, Report, Settled, TaskText};
pub use queue::QueueId;
pub use worker::{Hello, WorkerId, WorkerInfo, WorkerState};

use audit::Awaiting;
use entry::Entry;
use queue::Queue;
use settle::Remembered;
use std::collections::{BTreeMap, BTreeSet, VecDeque, btree_map};
use std::sync::Arc;
use strikes::Presumptions;
use worker::{Load, Worker};

/// A time: milliseconds from any fixed instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Millis(pub u64);

impl Millis {
    /// Since an earlier time; 0 since a later one.
    pub fn since(self, earlier: Millis) -> u64 {
        self.0.saturating_sub(earlier.0)
    }

    /// Moves a start that is waited from by a time that does not count, up to now.
    pub(crate) fn excuse(&mut self, pause_ms: u64, now: Millis) {
        self.0 = (self.0 + pause_ms).min(now.0);
    }
}

/// How long things may take, milliseconds.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Workers are to be heard of at least so often.
    pub heartbeat_ms: u64,
    /// A worker's silence ends its leases.
    pub timeout_ms: u64,
    /// An evaluation that runs for so long ends the attachment of its worker: it hangs, and heartbeats do
    /// not show it.
    pub overdue_ms: u64,
    /// Whoever was lost and lives is back within this time.
    pub parole_ms: u64,
}

/// What the scheduler wants done.
#[derive(Debug)]
pub enum Order {
    /// Tell a worker what nobody needs any more, and then what to do next. Either may be empty.
    Tell {
        /// Whom.
        worker: WorkerId,
        /// What to drop.
        revoked: Vec<AttemptId>,
        /// What to do.
        assigned: Vec<Assignment>,
    },
    /// Close the stream of a worker that is attached no more.
    Dismiss {
        /// Whose.
        worker: WorkerId,
        /// Why.
        loss: Loss,
        /// How many leases ended with it.
        leases: u64,
    },
    /// Tell everybody that a worker is trusted no more.
    Quarantine(Quarantine),
    /// Tell a queue's owner what is settled, and what contradicts it.
    Deliver {
        /// Whose.
        queue: QueueId,
        /// In the order in which they were settled.
        settled: Vec<Settled>,
        /// Mostly empty.
        conflicts: Vec<Conflict>,
        /// Workers that are trusted no more, which each queue is told: mostly empty.
        quarantined: Vec<Quarantine>,
    },
}

/// The fleet in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Summary {
    /// Workers attached, draining ones included.
    pub workers: u32,
    /// What those of them that take evaluations run at once.
    pub slots: u32,
    /// Leases.
    pub in_flight: u64,
    /// Evaluations that wait to be handed out, paused queues included.
    pub ready: u64,
    /// Those of them on which workers differ, and which another one must decide.
    pub disputed: u64,
    /// Evaluations that are about to be set aside, unless one of the workers that were lost with them is back.
    pub condemned: u64,
}

/// The state of everything that is under evaluation.
#[derive(Debug)]
pub struct Scheduler {
    limits: Limits,
    workers: BTreeMap<WorkerId, Worker>,
    names: BTreeMap<Arc<str>, WorkerId>,
    gone: VecDeque<WorkerInfo>, // (≤ GONE_REMEMBERED), oldest first
    queues: BTreeMap<QueueId, Queue>,
    evaluations: BTreeMap<u64, Entry>,
    /// Workers that can take more, the least loaded first.
    free: BTreeSet<(Load, WorkerId)>,
    /// Queues with something to hand out, the least served first.
    runnable: BTreeSet<(u128, QueueId)>,
    /// The pass of the queue served last: one that has slept begins from here, and hoards no claim.
    pass: u128,
    /// Suspects to be handed out, and the worker that is being emptied for each.
    suspects: BTreeMap<u64, Option<WorkerId>>,
    /// Evaluations with three strikes, not all of them certain, and since when.
    condemned: BTreeMap<u64, Millis>,
    presumptions: Presumptions,
    /// Evaluations that wait for another opinion.
    awaiting: Awaiting,
    /// When two workers were last there to take evaluations.
    company: Millis,
    /// Names of workers that are trusted no more.
    quarantined: BTreeSet<Arc<str>>,
    /// What a late report may contradict, oldest first.
    remembered: VecDeque<Remembered>,
    /// Workers and queues with something in their boxes, and workers to dismiss: this round's orders.
    told: BTreeSet<WorkerId>,
    delivered: BTreeSet<QueueId>,
    dismissed: Vec<(WorkerId, Loss, u64)>,
    verdicts: Vec<Quarantine>,
    worker_next: u64,
    queue_next: u64,
    /// When the time was last advanced, and stragglers last looked for.
    advanced: Millis,
    looked: Millis,
    stopped: bool,
}

impl Scheduler {
    /// A scheduler without workers or queues.
    pub fn new(limits: Limits, now: Millis) -> Scheduler {
        Scheduler {
            limits,
            workers: BTreeMap::new(),
            names: BTreeMap::new(),
            gone: VecDeque::new(),
            queues: BTreeMap::new(),
            evaluations: BTreeMap::new(),
            free: BTreeSet::new(),
            runnable: BTreeSet::new(),
            pass: 0,
            suspects: BTreeMap::new(),
            condemned: BTreeMap::new(),
            presumptions: Presumptions::default(),
            awaiting: Awaiting::default(),
            company: now,
            quarantined: BTreeSet::new(),
            remembered: VecDeque::new(),
            told: BTreeSet::new(),
            delivered: BTreeSet::new(),
            dismissed: Vec::new(),
            verdicts: Vec::new(),
            worker_next: 1,
            queue_next: 1,
            advanced: now,
            looked: now,
            stopped: false,
        }
    }

    /// Trusts no worker of that name, from what is known of it from before.
    pub fn distrust(&mut self, name: &str) {
        self.quarantined.insert(name.into());
    }

    /// Opens a queue. Between queues that have something ready, workers' time is shared by weight; a weight
    /// of 0 counts as 1.
    pub fn open(&mut self, weight: u32) -> QueueId {
        let id = QueueId(self.queue_next);
        self.queue_next += 1;
        self.queues.insert(id, Queue::new(weight));
        id
    }

    /// Adds evaluations to a queue. One whose id is open already is left out: it is under evaluation.
    pub fn submit(&mut self, queue: QueueId, evaluations: Vec<Evaluation>) {
        let Some(state) = self.queues.get_mut(&queue) else { return };
        for evaluation in evaluations {
            if let btree_map::Entry::Vacant(vacant) = self.evaluations.entry(evaluation.id) {
                let entry = vacant.insert(Entry::new(queue, evaluation));
                state.ready.insert(entry.rank());
            }
        }
        self.file_queue(queue);
    }

    /// Hands out nothing more of a queue, or goes on. What runs is finished and delivered.
    pub fn pause(&mut self, queue: QueueId, paused: bool) {
        if let Some(state) = self.queues.get_mut(&queue) {
            state.paused = paused;
            self.file_queue(queue);
            if paused {
                self.release_reserved(queue);
            }
        }
    }

    /// Ends a queue: nothing of it is delivered any more, and its leases are revoked.
    pub fn cancel(&mut self, queue: QueueId, now: Millis) {
        let cancelled: Vec<u64> =
            self.evaluations.iter().filter(|(_, entry)| entry.queue == queue).map(|(&id, _)| id).collect();
        for id in cancelled {
            self.abandon(id, now);
        }
        if let Some(filed) = self.queues.remove(&queue).and_then(|state| state.filed) {
            self.runnable.remove(&(filed, queue));
        }
        self.delivered.remove(&queue);
        self.remembered.retain(|one| one.queue != queue);
    }

    /// Hands out nothing more, for good.
    pub fn stop(&mut self) {
        self.stopped = true;
    }

    /// Hands out what can be handed out, and gives this round's orders. For one worker, what is revoked comes
    /// before what is assigned.
    pub fn dispatch(&mut self, now: Millis) -> Vec<Order> {
        if !self.stopped {
            self.hand_out(now);
        }
        let mut orders = self.dismissals();
        for worker in std::mem::take(&mut self.told) {
            let Some(state) = self.workers.get_mut(&worker) else { continue };
            let (revoked, assigned) =
                (std::mem::take(&mut state.revoked), std::mem::take(&mut state.assigned));
            orders.push(Order::Tell { worker, revoked, assigned });
        }
        let quarantined = std::mem::take(&mut self.verdicts);
        if !quarantined.is_empty() {
            self.delivered.extend(self.queues.keys());
            orders.extend(quarantined.iter().cloned().map(Order::Quarantine));
        }
        for queue in std::mem::take(&mut self.delivered) {
            let Some(state) = self.queues.get_mut(&queue) else { continue };
            let (settled, conflicts) =
                (std::mem::take(&mut state.settled), std::mem::take(&mut state.conflicts));
            orders.push(Order::Deliver { queue, settled, conflicts, quarantined: quarantined.clone() });
        }
        orders
    }

    /// The orders to close the streams of workers that are attached no more: before anybody else comes under their names.
    pub fn dismissals(&mut self) -> Vec<Order> {
        let dismissed = std::mem::take(&mut self.dismissed).into_iter();
        dismissed.map(|(worker, loss, leases)| Order::Dismiss { worker, loss, leases }).collect()
    }

    /// Who is attached, by number, and who was, the last to go at the end.
    pub fn workers(&self) -> Vec<WorkerInfo> {
        self.workers.values().map(Worker::info).chain(self.gone.iter().cloned()).collect()
    }

    /// The fleet in numbers.
    pub fn summary(&self) -> Summary {
        let taking = self.workers.values().filter(|worker| worker.takes());
        Summary {
            workers: self.workers.len() as u32,
            slots: taking.map(Worker::slots).sum(),
            in_flight: self.workers.values().map(|worker| worker.lease_count() as u64).sum(),
            disputed: self.awaiting.disputed() as u64,
            condemned: self.condemned.len() as u64,
            ready: (self.suspects.len() + self.awaiting.len()) as u64
                + self.queues.values().map(|queue| queue.ready.len() as u64).sum::<u64>(),
        }
    }

    /// Puts a worker where its load and window say.
    fn file_worker(&mut self, id: WorkerId) {
        let Some(worker) = self.workers.get_mut(&id) else { return };
        let key = worker.can_take_more().then(|| worker.load());
        if worker.filed != key {
            if let Some(old) = worker.filed {
                self.free.remove(&(old, id));
            }
            if let Some(new) = key {
                self.free.insert((new, id));
            }
            worker.filed = key;
        }
    }

    /// Puts a queue where its pass says.
    fn file_queue(&mut self, id: QueueId) {
        let Some(queue) = self.queues.get_mut(&id) else { return };
        if queue.is_runnable() && queue.filed.is_none() {
            queue.pass = queue.pass.max(self.pass);
        }
        let key = queue.is_runnable().then_some(queue.pass);
        if queue.filed != key {
            if let Some(old) = queue.filed {
                self.runnable.remove(&(old, id));
            }
            if let Some(new) = key {
                self.runnable.insert((new, id));
            }
            queue.filed = key;
        }
    }
}

#[cfg(test)]
mod audits;
#[cfg(test)]
mod properties;
#[cfg(test)]
mod rig;
#[cfg(test)]
mod suspects;
#[cfg(test)]
mod tests;

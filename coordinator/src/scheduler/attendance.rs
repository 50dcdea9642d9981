//! Attendance: workers come, say that they live, leave, and fall silent. What becomes of their leases is settled
//! elsewhere.

use super::strikes::Strike;
use super::worker::{Lease, Worker};
use super::{AttemptId, Hello, Millis, Scheduler, WorkerId, WorkerInfo, WorkerState};

/// Why a worker is attached no more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// It hung up.
    Left,
    /// Its stream broke.
    Broke,
    /// It was silent for too long.
    Silent,
    /// An evaluation ran for too long.
    Overdue,
    /// It attached anew.
    Replaced,
    /// It does not take what it is sent.
    Stalled,
    /// It broke the protocol.
    Misspoke,
    /// Its token is good no more.
    Expelled,
}

impl Loss {
    /// Of attempts whose worker is trusted no more, and stays attached.
    pub(super) const QUARANTINED: &str = "worker quarantined";

    /// In the lineage.
    pub fn word(self) -> &'static str {
        match self {
            Loss::Left => "left",
            Loss::Broke => "stream broke",
            Loss::Silent => "silent",
            Loss::Overdue => "overdue",
            Loss::Replaced => "attached anew",
            Loss::Stalled => "took no messages",
            Loss::Misspoke => "broke the protocol",
            Loss::Expelled => "its token ended",
        }
    }

    /// Whether what it ran may have been the cause.
    fn is_suspicious(self) -> bool {
        matches!(self, Loss::Broke | Loss::Silent | Loss::Replaced)
    }
}

/// A worker of that name is attached and alive.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a worker of the name `{0}` is attached")]
pub struct NameTaken(pub String);

/// Workers that went are remembered for their counts, so many of them.
const GONE_REMEMBERED: usize = 256;

impl Scheduler {
    /// Attaches a worker. Leases that it holds from before are restored; what it holds in vain is revoked.
    ///
    /// # Errors
    /// A worker of that name is attached and was heard of within two heartbeats.
    pub fn attach(&mut self, hello: Hello, now: Millis) -> Result<WorkerId, NameTaken> {
        if let Some(&old) = self.names.get(&*hello.name) {
            if now.since(self.workers[&old].heard) <= 2 * self.limits.heartbeat_ms {
                return Err(NameTaken(hello.name));
            }
            self.dismiss(old, Loss::Replaced, now);
        }
        let id = WorkerId(self.worker_next);
        self.worker_next += 1;
        let (holding, incarnation) = (hello.holding.clone(), hello.incarnation);
        let mut worker = Worker::new(id, hello, now);
        worker.quarantined = self.quarantined.contains(&worker.name);
        if let Some(at) = self.gone.iter().position(|gone| gone.name == *worker.name)
            && let Some(gone) = self.gone.remove(at)
        {
            (worker.completed, worker.lost, worker.busy_seconds) =
                (gone.completed, gone.lost, gone.busy_seconds);
        }
        self.names.insert(worker.name.clone(), id);
        self.workers.insert(id, worker);
        self.review(id, incarnation, now);
        for attempt in holding {
            self.restore(id, attempt, now);
        }
        self.file_worker(id);
        Ok(id)
    }

    /// A worker gave a sign of life.
    pub fn heard(&mut self, worker: WorkerId, now: Millis) {
        if let Some(worker) = self.workers.get_mut(&worker) {
            worker.heard = now;
        }
    }

    /// A worker takes so many evaluations at once from now on.
    pub fn window(&mut self, worker: WorkerId, evaluations: u32) {
        if let Some(state) = self.workers.get_mut(&worker) {
            state.window = evaluations.max(1);
            self.file_worker(worker);
        }
    }

    /// A worker takes nothing new and gives back what it has not begun.
    pub fn drain(&mut self, worker: WorkerId, returned: &[AttemptId], now: Millis) {
        let Some(state) = self.workers.get_mut(&worker) else { return };
        state.draining = true;
        let name = state.name.clone();
        if let Some(suspect) = state.reserved
            && let Some(awaited @ Some(_)) = self.suspects.get_mut(&suspect)
        {
            *awaited = None;
            state.reserved = None;
        }
        self.file_worker(worker);
        for attempt in returned {
            self.give_back(&name, *attempt, now);
        }
    }

    /// A worker is attached no more. Its leases are void, and what it may have been running gets a strike if
    /// that may have been the cause. Gives the number of leases that ended so.
    ///
    /// A worker that drains and then hangs up has reported all that it ran: what it was handed while its word was on
    /// the way it never began, and gives back with that.
    pub fn lose(&mut self, worker: WorkerId, loss: Loss, now: Millis) -> u64 {
        let Some(state) = self.workers.remove(&worker) else { return 0 };
        let lost_before = state.lost;
        if let Some(load) = state.filed {
            self.free.remove(&(load, worker));
        }
        self.names.remove(&state.name);
        self.told.remove(&worker);
        if let Some(awaited) = state.reserved.and_then(|suspect| self.suspects.get_mut(&suspect)) {
            *awaited = None;
        }
        let mut info = state.info();
        for lease in state.leases() {
            if state.draining && loss == Loss::Left {
                self.give_back(&state.name, lease.attempt, now);
                continue;
            }
            info.lost += 1;
            let is_overdue = loss == Loss::Overdue && lease.ran_ms(now) > self.limits.overdue_ms;
            let strike = match lease.begun {
                Some(_) if is_overdue => Some(Strike::Certain),
                // One that drains was to end anyway.
                Some(_) if loss.is_suspicious() && !state.draining => {
                    Some(Strike::Presumed(state.incarnation))
                }
                _ => None,
            };
            self.void(lease, loss, strike, now);
        }
        if self.gone.len() == GONE_REMEMBERED {
            self.gone.pop_front();
        }
        let lost = info.lost - lost_before;
        let state = if state.quarantined { WorkerState::Quarantined } else { WorkerState::Gone };
        self.gone.push_back(WorkerInfo { state, in_flight: 0, ..info });
        lost
    }

    /// Lets time pass: workers that were silent for too long, or run one evaluation for too long, are lost, and
    /// evaluations are set aside whose workers have not come back.
    ///
    /// Time counts only while somebody listened: when this is called after a longer pause than a heartbeat (the
    /// process was stopped, the machine slept), all that is waited for gets the pause back. Gives that pause,
    /// milliseconds.
    pub fn advance(&mut self, now: Millis) -> u64 {
        let elapsed = now.since(self.advanced);
        let pause = elapsed.saturating_sub(self.limits.heartbeat_ms);
        self.advanced = now;
        // Nor does it count as time to come back while nobody at all gets through.
        let parole_pause = if self.workers.is_empty() { elapsed } else { pause };
        self.condemned.values_mut().for_each(|since| since.excuse(parole_pause, now));
        let mut losses = Vec::new();
        for worker in self.workers.values_mut() {
            worker.excuse(pause, now);
            let is_overdue = |lease: &Lease| lease.ran_ms(now) > self.limits.overdue_ms;
            if now.since(worker.heard) > self.limits.timeout_ms {
                losses.push((worker.id, Loss::Silent));
            } else if worker.leases().any(is_overdue) {
                losses.push((worker.id, Loss::Overdue));
            }
        }
        for (worker, loss) in losses {
            self.dismiss(worker, loss, now);
        }
        self.pass_sentence(now);
        pause
    }

    /// Loses a worker on this side's account.
    pub(super) fn dismiss(&mut self, worker: WorkerId, loss: Loss, now: Millis) {
        let leases = self.lose(worker, loss, now);
        self.dismissed.push((worker, loss, leases));
    }
}

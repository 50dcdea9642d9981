//! One attached worker: its window, and the leases it holds in the order in which it works on them. It knows
//! nothing of queues.

use super::{Assignment, AttemptId, Millis, QueueId};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A worker's number, of one attachment: it gets another one when it comes back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WorkerId(pub u64);

/// What a worker says of itself when it attaches.
#[derive(Debug, Clone)]
pub struct Hello {
    /// Unique in the fleet.
    pub name: String,
    /// Its machine.
    pub host: String,
    /// Of its process: another process has another one.
    pub incarnation: u64,
    /// Of its program.
    pub version: String,
    /// What it runs at once; at least 1.
    pub slots: u32,
    /// What it takes at once, running evaluations included; at least 1.
    pub window: u32,
    /// Attempts that it still runs, or whose reports it still holds.
    pub holding: Vec<AttemptId>,
    /// What its starter says of it.
    pub labels: BTreeMap<String, String>,
}

/// What a worker is up to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorkerState {
    /// Takes evaluations.
    Attached,
    /// Finishes what it runs and takes nothing new.
    Draining,
    /// Found other bits than two others, and is trusted no more; attached or not.
    Quarantined,
    /// Is attached no more.
    Gone,
}

impl WorkerState {
    /// Its word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            WorkerState::Attached => "attached",
            WorkerState::Draining => "draining",
            WorkerState::Quarantined => "quarantined",
            WorkerState::Gone => "gone",
        }
    }
}

/// What is known of a worker. Counts go on when it comes back under its name.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkerInfo {
    /// Of its latest attachment.
    pub id: WorkerId,
    /// Unique in the fleet.
    pub name: String,
    /// Its machine.
    pub host: String,
    /// Of its program.
    pub version: String,
    /// What it runs at once.
    pub slots: u32,
    /// What it takes at once.
    pub window: u32,
    /// What it is up to.
    pub state: WorkerState,
    /// Leases that it holds.
    pub in_flight: u32,
    /// Outcomes of its that counted.
    pub completed: u64,
    /// Attempts lost with it.
    pub lost: u64,
    /// Spent on the attempts that it reported.
    pub busy_seconds: f64,
    /// When it attached.
    pub attached: Millis,
    /// When it was last heard of.
    pub heard: Millis,
    /// What its starter says of it.
    pub labels: BTreeMap<String, String>,
}

/// An evaluation handed to this worker.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lease {
    pub(super) attempt: AttemptId,
    pub(super) queue: QueueId,
    /// When it was handed out.
    pub(super) since: Millis,
    /// When it came to stand among the first `slots`, so that the worker may have begun it.
    pub(super) begun: Option<Millis>,
}

impl Lease {
    /// How long it may have been running; 0 if it has not begun.
    pub(super) fn ran_ms(&self, now: Millis) -> u64 {
        self.begun.map_or(0, |begun| now.since(begun))
    }
}

#[derive(Debug)]
pub(super) struct Worker {
    pub(super) id: WorkerId,
    pub(super) name: Arc<str>,
    pub(super) incarnation: u64,
    host: String,
    version: String,
    labels: BTreeMap<String, String>,
    slots: u32,
    pub(super) window: u32,
    /// Leases by seat, a number that counts up as they are handed out: a worker works in that order. The
    /// first `slots` may be running; the others wait.
    running: BTreeMap<u64, Lease>,
    waiting: BTreeMap<u64, Lease>,
    seat_next: u64,
    pub(super) attached: Millis,
    pub(super) heard: Millis,
    pub(super) draining: bool,
    /// Is trusted no more.
    pub(super) quarantined: bool,
    /// A suspect that it must have for itself alone: nothing else is handed to it until that has ended.
    pub(super) reserved: Option<u64>,
    pub(super) completed: u64,
    pub(super) lost: u64,
    pub(super) busy_seconds: f64,
    /// What to tell it at the end of this round.
    pub(super) revoked: Vec<AttemptId>,
    pub(super) assigned: Vec<Assignment>,
    /// Its key among the workers that can take more, while it stands there.
    pub(super) filed: Option<Load>,
}

/// How full a worker is: leases over slots, in units of 2⁻¹⁶.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Load(u64);

impl Load {
    /// From here on no slot is idle.
    pub(super) const BUSY: Load = Load(1 << 16);
}

impl Worker {
    pub(super) fn new(id: WorkerId, hello: Hello, now: Millis) -> Worker {
        Worker {
            id,
            name: hello.name.into(),
            incarnation: hello.incarnation,
            host: hello.host,
            version: hello.version,
            labels: hello.labels,
            slots: hello.slots.max(1),
            window: hello.window.max(1),
            running: BTreeMap::new(),
            waiting: BTreeMap::new(),
            seat_next: 0,
            attached: now,
            heard: now,
            draining: false,
            quarantined: false,
            reserved: None,
            completed: 0,
            lost: 0,
            busy_seconds: 0.0,
            revoked: Vec::new(),
            assigned: Vec::new(),
            filed: None,
        }
    }

    /// Takes on a lease of what has run for `ran_ms` already, and gives its seat.
    pub(super) fn seat(&mut self, attempt: AttemptId, queue: QueueId, ran_ms: u64, now: Millis) -> u64 {
        let seat = self.seat_next;
        self.seat_next += 1;
        if self.running.len() < self.slots as usize {
            let begun = Some(Millis(now.0.saturating_sub(ran_ms)));
            self.running.insert(seat, Lease { attempt, queue, since: now, begun });
        } else {
            self.waiting.insert(seat, Lease { attempt, queue, since: now, begun: None });
        }
        seat
    }

    /// Ends a lease; the first of those that wait moves up.
    pub(super) fn release(&mut self, seat: u64, now: Millis) {
        if self.running.remove(&seat).is_none() {
            self.waiting.remove(&seat);
        } else if let Some((seat, lease)) = self.waiting.pop_first() {
            self.running.insert(seat, Lease { begun: Some(now), ..lease });
        }
    }

    /// Nobody listened to it for a time, nor could it deliver what it ran.
    pub(super) fn excuse(&mut self, pause_ms: u64, now: Millis) {
        self.heard.excuse(pause_ms, now);
        self.running
            .values_mut()
            .filter_map(|lease| lease.begun.as_mut())
            .for_each(|b| b.excuse(pause_ms, now));
    }

    /// Its leases in the order of work.
    pub(super) fn leases(&self) -> impl Iterator<Item = &Lease> {
        self.running.values().chain(self.waiting.values())
    }

    pub(super) fn lease_count(&self) -> usize {
        self.running.len() + self.waiting.len()
    }

    pub(super) fn slots(&self) -> u32 {
        self.slots
    }

    pub(super) fn load(&self) -> Load {
        Load(((self.lease_count() as u64) << 16) / u64::from(self.slots))
    }

    /// Whether it is there to be handed anything at all.
    pub(super) fn takes(&self) -> bool {
        !self.draining && !self.quarantined
    }

    /// Whether it can be handed another evaluation that does not ask for solitude.
    pub(super) fn can_take_more(&self) -> bool {
        self.takes() && self.reserved.is_none() && self.lease_count() < self.window as usize
    }

    pub(super) fn info(&self) -> WorkerInfo {
        WorkerInfo {
            id: self.id,
            name: self.name.to_string(),
            host: self.host.clone(),
            version: self.version.clone(),
            slots: self.slots,
            window: self.window,
            state: match self {
                Worker { quarantined: true, .. } => WorkerState::Quarantined,
                Worker { draining: true, .. } => WorkerState::Draining,
                _ => WorkerState::Attached,
            },
            in_flight: self.lease_count() as u32,
            completed: self.completed,
            lost: self.lost,
            busy_seconds: self.busy_seconds,
            attached: self.attached,
            heard: self.heard,
            labels: self.labels.clone(),
        }
    }
}

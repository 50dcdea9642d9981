//! The fleet: runs the scheduler in one loop that owns it, and gives handles to those who submit evaluations
//! and to those who hold a worker's stream. It decides nothing that the scheduler decides.

mod counts;
mod obstacle;
mod rounds;
mod session;

pub use crate::lineage::{Attempt, Fate, Joined, Ruling, SetAside};
pub use crate::scheduler::{
    Conflict, Evaluation, Millis, Quarantine, Settled, Summary, TaskText, WorkerInfo, WorkerState,
};
pub(crate) use counts::Counts;
pub(crate) use obstacle::Refused;
pub(crate) use session::{Attachment, Mouth};

use crate::scheduler::{AttemptId, Hello, Loss, QueueId, Report, WorkerId};
use proto::refusal::Refusal;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};
use tokio::sync::{broadcast, mpsc, oneshot, watch};
use tokio::time::Instant;

/// What a fleet is told when it starts.
#[derive(Debug, Clone)]
pub struct FleetSettings {
    /// Workers show that they are alive at least so often, milliseconds.
    pub heartbeat_ms: u32,
    /// Silence that ends a worker's leases, milliseconds.
    pub timeout_ms: u32,
    /// An evaluation that runs for longer hangs, and ends its worker, whose heartbeats do not show it. Seconds.
    pub overdue_s: u32,
    /// Of this program: workers of another version are refused.
    pub version: String,
    /// Of this program's physics on this machine: workers that compute other bits are refused.
    pub fingerprint: [u8; 32],
    /// The lineage's identity: reports that workers hold for another one are void.
    pub lineage: [u8; 16],
    /// Names of workers that are trusted no more, from before.
    pub quarantined: Vec<String>,
}

/// A worker came or went.
#[derive(Debug, Clone)]
pub enum Change {
    /// It is attached.
    Joined(Joined),
    /// It is attached no more.
    Left {
        /// Its name.
        name: String,
        /// Why.
        reason: &'static str,
    },
    /// It is trusted no more.
    Quarantined(Quarantine),
}

/// A process that was lost and lives is back within this time: it finds out for itself that its line is dead within
/// 15 s, dials for up to 10 s, and waits for up to 5 s between tries.
pub(crate) const PAROLE_MS: u64 = 60_000;
/// Events that may wait for the loop; beyond that whoever brings one waits.
const EVENTS_MAX: usize = 1024;
/// Changes that a slow reader may be behind before it misses some.
const CHANGES_MAX: usize = 4096;

/// All workers and all that they are to evaluate. Clones share it; it ends with the last of them.
#[derive(Debug, Clone)]
pub struct Fleet {
    settings: Arc<FleetSettings>,
    clock: Clock,
    events: mpsc::Sender<Event>,
    summary: watch::Receiver<Summary>,
    changes: broadcast::Sender<Change>,
    counts: Counts,
    /// The last worker that was turned away, until one is let in.
    refused: watch::Sender<Option<Refused>>,
}

impl Fleet {
    /// Starts a fleet without workers, on the present runtime.
    pub fn start(settings: FleetSettings) -> Fleet {
        let settings = Arc::new(settings);
        let clock = Clock::start();
        let (events, inbox) = mpsc::channel(EVENTS_MAX);
        let (summary_sender, summary) = watch::channel(Summary::default());
        let changes = broadcast::Sender::new(CHANGES_MAX);
        let counts = Counts::default();
        let rounds =
            rounds::Rounds::new(settings.clone(), clock, summary_sender, changes.clone(), counts.clone());
        tokio::spawn(rounds.run(inbox));
        let refused = watch::Sender::new(None);
        Fleet { settings, clock, events, summary, changes, counts, refused }
    }

    /// Opens a queue: where to put evaluations, and where they come out. The label names it in the log.
    /// Between queues with something to hand out, the workers' time is shared by weight, at least 1.
    pub async fn queue(&self, label: String, weight: u32) -> (Queue, QueueOutput) {
        let (deliver, deliveries) = mpsc::unbounded_channel();
        let (reply, id) = oneshot::channel();
        self.tell(Event::Open { label, weight, deliver, reply }).await;
        // After the goodbye there are no queues: the output of this one has ended.
        let id = id.await.unwrap_or(QueueId(0));
        let control = QueueControl { id, events: self.events.clone() };
        (Queue { control }, QueueOutput { deliveries, conflicts: Vec::new(), quarantined: Vec::new() })
    }

    /// The fleet in numbers, as of late.
    pub fn summary(&self) -> watch::Receiver<Summary> {
        self.summary.clone()
    }

    /// Who is attached, and who was of late.
    pub async fn workers(&self) -> Vec<WorkerInfo> {
        let (reply, workers) = oneshot::channel();
        self.tell(Event::Workers(reply)).await;
        workers.await.unwrap_or_default()
    }

    /// Workers that come and go from now on.
    pub fn changes(&self) -> broadcast::Receiver<Change> {
        self.changes.subscribe()
    }

    /// A time of this fleet as Unix time, milliseconds.
    pub fn unix_ms(&self, time: Millis) -> i64 {
        self.clock.unix_start_ms + time.0 as i64
    }

    /// Ends the fleet: hands out nothing more, tells the workers and closes their streams. Outputs of queues
    /// end; what was not settled by then never is.
    pub async fn goodbye(&self) {
        let (reply, said) = oneshot::channel();
        self.tell(Event::Goodbye(reply)).await;
        // An error says that somebody else has said goodbye before.
        let _ = said.await;
    }

    /// Why nothing can be handed out at present; empty if it can.
    pub fn obstacle(&self) -> String {
        obstacle::words(&self.summary.borrow(), self.refused.borrow().as_ref())
    }

    /// What somebody who looks at the workers should know beside them.
    pub fn notes(&self) -> Vec<String> {
        obstacle::notes(&self.summary.borrow(), self.refused.borrow().as_ref())
    }

    pub(crate) fn counts(&self) -> &Counts {
        &self.counts
    }

    /// A worker was turned away at the door.
    pub(crate) fn turned_away(&self, name: &str, host: &str, refusal: &Refusal) {
        self.counts.refused(refusal);
        tracing::warn!(worker = name, host, "worker refused: {refusal}");
        self.refused.send_replace(Some(Refused {
            name: name.to_owned(),
            host: host.to_owned(),
            reason: refusal.to_string(),
        }));
    }

    pub(crate) fn settings(&self) -> &FleetSettings {
        &self.settings
    }

    /// Attaches a worker that has introduced itself.
    ///
    /// # Errors
    /// Its name is taken by a worker that is alive. `None`: the fleet has said goodbye.
    pub(crate) async fn attach(
        &self,
        hello: Hello,
        fingerprint: [u8; 32],
    ) -> Option<Result<Attachment, Refusal>> {
        let (outbox, messages) = mpsc::channel(session::MESSAGES_MAX);
        let (open, closed) = oneshot::channel();
        let (reply, answer) = oneshot::channel();
        let session = session::Session::new(outbox, open, self.clock.now());
        self.tell(Event::Attach { hello, fingerprint, session, reply }).await;
        let attached = answer.await.ok()?;
        Some(match attached {
            Ok(worker) => {
                self.refused.send_replace(None);
                Ok(Attachment { worker, messages, closed, events: self.events.clone() })
            }
            Err(taken) => Err(Refusal::NameTaken { name: taken.0 }),
        })
    }

    /// After the goodbye nobody listens, and nothing is to be done about it.
    async fn tell(&self, event: Event) {
        let _ = self.events.send(event).await;
    }
}

/// Where evaluations are put in.
#[derive(Debug, Clone)]
pub struct Queue {
    control: QueueControl,
}

impl Queue {
    /// Adds evaluations. They are handed out in their order, not in that of submission. An id that is under
    /// evaluation already is left as it is.
    pub async fn submit(&self, evaluations: Vec<Evaluation>) {
        self.control.tell(Event::Submit(self.control.id, evaluations)).await;
    }

    /// To pause, resume or cancel it from elsewhere.
    pub fn control(&self) -> QueueControl {
        self.control.clone()
    }
}

/// Steers a queue.
#[derive(Debug, Clone)]
pub struct QueueControl {
    id: QueueId,
    events: mpsc::Sender<Event>,
}

impl QueueControl {
    /// Hands out nothing more. What runs is finished and comes out.
    pub async fn pause(&self) {
        self.tell(Event::Pause(self.id, true)).await;
    }

    /// Goes on after a pause.
    pub async fn resume(&self) {
        self.tell(Event::Pause(self.id, false)).await;
    }

    /// Ends the queue: its leases are revoked and its output ends.
    pub async fn cancel(&self) {
        self.tell(Event::Cancel(self.id)).await;
    }

    async fn tell(&self, event: Event) {
        // After the goodbye nobody listens, and nothing is to be done about it.
        let _ = self.events.send(event).await;
    }
}

/// Where settled evaluations come out. Dropped, it cancels its queue.
///
/// It holds no more than was submitted, since every evaluation is settled once; so the fleet never waits for
/// an owner.
#[derive(Debug)]
pub struct QueueOutput {
    deliveries: mpsc::UnboundedReceiver<Delivery>,
    conflicts: Vec<Conflict>,
    quarantined: Vec<Quarantine>,
}

impl QueueOutput {
    /// What was settled since, in that order: whatever is ready, at least one unless there was a conflict or a
    /// quarantine.
    /// `None`: the queue was cancelled, or the fleet has said goodbye.
    ///
    /// Dropping the future loses nothing.
    pub async fn next(&mut self) -> Option<Vec<Settled>> {
        let Delivery { mut settled, conflicts, quarantined } = self.deliveries.recv().await?;
        self.conflicts.extend(conflicts);
        self.quarantined.extend(quarantined);
        while let Ok(more) = self.deliveries.try_recv() {
            settled.extend(more.settled);
            self.conflicts.extend(more.conflicts);
            self.quarantined.extend(more.quarantined);
        }
        Some(settled)
    }

    /// Outcomes that contradict what was settled, of which [`QueueOutput::next`] has learnt (walker X-18).
    pub fn take_conflicts(&mut self) -> Vec<Conflict> {
        std::mem::take(&mut self.conflicts)
    }

    /// Workers that are trusted no more, of which [`QueueOutput::next`] has learnt: what they delivered and no audit
    /// has confirmed is in doubt, that of the same call included.
    pub fn take_quarantined(&mut self) -> Vec<Quarantine> {
        std::mem::take(&mut self.quarantined)
    }
}

#[derive(Debug)]
struct Delivery {
    settled: Vec<Settled>,
    conflicts: Vec<Conflict>,
    quarantined: Vec<Quarantine>,
}

/// What the loop is told.
#[derive(Debug)]
enum Event {
    Attach {
        hello: Hello,
        fingerprint: [u8; 32],
        session: session::Session,
        reply: oneshot::Sender<Result<WorkerId, crate::scheduler::NameTaken>>,
    },
    Reports(WorkerId, Vec<Report>),
    Heard(WorkerId),
    Window(WorkerId, u32),
    Drain(WorkerId, Vec<AttemptId>),
    Ended(WorkerId, Loss, Option<tonic::Status>),
    Open {
        label: String,
        weight: u32,
        deliver: mpsc::UnboundedSender<Delivery>,
        reply: oneshot::Sender<QueueId>,
    },
    Submit(QueueId, Vec<Evaluation>),
    Pause(QueueId, bool),
    Cancel(QueueId),
    Workers(oneshot::Sender<Vec<WorkerInfo>>),
    Goodbye(oneshot::Sender<()>),
}

/// Milliseconds since the start of the fleet, which no change of the wall clock moves.
#[derive(Debug, Clone, Copy)]
struct Clock {
    start: Instant,
    unix_start_ms: i64,
}

impl Clock {
    fn start() -> Clock {
        let unix = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Clock { start: Instant::now(), unix_start_ms: unix.as_millis() as i64 }
    }

    fn now(&self) -> Millis {
        Millis(self.start.elapsed().as_millis() as u64)
    }
}

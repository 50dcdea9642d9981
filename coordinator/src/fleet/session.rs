//! A worker's stream as the fleet sees it: messages that it has yet to take, and the tasks that it knows. A
//! worker that takes nothing is let go; nobody waits for it.

use super::Event;
use crate::scheduler::{Assignment, AttemptId, Loss, Millis, Report, WorkerId};
use bytes::Bytes;
use proto::convert::TaskHash;
use proto::v1;
use std::collections::BTreeMap;
use std::convert::Infallible;
use tokio::sync::{mpsc, oneshot};
use tonic::Status;

/// Messages that may wait for a worker. Each batch spends credit that only a report gives back, so a worker
/// with more of them waiting than this does not take them.
pub(super) const MESSAGES_MAX: usize = 1024;
/// Genotypes in one message, bytes: short enough for others to get between, far below the limit of a message.
const BATCH_SIZE_MAX: usize = 1 << 20;

/// The fleet's end of a worker's stream.
#[derive(Debug)]
pub(crate) struct Session {
    outbox: mpsc::Sender<Result<v1::CoordinatorMessage, Status>>,
    /// Dropped with the session: tells the other end that it is over.
    _open: oneshot::Sender<Infallible>,
    /// Tasks that were sent, once a stream, with the hash as it goes into assignments.
    tasks: BTreeMap<TaskHash, Bytes>,
    sent: u64,
    /// How many messages it had taken when it last took one, and when that was seen.
    taken: (u64, Millis),
}

/// A stream did not take a message: it is full, or gone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unsent(pub(super) Loss);

impl Session {
    pub(super) fn new(
        outbox: mpsc::Sender<Result<v1::CoordinatorMessage, Status>>,
        open: oneshot::Sender<Infallible>,
        now: Millis,
    ) -> Session {
        Session { outbox, _open: open, tasks: BTreeMap::new(), sent: 0, taken: (0, now) }
    }

    /// Whether the other end is gone.
    pub(super) fn is_closed(&self) -> bool {
        self.outbox.is_closed()
    }

    /// Since when messages wait and none is taken; `None` while all goes well.
    pub(super) fn stuck_since(&mut self, now: Millis) -> Option<Millis> {
        let waiting = self.outbox.max_capacity() - self.outbox.capacity();
        let taken = self.sent - waiting as u64;
        if waiting == 0 || taken != self.taken.0 {
            self.taken = (taken, now);
        }
        (waiting > 0).then_some(self.taken.1)
    }

    /// Nobody saw to the stream for a time, which is not held against it.
    pub(super) fn excuse(&mut self, pause_ms: u64, now: Millis) {
        self.taken.1.excuse(pause_ms, now);
    }

    pub(super) fn send(&mut self, kind: v1::coordinator_message::Kind) -> Result<(), Unsent> {
        self.sent += 1;
        self.outbox.try_send(Ok(v1::CoordinatorMessage { kind: Some(kind) })).map_err(|error| match error {
            mpsc::error::TrySendError::Full(_) => Unsent(Loss::Stalled),
            mpsc::error::TrySendError::Closed(_) => Unsent(Loss::Broke),
        })
    }

    /// The last word before the stream is closed.
    pub(super) fn refuse(&mut self, status: Status) {
        // A stream that is full or gone ends without it.
        let _ = self.outbox.try_send(Err(status));
    }

    /// Tells a worker what nobody needs any more, then what to do.
    pub(super) fn tell(&mut self, revoked: Vec<AttemptId>, assigned: Vec<Assignment>) -> Result<(), Unsent> {
        use v1::coordinator_message::Kind;
        if !revoked.is_empty() {
            let attempts = revoked
                .into_iter()
                .map(|AttemptId { evaluation, number }| v1::Attempt { evaluation, number });
            self.send(Kind::Revoke(v1::Revoke { attempts: attempts.collect() }))?;
        }
        let mut batch = Vec::with_capacity(assigned.len());
        let mut size = 0;
        for Assignment { number, evaluation } in assigned {
            let task = self.know(&evaluation.task)?;
            if size + evaluation.genotype.len() > BATCH_SIZE_MAX && !batch.is_empty() {
                self.send(Kind::Batch(v1::Batch { assignments: std::mem::take(&mut batch) }))?;
                size = 0;
            }
            size += evaluation.genotype.len();
            batch.push(v1::Assignment {
                attempt: Some(v1::Attempt { evaluation: evaluation.id, number }),
                task,
                genotype: evaluation.genotype,
                seed: evaluation.seed,
                cull: evaluation.cull.map(Into::into),
            });
        }
        if batch.is_empty() {
            return Ok(());
        }
        self.send(Kind::Batch(v1::Batch { assignments: batch }))
    }

    /// Sends a task unless the worker has it, and gives its name.
    fn know(&mut self, task: &super::TaskText) -> Result<Bytes, Unsent> {
        if let Some(name) = self.tasks.get(&task.hash) {
            return Ok(name.clone());
        }
        let name = Bytes::from(task.hash);
        self.tasks.insert(task.hash, name.clone());
        self.send(v1::coordinator_message::Kind::Task(v1::Task {
            hash: name.clone(),
            system: task.system.clone(),
            version: task.version,
            spec: task.spec.clone(),
        }))?;
        Ok(name)
    }
}

/// The service's end of a worker's stream.
#[derive(Debug)]
pub(crate) struct Attachment {
    pub(crate) worker: WorkerId,
    /// What to send to it. Ends when the fleet has closed the stream.
    pub(crate) messages: mpsc::Receiver<Result<v1::CoordinatorMessage, Status>>,
    /// Resolves when the fleet has closed the stream.
    pub(crate) closed: oneshot::Receiver<Infallible>,
    pub(super) events: mpsc::Sender<Event>,
}

/// What a worker says, for the fleet to hear. Waits while the fleet is busy.
#[derive(Debug, Clone)]
pub(crate) struct Mouth {
    worker: WorkerId,
    events: mpsc::Sender<Event>,
}

impl Attachment {
    pub(crate) fn mouth(&self) -> Mouth {
        Mouth { worker: self.worker, events: self.events.clone() }
    }
}

impl Mouth {
    pub(crate) async fn heartbeat(&self) {
        self.tell(Event::Heard(self.worker)).await;
    }

    pub(crate) async fn reports(&self, reports: Vec<Report>) {
        self.tell(Event::Reports(self.worker, reports)).await;
    }

    pub(crate) async fn window(&self, evaluations: u32) {
        self.tell(Event::Window(self.worker, evaluations)).await;
    }

    pub(crate) async fn drain(&self, returned: Vec<AttemptId>) {
        self.tell(Event::Drain(self.worker, returned)).await;
    }

    /// The worker has hung up.
    pub(crate) async fn left(&self) {
        self.tell(Event::Ended(self.worker, Loss::Left, None)).await;
    }

    /// The stream broke.
    pub(crate) async fn broke(&self) {
        self.tell(Event::Ended(self.worker, Loss::Broke, None)).await;
    }

    /// The worker broke the protocol, and is to be told so.
    pub(crate) async fn misspoke(&self, status: Status) {
        self.tell(Event::Ended(self.worker, Loss::Misspoke, Some(status))).await;
    }

    /// The worker's token is good no more, and it is to be told so.
    pub(crate) async fn expelled(&self, status: Status) {
        self.tell(Event::Ended(self.worker, Loss::Expelled, Some(status))).await;
    }

    /// After the goodbye nobody listens, and nothing is to be done about it.
    async fn tell(&self, event: Event) {
        let _ = self.events.send(event).await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scheduler::{Evaluation, TaskText};
    use std::sync::Arc;
    use v1::coordinator_message::Kind;

    type Messages = mpsc::Receiver<Result<v1::CoordinatorMessage, Status>>;

    fn session(capacity: usize) -> (Session, Messages) {
        let (outbox, messages) = mpsc::channel(capacity);
        (Session::new(outbox, oneshot::channel().0, Millis(5000)), messages)
    }

    fn assignments(count: u64, size: usize) -> Vec<Assignment> {
        let task = Arc::new(TaskText::new("probe", 1, "{}"));
        let genotype = Bytes::from(vec![0; size]);
        let one = |id| Assignment {
            number: 1,
            evaluation: Evaluation {
                id,
                order: (1, 1, id as u32),
                task: task.clone(),
                genotype: genotype.clone(),
                seed: id,
                cull: None,
                audit: false,
                attempts_before: 0,
            },
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn a_stream_is_stuck_from_its_last_taken_message_on() {
        let (mut session, mut messages) = session(8);
        assert_eq!(session.stuck_since(Millis(5010)), None);
        session.tell(vec![], assignments(1, 4)).unwrap(); // a task and a batch
        assert_eq!(session.stuck_since(Millis(5020)), Some(Millis(5010)));
        messages.try_recv().unwrap().unwrap();
        assert_eq!(session.stuck_since(Millis(5030)), Some(Millis(5030)), "it has taken one");
        assert_eq!(session.stuck_since(Millis(5040)), Some(Millis(5030)));
        session.excuse(15, Millis(5050));
        assert_eq!(session.stuck_since(Millis(5050)), Some(Millis(5045)), "nobody saw to it for a while");
        session.excuse(15, Millis(5050));
        assert_eq!(session.stuck_since(Millis(5050)), Some(Millis(5050)));
        messages.try_recv().unwrap().unwrap();
        assert_eq!(session.stuck_since(Millis(5050)), None);
    }

    #[test]
    fn a_welcome_that_is_still_to_be_taken_waits_since_the_worker_came() {
        let (mut session, _messages) = session(8);
        session.send(Kind::Welcome(v1::Welcome::default())).unwrap();
        assert_eq!(session.stuck_since(Millis(5001)), Some(Millis(5000)), "not since the fleet began");
    }

    #[test]
    fn a_stream_that_is_full_or_gone_says_so() {
        let (mut session, messages) = session(1);
        assert_eq!(session.tell(vec![], assignments(1, 4)).unwrap_err().0, Loss::Stalled);
        drop(messages);
        assert_eq!(session.tell(vec![], assignments(1, 4)).unwrap_err().0, Loss::Broke);
    }

    #[test]
    fn large_genotypes_go_out_in_several_messages_in_order() {
        let (mut session, mut messages) = session(64);
        session.tell(vec![], assignments(7, BATCH_SIZE_MAX / 2)).unwrap();
        let mut batches = Vec::new();
        while let Ok(Ok(message)) = messages.try_recv() {
            if let Some(Kind::Batch(batch)) = message.kind {
                batches.push(batch.assignments.iter().map(|one| one.seed).collect::<Vec<_>>());
            }
        }
        assert_eq!(batches, [vec![0, 1], vec![2, 3], vec![4, 5], vec![6]]);
    }
}

//! The loop that owns the scheduler. Each round takes the events that have come, lets the scheduler hand out
//! once, and carries out its orders. It waits for nobody: neither for a worker nor for an owner.

use super::counts::Counts;
use super::session::{Session, Unsent};
use super::{Change, Clock, Delivery, Event, FleetSettings, Joined, PAROLE_MS, Summary};
use crate::scheduler::{Hello, Limits, Loss, Millis, NameTaken, Order, QueueId, Scheduler, WorkerId};
use bytes::Bytes;
use proto::v1::{self, coordinator_message::Kind};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{broadcast, mpsc, oneshot, watch};
use tokio::time::MissedTickBehavior;
use tonic::Status;

/// The longest time between rounds: stragglers are looked for that often.
const TICK: Duration = Duration::from_millis(20);
/// The most events of one round.
const EVENTS_A_ROUND: usize = 256;

pub(super) struct Rounds {
    settings: Arc<FleetSettings>,
    clock: Clock,
    scheduler: Scheduler,
    sessions: BTreeMap<WorkerId, (Session, String)>,
    owners: BTreeMap<QueueId, Owner>,
    inspected: Millis,
    summed: Millis,
    summary: watch::Sender<Summary>,
    changes: broadcast::Sender<Change>,
    counts: Counts,
}

struct Owner {
    label: String,
    deliver: mpsc::UnboundedSender<Delivery>,
}

impl Rounds {
    pub(super) fn new(
        settings: Arc<FleetSettings>,
        clock: Clock,
        summary: watch::Sender<Summary>,
        changes: broadcast::Sender<Change>,
        counts: Counts,
    ) -> Rounds {
        let limits = Limits {
            heartbeat_ms: settings.heartbeat_ms.into(),
            timeout_ms: settings.timeout_ms.into(),
            overdue_ms: 1000 * u64::from(settings.overdue_s),
            parole_ms: PAROLE_MS,
        };
        let now = clock.now();
        let mut scheduler = Scheduler::new(limits, now);
        settings.quarantined.iter().for_each(|name| scheduler.distrust(name));
        Rounds {
            scheduler,
            sessions: BTreeMap::new(),
            owners: BTreeMap::new(),
            inspected: now,
            summed: now,
            settings,
            clock,
            summary,
            changes,
            counts,
        }
    }

    /// Runs until the goodbye, or until nobody has a handle any more.
    pub(super) async fn run(mut self, mut inbox: mpsc::Receiver<Event>) {
        let mut events = Vec::with_capacity(EVENTS_A_ROUND);
        let mut tick = tokio::time::interval(TICK);
        tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                biased; // so that a simulation replays
                count = inbox.recv_many(&mut events, EVENTS_A_ROUND) => if count == 0 { return },
                _ = tick.tick() => {}
            }
            let now = self.clock.now();
            let mut goodbye = None;
            for event in events.drain(..) {
                if let Some(reply) = self.apply(event, now) {
                    goodbye = Some(reply);
                }
            }
            self.inspect(now);
            for order in self.scheduler.dispatch(now) {
                self.carry_out(order, now);
            }
            if let Some(reply) = goodbye {
                self.leave();
                // Whoever said goodbye may be gone.
                let _ = reply.send(());
                return;
            }
        }
    }

    /// Gives the one to be answered if this is the goodbye.
    fn apply(&mut self, event: Event, now: Millis) -> Option<oneshot::Sender<()>> {
        match event {
            Event::Attach { hello, fingerprint, session, reply } => {
                let attached = self.attach(hello, fingerprint, session, now);
                if let Err(Ok(worker)) = reply.send(attached) {
                    // The client has gone before it was answered.
                    self.close(worker, Loss::Broke, now);
                }
            }
            Event::Reports(worker, reports) => {
                self.scheduler.heard(worker, now);
                for report in reports {
                    self.scheduler.report(worker, report, now);
                }
            }
            Event::Heard(worker) => self.scheduler.heard(worker, now),
            Event::Window(worker, evaluations) => {
                self.scheduler.heard(worker, now);
                self.scheduler.window(worker, evaluations);
            }
            Event::Drain(worker, returned) => {
                self.scheduler.heard(worker, now);
                self.scheduler.drain(worker, &returned, now);
            }
            Event::Ended(worker, loss, status) => {
                if let (Some(status), Some((session, _))) = (status, self.sessions.get_mut(&worker)) {
                    session.refuse(status);
                }
                self.close(worker, loss, now);
            }
            Event::Open { label, weight, deliver, reply } => {
                let queue = self.scheduler.open(weight);
                // An owner that is gone already shows in its channel, at the next inspection.
                let _ = reply.send(queue);
                self.owners.insert(queue, Owner { label, deliver });
            }
            Event::Submit(queue, evaluations) => self.scheduler.submit(queue, evaluations),
            Event::Pause(queue, paused) => self.scheduler.pause(queue, paused),
            Event::Cancel(queue) => self.cancel(queue, now),
            Event::Workers(reply) => {
                // Whoever asked may be gone.
                let _ = reply.send(self.scheduler.workers());
            }
            Event::Goodbye(reply) => {
                self.scheduler.stop();
                return Some(reply);
            }
        }
        None
    }

    fn attach(
        &mut self,
        hello: Hello,
        fingerprint: [u8; 32],
        mut session: Session,
        now: Millis,
    ) -> Result<WorkerId, NameTaken> {
        let joined = Joined {
            name: hello.name.clone(),
            host: hello.host.clone(),
            slots: hello.slots,
            version: hello.version.clone(),
            fingerprint,
        };
        let worker = match self.scheduler.attach(hello.clone(), now) {
            Ok(worker) => worker,
            Err(taken) => {
                // Its stream may be gone without anybody having said so yet.
                let mut closed = self.sessions.iter().filter(|(_, (old, _))| old.is_closed());
                let dead = closed.find(|(_, (_, name))| *name == taken.0).map(|(&dead, _)| dead);
                self.close(dead.ok_or(taken)?, Loss::Broke, now);
                self.scheduler.attach(hello, now)?
            }
        };
        // A predecessor leaves before its successor joins.
        for order in self.scheduler.dismissals() {
            self.carry_out(order, now);
        }
        let welcome = v1::Welcome {
            worker: worker.0,
            lineage: Bytes::copy_from_slice(&self.settings.lineage),
            heartbeat_ms: self.settings.heartbeat_ms,
            timeout_ms: self.settings.timeout_ms,
        };
        // A stream that is gone by now is found out by the one who holds its other end.
        let _ = session.send(Kind::Welcome(welcome));
        self.sessions.insert(worker, (session, joined.name.clone()));
        // Nobody listening is no error.
        let _ = self.changes.send(Change::Joined(joined));
        Ok(worker)
    }

    /// Closes a worker's stream, and takes its leases back.
    fn close(&mut self, worker: WorkerId, loss: Loss, now: Millis) {
        let leases = self.scheduler.lose(worker, loss, now);
        self.take_leave(worker, loss, leases);
    }

    /// Closes the stream of a worker that holds no lease any more.
    fn take_leave(&mut self, worker: WorkerId, loss: Loss, leases: u64) {
        let Some((_, name)) = self.sessions.remove(&worker) else { return };
        self.counts.left(loss.word(), leases);
        // Nobody listening is no error.
        let _ = self.changes.send(Change::Left { name, reason: loss.word() });
    }

    fn cancel(&mut self, queue: QueueId, now: Millis) {
        self.scheduler.cancel(queue, now);
        self.owners.remove(&queue);
    }

    /// Looks for silent workers, stuck streams and owners that are gone, at a slower pace than the rounds.
    fn inspect(&mut self, now: Millis) {
        if now.since(self.summed) >= TICK.as_millis() as u64 {
            self.summed = now;
            let summary = self.scheduler.summary();
            self.summary.send_if_modified(|old| std::mem::replace(old, summary) != summary);
        }
        if now.since(self.inspected) < u64::from(self.settings.heartbeat_ms) / 4 {
            return;
        }
        self.inspected = now;
        let pause_ms = self.scheduler.advance(now);
        let timeout = u64::from(self.settings.timeout_ms);
        let is_stuck = |session: &mut Session| {
            session.excuse(pause_ms, now);
            session.stuck_since(now).is_some_and(|since| now.since(since) > timeout)
        };
        let stuck: Vec<WorkerId> = self
            .sessions
            .iter_mut()
            .filter_map(|(&worker, (session, _))| is_stuck(session).then_some(worker))
            .collect();
        for worker in stuck {
            self.close(worker, Loss::Stalled, now);
        }
        let abandoned = self.owners.iter().filter(|(_, owner)| owner.deliver.is_closed());
        for queue in abandoned.map(|(&queue, _)| queue).collect::<Vec<_>>() {
            self.cancel(queue, now);
        }
    }

    fn carry_out(&mut self, order: Order, now: Millis) {
        match order {
            Order::Dismiss { worker, loss, leases } => {
                if let Some((session, _)) = self.sessions.get_mut(&worker) {
                    session.refuse(match loss {
                        // It will not get rid of what hangs by attaching again.
                        Loss::Overdue => Status::failed_precondition(format!(
                            "an evaluation has run for more than {} s (the coordinator's --overdue-s) and counts as hung: \
                             start this worker again",
                            self.settings.overdue_s
                        )),
                        _ => Status::unavailable(format!("dismissed: {}", loss.word())),
                    });
                }
                self.take_leave(worker, loss, leases);
            }
            Order::Tell { worker, revoked, assigned } => {
                let Some((session, name)) = self.sessions.get_mut(&worker) else { return };
                self.counts.handed_out(assigned.len());
                for one in &assigned {
                    tracing::trace!(
                        evaluation = one.evaluation.id,
                        attempt = one.number,
                        worker = name,
                        "handed out"
                    );
                }
                if let Err(Unsent(loss)) = session.tell(revoked, assigned) {
                    self.close(worker, loss, now);
                }
            }
            Order::Quarantine(verdict) => {
                tracing::error!(
                    worker = verdict.worker,
                    evaluation = verdict.evaluation,
                    found = ?verdict.found,
                    against = ?verdict.against,
                    witnesses = ?verdict.witnesses,
                    "a worker found other bits than two others, and is quarantined"
                );
                self.counts.quarantined();
                // Nobody listening is no error.
                let _ = self.changes.send(Change::Quarantined(verdict));
            }
            Order::Deliver { queue, settled, conflicts, quarantined } => {
                let Some(owner) = self.owners.get(&queue) else { return };
                self.counts.contradicted(&conflicts);
                for one in &settled {
                    self.counts.settled(one);
                    tracing::trace!(queue = owner.label, evaluation = one.id, "settled");
                    if let Err(aside) = &one.result {
                        tracing::warn!(queue = owner.label, evaluation = one.id, "{aside}");
                    }
                }
                for conflict in &conflicts {
                    tracing::error!(
                        queue = owner.label,
                        evaluation = conflict.id,
                        first = ?conflict.first,
                        second = ?conflict.second,
                        "two workers computed different bits"
                    );
                }
                if owner.deliver.send(Delivery { settled, conflicts, quarantined }).is_err() {
                    self.cancel(queue, now);
                }
            }
        }
    }

    /// Says goodbye to every worker. The streams end with that.
    fn leave(&mut self) {
        for (session, _) in self.sessions.values_mut() {
            let reason = "the coordinator goes away".to_owned();
            // A stream that is gone needs no goodbye.
            let _ = session.send(Kind::Goodbye(v1::Goodbye { reason }));
        }
        self.sessions.clear();
        self.summary.send_replace(Summary::default());
    }
}

//! A rig for tests: a scheduler, workers that do as they are told, and operations on both. After every
//! operation it holds the scheduler's state against what must always be true.

use super::entry::Standing;
use super::queue::Rank;
use super::*;
use crate::lineage::Fate;
use creatures::{Cull, Interim, Outcome, Status};
use std::collections::BTreeMap;

pub(super) const HEARTBEAT: u64 = 100;
pub(super) const TIMEOUT: u64 = 500;
pub(super) const OVERDUE: u64 = 60_000;
pub(super) const PAROLE: u64 = 2_000;

/// One thing that happens. Workers are named by letters, evaluations by numbers in order of submission from
/// 0, queues by numbers in order of opening from 0.
#[derive(Debug, Clone)]
pub(super) enum Op {
    /// A worker of one slot that takes two evaluations attaches: another process than before under that name.
    Join(char),
    /// The same with so many slots and such a window.
    JoinWith(char, u32, u32),
    /// A lost worker comes back and still holds what it ran.
    Back(char),
    /// A lost worker comes back, the same process, and holds nothing any more.
    Return(char),
    /// Opens a queue of a weight.
    Open(u32),
    /// Submits so many evaluations to a queue.
    Submit(usize, u32),
    Pause(usize),
    Resume(usize),
    Cancel(usize),
    /// A worker reports the outcome of an evaluation that it holds.
    Report(char, u64),
    /// A worker says again what it reported last, and then that it found other bits.
    ReportTwice(char),
    ReportOtherwise(char),
    /// A worker reports the outcome of whatever it began first.
    ReportFirst(char),
    /// A worker reports other bits for whatever it began first, such as nobody else does.
    Lie(char),
    /// The first thing that a worker runs fails; with `true`, it would on every worker.
    Fail(char, bool),
    /// A worker's stream breaks.
    Lose(char),
    /// A worker hangs up.
    Leave(char),
    /// A worker says nothing from now on.
    Silence(char),
    Window(char, u32),
    /// A worker gives back what it has not begun.
    Drain(char),
    /// A worker that has received nothing yet says that it drains.
    DrainIdle(char),
    /// Time passes, with heartbeats.
    Advance(u64),
    /// Time passes at once: nobody was listening.
    Jump(u64),

    // What must be true at this point.
    Holds(char, &'static [u64]),
    Settled(&'static [u64]),
    SetAside(&'static [u64]),
    Conflicts(usize),
}

/// A worker as it sees itself.
#[derive(Debug, Default)]
struct Hand {
    id: Option<WorkerId>,
    incarnation: u64,
    slots: u32,
    window: u32,
    held: Vec<AttemptId>,
    last: Option<Report>,
    silent: bool,
}

pub(super) struct Rig {
    pub(super) scheduler: Scheduler,
    pub(super) now: Millis,
    pub(super) queues: Vec<QueueId>,
    hands: BTreeMap<char, Hand>,
    /// What is neither settled nor cancelled, with its queue.
    open: BTreeMap<u64, usize>,
    submitted: u64,
    pub(super) settled: BTreeMap<u64, Settled>,
    pub(super) conflicts: Vec<Conflict>,
    /// Every evaluation in the order in which it was handed out.
    pub(super) handed: Vec<u64>,
    /// The culling rule of what is submitted, and what workers measure.
    pub(super) cull: Option<Cull>,
    /// Whether what is submitted is audited.
    pub(super) audit: bool,
    /// Workers that were found out.
    pub(super) quarantined: Vec<Quarantine>,
    pub(super) events: u64,
}

pub(super) fn outcome(evaluation: u64) -> Outcome {
    Outcome {
        status: Status::Completed,
        fitness: evaluation as f64,
        steps: 100,
        measures: vec![],
        interim: Some(Interim { step: 50, measure: evaluation as f64 }),
        note: String::new(),
    }
}

impl Rig {
    /// A rig with one queue.
    pub(super) fn new() -> Rig {
        let now = Millis(1_000);
        let limits =
            Limits { heartbeat_ms: HEARTBEAT, timeout_ms: TIMEOUT, overdue_ms: OVERDUE, parole_ms: PAROLE };
        let mut scheduler = Scheduler::new(limits, now);
        let queues = vec![scheduler.open(1)];
        Rig {
            scheduler,
            now,
            queues,
            hands: BTreeMap::new(),
            open: BTreeMap::new(),
            submitted: 0,
            settled: BTreeMap::new(),
            conflicts: Vec::new(),
            handed: Vec::new(),
            cull: None,
            audit: false,
            quarantined: Vec::new(),
            events: 0,
        }
    }

    pub(super) fn run(mut self, ops: &[Op]) -> Rig {
        for op in ops {
            self.apply(op);
        }
        self
    }

    /// Applies an operation; one that makes no sense at this point does nothing.
    pub(super) fn apply(&mut self, op: &Op) {
        self.events += 1;
        match *op {
            Op::Join(name) => self.join(name, 1, 2),
            Op::JoinWith(name, slots, window) => self.join(name, slots, window),
            Op::Back(name) => self.attach(name),
            Op::Return(name) => {
                if let Some(hand) = self.hands.get_mut(&name).filter(|hand| hand.id.is_none()) {
                    hand.held.clear();
                    self.attach(name);
                }
            }
            Op::Open(weight) => self.queues.push(self.scheduler.open(weight)),
            Op::Submit(queue, count) => self.submit(queue, count),
            Op::Pause(queue) => self.scheduler.pause(self.queues[queue], true),
            Op::Resume(queue) => self.scheduler.pause(self.queues[queue], false),
            Op::Cancel(queue) => {
                self.scheduler.cancel(self.queues[queue], self.now);
                self.open.retain(|_, of| *of != queue);
            }
            Op::Report(name, evaluation) => {
                let held = self.hands.get(&name).map(|hand| hand.held.clone()).unwrap_or_default();
                if let Some(attempt) = held.into_iter().find(|held| held.evaluation == evaluation) {
                    self.report(name, attempt, News::Outcome(outcome(evaluation)));
                }
            }
            Op::ReportFirst(name) => {
                if let Some(first) = self.first(name) {
                    self.report(name, first, News::Outcome(outcome(first.evaluation)));
                }
            }
            Op::Lie(name) => {
                if let Some(first) = self.first(name) {
                    let mut lie = outcome(first.evaluation);
                    lie.fitness += 1000.0 * f64::from(u32::from(name));
                    self.report(name, first, News::Outcome(lie));
                }
            }
            Op::Fail(name, lasting) => {
                if let Some(first) = self.first(name) {
                    self.report(name, first, News::Failure { reason: "it broke".to_owned(), lasting });
                }
            }
            Op::ReportTwice(name) => self.repeat(name, |_| {}),
            Op::ReportOtherwise(name) => self.repeat(name, |outcome| outcome.fitness += 1.0),
            Op::Lose(name) => self.lose(name, Loss::Broke),
            Op::Leave(name) => self.lose(name, Loss::Left),
            Op::Silence(name) => {
                if let Some(hand) = self.hands.get_mut(&name) {
                    hand.silent = true;
                }
            }
            Op::Window(name, window) => {
                if let Some(hand) = self.hands.get_mut(&name)
                    && let Some(id) = hand.id
                {
                    hand.window = window;
                    self.scheduler.window(id, window);
                }
            }
            Op::Drain(name) => self.drain(name),
            Op::DrainIdle(name) => {
                if let Some(id) = self.hands.get(&name).and_then(|hand| hand.id) {
                    self.scheduler.drain(id, &[], self.now);
                }
            }
            Op::Advance(time) => {
                for _ in 0..time / HEARTBEAT {
                    self.now.0 += HEARTBEAT;
                    self.beat();
                    self.scheduler.advance(self.now);
                    self.round();
                }
                self.now.0 += time % HEARTBEAT;
                self.beat();
                self.scheduler.advance(self.now);
            }
            Op::Jump(time) => {
                self.now.0 += time;
                self.scheduler.advance(self.now);
            }
            Op::Holds(name, evaluations) => {
                assert_eq!(self.held(name), evaluations, "held by {name}");
            }
            Op::Settled(evaluations) => {
                assert_eq!(self.settled.keys().copied().collect::<Vec<_>>(), evaluations);
            }
            Op::SetAside(evaluations) => {
                let aside = self.settled.values().filter(|settled| settled.result.is_err());
                assert_eq!(aside.map(|settled| settled.id).collect::<Vec<_>>(), evaluations);
            }
            Op::Conflicts(count) => assert_eq!(self.conflicts.len(), count),
        }
        self.round();
    }

    pub(super) fn held(&self, name: char) -> Vec<u64> {
        let held = self.hands.get(&name).map(|hand| hand.held.as_slice()).unwrap_or_default();
        held.iter().map(|attempt| attempt.evaluation).collect()
    }

    pub(super) fn attached(&self) -> Vec<char> {
        self.hands.iter().filter(|(_, hand)| hand.id.is_some()).map(|(&name, _)| name).collect()
    }

    /// Lets a worker report on an attempt that it need not hold.
    pub(super) fn report(&mut self, name: char, attempt: AttemptId, news: News) {
        let report = Report { attempt, seconds: 0.01, news };
        let Some(hand) = self.hands.get_mut(&name) else { return };
        let Some(id) = hand.id else { return };
        if !matches!(report.news, News::Interim(_)) {
            hand.held.retain(|held| *held != attempt);
        }
        hand.last = Some(report.clone());
        self.scheduler.heard(id, self.now);
        self.scheduler.report(id, report, self.now);
    }

    fn submit(&mut self, queue: usize, count: u32) {
        let first = self.submitted;
        self.submitted += u64::from(count);
        let evaluations = (first..first + u64::from(count)).map(|id| Evaluation {
            id,
            order: (1, 1, id as u32),
            task: Arc::new(TaskText::new("probe", 1, "{}")),
            genotype: bytes::Bytes::new(),
            seed: id,
            cull: self.cull,
            audit: self.audit,
            attempts_before: 0,
        });
        let evaluations: Vec<_> = evaluations.collect();
        if self.scheduler.queues.contains_key(&self.queues[queue]) {
            self.open.extend(evaluations.iter().map(|evaluation| (evaluation.id, queue)));
        }
        self.scheduler.submit(self.queues[queue], evaluations);
    }

    /// Another process of that name, unless one is attached.
    fn join(&mut self, name: char, slots: u32, window: u32) {
        let incarnation = match self.hands.get(&name) {
            Some(Hand { id: Some(_), .. }) => return,
            Some(hand) => hand.incarnation + 1,
            None => 1,
        };
        self.hands.insert(name, Hand { incarnation, slots, window, ..Hand::default() });
        self.attach(name);
    }

    /// The process attaches, unless it is attached or there is none.
    fn attach(&mut self, name: char) {
        let Some(hand) = self.hands.get_mut(&name).filter(|hand| hand.id.is_none()) else { return };
        let hello = Hello {
            name: name.to_string(),
            host: "here".to_owned(),
            incarnation: hand.incarnation,
            version: "1".to_owned(),
            slots: hand.slots,
            window: hand.window,
            holding: hand.held.clone(),
            labels: BTreeMap::new(),
        };
        let id = self.scheduler.attach(hello, self.now).expect("the rig attaches nobody twice");
        (hand.id, hand.last, hand.silent) = (Some(id), None, false);
    }

    fn first(&self, name: char) -> Option<AttemptId> {
        self.hands.get(&name).filter(|hand| hand.id.is_some())?.held.first().copied()
    }

    fn repeat(&mut self, name: char, change: impl Fn(&mut Outcome)) {
        let last = self.hands.get(&name).and_then(|hand| hand.last.clone());
        if let Some(Report { attempt, news: News::Outcome(mut outcome), .. }) = last {
            change(&mut outcome);
            self.report(name, attempt, News::Outcome(outcome));
        }
    }

    fn lose(&mut self, name: char, loss: Loss) {
        if let Some(id) = self.hands.get(&name).and_then(|hand| hand.id) {
            self.scheduler.lose(id, loss, self.now);
            self.forget(name);
        }
    }

    /// A worker notices that its stream is gone: it drops what it has not begun.
    fn forget(&mut self, name: char) {
        let hand = self.hands.get_mut(&name).expect("it was found by this name");
        hand.id = None;
        hand.held.truncate(hand.slots as usize);
    }

    fn drain(&mut self, name: char) {
        let Some(hand) = self.hands.get_mut(&name) else { return };
        let Some(id) = hand.id else { return };
        let returned = hand.held.split_off(hand.held.len().min(hand.slots as usize));
        self.scheduler.drain(id, &returned, self.now);
    }

    fn beat(&mut self) {
        for hand in self.hands.values().filter(|hand| !hand.silent) {
            if let Some(id) = hand.id {
                self.scheduler.heard(id, self.now);
            }
        }
    }

    /// Carries out a round's orders.
    pub(super) fn round(&mut self) {
        for order in self.scheduler.dispatch(self.now) {
            match order {
                Order::Dismiss { worker, .. } => {
                    let of = self.hands.iter().find(|(_, hand)| hand.id == Some(worker));
                    self.forget(*of.expect("only attached workers are dismissed").0);
                }
                Order::Tell { worker, revoked, assigned } => {
                    let mut hands = self.hands.values_mut();
                    let hand = hands.find(|hand| hand.id == Some(worker)).expect("it is attached");
                    for attempt in revoked {
                        hand.held.retain(|held| *held != attempt);
                    }
                    let is_handed = !assigned.is_empty();
                    for Assignment { number, evaluation } in assigned {
                        self.handed.push(evaluation.id);
                        hand.held.push(AttemptId { evaluation: evaluation.id, number });
                    }
                    let limit = hand.window as usize;
                    assert!(!is_handed || hand.held.len() <= limit, "a worker gets more than its window");
                }
                Order::Quarantine(verdict) => self.quarantined.push(verdict),
                Order::Deliver { settled, conflicts, .. } => {
                    for one in settled {
                        let id = one.id;
                        assert!(self.open.remove(&id).is_some(), "{id} is settled twice, or in vain");
                        self.settled.insert(id, one);
                    }
                    self.conflicts.extend(conflicts);
                }
            }
        }
        self.check();
    }

    /// What must always be true.
    fn check(&self) {
        let state = &self.scheduler;
        assert!(self.open.keys().eq(state.evaluations.keys()), "an evaluation is lost, or open in vain");
        for (id, entry) in &state.evaluations {
            let out: Vec<_> = entry.outstanding().collect();
            assert!(out.len() <= hand_out::OUTSTANDING_MAX, "{id} runs {} times", out.len());
            assert!(out.len() < 2 || out[0].worker != out[1].worker, "{id} runs twice on one worker");
            let is_ready = state.queues[&entry.queue].ready.contains(&entry.rank());
            let is_awaiting = state.suspects.contains_key(id);
            let is_audited = state.awaiting.holds(entry);
            let is_condemned = state.condemned.contains_key(id);
            let places = [is_ready, is_awaiting, is_audited, is_condemned, !out.is_empty()];
            let count = places.into_iter().filter(|&stands| stands).count();
            assert_eq!(count, 1, "{id}: ready, suspect, awaiting an opinion, condemned, out: {places:?}");
            assert!(is_audited || out.iter().all(|tried| !entry.has_opined(&tried.name)));
            let honest = |opinion: &audit::Opinion| !state.quarantined.contains(&opinion.worker);
            assert!(entry.opinions.iter().all(honest), "the word of a liar counts");
            let belongs = match entry.standing() {
                Standing::UnderWay => !out.is_empty(),
                Standing::Ready => is_ready,
                Standing::Suspect => is_awaiting,
                Standing::Awaiting => is_audited,
                Standing::Condemned => is_condemned,
                Standing::Convicted => false,
            };
            assert!(belongs, "{id} is {:?} and stands elsewhere: {places:?}", entry.standing());
            assert!(entry.attempts.len() <= ATTEMPTS_KEPT);
        }
        for (id, worker) in &state.workers {
            let leases: Vec<_> = worker.leases().map(|lease| lease.attempt).collect();
            let hand = self.hands.values().find(|hand| hand.id == Some(*id)).expect("the rig attached it");
            assert_eq!(leases, hand.held, "worker {} holds something else than it was told", worker.name);
            for attempt in &leases {
                let entry = &state.evaluations[&attempt.evaluation];
                assert!(entry.outstanding().any(|t| t.number == attempt.number && t.worker == *id));
            }
            assert_eq!(worker.filed, worker.can_take_more().then(|| worker.load()));
            assert_eq!(worker.filed.is_some(), state.free.iter().any(|(_, free)| free == id));
            if let Some(suspect) = worker.reserved {
                let awaited = state.suspects.get(&suspect) == Some(&Some(*id));
                assert!(awaited || leases.iter().any(|lease| lease.evaluation == suspect));
            }
        }
        let out = state.evaluations.values().map(|entry| entry.outstanding().count()).sum::<usize>();
        assert_eq!(out as u64, state.summary().in_flight, "leases and attempts differ");
        for (id, queue) in &state.queues {
            assert_eq!(queue.filed, queue.is_runnable().then_some(queue.pass));
            assert_eq!(queue.filed.is_some(), state.runnable.iter().any(|(_, runnable)| runnable == id));
            let is_of_it = |rank: &Rank| state.evaluations[&rank.evaluation].queue == *id;
            assert!(queue.ready.iter().all(is_of_it));
        }
        assert!(state.runnable.is_empty() || state.free.is_empty(), "work waits beside a free worker");
        assert!(state.stopped || state.next_audit().is_none(), "an audit waits beside a free worker");
        assert!(state.suspects.values().flatten().all(|worker| state.workers[worker].reserved.is_some()));
    }

    /// Brings everything to its end: queues go on, sound workers come, everybody reports.
    pub(super) fn finish(mut self) -> Rig {
        for queue in 0..self.queues.len() {
            self.apply(&Op::Resume(queue));
        }
        for name in self.attached() {
            self.apply(&Op::Leave(name));
        }
        self.apply(&Op::JoinWith('Y', 2, 4));
        self.apply(&Op::JoinWith('Z', 1, 2));
        self.apply(&Op::Advance(PAROLE + HEARTBEAT));
        let limit = 4 * self.open.len() + 16;
        for _ in 0..limit {
            self.apply(&Op::ReportFirst('Y'));
            self.apply(&Op::ReportFirst('Z'));
        }
        let unsettled = self.scheduler.evaluations.keys().collect::<Vec<_>>();
        assert!(unsettled.is_empty(), "never settled: {unsettled:?}");
        for settled in self.settled.values() {
            let counted = settled.attempts.iter().filter(|attempt| attempt.fate == Fate::Counted).count();
            assert_eq!(counted, usize::from(settled.result.is_ok()));
        }
        let summary = self.scheduler.summary();
        assert_eq!((summary.in_flight, summary.ready), (0, 0));
        self
    }
}

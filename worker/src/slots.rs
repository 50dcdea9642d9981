//! Slots: plain threads that evaluate one after another from one queue, in its order, behind one lock. Where
//! time is simulated, tasks take their place.
//! They know no stream; whoever holds one feeds the queue and takes the reports.

use crate::config::Hands;
use crate::reports::{Attempt, Evaluation, Failure, News, Outbox, Report};
use crate::tasks::{chain, words};
use crate::window::Pace;
use creatures::{Interim, Observer};
use std::collections::{BTreeSet, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::{Duration, Instant};
use std::{io, thread};
use tokio::sync::Notify;

/// The slots of this worker. Dropped, they finish what they run and end.
pub(crate) struct Slots {
    count: usize,
    shared: Arc<Shared>,
}

struct Shared {
    state: Mutex<State>,
    /// Signalled when the queue has grown and a slot waits.
    work: Condvar,
    /// The same for slots in simulated time.
    simulated_work: Notify,
    /// Signalled when reports are worth sending, or when the last slot has become idle.
    stirred: Notify,
}

struct State {
    queue: VecDeque<Evaluation>,
    running: Vec<Option<Running>>, // (slots)
    outbox: Outbox,
    /// Whether somebody was woken for the reports that wait.
    is_announced: bool,
    pace: Pace,
    waiting_slots: usize,
    /// When a slot last had something to evaluate.
    busy: Instant,
    closed: bool,
}

#[derive(Clone, Copy)]
struct Running {
    attempt: Attempt,
    /// Whether anybody waits for its reports.
    wanted: bool,
}

impl Slots {
    /// Starts the threads, or the tasks in their place.
    ///
    /// # Errors
    /// When the system refuses a thread.
    pub(crate) fn start(count: usize, hands: Hands) -> io::Result<Self> {
        let state = State {
            queue: VecDeque::new(),
            running: vec![None; count],
            outbox: Outbox::default(),
            is_announced: false,
            pace: Pace::default(),
            waiting_slots: 0,
            busy: Instant::now(),
            closed: false,
        };
        let shared = Shared {
            state: Mutex::new(state),
            work: Condvar::new(),
            simulated_work: Notify::new(),
            stirred: Notify::new(),
        };
        let slots = Slots { count, shared: Arc::new(shared) };
        for slot in 0..count {
            let shared = Arc::clone(&slots.shared);
            match hands {
                Hands::Threads => {
                    thread::Builder::new().name(format!("slot-{slot}")).spawn(move || shared.run(slot))?;
                }
                Hands::Simulated(takes) => drop(tokio::spawn(shared.simulate(slot, takes))),
            }
        }
        Ok(slots)
    }

    /// Queues evaluations behind those that are there.
    pub(crate) fn offer(&self, evaluations: Vec<Evaluation>) {
        let count = evaluations.len();
        let mut state = self.shared.lock();
        state.queue.extend(evaluations);
        let waiting = state.waiting_slots;
        drop(state);
        if waiting <= count {
            self.shared.work.notify_all();
        } else {
            (0..count).for_each(|_| self.shared.work.notify_one());
        }
        self.shared.simulated_work.notify_waiters();
    }

    /// Adds a report of an evaluation that never got to a slot.
    pub(crate) fn report(&self, report: Report) {
        self.shared.lock().outbox.push(report);
        self.shared.stirred.notify_one();
    }

    /// Returns when a report may be waiting, or all slots may have become idle.
    pub(crate) async fn stirred(&self) {
        self.shared.stirred.notified().await;
    }

    /// The next reports to send, whether others wait, and the window that the pace asks for.
    pub(crate) fn take_reports(&self) -> (Vec<Report>, bool, u32) {
        let mut state = self.shared.lock();
        state.is_announced = false;
        let reports = state.outbox.take();
        (reports, state.outbox.waiting() > 0, state.pace.window(self.count))
    }

    /// The window that the pace asks for.
    pub(crate) fn window(&self) -> u32 {
        self.shared.lock().pace.window(self.count)
    }

    /// The first `count` reports of this stream that ended an attempt have arrived.
    pub(crate) fn confirm(&self, count: u64) {
        self.shared.lock().outbox.confirm(count);
    }

    /// The stream is gone: drops what has not begun and makes ready to send again what may not have arrived.
    pub(crate) fn recall(&self) {
        let mut state = self.shared.lock();
        state.queue.clear();
        state.outbox.recall();
    }

    /// Attempts whose reports are held here, and then those that run, each once.
    pub(crate) fn holding(&self) -> Vec<Attempt> {
        let state = self.shared.lock();
        let running = state.running.iter().flatten().filter(|running| running.wanted);
        state.outbox.ended().chain(running.map(|running| running.attempt)).collect()
    }

    /// Nobody needs these any more: they are dropped if not begun, and go unreported.
    pub(crate) fn revoke(&self, attempts: &BTreeSet<Attempt>) {
        let mut state = self.shared.lock();
        state.queue.retain(|evaluation| !attempts.contains(&evaluation.attempt));
        for running in state.running.iter_mut().flatten() {
            running.wanted &= !attempts.contains(&running.attempt);
        }
        attempts.iter().for_each(|attempt| state.outbox.drop_attempt(*attempt));
    }

    /// Takes back what has not begun.
    pub(crate) fn withdraw(&self) -> Vec<Attempt> {
        self.shared.lock().queue.drain(..).map(|evaluation| evaluation.attempt).collect()
    }

    /// Takes back everything that has not ended. What runs goes on, and nobody hears of it.
    pub(crate) fn abandon(&self) -> Vec<Attempt> {
        let mut state = self.shared.lock();
        let waiting: Vec<Attempt> = state.queue.drain(..).map(|evaluation| evaluation.attempt).collect();
        let running = state.running.iter_mut().flatten().filter(|running| running.wanted);
        let running = running.map(|running| {
            running.wanted = false;
            running.attempt
        });
        running.chain(waiting).collect()
    }

    /// How long all slots have had nothing to evaluate.
    pub(crate) fn idle_for(&self) -> Duration {
        let state = self.shared.lock();
        let is_busy = !state.queue.is_empty() || state.running.iter().any(Option::is_some);
        if is_busy { Duration::ZERO } else { state.busy.elapsed() }
    }

    /// Throws away all reports, those of running evaluations included.
    pub(crate) fn forget(&self) {
        let mut state = self.shared.lock();
        state.queue.clear();
        state.outbox.clear();
        state.running.iter_mut().flatten().for_each(|running| running.wanted = false);
    }

    /// Whether nothing is queued, nothing wanted runs and no report waits.
    pub(crate) fn are_idle(&self) -> bool {
        self.shared.lock().is_idle()
    }
}

impl Drop for Slots {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.closed = true;
        state.queue.clear();
        drop(state);
        self.shared.work.notify_all();
        self.shared.simulated_work.notify_waiters();
    }
}

impl State {
    /// The next evaluation, which this slot then runs.
    fn begin(&mut self, slot: usize) -> Option<Evaluation> {
        let evaluation = self.queue.pop_front()?;
        self.running[slot] = Some(Running { attempt: evaluation.attempt, wanted: true });
        Some(evaluation)
    }

    /// Takes a slot's last report. True if it is time to wake somebody.
    fn hand_in(&mut self, slot: usize, report: Report) -> bool {
        self.pace.observe(report.seconds);
        self.busy = Instant::now();
        if self.running[slot].take().is_some_and(|running| running.wanted) {
            self.outbox.push(report);
        }
        let is_time = self.queue.is_empty() || self.outbox.waiting() >= self.pace.batch();
        is_time && !std::mem::replace(&mut self.is_announced, true)
    }

    fn is_idle(&self) -> bool {
        let wanted = self.running.iter().flatten().any(|running| running.wanted);
        self.queue.is_empty() && self.outbox.waiting() == 0 && !wanted
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics while it holds this lock")
    }

    /// A slot's whole life.
    fn run(&self, slot: usize) {
        let mut ended = None;
        while let Some(evaluation) = self.next(slot, ended) {
            let start = Instant::now();
            let news = live(&evaluation, &mut |interim: Interim| {
                let seconds = start.elapsed().as_secs_f64();
                self.tell(
                    slot,
                    Report { attempt: evaluation.attempt, seconds, news: News::Interim(interim) },
                );
            });
            let seconds = start.elapsed().as_secs_f64();
            ended = Some(Report { attempt: evaluation.attempt, seconds, news });
        }
    }

    /// A slot's whole life in simulated time.
    async fn simulate(self: Arc<Self>, slot: usize, takes: fn(&[u8], u64) -> Duration) {
        loop {
            let more = self.simulated_work.notified(); // from here on, so that no call is missed
            let next = {
                let mut state = self.lock();
                if state.closed {
                    return;
                }
                state.begin(slot)
            };
            let Some(evaluation) = next else {
                more.await;
                continue;
            };
            let took = takes(&evaluation.genotype, evaluation.seed);
            tokio::time::sleep(took).await;
            let (attempt, seconds) = (evaluation.attempt, took.as_secs_f64());
            let news = live(&evaluation, &mut |interim: Interim| {
                self.tell(slot, Report { attempt, seconds, news: News::Interim(interim) });
            });
            if self.lock().hand_in(slot, Report { attempt, seconds, news }) {
                self.stirred.notify_one();
            }
        }
    }

    fn tell(&self, slot: usize, report: Report) {
        let mut state = self.lock();
        let wanted = state.running[slot].is_some_and(|running| running.wanted);
        if wanted {
            state.outbox.push(report);
            state.is_announced = true;
            drop(state);
            self.stirred.notify_one();
        }
    }

    /// Hands in a slot's last report and waits for its next evaluation, with one locking for both where
    /// there is work. `None`: the worker ends.
    fn next(&self, slot: usize, ended: Option<Report>) -> Option<Evaluation> {
        let mut state = self.lock();
        if let Some(report) = ended
            && state.hand_in(slot, report)
        {
            self.stirred.notify_one();
        }
        loop {
            if state.closed {
                return None;
            }
            if let Some(evaluation) = state.begin(slot) {
                return Some(evaluation);
            }
            state.waiting_slots += 1;
            state = self.work.wait(state).expect("nothing panics while it holds this lock");
            state.waiting_slots -= 1;
        }
    }
}

/// Lives one genotype. Whatever goes wrong is told, never passed on: a panic costs its evaluation alone.
fn live(evaluation: &Evaluation, observer: &mut dyn Observer) -> News {
    let Evaluation { task, genotype, seed, cull, .. } = evaluation;
    let failure = |reason, last| News::Failure(Failure { reason, last });
    match catch_unwind(AssertUnwindSafe(|| task.evaluate(genotype, *seed, cull.as_ref(), observer))) {
        Ok(Ok(outcome)) => match proto::convert::admissible(&outcome) {
            Ok(()) => News::Outcome(outcome),
            Err(error) => failure(format!("outcome: {error}"), true),
        },
        Ok(Err(error)) => failure(chain(&error), true),
        Err(panic) => failure(format!("evaluation panicked: {}", words(&*panic)), false),
    }
}

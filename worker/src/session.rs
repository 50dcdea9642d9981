//! One attachment after another: hello, evaluations in, reports out, until drained or refused. Each is one
//! loop on the runtime; it never evaluates and never waits for a slot.

use crate::backoff::Backoff;
use crate::config::Config;
use crate::reports::{Attempt, Evaluation, Failure, News, Report};
use crate::slots::Slots;
use crate::tasks::{Tasks, chain};
use crate::window::{Account, is_news};
use bytes::Bytes;
use creatures::Cull;
use proto::dial::{DialError, Line};
use proto::v1::coordinator_message::Kind as Incoming;
use proto::v1::fleet_client::FleetClient;
use proto::v1::worker_message::Kind as Outgoing;
use proto::{MESSAGE_SIZE_MAX, PROTOCOL, TaskHash, WORKER_MESSAGE_SIZE_MAX, refusal, v1};
use std::collections::VecDeque;
use std::future::pending;
use std::io;
use std::pin::{Pin, pin};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{Instant, MissedTickBehavior, interval, sleep, sleep_until, timeout};
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Status, Streaming};

/// To connect, and from the hello to the welcome.
const ATTACH_TIMEOUT: Duration = Duration::from_secs(10);
/// For the coordinator to read the last reports of a worker that leaves.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(5);
/// Messages on their way to the socket.
const OUTGOING_MAX: usize = 16;

/// Why a worker ended before it was asked to.
#[derive(Debug, thiserror::Error)]
pub enum WorkerError {
    /// The coordinator refuses this worker and would do so again.
    #[error("coordinator {coordinator} refuses this worker ({}): {worker}", .status.message())]
    Refused {
        /// Its address.
        coordinator: String,
        /// What this worker said of itself.
        worker: String,
        /// Its answer.
        status: Box<Status>,
    },
    /// Whoever answers is not the coordinator that is meant, or speaks otherwise.
    #[error("{0}")]
    Misdialled(String),
    /// A slot's thread could not be started.
    #[error("cannot start the thread of a slot")]
    Thread(#[source] io::Error),
}

/// Attaches to the coordinator, and again whenever the stream breaks, and evaluates, until `shutdown`
/// completes, or its time or its patience with idleness is over: then takes nothing new, gives back what has not
/// begun, finishes and reports what runs, within the grace, and returns. Without a connection at that moment it
/// returns at once; what it held can be evaluated again.
///
/// # Errors
/// When the coordinator refuses this worker for good, or never was the one that is meant.
pub async fn run(config: Config, shutdown: impl Future<Output = ()>) -> Result<(), WorkerError> {
    let slots = Slots::start(config.slots, config.hands).map_err(WorkerError::Thread)?;
    let time_limit = config.time_limit.map(|time| Instant::now() + time);
    let mut shutdown = pin!(async {
        tokio::select! {
            biased; // so that a simulation replays
            () = shutdown => {}
            () = until(time_limit) => tracing::info!("the time limit is over"),
            () = idle(&slots, config.idle_timeout) => tracing::info!("nothing to evaluate for the idle timeout"),
        }
    });
    let mut backoff = Backoff::new(&config.name);
    let mut lineage = Bytes::new();
    let mut told = String::new(); // a coordinator that stays away is worth one line
    loop {
        let line = tokio::select! {
            biased;
            () = &mut shutdown => return Ok(()),
            line = dial(&config) => line,
        };
        // Once it has said hello it may hold leases, and takes leave of them.
        let attached = async { attach(line?, &config, &slots, &mut lineage).await };
        let end = match attached.await {
            Ok(session) => {
                backoff.reset();
                told.clear();
                session.work(&slots, shutdown.as_mut(), config.grace).await
            }
            Err(end) => end,
        };
        let end = match end {
            // Once it was the right one, and whoever is there now may go away again.
            End::Misdialled(reason) if !lineage.is_empty() => End::Lost(reason),
            end => end,
        };
        match end {
            End::Drained => return Ok(()),
            End::Refused(status) => return Err(refused(&config, status)),
            End::Misdialled(reason) => return Err(WorkerError::Misdialled(reason)),
            End::Lost(reason) => {
                slots.recall();
                let (coordinator, wait) = (config.coordinator.uri(), backoff.wait());
                if reason == told {
                    tracing::debug!(%coordinator, ?wait, "{reason}");
                } else {
                    tracing::warn!(%coordinator, ?wait, "{reason}");
                }
                told = reason;
                tokio::select! {
                    biased;
                    () = &mut shutdown => return Ok(()),
                    () = sleep(wait) => {}
                }
            }
        }
    }
}

fn refused(config: &Config, status: Box<Status>) -> WorkerError {
    let fingerprint: String = config.fingerprint.iter().map(|byte| format!("{byte:02x}")).collect();
    let Config { name, version, .. } = config;
    WorkerError::Refused {
        coordinator: config.coordinator.uri().to_string(),
        worker: format!("worker `{name}`, version {version}, protocol {PROTOCOL}, fingerprint {fingerprint}"),
        status,
    }
}

/// How an attachment ended.
enum End {
    /// As asked: everything is reported, or nobody is there to report to.
    Drained,
    /// The coordinator would say the same again.
    Refused(Box<Status>),
    /// It was not the coordinator that is meant, or one that speaks otherwise.
    Misdialled(String),
    /// Anything that another attachment may mend.
    Lost(String),
}

impl From<Status> for End {
    fn from(status: Status) -> Self {
        if refusal::is_lasting(&status) {
            return End::Refused(Box::new(status));
        }
        End::Lost(format!("attachment lost: {:?}: {}", status.code(), status.message()))
    }
}

impl From<DialError> for End {
    fn from(error: DialError) -> Self {
        match error {
            DialError::Stranger { .. } | DialError::Plain { .. } | DialError::Tls { .. } => {
                End::Misdialled(error.to_string())
            }
            DialError::Silent { .. } => End::Lost(chain(&error)),
        }
    }
}

/// Waits for a time, which may never come.
async fn until(time: Option<Instant>) {
    match time {
        Some(time) => sleep_until(time).await,
        None => pending().await,
    }
}

/// Waits until there was nothing to evaluate for so long.
async fn idle(slots: &Slots, timeout: Option<Duration>) {
    let Some(timeout) = timeout else { return pending().await };
    while let Some(rest) = timeout.checked_sub(slots.idle_for()).filter(|rest| !rest.is_zero()) {
        sleep(rest).await;
    }
}

async fn dial(config: &Config) -> Result<Line, End> {
    let address = config.coordinator.clone().with(|endpoint| {
        endpoint
            .connect_timeout(ATTACH_TIMEOUT)
            .http2_keep_alive_interval(Duration::from_secs(5))
            .keep_alive_timeout(Duration::from_secs(10))
            .keep_alive_while_idle(true)
    });
    let line = async {
        match config.dial {
            Some(dial) => address.connect_through(dial).await,
            None => address.connect().await,
        }
    };
    let lost = |_| End::Lost(format!("no connection within {ATTACH_TIMEOUT:?}"));
    Ok(timeout(ATTACH_TIMEOUT, line).await.map_err(lost)??)
}

/// Says hello and waits for the welcome. What is held for another lineage than the welcome's is thrown away.
async fn attach(line: Line, config: &Config, slots: &Slots, lineage: &mut Bytes) -> Result<Session, End> {
    let hello = async {
        let mut client = FleetClient::new(line)
            .max_decoding_message_size(MESSAGE_SIZE_MAX)
            .max_encoding_message_size(WORKER_MESSAGE_SIZE_MAX);
        let window = slots.window();
        let hello = v1::Hello {
            protocol: PROTOCOL,
            name: config.name.clone(),
            host: config.host.clone(),
            slots: config.slots as u32,
            version: config.version.clone(),
            fingerprint: Bytes::copy_from_slice(&config.fingerprint),
            window,
            lineage: lineage.clone(),
            holding: slots.holding().into_iter().map(Into::into).collect(),
            labels: config.labels.clone().into_iter().collect(),
            incarnation: config.incarnation,
        };
        let (sender, receiver) = mpsc::channel(OUTGOING_MAX);
        sender.try_send(message(Outgoing::Hello(hello))).expect("a new channel has room for a message");
        let mut incoming = client.attach(ReceiverStream::new(receiver)).await?.into_inner();
        match incoming.message().await?.and_then(|message| message.kind) {
            Some(Incoming::Welcome(welcome)) => Ok((welcome, window, sender, incoming)),
            Some(Incoming::Goodbye(goodbye)) => Err(going_away(&goodbye)),
            _ => Err(End::Lost("the coordinator did not say welcome".to_owned())),
        }
    };
    let (welcome, window, sender, incoming) = timeout(ATTACH_TIMEOUT, hello)
        .await
        .unwrap_or_else(|_| Err(End::Lost(format!("no welcome within {ATTACH_TIMEOUT:?}"))))?;
    if welcome.lineage != *lineage {
        slots.forget();
        *lineage = Bytes::copy_from_slice(&welcome.lineage);
    }
    tracing::info!(coordinator = %config.coordinator.uri(), worker = welcome.worker, "attached");
    Ok(Session {
        sender,
        incoming,
        outgoing: VecDeque::new(),
        // Half the interval: the promise is one within each.
        heartbeat: Duration::from_millis(u64::from(welcome.heartbeat_ms / 2).max(1)),
        window,
        account: Account { window_max: window, ..Account::default() },
        tasks: Tasks::new(config.systems),
        draining: false,
    })
}

fn message(kind: Outgoing) -> v1::WorkerMessage {
    v1::WorkerMessage { kind: Some(kind) }
}

fn going_away(goodbye: &v1::Goodbye) -> End {
    End::Lost(format!("the coordinator goes away: {}", goodbye.reason))
}

/// What a session has to react to.
enum Event {
    Incoming(Result<Option<v1::CoordinatorMessage>, Status>),
    /// There is room to send a message, or there will be none any more.
    Room(bool),
    Stirred,
    Beat,
    Shutdown,
    /// What runs may run no longer.
    GraceOver,
}

/// One attachment.
struct Session {
    sender: mpsc::Sender<v1::WorkerMessage>,
    incoming: Streaming<v1::CoordinatorMessage>,
    /// What goes out before any report.
    outgoing: VecDeque<Outgoing>,
    heartbeat: Duration,
    window: u32, // as announced
    account: Account,
    tasks: Tasks,
    draining: bool,
}

impl Session {
    /// Works until the stream ends, or until drained.
    async fn work(
        mut self,
        slots: &Slots,
        mut shutdown: Pin<&mut impl Future<Output = ()>>,
        grace: Duration,
    ) -> End {
        let mut grace_over = None;
        let mut beat = interval(self.heartbeat);
        beat.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut stirred = true; // reports may have been held from before
        loop {
            if self.draining && self.outgoing.is_empty() && slots.are_idle() {
                return self.close().await;
            }
            // Once the sending half has closed, the reason is about to come in.
            let sends = (stirred || !self.outgoing.is_empty()) && !self.sender.is_closed();
            // In a fixed order, so that a simulation replays. What comes in has an end: the window.
            let event = tokio::select! {
                biased;
                () = &mut shutdown, if !self.draining => Event::Shutdown,
                () = until(grace_over) => Event::GraceOver,
                _ = beat.tick() => Event::Beat,
                room = self.sender.reserve(), if sends => Event::Room(room.is_ok()),
                message = self.incoming.message() => Event::Incoming(message),
                () = slots.stirred(), if !stirred => Event::Stirred,
            };
            match event {
                Event::Incoming(message) => match self.take(message, slots) {
                    Ok(()) => {}
                    Err(End::Lost(reason)) if self.draining => {
                        tracing::warn!("{reason}; what was not reported will be evaluated elsewhere");
                        return End::Drained;
                    }
                    Err(end) => return end,
                },
                Event::Room(false) => {}
                Event::Room(true) => match self.outgoing.pop_front() {
                    Some(kind) => self.send(kind),
                    None => stirred = self.report(slots),
                },
                Event::Stirred => stirred = true,
                Event::Beat => {
                    stirred = true; // no report waits for company longer than this
                    if self.outgoing.is_empty() {
                        self.outgoing.push_back(Outgoing::Heartbeat(v1::Heartbeat {}));
                    }
                }
                Event::Shutdown => {
                    tracing::info!("draining");
                    self.draining = true;
                    grace_over = Some(Instant::now() + grace);
                    self.give_back(slots.withdraw());
                }
                Event::GraceOver => {
                    tracing::info!("the grace is over: giving back what still runs");
                    grace_over = None;
                    self.give_back(slots.abandon());
                }
            }
        }
    }

    /// Sends a message for which there is room. If the stream has ended meanwhile, its end is about to come
    /// in, and whatever may not have arrived is sent again on the next one.
    fn send(&self, kind: Outgoing) {
        let _ = self.sender.try_send(message(kind));
    }

    /// Sends the reports that wait. True if there are more.
    fn report(&mut self, slots: &Slots) -> bool {
        let (reports, more, window) = slots.take_reports();
        if !reports.is_empty() {
            let reports = reports.into_iter().map(Into::into).collect();
            self.send(Outgoing::Reports(v1::Reports { reports }));
        }
        self.adapt(window);
        more
    }

    /// Announces a window that differs enough from the last one.
    fn adapt(&mut self, window: u32) {
        if !self.draining && is_news(self.window, window) {
            self.window = window;
            self.account.window_max = self.account.window_max.max(window);
            self.outgoing.push_back(Outgoing::Window(v1::Window { evaluations: window }));
        }
    }

    /// Returns attempts that will not be reported.
    fn give_back(&mut self, attempts: Vec<Attempt>) {
        let returned: Vec<_> = attempts.into_iter().map(Into::into).collect();
        self.account.released += returned.len() as u64;
        self.outgoing.push_back(Outgoing::Drain(v1::Drain { returned }));
    }

    /// Takes in what came off the stream.
    fn take(
        &mut self,
        message: Result<Option<v1::CoordinatorMessage>, Status>,
        slots: &Slots,
    ) -> Result<(), End> {
        let Some(message) = message? else {
            return Err(End::Lost("the coordinator closed the stream".to_owned()));
        };
        match message.kind {
            Some(Incoming::Task(task)) => {
                let hash = task.verified().map_err(|error| End::Lost(format!("task: {error}")))?;
                self.tasks.learn(hash, task).map_err(End::Lost)
            }
            Some(Incoming::Batch(batch)) => self.queue(batch, slots),
            Some(Incoming::Revoke(revoke)) => {
                self.account.released += revoke.attempts.len() as u64;
                slots.revoke(&revoke.attempts.into_iter().map(Into::into).collect());
                Ok(())
            }
            Some(Incoming::Goodbye(goodbye)) => Err(going_away(&goodbye)),
            Some(Incoming::Welcome(_)) => Err(End::Lost("the coordinator said welcome twice".to_owned())),
            None => Err(End::Lost("the coordinator sent a message of an unknown kind".to_owned())),
        }
    }

    /// Queues a batch. What cannot be evaluated is reported as failed.
    fn queue(&mut self, batch: v1::Batch, slots: &Slots) -> Result<(), End> {
        self.account.assigned += batch.assignments.len() as u64;
        slots.confirm(self.account.confirmed());
        let mut evaluations = Vec::with_capacity(batch.assignments.len());
        for assignment in batch.assignments {
            let attempt = assignment.attempt.map(Attempt::from);
            let attempt = attempt.ok_or_else(|| End::Lost("an assignment names no attempt".to_owned()))?;
            match evaluation(attempt, assignment, &mut self.tasks) {
                Ok(evaluation) => evaluations.push(evaluation),
                Err(failure) => {
                    slots.report(Report { attempt, seconds: 0.0, news: News::Failure(failure) });
                }
            }
        }
        if self.draining {
            // It had been sent before the drain was read. Nothing of it begins.
            self.give_back(evaluations.into_iter().map(|evaluation| evaluation.attempt).collect());
        } else {
            slots.offer(evaluations);
        }
        Ok(())
    }

    /// Hangs up, and waits until the coordinator has read all and does the same.
    async fn close(self) -> End {
        let Session { sender, mut incoming, .. } = self;
        drop(sender);
        let end = timeout(CLOSE_TIMEOUT, async { while let Ok(Some(_)) = incoming.message().await {} });
        if end.await.is_err() {
            tracing::warn!("the coordinator did not take leave within {CLOSE_TIMEOUT:?}");
        }
        End::Drained
    }
}

/// Reads an assignment.
fn evaluation(
    attempt: Attempt,
    assignment: v1::Assignment,
    tasks: &mut Tasks,
) -> Result<Evaluation, Failure> {
    let malformed = |error| Failure { reason: format!("assignment: {error}"), last: true };
    let task = tasks.find(TaskHash::try_from(&assignment.task).map_err(malformed)?)?;
    let cull = assignment.cull.map(Cull::try_from).transpose();
    let cull = cull.map_err(|error| malformed(error.within("cull")))?;
    Ok(Evaluation { attempt, task, genotype: assignment.genotype, seed: assignment.seed, cull })
}

#[cfg(test)]
mod tests;

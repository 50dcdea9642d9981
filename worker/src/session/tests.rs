//! The worker against a coordinator that does exactly what each test says, over real sockets.

use super::*;
use creatures::{DecodeError, Nobody, Observer, Outcome, Proof, SpecError, System, Task};
use proto::v1::fleet_server::{Fleet, FleetServer};
use proto::v1::report::What;
use std::thread;
use std::time::Instant;
use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio_stream::wrappers::TcpListenerStream;
use tonic::{Request, Response};

/// A system whose creatures do what their genotype says.
struct Actor;

impl System for Actor {
    fn name(&self) -> &'static str {
        "actor"
    }

    fn version(&self) -> u32 {
        1
    }

    fn resolve(&self, task: serde_json::Value) -> Result<serde_json::Value, SpecError> {
        Ok(task)
    }

    fn task(&self, _resolved: &str) -> Result<Box<dyn Task>, SpecError> {
        Ok(Box::new(Actor))
    }

    fn proofs(&self) -> Vec<Proof> {
        vec![]
    }
}

impl Task for Actor {
    fn check(&self, _genotype: &[u8]) -> Result<(), DecodeError> {
        Ok(())
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        _seed: u64,
        _cull: Option<&Cull>,
        _observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        let mut fitness = 1.0;
        match genotype {
            b"panic" => panic!("broken invariant {}", 7),
            b"illegal" => return Err(DecodeError::illegal("genes[3]", "must be within 0..=9")),
            b"nan" => fitness = f64::NAN,
            b"sleep" => thread::sleep(Duration::from_millis(300)),
            _ => {}
        }
        let status = creatures::Status::Completed;
        Ok(Outcome { status, fitness, steps: 1, measures: vec![], interim: None, note: String::new() })
    }
}

fn systems(name: &str) -> Option<&'static dyn System> {
    if name == "actor" { Some(&Actor) } else { creatures::system(name) }
}

/// Passes each attached stream on to the test.
struct Door(mpsc::Sender<Link>);

#[tonic::async_trait]
impl Fleet for Door {
    type AttachStream = ReceiverStream<Result<v1::CoordinatorMessage, Status>>;

    async fn attach(
        &self,
        request: Request<Streaming<v1::WorkerMessage>>,
    ) -> Result<Response<Self::AttachStream>, Status> {
        let (sender, receiver) = mpsc::channel(64);
        let link = Link { from_worker: request.into_inner(), to_worker: sender };
        self.0.send(link).await.map_err(|_| Status::unavailable("the test is over"))?;
        Ok(Response::new(ReceiverStream::new(receiver)))
    }

    async fn workers(&self, _: Request<v1::WorkersRequest>) -> Result<Response<v1::WorkersReply>, Status> {
        Err(Status::unimplemented("not needed here"))
    }
}

/// A coordinator in the hands of a test, and one worker that attaches to it.
struct Stage {
    links: mpsc::Receiver<Link>,
    worker: JoinHandle<Result<(), WorkerError>>,
    drain: Option<oneshot::Sender<()>>,
}

impl Stage {
    async fn set(slots: usize) -> Stage {
        Stage::set_with(slots, |config| config).await
    }

    async fn set_with(slots: usize, change: impl FnOnce(Config) -> Config) -> Stage {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let (sender, links) = mpsc::channel(8);
        let server = tonic::transport::Server::builder().add_service(FleetServer::new(Door(sender)));
        tokio::spawn(server.serve_with_incoming(TcpListenerStream::new(listener)));
        let config = change(Config { systems, ..Config::new(&url).unwrap().with_slots(slots).unwrap() });
        let (drain, drained) = oneshot::channel();
        let worker = tokio::spawn(run(config, async move { drop(drained.await) }));
        Stage { links, worker, drain: Some(drain) }
    }

    /// The next stream, its hello and a welcome to a lineage.
    async fn welcome(&mut self, lineage: &'static [u8]) -> (Link, v1::Hello) {
        let mut link = self.link().await;
        let hello = link.hello().await;
        let lineage = Bytes::from_static(lineage);
        link.say(Incoming::Welcome(v1::Welcome { worker: 1, lineage, heartbeat_ms: 50, timeout_ms: 1000 }))
            .await;
        (link, hello)
    }

    async fn link(&mut self) -> Link {
        soon(self.links.recv()).await.unwrap()
    }

    fn drain(&mut self) {
        self.drain.take().unwrap().send(()).unwrap();
    }

    async fn end(self) -> Result<(), WorkerError> {
        soon(self.worker).await.unwrap()
    }
}

async fn soon<T>(future: impl Future<Output = T>) -> T {
    timeout(Duration::from_secs(20), future).await.expect("within 20 s")
}

/// The coordinator's end of one stream.
struct Link {
    from_worker: Streaming<v1::WorkerMessage>,
    to_worker: mpsc::Sender<Result<v1::CoordinatorMessage, Status>>,
}

impl Link {
    async fn say(&self, kind: Incoming) {
        soon(self.to_worker.send(Ok(v1::CoordinatorMessage { kind: Some(kind) }))).await.unwrap();
    }

    /// What the worker says next. `None` when it has hung up.
    async fn hear(&mut self) -> Option<Outgoing> {
        soon(self.from_worker.message()).await.unwrap().map(|message| message.kind.unwrap())
    }

    async fn hello(&mut self) -> v1::Hello {
        match self.hear().await {
            Some(Outgoing::Hello(hello)) => hello,
            other => panic!("{other:?} is no hello"),
        }
    }

    /// The next message with reports.
    async fn batch(&mut self) -> Vec<v1::Report> {
        loop {
            match self.hear().await {
                Some(Outgoing::Reports(reports)) => return reports.reports,
                Some(Outgoing::Heartbeat(_) | Outgoing::Window(_)) => {}
                other => panic!("{other:?} where reports were expected"),
            }
        }
    }

    /// The next so many reports, by evaluation.
    async fn reports(&mut self, count: usize) -> Vec<(u64, What)> {
        let mut reports = Vec::new();
        while reports.len() < count {
            reports.extend(self.batch().await);
        }
        reports.into_iter().map(|report| (report.attempt.unwrap().evaluation, report.what.unwrap())).collect()
    }

    async fn drain(&mut self) -> Vec<u64> {
        loop {
            match self.hear().await {
                Some(Outgoing::Drain(drain)) => return drain.returned.iter().map(|a| a.evaluation).collect(),
                Some(Outgoing::Heartbeat(_)) => {}
                other => panic!("{other:?} where a drain was expected"),
            }
        }
    }

    async fn assign(&self, assignments: Vec<v1::Assignment>) {
        self.say(Incoming::Batch(v1::Batch { assignments })).await;
    }
}

fn actor() -> v1::Task {
    v1::Task::named("actor", 1, "{}")
}

fn attempt(evaluation: u64) -> v1::Attempt {
    v1::Attempt { evaluation, number: 1 }
}

fn assignment(evaluation: u64, task: &v1::Task, genotype: &'static str) -> v1::Assignment {
    let attempt = Some(attempt(evaluation));
    let genotype = Bytes::from_static(genotype.as_bytes());
    v1::Assignment { attempt, task: task.hash.clone(), genotype, seed: 7, cull: None }
}

fn failure(what: &What) -> (&str, bool) {
    match what {
        What::Failure(v1::Failure { reason, r#final }) => (reason, *r#final),
        other => panic!("{other:?} is no failure"),
    }
}

fn outcome(what: What) -> Outcome {
    match what {
        What::Outcome(outcome) => outcome.try_into().unwrap(),
        other => panic!("{other:?} is no outcome"),
    }
}

#[tokio::test]
async fn an_outcome_is_what_the_function_gives() {
    let mut stage = Stage::set(2).await;
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!((hello.protocol, hello.slots, hello.window), (PROTOCOL, 2, 3));
    assert_eq!(hello.fingerprint[..], creatures::fingerprint());
    assert!(hello.holding.is_empty() && hello.lineage.is_empty());
    let task = v1::Task::named("probe", 1, r#"{"work":50}"#);
    link.say(Incoming::Task(task.clone())).await;
    link.assign((0..20).map(|evaluation| assignment(evaluation, &task, "dna")).collect()).await;
    let probe = creatures::system("probe").unwrap().task(&task.spec).unwrap();
    let expected = probe.evaluate(b"dna", 7, None, &mut Nobody).unwrap();
    let mut reports = link.reports(20).await;
    reports.sort_by_key(|(evaluation, _)| *evaluation);
    for (index, (evaluation, what)) in reports.into_iter().enumerate() {
        assert_eq!(evaluation, index as u64);
        assert_eq!(outcome(what).digest(), expected.digest());
    }
}

#[tokio::test]
async fn an_interim_report_goes_ahead_and_the_cutoff_stops_the_creature() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = v1::Task::named("probe", 1, r#"{"work":100}"#);
    link.say(Incoming::Task(task.clone())).await;
    let cull = Some(v1::Cull { at: 0.25, cutoff: Some(2.0), control: false });
    link.assign(vec![v1::Assignment { cull, ..assignment(1, &task, "dna") }]).await;
    let [(_, What::Interim(interim)), (_, what)] = &link.reports(2).await[..] else {
        panic!("interim first")
    };
    let outcome = outcome(what.clone());
    assert_eq!((outcome.status, outcome.steps), (creatures::Status::Culled, 25));
    assert_eq!(outcome.interim, Some((*interim).try_into().unwrap()));
}

#[tokio::test]
async fn what_has_no_outcome_is_told_with_its_reason_and_the_worker_goes_on() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    let stranger = v1::Task::named("actor", 1, r#"{"never":"sent"}"#);
    let unknown = v1::Task::named("unicorn", 1, "{}");
    link.say(Incoming::Task(task.clone())).await;
    link.say(Incoming::Task(unknown.clone())).await;
    let cull = Some(v1::Cull { at: 1.5, ..Default::default() });
    let batch = vec![
        assignment(1, &task, "panic"),
        assignment(2, &task, "illegal"),
        assignment(3, &task, "nan"),
        assignment(4, &stranger, ""),
        assignment(5, &unknown, ""),
        v1::Assignment { cull, ..assignment(6, &task, "") },
        assignment(7, &task, "well"),
    ];
    link.assign(batch).await;
    let mut reports = link.reports(7).await;
    reports.sort_by_key(|(evaluation, _)| *evaluation);
    let (_, last) = reports.pop().unwrap();
    assert_eq!(outcome(last).fitness, 1.0);
    let failures: Vec<_> = reports.iter().map(|(_, what)| failure(what)).collect();
    let never_sent = format!("task {} was not sent before its evaluation", stranger.verified().unwrap());
    assert_eq!(
        failures,
        [
            ("evaluation panicked: broken invariant 7", false),
            ("genotype field `genes[3]`: must be within 0..=9", true),
            ("outcome: `fitness` is NaN, must be finite in a completed outcome", true),
            (&*never_sent, false),
            ("this worker knows no system `unicorn`", false),
            ("assignment: `cull.at` is 1.5, must be within (0, 1)", true),
        ]
    );
}

#[tokio::test]
async fn a_report_finished_without_a_coordinator_is_delivered_to_the_next() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep"), assignment(2, &task, "never begun")]).await;
    sleep(Duration::from_millis(100)).await;
    drop(link);
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!((&hello.lineage[..], hello.holding), (&b"here"[..], vec![attempt(1)]));
    let [(1, what)] = &link.reports(1).await[..] else { panic!("the first evaluation alone") };
    assert_eq!(outcome(what.clone()).fitness, 1.0);
}

#[tokio::test]
async fn reports_that_may_not_have_arrived_are_sent_again_and_others_are_not() {
    let mut stage = Stage::set(1).await;
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!(hello.window, 2);
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign((1..=2).map(|evaluation| assignment(evaluation, &task, "sleep")).collect()).await;
    link.reports(2).await;
    // Within a window of two this proves that the first report was read, and says nothing of the second.
    link.assign(vec![assignment(3, &task, "sleep")]).await;
    link.reports(1).await;
    drop(link);
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!(hello.holding, [attempt(2), attempt(3)]);
    let again: Vec<u64> = link.reports(2).await.into_iter().map(|(evaluation, _)| evaluation).collect();
    assert_eq!(again, [2, 3]);
}

#[tokio::test]
async fn another_lineage_gets_no_report_of_the_former() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep")]).await;
    sleep(Duration::from_millis(100)).await;
    drop(link);
    let (mut link, _) = stage.welcome(b"elsewhere").await;
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(2, &task, "well")]).await;
    let reports = link.reports(1).await;
    assert_eq!(reports.iter().map(|(evaluation, _)| *evaluation).collect::<Vec<_>>(), [2]);
}

#[tokio::test]
async fn draining_gives_back_what_has_not_begun_and_delivers_what_runs() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign((1..=3).map(|evaluation| assignment(evaluation, &task, "sleep")).collect()).await;
    sleep(Duration::from_millis(100)).await;
    stage.drain();
    assert_eq!(link.drain().await, [2, 3]);
    // Sent before the drain was read: it comes back as well.
    link.assign(vec![assignment(4, &task, "sleep")]).await;
    assert_eq!(link.drain().await, [4]);
    let [(1, what)] = &link.reports(1).await[..] else { panic!("the running one alone") };
    assert_eq!(outcome(what.clone()).fitness, 1.0);
    while let Some(message) = link.hear().await {
        assert!(matches!(message, Outgoing::Heartbeat(_)), "{message:?} after the last report");
    }
    drop(link);
    stage.end().await.unwrap();
}

#[tokio::test]
async fn draining_an_idle_worker_ends_it_at_once_and_so_does_a_lost_coordinator() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    drop(link);
    stage.drain();
    stage.end().await.unwrap();
}

#[tokio::test]
async fn a_refused_worker_stops_and_shows_both_sides() {
    let mut stage = Stage::set(1).await;
    let mut link = stage.link().await;
    let hello = link.hello().await;
    let theirs = proto::Refusal::Version { worker: hello.version, coordinator: "9.9.9".to_owned() };
    link.to_worker.send(Err(theirs.into())).await.unwrap();
    let text = stage.end().await.unwrap_err().to_string();
    assert!(text.contains("coordinator 9.9.9"), "{text}");
    assert!(
        text.contains(&format!("version {}, protocol 1, fingerprint", env!("CARGO_PKG_VERSION"))),
        "{text}"
    );
}

#[tokio::test]
async fn a_taken_name_is_tried_again() {
    let mut stage = Stage::set(1).await;
    let link = stage.link().await;
    link.to_worker.send(Err(Status::already_exists("still attached"))).await.unwrap();
    stage.welcome(b"here").await;
}

#[tokio::test]
async fn a_coordinator_that_says_goodbye_is_attached_to_again() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    link.say(Incoming::Goodbye(v1::Goodbye { reason: "upgrade".to_owned() })).await;
    stage.welcome(b"here").await;
}

#[tokio::test]
async fn what_is_revoked_is_not_begun_and_not_reported() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign((1..=3).map(|evaluation| assignment(evaluation, &task, "sleep")).collect()).await;
    sleep(Duration::from_millis(100)).await;
    link.say(Incoming::Revoke(v1::Revoke { attempts: vec![attempt(1), attempt(2)] })).await;
    let start = Instant::now();
    let reports = link.reports(1).await;
    assert_eq!(reports.iter().map(|(evaluation, _)| *evaluation).collect::<Vec<_>>(), [3]);
    assert!(start.elapsed() < Duration::from_millis(750), "the second was dropped, not lived");
}

#[tokio::test]
async fn heartbeats_go_on_while_every_slot_is_busy() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep")]).await;
    let mut beats = 0;
    while let Some(Outgoing::Heartbeat(_)) = link.hear().await {
        beats += 1;
    }
    assert!(beats >= 4, "{beats} heartbeats in 300 ms, with one promised within each 50");
}

#[tokio::test]
async fn short_evaluations_widen_the_window_and_share_messages() {
    let mut stage = Stage::set(2).await;
    let (mut link, hello) = stage.welcome(b"here").await;
    let task = v1::Task::named("probe", 1, "{}");
    link.say(Incoming::Task(task.clone())).await;
    link.assign((0..5000).map(|evaluation| assignment(evaluation, &task, "dna")).collect()).await;
    let (mut reports, mut messages, mut widest) = (0, 0, hello.window);
    while reports < 5000 || widest == hello.window {
        match link.hear().await {
            Some(Outgoing::Reports(batch)) => {
                reports += batch.reports.len();
                messages += 1;
            }
            Some(Outgoing::Window(window)) => widest = widest.max(window.evaluations),
            other => assert!(matches!(other, Some(Outgoing::Heartbeat(_))), "{other:?}"),
        }
    }
    assert!(widest > 64, "a window of {widest} for evaluations of some microseconds");
    assert!(messages < 2500, "{messages} messages for 5000 reports");
}

#[tokio::test]
async fn what_still_runs_when_the_grace_is_over_is_given_back() {
    let grace = Duration::from_millis(50);
    let mut stage = Stage::set_with(1, |config| Config { grace, ..config }).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep"), assignment(2, &task, "never begun")]).await;
    sleep(Duration::from_millis(100)).await;
    stage.drain();
    assert_eq!(link.drain().await, [2], "at once");
    assert_eq!(link.drain().await, [1], "after the grace, before its 300 ms are over");
    assert!(link.hear().await.is_none(), "and it hangs up");
    drop(link);
    stage.end().await.unwrap();
}

#[tokio::test]
async fn a_worker_leaves_when_its_time_is_over() {
    let time_limit = Some(Duration::from_millis(200));
    let mut stage = Stage::set_with(1, |config| Config { time_limit, ..config }).await;
    let (mut link, _) = stage.welcome(b"here").await;
    assert!(link.drain().await.is_empty());
    assert!(link.hear().await.is_none());
    drop(link);
    stage.end().await.unwrap();
}

#[tokio::test]
async fn a_worker_leaves_when_it_was_idle_for_too_long_and_not_while_it_is_busy() {
    let idle_timeout = Some(Duration::from_millis(200));
    let mut stage = Stage::set_with(1, |config| Config { idle_timeout, ..config }).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    // Busy for longer than the timeout, and all of it is reported.
    link.assign(vec![assignment(1, &task, "sleep"), assignment(2, &task, "sleep")]).await;
    assert_eq!(link.reports(2).await.len(), 2);
    assert!(link.drain().await.is_empty());
    assert!(link.hear().await.is_none());
    drop(link);
    stage.end().await.unwrap();
}

#[tokio::test]
async fn a_hello_says_what_the_starter_says_of_the_worker() {
    let label = ("rack".to_owned(), "2".to_owned());
    let mut stage =
        Stage::set_with(1, |config| config.with_labels(std::slice::from_ref(&label)).unwrap()).await;
    let (_link, hello) = stage.welcome(b"here").await;
    assert_eq!(hello.labels.into_iter().collect::<Vec<_>>(), [label]);
}

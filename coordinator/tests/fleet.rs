//! The fleet over real streams on loopback: workers that are in the hands of each test, word by word.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use bytes::Bytes;
use coordinator::fleet::{Evaluation, Fate, Fleet, FleetSettings, Queue, QueueOutput, Settled, TaskText};
use coordinator::service;
use creatures::{Nobody, Outcome, Status as Ending};
use proto::v1::coordinator_message::Kind as Told;
use proto::v1::evaluate_reply::What as Answer;
use proto::v1::evaluate_request::What as Ask;
use proto::v1::evaluation_client::EvaluationClient;
use proto::v1::fleet_client::FleetClient;
use proto::v1::report::What;
use proto::v1::worker_message::Kind as Said;
use proto::{PROTOCOL, v1};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::mpsc;
use tokio::time::timeout;
use tokio_stream::wrappers::ReceiverStream;
use tonic::transport::server::TcpIncoming;
use tonic::transport::{Channel, Server};
use tonic::{Code, Status, Streaming};

const LINEAGE: [u8; 16] = [7; 16];
const FINGERPRINT: [u8; 32] = [9; 32];
const PATIENCE: Duration = Duration::from_secs(20);

struct Service {
    fleet: Fleet,
    channel: Channel,
}

async fn serve(heartbeat_ms: u32, timeout_ms: u32) -> Service {
    let fleet = Fleet::start(FleetSettings {
        heartbeat_ms,
        timeout_ms,
        version: "1.2.3".to_owned(),
        fingerprint: FINGERPRINT,
        lineage: LINEAGE,
        quarantined: vec![],
    });
    let listener = TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await.unwrap();
    let address = listener.local_addr().unwrap();
    let router = Server::builder()
        .add_service(service::fleet(fleet.clone()))
        .add_service(service::evaluation(fleet.clone()));
    tokio::spawn(router.serve_with_incoming(TcpIncoming::from(listener)));
    let channel = Channel::from_shared(format!("http://{address}")).unwrap().connect().await.unwrap();
    Service { fleet, channel }
}

/// Heartbeats play no part.
async fn serve_patiently() -> Service {
    serve(60_000, 600_000).await
}

fn hello(name: &str, slots: u32, window: u32) -> v1::Hello {
    v1::Hello {
        protocol: PROTOCOL,
        name: name.to_owned(),
        host: "here".to_owned(),
        slots,
        version: "1.2.3".to_owned(),
        fingerprint: Bytes::copy_from_slice(&FINGERPRINT),
        window,
        lineage: Bytes::new(),
        holding: vec![],
        labels: Default::default(),
    }
}

/// A worker's end of a stream.
struct Raw {
    sender: mpsc::Sender<v1::WorkerMessage>,
    incoming: Streaming<v1::CoordinatorMessage>,
    welcome: v1::Welcome,
}

impl Service {
    async fn attach(&self, hello: v1::Hello) -> Result<Raw, Status> {
        self.begin(Said::Hello(hello)).await
    }

    async fn begin(&self, first: Said) -> Result<Raw, Status> {
        let (sender, receiver) = mpsc::channel(16);
        sender.send(v1::WorkerMessage { kind: Some(first) }).await.unwrap();
        let mut client = FleetClient::new(self.channel.clone());
        let mut incoming = client.attach(ReceiverStream::new(receiver)).await?.into_inner();
        match incoming.message().await?.and_then(|message| message.kind) {
            Some(Told::Welcome(welcome)) => Ok(Raw { sender, incoming, welcome }),
            other => panic!("no welcome but {other:?}"),
        }
    }

    async fn join(&self, name: &str, slots: u32, window: u32) -> Raw {
        self.attach(hello(name, slots, window)).await.unwrap()
    }

    async fn queue(&self) -> (Queue, QueueOutput) {
        self.fleet.queue("test".to_owned(), 1).await
    }
}

impl Raw {
    async fn say(&self, kind: Said) {
        self.sender.send(v1::WorkerMessage { kind: Some(kind) }).await.unwrap();
    }

    async fn hear(&mut self) -> Result<Option<Told>, Status> {
        let message = timeout(PATIENCE, self.incoming.message()).await.expect("it answers in time")?;
        Ok(message.map(|message| message.kind.expect("messages have a kind")))
    }

    /// The next batch, past any task.
    async fn batch(&mut self) -> Vec<v1::Assignment> {
        loop {
            match self.hear().await.unwrap() {
                Some(Told::Batch(batch)) => return batch.assignments,
                Some(Told::Task(_)) => {}
                other => panic!("no batch but {other:?}"),
            }
        }
    }

    async fn report(&self, attempt: v1::Attempt, what: What) {
        let report = v1::Report { attempt: Some(attempt), seconds: 0.01, what: Some(what) };
        self.say(Said::Reports(v1::Reports { reports: vec![report] })).await;
    }

    async fn complete(&self, assignment: &v1::Assignment) {
        let attempt = assignment.attempt.unwrap();
        self.report(attempt, What::Outcome(outcome(attempt.evaluation as f64).into())).await;
    }
}

fn outcome(fitness: f64) -> Outcome {
    Outcome {
        status: Ending::Completed,
        fitness,
        steps: 10,
        measures: vec![("echo".to_owned(), fitness)],
        interim: None,
        note: String::new(),
    }
}

fn evaluations(ids: std::ops::Range<u64>) -> Vec<Evaluation> {
    let task = Arc::new(TaskText::new("probe", 1, r#"{"work":0}"#));
    let one = |id| Evaluation {
        id,
        order: (1, 1, id as u32),
        task: task.clone(),
        genotype: Bytes::from(vec![id as u8; 4]),
        seed: id,
        cull: None,
        audit: false,
        attempts_before: 0,
    };
    ids.map(one).collect()
}

async fn take(output: &mut QueueOutput, count: usize) -> Vec<Settled> {
    let mut settled = Vec::new();
    while settled.len() < count {
        settled.extend(timeout(PATIENCE, output.next()).await.expect("it settles in time").unwrap());
    }
    settled
}

fn fates(settled: &Settled) -> Vec<(u32, &str, Fate)> {
    settled.attempts.iter().map(|a| (a.number, a.worker.as_str(), a.fate.clone())).collect()
}

#[tokio::test]
async fn a_worker_is_told_its_task_once_and_asks_for_more_by_reporting() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 2).await;
    assert_eq!(
        (&a.welcome.lineage[..], a.welcome.heartbeat_ms, a.welcome.timeout_ms),
        (&LINEAGE[..], 60_000, 600_000)
    );
    queue.submit(evaluations(1..4)).await;
    let Some(Told::Task(task)) = a.hear().await.unwrap() else { panic!("a task comes first") };
    assert_eq!(task.verified().unwrap(), TaskText::new("probe", 1, r#"{"work":0}"#).hash);
    let Some(Told::Batch(batch)) = a.hear().await.unwrap() else { panic!("a batch comes next") };
    assert_eq!(batch.assignments.len(), 2);
    let first = &batch.assignments[0];
    assert_eq!(first.attempt, Some(v1::Attempt { evaluation: 1, number: 1 }));
    assert_eq!((&first.genotype[..], first.seed, &first.task), (&[1; 4][..], 1, &task.hash));
    a.complete(first).await;
    let Some(Told::Batch(more)) = a.hear().await.unwrap() else { panic!("the task is known") };
    assert_eq!(more.assignments[0].attempt, Some(v1::Attempt { evaluation: 3, number: 1 }));
    a.complete(&more.assignments[0]).await;
    a.complete(&batch.assignments[1]).await;
    let settled = take(&mut output, 3).await;
    assert_eq!(settled.iter().map(|one| one.id).collect::<Vec<_>>(), [1, 3, 2]);
    assert_eq!(settled[0].result, Ok(outcome(1.0)));
    assert_eq!(fates(&settled[0]), [(1, "a", Fate::Counted)]);
    assert_eq!((settled[0].attempts[0].steps, settled[0].attempts[0].seconds), (10, 0.01));
}

#[tokio::test]
async fn a_broken_stream_hands_its_leases_on_at_once() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    a.batch().await;
    let mut b = service.join("b", 1, 1).await;
    drop(a);
    let handed_on = b.batch().await;
    assert_eq!(handed_on[0].attempt, Some(v1::Attempt { evaluation: 1, number: 2 }));
    b.complete(&handed_on[0]).await;
    assert_eq!(take(&mut output, 1).await[0].attempts.len(), 2);
}

#[tokio::test]
async fn a_worker_that_comes_back_holding_a_lease_reports_on_it_as_if_nothing_had_happened() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 2).await;
    queue.submit(evaluations(1..3)).await;
    let batch = a.batch().await;
    drop(a);
    let held = v1::Attempt { evaluation: 1, number: 1 };
    let back = v1::Hello {
        lineage: Bytes::copy_from_slice(&LINEAGE),
        holding: vec![held, v1::Attempt { evaluation: 99, number: 1 }],
        ..hello("a", 1, 2)
    };
    // The old stream may take a moment to be found gone.
    let mut a = loop {
        match service.attach(back.clone()).await {
            Ok(a) => break a,
            Err(status) => assert_eq!(status.code(), Code::AlreadyExists),
        }
    };
    let Some(Told::Revoke(revoked)) = a.hear().await.unwrap() else {
        panic!("what is not wanted is revoked")
    };
    assert_eq!(revoked.attempts, [v1::Attempt { evaluation: 99, number: 1 }]);
    let again = a.batch().await;
    assert_eq!(again[0].attempt, Some(v1::Attempt { evaluation: 2, number: 2 }), "what had not begun");
    a.complete(&batch[0]).await;
    a.complete(&again[0]).await;
    let settled = take(&mut output, 2).await;
    assert_eq!(fates(&settled[0]), [(1, "a", Fate::Counted)]);
}

#[tokio::test]
async fn what_is_held_for_another_lineage_is_evaluated_again() {
    let service = serve_patiently().await;
    let (queue, _output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    a.batch().await;
    a.sender.send(v1::WorkerMessage { kind: Some(Said::Drain(v1::Drain::default())) }).await.unwrap();
    drop(a.sender);
    while a.incoming.message().await.unwrap().is_some() {}
    let stranger = v1::Hello {
        lineage: Bytes::from(vec![8; 16]),
        holding: vec![v1::Attempt { evaluation: 1, number: 1 }],
        ..hello("a", 1, 1)
    };
    let mut a = service.attach(stranger).await.unwrap();
    assert_eq!(a.batch().await[0].attempt, Some(v1::Attempt { evaluation: 1, number: 2 }));
}

#[tokio::test]
async fn a_worker_that_differs_is_refused_with_both_values_and_the_side_to_upgrade() {
    let service = serve_patiently().await;
    let refused = async |hello: v1::Hello| service.attach(hello).await.map(drop).unwrap_err();
    let status = refused(v1::Hello { protocol: PROTOCOL + 1, ..hello("a", 1, 1) }).await;
    assert_eq!(status.code(), Code::FailedPrecondition);
    assert!(status.message().contains("upgrade the coordinator"), "{status}");
    let status = refused(v1::Hello { version: "1.2.2".to_owned(), ..hello("a", 1, 1) }).await;
    assert_eq!(status.code(), Code::FailedPrecondition);
    assert!(status.message().contains("1.2.2") && status.message().contains("1.2.3"), "{status}");
    let status = refused(v1::Hello { fingerprint: Bytes::from(vec![1; 32]), ..hello("a", 1, 1) }).await;
    assert_eq!(status.code(), Code::FailedPrecondition);
    assert!(status.message().contains("0101") && status.message().contains("0909"), "{status}");
}

#[tokio::test]
async fn a_hello_out_of_bounds_is_refused_by_the_name_of_its_field() {
    let service = serve_patiently().await;
    for (hello, field) in [
        (hello("", 1, 1), "`name`"),
        (hello(&"x".repeat(129), 1, 1), "`name`"),
        (hello("a\nb", 1, 1), "`name`"),
        (hello("a", 0, 1), "`slots`"),
        (hello("a", 4097, 1), "`slots`"),
        (hello("a", 1, 0), "`window`"),
        (hello("a", 1, 65_537), "`window`"),
        (v1::Hello { fingerprint: Bytes::new(), ..hello("a", 1, 1) }, "`fingerprint`"),
    ] {
        let status = service.attach(hello).await.map(drop).unwrap_err();
        assert_eq!(status.code(), Code::InvalidArgument);
        assert!(status.message().contains(field), "{status}");
    }
    let status = service.begin(Said::Heartbeat(v1::Heartbeat {})).await.map(drop).unwrap_err();
    assert_eq!((status.code(), status.message()), (Code::InvalidArgument, "hello: it must come first"));
}

#[tokio::test]
async fn a_name_is_taken_until_its_worker_is_gone() {
    let service = serve_patiently().await;
    let a = service.join("a", 1, 1).await;
    let status = service.attach(hello("a", 1, 1)).await.map(drop).unwrap_err();
    assert_eq!(status.code(), Code::AlreadyExists);
    drop(a);
    let freed = async {
        while service.attach(hello("a", 1, 1)).await.is_err() {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    };
    timeout(PATIENCE, freed).await.unwrap();
}

#[tokio::test]
async fn a_silent_worker_is_dismissed_and_one_that_beats_is_not() {
    let service = serve(50, 200).await;
    let (queue, mut output) = service.queue().await;
    let mut silent = service.join("silent", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    silent.batch().await;
    let mut alive = service.join("alive", 1, 1).await;
    let sender = alive.sender.clone();
    let beats = tokio::spawn(async move {
        loop {
            let beat = v1::WorkerMessage { kind: Some(Said::Heartbeat(v1::Heartbeat {})) };
            sender.send(beat).await.unwrap();
            tokio::time::sleep(Duration::from_millis(25)).await;
        }
    });
    let status = silent.hear().await.unwrap_err();
    assert_eq!((status.code(), status.message()), (Code::Unavailable, "dismissed: silent"));
    let handed_on = alive.batch().await;
    alive.complete(&handed_on[0]).await;
    let settled = take(&mut output, 1).await;
    assert_eq!(fates(&settled[0])[0], (1, "silent", Fate::Lost("silent".to_owned())));
    beats.abort();
}

#[tokio::test]
async fn a_straggler_is_tried_elsewhere_and_the_loser_is_told() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..5)).await;
    for _ in 0..3 {
        let batch = a.batch().await;
        a.complete(&batch[0]).await;
    }
    a.batch().await;
    let mut b = service.join("b", 1, 1).await;
    let second = b.batch().await;
    assert_eq!(second[0].attempt, Some(v1::Attempt { evaluation: 4, number: 2 }));
    b.complete(&second[0]).await;
    let Some(Told::Revoke(revoked)) = a.hear().await.unwrap() else { panic!("the loser is revoked") };
    assert_eq!(revoked.attempts, [v1::Attempt { evaluation: 4, number: 1 }]);
    let settled = take(&mut output, 4).await;
    assert_eq!(fates(&settled[3]), [(1, "a", Fate::Duplicate), (2, "b", Fate::Counted)]);
    // Its outcome was underway: equal bits change nothing, others raise an alarm.
    let late = v1::Attempt { evaluation: 4, number: 1 };
    a.report(late, What::Outcome(outcome(4.0).into())).await;
    a.report(late, What::Outcome(outcome(5.0).into())).await;
    assert_eq!(timeout(PATIENCE, output.next()).await.unwrap(), Some(vec![]));
    let conflicts = output.take_conflicts();
    assert_eq!(conflicts.len(), 1);
    assert_eq!(
        (conflicts[0].first.clone(), conflicts[0].second.clone()),
        ((outcome(4.0), "b".to_owned()), (outcome(5.0), "a".to_owned()))
    );
}

#[tokio::test]
async fn an_outcome_that_means_nothing_ends_its_attempt_and_nothing_else() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    let first = a.batch().await;
    let wrong = v1::Outcome { fitness: Some(f64::NAN), ..outcome(1.0).into() };
    a.report(first[0].attempt.unwrap(), What::Outcome(wrong)).await;
    let second = a.batch().await;
    assert_eq!(second[0].attempt, Some(v1::Attempt { evaluation: 1, number: 2 }));
    a.complete(&second[0]).await;
    let settled = take(&mut output, 1).await;
    let Fate::Failed(reason) = &settled[0].attempts[0].fate else { panic!("it failed") };
    assert!(reason.contains("`fitness` is NaN"), "{reason}");
}

#[tokio::test]
async fn a_worker_that_breaks_the_protocol_is_told_and_let_go() {
    let service = serve_patiently().await;
    for (wrong, word) in [
        (Said::Hello(hello("a", 1, 1)), "a second hello"),
        (Said::Window(v1::Window { evaluations: 0 }), "`window.evaluations` is 0"),
        (Said::Reports(v1::Reports { reports: vec![v1::Report::default()] }), "`reports.attempt` is missing"),
    ] {
        let name = format!("worker {word}");
        let mut a = service.join(&name, 1, 1).await;
        a.say(wrong).await;
        let status = a.hear().await.unwrap_err();
        assert_eq!(status.code(), Code::InvalidArgument);
        assert!(status.message().contains(word), "{status}");
    }
}

#[tokio::test]
async fn a_draining_worker_gives_back_what_it_has_not_begun_and_hangs_up_in_peace() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 2).await;
    queue.submit(evaluations(1..3)).await;
    let batch = a.batch().await;
    let mut b = service.join("b", 1, 1).await;
    let returned = vec![batch[1].attempt.unwrap()];
    a.say(Said::Drain(v1::Drain { returned })).await;
    let handed_on = b.batch().await;
    assert_eq!(handed_on[0].attempt, Some(v1::Attempt { evaluation: 2, number: 2 }));
    a.complete(&batch[0]).await;
    let Raw { sender, mut incoming, .. } = a;
    drop(sender);
    assert!(timeout(PATIENCE, incoming.message()).await.unwrap().unwrap().is_none(), "the stream ends well");
    b.complete(&handed_on[0]).await;
    assert_eq!(take(&mut output, 2).await.len(), 2);
    let reply = FleetClient::new(service.channel.clone()).workers(v1::WorkersRequest {}).await.unwrap();
    let workers = reply.into_inner().workers;
    let told: Vec<_> =
        workers.iter().map(|w| (w.name.as_str(), w.state.as_str(), w.completed, w.lost)).collect();
    assert_eq!(told, [("b", "attached", 1, 0), ("a", "gone", 1, 0)]);
    assert!(workers[0].attached_ms > 1_600_000_000_000 && workers[0].heard_ms >= workers[0].attached_ms);
}

#[tokio::test]
async fn a_goodbye_reaches_the_workers_and_the_owners() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..3)).await;
    a.batch().await;
    service.fleet.goodbye().await;
    let Some(Told::Goodbye(goodbye)) = a.hear().await.unwrap() else { panic!("no goodbye") };
    assert_eq!(goodbye.reason, "the coordinator goes away");
    assert!(a.hear().await.unwrap().is_none());
    assert_eq!(output.next().await, None);
    let status = service.attach(hello("b", 1, 1)).await.map(drop).unwrap_err();
    assert_eq!(status.code(), Code::Unavailable);
    // Nothing of this waits for ever.
    queue.submit(evaluations(5..6)).await;
    service.fleet.goodbye().await;
    assert_eq!(service.fleet.queue("late".to_owned(), 1).await.1.next().await, None);
    assert_eq!(service.fleet.workers().await, []);
}

#[tokio::test]
async fn an_owner_that_goes_away_leaves_nothing_running() {
    let service = serve(50, 60_000).await;
    let (queue, output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..3)).await;
    let batch = a.batch().await;
    drop(output);
    let Some(Told::Revoke(revoked)) = a.hear().await.unwrap() else { panic!("nothing was revoked") };
    assert_eq!(revoked.attempts, [batch[0].attempt.unwrap()]);
}

/// Evaluates as a worker does, until its stream ends.
async fn evaluate_all(mut a: Raw) {
    let system = creatures::system("probe").unwrap();
    let mut task = None;
    while let Ok(Some(told)) = a.hear().await {
        match told {
            Told::Task(text) => task = Some(system.task(&text.spec).unwrap()),
            Told::Batch(batch) => {
                for one in batch.assignments {
                    let task = task.as_ref().expect("the task comes first");
                    let attempt = one.attempt.unwrap();
                    let cull = one.cull.map(|cull| creatures::Cull::try_from(cull).unwrap());
                    let what = if one.genotype.is_empty() {
                        What::Failure(v1::Failure { reason: "too short to live".to_owned(), r#final: true })
                    } else {
                        let lived = task.evaluate(&one.genotype, one.seed, cull.as_ref(), &mut Nobody);
                        What::Outcome(lived.unwrap().into())
                    };
                    a.report(attempt, what).await;
                }
            }
            _ => {}
        }
    }
}

fn bare_task() -> v1::EvaluateRequest {
    v1::EvaluateRequest { what: Some(Ask::Task(v1::Task::named("probe", 1, r#"{"work": 3}"#))) }
}

fn bare(id: u64, payload: &[u8]) -> v1::EvaluateRequest {
    let genotype =
        v1::Genotype { system: "probe".to_owned(), version: 1, payload: Bytes::copy_from_slice(payload) };
    let genotype = v1::EvaluateGenotype { id, genotype: Some(genotype), seed: 5, cull: None };
    v1::EvaluateRequest { what: Some(Ask::Genotype(genotype)) }
}

#[tokio::test]
async fn the_bare_service_answers_each_genotype_by_its_id() {
    let service = serve_patiently().await;
    let a = service.join("a", 1, 4).await;
    tokio::spawn(evaluate_all(a));
    let other = v1::Genotype { system: "walker".to_owned(), version: 1, payload: Bytes::from_static(b"x") };
    let other = v1::EvaluateGenotype { id: 13, genotype: Some(other), ..Default::default() };
    let asked = [
        bare_task(),
        bare(11, b"one"),
        bare(12, b""),
        v1::EvaluateRequest { what: Some(Ask::Genotype(other)) },
        bare(11, b"two"),
    ];
    let mut client = EvaluationClient::new(service.channel.clone());
    let response = client.evaluate(tokio_stream::iter(asked)).await.unwrap();
    assert_eq!(response.metadata().get("x-hatchery-limit").unwrap(), "1024");
    let mut replies = response.into_inner();
    let mut answers = Vec::new();
    while let Some(reply) = timeout(PATIENCE, replies.message()).await.unwrap().unwrap() {
        answers.push((reply.id, reply.what.unwrap()));
    }
    assert_eq!(answers.len(), 4);
    let task = creatures::system("probe").unwrap().task(r#"{"work":3}"#).unwrap();
    for genotype in [b"one", b"two"] {
        let lived = Answer::Outcome(task.evaluate(genotype, 5, None, &mut Nobody).unwrap().into());
        assert!(answers.contains(&(11, lived)));
    }
    assert!(answers.contains(&(12, Answer::Error("set aside: too short to live".to_owned()))));
    let (_, Answer::Error(error)) = answers.iter().find(|(id, _)| *id == 13).unwrap() else {
        panic!("refused")
    };
    assert!(error.contains("of `walker`, the task is of version 1 of `probe`"), "{error}");
}

#[tokio::test]
async fn the_bare_service_says_what_is_wrong_with_a_task() {
    let service = serve_patiently().await;
    let named = |system, version, spec| v1::EvaluateRequest {
        what: Some(Ask::Task(v1::Task::named(system, version, spec))),
    };
    for (request, code, word) in [
        (named("unicorn", 1, "{}"), Code::InvalidArgument, "`task.system` is `unicorn`, known are probe"),
        (named("probe", 0, "{}"), Code::FailedPrecondition, "upgrade the caller"),
        (named("probe", 99, "{}"), Code::FailedPrecondition, "upgrade the coordinator"),
        (named("probe", 1, "{"), Code::InvalidArgument, "`task.spec`"),
        (named("probe", 1, r#"{"wrok":1}"#), Code::InvalidArgument, "wrok"),
        (bare(1, b"x"), Code::FailedPrecondition, "a task must come first"),
        (v1::EvaluateRequest::default(), Code::InvalidArgument, "neither task nor genotype"),
    ] {
        let mut client = EvaluationClient::new(service.channel.clone());
        let mut replies = client.evaluate(tokio_stream::iter([request])).await.unwrap().into_inner();
        let status = timeout(PATIENCE, replies.message()).await.unwrap().unwrap_err();
        assert_eq!(status.code(), code);
        assert!(status.message().contains(word), "{status}");
    }
}

#[tokio::test]
async fn the_bare_service_reads_no_more_than_its_limit_and_drops_all_with_its_caller() {
    let service = serve(50, 60_000).await;
    let asked = std::iter::once(bare_task()).chain((0..5000).map(|id| bare(id, b"x")));
    let mut client = EvaluationClient::new(service.channel.clone());
    let replies = client.evaluate(tokio_stream::iter(asked)).await.unwrap();
    let mut summary = service.fleet.summary();
    timeout(PATIENCE, summary.wait_for(|summary| summary.ready == 1024)).await.unwrap().unwrap();
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert_eq!(summary.borrow_and_update().ready, 1024);
    drop(replies);
    timeout(PATIENCE, summary.wait_for(|summary| summary.ready == 0)).await.unwrap().unwrap();
}

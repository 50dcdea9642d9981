//! The stage of a test: a coordinator in its hands, the worker under test, and a system whose creatures do what
//! their genotype says.

use super::*;
use creatures::{DecodeError, Observer, Outcome, Proof, SpecError, System, Task};
use proto::v1::fleet_server::{Fleet, FleetServer};
use std::thread;
use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio_stream::wrappers::TcpListenerStream;
use tonic::{Request, Response};

/// A system whose creatures do what their genotype says.
pub(super) struct Actor;

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

pub(super) fn systems(name: &str) -> Option<&'static dyn System> {
    if name == "actor" { Some(&Actor) } else { creatures::system(name) }
}

/// Passes each attached stream on to the test.
pub(super) struct Door(mpsc::Sender<Link>);

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
pub(super) struct Stage {
    links: mpsc::Receiver<Link>,
    worker: JoinHandle<Result<(), WorkerError>>,
    drain: Option<oneshot::Sender<()>>,
}

impl Stage {
    pub(super) async fn set(slots: usize) -> Stage {
        Stage::set_with(slots, |config| config).await
    }

    pub(super) async fn set_with(slots: usize, change: impl FnOnce(Config) -> Config) -> Stage {
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
    pub(super) async fn welcome(&mut self, lineage: &'static [u8]) -> (Link, v1::Hello) {
        let mut link = self.link().await;
        let hello = link.hello().await;
        let lineage = Bytes::from_static(lineage);
        link.say(Incoming::Welcome(v1::Welcome { worker: 1, lineage, heartbeat_ms: 50, timeout_ms: 1000 }))
            .await;
        (link, hello)
    }

    pub(super) async fn link(&mut self) -> Link {
        soon(self.links.recv()).await.unwrap()
    }

    pub(super) fn drain(&mut self) {
        self.drain.take().unwrap().send(()).unwrap();
    }

    pub(super) async fn end(self) -> Result<(), WorkerError> {
        soon(self.worker).await.unwrap()
    }
}

pub(super) async fn soon<T>(future: impl Future<Output = T>) -> T {
    timeout(Duration::from_secs(20), future).await.expect("within 20 s")
}

/// The coordinator's end of one stream.
pub(super) struct Link {
    pub(super) from_worker: Streaming<v1::WorkerMessage>,
    pub(super) to_worker: mpsc::Sender<Result<v1::CoordinatorMessage, Status>>,
}

impl Link {
    pub(super) async fn say(&self, kind: Incoming) {
        soon(self.to_worker.send(Ok(v1::CoordinatorMessage { kind: Some(kind) }))).await.unwrap();
    }

    /// What the worker says next. `None` when it has hung up.
    pub(super) async fn hear(&mut self) -> Option<Outgoing> {
        soon(self.from_worker.message()).await.unwrap().map(|message| message.kind.unwrap())
    }

    pub(super) async fn hello(&mut self) -> v1::Hello {
        match self.hear().await {
            Some(Outgoing::Hello(hello)) => hello,
            other => panic!("{other:?} is no hello"),
        }
    }

    /// The next message with reports.
    pub(super) async fn batch(&mut self) -> Vec<v1::Report> {
        loop {
            match self.hear().await {
                Some(Outgoing::Reports(reports)) => return reports.reports,
                Some(Outgoing::Heartbeat(_) | Outgoing::Window(_)) => {}
                other => panic!("{other:?} where reports were expected"),
            }
        }
    }

    /// The next so many reports, by evaluation.
    pub(super) async fn reports(&mut self, count: usize) -> Vec<(u64, What)> {
        let mut reports = Vec::new();
        while reports.len() < count {
            reports.extend(self.batch().await);
        }
        reports.into_iter().map(|report| (report.attempt.unwrap().evaluation, report.what.unwrap())).collect()
    }

    pub(super) async fn drain(&mut self) -> Vec<u64> {
        loop {
            match self.hear().await {
                Some(Outgoing::Drain(drain)) => return drain.returned.iter().map(|a| a.evaluation).collect(),
                Some(Outgoing::Heartbeat(_)) => {}
                other => panic!("{other:?} where a drain was expected"),
            }
        }
    }

    pub(super) async fn assign(&self, assignments: Vec<v1::Assignment>) {
        self.say(Incoming::Batch(v1::Batch { assignments })).await;
    }
}

pub(super) fn actor() -> v1::Task {
    v1::Task::named("actor", 1, "{}")
}

pub(super) fn attempt(evaluation: u64) -> v1::Attempt {
    v1::Attempt { evaluation, number: 1 }
}

pub(super) fn assignment(evaluation: u64, task: &v1::Task, genotype: &'static str) -> v1::Assignment {
    let attempt = Some(attempt(evaluation));
    let genotype = Bytes::from_static(genotype.as_bytes());
    v1::Assignment { attempt, task: task.hash.clone(), genotype, seed: 7, cull: None }
}

pub(super) fn failure(what: &What) -> (&str, bool) {
    match what {
        What::Failure(v1::Failure { reason, r#final }) => (reason, *r#final),
        other => panic!("{other:?} is no failure"),
    }
}

pub(super) fn outcome(what: What) -> Outcome {
    match what {
        What::Outcome(outcome) => outcome.try_into().unwrap(),
        other => panic!("{other:?} is no outcome"),
    }
}

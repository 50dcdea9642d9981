//! A fleet behind a socket, and workers in the hands of a test: each says what it is told to, and shows what it hears.

use bytes::Bytes;
use coordinator::fleet::{Evaluation, Fate, Fleet, FleetSettings, Queue, QueueOutput, Settled, TaskText};
use coordinator::service;
use creatures::{Outcome, Status as Ending};
use proto::v1::coordinator_message::Kind as Told;
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
use tonic::{Status, Streaming};

pub(crate) const LINEAGE: [u8; 16] = [7; 16];
pub(crate) const FINGERPRINT: [u8; 32] = [9; 32];
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

pub(crate) struct Service {
    pub(crate) fleet: Fleet,
    pub(crate) channel: Channel,
}

pub(crate) async fn serve(heartbeat_ms: u32, timeout_ms: u32) -> Service {
    serve_until_overdue(heartbeat_ms, timeout_ms, 900).await
}

pub(crate) async fn serve_until_overdue(heartbeat_ms: u32, timeout_ms: u32, overdue_s: u32) -> Service {
    let fleet = Fleet::start(FleetSettings {
        heartbeat_ms,
        timeout_ms,
        overdue_s,
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
pub(crate) async fn serve_patiently() -> Service {
    serve(60_000, 600_000).await
}

pub(crate) fn hello(name: &str, slots: u32, window: u32) -> v1::Hello {
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
        incarnation: 1,
    }
}

/// A worker's end of a stream.
pub(crate) struct Raw {
    pub(crate) sender: mpsc::Sender<v1::WorkerMessage>,
    pub(crate) incoming: Streaming<v1::CoordinatorMessage>,
    pub(crate) welcome: v1::Welcome,
}

impl Service {
    pub(crate) async fn attach(&self, hello: v1::Hello) -> Result<Raw, Status> {
        self.begin(Said::Hello(hello)).await
    }

    pub(crate) async fn begin(&self, first: Said) -> Result<Raw, Status> {
        let (sender, receiver) = mpsc::channel(16);
        sender.send(v1::WorkerMessage { kind: Some(first) }).await.unwrap();
        let mut client = FleetClient::new(self.channel.clone());
        let mut incoming = client.attach(ReceiverStream::new(receiver)).await?.into_inner();
        match incoming.message().await?.and_then(|message| message.kind) {
            Some(Told::Welcome(welcome)) => Ok(Raw { sender, incoming, welcome }),
            other => panic!("no welcome but {other:?}"),
        }
    }

    pub(crate) async fn join(&self, name: &str, slots: u32, window: u32) -> Raw {
        self.attach(hello(name, slots, window)).await.unwrap()
    }

    pub(crate) async fn queue(&self) -> (Queue, QueueOutput) {
        self.fleet.queue("test".to_owned(), 1).await
    }
}

impl Raw {
    pub(crate) async fn say(&self, kind: Said) {
        self.sender.send(v1::WorkerMessage { kind: Some(kind) }).await.unwrap();
    }

    pub(crate) async fn hear(&mut self) -> Result<Option<Told>, Status> {
        let message = timeout(PATIENCE, self.incoming.message()).await.expect("it answers in time")?;
        Ok(message.map(|message| message.kind.expect("messages have a kind")))
    }

    /// The next batch, past any task.
    pub(crate) async fn batch(&mut self) -> Vec<v1::Assignment> {
        loop {
            match self.hear().await.unwrap() {
                Some(Told::Batch(batch)) => return batch.assignments,
                Some(Told::Task(_)) => {}
                other => panic!("no batch but {other:?}"),
            }
        }
    }

    pub(crate) async fn report(&self, attempt: v1::Attempt, what: What) {
        let report = v1::Report { attempt: Some(attempt), seconds: 0.01, what: Some(what) };
        self.say(Said::Reports(v1::Reports { reports: vec![report] })).await;
    }

    pub(crate) async fn complete(&self, assignment: &v1::Assignment) {
        let attempt = assignment.attempt.unwrap();
        self.report(attempt, What::Outcome(outcome(attempt.evaluation as f64).into())).await;
    }
}

pub(crate) fn outcome(fitness: f64) -> Outcome {
    Outcome {
        status: Ending::Completed,
        fitness,
        steps: 10,
        measures: vec![("echo".to_owned(), fitness)],
        interim: None,
        note: String::new(),
    }
}

pub(crate) fn evaluations(ids: std::ops::Range<u64>) -> Vec<Evaluation> {
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

pub(crate) async fn take(output: &mut QueueOutput, count: usize) -> Vec<Settled> {
    let mut settled = Vec::new();
    while settled.len() < count {
        settled.extend(timeout(PATIENCE, output.next()).await.expect("it settles in time").unwrap());
    }
    settled
}

pub(crate) fn fates(settled: &Settled) -> Vec<(u32, &str, Fate)> {
    settled.attempts.iter().map(|a| (a.number, a.worker.as_str(), a.fate.clone())).collect()
}

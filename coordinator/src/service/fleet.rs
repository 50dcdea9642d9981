//! The fleet's service: takes workers in by their hello, and passes on what they say. Who gets what is the
//! fleet's to decide.

use crate::credentials::Admission;
use crate::fleet::{Fleet, Mouth, WorkerInfo};
use crate::service::words::{attempt, introduce, report, within};
use proto::hello::{HOLDING_MAX, VERSION_SIZE_MAX, WINDOW_MAX};
use proto::refusal::Refusal;
use proto::v1::fleet_server::FleetServer;
use proto::v1::worker_message::Kind;
use proto::{MESSAGE_SIZE_MAX, PROTOCOL, REPORTS_MAX, WORKER_MESSAGE_SIZE_MAX, v1};
use std::convert::Infallible;
use std::future::pending;
use std::pin::pin;
use std::time::Duration;
use tokio::sync::oneshot;
use tokio::time::timeout;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status, Streaming};

/// From the call to the hello.
const HELLO_TIMEOUT: Duration = Duration::from_secs(10);
/// For a worker to hang up after its stream was closed.
const HANG_UP_TIMEOUT: Duration = Duration::from_secs(2);

/// The service over a fleet.
pub fn fleet(fleet: Fleet) -> FleetServer<FleetService> {
    FleetServer::new(FleetService { fleet })
        .max_decoding_message_size(WORKER_MESSAGE_SIZE_MAX)
        .max_encoding_message_size(MESSAGE_SIZE_MAX)
}

/// `hatchery.v1.Fleet`.
#[derive(Debug)]
pub struct FleetService {
    fleet: Fleet,
}

#[tonic::async_trait]
impl v1::fleet_server::Fleet for FleetService {
    type AttachStream = ReceiverStream<Result<v1::CoordinatorMessage, Status>>;

    async fn attach(
        &self,
        request: Request<Streaming<v1::WorkerMessage>>,
    ) -> Result<Response<Self::AttachStream>, Status> {
        let admission = request.extensions().get::<Admission>().cloned();
        let mut incoming = request.into_inner();
        let first = timeout(HELLO_TIMEOUT, incoming.message())
            .await
            .map_err(|_| Status::deadline_exceeded(format!("no hello within {HELLO_TIMEOUT:?}")))??;
        let Some(v1::WorkerMessage { kind: Some(Kind::Hello(hello)) }) = first else {
            return Err(Refusal::Hello("it must come first".to_owned()).into());
        };
        let (name, host) = (hello.name.clone(), hello.host.clone());
        let admitted = match self
            .vet(&hello)
            .and_then(|print| Ok((introduce(hello, &self.fleet.settings().lineage)?, print)))
        {
            Ok((hello, fingerprint)) => self
                .fleet
                .attach(hello, fingerprint)
                .await
                .ok_or_else(|| Status::unavailable("the coordinator goes away"))?,
            Err(refusal) => Err(refusal),
        };
        let attachment = admitted
            .inspect_err(|refusal| self.fleet.turned_away(&printable(&name), &printable(&host), refusal))?;
        tokio::spawn(listen(incoming, attachment.mouth(), attachment.closed, admission));
        Ok(Response::new(ReceiverStream::new(attachment.messages)))
    }

    async fn workers(
        &self,
        _request: Request<v1::WorkersRequest>,
    ) -> Result<Response<v1::WorkersReply>, Status> {
        let workers = self.fleet.workers().await;
        let workers = workers.into_iter().map(|worker| self.render(worker)).collect();
        Ok(Response::new(v1::WorkersReply { workers, notes: self.fleet.notes() }))
    }
}

impl FleetService {
    /// Whether a worker speaks as this program does and computes what it computes. Gives its fingerprint.
    fn vet(&self, hello: &v1::Hello) -> Result<[u8; 32], Refusal> {
        let settings = self.fleet.settings();
        if hello.protocol != PROTOCOL {
            return Err(Refusal::Protocol { worker: hello.protocol, coordinator: PROTOCOL });
        }
        if hello.version.len() > VERSION_SIZE_MAX {
            let size = hello.version.len();
            return Err(Refusal::Hello(format!(
                "`version` has {size} bytes, the limit is {VERSION_SIZE_MAX}"
            )));
        }
        if hello.version != settings.version {
            let (worker, coordinator) = (hello.version.clone(), settings.version.clone());
            return Err(Refusal::Version { worker, coordinator });
        }
        let fingerprint: [u8; 32] = hello.fingerprint[..].try_into().map_err(|_| {
            Refusal::Hello(format!("`fingerprint` has {} bytes, must have 32", hello.fingerprint.len()))
        })?;
        if fingerprint != settings.fingerprint {
            let (worker, coordinator) = (hexadecimal(&fingerprint), hexadecimal(&settings.fingerprint));
            return Err(Refusal::Fingerprint { worker, coordinator });
        }
        Ok(fingerprint)
    }

    fn render(&self, worker: WorkerInfo) -> v1::WorkerInfo {
        v1::WorkerInfo {
            id: worker.id.0,
            name: worker.name,
            host: worker.host,
            slots: worker.slots,
            version: worker.version,
            state: worker.state.word().to_owned(),
            in_flight: worker.in_flight,
            window: worker.window,
            completed: worker.completed,
            lost: worker.lost,
            busy_seconds: worker.busy_seconds,
            attached_ms: self.fleet.unix_ms(worker.attached),
            heard_ms: self.fleet.unix_ms(worker.heard),
            labels: worker.labels,
        }
    }
}

/// Passes on what a worker says until its stream ends or the fleet closes it.
async fn listen(
    mut incoming: Streaming<v1::WorkerMessage>,
    mouth: Mouth,
    mut closed: oneshot::Receiver<Infallible>,
    admission: Option<Admission>,
) {
    let mut expelled = pin!(async {
        match admission {
            Some(admission) => admission.ended().await,
            None => pending().await,
        }
    });
    loop {
        let message = tokio::select! {
            biased; // so that a simulation replays
            _ = &mut closed => break,
            denied = &mut expelled => {
                mouth.expelled(denied.into()).await;
                break;
            }
            message = incoming.message() => message,
        };
        let passed = match message {
            Ok(Some(message)) => pass_on(message, &mouth).await,
            Ok(None) => return mouth.left().await,
            Err(_) => return mouth.broke().await,
        };
        if let Err(status) = passed {
            mouth.misspoke(status).await;
            break;
        }
    }
    // Whoever hangs up first resets the stream: leave that to the worker, which may still be reading.
    let hang_up = async { while let Ok(Some(_)) = incoming.message().await {} };
    let _ = timeout(HANG_UP_TIMEOUT, hang_up).await;
}

async fn pass_on(message: v1::WorkerMessage, mouth: &Mouth) -> Result<(), Status> {
    match message.kind {
        Some(Kind::Reports(v1::Reports { reports })) => {
            within("reports", reports.len(), REPORTS_MAX)?;
            mouth.reports(reports.into_iter().map(report).collect::<Result<_, _>>()?).await;
        }
        Some(Kind::Heartbeat(v1::Heartbeat {})) => mouth.heartbeat().await,
        Some(Kind::Window(v1::Window { evaluations })) => {
            if !(1..=WINDOW_MAX).contains(&evaluations) {
                return Err(Status::invalid_argument(format!(
                    "`window.evaluations` is {evaluations}, must be 1 to {WINDOW_MAX}"
                )));
            }
            mouth.window(evaluations).await;
        }
        Some(Kind::Drain(v1::Drain { returned })) => {
            within("drain.returned", returned.len(), HOLDING_MAX)?;
            mouth.drain(returned.into_iter().map(attempt).collect()).await;
        }
        Some(Kind::Hello(_)) => return Err(Status::invalid_argument("a second hello")),
        None => return Err(Status::invalid_argument("a message of an unknown kind")),
    }
    Ok(())
}

/// A stranger's word about itself, short and without control characters.
fn printable(word: &str) -> String {
    word.chars().take(64).collect::<String>().escape_debug().to_string()
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

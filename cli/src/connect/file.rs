//! A lineage file served in this process over a pipe in memory, so that a command which reads a file is the
//! same gRPC client as one which asks a coordinator. Nothing listens, and a run may be writing the file
//! meanwhile. Picks, orders, changed files and forks are written, into a file that nobody else writes; nothing is
//! evaluated.

use std::path::Path;
use std::pin::Pin;

use coordinator::driver::{amend_at_rest, control_at_rest, fork_at_rest, pick_at_rest};
use coordinator::lineage::{IndividualId, Lineage, OpenError, ReadError, Reader, State, Summary, is_at_work};
use coordinator::service::experiments::{self, render_summary};
use coordinator::service::lineage::{LineageService, OWN, status};
use hyper_util::rt::TokioIo;
use proto::dial::{Line, Show};
use proto::v1;
use proto::v1::experiments_server::{Experiments, ExperimentsServer};
use tokio_stream::{Stream, StreamExt};
use tonic::service::interceptor::InterceptedService;
use tonic::transport::{Endpoint, Server};
use tonic::{Request, Response, Status};

use crate::exit::Failure;

/// The state of an experiment that was running when whoever ran it ended.
const INTERRUPTED: &str = "interrupted";
/// Room for what is on its way through the pipe, bytes.
const PIPE_SIZE: usize = 1 << 20;

/// Opens a lineage file for reading and serves it to the channel that it gives.
///
/// # Errors
/// No such file, or a file that is no lineage, or not of this release.
pub(super) async fn serve(path: &Path) -> Result<Line, Failure> {
    let is_at_rest = !is_at_work(path);
    let reader = Reader::open(path).await?;
    let (ours, theirs) = tokio::io::duplex(PIPE_SIZE);
    let once = tokio_stream::once(Ok::<_, std::io::Error>(theirs)).chain(tokio_stream::pending());
    let router = Server::builder()
        .add_service(LineageService::within(reader.clone(), OWN).into_server())
        .add_service(ExperimentsServer::new(Stored { reader, is_at_rest }));
    tokio::spawn(async move {
        if let Err(error) = router.serve_with_incoming(once).await {
            tracing::warn!("the service in this process ended: {error}");
        }
    });
    let mut ours = Some(TokioIo::new(ours));
    let connector = tower::service_fn(move |_| {
        // There is one pipe: a second connection would mean that the first one broke.
        let pipe = ours.take().ok_or_else(|| std::io::Error::other("the service in this process ended"));
        std::future::ready(pipe)
    });
    let endpoint = Endpoint::from_static("http://in-process");
    let channel = endpoint.connect_with_connector(connector).await.map_err(anyhow::Error::new)?;
    Ok(InterceptedService::new(channel, Show::nothing()))
}

/// The `Experiments` service as far as a file can answer: what there is, and how far it was when last
/// written.
struct Stored {
    reader: Reader,
    /// Nobody was at work on the file when it was opened.
    is_at_rest: bool,
}

impl Stored {
    async fn show(&self, reference: String) -> Result<Response<v1::Experiment>, Status> {
        let id = self.reader.find_one(&reference).await.map_err(status)?;
        let mut summaries = self.reader.summaries(Some(&[id])).await.map_err(status)?;
        let summary = summaries.pop();
        let summary = summary.ok_or_else(|| status(ReadError::NotFound { what: "experiment", reference }))?;
        let resolved = self.reader.experiment(id).await.map_err(status)?.resolved;
        Ok(Response::new(v1::Experiment { resolved, ..self.render(summary) }))
    }

    /// What the file has as running, and nobody runs, was interrupted.
    fn render(&self, summary: Summary) -> v1::Experiment {
        let mut rendered = render_summary(summary);
        if self.is_at_rest && rendered.state == State::Running.word() {
            rendered.state = INTERRUPTED.to_owned();
            rendered.reason = "nobody is at work on it; it goes on when it is run again".to_owned();
        }
        rendered
    }

    /// Carries an order out on all that a reference names.
    async fn control(
        &self,
        request: Request<v1::ControlRequest>,
        to: State,
    ) -> Result<Response<v1::ListReply>, Status> {
        let ids = self.reader.find(&request.into_inner().experiment).await.map_err(status)?;
        let lineage = self.write().await?;
        let ordered = async {
            for &id in &ids {
                control_at_rest(&lineage, id, to).await?;
            }
            Ok(())
        };
        let ordered = ordered.await.map_err(experiments::control_status);
        written(lineage, ordered).await?;
        let summaries = self.reader.summaries(Some(&ids)).await.map_err(status)?;
        let experiments = summaries.into_iter().map(|summary| self.render(summary)).collect();
        Ok(Response::new(v1::ListReply { experiments }))
    }

    /// The right to write the file, which one at a time has.
    async fn write(&self) -> Result<Lineage, Status> {
        Lineage::open(self.reader.path()).await.map_err(|error| match error {
            OpenError::Held { .. } => {
                Status::failed_precondition(format!("{error}: name it with --coordinator URL"))
            }
            _ => Status::internal(error.to_string()),
        })
    }
}

/// What was written, once it is on disk and the file is free again.
async fn written<T>(lineage: Lineage, what: Result<T, Status>) -> Result<T, Status> {
    let closed = lineage.close().await;
    let what = what?;
    closed.map_err(|error| Status::internal(error.to_string()))?;
    Ok(what)
}

/// Of the physics of this program.
async fn fingerprint() -> [u8; 32] {
    let fingerprint = tokio::task::spawn_blocking(creatures::fingerprint).await;
    fingerprint.expect("the fingerprint of a sound build does not panic; a test says so")
}

/// What only a coordinator can do.
fn needs_coordinator<T>() -> Result<Response<T>, Status> {
    Err(Status::failed_precondition("a file alone cannot do this: name a coordinator with --coordinator URL"))
}

#[tonic::async_trait]
impl Experiments for Stored {
    async fn list(&self, _: Request<v1::ListRequest>) -> Result<Response<v1::ListReply>, Status> {
        let summaries = self.reader.summaries(None).await.map_err(status)?;
        let experiments = summaries.into_iter().map(|summary| self.render(summary)).collect();
        Ok(Response::new(v1::ListReply { experiments }))
    }

    async fn get(&self, request: Request<v1::GetRequest>) -> Result<Response<v1::Experiment>, Status> {
        self.show(request.into_inner().experiment).await
    }

    async fn candidates(
        &self,
        request: Request<v1::CandidatesRequest>,
    ) -> Result<Response<v1::CandidatesReply>, Status> {
        experiments::candidates(&self.reader, request.into_inner()).await
    }

    async fn pick(&self, request: Request<v1::PickRequest>) -> Result<Response<v1::Experiment>, Status> {
        let v1::PickRequest { experiment, individual, note } = request.into_inner();
        let id = self.reader.find_one(&experiment).await.map_err(status)?;
        let lineage = self.write().await?;
        let picked = pick_at_rest(&lineage, id, IndividualId(individual), note).await;
        written(lineage, picked.map_err(experiments::pick_status)).await?;
        self.show(experiment).await
    }

    async fn amend(&self, request: Request<v1::AmendRequest>) -> Result<Response<v1::AmendReply>, Status> {
        let v1::AmendRequest { experiment, file } = request.into_inner();
        let id = self.reader.find_one(&experiment).await.map_err(status)?;
        let file = experiments::file_of(file.unwrap_or_default())?;
        let (fingerprint, lineage) = (fingerprint().await, self.write().await?);
        let amended = amend_at_rest(&lineage, fingerprint, id, &file).await;
        let differences = written(lineage, amended.map_err(experiments::amend_status)).await?;
        let experiment = Some(self.show(id.to_string()).await?.into_inner());
        Ok(Response::new(v1::AmendReply { experiment, differences }))
    }

    async fn fork(&self, request: Request<v1::ForkRequest>) -> Result<Response<v1::Experiment>, Status> {
        let fork = experiments::fork_of(&self.reader, request.into_inner()).await?;
        let (fingerprint, lineage) = (fingerprint().await, self.write().await?);
        let forked = fork_at_rest(&lineage, fingerprint, fork).await;
        let id = written(lineage, forked.map_err(experiments::fork_status)).await?;
        self.show(id.to_string()).await
    }

    async fn submit(&self, _: Request<v1::SubmitRequest>) -> Result<Response<v1::SubmitReply>, Status> {
        needs_coordinator()
    }

    type WatchStream = Pin<Box<dyn Stream<Item = Result<v1::WatchEvent, Status>> + Send>>;

    async fn watch(&self, _: Request<v1::WatchRequest>) -> Result<Response<Self::WatchStream>, Status> {
        needs_coordinator()
    }

    async fn pause(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        self.control(request, State::Paused).await
    }

    async fn resume(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        self.control(request, State::Running).await
    }

    async fn cancel(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        self.control(request, State::Cancelled).await
    }
}

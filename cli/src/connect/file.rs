//! A lineage file served in this process over a pipe in memory, so that a command which reads a file is the
//! same gRPC client as one which asks a coordinator. Nothing is written, nothing listens, and a run may be
//! writing the file meanwhile.

use std::path::Path;
use std::pin::Pin;

use coordinator::lineage::{ExperimentId, OpenError, Reader};
use coordinator::service::lineage::{LineageService, read_status};
use hyper_util::rt::TokioIo;
use proto::v1::experiments_server::{Experiments, ExperimentsServer};
use proto::v1::lineage_server::LineageServer;
use proto::{MESSAGE_SIZE_MAX, v1};
use tokio_stream::{Stream, StreamExt};
use tonic::transport::{Channel, Endpoint, Server};
use tonic::{Request, Response, Status};

use crate::exit::Failure;

/// Room for what is on its way through the pipe, bytes.
const PIPE_SIZE: usize = 1 << 20;

/// Opens a lineage file for reading and serves it to the channel that it gives.
///
/// # Errors
/// No such file, or a file that is no lineage, or not of this release.
pub(super) async fn serve(path: &Path) -> Result<Channel, Failure> {
    let reader = Reader::open(path).await.map_err(refusal)?;
    let (ours, theirs) = tokio::io::duplex(PIPE_SIZE);
    let once = tokio_stream::once(Ok::<_, std::io::Error>(theirs)).chain(tokio_stream::pending());
    let router = Server::builder()
        .add_service(
            LineageServer::new(LineageService::new(reader.clone()))
                .max_encoding_message_size(MESSAGE_SIZE_MAX),
        )
        .add_service(ExperimentsServer::new(Stored { reader }).max_encoding_message_size(MESSAGE_SIZE_MAX));
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
    endpoint.connect_with_connector(connector).await.map_err(|error| anyhow::Error::new(error).into())
}

fn refusal(error: OpenError) -> Failure {
    match error {
        OpenError::Missing { path } => Failure::NotFound(format!(
            "{}: no such file; name a lineage with --db FILE, or a coordinator with --coordinator URL",
            path.display()
        )),
        OpenError::Foreign { .. } => Failure::Usage(error.to_string()),
        _ => Failure::Failed(error.into()),
    }
}

/// The `Experiments` service as far as a file can answer: what there is, and how far it was when last
/// written.
#[derive(Debug, Clone)]
struct Stored {
    reader: Reader,
}

impl Stored {
    async fn summary(&self, id: ExperimentId) -> Result<v1::Experiment, Status> {
        self.reader.summary(id).await.map_err(|error| read_status(&error))
    }
}

/// What only a coordinator can do.
fn needs_coordinator<T>() -> Result<Response<T>, Status> {
    Err(Status::failed_precondition("a file alone cannot do this: name a coordinator with --coordinator URL"))
}

#[tonic::async_trait]
impl Experiments for Stored {
    async fn list(&self, _: Request<v1::ListRequest>) -> Result<Response<v1::ListReply>, Status> {
        let mut experiments = Vec::new();
        for id in self.reader.every().await.map_err(|error| read_status(&error))? {
            experiments.push(self.summary(id).await?);
        }
        Ok(Response::new(v1::ListReply { experiments }))
    }

    async fn get(&self, request: Request<v1::GetRequest>) -> Result<Response<v1::Experiment>, Status> {
        let reference = request.into_inner().experiment;
        let ids = self.reader.find(&reference).await.map_err(|error| read_status(&error))?;
        let [id] = ids[..] else {
            return Err(Status::invalid_argument(format!(
                "`{reference}` names {} experiments: name one by its number",
                ids.len()
            )));
        };
        Ok(Response::new(self.summary(id).await?))
    }

    async fn submit(&self, _: Request<v1::SubmitRequest>) -> Result<Response<v1::SubmitReply>, Status> {
        needs_coordinator()
    }

    type WatchStream = Pin<Box<dyn Stream<Item = Result<v1::WatchEvent, Status>> + Send>>;

    async fn watch(&self, _: Request<v1::WatchRequest>) -> Result<Response<Self::WatchStream>, Status> {
        needs_coordinator()
    }

    async fn pause(&self, _: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        needs_coordinator()
    }

    async fn resume(&self, _: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        needs_coordinator()
    }

    async fn cancel(&self, _: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        needs_coordinator()
    }
}

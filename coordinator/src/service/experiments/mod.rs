//! Experiments over gRPC: parses, calls the driver or a reader, renders. It decides nothing.

mod refusal;
mod render;
mod watch;

pub use refusal::{amend_status, control_status, fork_status, pick_status};
pub use render::render_summary;

use std::collections::BTreeSet;
use std::pin::Pin;

use proto::v1;
use search::Overrides;
use tokio::sync::mpsc;
use tokio_stream::Stream;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status};

use crate::driver::{Changed, ControlError, Driver, Fork, Submission};
use crate::lineage::{ExperimentId, Health, IndividualId, Reader, State};
use crate::service::lineage::status;
use refusal::submit_status;
use render::{bring_up_to_date, render_choice};

/// The `Experiments` service over a driver.
#[derive(Debug, Clone)]
pub struct ExperimentsService {
    driver: Driver,
}

impl ExperimentsService {
    /// The service over a driver.
    pub fn new(driver: Driver) -> Self {
        ExperimentsService { driver }
    }

    /// As a tonic server.
    pub fn into_server(self) -> v1::experiments_server::ExperimentsServer<Self> {
        v1::experiments_server::ExperimentsServer::new(self)
            .max_decoding_message_size(proto::MESSAGE_SIZE_MAX)
    }

    async fn find(&self, reference: &str) -> Result<Vec<ExperimentId>, Status> {
        self.driver.lineage().clients().find(reference).await.map_err(status)
    }

    async fn render(&self, id: ExperimentId) -> Result<v1::Experiment, Status> {
        let rendered = self.render_all(Some(&[id])).await?;
        rendered
            .into_iter()
            .next()
            .ok_or_else(|| Status::not_found(format!("experiment {id} is not in this lineage")))
    }

    /// Experiments as the lineage has them, with what only the driver knows.
    async fn render_all(&self, ids: Option<&[ExperimentId]>) -> Result<Vec<v1::Experiment>, Status> {
        let summaries = self.driver.lineage().clients().summaries(ids).await.map_err(status)?;
        Ok(summaries
            .into_iter()
            .map(|summary| {
                let id = summary.id;
                let mut rendered = render_summary(summary);
                if let Some(progress) = self.driver.progress(id) {
                    bring_up_to_date(&mut rendered, &progress.counts().runs);
                }
                if rendered.state == State::Running.word() && rendered.reason.is_empty() {
                    rendered.reason = self.driver.held_up();
                }
                rendered
            })
            .collect())
    }

    /// Carries an order out to its end, whether or not the caller still listens, or refuses it while nothing can be
    /// written: who has given up waiting would give it again.
    async fn carry_out<T: Send + 'static>(
        &self,
        order: impl Future<Output = Result<T, Status>> + Send + 'static,
    ) -> Result<T, Status> {
        if let Health::Stuck { reason } = &*self.driver.lineage().health().borrow() {
            let text = format!(
                "the lineage cannot be written: {reason}; nothing was done, try again once it can be"
            );
            return Err(Status::unavailable(text));
        }
        let broke = |error| Status::internal(format!("the order was not carried out to its end: {error}"));
        tokio::spawn(order).await.map_err(broke)?
    }

    /// Gives one order to every experiment that is named.
    async fn control<Given>(
        &self,
        request: Request<v1::ControlRequest>,
        order: impl Fn(Driver, ExperimentId) -> Given + Send + 'static,
    ) -> Result<Response<v1::ListReply>, Status>
    where
        Given: Future<Output = Result<(), ControlError>> + Send,
    {
        let ids = self.find(&request.into_inner().experiment).await?;
        let driver = self.driver.clone();
        let given = async move {
            for &id in &ids {
                order(driver.clone(), id).await.map_err(control_status)?;
            }
            Ok(ids)
        };
        self.reply(&self.carry_out(given).await?).await
    }

    async fn reply(&self, ids: &[ExperimentId]) -> Result<Response<v1::ListReply>, Status> {
        Ok(Response::new(v1::ListReply { experiments: self.render_all(Some(ids)).await? }))
    }
}

#[tonic::async_trait]
impl v1::experiments_server::Experiments for ExperimentsService {
    async fn submit(&self, request: Request<v1::SubmitRequest>) -> Result<Response<v1::SubmitReply>, Status> {
        let request = request.into_inner();
        let resume = request.resume;
        let Changed { text, overrides } = file_of(request)?;
        let submission = Submission { text, overrides, resume };
        let driver = self.driver.clone();
        let order = async move { driver.submit(submission).await.map_err(submit_status) };
        let (ids, resumed) = self.carry_out(order).await?;
        let experiments = self.render_all(Some(&ids)).await?;
        Ok(Response::new(v1::SubmitReply { experiments, resumed }))
    }

    async fn list(&self, _: Request<v1::ListRequest>) -> Result<Response<v1::ListReply>, Status> {
        Ok(Response::new(v1::ListReply { experiments: self.render_all(None).await? }))
    }

    async fn get(&self, request: Request<v1::GetRequest>) -> Result<Response<v1::Experiment>, Status> {
        let reader = self.driver.lineage().clients();
        let id = reader.find_one(&request.into_inner().experiment).await.map_err(status)?;
        let mut rendered = self.render(id).await?;
        let stored = reader.experiment(id).await.map_err(status)?;
        rendered.resolved = stored.resolved;
        Ok(Response::new(rendered))
    }

    type WatchStream = Pin<Box<dyn Stream<Item = Result<v1::WatchEvent, Status>> + Send>>;

    async fn watch(&self, request: Request<v1::WatchRequest>) -> Result<Response<Self::WatchStream>, Status> {
        let ids: BTreeSet<_> = self.find(&request.into_inner().experiment).await?.into_iter().collect();
        let (events, stream) = mpsc::channel(64);
        let service = self.clone();
        tokio::spawn(async move {
            // A watcher that went away is no news.
            let _ = service.watch_until_ended(ids, events).await;
        });
        Ok(Response::new(Box::pin(ReceiverStream::new(stream))))
    }

    async fn pause(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        self.control(request, |driver, id| async move { driver.pause(id).await }).await
    }

    async fn resume(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        self.control(request, |driver, id| async move { driver.resume(id).await }).await
    }

    async fn cancel(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        self.control(request, |driver, id| async move { driver.cancel(id).await }).await
    }

    async fn candidates(
        &self,
        request: Request<v1::CandidatesRequest>,
    ) -> Result<Response<v1::CandidatesReply>, Status> {
        candidates(self.driver.lineage().clients(), request.into_inner()).await
    }

    async fn pick(&self, request: Request<v1::PickRequest>) -> Result<Response<v1::Experiment>, Status> {
        let v1::PickRequest { experiment, individual, note } = request.into_inner();
        let id = self.driver.lineage().clients().find_one(&experiment).await.map_err(status)?;
        let driver = self.driver.clone();
        let order = async move { driver.pick(id, IndividualId(individual), note).await.map_err(pick_status) };
        self.carry_out(order).await?;
        Ok(Response::new(self.render(id).await?))
    }

    async fn amend(&self, request: Request<v1::AmendRequest>) -> Result<Response<v1::AmendReply>, Status> {
        let v1::AmendRequest { experiment, file } = request.into_inner();
        let id = self.driver.lineage().clients().find_one(&experiment).await.map_err(status)?;
        let file = file_of(file.unwrap_or_default())?;
        let driver = self.driver.clone();
        let order = async move { driver.amend(id, &file).await.map_err(amend_status) };
        let differences = self.carry_out(order).await?;
        let experiment = Some(self.render(id).await?);
        Ok(Response::new(v1::AmendReply { experiment, differences }))
    }

    async fn fork(&self, request: Request<v1::ForkRequest>) -> Result<Response<v1::Experiment>, Status> {
        let fork = fork_of(self.driver.lineage().clients(), request.into_inner()).await?;
        let driver = self.driver.clone();
        let id = self.carry_out(async move { driver.fork(fork).await.map_err(fork_status) }).await?;
        Ok(Response::new(self.render(id).await?))
    }
}

/// An experiment file off the wire, not yet read.
///
/// # Errors
/// An assignment that is none.
pub fn file_of(file: v1::SubmitRequest) -> Result<Changed, Status> {
    let mut set = Vec::with_capacity(file.set.len());
    for assignment in &file.set {
        let (key, value) = assignment.split_once('=').ok_or_else(|| {
            Status::invalid_argument(format!("`{assignment}` is no assignment: write key=value"))
        })?;
        set.push((key.trim().to_owned(), value.trim().to_owned()));
    }
    let profile = Some(file.profile).filter(|profile| !profile.is_empty());
    Ok(Changed { text: file.text, overrides: Overrides { profile, set } })
}

/// A fork off the wire.
///
/// # Errors
/// An experiment that is not there; an assignment that is none.
pub async fn fork_of(reader: &Reader, request: v1::ForkRequest) -> Result<Fork, Status> {
    let from = reader.find_one(&request.experiment).await.map_err(status)?;
    let file = request.file.map(file_of).transpose()?;
    Ok(Fork { from, after: request.after, file })
}

/// The candidates of an experiment, at the end of all its stages or of one.
///
/// # Errors
/// `NOT_FOUND`: an experiment or a stage that is not there.
pub async fn candidates(
    reader: &Reader,
    request: v1::CandidatesRequest,
) -> Result<Response<v1::CandidatesReply>, Status> {
    let id = reader.find_one(&request.experiment).await.map_err(status)?;
    let mut choices = reader.choices(id).await.map_err(status)?;
    let wanted = request.stage.as_str();
    if !wanted.is_empty() {
        choices.retain(|choice| choice.name == wanted || choice.number.to_string() == wanted);
        if choices.is_empty() {
            let text = format!("experiment {id} has let nobody pick at the end of a stage `{wanted}`");
            return Err(Status::not_found(text));
        }
    }
    Ok(Response::new(v1::CandidatesReply { choices: choices.into_iter().map(render_choice).collect() }))
}

//! Experiments over gRPC: parses, calls the driver or a reader, renders. It decides nothing.

use std::collections::BTreeSet;
use std::pin::Pin;
use std::time::Duration;

use prost::Message;
use proto::v1;
use search::{Overrides, Problem};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::mpsc;
use tokio_stream::Stream;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Code, Request, Response, Status};

use crate::driver::{ControlError, Driver, Ended, Happening, Submission, SubmitError};
use crate::lineage::{ExperimentId, State, WriteError};
use crate::service::lineage::read_status;

/// How often watchers are told the progress.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);

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

    async fn find(&self, reference: &str) -> Result<Vec<ExperimentId>, Status> {
        self.driver.lineage().reader().find(reference).await.map_err(|error| read_status(&error))
    }

    /// An experiment as the lineage has it, with what only the driver knows.
    async fn render(&self, id: ExperimentId) -> Result<v1::Experiment, Status> {
        let mut rendered =
            self.driver.lineage().reader().summary(id).await.map_err(|error| read_status(&error))?;
        rendered.resolved.clear();
        if let Some(progress) = self.driver.progress(id) {
            let counts = progress.counts();
            rendered.evaluated = rendered.evaluated.max(counts.evaluated);
            for run in &mut rendered.progress {
                let Some(live) = counts.runs.get(run.run as usize - 1) else { continue };
                if live.generation >= run.generation && live.stage >= run.stage {
                    (run.generation, run.size, run.done) =
                        (live.generation, live.size as u32, live.done as u32);
                }
                if let Some((best, fitness)) = live.best
                    && run.best.is_none_or(|known| fitness > known)
                {
                    (run.best, run.best_individual) = (Some(fitness), best.0);
                }
            }
        }
        if rendered.state == State::Running.word() && rendered.reason.is_empty() {
            rendered.reason = self.driver.held_up();
        }
        Ok(rendered)
    }

    async fn render_all(&self, ids: &[ExperimentId]) -> Result<Response<v1::ListReply>, Status> {
        let mut experiments = Vec::with_capacity(ids.len());
        for &id in ids {
            experiments.push(self.render(id).await?);
        }
        Ok(Response::new(v1::ListReply { experiments }))
    }

    /// Sends a watcher what happens until every experiment has ended or nobody reads any more.
    async fn watch_until_ended(
        self,
        ids: BTreeSet<ExperimentId>,
        events: mpsc::Sender<Result<v1::WatchEvent, Status>>,
    ) -> Result<(), Gone> {
        let mut happenings = self.driver.happenings();
        let mut ended = BTreeSet::new();
        let mut reasons = std::collections::BTreeMap::new();
        for &id in &ids {
            self.send_state(id, &events, &mut ended).await?;
        }
        let mut ticks = tokio::time::interval(PROGRESS_EVERY);
        ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        while ended.len() < ids.len() {
            tokio::select! {
                happening = happenings.recv() => match happening {
                    Ok(Happening::State(id)) if ids.contains(&id) => {
                        self.send_state(id, &events, &mut ended).await?;
                    }
                    Ok(Happening::Generation(id, generation)) if ids.contains(&id) => {
                        send(&events, id, v1::watch_event::What::Generation(render_generation(*generation))).await?;
                    }
                    Ok(_) => {}
                    // A slow watcher misses generations; the lineage has them.
                    Err(RecvError::Lagged(missed)) => tracing::debug!(missed, "a watcher fell behind"),
                    Err(RecvError::Closed) => return Err(Gone),
                },
                _ = ticks.tick() => {
                    let held_up = self.driver.held_up();
                    for &id in ids.difference(&ended.clone()) {
                        if reasons.insert(id, held_up.clone()).unwrap_or_default() != held_up {
                            self.send_state(id, &events, &mut ended).await?;
                        }
                        if let Some(progress) = self.progress(id) {
                            send(&events, id, v1::watch_event::What::Progress(progress)).await?;
                        }
                    }
                }
                _ = events.closed() => return Err(Gone),
            }
        }
        Ok(())
    }

    fn progress(&self, id: ExperimentId) -> Option<v1::Progress> {
        let counts = self.driver.progress(id)?.counts();
        let fleet = self.driver.fleet().summary().borrow().clone();
        Some(v1::Progress {
            evaluated: counts.evaluated,
            planned: counts.planned.unwrap_or(0),
            rate: counts.rate(),
            workers: fleet.workers,
            slots: fleet.slots,
        })
    }

    async fn send_state(
        &self,
        id: ExperimentId,
        events: &mpsc::Sender<Result<v1::WatchEvent, Status>>,
        ended: &mut BTreeSet<ExperimentId>,
    ) -> Result<(), Gone> {
        match self.render(id).await {
            Ok(experiment) => {
                let over = ["finished", "cancelled", "failed"].contains(&experiment.state.as_str());
                send(events, id, v1::watch_event::What::State(experiment)).await?;
                if over {
                    ended.insert(id);
                }
                Ok(())
            }
            Err(status) => {
                let _ = events.send(Err(status)).await;
                Err(Gone)
            }
        }
    }
}

/// Nobody reads the stream any more, or nothing will come.
#[derive(Debug)]
struct Gone;

async fn send(
    events: &mpsc::Sender<Result<v1::WatchEvent, Status>>,
    id: ExperimentId,
    what: v1::watch_event::What,
) -> Result<(), Gone> {
    events.send(Ok(v1::WatchEvent { experiment: id.0, what: Some(what) })).await.map_err(|_| Gone)
}

#[tonic::async_trait]
impl v1::experiments_server::Experiments for ExperimentsService {
    async fn submit(
        &self,
        request: Request<v1::SubmitRequest>,
    ) -> Result<Response<v1::SubmitReply>, Status> {
        let request = request.into_inner();
        let mut set = Vec::with_capacity(request.set.len());
        for assignment in &request.set {
            let (key, value) = assignment.split_once('=').ok_or_else(|| {
                Status::invalid_argument(format!("`{assignment}` is no assignment: write key=value"))
            })?;
            set.push((key.trim().to_owned(), value.trim().to_owned()));
        }
        let profile = Some(request.profile).filter(|profile| !profile.is_empty());
        let submission = Submission {
            text: request.text,
            overrides: Overrides { profile, set },
            resume: request.resume,
        };
        let (ids, resumed) =
            self.driver.submit(submission).await.map_err(|error| submit_status(&error))?;
        let experiments = self.render_all(&ids).await?.into_inner().experiments;
        Ok(Response::new(v1::SubmitReply { experiments, resumed }))
    }

    async fn list(&self, _: Request<v1::ListRequest>) -> Result<Response<v1::ListReply>, Status> {
        let ids = self.driver.lineage().reader().every().await.map_err(|error| read_status(&error))?;
        self.render_all(&ids).await
    }

    async fn get(&self, request: Request<v1::GetRequest>) -> Result<Response<v1::Experiment>, Status> {
        let reference = request.into_inner().experiment;
        let ids = self.find(&reference).await?;
        let [id] = ids[..] else {
            return Err(Status::invalid_argument(format!(
                "`{reference}` names {} experiments: name one by its number",
                ids.len()
            )));
        };
        let mut rendered = self.render(id).await?;
        let stored =
            self.driver.lineage().reader().experiment(id).await.map_err(|error| read_status(&error))?;
        rendered.resolved = stored.resolved;
        Ok(Response::new(rendered))
    }

    type WatchStream = Pin<Box<dyn Stream<Item = Result<v1::WatchEvent, Status>> + Send>>;

    async fn watch(
        &self,
        request: Request<v1::WatchRequest>,
    ) -> Result<Response<Self::WatchStream>, Status> {
        let ids: BTreeSet<_> =
            self.find(&request.into_inner().experiment).await?.into_iter().collect();
        let (events, stream) = mpsc::channel(64);
        let service = self.clone();
        tokio::spawn(async move {
            // A watcher that went away is no news.
            let _ = service.watch_until_ended(ids, events).await;
        });
        Ok(Response::new(Box::pin(ReceiverStream::new(stream))))
    }

    async fn pause(
        &self,
        request: Request<v1::ControlRequest>,
    ) -> Result<Response<v1::ListReply>, Status> {
        let ids = self.find(&request.into_inner().experiment).await?;
        for &id in &ids {
            self.driver.pause(id).await.map_err(|error| control_status(&error))?;
        }
        self.render_all(&ids).await
    }

    async fn resume(
        &self,
        request: Request<v1::ControlRequest>,
    ) -> Result<Response<v1::ListReply>, Status> {
        let ids = self.find(&request.into_inner().experiment).await?;
        for &id in &ids {
            self.driver.resume(id).await.map_err(|error| control_status(&error))?;
        }
        self.render_all(&ids).await
    }

    async fn cancel(
        &self,
        request: Request<v1::ControlRequest>,
    ) -> Result<Response<v1::ListReply>, Status> {
        let ids = self.find(&request.into_inner().experiment).await?;
        for &id in &ids {
            self.driver.cancel(id).await.map_err(|error| control_status(&error))?;
        }
        self.render_all(&ids).await
    }
}

fn render_generation(ended: Ended) -> v1::Generation {
    v1::Generation {
        run: ended.run,
        stage: ended.stage,
        stage_name: String::new(),
        generation: ended.generation,
        generations: ended.generations.unwrap_or(0),
        individuals: ended.tally.individuals,
        completed: ended.tally.completed,
        culled: ended.tally.culled,
        aborted: ended.tally.aborted,
        failed: ended.tally.failed,
        inherited: ended.inherited,
        best: ended.tally.best,
        mean: ended.tally.mean,
        worst: ended.tally.worst,
        best_individual: ended.best.map_or(0, |id| id.0),
        steps: ended.tally.steps,
        seconds: ended.seconds,
        notes: ended.notes,
    }
}

fn submit_status(error: &SubmitError) -> Status {
    match error {
        SubmitError::Problems(problems) => {
            let text = problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n");
            let details = v1::Problems { problems: problems.iter().map(render_problem).collect() };
            Status::with_details(Code::InvalidArgument, text, details.encode_to_vec().into())
        }
        SubmitError::Read(error) => read_status(error),
        SubmitError::Write(error) => write_status(error),
        SubmitError::Control(error) => control_status(error),
    }
}

fn render_problem(problem: &Problem) -> v1::Problem {
    v1::Problem {
        key: problem.key.clone(),
        message: problem.message.clone(),
        help: problem.help.clone().unwrap_or_default(),
        start: problem.span.as_ref().map(|span| span.start as u64),
        end: problem.span.as_ref().map(|span| span.end as u64),
        line: problem.line,
        column: problem.column,
    }
}

fn control_status(error: &ControlError) -> Status {
    match error {
        ControlError::Ended(..) | ControlError::Incompatible(..) => {
            Status::failed_precondition(error.to_string())
        }
        ControlError::Read(error) => read_status(error),
        ControlError::Write(error) => write_status(error),
    }
}

fn write_status(error: &WriteError) -> Status {
    match error {
        WriteError::Closed { .. } => Status::unavailable(error.to_string()),
        WriteError::Contradiction { .. } => Status::internal(error.to_string()),
    }
}


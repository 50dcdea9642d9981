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

use crate::driver::{
    AmendError, Changed, ControlError, Counts, Driver, Ended, Fork, ForkError, Happening, PickError,
    Submission, SubmitError,
};
use crate::lineage::{
    ExperimentId, IndividualId, Reader, RunProgress, State, StoredChoice, Summary, WriteError,
};
use crate::service::lineage::status;

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

    /// As a tonic server.
    pub fn into_server(self) -> v1::experiments_server::ExperimentsServer<Self> {
        v1::experiments_server::ExperimentsServer::new(self)
            .max_decoding_message_size(proto::MESSAGE_SIZE_MAX)
    }

    async fn find(&self, reference: &str) -> Result<Vec<ExperimentId>, Status> {
        self.driver.lineage().reader().find(reference).await.map_err(status)
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
        let summaries = self.driver.lineage().reader().summaries(ids).await.map_err(status)?;
        Ok(summaries
            .into_iter()
            .map(|summary| {
                let id = summary.id;
                let mut rendered = render_summary(summary);
                if let Some(progress) = self.driver.progress(id) {
                    bring_up_to_date(&mut rendered, &progress.counts());
                }
                if rendered.state == State::Running.word() && rendered.reason.is_empty() {
                    rendered.reason = self.driver.held_up();
                }
                rendered
            })
            .collect())
    }

    async fn reply(&self, ids: &[ExperimentId]) -> Result<Response<v1::ListReply>, Status> {
        Ok(Response::new(v1::ListReply { experiments: self.render_all(Some(ids)).await? }))
    }

    /// Sends a watcher what happens until every experiment has ended or waits for a pick, or nobody reads any
    /// more.
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
        let fleet = *self.driver.fleet().summary().borrow();
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
                let over =
                    ["finished", "cancelled", "failed", "awaiting"].contains(&experiment.state.as_str());
                send(events, id, v1::watch_event::What::State(experiment)).await?;
                // One that waited may go on while others are still watched.
                if over {
                    ended.insert(id);
                } else {
                    ended.remove(&id);
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
    async fn submit(&self, request: Request<v1::SubmitRequest>) -> Result<Response<v1::SubmitReply>, Status> {
        let request = request.into_inner();
        let resume = request.resume;
        let Changed { text, overrides } = file_of(request)?;
        let submission = Submission { text, overrides, resume };
        let (ids, resumed) = self.driver.submit(submission).await.map_err(submit_status)?;
        let experiments = self.render_all(Some(&ids)).await?;
        Ok(Response::new(v1::SubmitReply { experiments, resumed }))
    }

    async fn list(&self, _: Request<v1::ListRequest>) -> Result<Response<v1::ListReply>, Status> {
        Ok(Response::new(v1::ListReply { experiments: self.render_all(None).await? }))
    }

    async fn get(&self, request: Request<v1::GetRequest>) -> Result<Response<v1::Experiment>, Status> {
        let reader = self.driver.lineage().reader();
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
        let ids = self.find(&request.into_inner().experiment).await?;
        for &id in &ids {
            self.driver.pause(id).await.map_err(control_status)?;
        }
        self.reply(&ids).await
    }

    async fn resume(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        let ids = self.find(&request.into_inner().experiment).await?;
        for &id in &ids {
            self.driver.resume(id).await.map_err(control_status)?;
        }
        self.reply(&ids).await
    }

    async fn cancel(&self, request: Request<v1::ControlRequest>) -> Result<Response<v1::ListReply>, Status> {
        let ids = self.find(&request.into_inner().experiment).await?;
        for &id in &ids {
            self.driver.cancel(id).await.map_err(control_status)?;
        }
        self.reply(&ids).await
    }

    async fn candidates(
        &self,
        request: Request<v1::CandidatesRequest>,
    ) -> Result<Response<v1::CandidatesReply>, Status> {
        candidates(self.driver.lineage().reader(), request.into_inner()).await
    }

    async fn pick(&self, request: Request<v1::PickRequest>) -> Result<Response<v1::Experiment>, Status> {
        let v1::PickRequest { experiment, individual, note } = request.into_inner();
        let id = self.driver.lineage().reader().find_one(&experiment).await.map_err(status)?;
        self.driver.pick(id, IndividualId(individual), note).await.map_err(pick_status)?;
        Ok(Response::new(self.render(id).await?))
    }

    async fn amend(&self, request: Request<v1::AmendRequest>) -> Result<Response<v1::AmendReply>, Status> {
        let v1::AmendRequest { experiment, file } = request.into_inner();
        let id = self.driver.lineage().reader().find_one(&experiment).await.map_err(status)?;
        let file = file_of(file.unwrap_or_default())?;
        let differences = self.driver.amend(id, &file).await.map_err(amend_status)?;
        let experiment = Some(self.render(id).await?);
        Ok(Response::new(v1::AmendReply { experiment, differences }))
    }

    async fn fork(&self, request: Request<v1::ForkRequest>) -> Result<Response<v1::Experiment>, Status> {
        let fork = fork_of(self.driver.lineage().reader(), request.into_inner()).await?;
        let id = self.driver.fork(fork).await.map_err(fork_status)?;
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

fn render_choice(choice: StoredChoice) -> v1::Choice {
    let candidates = choice.candidates.into_iter().map(|one| v1::Candidate {
        rank: one.rank,
        individual: one.individual.0,
        population: one.population,
        fitness: one.fitness,
        notes: one.notes,
    });
    let picked = choice.picked;
    v1::Choice {
        run: choice.run,
        stage: choice.number,
        stage_name: choice.name,
        candidates: candidates.collect(),
        picked: picked.as_ref().map_or(0, |picked| picked.individual.0),
        picked_by: picked.as_ref().map(|picked| picked.by.clone()).unwrap_or_default(),
        note: picked.map(|picked| picked.note).unwrap_or_default(),
    }
}

/// An experiment as the lineage has it, for the wire; without its resolved file.
pub fn render_summary(summary: Summary) -> v1::Experiment {
    v1::Experiment {
        id: summary.id.0,
        name: summary.name,
        group: summary.group.unwrap_or_default(),
        system: summary.system,
        search: summary.search_kind,
        state: summary.state,
        reason: summary.reason,
        seed: summary.seed,
        runs: summary.runs,
        cell: summary.cell,
        created_ms: summary.created_ms,
        ended_ms: summary.ended_ms,
        individuals: summary.individuals,
        planned: summary.planned.unwrap_or(0),
        evaluated: summary.evaluated,
        culled: summary.culled,
        aborted: summary.aborted,
        failed: summary.failed,
        progress: summary.progress.into_iter().map(render_run).collect(),
        resolved: String::new(),
    }
}

fn render_run(run: RunProgress) -> v1::Run {
    v1::Run {
        run: run.run,
        stage: run.stage,
        stage_name: run.stage_name,
        generation: run.generation,
        generations: run.generations.unwrap_or(0),
        done: run.done,
        size: run.size,
        best: run.best.map(|(fitness, _)| fitness),
        best_individual: run.best.map_or(0, |(_, id)| id.0),
        finished: run.ended,
    }
}

/// Outcomes reach the lineage a moment after the driver.
fn bring_up_to_date(rendered: &mut v1::Experiment, counts: &Counts) {
    for run in &mut rendered.progress {
        let Some(live) = counts.runs.get(run.run as usize - 1) else { continue };
        if live.stage > run.stage {
            // Nothing of the stage was written yet when the lineage was read.
            (run.stage, run.stage_name) = (live.stage, live.stage_name.clone());
            (run.best, run.best_individual, run.generations) = (None, 0, live.generations.unwrap_or(0));
        }
        if (live.stage, live.generation) >= (run.stage, run.generation) {
            (run.generation, run.size, run.done) = (live.generation, live.size as u32, live.done as u32);
        }
        if let Some((best, fitness)) = live.best
            && live.stage == run.stage
            && run.best.is_none_or(|known| fitness > known)
        {
            (run.best, run.best_individual) = (Some(fitness), best.0);
        }
    }
}

fn render_generation(ended: Ended) -> v1::Generation {
    v1::Generation {
        run: ended.run,
        stage: ended.stage,
        stage_name: ended.stage_name,
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

fn problems_status(problems: &[Problem]) -> Status {
    let text = problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n");
    let details = v1::Problems { problems: problems.iter().map(render_problem).collect() };
    Status::with_details(Code::InvalidArgument, text, details.encode_to_vec().into())
}

/// The status of a changed file that was refused.
pub fn amend_status(error: AmendError) -> Status {
    match error {
        AmendError::Problems(problems) => problems_status(&problems),
        AmendError::Running(_) | AmendError::Ended(..) | AmendError::Refused(_) => {
            Status::failed_precondition(error.to_string())
        }
        AmendError::Control(error) => control_status(error),
        AmendError::Read(error) => status(error),
        AmendError::Write(error) => write_status(error),
    }
}

/// The status of a fork that was refused.
pub fn fork_status(error: ForkError) -> Status {
    match error {
        ForkError::NoStage { .. } => Status::not_found(error.to_string()),
        ForkError::NotEnded { .. } => Status::failed_precondition(error.to_string()),
        ForkError::Problems(problems) => problems_status(&problems),
        ForkError::Amend(error) => amend_status(error),
        ForkError::Control(error) => control_status(error),
        ForkError::Read(error) => status(error),
        ForkError::Write(error) => write_status(error),
    }
}

fn submit_status(error: SubmitError) -> Status {
    match error {
        SubmitError::Problems(problems) => problems_status(&problems),
        SubmitError::Read(error) => status(error),
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

fn control_status(error: ControlError) -> Status {
    match error {
        ControlError::Ended(..) | ControlError::Incompatible(..) => {
            Status::failed_precondition(error.to_string())
        }
        ControlError::Read(error) => status(error),
        ControlError::Write(error) => write_status(error),
    }
}

/// The status of a pick that was refused.
pub fn pick_status(error: PickError) -> Status {
    match error {
        PickError::NotAwaited(_) | PickError::NoCandidate { .. } | PickError::Ended(..) => {
            Status::failed_precondition(error.to_string())
        }
        PickError::Read(error) => status(error),
        PickError::Write(error) => write_status(error),
        PickError::Control(error) => control_status(error),
    }
}

fn write_status(error: WriteError) -> Status {
    match error {
        WriteError::Closed { .. } => Status::unavailable(error.to_string()),
        WriteError::Contradiction { .. } => Status::internal(error.to_string()),
    }
}

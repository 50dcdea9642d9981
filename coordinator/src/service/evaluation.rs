//! The bare service: genotypes in, fitness out, over the same fleet as experiments. Nothing is recorded, and
//! no more is read than may be under evaluation.

use crate::fleet::{Evaluation, Fleet, Queue, QueueOutput, Settled, TaskText};
use proto::v1::evaluate_reply::What as Answer;
use proto::v1::evaluate_request::What;
use proto::v1::evaluation_server::EvaluationServer;
use proto::{MESSAGE_SIZE_MAX, v1};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::metadata::MetadataValue;
use tonic::{Request, Response, Status, Streaming};

/// Genotypes of one stream that may be under evaluation at a time.
const LIMIT: usize = 1024;
/// No further one is read while they have so many bytes together.
const SIZE_MAX: usize = 64 << 20;
/// Answers that may wait for their caller to take them.
const ANSWERS_MAX: usize = 256;

/// The service over a fleet.
pub fn evaluation(fleet: Fleet) -> EvaluationServer<EvaluationService> {
    EvaluationServer::new(EvaluationService { fleet, streams: AtomicU64::new(0), ids: Arc::default() })
        .max_decoding_message_size(MESSAGE_SIZE_MAX)
        .max_encoding_message_size(MESSAGE_SIZE_MAX)
}

/// `hatchery.v1.Evaluation`.
#[derive(Debug)]
pub struct EvaluationService {
    fleet: Fleet,
    streams: AtomicU64,
    ids: Arc<AtomicU64>,
}

type Answers = mpsc::Sender<Result<v1::EvaluateReply, Status>>;

#[tonic::async_trait]
impl v1::evaluation_server::Evaluation for EvaluationService {
    type EvaluateStream = ReceiverStream<Result<v1::EvaluateReply, Status>>;

    async fn evaluate(
        &self,
        request: Request<Streaming<v1::EvaluateRequest>>,
    ) -> Result<Response<Self::EvaluateStream>, Status> {
        let number = self.streams.fetch_add(1, Ordering::Relaxed) + 1;
        let (queue, output) = self.fleet.queue(format!("bare stream {number}"), 1).await;
        let (answers, replies) = mpsc::channel(ANSWERS_MAX);
        let conversation = Conversation {
            queue,
            ids: self.ids.clone(),
            answers,
            task: None,
            order: 0,
            callers: BTreeMap::new(),
            size: 0,
        };
        tokio::spawn(conversation.hold(request.into_inner(), output));
        let mut response = Response::new(ReceiverStream::new(replies));
        response.metadata_mut().insert("x-hatchery-limit", MetadataValue::from(LIMIT));
        Ok(response)
    }
}

/// What is to be done, as the stream last said.
struct Current {
    task: Box<dyn creatures::Task>,
    text: Arc<TaskText>,
}

/// One stream.
struct Conversation {
    queue: Queue,
    ids: Arc<AtomicU64>,
    answers: Answers,
    task: Option<Current>,
    /// Genotypes read so far: they are handed out in that order.
    order: u64,
    /// The caller's ids of what is under evaluation and the sizes of the genotypes, by our ids.
    callers: BTreeMap<u64, (u64, usize)>,
    /// Sum of these sizes, bytes.
    size: usize,
}

/// The caller is gone, or was told why the stream ends.
struct Over;

impl Conversation {
    /// Reads and answers until everything that was sent is answered.
    async fn hold(mut self, mut incoming: Streaming<v1::EvaluateRequest>, mut output: QueueOutput) {
        let mut is_reading = true;
        while is_reading || !self.callers.is_empty() {
            let went = tokio::select! {
                settled = output.next() => match settled {
                    Some(settled) => self.answer(settled).await,
                    None => self.end(Status::unavailable("the coordinator goes away")).await,
                },
                request = incoming.message(), if is_reading && self.has_room() => match request {
                    Ok(Some(request)) => self.take(request).await,
                    Ok(None) => {
                        is_reading = false;
                        Ok(())
                    }
                    Err(_) => Err(Over), // the caller broke off
                },
                () = self.answers.closed() => Err(Over),
            };
            if went.is_err() {
                return; // which drops the output, and so cancels what is under evaluation
            }
        }
    }

    fn has_room(&self) -> bool {
        self.callers.len() < LIMIT && self.size < SIZE_MAX
    }

    async fn take(&mut self, request: v1::EvaluateRequest) -> Result<(), Over> {
        match request.what {
            Some(What::Task(task)) => match current(&task) {
                Ok(current) => self.task = Some(current),
                Err(status) => return self.end(status).await,
            },
            Some(What::Genotype(genotype)) => {
                let Some(current) = &self.task else {
                    return self.end(Status::failed_precondition("a task must come first")).await;
                };
                let caller = genotype.id;
                match read(genotype, current) {
                    Ok(evaluation) => self.submit(caller, evaluation).await,
                    Err(error) => return self.send(caller, Answer::Error(error)).await,
                }
            }
            None => {
                return self.end(Status::invalid_argument("a request with neither task nor genotype")).await;
            }
        }
        Ok(())
    }

    async fn submit(&mut self, caller: u64, evaluation: Evaluation) {
        let id = Evaluation::BARE | self.ids.fetch_add(1, Ordering::Relaxed);
        let order = (0, (self.order >> 32) as u32, self.order as u32);
        self.order += 1;
        let size = evaluation.genotype.len();
        self.size += size;
        self.callers.insert(id, (caller, size));
        self.queue.submit(vec![Evaluation { id, order, ..evaluation }]).await;
    }

    async fn answer(&mut self, settled: Vec<Settled>) -> Result<(), Over> {
        for one in settled {
            let Some((caller, size)) = self.callers.remove(&one.id) else { continue };
            self.size -= size;
            let answer = match one.result {
                Ok(outcome) => Answer::Outcome(outcome.into()),
                Err(aside) => Answer::Error(aside.to_string()),
            };
            self.send(caller, answer).await?;
        }
        Ok(())
    }

    async fn send(&self, id: u64, what: Answer) -> Result<(), Over> {
        self.answers.send(Ok(v1::EvaluateReply { id, what: Some(what) })).await.map_err(|_| Over)
    }

    async fn end(&self, status: Status) -> Result<(), Over> {
        // A caller that is gone needs no reason.
        let _ = self.answers.send(Err(status)).await;
        Err(Over)
    }
}

/// Reads a task: its system must be known in that version, and its table legal.
fn current(task: &v1::Task) -> Result<Current, Status> {
    task.verified().map_err(|error| error.within("task"))?;
    let system = creatures::system(&task.system).ok_or_else(|| {
        let known: Vec<_> = creatures::systems().iter().map(|system| system.name()).collect();
        Status::invalid_argument(format!(
            "`task.system` is `{}`, known are {}",
            task.system.escape_debug(),
            known.join(", ")
        ))
    })?;
    let known = system.version();
    if task.version != known {
        let side = if task.version < known { "caller" } else { "coordinator" };
        return Err(Status::failed_precondition(format!(
            "`task.version` is {}, this coordinator has version {known} of `{}`: upgrade the {side}",
            task.version, task.system
        )));
    }
    let invalid = |error: String| Status::invalid_argument(format!("`task.spec`: {error}"));
    let spec = serde_json::from_str(&task.spec).map_err(|error| invalid(error.to_string()))?;
    let resolved = system.resolve(spec).map_err(|error| invalid(error.to_string()))?.to_string();
    let text = Arc::new(TaskText::new(&task.system, known, &resolved));
    Ok(Current { task: system.task(&resolved).map_err(|error| invalid(error.to_string()))?, text })
}

/// Reads a genotype for a task. Its id and order are the conversation's to give.
fn read(request: v1::EvaluateGenotype, current: &Current) -> Result<Evaluation, String> {
    let genotype = request.genotype.ok_or("`genotype.genotype` is missing")?;
    let TaskText { system, version, .. } = &*current.text;
    if genotype.system != *system || genotype.version != *version {
        return Err(format!(
            "`genotype` is of version {} of `{}`, the task is of version {version} of `{system}`",
            genotype.version,
            genotype.system.escape_debug()
        ));
    }
    current.task.check(&genotype.payload).map_err(|error| chain(&error))?;
    let cull = request.cull.map(creatures::Cull::try_from).transpose();
    Ok(Evaluation {
        id: Evaluation::BARE,
        order: (0, 0, 0),
        task: current.text.clone(),
        // The payload is a slice of the whole message: kept by itself, so that the message can go.
        genotype: genotype.payload.to_vec().into(),
        seed: request.seed,
        cull: cull.map_err(|error| error.within("genotype.cull").to_string())?,
        audit: false,
        attempts_before: 0,
    })
}

/// An error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

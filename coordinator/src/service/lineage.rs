//! Questions to the lineage, over gRPC: parses, calls a reader, renders. It never writes.
//! It needs no coordinator: `hatchery --db FILE` serves it in its own process.

use crate::lineage::{
    Ancestor, Answer, Cell, ExperimentHash, ExperimentId, IndividualId, Limits, Link, Portrait, QueryError,
    ReadError, Reader,
};
use proto::v1;
use std::pin::Pin;
use std::time::Duration;
use tokio_stream::{Stream, StreamExt as _};
use tonic::{Request, Response, Status};

/// What users' SQL may cost where many share a coordinator.
pub const SHARED: Limits = Limits { rows: 1_000_000, bytes: 256 << 20, time: Duration::from_secs(30) };

/// What it may cost on one's own file.
pub const OWN: Limits = Limits { rows: u64::MAX, bytes: u64::MAX, time: Duration::from_secs(3600) };

/// What the documented views may cost, which are read whole: the reader's pace alone holds them back.
const VIEWS: Limits = Limits { rows: u64::MAX, bytes: u64::MAX, time: Duration::from_secs(600) };

/// The `Lineage` service over a reader.
#[derive(Clone)]
pub struct LineageService {
    reader: Reader,
    most: Limits,
}

impl LineageService {
    /// The service over a reader, within the limits of [`SHARED`].
    pub fn new(reader: Reader) -> Self {
        LineageService::within(reader, SHARED)
    }

    /// The service over a reader, with users' SQL within other limits.
    pub fn within(reader: Reader, most: Limits) -> Self {
        LineageService { reader, most }
    }

    /// As a tonic server.
    pub fn into_server(self) -> v1::lineage_server::LineageServer<Self> {
        v1::lineage_server::LineageServer::new(self).max_decoding_message_size(proto::MESSAGE_SIZE_MAX)
    }

    async fn find(&self, reference: &str) -> Result<Option<Vec<ExperimentId>>, ReadError> {
        if reference.is_empty() { Ok(None) } else { self.reader.find(reference).await.map(Some) }
    }
}

type Replies<T> = Pin<Box<dyn Stream<Item = Result<T, Status>> + Send>>;

#[tonic::async_trait]
impl v1::lineage_server::Lineage for LineageService {
    type QueryStream = Replies<v1::QueryReply>;
    type AncestryStream = Replies<v1::Ancestor>;

    async fn query(&self, request: Request<v1::QueryRequest>) -> Result<Response<Self::QueryStream>, Status> {
        let v1::QueryRequest { what, row_limit, timeout_ms } = request.into_inner();
        let asked = |most: Limits| Limits {
            rows: if row_limit == 0 { most.rows } else { most.rows.min(row_limit) },
            bytes: most.bytes,
            time: match timeout_ms {
                0 => most.time,
                asked => most.time.min(Duration::from_millis(asked.into())),
            },
        };
        let answer = match what {
            Some(v1::query_request::What::Sql(sql)) => {
                self.reader.query(&sql, asked(self.most)).await.map_err(query_status)?
            }
            Some(v1::query_request::What::View(v1::View { name, experiment })) => {
                let of = self.find(&experiment).await.map_err(status)?;
                self.reader.view(&name, of.as_deref(), asked(VIEWS)).await.map_err(query_status)?
            }
            None => return Err(Status::invalid_argument("neither sql nor a view was named")),
        };
        Ok(Response::new(Box::pin(replies(answer))))
    }

    async fn individual(
        &self,
        request: Request<v1::IndividualRequest>,
    ) -> Result<Response<v1::IndividualReply>, Status> {
        let id = IndividualId(request.into_inner().individual);
        let portrait = self.reader.individual(id).await.map_err(status)?;
        Ok(Response::new(individual(portrait, true)))
    }

    async fn ancestry(
        &self,
        request: Request<v1::AncestryRequest>,
    ) -> Result<Response<Self::AncestryStream>, Status> {
        let v1::AncestryRequest { individual, depth, line } = request.into_inner();
        let ancestors = self.reader.ancestry(IndividualId(individual), depth, line).await.map_err(status)?;
        Ok(Response::new(Box::pin(tokio_stream::iter(ancestors).map(|one| Ok(ancestor(one))))))
    }

    async fn best(&self, request: Request<v1::BestRequest>) -> Result<Response<v1::BestReply>, Status> {
        let v1::BestRequest { experiment, limit } = request.into_inner();
        let mut individuals = Vec::new();
        for experiment in self.reader.find(&experiment).await.map_err(status)? {
            for id in self.reader.best(experiment, limit.clamp(1, 10_000)).await.map_err(status)? {
                let portrait = self.reader.individual(id).await.map_err(status)?;
                individuals.push(self::individual(portrait, false));
            }
        }
        Ok(Response::new(v1::BestReply { individuals }))
    }

    async fn hash(&self, request: Request<v1::HashRequest>) -> Result<Response<v1::HashReply>, Status> {
        let mut hashes = Vec::new();
        for experiment in self.reader.find(&request.into_inner().experiment).await.map_err(status)? {
            let ExperimentHash { experiment, name, hash, individuals, finished } =
                self.reader.hash(experiment).await.map_err(status)?;
            let hash = hash.to_vec().into();
            hashes.push(v1::ExperimentHash { experiment: experiment.0, name, hash, individuals, finished });
        }
        Ok(Response::new(v1::HashReply { hashes }))
    }
}

/// Columns first, then rows as they come.
fn replies(mut answer: Answer) -> impl Stream<Item = Result<v1::QueryReply, Status>> + Send {
    let columns = std::mem::take(&mut answer.columns);
    let head = v1::QueryReply { columns, rows: Vec::new() };
    tokio_stream::once(Ok(head)).chain(Rows(answer))
}

struct Rows(Answer);

impl Stream for Rows {
    type Item = Result<v1::QueryReply, Status>;

    fn poll_next(
        mut self: Pin<&mut Self>,
        context: &mut std::task::Context<'_>,
    ) -> std::task::Poll<Option<Self::Item>> {
        self.0.poll_next(context).map(|chunk| {
            chunk.map(|chunk| {
                let rows = chunk.map_err(query_status)?.into_iter().map(row).collect();
                Ok(v1::QueryReply { columns: Vec::new(), rows })
            })
        })
    }
}

fn row(cells: Vec<Cell>) -> v1::Row {
    let value = |cell| v1::Value {
        kind: match cell {
            Cell::Null => None,
            Cell::Integer(integer) => Some(v1::value::Kind::Integer(integer)),
            Cell::Real(real) => Some(v1::value::Kind::Real(real)),
            Cell::Text(text) => Some(v1::value::Kind::Text(text)),
            Cell::Blob(bytes) => Some(v1::value::Kind::Blob(bytes.into())),
        },
    };
    v1::Row { values: cells.into_iter().map(value).collect() }
}

fn individual(portrait: Portrait, with_genotype: bool) -> v1::IndividualReply {
    let digest = blake3::hash(&portrait.genotype).as_bytes().to_vec().into();
    v1::IndividualReply {
        id: portrait.id.0,
        experiment: portrait.experiment.0,
        experiment_name: portrait.experiment_name,
        run: portrait.run,
        stage: portrait.place.stage,
        stage_name: portrait.stage_name,
        generation: portrait.place.generation,
        index: portrait.place.index,
        operator: portrait.operator,
        status: portrait.status,
        fitness: portrait.fitness,
        note: portrait.note,
        traits: portrait.traits,
        measures: portrait.measures,
        genotype: with_genotype.then(|| v1::Genotype {
            system: portrait.system,
            version: portrait.system_version,
            payload: portrait.genotype.into(),
        }),
        digest,
        task: portrait.task_json,
        seed: portrait.seed,
        cull: portrait.cull.map(Into::into),
        interim: portrait.interim.map(Into::into),
        steps: portrait.steps.into(),
        parents: portrait.parents.into_iter().map(link).collect(),
        attempts: portrait
            .attempts
            .into_iter()
            .map(|attempt| v1::AttemptInfo {
                number: attempt.number,
                worker: attempt.worker,
                fate: attempt.fate,
                steps: attempt.steps.into(),
                seconds: attempt.seconds,
            })
            .collect(),
        inherits: portrait.inherits.map_or(0, |giver| giver.0),
        children: portrait.children,
    }
}

fn ancestor(ancestor: Ancestor) -> v1::Ancestor {
    v1::Ancestor {
        id: ancestor.id.0,
        depth: ancestor.depth,
        stage: ancestor.place.stage,
        generation: ancestor.place.generation,
        index: ancestor.place.index,
        operator: ancestor.operator,
        status: ancestor.status,
        fitness: ancestor.fitness,
        parents: ancestor.parents.into_iter().map(link).collect(),
    }
}

fn link(Link { parent, role }: Link) -> v1::ParentLink {
    v1::ParentLink { parent: parent.0, role }
}

/// From a reader's error to a status. UNAVAILABLE: ask again.
pub fn status(error: ReadError) -> Status {
    let text = error.to_string();
    match error {
        ReadError::NotFound { .. } => Status::not_found(text),
        ReadError::Ambiguous { .. } => Status::invalid_argument(text),
        ReadError::Corrupt { .. } => Status::data_loss(text),
        ReadError::Unavailable(cause) => Status::unavailable(format!("{text}: {cause}")),
    }
}

fn query_status(error: QueryError) -> Status {
    match error {
        QueryError::Malformed(text) => Status::invalid_argument(text),
        QueryError::Forbidden(text) => Status::permission_denied(text),
        QueryError::TooMuch(text) => Status::resource_exhausted(text),
        QueryError::Read(error) => status(error),
    }
}

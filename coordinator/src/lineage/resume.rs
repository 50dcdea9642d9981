//! What a coordinator needs to take up where another one stopped: unfinished experiments, and where each
//! stage goes on.

use super::genotype::{DIGEST, digest};
use super::outcome::{Columns, Known};
use super::sql::sql;
use super::{Culling, ExperimentId, IndividualId, Origin, ReadError, Reader, SetAside, StageId, State};
use creatures::Outcome;
use sqlx::sqlite::SqliteConnection;

/// The largest checkpoint that is believed, bytes: what is allocated on the word of a row.
const CHECKPOINT_MAX: usize = 1 << 30;

/// An experiment as it stands in the lineage, with all that is needed to take it up again.
#[derive(Debug, Clone)]
pub struct StoredExperiment {
    /// Its number.
    pub id: ExperimentId,
    /// Its name, unique.
    pub name: String,
    /// The matrix that it is a cell of.
    pub group: Option<String>,
    /// Its matrix coordinates: a JSON object.
    pub cell: serde_json::Value,
    /// The system's name.
    pub system: String,
    /// The system's version.
    pub system_version: u32,
    /// The kind of its search.
    pub search_kind: String,
    /// The seed of run 1.
    pub seed: u64,
    /// Independent repetitions.
    pub runs: u32,
    /// JSON text of the resolved task.
    pub task_json: String,
    /// The resolved file.
    pub resolved: String,
    /// BLAKE3 of the resolved file.
    pub digest: [u8; 32],
    /// Published results to compare with.
    pub published: serde_json::Value,
    /// The physics fingerprint under which it began.
    pub fingerprint: [u8; 32],
    /// What it is up to.
    pub state: State,
    /// Why; may be empty.
    pub reason: String,
    /// Unix time, ms.
    pub created_ms: i64,
    /// Unix time, ms.
    pub ended_ms: Option<i64>,
    /// Individuals in all, when the search knows.
    pub planned: Option<u64>,
    /// Whose first stages are its own as well.
    pub origin: Option<Origin>,
    /// Its own, in order of run and stage.
    pub stages: Vec<StoredStage>,
}

/// A stage as it stands in the lineage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredStage {
    /// Its row.
    pub id: StageId,
    /// Which repetition, from 1.
    pub run: u32,
    /// Which stage of the run, from 0.
    pub stage: u32,
    /// Its name.
    pub name: String,
    /// How many generations it takes, when known.
    pub generations: Option<u32>,
    /// True once its last generation has ended.
    pub ended: bool,
    /// True if the run has ended with it.
    pub over: bool,
    /// Its latest generation; 0 before the first.
    pub latest: u32,
}

/// Where a stage goes on: its open generation.
#[derive(Debug, Clone)]
pub struct ResumePoint {
    /// Its number.
    pub generation: u32,
    /// JSON text of the stage's own task; `None` for the experiment's.
    pub task_json: Option<String>,
    /// The culling rule of this generation.
    pub culling: Option<Culling>,
    /// In order of index.
    pub individuals: Vec<Standing>,
    /// The previous generation of the stage, in order of index; empty for the first.
    pub previous: Vec<Standing>,
}

/// How one individual stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// Its id.
    pub id: IndividualId,
    /// Its index in its generation.
    pub index: u32,
    /// What its genotype is known by: see [`Standing::has`].
    digest: [u8; DIGEST],
    /// What became of it; `None` while pending.
    pub ending: Option<Result<Outcome, SetAside>>,
}

impl Standing {
    /// Whether this is its genotype.
    pub fn has(&self, genotype: &[u8]) -> bool {
        digest(genotype) == self.digest
    }
}

#[derive(sqlx::FromRow)]
struct ExperimentRow {
    id: i64,
    name: String,
    group: Option<String>,
    cell: String,
    system: String,
    system_version: u32,
    search: String,
    seed: i64,
    runs: u32,
    task: String,
    resolved: String,
    digest: Vec<u8>,
    published: String,
    fingerprint: Vec<u8>,
    state: String,
    reason: String,
    created_ms: i64,
    ended_ms: Option<i64>,
    planned: Option<i64>,
    origin: Option<i64>,
    origin_stage: Option<u32>,
}

#[derive(sqlx::FromRow)]
struct StageRow {
    id: i64,
    run: u32,
    number: u32,
    name: String,
    generations: Option<u32>,
    ended: bool,
    over: bool,
    latest: u32,
}

#[derive(sqlx::FromRow)]
struct OpenGenerationRow {
    number: u32,
    first: i64,
    size: u32,
    cull_at: Option<f64>,
    cutoff: Option<f64>,
    task: Option<String>,
}

#[derive(sqlx::FromRow)]
struct StandingRow {
    id: i64,
    digest: Vec<u8>,
    #[sqlx(flatten)]
    outcome: Columns,
}

impl Reader {
    /// Every experiment that can still go on, in order of number.
    ///
    /// # Errors
    /// See [`ReadError`], here and below.
    pub async fn unfinished(&self) -> Result<Vec<StoredExperiment>, ReadError> {
        let ids: Vec<i64> = sqlx::query_scalar(sql!("unfinished")).fetch_all(self.pool()).await?;
        let mut unfinished = Vec::with_capacity(ids.len());
        for id in ids {
            unfinished.push(self.experiment(ExperimentId::of(id)).await?);
        }
        Ok(unfinished)
    }

    /// One experiment.
    pub async fn experiment(&self, id: ExperimentId) -> Result<StoredExperiment, ReadError> {
        let row: Option<ExperimentRow> =
            sqlx::query_as(sql!("experiment")).bind(id.sql()).fetch_optional(self.pool()).await?;
        let not_found = || ReadError::NotFound { what: "experiment", reference: id.to_string() };
        let row = row.ok_or_else(not_found)?;
        let stages: Vec<StageRow> =
            sqlx::query_as(sql!("stages")).bind(id.sql()).fetch_all(self.pool()).await?;
        let damaged = |what: &str| ReadError::Corrupt { problem: format!("{what} of experiment {id}") };
        let json = |text: &str, what| serde_json::from_str(text).map_err(|_| damaged(what));
        let hash = |bytes: Vec<u8>, what| bytes.try_into().map_err(|_| damaged(what));
        let state = State::ALL.into_iter().find(|state| state.word() == row.state);
        Ok(StoredExperiment {
            id: ExperimentId::of(row.id),
            name: row.name,
            group: row.group,
            cell: json(&row.cell, "cell")?,
            system: row.system,
            system_version: row.system_version,
            search_kind: row.search,
            seed: row.seed.cast_unsigned(),
            runs: row.runs,
            task_json: row.task,
            resolved: row.resolved,
            digest: hash(row.digest, "digest")?,
            published: json(&row.published, "published results")?,
            fingerprint: hash(row.fingerprint, "fingerprint")?,
            state: state.ok_or_else(|| damaged("state"))?,
            reason: row.reason,
            created_ms: row.created_ms,
            ended_ms: row.ended_ms,
            planned: row.planned.map(i64::cast_unsigned),
            origin: row
                .origin
                .zip(row.origin_stage)
                .map(|(id, stage)| Origin { experiment: ExperimentId::of(id), stage }),
            stages: stages.into_iter().map(StoredStage::from).collect(),
        })
    }

    /// The latest unfinished experiment of a resolved file.
    pub async fn find_unfinished(&self, digest: &[u8; 32]) -> Result<Option<ExperimentId>, ReadError> {
        let query = sqlx::query_scalar(sql!("find_unfinished")).bind(&digest[..]);
        Ok(query.fetch_optional(self.pool()).await?.map(ExperimentId::of))
    }

    /// The latest finished experiment of a resolved file among the cells of another's matrix.
    pub async fn find_finished(
        &self,
        beside: ExperimentId,
        digest: &[u8; 32],
    ) -> Result<Option<ExperimentId>, ReadError> {
        let query = sqlx::query_scalar(sql!("find_finished")).bind(beside.sql()).bind(&digest[..]);
        Ok(query.fetch_optional(self.pool()).await?.map(ExperimentId::of))
    }

    /// Where a stage goes on; `None` when it has no generation yet, or has ended.
    pub async fn resume_point(&self, stage: StageId) -> Result<Option<ResumePoint>, ReadError> {
        let mut transaction = self.pool().begin().await?; // one state of the file
        let open: Option<OpenGenerationRow> = sqlx::query_as(sql!("open_generation"))
            .bind(stage.sql())
            .fetch_optional(&mut *transaction)
            .await?;
        let Some(open) = open else { return Ok(None) };
        let individuals = standings(&mut transaction, open.first, open.size).await?;
        let previous = generation(&mut transaction, stage, open.number - 1).await?;
        let culling = open.cull_at.map(|at| Culling { at, cutoff: open.cutoff });
        let (generation, task_json) = (open.number, open.task);
        Ok(Some(ResumePoint { generation, task_json, culling, individuals, previous }))
    }

    /// How the individuals of a generation stand, in order of index; none if there is no such generation.
    pub async fn standings(&self, stage: StageId, number: u32) -> Result<Vec<Standing>, ReadError> {
        let mut connection = self.pool().acquire().await?;
        generation(&mut connection, stage, number).await
    }

    /// The search's state before it asked for a generation of a stage; of a stage that has ended, also the
    /// one after its last. `None` where none was kept.
    ///
    /// # Errors
    /// [`ReadError::Corrupt`] also for one that is truncated, or is not what was saved (ESP EF-13).
    pub async fn checkpoint(&self, stage: StageId, generation: u32) -> Result<Option<Vec<u8>>, ReadError> {
        let query = sqlx::query_as(sql!("checkpoint")).bind(stage.sql()).bind(generation);
        let row: Option<(i64, Vec<u8>, Vec<u8>)> = query.fetch_optional(self.pool()).await?;
        let Some((size, digest, state)) = row else { return Ok(None) };
        let state = unframe(&state, size)?;
        if blake3::hash(&state).as_bytes()[..] != digest {
            return Err(ReadError::Corrupt { problem: "a checkpoint has another checksum".to_owned() });
        }
        Ok(Some(state))
    }

    /// Names of workers that are trusted no more.
    pub async fn quarantined(&self) -> Result<Vec<String>, ReadError> {
        Ok(sqlx::query_scalar(sql!("quarantined_names")).fetch_all(self.pool()).await?)
    }

    /// Outcomes of an experiment, in generations that have ended, which rest on the word of workers of one name.
    pub async fn unaudited(&self, experiment: ExperimentId, worker: &str) -> Result<u64, ReadError> {
        let query = sqlx::query_scalar::<_, i64>(sql!("unaudited")).bind(experiment.sql()).bind(worker);
        Ok(query.fetch_one(self.pool()).await?.cast_unsigned())
    }
}

impl From<StageRow> for StoredStage {
    fn from(row: StageRow) -> Self {
        StoredStage {
            id: StageId::of(row.id),
            run: row.run,
            stage: row.number,
            name: row.name,
            generations: row.generations,
            ended: row.ended,
            over: row.over,
            latest: row.latest,
        }
    }
}

async fn generation(
    connection: &mut SqliteConnection,
    stage: StageId,
    number: u32,
) -> Result<Vec<Standing>, ReadError> {
    let query = sqlx::query_as(sql!("generation")).bind(stage.sql()).bind(number);
    let found: Option<(i64, u32)> = query.fetch_optional(&mut *connection).await?;
    match found {
        Some((first, size)) => standings(connection, first, size).await,
        None => Ok(Vec::new()),
    }
}

async fn standings(
    connection: &mut SqliteConnection,
    first: i64,
    size: u32,
) -> Result<Vec<Standing>, ReadError> {
    let rows: Vec<StandingRow> = sqlx::query_as(sql!("standings"))
        .bind(first)
        .bind(first + i64::from(size) - 1)
        .fetch_all(connection)
        .await?;
    if rows.len() != size as usize {
        return Err(ReadError::Corrupt { problem: format!("{} of {size} individuals", rows.len()) });
    }
    let standing = |(index, row): (u32, StandingRow)| -> Result<Standing, ReadError> {
        let id = IndividualId::of(row.id);
        let damaged = |problem| ReadError::Corrupt { problem: format!("individual {id}: {problem}") };
        let ending: Known = row.outcome.read().map_err(damaged)?;
        let digest =
            row.digest.try_into().map_err(|_| damaged("its digest is of another length".to_owned()))?;
        Ok(Standing { id, index, digest, ending })
    };
    (0..).zip(rows).map(standing).collect()
}

fn unframe(state: &[u8], size: i64) -> Result<Vec<u8>, ReadError> {
    let damaged = || ReadError::Corrupt { problem: "a checkpoint does not decompress".to_owned() };
    let size = usize::try_from(size).ok().filter(|size| *size <= CHECKPOINT_MAX).ok_or_else(damaged)?;
    match zstd::bulk::decompress(state, size) {
        Ok(checkpoint) if checkpoint.len() == size => Ok(checkpoint),
        _ => Err(damaged()),
    }
}

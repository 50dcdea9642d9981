//! One individual with all that is needed to live it again.

use super::sql::sql;
use super::summary::id_list;
use super::{ExperimentId, IndividualId, ReadError, Reader, evaluation_seed, genotype};
use creatures::{Cull, Interim};
use search::Place;
use sqlx::sqlite::SqliteConnection;

/// An individual as it stands in the lineage.
#[derive(Debug, Clone, PartialEq)]
pub struct Portrait {
    /// Its id.
    pub id: IndividualId,
    /// Its experiment.
    pub experiment: ExperimentId,
    /// The name of its experiment.
    pub experiment_name: String,
    /// Which repetition, from 1.
    pub run: u32,
    /// The name of its stage.
    pub stage_name: String,
    /// Where it stands in its run.
    pub place: Place,
    /// How it was made.
    pub operator: String,
    /// `completed`, `culled`, `aborted:REASON`, `failed` or `pending`.
    pub status: String,
    /// To the bit; `None` while pending and for failed ones.
    pub fitness: Option<f64>,
    /// Which quantity ended it, or why it was set aside; may be empty.
    pub note: String,
    /// What people ask about: a JSON object.
    pub traits: String,
    /// What else was measured: a JSON object in the task's order; empty text while pending.
    pub measures: String,
    /// Physics steps of its evaluation.
    pub steps: u64,
    /// Its interim report, if one was made.
    pub interim: Option<Interim>,
    /// The culling rule as it was ruled on, of inherited outcomes that of the giver.
    pub cull: Option<Cull>,
    /// The system's name.
    pub system: String,
    /// The system's version.
    pub system_version: u32,
    /// JSON text of the resolved task.
    pub task_json: String,
    /// The seed of its evaluation, of inherited outcomes that of the giver's.
    pub seed: u64,
    /// BLAKE3 of its genotype.
    pub digest: [u8; 32],
    /// In the search's order.
    pub parents: Vec<Link>,
    /// Every attempt in order, with the worker's name and the fate as a word.
    pub attempts: Vec<AttemptLine>,
    /// Whose outcome it took over.
    pub inherits: Option<IndividualId>,
    /// How many children it has.
    pub children: u64,
}

/// A parent and the part it played.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    /// The parent.
    pub parent: IndividualId,
    /// `first`, `second` or `only`.
    pub role: String,
}

/// One attempt, as people read it.
#[derive(Debug, Clone, PartialEq, sqlx::FromRow)]
pub struct AttemptLine {
    /// Counts up from 1.
    pub number: u32,
    /// The worker's name; empty if unknown.
    pub worker: String,
    /// `counted`, `duplicate`, `lost:REASON`, `failed:REASON`.
    pub fate: String,
    /// Physics steps simulated.
    pub steps: u32,
    /// Spent on it.
    pub seconds: f64,
}

#[derive(sqlx::FromRow)]
struct IndividualRow {
    id: i64,
    experiment: i64,
    experiment_name: String,
    run: u32,
    stage: u32,
    stage_name: String,
    generation: u32,
    idx: u32,
    operator: String,
    fitness_bits: Option<i64>,
    traits: String,
    measures: Option<String>,
    steps: Option<i64>,
    interim_step: Option<u32>,
    interim_measure: Option<f64>,
    verdict: Option<String>,
    note: String,
    inherits: Option<i64>,
    status: String,
    run_seed: i64,
    cull_at: Option<f64>,
    cutoff: Option<f64>,
    system: String,
    system_version: u32,
    task: String,
    digest: Vec<u8>,
    children: i64,
}

#[derive(sqlx::FromRow)]
pub(super) struct GenotypeRow {
    pub(super) size: i64,
    pub(super) bytes: Vec<u8>,
}

impl IndividualRow {
    fn place(&self) -> Place {
        Place { stage: self.stage, generation: self.generation, index: self.idx }
    }

    fn cull(&self) -> Option<Cull> {
        // The control sample is known by its verdict: elsewhere it makes no difference.
        let control = self.verdict.as_deref() == Some("spare");
        self.cull_at.map(|at| Cull { at, cutoff: self.cutoff, control })
    }
}

impl Reader {
    /// One individual.
    ///
    /// # Errors
    /// See [`ReadError`], here and below.
    pub async fn individual(&self, id: IndividualId) -> Result<Portrait, ReadError> {
        let mut transaction = self.pool().begin().await?; // one state of the file
        let row = row(&mut transaction, id).await?;
        let giver: Option<i64> =
            sqlx::query_scalar(sql!("giver")).bind(id.sql()).fetch_optional(&mut *transaction).await?;
        let evaluated = match giver.filter(|giver| *giver != row.id) {
            Some(giver) => Some(self::row(&mut transaction, IndividualId::of(giver)).await?),
            None => None,
        };
        let evaluated = evaluated.as_ref().unwrap_or(&row);
        let (seed, cull) =
            (evaluation_seed(evaluated.run_seed.cast_unsigned(), evaluated.place()), evaluated.cull());
        let links: Vec<(i64, String)> =
            sqlx::query_as(sql!("links")).bind(id.sql()).fetch_all(&mut *transaction).await?;
        let attempts = sqlx::query_as(sql!("attempts")).bind(id.sql()).fetch_all(&mut *transaction).await?;
        let measure = row.interim_measure.unwrap_or(f64::NAN);
        let digest = row.digest.clone().try_into();
        Ok(Portrait {
            id,
            experiment: ExperimentId::of(row.experiment),
            place: row.place(),
            experiment_name: row.experiment_name,
            run: row.run,
            stage_name: row.stage_name,
            operator: row.operator,
            status: row.status,
            fitness: row.fitness_bits.map(|bits| f64::from_bits(bits.cast_unsigned())),
            note: row.note,
            traits: row.traits,
            measures: row.measures.unwrap_or_default(),
            steps: row.steps.unwrap_or(0).cast_unsigned(),
            interim: row.interim_step.map(|step| Interim { step, measure }),
            cull,
            system: row.system,
            system_version: row.system_version,
            task_json: row.task,
            seed,
            digest: digest.map_err(|_| damaged(id, "its digest is not 32 bytes long"))?,
            parents: links
                .into_iter()
                .map(|(parent, role)| Link { parent: IndividualId::of(parent), role })
                .collect(),
            attempts,
            inherits: row.inherits.map(IndividualId::of),
            children: row.children.cast_unsigned(),
        })
    }

    /// The canonical bytes of an individual's genotype, checked against their digest.
    pub async fn genotype(&self, id: IndividualId) -> Result<Vec<u8>, ReadError> {
        let mut connection = self.pool().acquire().await.map_err(ReadError::from)?;
        let bytes = genotype(&mut connection, id).await?;
        let digest: Vec<u8> =
            sqlx::query_scalar(sql!("digest")).bind(id.sql()).fetch_one(&mut *connection).await?;
        if digest != blake3::hash(&bytes).as_bytes() {
            return Err(damaged(id, "its genotype is not the one of its digest"));
        }
        Ok(bytes)
    }

    /// The best individuals of an experiment, best first, the earliest of equals, each outcome once: of its
    /// latest stage, since the fitness of different stages does not compare.
    pub async fn best(&self, experiment: ExperimentId, limit: u32) -> Result<Vec<IndividualId>, ReadError> {
        let query = sqlx::query_scalar(sql!("best")).bind(id_list(&[experiment])).bind(limit);
        let ids: Vec<i64> = query.fetch_all(self.pool()).await?;
        Ok(ids.into_iter().map(IndividualId::of).collect())
    }
}

async fn row(connection: &mut SqliteConnection, id: IndividualId) -> Result<IndividualRow, ReadError> {
    let query = sqlx::query_as(sql!("individual")).bind(id.sql());
    let not_found = || ReadError::NotFound { what: "individual", reference: id.to_string() };
    query.fetch_optional(connection).await?.ok_or_else(not_found)
}

/// A genotype unpacked, from the full copy that it rests on down to itself.
pub(super) async fn genotype(
    connection: &mut SqliteConnection,
    id: IndividualId,
) -> Result<Vec<u8>, ReadError> {
    let chain: Vec<GenotypeRow> =
        sqlx::query_as(sql!("genotype_chain")).bind(id.sql()).fetch_all(connection).await?;
    let mut bytes: Option<Vec<u8>> = None;
    for row in chain {
        let size = usize::try_from(row.size).map_err(|_| damaged(id, "its genotype has no size"))?;
        let unpacked = genotype::unpack(row.bytes, size, bytes.as_deref());
        bytes = Some(unpacked.map_err(|problem| damaged(id, &problem))?);
    }
    bytes.ok_or_else(|| ReadError::NotFound { what: "individual", reference: id.to_string() })
}

pub(super) fn damaged(id: IndividualId, problem: &str) -> ReadError {
    ReadError::Corrupt { problem: format!("individual {id}: {problem}") }
}

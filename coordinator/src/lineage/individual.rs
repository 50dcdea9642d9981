//! One individual with all that is needed to live it again.

use super::outcome::{Columns, object};
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
    pub steps: u32,
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
    /// Canonical bytes, checked against their digest.
    pub genotype: Vec<u8>,
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
    standing: String,
    traits: String,
    verdict: Option<String>,
    inherits: Option<i64>,
    run_seed: i64,
    cull_at: Option<f64>,
    cutoff: Option<f64>,
    system: String,
    system_version: u32,
    task: String,
    digest: Vec<u8>,
    children: i64,
    #[sqlx(flatten)]
    outcome: Columns,
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
        let genotype = genotype(&mut transaction, id).await?;
        if row.digest != genotype::digest(&genotype) {
            return Err(damaged(id, "its genotype is not the one of its digest"));
        }
        let known = row.outcome.read().map_err(|problem| damaged(id, &problem))?;
        let (outcome, set_aside) = match known {
            Some(Ok(outcome)) => (Some(outcome), None),
            Some(Err(set_aside)) => (None, Some(set_aside.reason)),
            None => (None, None),
        };
        Ok(Portrait {
            id,
            experiment: ExperimentId::of(row.experiment),
            place: row.place(),
            experiment_name: row.experiment_name,
            run: row.run,
            stage_name: row.stage_name,
            operator: row.operator,
            status: row.standing,
            fitness: outcome.as_ref().map(|outcome| outcome.fitness),
            note: set_aside
                .or_else(|| outcome.as_ref().map(|outcome| outcome.note.clone()))
                .unwrap_or_default(),
            traits: row.traits,
            measures: outcome.as_ref().map(|outcome| object(&outcome.measures)).unwrap_or_default(),
            steps: outcome.as_ref().map_or(0, |outcome| outcome.steps),
            interim: outcome.and_then(|outcome| outcome.interim),
            cull,
            system: row.system,
            system_version: row.system_version,
            task_json: row.task,
            seed,
            genotype,
            parents: links
                .into_iter()
                .map(|(parent, role)| Link { parent: IndividualId::of(parent), role })
                .collect(),
            attempts,
            inherits: row.inherits.map(IndividualId::of),
            children: row.children.cast_unsigned(),
        })
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

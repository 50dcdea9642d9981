//! How experiments stand, for those who list and watch them.

use super::sql::sql;
use super::{ExperimentId, IndividualId, ReadError, Reader};

/// How an experiment stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Its number.
    pub id: ExperimentId,
    /// Its name.
    pub name: String,
    /// The matrix that it is a cell of.
    pub group: Option<String>,
    /// Its matrix coordinates: JSON.
    pub cell: String,
    /// The system's name.
    pub system: String,
    /// The kind of its search.
    pub search_kind: String,
    /// As a word: see [`super::State`].
    pub state: String,
    /// Why; may be empty.
    pub reason: String,
    /// The seed of run 1.
    pub seed: u64,
    /// Independent repetitions.
    pub runs: u32,
    /// Unix time, ms.
    pub created_ms: i64,
    /// Unix time, ms.
    pub ended_ms: Option<i64>,
    /// Asked for so far.
    pub individuals: u64,
    /// In all, when the search knows.
    pub planned: Option<u64>,
    /// With an outcome.
    pub evaluated: u64,
    /// Of these, culled.
    pub culled: u64,
    /// Of these, aborted.
    pub aborted: u64,
    /// Of these, set aside.
    pub failed: u64,
    /// Those runs that have begun, in order.
    pub progress: Vec<RunProgress>,
}

/// How one run stands: in its latest stage.
#[derive(Debug, Clone, PartialEq)]
pub struct RunProgress {
    /// Which repetition, from 1.
    pub run: u32,
    /// Which stage, from 0.
    pub stage: u32,
    /// Its name.
    pub stage_name: String,
    /// The generation under evaluation, or the last one; 0 before the first.
    pub generation: u32,
    /// How many the stage takes, when known.
    pub generations: Option<u32>,
    /// Individuals of that generation with an outcome.
    pub done: u32,
    /// Individuals of that generation.
    pub size: u32,
    /// The best of the stage so far.
    pub best: Option<(f64, IndividualId)>,
    /// True once the stage has ended.
    pub ended: bool,
}

#[derive(sqlx::FromRow)]
struct SummaryRow {
    id: i64,
    name: String,
    group: Option<String>,
    cell: String,
    system: String,
    search: String,
    state: String,
    reason: String,
    seed: i64,
    runs: u32,
    created_ms: i64,
    ended_ms: Option<i64>,
    individuals: i64,
    planned: Option<i64>,
    evaluated: i64,
    culled: i64,
    aborted: i64,
    failed: i64,
}

#[derive(sqlx::FromRow)]
struct ProgressRow {
    experiment: i64,
    run: u32,
    stage: u32,
    stage_name: String,
    generation: u32,
    generations: Option<u32>,
    done: u32,
    size: u32,
    best: Option<f64>,
    best_individual: Option<i64>,
    ended: bool,
}

impl Reader {
    /// How experiments stand, in order of number: these, or all of them.
    ///
    /// # Errors
    /// See [`ReadError`].
    pub async fn summaries(&self, of: Option<&[ExperimentId]>) -> Result<Vec<Summary>, ReadError> {
        let ids = of.map(id_list);
        let mut transaction = self.pool().begin().await?; // one state of the file
        let rows: Vec<SummaryRow> =
            sqlx::query_as(sql!("summaries")).bind(&ids).fetch_all(&mut *transaction).await?;
        let progress: Vec<ProgressRow> =
            sqlx::query_as(sql!("progress")).bind(&ids).fetch_all(&mut *transaction).await?;
        let mut summaries: Vec<Summary> = rows.into_iter().map(Summary::from).collect();
        for row in progress {
            let id = ExperimentId::of(row.experiment);
            if let Ok(at) = summaries.binary_search_by_key(&id, |summary| summary.id) {
                summaries[at].progress.push(RunProgress::from(row));
            }
        }
        Ok(summaries)
    }
}

/// A list of ids as one value: statements unfold it with `json_each`.
pub(super) fn id_list(ids: &[ExperimentId]) -> String {
    serde_json::Value::from(ids.iter().map(|id| id.sql()).collect::<Vec<_>>()).to_string()
}

impl From<SummaryRow> for Summary {
    fn from(row: SummaryRow) -> Self {
        Summary {
            id: ExperimentId::of(row.id),
            name: row.name,
            group: row.group,
            cell: row.cell,
            system: row.system,
            search_kind: row.search,
            state: row.state,
            reason: row.reason,
            seed: row.seed.cast_unsigned(),
            runs: row.runs,
            created_ms: row.created_ms,
            ended_ms: row.ended_ms,
            individuals: row.individuals.cast_unsigned(),
            planned: row.planned.map(i64::cast_unsigned),
            evaluated: row.evaluated.cast_unsigned(),
            culled: row.culled.cast_unsigned(),
            aborted: row.aborted.cast_unsigned(),
            failed: row.failed.cast_unsigned(),
            progress: Vec::new(),
        }
    }
}

impl From<ProgressRow> for RunProgress {
    fn from(row: ProgressRow) -> Self {
        RunProgress {
            run: row.run,
            stage: row.stage,
            stage_name: row.stage_name,
            generation: row.generation,
            generations: row.generations,
            done: row.done,
            size: row.size,
            best: row.best.zip(row.best_individual.map(IndividualId::of)),
            ended: row.ended,
        }
    }
}

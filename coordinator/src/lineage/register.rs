//! What the writer keeps in memory between transactions, so that it writes without reading: words, workers,
//! the next id, the open generations. All of it can be read again from the file, and is after a rollback.

use super::outcome::read_names;
use super::sql::sql;
use super::{IndividualId, StageId};
use sqlx::sqlite::SqliteConnection;
use std::collections::BTreeMap;

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct Register {
    words: BTreeMap<String, i64>,
    workers: BTreeMap<String, i64>,
    last_individual: u64,
    open: BTreeMap<u64, (u32, StageId)>, // first individual → size, stage
    measures: BTreeMap<StageId, Vec<String>>,
    traits: BTreeMap<StageId, Vec<String>>,
}

impl Register {
    /// Reads it from the file.
    pub(crate) async fn load(connection: &mut SqliteConnection) -> Result<Register, sqlx::Error> {
        let words: Vec<(String, i64)> = sqlx::query_as(sql!("words")).fetch_all(&mut *connection).await?;
        let workers: Vec<(String, i64)> =
            sqlx::query_as(sql!("worker_names")).fetch_all(&mut *connection).await?;
        let last: i64 = sqlx::query_scalar(sql!("last_individual")).fetch_one(&mut *connection).await?;
        // Of each: its first individual, its size, its stage, and the names of traits and measures.
        type Open = (i64, u32, i64, Option<String>, Option<String>);
        let open: Vec<Open> = sqlx::query_as(sql!("open_generations")).fetch_all(&mut *connection).await?;
        let mut register = Register {
            words: words.into_iter().collect(),
            workers: workers.into_iter().collect(),
            last_individual: last.cast_unsigned(),
            ..Register::default()
        };
        for (first, size, stage, traits, measures) in open {
            let stage = StageId::of(stage);
            register.open.insert(first.cast_unsigned(), (size, stage));
            // Names that do not read are taken for none: rows then carry their own.
            for (names, known) in [(traits, &mut register.traits), (measures, &mut register.measures)] {
                if let Some(names) = names.as_deref().and_then(read_names) {
                    known.insert(stage, names);
                }
            }
        }
        Ok(register)
    }

    /// The id of a word, written when it is new.
    pub(crate) async fn word(
        &mut self,
        connection: &mut SqliteConnection,
        text: &str,
    ) -> Result<i64, sqlx::Error> {
        if let Some(id) = self.words.get(text) {
            return Ok(*id);
        }
        let inserted = sqlx::query(sql!("insert_word")).bind(text).execute(connection).await?;
        self.words.insert(text.to_owned(), inserted.last_insert_rowid());
        Ok(inserted.last_insert_rowid())
    }

    /// The row of a worker, by its name: its latest attachment. One that never said hello gets a bare row.
    pub(crate) async fn worker(
        &mut self,
        connection: &mut SqliteConnection,
        name: &str,
    ) -> Result<i64, sqlx::Error> {
        if let Some(id) = self.workers.get(name) {
            return Ok(*id);
        }
        let query = sqlx::query(sql!("insert_worker")).bind(name).bind("").bind(0).bind("");
        let id = query.bind(&[][..]).execute(connection).await?.last_insert_rowid();
        self.attached(name, id);
        Ok(id)
    }

    /// From now on a name means this attachment.
    pub(crate) fn attached(&mut self, name: &str, id: i64) {
        self.workers.insert(name.to_owned(), id);
    }

    /// Gives ids to a new generation: the first of them.
    pub(crate) fn open_generation(&mut self, stage: StageId, size: u32) -> IndividualId {
        let first = self.last_individual + 1;
        self.last_individual += u64::from(size);
        self.open.insert(first, (size, stage));
        IndividualId(first)
    }

    /// Forgets the open generation of a stage, if it has one.
    pub(crate) fn close_generation(&mut self, stage: StageId) {
        self.open.retain(|_, (_, open)| *open != stage);
    }

    /// Forgets a stage that has ended.
    pub(crate) fn end_stage(&mut self, stage: StageId) {
        self.measures.remove(&stage);
        self.traits.remove(&stage);
    }

    /// The stage of an individual of an open generation.
    pub(crate) fn stage_of(&self, individual: IndividualId) -> Option<StageId> {
        let (first, (size, stage)) = self.open.range(..=individual.0).next_back()?;
        (individual.0 < first + u64::from(*size)).then_some(*stage)
    }

    /// What the outcomes of a stage measure, once one of them has.
    pub(crate) fn measures(&self, stage: StageId) -> Option<&[String]> {
        self.measures.get(&stage).map(Vec::as_slice)
    }

    /// Names what the outcomes of a stage measure.
    pub(crate) fn name_measures(&mut self, stage: StageId, names: Vec<String>) {
        self.measures.insert(stage, names);
    }

    /// The traits of a stage's individuals, once it has one.
    pub(crate) fn traits(&self, stage: StageId) -> Option<&[String]> {
        self.traits.get(&stage).map(Vec::as_slice)
    }

    /// Names the traits of a stage's individuals.
    pub(crate) fn name_traits(&mut self, stage: StageId, names: Vec<String>) {
        self.traits.insert(stage, names);
    }
}

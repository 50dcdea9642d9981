//! Who may go on from the end of a stage, and who does: written with the stage's end, and read by those who
//! pick. It judges no creature.

use super::entry::{NewChoice, NewPick};
use super::sql::sql;
use super::transaction::{Places, Refusal, Transaction};
use super::{ExperimentId, IndividualId, ReadError, Reader, StageId};
use search::{PickedBy, Place};

/// A choice at the end of a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredChoice {
    /// At the end of which stage.
    pub stage: StageId,
    /// Which repetition, from 1.
    pub run: u32,
    /// The stage's number.
    pub number: u32,
    /// The stage's name; may be empty.
    pub name: String,
    /// Best first.
    pub candidates: Vec<StoredCandidate>,
    /// Who goes on; `None` while a pick is awaited.
    pub picked: Option<Picked>,
}

/// Who went on from the end of a stage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picked {
    /// One of the candidates.
    pub individual: IndividualId,
    /// `best` or `human`.
    pub by: String,
    /// Why, in words; may be empty.
    pub note: String,
}

/// One who may go on.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredCandidate {
    /// From 1.
    pub rank: u32,
    /// Who.
    pub individual: IndividualId,
    /// Of which population, where there are several side by side.
    pub population: Option<u32>,
    /// Its fitness.
    pub fitness: f64,
    /// What the search says of it: a JSON object.
    pub notes: String,
}

#[derive(sqlx::FromRow)]
struct CandidateRow {
    stage: i64,
    run: u32,
    number: u32,
    name: String,
    rank: u32,
    individual: i64,
    population: Option<u32>,
    fitness: f64,
    notes: String,
    picked: Option<i64>,
    picked_by: Option<String>,
    note: Option<String>,
}

impl Transaction<'_> {
    /// Writes candidates, and who goes on if that is known.
    pub(crate) async fn choose(&mut self, choice: &NewChoice) -> Result<(), Refusal> {
        let standing = self.standing(choice.stage).await?;
        let mut places = Places::default();
        for (rank, candidate) in (1u32..).zip(&choice.candidates) {
            let individual = places.find(self, &standing, candidate.place).await?;
            sqlx::query(sql!("insert_candidate"))
                .bind(choice.experiment.sql())
                .bind(choice.stage.sql())
                .bind(rank)
                .bind(individual)
                .bind(candidate.fitness)
                .bind(serde_json::Value::Object(candidate.notes.clone()).to_string())
                .execute(&mut *self.connection)
                .await?;
        }
        let Some(place) = choice.picked else { return Ok(()) };
        let individual = IndividualId::of(places.find(self, &standing, place).await?);
        let (experiment, stage) = (choice.experiment, choice.stage);
        self.pick(&NewPick { experiment, stage, individual, by: PickedBy::Best, note: String::new() }).await
    }

    /// Writes down who goes on, and lets an experiment that waited for it run.
    pub(crate) async fn pick(&mut self, pick: &NewPick) -> Result<(), Refusal> {
        let query = sqlx::query(sql!("insert_pick"))
            .bind(pick.experiment.sql())
            .bind(pick.stage.sql())
            .bind(pick.individual.sql())
            .bind(word(pick.by))
            .bind(&pick.note);
        if query.execute(&mut *self.connection).await?.rows_affected() == 0 {
            return Err(Refusal::Contradiction(format!("individual {} is no candidate", pick.individual)));
        }
        let query = sqlx::query(sql!("stop_awaiting")).bind(pick.experiment.sql());
        query.execute(&mut *self.connection).await?;
        Ok(())
    }
}

/// As in the lineage.
fn word(by: PickedBy) -> &'static str {
    match by {
        PickedBy::Best => "best",
        PickedBy::Human => "human",
    }
}

impl Reader {
    /// Every choice of an experiment so far, in order of run and stage.
    ///
    /// # Errors
    /// See [`ReadError`], here and below.
    pub async fn choices(&self, experiment: ExperimentId) -> Result<Vec<StoredChoice>, ReadError> {
        let query = sqlx::query_as(sql!("candidates")).bind(experiment.sql());
        let rows: Vec<CandidateRow> = query.fetch_all(self.pool()).await?;
        let mut choices: Vec<StoredChoice> = Vec::new();
        for row in rows {
            let stage = StageId::of(row.stage);
            let candidate = StoredCandidate {
                rank: row.rank,
                individual: IndividualId::of(row.individual),
                population: row.population,
                fitness: row.fitness,
                notes: row.notes,
            };
            match choices.last_mut() {
                Some(choice) if choice.stage == stage => choice.candidates.push(candidate),
                _ => choices.push(StoredChoice {
                    stage,
                    run: row.run,
                    number: row.number,
                    name: row.name,
                    candidates: vec![candidate],
                    picked: row.picked.map(|individual| Picked {
                        individual: IndividualId::of(individual),
                        by: row.picked_by.unwrap_or_default(),
                        note: row.note.unwrap_or_default(),
                    }),
                }),
            }
        }
        Ok(choices)
    }

    /// Where in its run the one stands who goes on from the end of a stage; `None` while nobody was picked.
    pub async fn picked(&self, experiment: ExperimentId, stage: StageId) -> Result<Option<Place>, ReadError> {
        let query = sqlx::query_as(sql!("picked")).bind(experiment.sql()).bind(stage.sql());
        let found: Option<(u32, u32, u32)> = query.fetch_optional(self.pool()).await?;
        Ok(found.map(|(stage, generation, index)| Place { stage, generation, index }))
    }
}

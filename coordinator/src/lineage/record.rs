//! Outcomes on their way to the disk: the hottest rows of the lineage, written many at a time.

use super::entry::{Ending, Evaluated, Fate, Retracted};
use super::outcome::{FAILED, Measures, names, word};
use super::sql::{Insert, sql};
use super::transaction::{Refusal, Transaction};
use super::{IndividualId, StageId};
use creatures::{Interim, Outcome, Verdict};
use std::sync::LazyLock;

struct OutcomeRow {
    individual: i64,
    status: i64,
    fitness: Option<f64>,
    steps: u32,
    interim: Option<Interim>,
    verdict: Option<i64>,
    note: Option<String>,
    counted: Option<(u32, i64, i64)>, // attempt, worker, micros
    audit: Option<i64>,
    measures: Measures,
}

struct AttemptRow {
    individual: i64,
    number: u32,
    worker: i64,
    fate: String,
    steps: i64,
    micros: i64,
}

impl Transaction<'_> {
    /// Writes what became of individuals, in order; whatever is known of one already stands.
    pub(crate) async fn record<'e>(
        &mut self,
        evaluated: impl IntoIterator<Item = &'e Evaluated>,
    ) -> Result<(), Refusal> {
        static OUTCOMES: LazyLock<Insert> = LazyLock::new(|| Insert::of(sql!("insert_outcome")));
        static ATTEMPTS: LazyLock<Insert> = LazyLock::new(|| Insert::of(sql!("insert_attempt")));

        let (mut outcomes, mut attempts, mut heirs) = (Vec::new(), Vec::new(), Vec::new());
        for evaluated in evaluated {
            let individual = evaluated.individual;
            match &evaluated.ending {
                Ending::Inherits(giver) => heirs.push((individual, *giver)),
                Ending::Settled(result) => {
                    let outcome = result.as_ref().map_err(|set_aside| set_aside.reason.as_str());
                    outcomes.push(self.outcome_row(evaluated, outcome).await?);
                }
            }
            for attempt in evaluated.attempts.iter().filter(|attempt| attempt.fate != Fate::Counted) {
                attempts.push(AttemptRow {
                    individual: individual.sql(),
                    number: attempt.number,
                    worker: self.register.worker(self.connection, &attempt.worker).await?,
                    fate: attempt.fate.word(),
                    steps: attempt.steps.cast_signed(),
                    micros: micros(attempt.seconds),
                });
            }
        }
        // Rows that come in order of their key are packed twice as tight.
        outcomes.sort_by_key(|row| row.individual);
        OUTCOMES
            .run(self.connection, &outcomes, |query, row| {
                let query = query
                    .bind(row.individual)
                    .bind(row.status)
                    .bind(row.fitness)
                    .bind(row.fitness.map(|fitness| fitness.to_bits().cast_signed()))
                    .bind(row.steps)
                    .bind(row.interim.map(|interim| interim.step))
                    .bind(row.interim.map(|interim| interim.measure))
                    .bind(row.verdict)
                    .bind(row.note.as_deref())
                    .bind(row.counted.map(|(attempt, _, _)| attempt))
                    .bind(row.counted.map(|(_, worker, _)| worker))
                    .bind(row.counted.map(|(_, _, micros)| micros))
                    .bind(row.audit);
                let query = row.measures.numbers.iter().fold(query, |query, number| query.bind(*number));
                query.bind(row.measures.pairs.as_deref())
            })
            .await?;
        ATTEMPTS
            .run(self.connection, &attempts, |query, row| {
                query
                    .bind(row.individual)
                    .bind(row.number)
                    .bind(row.worker)
                    .bind(&row.fate)
                    .bind(row.steps)
                    .bind(row.micros)
            })
            .await?;
        // An heir may be the giver of a later one, so these keep their order.
        for (heir, giver) in heirs {
            self.inherit(heir, giver).await?;
        }
        Ok(())
    }

    async fn outcome_row(
        &mut self,
        evaluated: &Evaluated,
        outcome: Result<&Outcome, &str>,
    ) -> Result<OutcomeRow, Refusal> {
        let counted = evaluated.attempts.iter().find(|attempt| attempt.fate == Fate::Counted);
        let counted = match counted {
            Some(attempt) => {
                let worker = self.register.worker(self.connection, &attempt.worker).await?;
                Some((attempt.number, worker, micros(attempt.seconds)))
            }
            None => None,
        };
        let ruling = evaluated.ruling;
        let verdict = match ruling {
            Some(ruling) => Some(self.register.word(self.connection, verdict(ruling.verdict)).await?),
            None => None,
        };
        let audit = match evaluated.audit {
            Some(audit) => Some(self.register.word(self.connection, audit.word()).await?),
            None => None,
        };
        let ruled = ruling.map(|ruling| Interim { step: ruling.step, measure: ruling.measure });
        Ok(match outcome {
            Ok(outcome) => OutcomeRow {
                individual: evaluated.individual.sql(),
                status: self.register.word(self.connection, &word(outcome.status)).await?,
                fitness: Some(outcome.fitness),
                steps: outcome.steps,
                measures: self.measures(evaluated.individual, outcome).await?,
                interim: outcome.interim.or(ruled),
                verdict,
                note: (!outcome.note.is_empty()).then(|| outcome.note.clone()),
                counted,
                audit,
            },
            Err(reason) => OutcomeRow {
                individual: evaluated.individual.sql(),
                status: self.register.word(self.connection, FAILED).await?,
                fitness: None,
                steps: 0,
                measures: Measures::default(),
                interim: ruled,
                verdict,
                note: Some(reason.to_owned()),
                counted,
                audit,
            },
        })
    }

    /// The columns of its measures. The first outcome of a stage that measures something names its measures.
    async fn measures(&mut self, individual: IndividualId, outcome: &Outcome) -> Result<Measures, Refusal> {
        if outcome.measures.is_empty() {
            return Ok(Measures::default());
        }
        let Some(stage) = self.register.stage_of(individual) else { return Ok(Measures::of(outcome, &[])) };
        if self.register.measures(stage).is_none() {
            self.name_measures(stage, outcome).await?;
        }
        Ok(Measures::of(outcome, self.register.measures(stage).unwrap_or(&[])))
    }

    async fn name_measures(&mut self, stage: StageId, outcome: &Outcome) -> Result<(), Refusal> {
        let query = sqlx::query(sql!("name_measures")).bind(stage.sql()).bind(names(outcome));
        query.execute(&mut *self.connection).await?;
        let named = outcome.measures.iter().map(|(name, _)| name.clone()).collect();
        self.register.name_measures(stage, named);
        Ok(())
    }

    /// Takes back what rests on the word of workers of one name alone, within an open generation.
    pub(crate) async fn retract(
        &mut self,
        first: IndividualId,
        size: u32,
        worker: &str,
    ) -> Result<Vec<Retracted>, Refusal> {
        if self.register.stage_of(first).is_none() {
            let problem = format!("the generation of individual {first} is not open");
            return Err(Refusal::Contradiction(problem));
        }
        let query = sqlx::query_as::<_, (i64, u32)>(sql!("doubtful"))
            .bind(first.sql())
            .bind(first.at(size.saturating_sub(1)).sql())
            .bind(worker);
        let doubtful = query.fetch_all(&mut *self.connection).await?;
        let ids = serde_json::Value::from_iter(doubtful.iter().map(|(id, _)| *id)).to_string();
        for statement in [sql!("retract_attempts"), sql!("retract_outcomes")] {
            sqlx::query(statement).bind(&ids).execute(&mut *self.connection).await?;
        }
        let retracted = |(id, attempts)| Retracted { individual: IndividualId::of(id), attempts };
        Ok(doubtful.into_iter().map(retracted).collect())
    }

    async fn inherit(&mut self, heir: IndividualId, giver: IndividualId) -> Result<(), Refusal> {
        let query = sqlx::query(sql!("inherit_outcome")).bind(heir.sql()).bind(giver.sql());
        if query.execute(&mut *self.connection).await?.rows_affected() > 0 {
            return Ok(());
        }
        // Nothing inserted: the heir is settled already, which is no matter, or the giver is not.
        let query = sqlx::query_scalar::<_, bool>(sql!("has_outcome")).bind(heir.sql());
        if query.fetch_one(&mut *self.connection).await? {
            return Ok(());
        }
        let problem = format!("individual {heir} cannot inherit from {giver}, which has no outcome");
        Err(Refusal::Contradiction(problem))
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::Cull => "cull",
        Verdict::Spare => "spare",
    }
}

/// Seconds as whole microseconds: half the bytes of a REAL. Nonsense becomes 0 or the largest.
fn micros(seconds: f64) -> i64 {
    (seconds * 1e6) as i64
}

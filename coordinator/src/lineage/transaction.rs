//! What each entry changes: the statements of one entry, within a transaction that the writer opens and
//! commits. Nothing here retries or waits.

use super::entry::{
    Amendment, CloseGeneration, Culling, Event, InStage, Joined, NewChoice, NewExperiment, NewStage, Origin,
    State,
};
use super::fault::{Fault, fault};
use super::genotype::Packed;
use super::register::Register;
use super::sql::{Insert, sql};
use super::{ExperimentId, IndividualId, StageId};
use search::{Individual, Place};
use sqlx::sqlite::SqliteConnection;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::LazyLock;

/// Why an entry is not written.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// It contradicts what stands in the lineage.
    Contradiction(String),
    /// SQLite could not.
    Sqlite(sqlx::Error),
}

impl From<sqlx::Error> for Refusal {
    fn from(error: sqlx::Error) -> Self {
        match fault(&error) {
            Fault::Contradiction => Refusal::Contradiction(error.to_string()),
            _ => Refusal::Sqlite(error),
        }
    }
}

/// A generation whose genotypes are packed.
#[derive(Debug)]
pub(crate) struct PackedGeneration {
    pub(crate) stage: InStage,
    pub(crate) generation: u32,
    pub(crate) checkpoint: Checkpoint,
    pub(crate) culling: Option<Culling>,
    /// Without their genotypes.
    pub(crate) individuals: Vec<Individual>,
    pub(crate) genotypes: Vec<Packed>,
    pub(crate) close: Option<CloseGeneration>,
    pub(crate) ends: Option<PackedEnd>,
    pub(crate) choice: Option<NewChoice>,
}

/// The end of a stage whose checkpoint is packed.
#[derive(Debug)]
pub(crate) struct PackedEnd {
    pub(crate) stage: StageId,
    pub(crate) close: CloseGeneration,
    pub(crate) checkpoint: Checkpoint,
    pub(crate) over: bool,
}

/// A search's state, packed.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    pub(crate) size: usize,
    pub(crate) digest: [u8; 32], // of the state itself
    pub(crate) frame: Vec<u8>,
}

/// Everything that entries change, over one connection in a transaction.
pub(crate) struct Transaction<'a> {
    pub(crate) connection: &'a mut SqliteConnection,
    pub(crate) register: &'a mut Register,
}

/// Where a stage belongs, and how far it is.
#[derive(Debug, sqlx::FromRow)]
pub(super) struct StageStanding {
    experiment: i64,
    run: u32,
    number: u32,
    ended: bool,
    latest: Option<u32>,
    open: Option<i64>,
}

impl Transaction<'_> {
    /// Writes experiments under names that are free.
    pub(crate) async fn create(&mut self, experiments: &[NewExperiment]) -> Result<Vec<u64>, Refusal> {
        let suffix = self.free_suffix(experiments).await?;
        let mut ids = Vec::with_capacity(experiments.len());
        for experiment in experiments {
            let (name, group) = named(experiment, &suffix);
            let inserted = sqlx::query(sql!("insert_experiment"))
                .bind(name)
                .bind(group)
                .bind(experiment.cell.to_string())
                .bind(&experiment.system)
                .bind(experiment.system_version)
                .bind(&experiment.search_kind)
                .bind(experiment.seed.cast_signed())
                .bind(experiment.runs)
                .bind(&experiment.task_json)
                .bind(&experiment.resolved)
                .bind(&experiment.digest[..])
                .bind(experiment.published.to_string())
                .bind(experiment.planned.map(u64::cast_signed))
                .bind(&experiment.program_version)
                .bind(&experiment.fingerprint[..])
                .bind(experiment.origin.map(|origin: Origin| origin.experiment.sql()))
                .bind(experiment.origin.map(|origin| origin.stage))
                .execute(&mut *self.connection)
                .await?;
            ids.push(inserted.last_insert_rowid().cast_unsigned());
        }
        Ok(ids)
    }

    /// The first of nothing, `-2`, `-3`, … under which every name is free.
    async fn free_suffix(&mut self, experiments: &[NewExperiment]) -> Result<String, sqlx::Error> {
        let mut number = 1;
        loop {
            let suffix = if number == 1 { String::new() } else { format!("-{number}") };
            let mut taken = false;
            for experiment in experiments {
                let (name, group) = named(experiment, &suffix);
                for name in [Some(name), group].into_iter().flatten() {
                    let query = sqlx::query_scalar::<_, bool>(sql!("name_is_taken")).bind(name);
                    taken |= query.fetch_one(&mut *self.connection).await?;
                }
            }
            if !taken {
                return Ok(suffix);
            }
            number += 1;
        }
    }

    /// Sets what an experiment is up to.
    pub(crate) async fn set_state(
        &mut self,
        experiment: ExperimentId,
        state: State,
        reason: &str,
    ) -> Result<(), Refusal> {
        let query = sqlx::query(sql!("set_state")).bind(experiment.sql()).bind(state.word()).bind(reason);
        if query.execute(&mut *self.connection).await?.rows_affected() == 0 {
            return Err(Refusal::Contradiction(format!("there is no experiment {experiment}")));
        }
        Ok(())
    }

    /// Gives an experiment a changed file.
    pub(crate) async fn amend(&mut self, of: &Amendment) -> Result<(), Refusal> {
        sqlx::query(sql!("amend_experiment"))
            .bind(of.experiment.sql())
            .bind(&of.resolved)
            .bind(&of.digest[..])
            .bind(&of.task_json)
            .bind(of.planned.map(u64::cast_signed))
            .execute(&mut *self.connection)
            .await?;
        let query = sqlx::query(sql!("no_run_is_over")).bind(of.experiment.sql());
        query.execute(&mut *self.connection).await?;
        self.set_state(of.experiment, State::Running, "").await?;
        let text = "it goes on with a changed file".to_owned();
        let (experiment, kind, data) = (Some(of.experiment), "amended".to_owned(), of.data.clone());
        self.event(&Event { experiment, kind, text, data }).await
    }

    /// Begins a stage.
    pub(crate) async fn open_stage(&mut self, stage: &NewStage) -> Result<u64, Refusal> {
        let query = sqlx::query(sql!("insert_stage"))
            .bind(stage.experiment.sql())
            .bind(stage.run)
            .bind(stage.stage)
            .bind(&stage.name)
            .bind(stage.seed.cast_signed())
            .bind(stage.generations)
            .bind(&stage.task_json);
        Ok(query.execute(&mut *self.connection).await?.last_insert_rowid().cast_unsigned())
    }

    /// Ends the stage before and the open generation, as far as that is said, and begins the next: its stage
    /// and its first id.
    pub(crate) async fn open_generation(
        &mut self,
        next: &PackedGeneration,
    ) -> Result<(StageId, IndividualId), Refusal> {
        if let Some(ends) = &next.ends {
            self.end_stage(ends).await?;
        }
        if let Some(choice) = &next.choice {
            self.choose(choice).await?;
        }
        let stage = match &next.stage {
            InStage::Open(stage, _) => *stage,
            InStage::New(stage) => StageId(self.open_stage(stage).await?),
        };
        let standing = self.standing(stage).await?;
        if standing.ended {
            return Err(Refusal::Contradiction(format!("stage {stage} has ended")));
        }
        let due = standing.latest.unwrap_or(0) + 1;
        if next.generation != due {
            return Err(Refusal::Contradiction(format!("generation {due} of stage {stage} is due")));
        }
        match (&next.close, standing.open) {
            (Some(close), Some(open)) => self.close_generation(stage, &standing, open, close).await?,
            (None, None) => {}
            (None, Some(_)) => {
                let problem = format!("generation {} has not been closed", due - 1);
                return Err(Refusal::Contradiction(problem));
            }
            (Some(_), None) => {
                return Err(Refusal::Contradiction("there is no open generation to close".to_owned()));
            }
        }
        let size = u32::try_from(next.individuals.len()).expect("a generation has fewer than 2^32");
        let first = self.register.open_generation(stage, size);
        let generation = sqlx::query(sql!("insert_generation"))
            .bind(stage.sql())
            .bind(next.generation)
            .bind(first.sql())
            .bind(size)
            .bind(next.culling.map(|culling| culling.at))
            .bind(next.culling.and_then(|culling| culling.cutoff))
            .execute(&mut *self.connection)
            .await?
            .last_insert_rowid();
        self.individuals(stage, &standing, generation, first, next).await?;
        self.checkpoint(stage, next.generation, &next.checkpoint).await?;
        Ok((stage, first))
    }

    /// Ends the last generation of a stage, and the stage.
    pub(crate) async fn end_stage(&mut self, ends: &PackedEnd) -> Result<(), Refusal> {
        let stage = ends.stage;
        let standing = self.standing(stage).await?;
        let (Some(open), Some(latest)) = (standing.open, standing.latest) else {
            return Err(Refusal::Contradiction("there is no open generation to close".to_owned()));
        };
        self.close_generation(stage, &standing, open, &ends.close).await?;
        self.checkpoint(stage, latest + 1, &ends.checkpoint).await?;
        let query = sqlx::query(sql!("end_stage")).bind(stage.sql()).bind(ends.over);
        query.execute(&mut *self.connection).await?;
        self.register.end_stage(stage);
        Ok(())
    }

    pub(super) async fn standing(&mut self, stage: StageId) -> Result<StageStanding, Refusal> {
        let query = sqlx::query_as(sql!("stage_standing")).bind(stage.sql());
        let standing = query.fetch_optional(&mut *self.connection).await?;
        standing.ok_or_else(|| Refusal::Contradiction(format!("there is no stage {stage}")))
    }

    async fn close_generation(
        &mut self,
        stage: StageId,
        standing: &StageStanding,
        open: i64,
        close: &CloseGeneration,
    ) -> Result<(), Refusal> {
        let query = sqlx::query_scalar::<_, i64>(sql!("pending_count")).bind(open);
        let pending = query.fetch_one(&mut *self.connection).await?;
        if pending > 0 {
            return Err(Refusal::Contradiction(format!("{pending} individuals have no outcome yet")));
        }
        sqlx::query(sql!("close_generation"))
            .bind(open)
            .bind(close.wall_seconds)
            .bind(serde_json::Value::Object(close.record.notes.clone()).to_string())
            .execute(&mut *self.connection)
            .await?;
        let mut places = Places::default();
        for species in &close.record.species {
            let representative = places.find(self, standing, species.representative).await?;
            sqlx::query(sql!("insert_species"))
                .bind(open)
                .bind(species.id)
                .bind(species.size)
                .bind(species.best)
                .bind(species.share)
                .bind(species.quota)
                .bind(representative)
                .bind(species.stagnant)
                .execute(&mut *self.connection)
                .await?;
        }
        self.register.close_generation(stage);
        Ok(())
    }

    async fn individuals(
        &mut self,
        stage: StageId,
        standing: &StageStanding,
        generation: i64,
        first: IndividualId,
        next: &PackedGeneration,
    ) -> Result<(), Refusal> {
        static INDIVIDUALS: LazyLock<Insert> = LazyLock::new(|| Insert::of(sql!("insert_individual")));
        static PARENTS: LazyLock<Insert> = LazyLock::new(|| Insert::of(sql!("insert_parent")));
        static GENOTYPES: LazyLock<Insert> = LazyLock::new(|| Insert::of(sql!("insert_genotype")));

        let mut places = Places::default();
        let own = (standing.number, next.generation);
        places.known.insert(own, Some((first.0, next.individuals.len() as u64)));
        let (mut rows, mut parents, mut genotypes) = (Vec::new(), Vec::new(), Vec::new());
        for ((index, individual), packed) in (0..).zip(&next.individuals).zip(&next.genotypes) {
            let id = first.at(index).sql();
            let operator = self.register.word(self.connection, &individual.operator).await?;
            let inherits = match individual.inherits {
                Some(place) => Some(places.find(self, standing, place).await?),
                None => None,
            };
            let traits = self.traits(stage, &individual.traits).await?;
            rows.push((id, operator, traits, inherits));
            for (ord, parent) in (0i64..).zip(&individual.parents) {
                let role = self.register.word(self.connection, &parent.role).await?;
                parents.push((id, ord, places.find(self, standing, parent.place).await?, role));
            }
            let base = match packed.base {
                Some(place) => Some(places.find(self, standing, place).await?),
                None => None,
            };
            genotypes.push((id, base, packed));
        }
        INDIVIDUALS
            .run(self.connection, &rows, |query, (id, operator, traits, inherits)| {
                query.bind(*id).bind(generation).bind(*operator).bind(traits).bind(*inherits)
            })
            .await?;
        PARENTS
            .run(self.connection, &parents, |query, (child, ord, parent, role)| {
                query.bind(*child).bind(*ord).bind(*parent).bind(*role)
            })
            .await?;
        GENOTYPES
            .run(self.connection, &genotypes, |query, (id, base, packed)| {
                let size = i64::try_from(packed.size).expect("a genotype is far below 2^63 bytes");
                query.bind(*id).bind(&packed.digest[..]).bind(*base).bind(size).bind(&packed.bytes)
            })
            .await?;
        Ok(())
    }

    /// The traits column: values alone under the names of the stage's first individual, else the whole object.
    async fn traits(&mut self, stage: StageId, traits: &serde_json::Value) -> Result<String, Refusal> {
        let Some(object) = traits.as_object() else {
            return Err(Refusal::Contradiction(format!("traits are a JSON object, not {traits}")));
        };
        if self.register.traits(stage).is_none() {
            let names: Vec<String> = object.keys().cloned().collect();
            let text = serde_json::Value::from(names.clone()).to_string();
            let query = sqlx::query(sql!("name_traits")).bind(stage.sql()).bind(text);
            query.execute(&mut *self.connection).await?;
            self.register.name_traits(stage, names);
        }
        if self.register.traits(stage).is_some_and(|names| object.keys().eq(names)) {
            return Ok(serde_json::Value::from_iter(object.values().cloned()).to_string());
        }
        Ok(traits.to_string())
    }

    async fn checkpoint(
        &mut self,
        stage: StageId,
        generation: u32,
        checkpoint: &Checkpoint,
    ) -> Result<(), Refusal> {
        sqlx::query(sql!("save_checkpoint"))
            .bind(stage.sql())
            .bind(generation)
            .bind(i64::try_from(checkpoint.size).expect("a checkpoint is far below 2^63 bytes"))
            .bind(&checkpoint.digest[..])
            .bind(&checkpoint.frame)
            .execute(&mut *self.connection)
            .await?;
        let query = sqlx::query(sql!("drop_checkpoints")).bind(stage.sql()).bind(generation);
        query.execute(&mut *self.connection).await?;
        Ok(())
    }

    /// Writes an event.
    pub(crate) async fn event(&mut self, event: &Event) -> Result<(), Refusal> {
        sqlx::query(sql!("insert_event"))
            .bind(event.experiment.map(ExperimentId::sql))
            .bind(&event.kind)
            .bind(&event.text)
            .bind(event.data.to_string())
            .execute(&mut *self.connection)
            .await?;
        Ok(())
    }

    /// A worker attached.
    pub(crate) async fn worker_joined(&mut self, worker: &Joined) -> Result<(), Refusal> {
        let inserted = sqlx::query(sql!("insert_worker"))
            .bind(&worker.name)
            .bind(&worker.host)
            .bind(worker.slots)
            .bind(&worker.version)
            .bind(&worker.fingerprint[..])
            .execute(&mut *self.connection)
            .await?;
        self.register.attached(&worker.name, inserted.last_insert_rowid());
        Ok(())
    }

    /// A worker's name is trusted no more.
    pub(crate) async fn worker_quarantined(&mut self, name: &str) -> Result<(), Refusal> {
        self.register.worker(self.connection, name).await?; // so that there is a row to mark
        sqlx::query(sql!("worker_quarantined")).bind(name).execute(&mut *self.connection).await?;
        Ok(())
    }

    /// A worker went away.
    pub(crate) async fn worker_left(&mut self, name: &str, reason: &str) -> Result<(), Refusal> {
        let id = self.register.worker(self.connection, name).await?;
        sqlx::query(sql!("worker_left")).bind(id).bind(reason).execute(&mut *self.connection).await?;
        Ok(())
    }
}

/// The name and matrix of an experiment under a suffix. Cells keep their part: `matrix-2/cell`.
fn named(experiment: &NewExperiment, suffix: &str) -> (String, Option<String>) {
    let group = experiment.group.as_ref().map(|group| format!("{group}{suffix}"));
    let cell = experiment.group.as_ref().and_then(|group| experiment.name.strip_prefix(group.as_str()));
    let name = match (&group, cell) {
        (Some(group), Some(cell)) if cell.starts_with('/') => format!("{group}{cell}"),
        _ => format!("{}{suffix}", experiment.name),
    };
    (name, group)
}

/// Generations of a run that have been looked up.
#[derive(Default)]
pub(super) struct Places {
    known: BTreeMap<(u32, u32), Option<(u64, u64)>>, // stage, generation → first, size
}

impl Places {
    /// The row of the individual at a place of the run.
    pub(super) async fn find(
        &mut self,
        transaction: &mut Transaction<'_>,
        run: &StageStanding,
        place: Place,
    ) -> Result<i64, Refusal> {
        let key = (place.stage, place.generation);
        if let Entry::Vacant(unknown) = self.known.entry(key) {
            let query = sqlx::query_as::<_, (i64, i64)>(sql!("locate_generation"))
                .bind(run.experiment)
                .bind(run.run)
                .bind(place.stage)
                .bind(place.generation);
            let found = query.fetch_optional(&mut *transaction.connection).await?;
            unknown.insert(found.map(|(first, size)| (first.cast_unsigned(), size.cast_unsigned())));
        }
        match self.known[&key] {
            Some((first, size)) if u64::from(place.index) < size => {
                Ok(IndividualId(first).at(place.index).sql())
            }
            _ => Err(Refusal::Contradiction(format!(
                "nobody stands at stage {}, generation {}, index {} of run {}",
                place.stage, place.generation, place.index, run.run
            ))),
        }
    }
}

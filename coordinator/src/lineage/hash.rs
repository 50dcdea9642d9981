//! The lineage hash of an experiment, from the rows on file: what the same experiment must come to anywhere.

use super::individual::damaged;
use super::sql::sql;
use super::{ExperimentId, IndividualId, ReadError, Reader, State, genotype, individual};
use search::Place;
use search::hash::{HashRow, LineageHasher};
use sqlx::sqlite::SqliteConnection;
use std::collections::BTreeMap;

/// The lineage hash of one experiment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExperimentHash {
    /// Its number.
    pub experiment: ExperimentId,
    /// Its name.
    pub name: String,
    /// Over all its individuals in order of run and place (design: determinism).
    pub hash: [u8; 32],
    /// How many they are.
    pub individuals: u64,
    /// Else the hash is of what stands so far.
    pub finished: bool,
}

#[derive(sqlx::FromRow, Clone, Copy)]
struct GenerationRow {
    run: u32,
    stage: u32,
    generation: u32,
    first: i64,
    size: u32,
}

#[derive(sqlx::FromRow)]
struct HashedRow {
    id: i64,
    operator: String,
    status: String,
    fitness_bits: Option<i64>,
    digest: Vec<u8>,
    base: Option<i64>,
    size: i64,
    bytes: Vec<u8>,
}

impl Reader {
    /// The lineage hash of an experiment. It reads every genotype, and checks each against its digest.
    ///
    /// # Errors
    /// See [`ReadError`].
    pub async fn hash(&self, experiment: ExperimentId) -> Result<ExperimentHash, ReadError> {
        let stored = self.experiment(experiment).await?;
        let mut transaction = self.pool().begin().await?; // one state of the file
        let generations: Vec<GenerationRow> = sqlx::query_as(sql!("generations_in_order"))
            .bind(experiment.sql())
            .fetch_all(&mut *transaction)
            .await?;
        let places = generations.iter().map(|row| (row.first, *row)).collect();
        let mut hasher = LineageHasher::new();
        let mut shelf = BTreeMap::new(); // genotypes of the generation before
        let picks: Vec<(u32, u32, i64)> = sqlx::query_as(sql!("picks_in_order"))
            .bind(experiment.sql())
            .fetch_all(&mut *transaction)
            .await?;
        let mut picks = picks.into_iter().peekable();
        let mut individuals = 0;
        for (at, generation) in generations.iter().enumerate() {
            shelf = add(&mut transaction, &mut hasher, *generation, &places, &shelf).await?;
            individuals += u64::from(generation.size);
            let stage = |row: &GenerationRow| (row.run, row.stage);
            if generations.get(at + 1).map(stage) == Some(stage(generation)) {
                continue; // the stage goes on
            }
            let own = |pick: &(u32, u32, i64)| (pick.0, pick.1) == stage(generation);
            if let Some((run, stage, individual)) = picks.next_if(own) {
                let picked = place(&places, individual);
                let id = IndividualId::of(individual);
                hasher.pick(run, stage, picked.ok_or_else(|| damaged(id, "it was picked and has no place"))?);
            }
        }
        Ok(ExperimentHash {
            experiment,
            name: stored.name,
            hash: hasher.finish(),
            individuals,
            finished: stored.state == State::Finished,
        })
    }
}

/// Adds the rows of one generation, and gives its genotypes.
async fn add(
    connection: &mut SqliteConnection,
    hasher: &mut LineageHasher,
    generation: GenerationRow,
    places: &BTreeMap<i64, GenerationRow>,
    shelf: &BTreeMap<i64, Vec<u8>>,
) -> Result<BTreeMap<i64, Vec<u8>>, ReadError> {
    let last = generation.first + i64::from(generation.size) - 1;
    let rows: Vec<HashedRow> = sqlx::query_as(sql!("hashed_individuals"))
        .bind(generation.first)
        .bind(last)
        .fetch_all(&mut *connection)
        .await?;
    let links: Vec<(i64, i64, String)> = sqlx::query_as(sql!("hashed_parents"))
        .bind(generation.first)
        .bind(last)
        .fetch_all(&mut *connection)
        .await?;
    if rows.len() != generation.size as usize {
        return Err(damaged(IndividualId::of(generation.first), "some of its generation are missing"));
    }
    let mut links = links.into_iter().peekable();
    let mut unpacked = BTreeMap::new();
    for (index, row) in (0..).zip(rows) {
        let id = IndividualId::of(row.id);
        let genotype = match row.base {
            Some(base) if !shelf.contains_key(&base) => individual::genotype(connection, id).await?,
            base => {
                let base = base.map(|base| shelf[&base].as_slice());
                let size = usize::try_from(row.size).map_err(|_| damaged(id, "its genotype has no size"))?;
                genotype::unpack(row.bytes, size, base).map_err(|problem| damaged(id, &problem))?
            }
        };
        if row.digest != genotype::digest(&genotype) {
            return Err(damaged(id, "its genotype is not the one of its digest"));
        }
        let mut parents: Vec<(Place, String)> = Vec::new();
        while let Some((_, parent, role)) = links.next_if(|(child, ..)| *child == row.id) {
            parents.push((place(places, parent).ok_or_else(|| damaged(id, "a parent has no place"))?, role));
        }
        let parents: Vec<(Place, &str)> =
            parents.iter().map(|(place, role)| (*place, role.as_str())).collect();
        hasher.row(&HashRow {
            run: generation.run,
            place: Place { stage: generation.stage, generation: generation.generation, index },
            genotype: &genotype,
            parents: &parents,
            operator: &row.operator,
            status: &row.status,
            fitness: row.fitness_bits.map_or(0.0, |bits| f64::from_bits(bits.cast_unsigned())),
        });
        unpacked.insert(row.id, genotype);
    }
    Ok(unpacked)
}

fn place(places: &BTreeMap<i64, GenerationRow>, individual: i64) -> Option<Place> {
    let (first, row) = places.range(..=individual).next_back()?;
    let index = u32::try_from(individual - first).ok().filter(|index| *index < row.size)?;
    Some(Place { stage: row.stage, generation: row.generation, index })
}

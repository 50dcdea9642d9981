//! Where an individual comes from: its ancestors back to the founders. The walk up is one recursive statement;
//! only the counting of steps is done here.

use super::individual::{Link, damaged};
use super::sql::sql;
use super::{IndividualId, ReadError, Reader};
use search::Place;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// One ancestor.
#[derive(Debug, Clone, PartialEq)]
pub struct Ancestor {
    /// Who.
    pub id: IndividualId,
    /// Steps back, the shortest way.
    pub depth: u32,
    /// Where it stands in its run.
    pub place: Place,
    /// How it was made.
    pub operator: String,
    /// As in [`super::Portrait`].
    pub status: String,
    /// `None` while pending and for failed ones.
    pub fitness: Option<f64>,
    /// Its own parents: all of them, also beyond the depth asked for.
    pub parents: Vec<Link>,
}

#[derive(sqlx::FromRow)]
struct AncestorRow {
    id: i64,
    generation: i64,
    operator: i64,
    status: Option<i64>,
    fitness_bits: Option<i64>,
}

/// Child and order among its parents → parent and the word of its role.
type Edges = BTreeMap<(i64, i64), (i64, i64)>;

impl Reader {
    /// The ancestors of an individual, nearest first, then in order of id.
    ///
    /// `depth` limits the steps back, 0 to the founders; `line` follows first parents alone.
    ///
    /// # Errors
    /// See [`ReadError`].
    pub async fn ancestry(
        &self,
        of: IndividualId,
        depth: u32,
        line: bool,
    ) -> Result<Vec<Ancestor>, ReadError> {
        let mut transaction = self.pool().begin().await?; // one state of the file
        let exists: bool =
            sqlx::query_scalar(sql!("exists")).bind(of.sql()).fetch_one(&mut *transaction).await?;
        if !exists {
            return Err(ReadError::NotFound { what: "individual", reference: of.to_string() });
        }
        let edges: Vec<(i64, i64, i64, i64)> = sqlx::query_as(sql!("pedigree"))
            .bind(of.sql())
            .bind(depth)
            .bind(line)
            .fetch_all(&mut *transaction)
            .await?;
        let edges = edges.into_iter().map(|(child, ord, parent, role)| ((child, ord), (parent, role)));
        let edges: Edges = edges.collect();
        let steps = steps(of.sql(), &edges, depth, line);
        let rows: Vec<AncestorRow> = sqlx::query_as(sql!("ancestors"))
            .bind(list(steps.keys().copied()))
            .fetch_all(&mut *transaction)
            .await?;
        let generations: BTreeSet<i64> = rows.iter().map(|row| row.generation).collect();
        let generations: Vec<(i64, u32, u32, i64)> = sqlx::query_as(sql!("generation_places"))
            .bind(list(generations))
            .fetch_all(&mut *transaction)
            .await?;
        let generations: BTreeMap<i64, (u32, u32, i64)> =
            generations.into_iter().map(|(id, stage, number, first)| (id, (stage, number, first))).collect();
        let words: Vec<(String, i64)> = sqlx::query_as(sql!("words")).fetch_all(&mut *transaction).await?;
        let words: BTreeMap<i64, String> = words.into_iter().map(|(text, id)| (id, text)).collect();

        let word = |id: i64| words.get(&id).cloned().unwrap_or_default(); // foreign keys say that it is there
        let mut ancestors = Vec::with_capacity(rows.len());
        for row in rows {
            let id = IndividualId::of(row.id);
            let place = generations.get(&row.generation).and_then(|&(stage, generation, first)| {
                Some(Place { stage, generation, index: u32::try_from(row.id - first).ok()? })
            });
            let parents = edges.range((row.id, i64::MIN)..=(row.id, i64::MAX));
            ancestors.push(Ancestor {
                id,
                depth: steps.get(&row.id).copied().unwrap_or(0),
                place: place.ok_or_else(|| damaged(id, "it stands in no generation"))?,
                operator: word(row.operator),
                status: row.status.map_or("pending".to_owned(), word),
                fitness: row.fitness_bits.map(|bits| f64::from_bits(bits.cast_unsigned())),
                parents: parents
                    .map(|(_, &(parent, role))| Link { parent: IndividualId::of(parent), role: word(role) })
                    .collect(),
            });
        }
        ancestors.sort_by_key(|ancestor| (ancestor.depth, ancestor.id));
        Ok(ancestors)
    }
}

/// Ids as one value: statements unfold it with `json_each`.
fn list(ids: impl IntoIterator<Item = i64>) -> String {
    serde_json::Value::from_iter(ids).to_string()
}

/// The shortest way back to each ancestor, in steps.
fn steps(of: i64, edges: &Edges, depth: u32, line: bool) -> BTreeMap<i64, u32> {
    let mut steps = BTreeMap::new();
    let mut ahead = VecDeque::from([(of, 0)]);
    while let Some((child, so_far)) = ahead.pop_front() {
        if depth > 0 && so_far == depth {
            continue;
        }
        let last = if line { 0 } else { i64::MAX };
        for (_, &(parent, _)) in edges.range((child, 0)..=(child, last)) {
            if let Entry::Vacant(unseen) = steps.entry(parent) {
                unseen.insert(so_far + 1);
                ahead.push_back((parent, so_far + 1));
            }
        }
    }
    steps
}

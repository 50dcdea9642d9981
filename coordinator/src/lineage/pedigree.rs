//! Where an individual comes from: its ancestors back to the founders. The walk up is one recursive statement;
//! only the counting of steps is done here.

use super::individual::Link;
use super::sql::sql;
use super::{IndividualId, ReadError, Reader};
use search::Place;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

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
    stage: u32,
    generation: u32,
    idx: u32,
    operator: String,
    status: String,
    fitness_bits: Option<i64>,
}

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
        let edges: Vec<(i64, i64, String)> = sqlx::query_as(sql!("pedigree"))
            .bind(of.sql())
            .bind(depth)
            .bind(line)
            .fetch_all(&mut *transaction)
            .await?;
        let mut parents: BTreeMap<i64, Vec<Link>> = BTreeMap::new();
        for (child, parent, role) in edges {
            parents.entry(child).or_default().push(Link { parent: IndividualId::of(parent), role });
        }
        let mut steps = steps(of, &parents, depth, line);
        let ids = serde_json::Value::from(steps.keys().map(|id| id.sql()).collect::<Vec<_>>()).to_string();
        let rows: Vec<AncestorRow> =
            sqlx::query_as(sql!("ancestors")).bind(ids).fetch_all(&mut *transaction).await?;
        let mut ancestors = Vec::with_capacity(rows.len());
        for row in rows {
            let id = IndividualId::of(row.id);
            ancestors.push(Ancestor {
                id,
                depth: steps.remove(&id).unwrap_or(0),
                place: Place { stage: row.stage, generation: row.generation, index: row.idx },
                operator: row.operator,
                status: row.status,
                fitness: row.fitness_bits.map(|bits| f64::from_bits(bits.cast_unsigned())),
                parents: parents.remove(&row.id).unwrap_or_default(),
            });
        }
        ancestors.sort_by_key(|ancestor| (ancestor.depth, ancestor.id));
        Ok(ancestors)
    }
}

/// The shortest way back to each ancestor, in steps.
fn steps(
    of: IndividualId,
    parents: &BTreeMap<i64, Vec<Link>>,
    depth: u32,
    line: bool,
) -> BTreeMap<IndividualId, u32> {
    let mut steps = BTreeMap::new();
    let mut ahead = VecDeque::from([(of, 0)]);
    while let Some((child, so_far)) = ahead.pop_front() {
        if depth > 0 && so_far == depth {
            continue;
        }
        let links = parents.get(&child.sql()).map_or(&[][..], Vec::as_slice);
        for link in links.iter().take(if line { 1 } else { links.len() }) {
            if let Entry::Vacant(first) = steps.entry(link.parent) {
                first.insert(so_far + 1);
                ahead.push_back((link.parent, so_far + 1));
            }
        }
    }
    steps
}

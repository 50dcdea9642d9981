//! The lineage hash (design: determinism): BLAKE3 over the canonical rows of an experiment, equal for any
//! number of workers and for any kill and resume. It reads no database; whoever does, streams rows in order
//! of run and place, and the pick at the end of a stage behind that stage's rows.

use crate::Place;

/// One individual with its outcome, as hashed.
#[derive(Debug, Clone, Copy)]
pub struct HashRow<'a> {
    /// Which repetition, from 1.
    pub run: u32,
    /// Where it stands in the run.
    pub place: Place,
    /// Canonical bytes.
    pub genotype: &'a [u8],
    /// Parents with their roles, in the order in which the search named them.
    pub parents: &'a [(Place, &'a str)],
    /// How it was made.
    pub operator: &'a str,
    /// `completed`, `culled`, `aborted:REASON`, `failed` or `pending`, as in the lineage.
    pub status: &'a str,
    /// Its fitness to the bit; 0.0 while pending.
    pub fitness: f64,
}

/// Takes rows in order and gives their hash.
#[derive(Debug)]
pub struct LineageHasher {
    hasher: blake3::Hasher,
    last: Option<(u32, Place)>,
}

impl Default for LineageHasher {
    fn default() -> Self {
        LineageHasher::new()
    }
}

impl LineageHasher {
    /// The hash of no rows so far.
    pub fn new() -> Self {
        LineageHasher { hasher: blake3::Hasher::new_derive_key("hatchery 2026-11 lineage"), last: None }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If rows do not ascend by run and place: a hash of another order would compare with nothing.
    pub fn row(&mut self, row: &HashRow<'_>) {
        let here = (row.run, row.place);
        assert!(self.last < Some(here), "rows of a lineage hash ascend by run and place");
        let stage = |(run, place): (u32, Place)| (run, place.stage);
        if self.last.map(stage) != Some(stage(here)) {
            self.text("stage");
            self.number(row.run);
            self.number(row.place.stage);
        }
        self.last = Some(here);
        self.text("individual");
        self.number(row.place.generation);
        self.number(row.place.index);
        self.bytes(row.genotype);
        self.number(row.parents.len() as u32);
        for (parent, role) in row.parents {
            self.number(parent.stage);
            self.number(parent.generation);
            self.number(parent.index);
            self.text(role);
        }
        self.text(row.operator);
        self.text(row.status);
        self.hasher.update(&row.fitness.to_bits().to_le_bytes());
    }

    /// Adds who went on from the stage of the row before. Who picked does not count.
    ///
    /// # Panics
    /// If the pick is of another stage than the row before.
    pub fn pick(&mut self, run: u32, stage: u32, picked: Place) {
        let here = self.last.map(|(run, place)| (run, place.stage));
        assert_eq!(here, Some((run, stage)), "a pick follows the rows of its stage");
        self.text("pick");
        self.number(picked.stage);
        self.number(picked.generation);
        self.number(picked.index);
    }

    /// The hash of the rows so far.
    pub fn finish(&self) -> [u8; 32] {
        *self.hasher.finalize().as_bytes()
    }

    fn number(&mut self, number: u32) {
        self.hasher.update(&number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    /// Length first, so that no two rows of different fields give the same stream.
    fn bytes(&mut self, bytes: &[u8]) {
        self.hasher.update(&(bytes.len() as u64).to_le_bytes());
        self.hasher.update(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: Place = Place { stage: 0, generation: 2, index: 3 };
    const PARENT: Place = Place { stage: 0, generation: 1, index: 0 };

    fn row() -> HashRow<'static> {
        HashRow {
            run: 1,
            place: AT,
            genotype: b"ab",
            parents: &[(PARENT, "only")],
            operator: "copy+tag",
            status: "completed",
            fitness: 1.5,
        }
    }

    fn hash(rows: &[HashRow<'_>]) -> [u8; 32] {
        let mut hasher = LineageHasher::new();
        rows.iter().for_each(|row| hasher.row(row));
        hasher.finish()
    }

    #[test]
    fn every_field_counts_and_its_borders_too() {
        let same = hash(&[row()]);
        assert_eq!(same, hash(&[row()]));
        let other_parent = [(Place { index: 1, ..PARENT }, "only")];
        let others = [
            HashRow { run: 2, ..row() },
            HashRow { place: Place { stage: 1, ..AT }, ..row() },
            HashRow { place: Place { generation: 3, ..AT }, ..row() },
            HashRow { place: Place { index: 4, ..AT }, ..row() },
            HashRow { genotype: b"abc", ..row() },
            HashRow { parents: &[], ..row() },
            HashRow { parents: &other_parent, ..row() },
            HashRow { parents: &[(PARENT, "first")], ..row() },
            HashRow { operator: "copy", ..row() },
            HashRow { operator: "copy+tagc", status: "ompleted", ..row() },
            HashRow { status: "culled", ..row() },
            HashRow { fitness: 1.5000000000000002, ..row() },
            HashRow { fitness: 0.0, ..row() },
            HashRow { fitness: -0.0, ..row() },
        ];
        let mut seen: Vec<_> = others.iter().map(|row| hash(&[*row])).chain([same]).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), others.len() + 1);
    }

    #[test]
    fn a_pick_counts_by_its_place() {
        let mut seen = vec![hash(&[row()])];
        for picked in [AT, Place { index: 4, ..AT }, Place { generation: 3, ..AT }, PARENT] {
            let mut hasher = LineageHasher::new();
            hasher.row(&row());
            hasher.pick(1, 0, picked);
            seen.push(hasher.finish());
        }
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 5);
    }

    #[test]
    #[should_panic(expected = "ascend by run and place")]
    fn rows_out_of_order_are_a_broken_invariant() {
        hash(&[row(), HashRow { place: PARENT, ..row() }]);
    }

    #[test]
    fn the_hash_is_the_same_in_every_release() {
        let hex: String = hash(&[row()]).iter().map(|byte| format!("{byte:02x}")).collect();
        insta::assert_snapshot!(hex, @"97f38bd72b86a3da916cecbba4f6f6f2e620062474a16592c1a9f13d8cf60a6f");
    }
}

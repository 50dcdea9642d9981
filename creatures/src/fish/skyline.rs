//! Symmetric positive definite systems whose columns reach no further than an envelope, laid out once for the
//! couplings between nodes of three unknowns each. It pivots nothing: a pivot that is not positive is
//! the caller's fault.

/// Unknowns of a node.
const AXES: usize = 3;

/// The lower triangle of a symmetric matrix, column by column.
///
/// It is factorised in place without square roots, as `U D⁻¹ Uᵀ` with `D` the diagonal of `U`, and three
/// columns at a time, which saves two of three passes over the rest. Every entry has its terms taken off in the
/// order of the columns, however many of them the processor works on at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Skyline {
    /// (3 nodes + 1), where a column starts in `entries`; the last is where they end.
    starts: Vec<usize>,
    /// (nodes), the row behind the last one that the columns of a node reach.
    ends: Vec<usize>,
    entries: Vec<f64>,
    /// (3 nodes), inverse pivots, once factorised.
    inverses: Vec<f64>,
}

/// A pivot that is not positive, by the number of its unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BadPivot(pub usize);

impl Skyline {
    /// All zero, for so many nodes of which some are coupled, each pair with the lower number first.
    pub fn new(nodes: usize, couplings: impl IntoIterator<Item = (usize, usize)>) -> Skyline {
        let mut last: Vec<usize> = (0..nodes).collect();
        for (lower, upper) in couplings {
            last[lower] = last[lower].max(upper);
        }
        // Elimination couples all that one node is coupled to, so that no column ends before those on its left.
        let ends: Vec<usize> = last
            .iter()
            .scan(0, |reach, &node| {
                *reach = node.max(*reach);
                Some(AXES * (*reach + 1))
            })
            .collect();
        let mut starts = vec![0];
        for column in 0..AXES * nodes {
            starts.push(starts[column] + ends[column / AXES] - column);
        }
        let entries = vec![0.0; starts[AXES * nodes]];
        Skyline { starts, ends, entries, inverses: vec![0.0; AXES * nodes] }
    }

    /// Entries within the envelope.
    pub fn size(&self) -> usize {
        self.entries.len()
    }

    /// Sets every entry to 0.
    pub fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Where the block of a pair of coupled nodes, the lower first, has the first entry of each of its columns;
    /// the other two rows follow. For a node with itself only rows from the diagonal down are held, and column
    /// `a` starts at row `a`.
    pub fn block(&self, lower: usize, upper: usize) -> [usize; AXES] {
        [0, 1, 2].map(|axis| {
            let column = AXES * lower + axis;
            let row = if lower == upper { column } else { AXES * upper };
            self.starts[column] + row - column
        })
    }

    /// Adds a symmetric matrix, given by its columns, to a block of two different nodes.
    #[inline]
    pub fn add(&mut self, block: [usize; AXES], columns: &[[f64; AXES]; AXES]) {
        for (start, column) in block.into_iter().zip(columns) {
            let entries = &mut self.entries[start..start + AXES];
            for (entry, value) in entries.iter_mut().zip(column) {
                *entry += value;
            }
        }
    }

    /// Adds a symmetric matrix, given by its columns, to the block of a node with itself.
    #[inline]
    pub fn add_diagonal(&mut self, block: [usize; AXES], columns: &[[f64; AXES]; AXES]) {
        for (axis, (start, column)) in block.into_iter().zip(columns).enumerate() {
            let entries = &mut self.entries[start..start + AXES - axis];
            for (entry, value) in entries.iter_mut().zip(&column[axis..]) {
                *entry += value;
            }
        }
    }

    /// Factorises in place.
    ///
    /// # Errors
    /// The first pivot that is not positive, or no number.
    pub fn factorise(&mut self) -> Result<(), BadPivot> {
        for (node, &end) in self.ends.iter().enumerate() {
            let first = AXES * node;
            let (head, tail) = self.entries.split_at_mut(self.starts[first + AXES]);
            let (rest, c2) = head.split_at_mut(self.starts[first + 2]);
            let (rest, c1) = rest.split_at_mut(self.starts[first + 1]);
            let c0 = &rest[self.starts[first]..];

            let i0 = invert(c0[0], first)?;
            subtract(c1, &c0[1..], c0[1] * i0);
            subtract(c2, &c0[2..], c0[2] * i0);
            let i1 = invert(c1[0], first + 1)?;
            subtract(c2, &c1[1..], c1[1] * i1);
            let i2 = invert(c2[0], first + 2)?;
            self.inverses[first..first + AXES].copy_from_slice(&[i0, i1, i2]);

            let (c0, c1, c2) = (&c0[3..], &c1[2..], &c2[1..]);
            let offset = self.starts[first + AXES];
            for below in 0..end - first - AXES {
                let (c0, c1, c2) = (&c0[below..], &c1[below..], &c2[below..]);
                let start = self.starts[first + AXES + below] - offset;
                let (f0, f1, f2) = (c0[0] * i0, c1[0] * i1, c2[0] * i2);
                let column = &mut tail[start..start + c0.len()];
                for (((entry, a), b), c) in column.iter_mut().zip(c0).zip(c1).zip(c2) {
                    *entry = *entry - a * f0 - b * f1 - c * f2;
                }
            }
        }
        Ok(())
    }

    /// Solves for a right side, which becomes the solution; the matrix has to be factorised.
    pub fn solve(&self, right: &mut [f64]) {
        for (column, &inverse) in self.inverses.iter().enumerate() {
            let below = &self.entries[self.starts[column] + 1..self.starts[column + 1]];
            let (head, tail) = right.split_at_mut(column + 1);
            head[column] *= inverse;
            subtract(tail, below, head[column]);
        }
        for (column, &inverse) in self.inverses.iter().enumerate().rev() {
            let below = &self.entries[self.starts[column] + 1..self.starts[column + 1]];
            let (head, tail) = right.split_at_mut(column + 1);
            head[column] -= inverse * dot(below, tail);
        }
    }
}

fn invert(pivot: f64, index: usize) -> Result<f64, BadPivot> {
    if pivot > 0.0 { Ok(1.0 / pivot) } else { Err(BadPivot(index)) }
}

/// `target −= factor · source`, as far as the shorter goes.
#[inline]
fn subtract(target: &mut [f64], source: &[f64], factor: f64) {
    for (value, term) in target.iter_mut().zip(source) {
        *value -= term * factor;
    }
}

/// Even and odd terms are summed apart, in order, and added at the end.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut even, mut odd) = (0.0, 0.0);
    let b = &b[..a.len()];
    let (pairs_a, pairs_b) = (a.chunks_exact(2), b.chunks_exact(2));
    let (rest_a, rest_b) = (pairs_a.remainder(), pairs_b.remainder());
    for (a, b) in pairs_a.zip(pairs_b) {
        even += a[0] * b[0];
        odd += a[1] * b[1];
    }
    for (a, b) in rest_a.iter().zip(rest_b) {
        even += a * b;
    }
    even + odd
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;
    use nalgebra::{DMatrix, DVector};

    /// Coupled as a chain with a few longer links, with every block drawn at random and a heavy diagonal.
    fn random_system(seed: u64) -> (Skyline, DMatrix<f64>) {
        let nodes = 7;
        let couplings = [(0, 1), (0, 3), (1, 2), (2, 3), (3, 4), (3, 6), (4, 5), (5, 6)];
        let mut draws = stream(seed, [0, 0, 0], "skyline test");
        let mut skyline = Skyline::new(nodes, couplings);
        let mut dense = DMatrix::zeros(3 * nodes, 3 * nodes);
        let all = couplings.into_iter().chain((0..nodes).map(|node| (node, node)));
        for (lower, upper) in all {
            let mut columns = [[0.0; 3]; 3];
            for (a, b) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
                let value = draws.between(-1.0, 1.0) + if lower == upper && a == b { 20.0 } else { 0.0 };
                (columns[a][b], columns[b][a]) = (value, value);
            }
            let block = skyline.block(lower, upper);
            if lower == upper {
                skyline.add_diagonal(block, &columns);
            } else {
                skyline.add(block, &columns);
            }
            for (a, column) in columns.iter().enumerate() {
                for (b, &value) in column.iter().enumerate() {
                    dense[(3 * upper + b, 3 * lower + a)] = value;
                    dense[(3 * lower + a, 3 * upper + b)] = value;
                }
            }
        }
        (skyline, dense)
    }

    #[test]
    fn it_solves_what_a_dense_solver_solves() {
        for seed in 0..20 {
            let (mut skyline, dense) = random_system(seed);
            let mut draws = stream(seed, [0, 0, 1], "skyline test");
            let right: Vec<f64> = (0..21).map(|_| draws.normal()).collect();
            let expected = dense.lu().solve(&DVector::from_vec(right.clone())).unwrap();
            let mut found = right;
            skyline.factorise().unwrap();
            skyline.solve(&mut found);
            let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-13, "{error}");
        }
    }

    #[test]
    fn a_pivot_that_is_not_positive_is_named() {
        let (mut skyline, _) = random_system(1);
        let block = skyline.block(2, 2);
        skyline.add_diagonal(block, &[[0.0; 3], [0.0, -40.0, 0.0], [0.0; 3]]);
        assert_eq!(skyline.factorise(), Err(BadPivot(7)));
        skyline.clear();
        assert_eq!(skyline.factorise(), Err(BadPivot(0)));
        let (mut skyline, _) = random_system(1);
        let block = skyline.block(3, 3);
        skyline.add_diagonal(block, &[[f64::NAN, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
        assert_eq!(skyline.factorise(), Err(BadPivot(9)));
    }
}

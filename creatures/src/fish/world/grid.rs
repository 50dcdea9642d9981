//! Who is near whom: fishes sorted into cells of the plane once a step, so that looking around costs what is
//! near and not what there is. What it finds is what a search of everybody finds, in the same order.

use super::FishId;
use glam::DVec3;

/// Side of a cell, about two body lengths.
const CELL: f64 = 40.0;

/// Fishes by cells.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    low: [f64; 2],
    /// Cells along x and y.
    counts: [usize; 2],
    /// (cells + 1), where a cell's fishes begin.
    starts: Vec<usize>,
    /// (fishes), by cell, ascending in each.
    fishes: Vec<(FishId, DVec3)>,
}

impl Grid {
    /// With room for so many fishes in a tank, given by its half extents.
    pub fn with_room(half: DVec3, fishes: usize) -> Grid {
        // A cell more on either side, since a node may be pressed into a wall.
        let cells = |half: f64| (2.0 * half / CELL) as usize + 3;
        let starts = Vec::with_capacity(cells(half.x) * cells(half.y) + 1);
        Grid { starts, fishes: Vec::with_capacity(fishes), ..Grid::default() }
    }

    /// Sorts fishes, given in ascending order with where they are. Room is kept from step to step.
    pub fn sort(&mut self, fishes: impl Iterator<Item = (FishId, DVec3)> + Clone) {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (_, at) in fishes.clone() {
            low = [low[0].min(at.x), low[1].min(at.y)];
            high = [high[0].max(at.x), high[1].max(at.y)];
        }
        self.fishes.clear();
        self.starts.clear();
        if low[0] > high[0] {
            self.counts = [0, 0];
            return;
        }
        self.low = low;
        self.counts = [0, 1].map(|axis| ((high[axis] - low[axis]) / CELL) as usize + 1);
        self.starts.resize(self.counts[0] * self.counts[1] + 1, 0);
        for (_, at) in fishes.clone() {
            let cell = self.cell(at);
            self.starts[cell + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let total = self.starts[self.starts.len() - 1];
        self.fishes.resize(total, (FishId(0), DVec3::ZERO));
        for (id, at) in fishes {
            // Starts move on as cells fill, and are moved back below.
            let cell = self.cell(at);
            self.fishes[self.starts[cell]] = (id, at);
            self.starts[cell] += 1;
        }
        for cell in (1..self.starts.len()).rev() {
            self.starts[cell] = self.starts[cell - 1];
        }
        self.starts[0] = 0;
    }

    /// Fills `found` with the fishes within a distance of a point, ascending.
    pub fn within(&self, at: DVec3, distance: f64, found: &mut Vec<FishId>) {
        found.clear();
        if self.fishes.is_empty() {
            return;
        }
        let span = |axis: usize, at: f64| {
            let cells = self.counts[axis] as f64;
            let of = |edge: f64| ((edge - self.low[axis]) / CELL).floor();
            // One cell more on either side, so that rounding loses nobody.
            let first = (of(at - distance) - 1.0).clamp(0.0, cells) as usize;
            first..(of(at + distance) + 2.0).clamp(0.0, cells) as usize
        };
        let (columns, rows) = (span(0, at.x), span(1, at.y));
        if columns.is_empty() {
            return;
        }
        for row in rows {
            let line = row * self.counts[0];
            let fishes = &self.fishes[self.starts[line + columns.start]..self.starts[line + columns.end]];
            let near =
                fishes.iter().filter(|(_, place)| (*place - at).length_squared() <= distance * distance);
            found.extend(near.map(|&(id, _)| id));
        }
        found.sort_unstable();
    }

    fn cell(&self, at: DVec3) -> usize {
        let of = |axis: usize, at: f64| {
            (((at - self.low[axis]) / CELL) as usize).min(self.counts[axis].saturating_sub(1))
        };
        of(1, at.y) * self.counts[0] + of(0, at.x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_grid_finds_what_a_search_of_everybody_finds(
            places in proptest::collection::vec((-210.0..210.0f64, -210.0..210.0f64, -110.0..110.0f64), 0..60),
            (x, y, z, distance) in (-250.0..250.0f64, -250.0..250.0f64, -110.0..110.0f64, 0.0..300.0f64),
        ) {
            let mut grid = Grid::default();
            let mut found = Vec::new();
            let places: Vec<DVec3> = places.into_iter().map(|(x, y, z)| DVec3::new(x, y, z)).collect();
            let fishes = || places.iter().enumerate().map(|(i, &at)| (FishId(i as u32), at));
            for _ in 0..2 {
                grid.sort(fishes()); // twice, since room is kept
            }
            let at = DVec3::new(x, y, z);
            grid.within(at, distance, &mut found);
            let near = |(_, place): &(FishId, DVec3)| (*place - at).length_squared() <= distance * distance;
            let everybody: Vec<FishId> = fishes().filter(near).map(|(id, _)| id).collect();
            prop_assert_eq!(found, everybody);
        }
    }
}

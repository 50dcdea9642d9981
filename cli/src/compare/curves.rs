//! Fitness curves averaged over finished runs (walkers G-67), and the generation at which they level off
//! (G-68). Runs that have not finished are left out, never padded.

use std::io::Write;

use serde::Serialize;

use super::cells::Cell;
use super::statistics::Sample;

/// One generation of a cell, averaged over its runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Point {
    /// From 1.
    pub(crate) generation: u64,
    /// Runs that reached it.
    pub(crate) runs: usize,
    /// The population's best fitness.
    pub(crate) best: f64,
    /// Its mean.
    pub(crate) mean: f64,
    /// Its least.
    pub(crate) worst: f64,
    /// The standard deviation of the best; none for fewer than two runs.
    pub(crate) best_sd: Option<f64>,
}

/// The curve of one cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Curve {
    /// The cell's body.
    pub(crate) body: String,
    /// The cell's method.
    pub(crate) method: String,
    /// In order of generation.
    pub(crate) points: Vec<Point>,
}

/// The curve of a cell's finished runs.
pub(crate) fn curve(cell: &Cell) -> Curve {
    let mut by_number = std::collections::BTreeMap::<u64, [Vec<f64>; 3]>::new();
    for generation in cell.finished().flat_map(|run| &run.generations) {
        let lists = by_number.entry(generation.number).or_default();
        for (list, value) in lists.iter_mut().zip([generation.best, generation.mean, generation.worst]) {
            list.push(value);
        }
    }
    let point = |(generation, [best, mean, worst]): (u64, [Vec<f64>; 3])| {
        let best = Sample::of(&best)?;
        Some(Point {
            generation,
            runs: best.count,
            best: best.mean,
            mean: Sample::of(&mean)?.mean,
            worst: Sample::of(&worst)?.mean,
            best_sd: best.deviation,
        })
    };
    Curve {
        body: cell.body.clone(),
        method: cell.method.clone(),
        points: by_number.into_iter().filter_map(point).collect(),
    }
}

impl Curve {
    /// The first generation at which the best reaches 99 % of its final value (G-68).
    pub(crate) fn plateau(&self) -> Option<u64> {
        self.reaches(0.99)
    }

    /// The first generation at which the best reaches a share of its final value (ESP R-2).
    pub(crate) fn reaches(&self, share: f64) -> Option<u64> {
        let last = self.points.last()?.best;
        // A part of the size below it, so that a curve that ends below zero levels off as well.
        let level = last - (1.0 - share) * last.abs();
        self.points.iter().find(|point| point.best >= level).map(|point| point.generation)
    }
}

/// Writes curves as `body,method,generation,runs,best,mean,worst,best_sd`.
pub(crate) fn write_csv(curves: &[Curve], to: impl Write) -> Result<(), csv::Error> {
    let mut out = csv::Writer::from_writer(to);
    out.write_record(["body", "method", "generation", "runs", "best", "mean", "worst", "best_sd"])?;
    for curve in curves {
        for point in &curve.points {
            out.write_record([
                curve.body.clone(),
                curve.method.clone(),
                point.generation.to_string(),
                point.runs.to_string(),
                point.best.to_string(),
                point.mean.to_string(),
                point.worst.to_string(),
                point.best_sd.map(|deviation| deviation.to_string()).unwrap_or_default(),
            ])?;
        }
    }
    Ok(out.flush()?)
}

#[cfg(test)]
mod tests {
    use super::super::cells::tests::finished;
    use super::*;

    fn of(bests: &[f64]) -> Curve {
        let point = |(&best, generation): (&f64, u64)| Point {
            generation,
            runs: 1,
            best,
            mean: 0.0,
            worst: 0.0,
            best_sd: None,
        };
        Curve { body: "b".into(), method: "m".into(), points: bests.iter().zip(1..).map(point).collect() }
    }

    #[test]
    fn a_curve_is_the_average_of_the_finished_runs() {
        let mut cell = finished("arm", "grn", &[10.0, 14.0]);
        cell.runs.push(super::super::cells::Run { finished: false, ..cell.runs[0].clone() });
        let curve = curve(&cell);
        let last = Point {
            generation: 2,
            runs: 2,
            best: 12.0,
            mean: 6.0,
            worst: 0.0,
            best_sd: Some(8.0_f64.sqrt()),
        };
        assert_eq!(curve.points[1], last);
        let mut csv = Vec::new();
        write_csv(&[curve], &mut csv).unwrap();
        assert_eq!(
            String::from_utf8(csv).unwrap(),
            "body,method,generation,runs,best,mean,worst,best_sd\n\
             arm,grn,1,2,6,3,0,1.4142135623730951\narm,grn,2,2,12,6,0,2.8284271247461903\n"
        );
    }

    #[test]
    fn the_plateau_is_where_the_best_first_reaches_99_per_cent_as_in_walker_g_68() {
        assert_eq!(of(&[50.0, 98.9, 99.0, 98.0, 100.0]).plateau(), Some(3));
        assert_eq!(of(&[0.0, 0.0]).plateau(), Some(1));
        assert_eq!(of(&[-20.0, -10.05, -10.0]).plateau(), Some(2), "also below zero");
        assert_eq!(of(&[]).plateau(), None);
        assert_eq!(of(&[0.5, 0.89, 0.91, 1.0]).reaches(0.9), Some(3));
    }
}

//! The best curves of all cells in one pair of axes, so that a sweep can be read at a glance (flyers F-71,
//! F-72, like the paper's figure 15), as PNG and as SVG. It draws what it is given and averages nothing.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::axes::{self, Extent, Room};
use super::curves::Curve;
use crate::render::drawing::{Drawing, save};

const WIDTH: u32 = 960;
const HEIGHT_MIN: u32 = 560;
/// The room of the names to the right.
const NAMES_WIDTH: u32 = 220;
const NAME_HEIGHT: u32 = 20;
const ROOM: Room = Room { below: 40, left: 68, around: 12, above: 12 };

/// Colours that stay apart for the colour-blind (Okabe and Ito); a ninth curve begins again, drawn thinner.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(86, 180, 233),
    RGBColor(204, 121, 167),
    RGBColor(86, 86, 86),
    RGBColor(200, 185, 20),
];

/// Draws the best curves into `best.png` and `best.svg` in a folder that is there.
///
/// # Errors
/// Nothing to draw, or a file that cannot be written.
pub(crate) fn draw(curves: &[Curve], folder: &Path) -> anyhow::Result<[PathBuf; 2]> {
    let curves: Vec<&Curve> = curves.iter().filter(|curve| !curve.points.is_empty()).collect();
    if curves.is_empty() {
        return Err(anyhow!("no finished run, so no curve to draw"));
    }
    let files = ["best.png", "best.svg"].map(|name| folder.join(name));
    files.iter().try_for_each(|file| save(&Overlay { curves: &curves }, file))?;
    Ok(files)
}

struct Overlay<'a> {
    curves: &'a [&'a Curve],
}

impl Drawing for Overlay<'_> {
    /// As high as the names need.
    fn size(&self) -> (u32, u32) {
        (WIDTH, HEIGHT_MIN.max(NAME_HEIGHT * (self.curves.len() as u32 + 2)))
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let curves = self.curves;
        area.fill(&WHITE)?;
        let (left, names) = area.split_horizontally(WIDTH - NAMES_WIDTH);
        let points = || curves.iter().flat_map(|curve| &curve.points);
        let extent = Extent {
            last: points().map(|point| point.generation).max().unwrap_or(1),
            bottom: points().map(|point| point.best).fold(0.0, f64::min),
            top: points().map(|point| point.best).fold(0.0, f64::max),
        };
        let mut chart = axes::draw(&left, extent, ROOM, "best fitness")?;
        for (index, curve) in curves.iter().enumerate() {
            let line = curve.points.iter().map(|point| (point.generation, point.best));
            chart.draw_series(LineSeries::new(line, style(index)))?;
        }
        // The highest end first, as the eye meets the curves.
        let mut order: Vec<(usize, f64)> =
            curves.iter().map(|curve| curve.points[curve.points.len() - 1].best).enumerate().collect();
        order.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        for (row, (index, end)) in (0..).zip(order) {
            let y = 20 + row * NAME_HEIGHT as i32;
            names.draw(&PathElement::new([(4, y + 7), (28, y + 7)], style(index)))?;
            let Curve { body, method, .. } = curves[index];
            let name = format!("{body}, {method}: {end:.0}");
            names.draw(&Text::new(name, (36, y), ("sans-serif", 14)))?;
        }
        area.present()?;
        Ok(())
    }
}

fn style(index: usize) -> ShapeStyle {
    let width = if index < COLOURS.len() { 3 } else { 1 };
    COLOURS[index % COLOURS.len()].stroke_width(width)
}

#[cfg(test)]
mod tests {
    use super::super::cells::tests::finished;
    use super::super::curves::curve;
    use super::*;

    #[test]
    fn every_cell_is_named_beside_its_curve_the_best_first() {
        let folder = tempfile::tempdir().unwrap();
        let cells = [("flyer", "alpha=0.001", 9235.0), ("flyer", "alpha=0.0003", 15508.0)];
        let curves = cells.map(|(body, method, best)| curve(&finished(body, method, &[best, best])));
        let [png, svg] = draw(&curves, folder.path()).unwrap();
        let svg = std::fs::read_to_string(svg).unwrap();
        let at = |words: &str| svg.find(words).unwrap_or_else(|| panic!("{words}"));
        assert!(at("flyer, alpha=0.0003: 15508") < at("flyer, alpha=0.001: 9235"));
        for colour in ["#0072B2", "#E69F00"] {
            assert_eq!(svg.matches(colour).count(), 2, "a curve and its name have {colour}");
        }
        assert!(std::fs::read(png).unwrap().starts_with(b"\x89PNG"));
    }

    #[test]
    fn nothing_to_draw_is_said_and_many_names_have_room() {
        let folder = tempfile::tempdir().unwrap();
        assert!(draw(&[], folder.path()).unwrap_err().to_string().contains("no finished run"));
        let one = curve(&finished("arm", "grn", &[1.0]));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let [_, svg] = draw(&vec![one; 40], folder.path()).unwrap();
        assert!(std::fs::read_to_string(svg).unwrap().contains("height=\"840\""));
    }
}

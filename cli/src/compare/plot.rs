//! The curves as a picture (walkers G-67, like the paper's figures 4 to 7): a panel a cell, bodies down and
//! methods across, best, mean and worst fitness over generations, as PNG and as SVG. It draws what it is
//! given and averages nothing.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;

use super::axes::{self, Extent, Room};
use super::curves::{Curve, Point};
use crate::render::drawing::{Drawing, save};

const PANEL_WIDTH: u32 = 480;
const PANEL_HEIGHT: u32 = 320;
const HEADING_HEIGHT: u32 = 34;
const LABELS_WIDTH: u32 = 56;
const ROOM: Room = Room { below: 36, left: LABELS_WIDTH, around: 10, above: HEADING_HEIGHT };
/// The room of one line's name in a heading.
const LEGEND_WIDTH: i32 = 66;
/// Panels a side at most: a picture beyond that can neither be read nor held in memory.
const PANELS_MAX: usize = 32;

/// Colours that stay apart for the colour-blind (Okabe and Ito), best, mean and worst.
const COLOURS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(230, 159, 0), RGBColor(86, 86, 86)];

/// A line's name and its value at a point.
type Line = (&'static str, fn(&Point) -> f64);

/// What is drawn of a cell.
const LINES: [Line; 3] =
    [("best", |point| point.best), ("mean", |point| point.mean), ("worst", |point| point.worst)];

/// Draws the curves into `curves.png` and `curves.svg` in a folder, which is made if it is not there.
///
/// # Errors
/// Nothing to draw, too many panels, or a file that cannot be written.
pub(crate) fn draw(curves: &[Curve], folder: &Path) -> anyhow::Result<[PathBuf; 2]> {
    let grid = Grid::of(curves)?;
    std::fs::create_dir_all(folder).with_context(|| format!("{}", folder.display()))?;
    let files = ["curves.png", "curves.svg"].map(|name| folder.join(name));
    files.iter().try_for_each(|file| save(&grid, file))?;
    Ok(files)
}

/// Panels in rows of one body and columns of one method. A cell that has several curves has them in the
/// same panel.
struct Grid<'a> {
    curves: &'a [Curve],
    bodies: Vec<&'a str>,
    methods: Vec<&'a str>,
}

impl<'a> Grid<'a> {
    fn of(curves: &'a [Curve]) -> anyhow::Result<Grid<'a>> {
        if curves.iter().all(|curve| curve.points.is_empty()) {
            return Err(anyhow!("no finished run, so no curve to draw"));
        }
        let distinct = |word: fn(&Curve) -> &str| {
            let mut words: Vec<&str> = Vec::new();
            for curve in curves {
                if !words.contains(&word(curve)) {
                    words.push(word(curve));
                }
            }
            words
        };
        let (bodies, methods) = (distinct(|curve| &curve.body), distinct(|curve| &curve.method));
        if bodies.len() > PANELS_MAX || methods.len() > PANELS_MAX {
            return Err(anyhow!("{} by {} panels, at most {PANELS_MAX} a side", bodies.len(), methods.len()));
        }
        Ok(Grid { curves, bodies, methods })
    }
}

impl Drawing for Grid<'_> {
    fn size(&self) -> (u32, u32) {
        (PANEL_WIDTH * self.methods.len() as u32, PANEL_HEIGHT * self.bodies.len() as u32)
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        area.fill(&WHITE)?;
        let panels = area.split_evenly((self.bodies.len(), self.methods.len()));
        let places =
            self.bodies.iter().flat_map(|body| self.methods.iter().map(move |method| (*body, *method)));
        for (panel, (body, method)) in panels.iter().zip(places) {
            // Both methods of a body share their scale, so that they can be compared by eye.
            let of_body: Vec<_> = self.curves.iter().filter(|curve| curve.body == body).collect();
            let of_cell: Vec<_> = of_body.iter().copied().filter(|curve| curve.method == method).collect();
            self.panel(panel, &format!("{body}, {method}"), &of_cell, &of_body)?;
        }
        area.present()?;
        Ok(())
    }
}

impl Grid<'_> {
    fn panel<B: DrawingBackend>(
        &self,
        panel: &DrawingArea<B, Shift>,
        caption: &str,
        of_cell: &[&Curve],
        of_body: &[&Curve],
    ) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let points = || of_body.iter().flat_map(|curve| &curve.points);
        let extent = Extent {
            last: points().map(|point| point.generation).max().unwrap_or(1),
            bottom: points().map(|point| point.worst).fold(0.0, f64::min),
            top: points().map(|point| point.best).fold(f64::NEG_INFINITY, f64::max),
        };
        heading(panel, caption)?;
        let mut chart = axes::draw(panel, extent, ROOM, "fitness")?;
        for ((_, of), colour) in LINES.into_iter().zip(COLOURS) {
            for curve in of_cell {
                let line = curve.points.iter().map(|point| (point.generation, of(point)));
                chart.draw_series(LineSeries::new(line, colour.stroke_width(2)))?;
            }
        }
        Ok(())
    }
}

/// The cell's name to the left and what the lines are to the right, where no curve can run behind them.
fn heading<B: DrawingBackend>(panel: &DrawingArea<B, Shift>, caption: &str) -> anyhow::Result<()>
where
    B::ErrorType: 'static,
{
    let left = (LABELS_WIDTH + 10) as i32;
    panel.draw(&Text::new(caption.to_owned(), (left, 8), ("sans-serif", 19)))?;
    let mut x = PANEL_WIDTH as i32 - 10 - LEGEND_WIDTH * LINES.len() as i32;
    for ((name, _), colour) in LINES.into_iter().zip(COLOURS) {
        panel.draw(&PathElement::new([(x, 18), (x + 16, 18)], colour.stroke_width(2)))?;
        panel.draw(&Text::new(name, (x + 21, 13), ("sans-serif", 14)))?;
        x += LEGEND_WIDTH;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::cells::tests::finished;
    use super::super::curves::curve;
    use super::*;

    fn table() -> Vec<Curve> {
        [("crawler", "grn", 80.0), ("crawler", "neat", 63.0), ("arm", "grn", 147.0), ("arm", "neat", 202.0)]
            .map(|(body, method, best)| curve(&finished(body, method, &[best, best + 2.0])))
            .to_vec()
    }

    #[test]
    fn every_cell_has_its_panel_with_its_name_and_axes() {
        let folder = tempfile::tempdir().unwrap();
        let [png, svg] = draw(&table(), &folder.path().join("figures")).unwrap();
        let svg = std::fs::read_to_string(svg).unwrap();
        for words in
            ["crawler, grn", "crawler, neat", "arm, grn", "arm, neat", "generation", "fitness", "worst"]
        {
            assert!(svg.contains(words), "{words}");
        }
        let png = std::fs::read(png).unwrap();
        let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        assert_eq!((side(16), side(20)), (2 * PANEL_WIDTH, 2 * PANEL_HEIGHT));
    }

    #[test]
    fn letters_leave_ink_in_the_bitmap() {
        crate::render::letters::register();
        let ink = |caption: &str| {
            let mut pixels = vec![255u8; (PANEL_WIDTH * PANEL_HEIGHT * 3) as usize];
            let area =
                BitMapBackend::with_buffer(&mut pixels, (PANEL_WIDTH, PANEL_HEIGHT)).into_drawing_area();
            area.draw(&Text::new(caption.to_owned(), (20, 20), ("sans-serif", 20))).unwrap();
            drop(area);
            pixels.iter().filter(|&&value| value < 128).count()
        };
        assert_eq!(ink(""), 0);
        assert!(ink("crawler") > 100, "{}", ink("crawler"));
    }

    #[test]
    fn nothing_to_draw_is_said_and_no_file_is_made() {
        let folder = tempfile::tempdir().unwrap();
        let empty = Curve { points: vec![], ..table().remove(0) };
        assert!(draw(&[empty], folder.path()).unwrap_err().to_string().contains("no finished run"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_flat_curve_at_zero_is_drawn() {
        let folder = tempfile::tempdir().unwrap();
        draw(&[curve(&finished("arm", "grn", &[0.0, 0.0]))], folder.path()).unwrap();
    }
}

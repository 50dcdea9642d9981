//! The contact sheet: views down, moments across, with times, a scale bar and charts beneath.

use anyhow::Result;
use creatures::record::{Recording, Shape, Shot};
use glam::{DVec2, DVec3};
use plotters::coord::Shift;
use plotters::prelude::*;

use super::cell::{Camera, Pixels};
use super::moments::{Band, film, stretch, whole};
use super::view::View;
use super::{charts, ink, ruler, solid};

/// Everything is drawn so many times as large as it is shown, and averaged: smooth edges.
pub(super) const SHARP: u32 = 2;

const MARGIN: u32 = 14 * SHARP;
const HEADER: u32 = 50 * SHARP;
const BAND_HEADING: u32 = 40 * SHARP;
const ROW_LABEL: u32 = 42 * SHARP;
/// Where the legend begins, and what a word of it takes.
const LEGEND: u32 = 130 * SHARP;
const LEGEND_STEP: u32 = 80 * SHARP;
const GAP: u32 = 4 * SHARP;
const CHARTS: u32 = 250 * SHARP;
/// Between the last cells and the charts.
const CHARTS_GAP: u32 = 16 * SHARP;
/// The share of a cell that what is in it takes at most.
const FILL: f64 = 0.86;
/// The same of a room, whose walls bound it anyway.
const ROOM_FILL: f64 = 0.96;

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// Letters of a size.
pub(super) fn font(size: u32) -> TextStyle<'static> {
    ("sans-serif", size * SHARP).into_font().color(&ink::TEXT)
}

/// What is where on a sheet.
pub(super) struct Sheet<'a> {
    recording: &'a Recording,
    bands: Vec<Band<'a>>,
    /// Each with the size of its cells.
    rows: Vec<(View, (u32, u32))>,
    /// Pixels of a unit of length, the same in every cell.
    scale: f64,
    /// The place that the cameras look at, if they do not follow the creature.
    fixed: Option<DVec3>,
    /// Whether charts of where it went are beneath.
    is_charted: bool,
}

impl<'a> Sheet<'a> {
    /// Lays a recording out: a camera follows a creature, or sees all of the room that creatures share.
    pub(super) fn of(recording: &'a Recording) -> Sheet<'a> {
        let scene = &recording.scene;
        let (side, above, front) = (View::side(scene), View::above(scene), View::front(scene));
        let room = scene.props.iter().find(|prop| matches!(prop.shape, Shape::Room { .. }));
        if let Some(room) = room {
            let corners = solid::extremes(&room.shape, &room.pose);
            let middle = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
            let across = extent(&corners, middle, &above);
            let scale = ROOM_FILL * f64::from(ROOM_WIDTH) / (2.0 * across.x);
            let rows = [above, side].map(|view| {
                let size = extent(&corners, middle, &view) * 2.0 * scale / ROOM_FILL;
                (view, (ROOM_WIDTH, (size.y.ceil() as u32).clamp(40, 4 * ROOM_WIDTH)))
            });
            let bands = vec![whole(&recording.shots, ROOM_COLUMNS)];
            let rows = rows.to_vec();
            return Sheet { recording, bands, rows, scale, fixed: Some(middle), is_charted: true };
        }
        let mut bands = vec![whole(&recording.shots, COLUMNS)];
        bands.extend(stretch(&recording.shots, COLUMNS));
        // A fish's front is hardly more than its mouth.
        let is_soft =
            scene.parts.iter().flat_map(|part| &part.shapes).any(|shape| matches!(shape, Shape::Skin { .. }));
        let views = if is_soft { vec![side, above] } else { vec![side, above, front] };
        let mut sheet = Sheet { recording, bands, rows: vec![], scale: 1.0, fixed: None, is_charted: true };
        let extents: Vec<DVec2> = views.iter().map(|view| sheet.reach(view)).collect();
        let widest = extents.iter().map(|extent| extent.x).fold(0.0, f64::max);
        sheet.scale = FILL * 0.5 * f64::from(WIDTH) / widest;
        sheet.rows = views
            .into_iter()
            .zip(&extents)
            .map(|(view, extent)| {
                let height = (2.0 * extent.y * sheet.scale / FILL).ceil() as u32;
                (view, (WIDTH, height.clamp(WIDTH / 2, WIDTH)))
            })
            .collect();
        let fits = |(_, size): &(View, (u32, u32)), extent: &DVec2| FILL * 0.5 * f64::from(size.1) / extent.y;
        let tallest = sheet.rows.iter().zip(&extents).map(|(row, extent)| fits(row, extent));
        sheet.scale = tallest.fold(sheet.scale, f64::min);
        sheet
    }

    /// Lays out a film: moments from above by a camera that stands still and holds whoever swims, walks or flies.
    pub(super) fn film(recording: &'a Recording) -> Sheet<'a> {
        let above = View::above(&recording.scene);
        let bands = film(&recording.shots, FILM_LINES, FILM_COLUMNS);
        let drawn = bands.iter().flat_map(|band| &band.shots);
        let bodies = drawn.flat_map(|shot| bodies(recording, shot));
        let ways = recording.shots.iter().flat_map(|shot| shot.frame.centers.iter().copied());
        let points: Vec<DVec3> = bodies.chain(ways).collect();
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let middle = 0.5 * (low + high);
        let reach = extent(&points, middle, &above).max(DVec2::splat(f64::MIN_POSITIVE));
        let height_max = f64::from(FILM_HEIGHT_MAX);
        let scale = FILL * 0.5 * (f64::from(FILM_WIDTH) / reach.x).min(height_max / reach.y);
        let height = (2.0 * reach.y * scale / FILL).ceil() as u32;
        let rows = vec![(above, (FILM_WIDTH, height.clamp(FILM_WIDTH / 8, FILM_HEIGHT_MAX)))];
        Sheet { recording, bands, rows, scale, fixed: Some(middle), is_charted: false }
    }

    /// How far the creature reaches from its centre in a view at any moment drawn.
    fn reach(&self, view: &View) -> DVec2 {
        let shots = self.bands.iter().flat_map(|band| &band.shots);
        let reach = shots.fold(DVec2::ZERO, |most, shot| {
            most.max(extent(&bodies(self.recording, shot), center(shot), view))
        });
        if reach.min_element() > 0.0 { reach } else { DVec2::ONE }
    }

    fn columns(&self) -> u32 {
        self.bands.iter().map(|band| band.shots.len()).max().unwrap_or(0).max(1) as u32
    }

    fn row_width(&self) -> u32 {
        let cell = self.rows.first().map_or(WIDTH, |(_, (width, _))| *width);
        ROW_LABEL + self.columns() * (cell + GAP)
    }

    fn band_height(&self) -> u32 {
        BAND_HEADING + self.rows.iter().map(|(_, (_, height))| height + GAP).sum::<u32>()
    }

    /// Pixels across and down, before they are averaged.
    pub(super) fn size(&self) -> (u32, u32) {
        let width = self.row_width().max(WIDTH_MIN) + 2 * MARGIN;
        let charts = if self.is_charted { CHARTS_GAP + CHARTS } else { 0 };
        let height = HEADER + self.bands.len() as u32 * self.band_height() + charts + 2 * MARGIN;
        (width.next_multiple_of(SHARP), height.next_multiple_of(SHARP))
    }

    /// Draws all but the cells.
    pub(super) fn draw(&self, area: &Area<'_>, title: &str, subtitle: &str) -> Result<()> {
        area.fill(&ink::PAPER)?;
        let left = MARGIN as i32;
        area.draw(&Text::new(title.to_owned(), (left, MARGIN as i32), font(19)))?;
        area.draw(&Text::new(subtitle.to_owned(), (left, (MARGIN + 25 * SHARP) as i32), font(13)))?;
        self.scale_bar(area)?;
        self.legend(area)?;
        for (index, band) in self.bands.iter().enumerate() {
            let top = self.band_top(index);
            area.draw(&Text::new(band.name, (left, (top + 4 * SHARP) as i32), font(14)))?;
            for (column, shot) in band.shots.iter().enumerate() {
                let unit = &self.recording.scene.time_unit;
                let time = format!("{:.2} {unit}", shot.time);
                let (x, _) = self.place(index, column, 0);
                let at = (x as i32, (top + BAND_HEADING - 16 * SHARP) as i32);
                area.draw(&Text::new(time, at, font(12)))?;
            }
            for (row, (view, (_, height))) in self.rows.iter().enumerate() {
                let (_, y) = self.place(index, 0, row);
                let at = (left, (y + height / 2 - 7 * SHARP) as i32);
                area.draw(&Text::new(view.name, at, font(12)))?;
            }
        }
        if !self.is_charted {
            return Ok(());
        }
        let (width, height) = self.size();
        let top = height - MARGIN - CHARTS;
        let charts = area.clone().shrink((MARGIN, top), (width - 2 * MARGIN, CHARTS));
        charts::draw(&charts, self.recording, &self.bands[0])
    }

    /// The cells and where their upper left corners are.
    pub(super) fn cells(&self) -> impl Iterator<Item = Result<((u32, u32), Pixels)>> + '_ {
        self.bands.iter().enumerate().flat_map(move |(band, of)| {
            of.shots.iter().enumerate().flat_map(move |(column, shot)| {
                self.rows.iter().enumerate().map(move |(row, &(view, size))| {
                    let middle = self.fixed.unwrap_or_else(|| center(shot));
                    let camera = Camera { view, middle, scale: self.scale, size };
                    Ok((self.place(band, column, row), camera.draw(self.recording, &shot.frame)?))
                })
            })
        })
    }

    /// What the colours say, beside the first band's name.
    fn legend(&self, area: &Area<'_>) -> Result<()> {
        let y = (self.band_top(0) + 4 * SHARP) as i32;
        let mut x = (MARGIN + LEGEND) as i32;
        for (name, colour) in ink::legend(&self.recording.scene) {
            let dot = (x, y + 9 * SHARP as i32);
            area.draw(&Circle::new(dot, 5 * SHARP, colour.filled()))?;
            area.draw(&Text::new(name.to_owned(), (x + 10 * SHARP as i32, y + SHARP as i32), font(12)))?;
            x += LEGEND_STEP as i32;
        }
        Ok(())
    }

    fn scale_bar(&self, area: &Area<'_>) -> Result<()> {
        let length = ruler::round_below(f64::from(WIDTH) / self.scale);
        let pixels = (length * self.scale).round() as i32;
        let (right, y) = ((self.size().0 - MARGIN) as i32, (MARGIN + 30 * SHARP) as i32);
        let tick = 4 * SHARP as i32;
        for line in [
            [(right - pixels, y), (right, y)],
            [(right - pixels, y - tick), (right - pixels, y + tick)],
            [(right, y - tick), (right, y + tick)],
        ] {
            area.draw(&PathElement::new(line, ink::TEXT.stroke_width(SHARP)))?;
        }
        let words = ruler::words(length, &self.recording.scene.length_unit);
        area.draw(&Text::new(words, (right - pixels, y - 20 * SHARP as i32), font(13)))?;
        Ok(())
    }

    fn band_top(&self, band: usize) -> u32 {
        MARGIN + HEADER + band as u32 * self.band_height()
    }

    fn place(&self, band: usize, column: usize, row: usize) -> (u32, u32) {
        let above: u32 = self.rows[..row].iter().map(|(_, (_, height))| height + GAP).sum();
        let cell = self.rows.first().map_or(WIDTH, |(_, (width, _))| *width);
        let x = MARGIN + ROW_LABEL + column as u32 * (cell + GAP);
        (x, self.band_top(band) + BAND_HEADING + above)
    }
}

/// Moments across, and pixels of a cell, where a camera follows.
const COLUMNS: usize = 8;
const WIDTH: u32 = 150 * SHARP;
/// The same where it sees all of a room.
const ROOM_COLUMNS: usize = 5;
const ROOM_WIDTH: u32 = 240 * SHARP;
/// Lines and columns of a film, and the pixels of its cells.
const FILM_LINES: usize = 2;
const FILM_COLUMNS: usize = 4;
const FILM_WIDTH: u32 = 270 * SHARP;
const FILM_HEIGHT_MAX: u32 = 360 * SHARP;
/// The charts want so much.
const WIDTH_MIN: u32 = 900 * SHARP;

/// Of the creature that a camera follows.
fn center(shot: &Shot) -> DVec3 {
    shot.frame.centers.first().copied().unwrap_or_default()
}

/// The points of all creatures that matter to how much room they take.
pub(super) fn bodies(recording: &Recording, shot: &Shot) -> Vec<DVec3> {
    let parts = recording.scene.parts.iter().zip(&shot.frame.poses);
    let own = parts.filter(|(part, _)| part.creature.is_some());
    own.flat_map(|(part, pose)| part.shapes.iter().flat_map(|shape| solid::extremes(shape, pose))).collect()
}

/// How far points lie from a place in a view, across and up.
fn extent(points: &[DVec3], from: DVec3, view: &View) -> DVec2 {
    points.iter().fold(DVec2::ZERO, |most, &point| most.max(view.flat(point - from).abs()))
}

//! Where the centres of mass went, beneath the moments: their way from above with that of the lights, their height
//! and their speed over time.

use anyhow::Result;
use creatures::record::{Pose, Recording, Shape, Shot};
use glam::DVec2;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::ink;
use super::moments::Band;
use super::sheet::{SHARP, font};
use super::view::View;

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// Speeds are taken over this share of a trial at most, so that they can be read.
const SMOOTH: usize = 200;
const LABELS: u32 = 46 * SHARP;
const HEADING: u32 = 22 * SHARP;
const MARGIN: u32 = 8 * SHARP;

/// Draws the three charts side by side.
pub(super) fn draw(area: &Area<'_>, recording: &Recording, marked: &Band<'_>) -> Result<()> {
    let scene = &recording.scene;
    let (length, time) = (scene.length_unit.as_str(), scene.time_unit.as_str());
    let speed = if length.is_empty() { String::new() } else { format!("{length}/{time}") };
    let above = View::above(scene);
    let step = (recording.shots.len() / SMOOTH).max(1);
    let way = |shot: &Shot, creature: usize| above.flat(shot.frame.centers[creature]);
    let height =
        |shot: &Shot, creature: usize| DVec2::new(shot.time, scene.up.dot(shot.frame.centers[creature]));
    let [left, middle, right] = &area.split_evenly((1, 3))[..] else { unreachable!("three were asked for") };
    let lines = |of: &dyn Fn(&Shot, usize) -> DVec2| -> Vec<Vec<DVec2>> {
        let creatures = 0..scene.creatures.len();
        creatures.map(|creature| recording.shots.iter().map(|shot| of(shot, creature)).collect()).collect()
    };
    let marks = |of: &dyn Fn(&Shot, usize) -> DVec2| -> Vec<DVec2> {
        if scene.creatures.len() != 1 {
            return vec![];
        }
        marked.shots.iter().map(|shot| of(shot, 0)).collect()
    };
    let speeds =
        (0..scene.creatures.len()).map(|creature| speeds(&recording.shots, creature, step)).collect();
    let charts = [
        (
            left,
            Chart {
                title: "way from above".to_owned(),
                axes: [labelled("ahead", length), labelled("to the left", length)],
                lines: lines(&way),
                marks: marks(&way),
                lights: lights(recording, marked, &above),
                is_map: true,
            },
        ),
        (
            middle,
            Chart {
                title: "height".to_owned(),
                axes: [labelled("time", time), labelled("height", length)],
                lines: lines(&height),
                marks: marks(&height),
                lights: vec![],
                is_map: false,
            },
        ),
        (
            right,
            Chart {
                title: "speed".to_owned(),
                axes: [labelled("time", time), labelled("speed", &speed)],
                lines: speeds,
                marks: vec![],
                lights: vec![],
                is_map: false,
            },
        ),
    ];
    for (area, chart) in charts {
        chart.draw(area, &|creature| ink::trail(scene, creature))?;
    }
    Ok(())
}

/// The way of every light, and where it is in the moments that are drawn above.
fn lights(recording: &Recording, marked: &Band<'_>, view: &View) -> Vec<[Vec<DVec2>; 2]> {
    let parts = recording.scene.parts.iter().enumerate();
    let is_light = |shape: &Shape| matches!(shape, Shape::Light { .. });
    let lights = parts.filter(|(_, part)| part.shapes.iter().any(is_light));
    let place = |shot: &Shot, part: usize| match shot.frame.poses.get(part)? {
        Pose::Rigid { position, .. } => Some(view.flat(*position)),
        Pose::Absent | Pose::Nodes(_) => None,
    };
    lights
        .map(|(part, _)| {
            let way = recording.shots.iter().filter_map(|shot| place(shot, part)).collect();
            [way, marked.shots.iter().filter_map(|shot| place(shot, part)).collect()]
        })
        .collect()
}

/// Time and speed of a creature's centre between frames that are `step` apart.
fn speeds(shots: &[Shot], creature: usize, step: usize) -> Vec<DVec2> {
    let pairs = shots.iter().zip(shots.iter().skip(step)).step_by(step);
    pairs
        .filter(|(before, after)| after.time > before.time)
        .map(|(before, after)| {
            let way = (after.frame.centers[creature] - before.frame.centers[creature]).length();
            DVec2::new(0.5 * (before.time + after.time), way / (after.time - before.time))
        })
        .collect()
}

fn labelled(what: &str, unit: &str) -> String {
    if unit.is_empty() { what.to_owned() } else { format!("{what}, {unit}") }
}

/// The points that lie at least two pixels apart, and the last: a broad line through nearer ones has gaps.
/// `scale` is in pixels, across and up.
pub(super) fn thinned(line: &[DVec2], scale: DVec2) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = Vec::new();
    for &point in line {
        if kept.last().is_none_or(|&last| ((point - last) * scale).length() >= 2.0) {
            kept.push(point);
        }
    }
    if let (Some(&end), Some(last)) = (line.last(), kept.last_mut().filter(|_| line.len() > 1)) {
        *last = end;
    }
    kept
}

/// A tick's label: the digits that tell ticks of a range apart, and no minus before nothing.
fn figure(value: f64, range: f64) -> String {
    let digits = (1.0 - range.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

struct Chart {
    title: String,
    /// Names of the axes.
    axes: [String; 2],
    /// One a creature.
    lines: Vec<Vec<DVec2>>,
    /// The moments that are drawn above.
    marks: Vec<DVec2>,
    /// The ways of lights, each with its places in those moments.
    lights: Vec<[Vec<DVec2>; 2]>,
    /// Whether both axes share their scale.
    is_map: bool,
}

impl Chart {
    fn draw(&self, area: &Area<'_>, colour: &dyn Fn(usize) -> RGBColor) -> Result<()> {
        let (width, height) = area.dim_in_pixel();
        let room = DVec2::new(
            f64::from(width.saturating_sub(LABELS + 2 * MARGIN)),
            f64::from(height.saturating_sub(LABELS + HEADING + MARGIN)),
        );
        let (low, high) = self.ranges(room);
        area.draw(&Text::new(self.title.clone(), ((LABELS + MARGIN) as i32, 2), font(14)))?;
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .margin_top(HEADING)
            .x_label_area_size(LABELS * 3 / 4)
            .y_label_area_size(LABELS)
            .build_cartesian_2d(low.x..high.x, low.y..high.y)?;
        chart
            .configure_mesh()
            .light_line_style(ink::PAPER)
            .bold_line_style(ink::GRID)
            .x_labels(6)
            .y_labels(5)
            .x_desc(&self.axes[0])
            .y_desc(&self.axes[1])
            .x_label_formatter(&|value| figure(*value, high.x - low.x))
            .y_label_formatter(&|value| figure(*value, high.y - low.y))
            .label_style(font(11))
            .axis_desc_style(font(12))
            .draw()?;
        for [way, marks] in &self.lights {
            let points = thinned(way, room / (high - low)).into_iter().map(|at| (at.x, at.y));
            chart.draw_series(LineSeries::new(points, ink::LIGHT.stroke_width(SHARP)))?;
            let mark = |at: &DVec2| Circle::new((at.x, at.y), 4 * SHARP, ink::LIGHT.filled());
            chart.draw_series(marks.iter().map(mark))?;
        }
        for (creature, line) in self.lines.iter().enumerate() {
            let points = thinned(line, room / (high - low));
            let points = points.into_iter().map(|at| (at.x, at.y));
            chart.draw_series(LineSeries::new(points, colour(creature).stroke_width(SHARP)))?;
        }
        let mark = |at: &DVec2| Circle::new((at.x, at.y), 3 * SHARP, ink::TEXT.filled());
        chart.draw_series(self.marks.iter().map(mark))?;
        Ok(())
    }

    /// What the axes run from and to: all lines with some room about them.
    fn ranges(&self, room: DVec2) -> (DVec2, DVec2) {
        let ways = self.lights.iter().map(|[way, _]| way);
        let all = || self.lines.iter().chain(ways.clone()).flatten();
        let low = all().copied().reduce(DVec2::min).unwrap_or(DVec2::ZERO);
        let high = all().copied().reduce(DVec2::max).unwrap_or(DVec2::ONE);
        let middle = 0.5 * (low + high);
        let mut half = 0.5 * (high - low);
        half = DVec2::select(half.cmpgt(DVec2::splat(1e-9)), half, DVec2::splat(0.5)) * 1.06;
        if self.is_map {
            half = room * (half / room).max_element();
        }
        (middle - half, middle + half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_line_keeps_its_ends_and_no_crowd() {
        let line: Vec<DVec2> = (0..=100).map(|x| DVec2::new(f64::from(x), 0.0)).collect();
        let kept = thinned(&line, DVec2::splat(0.5));
        assert_eq!((kept[0], kept[1], kept.len()), (line[0], line[4], 26));
        assert_eq!(kept.last(), line.last());
        assert_eq!(thinned(&line[..1], DVec2::ONE), line[..1]);
        assert_eq!(thinned(&[], DVec2::ONE), []);
    }

    #[test]
    fn ticks_have_the_digits_that_tell_them_apart() {
        assert_eq!([figure(-0.0, 2.0), figure(0.25, 0.9), figure(-1e-12, 0.5)], ["0.0", "0.25", "0.00"]);
        assert_eq!([figure(120.0, 300.0), figure(-5.0, 12.0)], ["120", "-5"]);
    }
}

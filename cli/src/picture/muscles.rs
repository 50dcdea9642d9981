//! What muscles did: creatures across, segments or single muscles down, how far each muscle was contracted over time,
//! as PNG or as SVG. Of two muscles on one side of a segment the second is the thin dark line.

use std::path::Path;

use anyhow::anyhow;
use creatures::record::Recording;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::ink;
use crate::render::drawing::{Drawing, save};

const PANEL_WIDTH: u32 = 460;
const PANEL_HEIGHT: u32 = 150;
const HEADER: u32 = 74;
const FOOTER: u32 = 24;
const LABELS: u32 = 48;
const MARGIN: u32 = 10;
/// Creatures and segments at most: a picture beyond that can neither be read nor held in memory.
const CREATURES_MAX: usize = 32;
const SEGMENTS_MAX: usize = 64;

/// Draws what the muscles of every creature did in all of a recording.
///
/// # Errors
/// A recording that tells of no muscles, too many creatures, or a file that cannot be written.
pub(crate) fn draw(recording: &Recording, captions: &[String; 2], file: &Path) -> anyhow::Result<()> {
    save(&Chart::of(recording, captions)?, file)
}

struct Chart<'a> {
    recording: &'a Recording,
    captions: &'a [String; 2],
    /// Each with the places of its muscles.
    segments: Vec<(&'a str, Vec<usize>)>,
}

impl<'a> Chart<'a> {
    fn of(recording: &'a Recording, captions: &'a [String; 2]) -> anyhow::Result<Chart<'a>> {
        let scene = &recording.scene;
        let mut segments: Vec<(&str, Vec<usize>)> = Vec::new();
        for (place, name) in scene.muscles.iter().enumerate() {
            let segment = segment(name);
            match segments.iter_mut().find(|(other, _)| *other == segment) {
                Some((_, muscles)) => muscles.push(place),
                None => segments.push((segment, vec![place])),
            }
        }
        if segments.is_empty() || recording.shots.is_empty() {
            return Err(anyhow!("there are no muscles to draw: the recording tells of none"));
        }
        if segments.len() > SEGMENTS_MAX {
            return Err(anyhow!("{} muscles below each other, at most {SEGMENTS_MAX}", segments.len()));
        }
        if scene.creatures.len() > CREATURES_MAX {
            return Err(anyhow!(
                "{} creatures beside each other, at most {CREATURES_MAX}",
                scene.creatures.len()
            ));
        }
        Ok(Chart { recording, captions, segments })
    }
}

impl Drawing for Chart<'_> {
    fn size(&self) -> (u32, u32) {
        let (across, down) = (self.recording.scene.creatures.len() as u32, self.segments.len() as u32);
        (PANEL_WIDTH * across, HEADER + PANEL_HEIGHT * down + FOOTER)
    }

    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let [title, subtitle] = self.captions;
        area.fill(&ink::PAPER)?;
        let (header, rest) = area.split_vertically(HEADER);
        let (panels, footer) = rest.split_vertically(PANEL_HEIGHT * self.segments.len() as u32);
        let creatures = &self.recording.scene.creatures;
        header.draw(&Text::new(title.clone(), (LABELS as i32, 6), letters(18)))?;
        header.draw(&Text::new(subtitle.clone(), (LABELS as i32, 30), letters(13)))?;
        for (creature, name) in creatures.iter().enumerate() {
            let left = (PANEL_WIDTH * creature as u32) as i32;
            header.draw(&Text::new(name.clone(), (left + LABELS as i32, 51), letters(15)))?;
            let time = (left + (PANEL_WIDTH + LABELS) as i32 / 2 - 12, 4);
            footer.draw(&Text::new("time", time, letters(13)))?;
        }
        if self.segments.iter().any(|(_, muscles)| muscles.len() > 1) {
            legend(&header)?;
        }
        let panels = panels.split_evenly((self.segments.len(), creatures.len()));
        let places =
            self.segments.iter().flat_map(|segment| (0..creatures.len()).map(move |of| (segment, of)));
        for (panel, ((segment, muscles), creature)) in panels.iter().zip(places) {
            self.panel(panel, segment, muscles, creature)?;
        }
        area.present()?;
        Ok(())
    }
}

impl Chart<'_> {
    fn panel<B: DrawingBackend>(
        &self,
        panel: &DrawingArea<B, Shift>,
        segment: &str,
        muscles: &[usize],
        creature: usize,
    ) -> anyhow::Result<()>
    where
        B::ErrorType: 'static,
    {
        let shots = &self.recording.shots;
        let [from, to] = [shots.first(), shots.last()].map(|shot| shot.map_or(0.0, |shot| shot.time));
        let mut chart = ChartBuilder::on(panel)
            .margin(MARGIN)
            .x_label_area_size(20)
            .y_label_area_size(LABELS)
            .build_cartesian_2d(from..to.max(from + self.recording.scene.step), 0.0..1.0)?;
        chart
            .configure_mesh()
            .light_line_style(ink::PAPER)
            .bold_line_style(ink::GRID)
            .x_labels(6)
            .y_labels(3)
            .y_desc(segment)
            .label_style(letters(12))
            .axis_desc_style(letters(13))
            .draw()?;
        let name = |muscle: usize| self.recording.scene.muscles[muscle].as_str();
        for (place, &muscle) in muscles.iter().enumerate() {
            let colour = ink::side(name(muscle));
            let of_side = muscles[..place].iter().filter(|&&other| ink::side(name(other)) == colour).count();
            let style = match of_side {
                0 => colour.stroke_width(3),
                _ => ink::lit(colour, 0.5).stroke_width(1),
            };
            let told = shots
                .iter()
                .filter_map(|shot| Some((shot.time, *shot.frame.muscles.get(creature)?.get(muscle)?)));
            chart.draw_series(LineSeries::new(told, style))?;
        }
        Ok(())
    }
}

/// Of `SIDE_SEGMENT_HEIGHT` the segment; a muscle of any other name has a panel for itself.
fn segment(name: &str) -> &str {
    let mut words = name.split('_');
    match (words.next(), words.next()) {
        (Some("left" | "right"), Some(segment)) => segment,
        _ => name,
    }
}

fn letters(size: u32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&ink::TEXT)
}

/// Which side has which colour, to the right.
fn legend<B: DrawingBackend>(header: &DrawingArea<B, Shift>) -> anyhow::Result<()>
where
    B::ErrorType: 'static,
{
    let (width, _) = header.dim_in_pixel();
    for (at, (name, colour)) in (0..).zip(ink::SIDES) {
        let x = width as i32 - 130 + 64 * at;
        header.draw(&PathElement::new([(x, 60), (x + 18, 60)], colour.stroke_width(3)))?;
        header.draw(&Text::new(name, (x + 23, 53), letters(13)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tests::{captions, recorded};
    use super::*;

    #[test]
    fn every_segment_has_a_panel_in_bitmaps_and_in_vectors() {
        let folder = tempfile::tempdir().unwrap();
        let recording = recorded("fish", 0);
        let [svg, png] = ["a.svg", "a.png"].map(|name| folder.path().join(name));
        draw(&recording, &captions(), &svg).unwrap();
        let svg = std::fs::read_to_string(svg).unwrap();
        for words in ["title", "subtitle", "front", "middle", "rear", "left", "right", "time"] {
            assert!(svg.contains(words), "{words}");
        }
        // Twelve muscles, each with a line through all shots.
        let lines = svg.matches("<polyline").count();
        assert!(lines >= 12, "{lines} lines");
        draw(&recording, &captions(), &png).unwrap();
        assert!(std::fs::read(png).unwrap().starts_with(b"\x89PNG"));
    }

    #[test]
    fn muscles_without_sides_have_a_panel_each() {
        let (recording, captions) = (recorded("esp", 0), captions());
        let chart = Chart::of(&recording, &captions).unwrap();
        assert_eq!(chart.segments.len(), recording.scene.muscles.len());
        assert_eq!(["left_front_top", "left", "a_b"].map(segment), ["front", "left", "a_b"]);
    }

    #[test]
    fn who_has_no_muscles_is_not_drawn() {
        let folder = tempfile::tempdir().unwrap();
        let error =
            draw(&recorded("walker", 0), &captions(), &folder.path().join("a.png")).unwrap_err().to_string();
        assert!(error.contains("no muscles"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

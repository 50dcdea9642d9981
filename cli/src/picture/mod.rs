//! A recording as a picture: a contact sheet, a film from above, a chart of its muscles. It draws what was recorded
//! and moves nothing.

mod cell;
mod charts;
mod ink;
mod lanes;
mod moments;
mod muscles;
mod ruler;
mod sheet;
mod solid;
mod view;

use std::path::Path;

use anyhow::anyhow;
use creatures::record::Recording;
use plotters::backend::BitMapBackend;
use plotters::drawing::IntoDrawingArea;

use crate::render::drawing::png;
use crate::render::letters;
use cell::Pixels;
pub(crate) use lanes::beside;
pub(crate) use muscles::draw as muscles;
use sheet::{SHARP, Sheet};

/// How a recording is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layout {
    /// Several views of the whole, with charts of where it went.
    Contact,
    /// Moments from above alone, by a camera that stands still.
    Film,
}

/// Draws a recording into a file, which is named `.png`.
///
/// # Errors
/// Nothing was recorded, or the file cannot be written.
pub(crate) fn draw(
    recording: &Recording,
    layout: Layout,
    [title, subtitle]: &[String; 2],
    file: &Path,
) -> anyhow::Result<()> {
    let sheet = shrunk(&pixels(recording, layout, [title, subtitle])?);
    Ok(png(sheet.size, &sheet.bytes, file)?)
}

/// The sheet before it is shrunk.
fn pixels(recording: &Recording, layout: Layout, [title, subtitle]: [&str; 2]) -> anyhow::Result<Pixels> {
    if recording.shots.is_empty() || recording.scene.creatures.is_empty() {
        return Err(anyhow!("there is nothing to draw: no frame was recorded"));
    }
    letters::register();
    let sheet = match layout {
        Layout::Contact => Sheet::of(recording),
        Layout::Film => Sheet::film(recording),
    };
    let size = sheet.size();
    let mut bytes = vec![255; (size.0 * size.1 * 3) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut bytes, size).into_drawing_area();
        sheet.draw(&area, title, subtitle)?;
        area.present()?;
    }
    let mut whole = Pixels { size, bytes };
    for cell in sheet.cells() {
        let (place, cell) = cell?;
        whole.paste(&cell, place);
    }
    Ok(whole)
}

impl Pixels {
    /// Copies another picture over this one; what would reach beyond is left out.
    fn paste(&mut self, other: &Pixels, (x, y): (u32, u32)) {
        let width = other.size.0.min(self.size.0.saturating_sub(x)) as usize * 3;
        for line in 0..other.size.1.min(self.size.1.saturating_sub(y)) {
            let to = ((y + line) * self.size.0 + x) as usize * 3;
            let from = (line * other.size.0) as usize * 3;
            self.bytes[to..to + width].copy_from_slice(&other.bytes[from..from + width]);
        }
    }
}

/// Each pixel the mean of those that it stands for.
fn shrunk(large: &Pixels) -> Pixels {
    let size = (large.size.0 / SHARP, large.size.1 / SHARP);
    let mut bytes = Vec::with_capacity((size.0 * size.1 * 3) as usize);
    for y in 0..size.1 {
        for x in 0..size.0 {
            for channel in 0..3 {
                let at = |dx: u32, dy: u32| {
                    let pixel = (y * SHARP + dy) * large.size.0 + x * SHARP + dx;
                    u32::from(large.bytes[(pixel * 3 + channel) as usize])
                };
                let sum: u32 = (0..SHARP).flat_map(|dy| (0..SHARP).map(move |dx| at(dx, dy))).sum();
                bytes.push((sum / (SHARP * SHARP)) as u8);
            }
        }
    }
    Pixels { size, bytes }
}

#[cfg(test)]
mod tests;

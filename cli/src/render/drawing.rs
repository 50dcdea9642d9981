//! Drawings into files: what is drawn once comes out as PNG or as SVG, by the file's name. It draws nothing itself.

use std::io;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::{letters, whole};

/// Something that can be drawn on bitmaps and in vectors.
pub(crate) trait Drawing {
    /// Width and height, pixels.
    fn size(&self) -> (u32, u32);

    /// Draws it on an area of its size.
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>
    where
        B::ErrorType: 'static;
}

/// Draws into a file: SVG if it is named so, else PNG.
///
/// # Errors
/// What cannot be drawn, or a file that cannot be written; there is then no file.
pub(crate) fn save(drawing: &impl Drawing, file: &Path) -> anyhow::Result<()> {
    letters::register();
    let size = drawing.size();
    if file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg")) {
        let mut text = String::new();
        drawing.draw(&SVGBackend::with_string(&mut text, size).into_drawing_area())?;
        return Ok(whole::write(file, text.as_bytes())?);
    }
    let mut pixels = vec![255; (size.0 * size.1 * 3) as usize];
    drawing.draw(&BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area())?;
    Ok(png(size, &pixels, file)?)
}

/// Writes a bitmap, three bytes a pixel, as PNG.
///
/// # Errors
/// A file that cannot be written; there is then none.
pub(crate) fn png((width, height): (u32, u32), pixels: &[u8], file: &Path) -> io::Result<()> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    whole::write(file, &bytes)
}

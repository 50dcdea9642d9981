//! A pair of axes for curves over generations: zero in sight, a little air on top, and a mesh that stays behind.

use plotters::coord::Shift;
use plotters::coord::types::{RangedCoordf64, RangedCoordu64};
use plotters::prelude::*;

/// Axes with generations across and fitness upward.
pub(super) type Chart<'a, B> = ChartContext<'a, B, Cartesian2d<RangedCoordu64, RangedCoordf64>>;

/// What is shown: the last generation, and the least and greatest values, the least at most 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub(super) last: u64,
    pub(super) bottom: f64,
    pub(super) top: f64,
}

/// The room of labels below and to the left, and of everything else around, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    pub(super) below: u32,
    pub(super) left: u32,
    pub(super) around: u32,
    pub(super) above: u32,
}

/// Draws axes over all of an area.
pub(super) fn draw<'a, B>(
    area: &DrawingArea<B, Shift>,
    Extent { last, bottom, top }: Extent,
    room: Room,
    values: &str,
) -> anyhow::Result<Chart<'a, B>>
where
    B: DrawingBackend + 'a,
    B::ErrorType: 'static,
{
    let top = if top > bottom { top + 0.05 * (top - bottom) } else { bottom + 1.0 };
    let mut chart = ChartBuilder::on(area)
        .margin(room.around)
        .margin_top(room.above)
        .x_label_area_size(room.below)
        .y_label_area_size(room.left)
        .build_cartesian_2d(1..last.max(2), bottom..top)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc("generation")
        .y_desc(values)
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;
    Ok(chart)
}

//! One moment in one view, as pixels of its own, so that nothing reaches beyond its edge.

use anyhow::Result;
use creatures::record::{Frame, Pose, Recording, Scene, Shape};
use glam::{DVec2, DVec3};
use plotters::coord::Shift;
use plotters::prelude::*;

use super::charts::thinned;
use super::ink;
use super::ruler::round_below;
use super::solid::{self, Face, Look, corners};
use super::view::View;

/// A view at a scale, with something in its middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Camera {
    pub(super) view: View,
    /// What lies in the middle of the cell.
    pub(super) middle: DVec3,
    /// Pixels of a unit of length.
    pub(super) scale: f64,
    /// Pixels across and down.
    pub(super) size: (u32, u32),
}

/// A cell's pixels, three bytes each, line by line.
pub(super) struct Pixels {
    pub(super) size: (u32, u32),
    pub(super) bytes: Vec<u8>,
}

type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// Farther outside than this, in cells, nothing is drawn.
const BEYOND: f64 = 8.0;
/// How much wider than a slack muscle one is that pulls with all its strength, pixels.
const MUSCLE: f64 = 4.0;
/// How dark edges are.
const EDGE: f64 = 0.6;

impl Camera {
    /// Draws a frame of a recording.
    pub(super) fn draw(&self, recording: &Recording, frame: &Frame) -> Result<Pixels> {
        let mut bytes = vec![255; (self.size.0 * self.size.1 * 3) as usize];
        let area = BitMapBackend::with_buffer(&mut bytes, self.size).into_drawing_area();
        area.fill(&ink::PAPER)?;
        self.grid(&area)?;
        let scene = &recording.scene;
        self.ground(&area, scene)?;
        self.rooms(&area, scene)?;
        self.trails(&area, recording)?;
        self.solids(&area, scene, frame)?;
        self.muscles(&area, scene, frame)?;
        self.specks(&area, scene, frame)?;
        let (width, height) = (self.size.0 as i32, self.size.1 as i32);
        area.draw(&Rectangle::new([(0, 0), (width - 1, height - 1)], ink::FRAME.stroke_width(2)))?;
        area.present()?;
        drop(area);
        Ok(Pixels { size: self.size, bytes })
    }

    fn pixel(&self, flat: DVec2) -> (i32, i32) {
        let at = (flat - self.view.flat(self.middle)) * self.scale;
        let half = DVec2::new(f64::from(self.size.0), f64::from(self.size.1)) * 0.5;
        ((half.x + at.x).round() as i32, (half.y - at.y).round() as i32)
    }

    /// Whether a pixel is near enough to the cell to be worth drawing.
    fn is_near(&self, (x, y): (i32, i32)) -> bool {
        let near = |at: i32, size: u32| f64::from(at).abs() < BEYOND * f64::from(size);
        near(x, self.size.0) && near(y, self.size.1)
    }

    /// Lines that stand still in the world, so that who moves is seen to move.
    fn grid(&self, area: &Area<'_>) -> Result<()> {
        let size = DVec2::new(f64::from(self.size.0), f64::from(self.size.1));
        let tick = round_below(0.45 * size.max_element() / self.scale);
        let (low, high) = {
            let (middle, half) = (self.view.flat(self.middle), 0.5 * size / self.scale);
            ((middle - half) / tick, (middle + half) / tick)
        };
        let line = |from: DVec2, to: DVec2| {
            PathElement::new([self.pixel(from * tick), self.pixel(to * tick)], ink::GRID.stroke_width(2))
        };
        for x in low.x.ceil() as i64..=high.x.floor() as i64 {
            area.draw(&line(DVec2::new(x as f64, low.y), DVec2::new(x as f64, high.y)))?;
        }
        for y in low.y.ceil() as i64..=high.y.floor() as i64 {
            area.draw(&line(DVec2::new(low.x, y as f64), DVec2::new(high.x, y as f64)))?;
        }
        Ok(())
    }

    /// The ground from its edge; from above it is the paper.
    fn ground(&self, area: &Area<'_>, scene: &Scene) -> Result<()> {
        let grounds = scene.props.iter().filter(|prop| prop.shape == Shape::Ground);
        for prop in grounds.filter(|_| self.view.is_upright(scene)) {
            let Pose::Rigid { position, .. } = prop.pose else { continue };
            let (_, line) = self.pixel(self.view.flat(position));
            let (width, height) = (self.size.0 as i32, self.size.1 as i32);
            if line < height {
                let line = line.max(0);
                area.draw(&Rectangle::new([(0, line), (width, height)], ink::EARTH.filled()))?;
                let edge = PathElement::new([(0, line), (width, line)], ink::EARTH_LINE.stroke_width(2));
                area.draw(&edge)?;
            }
        }
        Ok(())
    }

    /// The walls of tanks.
    fn rooms(&self, area: &Area<'_>, scene: &Scene) -> Result<()> {
        for prop in &scene.props {
            let (Shape::Room { half }, Pose::Rigid { position, orientation }) = (&prop.shape, &prop.pose)
            else {
                continue;
            };
            let corners = corners(*half).map(|corner| self.view.flat(*position + *orientation * corner));
            let (low, high) =
                corners.iter().fold((corners[0], corners[0]), |(low, high), &at| (low.min(at), high.max(at)));
            let walls = Rectangle::new([self.pixel(low), self.pixel(high)], ink::EARTH_LINE.stroke_width(2));
            area.draw(&walls)?;
        }
        Ok(())
    }

    /// The ways of the centres of mass, through the whole trial.
    fn trails(&self, area: &Area<'_>, recording: &Recording) -> Result<()> {
        for creature in 0..recording.scene.creatures.len() {
            let colour = ink::trail(&recording.scene, creature).mix(0.5);
            let centers = recording.shots.iter().filter_map(|shot| shot.frame.centers.get(creature));
            let way: Vec<DVec2> = centers.map(|&center| self.view.flat(center)).collect();
            let way = thinned(&way, DVec2::splat(self.scale));
            let pixels: Vec<_> = way.into_iter().map(|at| self.pixel(at)).collect();
            for near in pixels.split(|&pixel| !self.is_near(pixel)).filter(|near| near.len() > 1) {
                area.draw(&PathElement::new(near.to_vec(), colour.stroke_width(2)))?;
            }
        }
        Ok(())
    }

    /// Everything that has faces, the farthest first.
    fn solids(&self, area: &Area<'_>, scene: &Scene, frame: &Frame) -> Result<()> {
        let colours = ink::colours(scene);
        let parts = scene.parts.iter().zip(&frame.poses).zip(colours);
        let mut faces: Vec<(Face, RGBColor)> = parts
            .flat_map(|((part, pose), colour)| part.shapes.iter().map(move |shape| (shape, pose, colour)))
            .chain(scene.props.iter().map(|prop| (&prop.shape, &prop.pose, ink::PROP)))
            .flat_map(|(shape, pose, colour)| {
                solid::faces(shape, pose, &self.view).into_iter().map(move |face| (face, colour))
            })
            .collect();
        faces.sort_by(|(a, _), (b, _)| a.nearness.total_cmp(&b.nearness));
        for (face, colour) in &faces {
            self.face(area, face, *colour)?;
        }
        Ok(())
    }

    fn face(&self, area: &Area<'_>, face: &Face, colour: RGBColor) -> Result<()> {
        let mut ring: Vec<_> = face.corners.iter().map(|&corner| self.pixel(corner)).collect();
        if !ring.iter().all(|&pixel| self.is_near(pixel)) {
            return Ok(());
        }
        let lit = ink::lit(colour, face.light);
        let (fill, edge) = match face.look {
            Look::Flat => (lit.mix(1.0), ink::lit(lit, EDGE)),
            Look::Round => (lit.mix(1.0), lit), // no gaps between neighbours
            Look::Film => (lit.mix(0.55), ink::lit(lit, EDGE)),
        };
        area.draw(&Polygon::new(ring.clone(), fill.filled()))?;
        ring.extend(ring.first().copied());
        area.draw(&PathElement::new(ring, edge.stroke_width(1)))?;
        Ok(())
    }

    /// Muscles as lines upon all parts, since they run along them or through them: the more active, the thicker
    /// and the redder.
    fn muscles(&self, area: &Area<'_>, scene: &Scene, frame: &Frame) -> Result<()> {
        let activations = frame.muscles.first().into_iter().flatten();
        for (cord, &activation) in scene.cords.iter().zip(activations) {
            let end = |end: usize| match frame.poses.get(cord.parts[end] as usize)? {
                Pose::Rigid { position, orientation } => {
                    Some(self.pixel(self.view.flat(*position + *orientation * cord.ends[end])))
                }
                Pose::Absent | Pose::Nodes(_) => None,
            };
            let (Some(from), Some(to)) = (end(0), end(1)) else { continue };
            if self.is_near(from) && self.is_near(to) {
                let width = 2 + (MUSCLE * activation).round() as u32;
                area.draw(&PathElement::new([from, to], ink::muscle(activation).stroke_width(width)))?;
            }
        }
        Ok(())
    }

    /// What takes no room: food as dots, lights as rings about a dot.
    fn specks(&self, area: &Area<'_>, scene: &Scene, frame: &Frame) -> Result<()> {
        for (part, pose) in scene.parts.iter().zip(&frame.poses) {
            let Pose::Rigid { position, .. } = pose else { continue };
            let at = self.pixel(self.view.flat(*position));
            for shape in part.shapes.iter().filter(|_| self.is_near(at)) {
                match shape {
                    Shape::Point => area.draw(&Circle::new(at, 3, ink::TEXT.filled()))?,
                    Shape::Light { .. } => {
                        area.draw(&Circle::new(at, 6, ink::LIGHT.filled()))?;
                        area.draw(&Circle::new(at, 11, ink::LIGHT.stroke_width(2)))?;
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }
}

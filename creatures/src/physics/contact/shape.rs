//! Shapes of parts, and what they weigh.

use glam::DVec3;
use rapier3d::prelude::SharedShape;
use std::f64::consts::PI;

/// A solid convex shape about its centre of mass; its principal axes are those of its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Half extents, m.
    Cuboid(DVec3),
    /// Radius, m.
    Ball(f64),
    /// Along x.
    Capsule {
        /// Of the cylinder and its caps, m.
        radius: f64,
        /// Of the straight part, m.
        half_length: f64,
    },
}

impl Shape {
    /// m³.
    pub fn volume(self) -> f64 {
        match self {
            Shape::Cuboid(half) => 8.0 * half.x * half.y * half.z,
            Shape::Ball(radius) => ball(radius),
            Shape::Capsule { radius, half_length } => cylinder(radius, half_length) + ball(radius),
        }
    }

    /// Principal moments of inertia at unit density, m⁵.
    pub fn inertia(self) -> DVec3 {
        match self {
            Shape::Cuboid(half) => {
                let square = half * half;
                let sums = DVec3::new(square.y + square.z, square.z + square.x, square.x + square.y);
                self.volume() / 3.0 * sums
            }
            Shape::Ball(radius) => DVec3::splat(0.4 * radius * radius * ball(radius)),
            Shape::Capsule { radius, half_length } => {
                let (tube, caps) = (cylinder(radius, half_length), ball(radius));
                let square = radius * radius;
                let along = tube * square / 2.0 + caps * square * 0.4;
                // A half ball's centre of mass is 3/8 of the radius beyond the tube's end.
                let reach = half_length * half_length + 0.75 * half_length * radius;
                let across =
                    tube * (square / 4.0 + half_length * half_length / 3.0) + caps * (square * 0.4 + reach);
                DVec3::new(along, across, across)
            }
        }
    }

    /// How far the shape reaches from its centre along a unit direction of its frame, m.
    pub fn reach(self, direction: DVec3) -> f64 {
        match self {
            Shape::Cuboid(half) => half.dot(direction.abs()),
            Shape::Ball(radius) => radius,
            Shape::Capsule { radius, half_length } => radius + half_length * direction.x.abs(),
        }
    }

    /// Radius of the ball about its centre that holds it, m.
    pub(super) fn radius(self) -> f64 {
        match self {
            Shape::Cuboid(half) => half.length(),
            Shape::Ball(radius) => radius,
            Shape::Capsule { radius, half_length } => radius + half_length,
        }
    }

    /// Radius on which it rolls, m; 0 for what has edges.
    pub(super) fn rounding(self) -> f64 {
        match self {
            Shape::Cuboid(_) => 0.0,
            Shape::Ball(radius) | Shape::Capsule { radius, .. } => radius,
        }
    }

    pub(super) fn shared(self) -> SharedShape {
        match self {
            Shape::Cuboid(half) => SharedShape::cuboid(half.x as f32, half.y as f32, half.z as f32),
            Shape::Ball(radius) => SharedShape::ball(radius as f32),
            Shape::Capsule { radius, half_length } => {
                SharedShape::capsule_x(half_length as f32, radius as f32)
            }
        }
    }
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius * radius * radius
}

fn cylinder(radius: f64, half_length: f64) -> f64 {
    2.0 * PI * radius * radius * half_length
}

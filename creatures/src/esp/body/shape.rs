//! The shapes of segments: where a direction leaves them, what they weigh, how thick they are (E-2, E-15, E-24).

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Legal half extents of a box and radii of a sphere, m; also half lengths of a capsule's straight part (E-2).
pub const EXTENT: RangeInclusive<f64> = 0.03..=0.5;
/// Legal radii of a capsule, m (E-2).
pub const CAPSULE_RADIUS: RangeInclusive<f64> = 0.03..=0.3;
/// Density of every segment, kg/m³ (E-2).
pub const DENSITY: f64 = 1000.0;

/// A convex shape about its centre, symmetric in the three planes of its frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// Half extents along x, y and z, m.
    Box([f64; 3]),
    /// Radius, m.
    Sphere(f64),
    /// Along local x.
    Capsule {
        /// Of the cylinder and its caps, m.
        radius: f64,
        /// Of the straight part, m.
        half_length: f64,
    },
}

impl Shape {
    /// Where the ray from the centre along a unit direction leaves the shape, m, segment frame (E-15).
    pub fn surface_point(self, direction: DVec3) -> DVec3 {
        direction * self.exit(direction)
    }

    fn exit(self, direction: DVec3) -> f64 {
        match self {
            Shape::Box(half) => {
                let [x, y, z] = half;
                let size = direction.abs();
                // A component of 0 gives infinity, which is never the least.
                (x / size.x).min(y / size.y).min(z / size.z)
            }
            Shape::Sphere(radius) => radius,
            Shape::Capsule { radius, half_length } => {
                let along = direction.x.abs();
                let across = (direction.y * direction.y + direction.z * direction.z).sqrt();
                if across > 0.0 && along * radius / across <= half_length {
                    radius / across
                } else {
                    let b = half_length * along;
                    b + (b * b - half_length * half_length + radius * radius).max(0.0).sqrt()
                }
            }
        }
    }

    /// The shape with every length times a factor, each then clamped to what is legal (E-13).
    #[must_use]
    pub fn scaled(self, factor: f64) -> Shape {
        let fit =
            |length: f64, legal: RangeInclusive<f64>| (length * factor).clamp(*legal.start(), *legal.end());
        match self {
            Shape::Box(half) => Shape::Box(half.map(|length| fit(length, EXTENT))),
            Shape::Sphere(radius) => Shape::Sphere(fit(radius, EXTENT)),
            Shape::Capsule { radius, half_length } => {
                Shape::Capsule { radius: fit(radius, CAPSULE_RADIUS), half_length: fit(half_length, EXTENT) }
            }
        }
    }

    /// Mass, kg.
    pub fn mass(self) -> f64 {
        let volume = match self {
            Shape::Box([x, y, z]) => 8.0 * x * y * z,
            Shape::Sphere(radius) => 4.0 / 3.0 * PI * radius * radius * radius,
            Shape::Capsule { radius, half_length } => {
                PI * radius * radius * (2.0 * half_length + 4.0 / 3.0 * radius)
            }
        };
        DENSITY * volume
    }

    /// The smallest cross-section, m² (E-24).
    pub fn cross_section(self) -> f64 {
        match self {
            Shape::Box([x, y, z]) => 4.0 * (x * y).min(y * z).min(z * x),
            Shape::Sphere(radius) | Shape::Capsule { radius, .. } => PI * radius * radius,
        }
    }

    /// How far the shape reaches from its centre along a unit direction, m, segment frame.
    pub fn reach(self, direction: DVec3) -> f64 {
        match self {
            Shape::Box(half) => DVec3::from_array(half).dot(direction.abs()),
            Shape::Sphere(radius) => radius,
            Shape::Capsule { radius, half_length } => radius + half_length * direction.x.abs(),
        }
    }

    /// Every length with its legal range, to move it.
    pub fn lengths_mut(&mut self) -> Vec<(&mut f64, RangeInclusive<f64>)> {
        match self {
            Shape::Box(half) => half.iter_mut().map(|length| (length, EXTENT)).collect(),
            Shape::Sphere(radius) => vec![(radius, EXTENT)],
            Shape::Capsule { radius, half_length } => vec![(radius, CAPSULE_RADIUS), (half_length, EXTENT)],
        }
    }

    /// The two other kinds of shape, reaching about as far along x, y and z as is legal.
    pub fn kin(self) -> [Shape; 2] {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| self.reach(axis));
        let cuboid = Shape::Box([x, y, z]);
        let ball = Shape::Sphere((x + y + z) / 3.0);
        let thickness = (y + z) / 2.0;
        let capsule = Shape::Capsule { radius: thickness, half_length: x - thickness };
        let kin = match self {
            Shape::Box(_) => [ball, capsule],
            Shape::Sphere(_) => [cuboid, capsule],
            Shape::Capsule { .. } => [cuboid, ball],
        };
        kin.map(|shape| shape.scaled(1.0))
    }

    /// A length that is not legal: its name, its value and its range (E-2).
    pub fn illegal_length(self) -> Option<(&'static str, f64, RangeInclusive<f64>)> {
        let lengths = match self {
            Shape::Box([x, y, z]) => {
                vec![("box[0]", x, EXTENT), ("box[1]", y, EXTENT), ("box[2]", z, EXTENT)]
            }
            Shape::Sphere(radius) => vec![("sphere", radius, EXTENT)],
            Shape::Capsule { radius, half_length } => {
                vec![("capsule.radius", radius, CAPSULE_RADIUS), ("capsule.half_length", half_length, EXTENT)]
            }
        };
        lengths.into_iter().find(|(_, length, legal)| !legal.contains(length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(shape: Shape, direction: [f64; 3]) -> DVec3 {
        shape.surface_point(DVec3::from_array(direction).normalize())
    }

    /// T-8
    #[test]
    fn a_direction_leaves_a_shape_where_the_ray_does() {
        let capsule = Shape::Capsule { radius: 0.1, half_length: 0.3 };
        for (shape, direction, expected) in [
            (Shape::Box([0.5, 0.3, 0.2]), [1.0, 1.0, 1.0], [0.2, 0.2, 0.2]),
            (Shape::Sphere(0.2), [0.0, 3.0, 4.0], [0.0, 0.12, 0.16]),
            (capsule, [1.0, 1.0, 0.0], [0.1, 0.1, 0.0]),
            (capsule, [4.0, 1.0, 0.0], [0.348_904, 0.087_226, 0.0]),
            (capsule, [-1.0, 0.0, 0.0], [-0.4, 0.0, 0.0]),
        ] {
            let found = point(shape, direction);
            assert!((found - DVec3::from_array(expected)).length() < 1e-6, "{shape:?}: {found}");
        }
    }

    /// E-2, E-24
    #[test]
    fn mass_and_cross_section_follow_the_dimensions() {
        let plank = Shape::Box([0.1, 0.5, 0.05]);
        assert!((plank.mass() - 20.0).abs() < 1e-9);
        assert!((plank.cross_section() - 0.02).abs() < 1e-12, "0.1 × 0.2 m, T-10");
        assert!((Shape::Sphere(0.2).cross_section() - 0.04 * PI).abs() < 1e-12);
        let capsule = Shape::Capsule { radius: 0.1, half_length: 0.3 };
        assert!((capsule.mass() - (6.0 * PI + 4.0 / 3.0 * PI)).abs() < 1e-9);
    }

    /// E-41
    #[test]
    fn kin_are_of_about_the_same_size_and_legal() {
        let capsule = Shape::Capsule { radius: 0.1, half_length: 0.3 };
        assert_eq!(capsule.kin(), [Shape::Box([0.4, 0.1, 0.1]), Shape::Sphere((0.4 + 0.1 + 0.1) / 3.0)]);
        assert_eq!(
            Shape::Box([0.4, 0.1, 0.1]).kin()[1],
            Shape::Capsule { radius: 0.1, half_length: 0.4 - 0.1 }
        );
        let flat = Shape::Sphere(0.2).kin()[1];
        assert_eq!(flat, Shape::Capsule { radius: 0.2, half_length: 0.03 }, "as short as is legal");
        for shape in [Shape::Box([0.03, 0.5, 0.5]), Shape::Sphere(0.5), Shape::Box([0.5; 3])] {
            assert!(shape.kin().iter().all(|kin| kin.illegal_length().is_none()), "{shape:?}");
        }
    }

    /// E-13
    #[test]
    fn a_scaled_shape_stays_legal() {
        let capsule = Shape::Capsule { radius: 0.2, half_length: 0.1 };
        assert_eq!(capsule.scaled(10.0), Shape::Capsule { radius: 0.3, half_length: 0.5 });
        assert_eq!(Shape::Sphere(0.1).scaled(0.1), Shape::Sphere(0.03));
        assert_eq!(Shape::Sphere(0.1).scaled(1.5), Shape::Sphere(0.1 * 1.5));
    }
}

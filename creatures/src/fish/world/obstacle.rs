//! What stands in the water: spheres, vertical cylinders and boxes, with exact distances, rays and outlines
//! . They never move.

use crate::SpecError;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// A solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case", deny_unknown_fields)]
pub enum Obstacle {
    /// A ball.
    Sphere {
        /// Its middle.
        center: [f64; 3],
        /// Length units.
        radius: f64,
    },
    /// An upright cylinder.
    Cylinder {
        /// Its middle.
        center: [f64; 3],
        /// Length units.
        radius: f64,
        /// From the middle to top and bottom.
        half_height: f64,
    },
    /// A box along the axes.
    Box {
        /// Its middle.
        center: [f64; 3],
        /// From the middle to its faces.
        half: [f64; 3],
    },
}

/// How a point lies to a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// To the nearest point of the surface, negative inside.
    pub distance: f64,
    /// Of length 1, from the surface outward there.
    pub normal: DVec3,
}

/// How far a point is outside each face pair of a box, negative inside.
pub(super) fn slab(at: DVec3, center: DVec3, half: DVec3) -> DVec3 {
    (at - center).abs() - half
}

impl Obstacle {
    /// Its middle.
    pub fn center(&self) -> DVec3 {
        match *self {
            Obstacle::Sphere { center, .. }
            | Obstacle::Cylinder { center, .. }
            | Obstacle::Box { center, .. } => DVec3::from_array(center),
        }
    }

    /// Radius of a ball about its middle that holds it.
    pub fn reach(&self) -> f64 {
        match *self {
            Obstacle::Sphere { radius, .. } => radius,
            Obstacle::Cylinder { radius, half_height, .. } => DVec2::new(radius, half_height).length(),
            Obstacle::Box { half, .. } => DVec3::from_array(half).length(),
        }
    }

    /// The nearest point of its surface, seen from a point; upward where every way is as near.
    pub fn contact(&self, at: DVec3) -> Contact {
        let way = at - self.center();
        match *self {
            Obstacle::Sphere { radius, .. } => {
                let distance = way.length();
                Contact { distance: distance - radius, normal: way.try_normalize().unwrap_or(DVec3::Z) }
            }
            Obstacle::Cylinder { radius, half_height, .. } => {
                let outward = way.truncate().try_normalize().unwrap_or(DVec2::X);
                let beside = way.truncate().length() - radius;
                let above = way.z.abs() - half_height;
                let (side, end) = (outward.extend(0.0), DVec3::new(0.0, 0.0, sign(way.z)));
                nearest(&[(beside, side), (above, end)])
            }
            Obstacle::Box { half, .. } => {
                let outside = way.abs() - DVec3::from_array(half);
                nearest(&[
                    (outside.x, DVec3::X * sign(way.x)),
                    (outside.y, DVec3::Y * sign(way.y)),
                    (outside.z, DVec3::Z * sign(way.z)),
                ])
            }
        }
    }

    /// How far along a ray the obstacle begins, if within `reach`; 0 from inside. It is taken as larger by
    /// `margin` on every side.
    pub fn hit(&self, origin: DVec3, direction: DVec3, reach: f64, margin: f64) -> Option<f64> {
        let from = origin - self.center();
        let span = match *self {
            Obstacle::Sphere { radius, .. } => ball(from, direction, radius + margin),
            Obstacle::Cylinder { radius, half_height, .. } => {
                let flat = between(from.z, direction.z, half_height + margin);
                let round = disc(from.truncate(), direction.truncate(), radius + margin);
                flat.zip(round).and_then(|(flat, round)| overlap(flat, round))
            }
            Obstacle::Box { half, .. } => {
                let [x, y, z] = half.map(|half| half + margin);
                between(from.x, direction.x, x)
                    .zip(between(from.y, direction.y, y))
                    .and_then(|(x, y)| overlap(x, y))
                    .zip(between(from.z, direction.z, z))
                    .and_then(|(xy, z)| overlap(xy, z))
            }
        };
        let (enter, leave) = span?;
        (leave >= 0.0 && enter <= reach).then_some(enter.max(0.0))
    }

    /// Five points of it as an eye sees them: the nearest, and the extremes of its outline to the left, to the
    /// right, above and below.
    pub fn outline(&self, eye: DVec3) -> [DVec3; 5] {
        let contact = self.contact(eye);
        let nearest = eye - contact.normal * contact.distance;
        let away = (self.center() - eye).try_normalize().unwrap_or(DVec3::Y);
        let left = DVec3::new(-away.y, away.x, 0.0).try_normalize().unwrap_or(DVec3::X);
        match *self {
            Obstacle::Sphere { radius, .. } => {
                let distance = (self.center() - eye).length().max(radius);
                let sine = radius / distance;
                let rim = self.center() - away * (radius * sine);
                let width = radius * (1.0 - sine * sine).sqrt();
                let up = left.cross(away) * -1.0;
                [nearest, rim + left * width, rim - left * width, rim + up * width, rim - up * width]
            }
            Obstacle::Cylinder { radius, half_height, .. } => {
                let center = self.center();
                let height = (eye.z - center.z).clamp(-half_height, half_height);
                let flat = DVec2::new(away.x, away.y).try_normalize().unwrap_or(DVec2::Y).extend(0.0);
                let distance = (center - eye).truncate().length().max(radius);
                let sine = radius / distance;
                let rim = center - flat * (radius * sine) + DVec3::Z * height;
                let width = radius * (1.0 - sine * sine).sqrt();
                let front = center - flat * radius;
                [
                    nearest,
                    rim + left * width,
                    rim - left * width,
                    front + DVec3::Z * half_height,
                    front - DVec3::Z * half_height,
                ]
            }
            Obstacle::Box { half, .. } => {
                let half = DVec3::from_array(half);
                let corners = [-1.0, 1.0].map(|z| {
                    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                        .map(|(x, y)| self.center() + half * DVec3::new(x, y, z))
                });
                let extreme = |score: &dyn Fn(DVec3) -> f64| {
                    corners.iter().flatten().fold((f64::NEG_INFINITY, nearest), |best, &corner| {
                        let found = score((corner - eye).normalize_or_zero());
                        if found > best.0 { (found, corner) } else { best }
                    })
                };
                [
                    nearest,
                    extreme(&|way| way.dot(left)).1,
                    extreme(&|way| -way.dot(left)).1,
                    extreme(&|way| way.z).1,
                    extreme(&|way| -way.z).1,
                ]
            }
        }
    }

    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        let sizes: &[(&str, f64)] = match self {
            Obstacle::Sphere { radius, .. } => &[("radius", *radius)],
            Obstacle::Cylinder { radius, half_height, .. } => {
                &[("radius", *radius), ("half_height", *half_height)]
            }
            Obstacle::Box { half: [x, y, z], .. } => &[("half", *x), ("half", *y), ("half", *z)],
        };
        for &(key, size) in sizes {
            if !(size > 0.0 && size <= 1e4) {
                return Err(SpecError::new(key, format!("{size} is not within (0, 10000]")));
            }
        }
        if !self.center().to_array().iter().all(|value| value.abs() <= 1e4) {
            return Err(SpecError::new("center", "is not within -10000 to 10000"));
        }
        Ok(())
    }
}

fn sign(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}

/// Distance and normal of a solid that is the intersection of slabs at right angles, from how far a point is
/// outside each of them.
fn nearest(outside: &[(f64, DVec3)]) -> Contact {
    let way: DVec3 = outside.iter().map(|&(by, normal)| normal * by.max(0.0)).sum();
    if let Some(normal) = way.try_normalize() {
        return Contact { distance: way.length(), normal };
    }
    let (first, rest) = outside.split_first().expect("a solid has sides");
    let &(distance, normal) = rest.iter().fold(first, |best, side| if side.0 > best.0 { side } else { best });
    Contact { distance, normal }
}

/// Where a line along a unit direction is within a ball about the origin.
pub(crate) fn ball(from: DVec3, direction: DVec3, radius: f64) -> Option<(f64, f64)> {
    let middle = -from.dot(direction);
    let square = radius * radius - (from.length_squared() - middle * middle);
    (square >= 0.0).then(|| {
        let half = square.sqrt();
        (middle - half, middle + half)
    })
}

/// Where a coordinate that starts at `from` and changes by `rate` is within ±`half`.
fn between(from: f64, rate: f64, half: f64) -> Option<(f64, f64)> {
    if rate == 0.0 {
        return (from.abs() <= half).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (one, other) = ((-half - from) / rate, (half - from) / rate);
    Some(if one < other { (one, other) } else { (other, one) })
}

/// Where a point of the plane that moves along a straight line is within a disc about the origin.
fn disc(from: DVec2, rate: DVec2, radius: f64) -> Option<(f64, f64)> {
    let a = rate.length_squared();
    let c = from.length_squared() - radius * radius;
    if a == 0.0 {
        return (c <= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let b = from.dot(rate);
    let square = b * b - a * c;
    (square >= 0.0).then(|| {
        let half = square.sqrt();
        ((-b - half) / a, (-b + half) / a)
    })
}

fn overlap(one: (f64, f64), other: (f64, f64)) -> Option<(f64, f64)> {
    let both = (one.0.max(other.0), one.1.min(other.1));
    (both.0 <= both.1).then_some(both)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BALL: Obstacle = Obstacle::Sphere { center: [0.0, 30.0, 0.0], radius: 5.0 };
    const POST: Obstacle = Obstacle::Cylinder { center: [0.0, 30.0, 0.0], radius: 5.0, half_height: 10.0 };
    const CRATE: Obstacle = Obstacle::Box { center: [0.0, 30.0, 0.0], half: [5.0, 4.0, 3.0] };

    ///
    #[test]
    fn distances_are_negative_inside() {
        let at = |obstacle: Obstacle, x, y, z| obstacle.contact(DVec3::new(x, y, z));
        assert_eq!(at(BALL, 0.0, 20.0, 0.0), Contact { distance: 5.0, normal: DVec3::NEG_Y });
        assert_eq!(at(BALL, 0.0, 30.0, 4.0), Contact { distance: -1.0, normal: DVec3::Z });
        assert_eq!(at(POST, 8.0, 30.0, 0.0), Contact { distance: 3.0, normal: DVec3::X });
        assert_eq!(at(POST, 8.0, 30.0, 14.0).distance, 5.0);
        assert_eq!(at(POST, 1.0, 30.0, -9.5), Contact { distance: -0.5, normal: DVec3::NEG_Z });
        assert_eq!(at(CRATE, 8.0, 38.0, 0.0).distance, 5.0);
        assert_eq!(at(CRATE, 0.0, 26.5, 0.0), Contact { distance: -0.5, normal: DVec3::NEG_Y });
        assert!(at(BALL, 0.0, 30.0, 0.0).normal.is_finite(), "AF-9");
    }

    ///
    #[test]
    fn rays_meet_the_exact_shapes() {
        let ray = |obstacle: &Obstacle, x, z| obstacle.hit(DVec3::new(x, 0.0, z), DVec3::Y, 100.0, 0.0);
        assert_eq!(ray(&BALL, 0.0, 0.0), Some(25.0));
        assert_eq!(ray(&BALL, 3.0, 0.0), Some(26.0));
        assert_eq!(ray(&BALL, 5.1, 0.0), None);
        assert_eq!(ray(&POST, 3.0, 9.9), Some(26.0));
        assert_eq!(ray(&POST, 3.0, 10.1), None);
        assert_eq!(ray(&CRATE, 4.9, 2.9), Some(26.0));
        assert_eq!(ray(&CRATE, 5.1, 0.0), None);
        for obstacle in [BALL, POST, CRATE] {
            assert_eq!(obstacle.hit(DVec3::ZERO, DVec3::Y, 20.0, 0.0), None, "out of reach");
            assert_eq!(obstacle.hit(DVec3::ZERO, DVec3::NEG_Y, 100.0, 0.0), None, "behind");
            assert_eq!(obstacle.hit(obstacle.center(), DVec3::Y, 1.0, 0.0), Some(0.0), "inside");
        }
        assert_eq!(BALL.hit(DVec3::ZERO, DVec3::Y, 100.0, 2.0), Some(23.0));
    }

    proptest! {
        /// outlines lie on the surface, and in the ball that is said to hold the obstacle.
        #[test]
        fn outlines_lie_on_the_surface(x in -50.0..50.0f64, y in -50.0..20.0f64, z in -50.0..50.0f64) {
            let eye = DVec3::new(x, y, z);
            for obstacle in [BALL, POST, CRATE] {
                for point in obstacle.outline(eye) {
                    prop_assert!(obstacle.contact(point).distance.abs() < 1e-9, "{obstacle:?} {point}");
                    prop_assert!((point - obstacle.center()).length() < obstacle.reach() + 1e-9);
                }
            }
        }

        /// A ray stops where the distance is 0.
        #[test]
        fn rays_and_distances_agree(x in -9.0..9.0f64, z in -9.0..9.0f64, margin in 0.0..0.1f64) {
            let (origin, direction) = (DVec3::new(1.0, 0.0, 2.0), DVec3::new(x, 30.0, z).normalize());
            for obstacle in [BALL, POST, CRATE] {
                if let Some(way) = obstacle.hit(origin, direction, 100.0, 0.0) {
                    let contact = obstacle.contact(origin + direction * way);
                    prop_assert!(contact.distance.abs() < 1e-9, "{obstacle:?}: {contact:?}");
                    let early = obstacle.hit(origin, direction, 100.0, margin).unwrap();
                    prop_assert!(early <= way);
                }
            }
        }
    }
}

//! A fish as it stands in the light: a rod with round ends.

use crate::fish::world::obstacle::ball;
use glam::DVec3;

/// Radius at size 1, half the width of a body.
pub const RADIUS: f64 = 1.9;

/// All points within a distance of a rod.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// The ends of the rod.
    pub ends: [DVec3; 2],
    /// Length units.
    pub radius: f64,
}

impl Capsule {
    /// Radius of a ball about its middle that holds it.
    pub fn reach(&self) -> f64 {
        0.5 * (self.ends[1] - self.ends[0]).length() + self.radius
    }

    /// Its middle.
    pub fn center(&self) -> DVec3 {
        (self.ends[0] + self.ends[1]) * 0.5
    }

    /// How far along a ray (unit direction) it begins, if within `reach`; 0 from inside.
    pub fn hit(&self, origin: DVec3, direction: DVec3, reach: f64) -> Option<f64> {
        // Most rays pass at a distance.
        let way = self.center() - origin;
        let (along, bound) = (way.dot(direction), self.reach());
        let aside = way.length_squared() - along * along;
        if along < -bound || along > reach + bound || aside > bound * bound {
            return None;
        }
        let rod = self.ends[1] - self.ends[0];
        let from = origin - self.ends[0];
        let mut first = f64::INFINITY;
        let mut consider = |span: Option<(f64, f64)>| {
            if let Some((enter, leave)) = span
                && leave >= 0.0
            {
                first = first.min(enter.max(0.0));
            }
        };
        consider(ball(from, direction, self.radius));
        consider(ball(origin - self.ends[1], direction, self.radius));
        if let Some(span) = self.tube(from, direction, rod) {
            consider(Some(span));
        }
        (first <= reach).then_some(first)
    }

    /// Where a ray is within the part between the ends.
    fn tube(&self, from: DVec3, direction: DVec3, rod: DVec3) -> Option<(f64, f64)> {
        let square = rod.length_squared();
        if square == 0.0 {
            return None;
        }
        // Across the rod: |from + t direction|² − (along the rod)² = radius².
        let (start, rate) = (from.dot(rod), direction.dot(rod));
        let a = 1.0 - rate * rate / square;
        let b = from.dot(direction) - start * rate / square;
        let c = from.length_squared() - start * start / square - self.radius * self.radius;
        let across = if a > 1e-12 {
            let root = b * b - a * c;
            if root < 0.0 {
                return None;
            }
            let half = root.sqrt();
            ((-b - half) / a, (-b + half) / a)
        } else if c <= 0.0 {
            (f64::NEG_INFINITY, f64::INFINITY)
        } else {
            return None;
        };
        let along = if rate == 0.0 {
            if !(0.0..=square).contains(&start) {
                return None;
            }
            (f64::NEG_INFINITY, f64::INFINITY)
        } else {
            let (one, other) = (-start / rate, (square - start) / rate);
            (one.min(other), one.max(other))
        };
        let both = (across.0.max(along.0), across.1.min(along.1));
        (both.0 <= both.1).then_some(both)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rays_meet_the_side_and_the_ends() {
        let capsule =
            Capsule { ends: [DVec3::new(-5.0, 30.0, 0.0), DVec3::new(5.0, 30.0, 0.0)], radius: 2.0 };
        let ray = |x| capsule.hit(DVec3::new(x, 0.0, 0.0), DVec3::Y, 100.0);
        assert_eq!(ray(0.0), Some(28.0));
        assert_eq!(ray(5.0), Some(28.0));
        assert_eq!(ray(7.0), Some(30.0));
        assert_eq!(ray(7.1), None);
        assert_eq!(capsule.hit(DVec3::new(-20.0, 30.0, 0.0), DVec3::X, 100.0), Some(13.0));
        assert_eq!(capsule.hit(DVec3::new(1.0, 31.0, 0.0), DVec3::X, 100.0), Some(0.0), "inside");
        assert_eq!(capsule.hit(DVec3::ZERO, DVec3::Y, 27.0), None, "out of reach");
    }

    proptest! {
        #[test]
        fn a_ray_enters_at_the_surface(x in -10.0..10.0f64, y in -10.0..10.0f64, z in -10.0..10.0f64) {
            let capsule =
                Capsule { ends: [DVec3::new(-3.0, 28.0, 1.0), DVec3::new(4.0, 33.0, -2.0)], radius: 2.0 };
            let direction = (DVec3::new(x, 30.0 + y, z)).normalize();
            if let Some(way) = capsule.hit(DVec3::ZERO, direction, 100.0) {
                let at = direction * way;
                let rod = capsule.ends[1] - capsule.ends[0];
                let along = ((at - capsule.ends[0]).dot(rod) / rod.length_squared()).clamp(0.0, 1.0);
                let distance = (at - capsule.ends[0] - rod * along).length();
                prop_assert!((distance - 2.0).abs() < 1e-9, "{distance}");
            }
        }
    }
}

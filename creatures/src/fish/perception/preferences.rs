//! Where not to turn: a fish that has to avoid one thing should not run into the next.

use super::{Figure, Senses};
use crate::fish::world::FishId;

/// Bearings that make a side bad, rad.
const SIDE: std::ops::RangeInclusive<f64> = std::f64::consts::FRAC_PI_6..=2.0 * std::f64::consts::FRAC_PI_3;

/// Sides on which something is within a body length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Preferences {
    /// Nothing to the left, please.
    pub no_left: bool,
    /// Nor to the right.
    pub no_right: bool,
    /// Nor upward.
    pub no_up: bool,
    /// Nor downward.
    pub no_down: bool,
}

impl Preferences {
    /// Of a fish at this instant, what it is about to avoid left out: a fish, or an obstacle or face of the tank
    /// by its number.
    pub fn of(
        senses: &Senses<'_>,
        fish: Option<FishId>,
        solid: Option<usize>,
        near: &mut Vec<FishId>,
    ) -> Self {
        let (me, scene) = (senses.me, senses.scene);
        let reach = me.length();
        let mut found = Preferences::default();
        let mut note = |point| {
            let place = me.locate(point);
            if place.distance <= reach {
                found.no_left |= SIDE.contains(&place.bearing);
                found.no_right |= SIDE.contains(&-place.bearing);
                found.no_up |= SIDE.contains(&place.climb);
                found.no_down |= SIDE.contains(&-place.climb);
            }
        };
        let solids = scene.obstacles.iter().map(|obstacle| obstacle.contact(me.eye));
        for (index, contact) in solids.chain(scene.tank.contacts(me.eye)).enumerate() {
            if Some(index) != solid {
                note(me.eye - contact.normal * contact.distance);
            }
        }
        // A fish counts by the nearest point of its axis, which is at most a body length from b.
        scene.grid.within(me.eye, reach + 20.0 * scene.size_max, near);
        for &id in near.iter().filter(|&&id| id != me.id && Some(id) != fish) {
            let figure: &Figure = &scene.figures[id.index()];
            let square = |point: glam::DVec3| (point - me.eye).length_squared();
            let nearest = figure.axis.into_iter().reduce(|a, b| if square(b) < square(a) { b } else { a });
            nearest.into_iter().for_each(&mut note);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::perception::tests::Pond;
    use crate::fish::world::Obstacle;
    use glam::DVec3;

    ///
    #[test]
    fn sides_with_something_near_are_bad() {
        let mut pond = Pond::with_eye_at_origin();
        let of = |pond: &Pond, solid| {
            pond.senses(0, |senses| Preferences::of(senses, None, solid, &mut Vec::new()))
        };
        assert_eq!(of(&pond, None), Preferences::default());
        pond.obstacles.push(Obstacle::Sphere { center: [-15.0, 0.0, 0.0], radius: 5.0 });
        assert_eq!(of(&pond, None), Preferences { no_left: true, ..Preferences::default() });
        assert_eq!(of(&pond, Some(0)), Preferences::default(), "what is avoided is no reason against itself");
        pond.add(DVec3::new(12.0, 3.0, 0.0), 0.0);
        let both = Preferences { no_left: true, no_right: true, ..Preferences::default() };
        assert_eq!(of(&pond, None), both);
        pond.obstacles.push(Obstacle::Box { center: [0.0, 0.0, 12.0], half: [3.0, 3.0, 2.0] });
        assert_eq!(of(&pond, None), Preferences { no_up: true, ..both });
        pond.obstacles.push(Obstacle::Sphere { center: [0.0, 18.0, 0.0], radius: 5.0 });
        assert_eq!(of(&pond, None), Preferences { no_up: true, ..both }, "ahead is neither side");
    }
}

//! Photoreceptors: how bright the lights are that one sees (E-29..E-31). What stands in between is asked, not
//! known.

use super::brain::clamp;
use super::trial::Light;
use glam::DVec3;

/// How far outside the surface a receptor looks from, m (E-30).
const OUTSIDE: f64 = 1e-3;

/// Σ S · max(0, cos α) · 1/(1 + (r/r0)²) · V over the lights, limited to [0, 1] (E-29).
///
/// `point` is the receptor's place, m, and `axis` where it looks, unit, world frame; `range` is r0, m; `is_clear`
/// says whether nothing stands between two points.
pub fn signal(
    point: DVec3,
    axis: DVec3,
    lights: &[Light],
    range: f64,
    is_clear: impl Fn(DVec3, DVec3) -> bool,
) -> f64 {
    let seen = |light: &Light| {
        let way = light.position - point;
        let distance = way.length();
        let cosine = way.dot(axis) / distance;
        if !(cosine > 0.0 && is_clear(point + OUTSIDE * axis, light.position)) {
            return 0.0;
        }
        let share = distance / range;
        light.strength * cosine / (1.0 + share * share)
    };
    clamp(lights.iter().map(seen).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::setup::{DISC_HEIGHT, DISC_RADIUS};
    use crate::esp::fitness::{Form, Target};
    use crate::esp::physics::Physics;
    use crate::physics::contact::{Pose, Shape, World};
    use glam::DQuat;

    fn place(shape: Shape, at: [f64; 3], world: &mut World) {
        world.insert(shape, &Pose { position: DVec3::from_array(at), rotation: DQuat::IDENTITY });
    }

    fn ball() -> World {
        let mut world = World::new(Physics::default().settings());
        place(Shape::Ball(0.2), [0.0, 0.0, 1.0], &mut world);
        world
    }

    fn light(strength: f64, at: [f64; 3]) -> Light {
        Light { position: DVec3::from_array(at), strength }
    }

    fn see(world: &World, point: [f64; 3], lights: &[Light]) -> f64 {
        signal(DVec3::from_array(point), DVec3::X, lights, 5.0, |from, to| world.is_clear(from, to))
    }

    /// T-4 (a), (b), (d)..(g)
    #[test]
    fn a_light_counts_by_strength_distance_and_angle() {
        let (ahead, far) = (light(1.0, [4.2, 3.0, 1.0]), light(1.0, [5.2, 0.0, 1.0]));
        let (near, behind) = (light(1.0, [0.7, 0.0, 1.0]), light(1.0, [-4.8, 0.0, 1.0]));
        for (lights, expected) in [
            (&[ahead][..], 0.4),
            (&[behind][..], 0.0),
            (&[ahead, far][..], 0.9),
            (&[near][..], 0.990_099),
            (&[ahead, near][..], 1.0),
            (&[light(2.0, [10.2, 0.0, 1.0])][..], 0.4),
            (&[][..], 0.0),
        ] {
            let found = see(&ball(), [0.2, 0.0, 1.0], lights);
            assert!((found - expected).abs() < 1e-6, "{lights:?}: {found}");
        }
    }

    /// T-4 (c), E-30: a part in between, the own one, the ground.
    #[test]
    fn what_stands_in_between_takes_the_light_away() {
        let mut world = ball();
        place(Shape::Cuboid(DVec3::splat(0.1)), [2.2, 1.5, 1.0], &mut world);
        assert_eq!(see(&world, [0.2, 0.0, 1.0], &[light(1.0, [4.2, 3.0, 1.0])]), 0.0);
        let beside = see(&world, [0.2, 0.0, 1.0], &[light(1.0, [4.2, 3.5, 1.0])]);
        assert!(beside > 0.0, "past it, the light is seen");
        let inside =
            signal(DVec3::new(-0.2, 0.0, 1.0), DVec3::X, &[light(1.0, [5.0, 0.0, 1.0])], 5.0, |a, b| {
                world.is_clear(a, b)
            });
        assert_eq!(inside, 0.0, "through the own part");
        assert_eq!(
            see(&world, [0.2, 0.0, -0.01], &[light(1.0, [5.0, 0.0, 1.0])]),
            0.0,
            "from below the ground"
        );
    }

    /// T-4 (h), E-30: discs block nothing.
    #[test]
    fn lights_are_seen_through_their_discs() {
        let mut world = World::new(Physics::default().settings());
        place(Shape::Ball(0.2), [0.0, 0.0, 0.3], &mut world);
        for (form, expected) in [(Form::Disc, 0.219_423), (Form::Stack, 0.658_411)] {
            let target = Target::new(form, 0.0, 3.2);
            for disc in 0..target.discs() {
                let height = (disc as f64 + 0.5) * DISC_HEIGHT;
                world.place_disc(target.centre().with_z(height), DISC_RADIUS, DISC_HEIGHT);
            }
            let lights: Vec<Light> = (0..target.lights())
                .map(|index| Light { position: target.light(index, 0.0), strength: 0.3 })
                .collect();
            let found = see(&world, [0.2, 0.0, 0.3], &lights);
            assert!((found - expected).abs() < 1e-6, "{form:?}: {found}");
        }
    }

    /// A receptor that stands in the light itself sees nothing, rather than no number.
    #[test]
    fn a_light_on_the_receptor_is_dark() {
        assert_eq!(see(&ball(), [0.2, 0.0, 1.0], &[light(1.0, [0.2, 0.0, 1.0])]), 0.0);
    }
}

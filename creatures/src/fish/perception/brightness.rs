//! How bright the world looks: the mean of what comes from 128 fixed directions. There is no renderer.

use super::{Senses, vision::COS_HALF_FIELD};
use crate::math::{cos, sin};
use glam::DVec3;
use std::f64::consts::PI;

/// Directions looked in.
const RAYS: usize = 128;
/// How much of the light a surface gives back.
const OBSTACLE_ALBEDO: f64 = 0.3;
const FISH_ALBEDO: f64 = 0.5;

/// The k-th direction, body frame (right, ahead, up): Fibonacci's points on the cap of sight, from straight
/// ahead backward.
fn direction(k: usize) -> DVec3 {
    let golden = PI * (3.0 - 5f64.sqrt());
    let ahead = cosine(k as f64 + 0.5);
    let across = (1.0 - ahead * ahead).sqrt();
    let turn = golden * k as f64;
    DVec3::new(across * cos(turn), ahead, across * sin(turn))
}

/// Cosine of the angle from straight ahead, of a number of a direction.
fn cosine(number: f64) -> f64 {
    1.0 - number * ((1.0 - COS_HALF_FIELD) / RAYS as f64)
}

/// Mean over the directions of what comes from there: the light at the first thing hit within V_r times its
/// albedo, or the light at the ray's end in open water.
pub fn mean(senses: &Senses<'_>) -> f64 {
    let (me, scene, reach) = (senses.me, senses.scene, senses.habits.vision);
    let light = |at: DVec3| scene.climate.light(at, scene.tank.surface());
    let ways: [DVec3; RAYS] = std::array::from_fn(|k| {
        let way = direction(k);
        me.right * way.x + me.forward * way.y + me.up * way.z
    });
    // How far each ray gets, and the albedo of what stops it.
    let mut ends = [(reach, 1.0); RAYS];
    for solid in scene.obstacles {
        shade(senses, &ways, &mut ends, solid.center(), solid.reach(), OBSTACLE_ALBEDO, |way, reach| {
            solid.hit(me.eye, way, reach, 0.0)
        });
    }
    for shadow in senses.shadows {
        shade(senses, &ways, &mut ends, shadow.center, shadow.reach, FISH_ALBEDO, |way, reach| {
            shadow.capsule.hit(me.eye, way, reach)
        });
    }
    for ((distance, albedo), way) in ends.iter_mut().zip(&ways) {
        for contact in scene.tank.contacts(me.eye) {
            let toward = -contact.normal.dot(*way);
            if toward > 0.0 && contact.distance < *distance * toward {
                (*distance, *albedo) = (contact.distance / toward, OBSTACLE_ALBEDO);
            }
        }
    }
    let sum = ends
        .iter()
        .zip(&ways)
        .fold(0.0, |sum, (&(distance, albedo), way)| sum + albedo * light(me.eye + *way * distance));
    sum / RAYS as f64
}

/// Stops the rays that meet a thing within a ball before they meet anything else. Directions are ordered by
/// their angle from straight ahead, so that those which may meet it follow one another.
fn shade(
    senses: &Senses<'_>,
    ways: &[DVec3; RAYS],
    ends: &mut [(f64, f64); RAYS],
    center: DVec3,
    radius: f64,
    albedo: f64,
    hit: impl Fn(DVec3, f64) -> Option<f64>,
) {
    let way = center - senses.me.eye;
    let distance = way.length();
    if distance > senses.habits.vision + radius {
        return;
    }
    let rays = if distance <= radius {
        0..RAYS
    } else {
        // cos(θ ± α) of the ball's middle and half width as seen from the eye.
        let (cos_middle, sin_half) = (way.dot(senses.me.forward) / distance, radius / distance);
        let sin_middle = (1.0 - cos_middle * cos_middle).max(0.0).sqrt();
        let cos_half = (1.0 - sin_half * sin_half).sqrt();
        let nearest =
            if cos_middle >= cos_half { 1.0 } else { cos_middle * cos_half + sin_middle * sin_half };
        let farthest =
            if cos_middle <= -cos_half { -1.0 } else { cos_middle * cos_half - sin_middle * sin_half };
        let number = |cosine: f64| (1.0 - cosine) * (RAYS as f64 / (1.0 - COS_HALF_FIELD));
        let first = (number(nearest) - 1.0).max(0.0) as usize;
        first.min(RAYS)..(number(farthest) + 1.0).min(RAYS as f64) as usize
    };
    for ray in rays {
        if let Some(way) = hit(ways[ray], ends[ray].0)
            && way < ends[ray].0
        {
            ends[ray] = (way, albedo);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::perception::tests::Pond;
    use crate::fish::world::Obstacle;

    #[test]
    fn directions_fill_the_field_of_sight() {
        let sum: DVec3 = (0..RAYS).map(direction).sum();
        assert!(direction(0).y > 0.99 && direction(RAYS - 1).y > COS_HALF_FIELD);
        assert!((sum.y / RAYS as f64 - 0.5 * (1.0 + COS_HALF_FIELD)).abs() < 1e-12, "uniform by height");
        assert!(sum.x.abs() < 1.0 && sum.z.abs() < 1.0, "{sum}");
    }

    /// open water without absorption looks as bright as its light, and what blocks it is darker.
    #[test]
    fn obstacles_and_walls_darken_the_view() {
        let mut pond = Pond::with_eye_at_origin();
        pond.climate.absorption = 0.0;
        pond.habits[0].vision = 90.0; // short of the tank's faces
        assert_eq!(pond.senses(0, |senses| senses.brightness()), 1.0);
        pond.obstacles.push(Obstacle::Box { center: [0.0, 30.0, 0.0], half: [1e3, 1.0, 1e3] });
        let half = pond.senses(0, |senses| senses.brightness());
        // A plane 29 ahead covers the directions within acos(29/90) of straight ahead.
        let covered = (1.0 - 29.0 / 90.0) / (1.0 - COS_HALF_FIELD);
        assert!((half - (1.0 - 0.7 * covered)).abs() < 0.7 / RAYS as f64, "{half}");
    }

    /// The ranges of rays lose no hit.
    #[test]
    fn what_is_met_is_what_every_ray_tried_one_by_one_meets() {
        let mut pond = Pond::with_eye_at_origin();
        for (x, y, z) in [(20.0, 30.0, 5.0), (-40.0, -10.0, 15.0), (3.0, -30.0, -20.0), (0.0, 60.0, 60.0)] {
            pond.obstacles.push(Obstacle::Sphere { center: [x, y, z], radius: 12.0 });
            pond.add(DVec3::new(-x, y + 20.0, z), x);
        }
        let found = pond.senses(0, |senses| senses.brightness());
        let expected = pond.senses(0, |senses| {
            let (me, scene, reach) = (senses.me, senses.scene, senses.habits.vision);
            let ray = |k| {
                let way = direction(k);
                let way = me.right * way.x + me.forward * way.y + me.up * way.z;
                let solids = scene
                    .obstacles
                    .iter()
                    .filter_map(|solid| Some((solid.hit(me.eye, way, reach, 0.0)?, OBSTACLE_ALBEDO)));
                let fishes = scene.figures[1..]
                    .iter()
                    .filter_map(|figure| Some((figure.shadow.hit(me.eye, way, reach)?, FISH_ALBEDO)));
                let walls = scene.tank.contacts(me.eye).into_iter().filter_map(|contact| {
                    let toward = -contact.normal.dot(way);
                    (toward > 0.0).then(|| (contact.distance / toward, OBSTACLE_ALBEDO))
                });
                let open = (reach, 1.0);
                let all = solids.chain(fishes).chain(walls);
                let (distance, albedo) = all.fold(open, |best, one| if one.0 < best.0 { one } else { best });
                albedo * scene.climate.light(me.eye + way * distance, scene.tank.surface())
            };
            (0..RAYS).map(ray).sum::<f64>() / RAYS as f64
        });
        assert_eq!(found, expected);
    }
}

//! What a fish is about to run into. Things outside its box of sensitivity do not count, however near
//! they may come.

use super::{Figure, Senses, capsule::RADIUS};
use crate::fish::mind::{Intention, Target};
use crate::fish::world::FishId;
use glam::DVec3;

/// Nearer than this to a surface, by L, b is in danger whatever the heading.
const SURFACE: f64 = 0.35;
/// The box about a fish, by L: behind b, ahead of the nose, to each side and above and below.
const BEHIND: f64 = 0.1;
const AHEAD: f64 = 1.0;
const ASIDE: f64 = 0.35;
/// How far ahead others are moved, time units.
const FORESIGHT: f64 = 2.0;
/// What a school and a pair find near.
const IN_FORMATION: f64 = 0.6;
const IN_COURTSHIP: f64 = 0.15;

/// A danger of collision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hazard {
    /// With something that stands still.
    Surface(Surface),
    /// With a fish.
    Fish(FishId),
}

/// The surface that is nearest of those in the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// An obstacle's number, or a face of the tank after them.
    pub index: usize,
    /// From the eye.
    pub distance: f64,
    /// The point of it nearest to the eye.
    pub point: DVec3,
    /// Of length 1, into the water there.
    pub normal: DVec3,
}

impl Hazard {
    /// The most dangerous one, if there is any: the nearest surface, else the fish with most points in the box,
    /// the lower id of two alike.
    ///
    /// Choice: what stands still goes first, since it does not give way. `prey` is what a predator is after,
    /// which it does not mind running into.
    pub fn of(
        senses: &Senses<'_>,
        intention: Intention,
        prey: Option<Target>,
        near: &mut Vec<FishId>,
    ) -> Option<Hazard> {
        surface(senses).map(Hazard::Surface).or_else(|| {
            let scale =
                senses.habits.sensitivity * if intention == Intention::School { IN_FORMATION } else { 1.0 };
            fish(senses, scale, prey, near).map(Hazard::Fish)
        })
    }
}

fn surface(senses: &Senses<'_>) -> Option<Surface> {
    let (me, scene) = (senses.me, senses.scene);
    let antenna = me.length() * senses.habits.sensitivity;
    let width = RADIUS * me.size;
    let mut most: Option<Surface> = None;
    let mut consider = |index: usize, touches: bool, contact: crate::fish::world::Contact| {
        if touches && most.is_none_or(|most| contact.distance < most.distance) {
            let point = me.eye - contact.normal * contact.distance;
            most = Some(Surface { index, distance: contact.distance, point, normal: contact.normal });
        }
    };
    for (index, solid) in scene.obstacles.iter().enumerate() {
        // Nothing farther than antenna, width and body is in the way.
        let far = solid.reach() + antenna + width + me.length();
        if (solid.center() - me.eye).length_squared() < far * far {
            let touches = solid.hit(me.eye, me.forward, antenna, width).is_some()
                || solid.contact(me.center).distance < SURFACE * antenna;
            consider(index, touches, solid.contact(me.eye));
        }
    }
    let tip = scene.tank.contacts(me.eye + me.forward * antenna);
    let bodies = scene.tank.contacts(me.center).into_iter().zip(tip);
    for (face, (contact, (body, tip))) in scene.tank.contacts(me.eye).into_iter().zip(bodies).enumerate() {
        let touches = tip.distance < width || body.distance < SURFACE * antenna;
        consider(scene.obstacles.len() + face, touches, contact);
    }
    most
}

fn fish(senses: &Senses<'_>, scale: f64, prey: Option<Target>, near: &mut Vec<FishId>) -> Option<FishId> {
    let (me, scene) = (senses.me, senses.scene);
    // The box, the way others come in the time ahead, and half of their length.
    let reach = 0.5 * me.length() + me.length() * scale * (AHEAD + 2.0 * ASIDE);
    let coming = FORESIGHT * (scene.speed_max + me.velocity.length());
    scene.grid.within(me.center, reach + coming + 20.0 * scene.size_max, near);
    let mut most: Option<(FishId, u32)> = None;
    for &id in near.iter().filter(|&&id| id != me.id && Some(Target::Fish(id)) != prey) {
        let other = &scene.figures[id.index()];
        let scale = if pair(me, other) { scale * IN_COURTSHIP } else { scale };
        let points = points_in_box(me, other, scale);
        if points > most.map_or(0, |(_, points)| points) {
            most = Some((id, points));
        }
    }
    most.map(|(id, _)| id)
}

/// Whether two fishes court each other.
fn pair(one: &Figure, other: &Figure) -> bool {
    one.partner == Some(other.id) && other.partner == Some(one.id)
}

/// How many of the seven points of another's axis are in the box, now or as far as they come in the time ahead.
fn points_in_box(me: &Figure, other: &Figure, scale: f64) -> u32 {
    let length = me.length() * scale;
    let nose = (me.mouth - me.center).dot(me.forward);
    let within = |point: DVec3| {
        let way = point - me.center;
        let ahead = way.dot(me.forward);
        ahead >= -BEHIND * length
            && ahead <= nose + AHEAD * length
            && way.dot(me.right).abs() <= ASIDE * length
            && way.dot(me.up).abs() <= ASIDE * length
    };
    let coming = (other.velocity - me.velocity) * FORESIGHT;
    let counts = other.axis.iter().filter(|&&point| within(point) || within(point + coming));
    counts.count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::perception::tests::Pond;
    use crate::fish::world::Obstacle;

    fn hazard(pond: &Pond, intention: Intention, prey: Option<Target>) -> Option<Hazard> {
        pond.senses(0, |senses| Hazard::of(senses, intention, prey, &mut Vec::new()))
    }

    /// the eye is at 0, L is 20, the body is 1.9 wide on either side.
    #[test]
    fn an_antenna_feels_obstacles_ahead() {
        let mut pond = Pond::with_eye_at_origin();
        let ahead =
            |distance: f64, aside: f64| Obstacle::Sphere { center: [aside, distance, 0.0], radius: 5.0 };
        for (distance, aside, expected) in
            [(26.8, 0.0, true), (27.0, 0.0, false), (20.0, 6.8, true), (20.0, 7.0, false), (-11.0, 0.0, true)]
        {
            pond.obstacles = vec![ahead(distance, aside)];
            let found = hazard(&pond, Intention::Wander, None);
            assert_eq!(matches!(found, Some(Hazard::Surface(_))), expected, "{distance} {aside}");
        }
        pond.obstacles = vec![ahead(20.0, 0.0), ahead(18.0, 1.0)];
        let Some(Hazard::Surface(nearest)) = hazard(&pond, Intention::Wander, None) else { panic!("two") };
        assert_eq!(nearest.index, 1);
        pond.habits[0].sensitivity = 0.5;
        assert_eq!(hazard(&pond, Intention::Wander, None), None, "a bold fish");
    }

    #[test]
    fn the_faces_of_the_tank_are_felt_too() {
        let mut pond = Pond::empty();
        pond.add(DVec3::new(0.0, 175.5, 0.0), 0.0);
        let Some(Hazard::Surface(face)) = hazard(&pond, Intention::Wander, None) else { panic!("no face") };
        assert_eq!((face.index, face.normal), (3, DVec3::NEG_Y));
        let mut pond = Pond::empty();
        pond.add(DVec3::new(0.0, 0.0, -94.0), 0.0);
        let Some(Hazard::Surface(bed)) = hazard(&pond, Intention::Wander, None) else { panic!("no bed") };
        assert_eq!((bed.index, bed.normal, bed.distance), (4, DVec3::Z, 6.0));
    }

    ///
    #[test]
    fn fishes_in_the_box_of_sensitivity_are_dangerous_now_or_soon() {
        let mut pond = Pond::with_eye_at_origin();
        pond.add(DVec3::new(20.0, 5.0, 0.0), 0.0);
        assert_eq!(hazard(&pond, Intention::Wander, None), None);
        pond.figures[1].velocity = DVec3::new(-7.0, 0.0, 0.0);
        assert_eq!(
            hazard(&pond, Intention::Wander, None),
            Some(Hazard::Fish(FishId(1))),
            "in two time units"
        );
        pond.add(DVec3::new(0.0, 20.0, 0.0), 0.0);
        pond.figures[1].velocity = DVec3::new(-7.0, 14.0, 0.0); // fewer of its points come in
        assert_eq!(hazard(&pond, Intention::Wander, None), Some(Hazard::Fish(FishId(2))));
        let prey = Some(Target::Fish(FishId(2)));
        assert_eq!(hazard(&pond, Intention::Eat, prey), Some(Hazard::Fish(FishId(1))));
    }

    ///
    #[test]
    fn schools_and_pairs_come_closer() {
        let mut pond = Pond::with_eye_at_origin();
        pond.add(DVec3::new(6.0, 0.0, 0.0), 0.0);
        assert!(hazard(&pond, Intention::Wander, None).is_some());
        assert!(hazard(&pond, Intention::School, None).is_none());
        (pond.figures[0].partner, pond.figures[1].partner) = (Some(FishId(1)), Some(FishId(0)));
        assert!(hazard(&pond, Intention::Mate, None).is_none());
        pond.figures[1].partner = None;
        assert!(hazard(&pond, Intention::Mate, None).is_some(), "one alone is no pair");
    }
}

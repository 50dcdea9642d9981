//! Swimming in company: nobody leads a school; each keeps its neighbours' heading and about a body length
//! of distance.

use super::head;
use crate::fish::perception::{Figure, Senses};
use crate::fish::posture::heading;
use crate::fish::world::FishId;
use crate::fish::{Chase, Command, Posture};
use crate::math::asin;
use glam::DVec3;

/// Within so many body lengths others are neighbours, in formation, too near.
const NEIGHBOURS: f64 = 4.0;
const FORMATION: f64 = 2.0;
const TOO_NEAR: f64 = 0.8;
/// How much an offset across the heading counts, and how large it may be by L before it does.
const OFFSET_GAIN: f64 = 0.15;
const OFFSET_MIN: f64 = 1.0;
/// How much being too near counts.
const APART: f64 = 0.5;
/// σ of a fish alone, of one in place, by how much a gap changes it, and its bounds.
const CRUISE: f64 = 0.7;
const CATCH_UP: f64 = 0.3;
const SWIM: [f64; 2] = [0.3, 1.0];
const SWIM_TOO_NEAR: f64 = 0.6;

/// What to do in this step to be in a school; none if nobody is in sight to school with. `near` is room for who is.
pub fn keep(
    senses: &Senses<'_>,
    chase: &mut Chase,
    posture: &Posture<'_>,
    near: &mut Vec<FishId>,
) -> Option<Command> {
    let (me, length) = (senses.me, senses.me.length());
    let companion = |figure: &Figure| figure.schooling && figure.species == me.species;
    let distance = |figure: &Figure| (figure.center - me.center).length();
    near.clear();
    near.extend(senses.seen(companion).map(|figure| figure.id));
    let scene = senses.scene;
    let nearest = scene.figures_of(near).reduce(|a, b| if distance(b) < distance(a) { b } else { a })?;
    if distance(nearest) > FORMATION * length {
        let leader = leader(scene.figures_of(near), me)?;
        return Some(chase.toward(leader.center, 1.0, posture, me.size));
    }
    near.retain(|id| distance(&scene.figures[id.index()]) <= NEIGHBOURS * length);
    let count = near.len() as f64;
    let mean = scene.figures_of(near).map(|figure| figure.forward).sum::<DVec3>() / count;
    let along = mean.try_normalize().unwrap_or(me.forward);
    let way = scene.figures_of(near).map(|figure| figure.center).sum::<DVec3>() / count - me.center;
    let gap = way.dot(along);
    let offset = way - along * gap;
    let (wish, swim) = if distance(nearest) <= TOO_NEAR * length {
        let apart = (me.center - nearest.center).normalize_or_zero();
        (mean + apart * APART, swim(gap, length).min(SWIM_TOO_NEAR))
    } else {
        let inward =
            if offset.length() > OFFSET_MIN * length { offset * (OFFSET_GAIN / length) } else { DVec3::ZERO };
        (mean + inward, swim(gap, length))
    };
    let Some(wish) = wish.try_normalize() else {
        return Some(head(posture, posture.heading(), 0.0, swim)); // AF-9: keeps its heading
    };
    Some(head(posture, heading(wish), asin(wish.z.clamp(-1.0, 1.0)), swim))
}

/// On, as it goes: of a fish that flees and sees neither predator nor company.
pub fn alone(posture: &Posture<'_>) -> Command {
    head(posture, posture.heading(), 0.0, CRUISE)
}

/// σ of a fish with a gap ahead of it, length units.
fn swim(gap: f64, length: f64) -> f64 {
    (CRUISE + CATCH_UP * gap / length).clamp(SWIM[0], SWIM[1])
}

/// The one farthest ahead along the mean heading of all; the lower id of two alike.
fn leader<'a>(visible: impl Iterator<Item = &'a Figure> + Clone, me: &Figure) -> Option<&'a Figure> {
    let mean: DVec3 = visible.clone().map(|figure| figure.forward).sum();
    let ahead = |figure: &Figure| (figure.center - me.center).dot(mean);
    visible.reduce(|a, b| if ahead(b) > ahead(a) { b } else { a })
}

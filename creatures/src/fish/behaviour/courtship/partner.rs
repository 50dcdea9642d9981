//! Whom a fish courts: he the near one, she the large one, both rather their own kind.

use crate::fish::behaviour::Stage;
use crate::fish::habits::{Nature, Sex};
use crate::fish::perception::{Figure, Percept, Senses};
use crate::fish::world::FishId;

/// How much another species attracts, by one's own.
const OTHER_SPECIES: f64 = 0.5;

/// The most attractive in sight, the lower id of two alike, those left alone aside.
pub(super) fn best<'a>(senses: &Senses<'a>, excluded: &[(FishId, f64)]) -> Option<Percept<'a>> {
    let me = senses.me;
    let suits = |figure: &Figure| {
        figure.nature == Nature::Pacifist
            && figure.sex != me.sex
            && !excluded.iter().any(|&(id, _)| id == figure.id)
    };
    let seen = senses.fishes(suits).map(|percept| (attraction(me, &percept), percept));
    seen.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|(_, percept)| percept)
}

/// s/(1 + d/L) to a male, s × size to a female.
pub(super) fn attraction(me: &Figure, other: &Percept<'_>) -> f64 {
    let kind = if other.figure.species == me.species { 1.0 } else { OTHER_SPECIES };
    match me.sex {
        Sex::Male => kind / (1.0 + other.distance / me.length()),
        Sex::Female => kind * other.figure.size,
    }
}

/// A male of her species who displays to her from near by and is larger than the one she has, the largest first
///
pub(super) fn larger<'a>(
    senses: &Senses<'a>,
    present: &Figure,
    larger: f64,
    near: f64,
) -> Option<Percept<'a>> {
    let me = senses.me;
    let displays = |figure: &Figure| {
        figure.sex == Sex::Male
            && figure.species == me.species
            && figure.stage == Stage::Display
            && figure.partner == Some(me.id)
            && figure.size >= larger * present.size
    };
    let close = senses.fishes(displays).filter(|rival| rival.distance <= near * me.length());
    close.reduce(|a, b| if b.figure.size > a.figure.size { b } else { a })
}

//! What a fish attends to: one thing to eat, kept until another is much nearer. Whom it
//! courts is courtship's business.

use super::{Figure, Room, Senses};
use crate::fish::habits::Nature;
use crate::fish::mind::{Intention, Target};
use crate::fish::world::FishId;
use std::f64::consts::PI;

/// What turning costs, of food and of prey, and what a school costs.
const TURN_COST: f64 = 0.2;
const SCHOOL_COST: f64 = 0.5;
/// A school are at least so many others of its intention, within so many body lengths.
const COMPANIONS: usize = 2;
const COMPANY: f64 = 2.0;

/// Whether a target gives way to a candidate: distances for food, costs for prey.
pub fn replaces(candidate: f64, current: f64, persistence: f64) -> bool {
    current - candidate > persistence
}

/// C = d (1 + β₁ S + β₂ E/π) of one prey: `distance` from the mouth to its b, whether it is in a school,
/// and the angle of turning toward it, rad.
pub fn prey_cost(distance: f64, schooled: bool, angle: f64) -> f64 {
    let school = if schooled { SCHOOL_COST } else { 0.0 };
    distance * (1.0 + school + TURN_COST * angle / PI)
}

/// Whether a fish is in a school.
pub fn in_school(senses: &Senses<'_>, figure: &Figure, near: &mut Vec<FishId>) -> bool {
    if figure.intention != Intention::School {
        return false;
    }
    senses.scene.grid.within(figure.center, COMPANY * figure.length(), near);
    let schooling = |id: &&FishId| {
        let other = &senses.scene.figures[id.index()];
        other.id != figure.id && other.species == figure.species && other.intention == Intention::School
    };
    near.iter().filter(schooling).count() >= COMPANIONS
}

/// What is to be eaten: what it was, unless that is out of sight or gives way, else the best in sight, the lower
/// id of two alike. `cost` is C of the chosen prey.
pub fn food(senses: &Senses<'_>, current: Option<Target>, room: &mut Room) -> Option<(Target, f64)> {
    let Room { near, costs } = room;
    costs.clear();
    if senses.habits.nature == Nature::Predator {
        let mut cost = |target: Target| match target {
            Target::Fish(id) => {
                let prey = &senses.scene.figures[id.index()];
                let distance = (prey.center - senses.me.mouth).length();
                let angle = senses.me.turning_angle(prey.center);
                prey_cost(distance, in_school(senses, prey, near), angle)
            }
            Target::Particle(_) => f64::INFINITY, // a predator never takes one for its target
        };
        let prey = senses.figures().filter(|figure| figure.nature == Nature::Prey);
        costs.extend(prey.map(|figure| Target::Fish(figure.id)).map(|target| (cost(target), target)));
        return persist(senses, current, costs, cost);
    }
    let distance = |target: Target| match target {
        Target::Particle(id) => (senses.scene.particles[id.index()].position - senses.me.mouth).length(),
        Target::Fish(_) => f64::INFINITY,
    };
    let weighed = |target: Target, at| {
        (distance(target) * (1.0 + TURN_COST * senses.me.turning_angle(at) / PI), target)
    };
    let present = senses.scene.particles.iter().filter(|particle| particle.present);
    costs.extend(present.map(|particle| weighed(Target::Particle(particle.id), particle.position)));
    persist(senses, current, costs, distance)
}

/// The cheapest candidate in sight, or the current target if that is in sight and persistence holds it; with its
/// measure.
fn persist(
    senses: &Senses<'_>,
    current: Option<Target>,
    costs: &mut [(f64, Target)],
    mut measure: impl FnMut(Target) -> f64,
) -> Option<(Target, f64)> {
    costs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let best = costs.iter().find(|(_, target)| senses.target(*target).is_some()).map(|&(_, target)| target);
    let held = current.filter(|&target| senses.target(target).is_some());
    let chosen = match (held, best) {
        (Some(held), Some(best)) => {
            if replaces(measure(best), measure(held), senses.habits.persistence) {
                best
            } else {
                held
            }
        }
        (held, best) => held.or(best)?,
    };
    Some((chosen, measure(chosen)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::habits::{Habits, Sex};
    use crate::fish::perception::tests::Pond;
    use crate::fish::world::{Particle, ParticleId, Stuff, Tank, tank};
    use glam::DVec3;

    /// T-20
    #[test]
    fn schools_and_turns_make_prey_dear() {
        let degrees = f64::to_radians;
        let costs = [
            (prey_cost(40.0, false, 0.0), 40.0),
            (prey_cost(40.0, true, 0.0), 60.0),
            (prey_cost(40.0, false, degrees(90.0)), 44.0),
            (prey_cost(30.0, true, degrees(180.0)), 51.0),
            (prey_cost(44.0, false, degrees(30.0)), 45.466_666_666_666_67),
        ];
        for (found, expected) in costs {
            assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
        }
        assert!(costs[1..].iter().all(|other| other.0 > costs[0].0), "the first is chosen");
    }

    /// T-24
    #[test]
    fn a_target_gives_way_to_what_is_much_nearer() {
        assert!(!replaces(61.0, 100.0, 40.0) && replaces(59.0, 100.0, 40.0));
        assert!(!replaces(60.0, 100.0, 40.0));
    }

    fn food_at(pond: &mut Pond, place: DVec3) {
        let id = ParticleId(pond.particles.len() as u32);
        let mut food = Particle::new(id, Stuff::default(), &Tank::new(tank::PUBLISHED), 1, 0, |_| true);
        food.position = place;
        pond.particles.push(food);
    }

    fn chosen(pond: &Pond, current: Option<u32>) -> Option<Target> {
        let current = current.map(|id| Target::Particle(ParticleId(id)));
        pond.senses(0, |senses| food(senses, current, &mut Room::default())).map(|(target, _)| target)
    }

    /// the mouth is at y = 2.
    #[test]
    fn food_is_chosen_by_distance_and_turn_and_kept() {
        let mut pond = Pond::with_eye_at_origin();
        let of = |id| Some(Target::Particle(ParticleId(id)));
        assert_eq!(chosen(&pond, None), None, "AF-11: no food");
        food_at(&mut pond, DVec3::new(0.0, 102.0, 0.0));
        food_at(&mut pond, DVec3::new(95.0, 2.0, 0.0));
        assert_eq!(chosen(&pond, None), of(0), "95 (1 + 0.1) is more than 100");
        food_at(&mut pond, DVec3::new(0.0, 63.0, 0.0));
        assert_eq!(chosen(&pond, Some(0)), of(0));
        assert_eq!(chosen(&pond, None), of(2));
        pond.particles[2].position.y = 61.0;
        assert_eq!(chosen(&pond, Some(0)), of(2));
        pond.particles[0].vanish();
        assert_eq!(chosen(&pond, Some(0)), of(2), "AF-12: it is gone");
    }

    ///
    #[test]
    fn a_predator_prefers_the_one_outside_the_school() {
        let mut pond = Pond::empty();
        pond.add_of(Habits::published(Nature::Predator, Sex::Male), DVec3::ZERO, 0.0);
        for x in [-20.0, 0.0, 20.0] {
            pond.add(DVec3::new(x, 80.0, 0.0), 0.0);
        }
        pond.add(DVec3::new(-10.0, 100.0, 20.0), 0.0);
        let choose =
            |pond: &Pond| pond.senses(0, |senses| food(senses, None, &mut Room::default())).unwrap().0;
        assert_eq!(choose(&pond), Target::Fish(FishId(2)));
        for fish in 1..4 {
            pond.figures[fish].intention = Intention::School;
        }
        assert_eq!(choose(&pond), Target::Fish(FishId(4)));
        pond.figures[3].intention = Intention::Eat;
        assert_eq!(choose(&pond), Target::Fish(FishId(2)), "two are no school");
    }
}

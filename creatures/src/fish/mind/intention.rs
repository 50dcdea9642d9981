//! The intention generator: what a fish means to do, by the first of five rules that fires. It is
//! a pure function of what the fish feels and sees.

use super::{Fear, Memory};
use crate::fish::habits::{Habits, Nature};

/// What a fish means to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Intention {
    /// Not to run into something.
    Avoid,
    /// To get away from a predator.
    Escape,
    /// To be safe among others.
    School,
    /// To eat.
    Eat,
    /// To mate.
    Mate,
    /// To get out of uncomfortable water.
    Leave,
    /// Nothing in particular.
    #[default]
    Wander,
}

/// The rule of A-63 that fired.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Cause {
    /// Rule 1.
    Collision,
    /// Rule 2.
    Predator,
    /// Rule 3.
    Memory,
    /// Rule 4.
    Desire,
    /// Rule 5.
    #[default]
    Ambience,
}

/// What the rules look at, in a fish whose mental state is felt already.
#[derive(Debug, Clone, Copy)]
pub struct Situation {
    /// Whether something is about to be run into.
    pub collision: bool,
    /// F and F_m.
    pub fear: Fear,
    /// H.
    pub hunger: f64,
    /// L.
    pub libido: f64,
    /// What it was kept from, if its target is still in sight.
    pub memory: Option<Memory>,
    /// What it meant to do until now.
    pub previous: Intention,
}

/// The intention and its cause. `comfortable` reads the ambient light and temperature, and `coin` is tossed
/// when hunger and libido are alike; both only if it comes to that.
///
/// Predators have neither fear nor libido, and are comfortable everywhere; prey have no libido, pacifists no
/// fear.
pub fn decide(
    habits: &Habits,
    situation: &Situation,
    comfortable: impl FnOnce() -> bool,
    coin: impl FnOnce() -> bool,
) -> (Intention, Cause) {
    if situation.collision {
        return (Intention::Avoid, Cause::Collision);
    }
    let Fear { total, worst, .. } = situation.fear;
    if habits.nature == Nature::Prey && total > habits.fear_min {
        let school = worst < habits.panic && habits.schooling;
        return (if school { Intention::School } else { Intention::Escape }, Cause::Predator);
    }
    // A school is resumed only while it is still needed, which the rule above has answered.
    if let Some(memory) = situation.memory.filter(|memory| memory.intention != Intention::School) {
        return (memory.intention, Cause::Memory);
    }
    let libido = if habits.nature == Nature::Pacifist { situation.libido } else { 0.0 };
    let hunger = situation.hunger;
    if hunger.max(libido) > habits.urge {
        let eat = match (hunger > libido, libido > hunger, situation.previous) {
            (true, _, _) | (_, false, Intention::Eat) => true,
            (_, true, _) | (_, _, Intention::Mate) => false,
            _ => coin(),
        };
        return (if eat { Intention::Eat } else { Intention::Mate }, Cause::Desire);
    }
    let content = habits.nature == Nature::Predator || comfortable();
    (if content { Intention::Wander } else { Intention::Leave }, Cause::Ambience)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::habits::Sex;
    use crate::fish::mind::Target;
    use crate::fish::world::ParticleId;
    use Intention::{Avoid, Eat, Escape, Leave, Mate, School, Wander};
    use Nature::{Pacifist, Predator, Prey};

    struct Row {
        nature: Nature,
        collision: bool,
        fear: (f64, f64),
        schooling: bool,
        hunger: f64,
        libido: f64,
        comfortable: bool,
        remembers: bool,
        previous: Intention,
    }

    const CALM: Row = Row {
        nature: Prey,
        collision: false,
        fear: (0.0, 0.0),
        schooling: true,
        hunger: 0.1,
        libido: 0.0,
        comfortable: true,
        remembers: false,
        previous: Wander,
    };

    fn result(row: &Row) -> Intention {
        let habits = Habits { schooling: row.schooling, ..Habits::published(row.nature, Sex::Male) };
        let memory = row.remembers.then_some(Memory::new(Eat, Some(Target::Particle(ParticleId(7))), 0.0));
        let situation = Situation {
            collision: row.collision,
            fear: Fear { total: row.fear.0, worst: row.fear.1, of: None },
            hunger: row.hunger,
            libido: row.libido,
            memory,
            previous: row.previous,
        };
        decide(&habits, &situation, || row.comfortable, || false).0
    }

    /// T-21, row by row.
    #[test]
    fn the_table_of_intentions() {
        for nature in [Predator, Prey, Pacifist] {
            let all = Row {
                nature,
                collision: true,
                fear: (0.9, 0.9),
                hunger: 0.9,
                libido: 0.9,
                comfortable: false,
                remembers: true,
                ..CALM
            };
            assert_eq!(result(&all), Avoid);
        }
        let scared = Row { fear: (0.55, 0.40), hunger: 0.9, ..CALM };
        assert_eq!(result(&scared), School);
        assert_eq!(result(&Row { schooling: false, ..scared }), Escape);
        assert_eq!(result(&Row { fear: (0.90, 0.75), ..scared }), Escape);
        assert_eq!(result(&Row { fear: (0.40, 0.40), hunger: 0.3, ..CALM }), Eat, "F is not above f₀");
        assert_eq!(result(&Row { fear: (0.1, 0.1), remembers: true, ..CALM }), Eat);
        assert_eq!(result(&Row { fear: (0.1, 0.1), ..CALM }), Wander, "what is lost is forgotten");
        let pacifist = Row { nature: Pacifist, hunger: 0.3, libido: 0.5, ..CALM };
        assert_eq!(result(&pacifist), Mate);
        let alike = Row { hunger: 0.5, schooling: false, ..pacifist };
        assert_eq!(result(&Row { previous: Eat, ..alike }), Eat);
        assert_eq!(result(&Row { previous: Mate, ..alike }), Mate);
        assert_eq!(result(&alike), Mate, "the coin says so");
        let calm = Row { hunger: 0.25, libido: 0.1, comfortable: false, ..pacifist };
        assert_eq!(result(&calm), Leave);
        let predator = Row { nature: Predator, comfortable: false, ..CALM };
        assert_eq!(result(&predator), Wander);
        assert_eq!(result(&Row { hunger: 0.3, ..predator }), Eat);
    }

    ///
    #[test]
    fn natures_lack_what_they_have_no_use_for() {
        let all = Row { fear: (1.0, 1.0), hunger: 0.3, libido: 0.9, ..CALM };
        assert_eq!(result(&Row { nature: Predator, ..all }), Eat);
        assert_eq!(result(&Row { nature: Pacifist, ..all }), Mate);
        assert_eq!(result(&Row { nature: Prey, fear: (0.0, 0.0), ..all }), Eat);
    }

    #[test]
    fn ambience_is_read_only_when_nothing_else_decides() {
        let habits = Habits::published(Prey, Sex::Male);
        let situation = Situation {
            collision: false,
            fear: Fear::default(),
            hunger: 0.9,
            libido: 0.0,
            memory: None,
            previous: Wander,
        };
        decide(&habits, &situation, || panic!("light was read"), || panic!("a coin was tossed"));
    }
}

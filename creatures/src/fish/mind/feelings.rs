//! Hunger, libido and fear. They are formulas of time and distance; what a fish sees is told.

use crate::fish::habits::Habits;
use crate::fish::world::FishId;

/// D₀: a predator this near is all the fear there is.
const FEAR_DISTANCE: f64 = 100.0;

/// What hunger and libido depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drives {
    /// n_e, meals not yet digested.
    pub meals: u32,
    /// Δt_H, time since the last meal.
    pub since_meal: f64,
    /// Δt_L, time since the last mating.
    pub since_mating: f64,
}

impl Drives {
    /// At birth: half full.
    pub fn new(habits: &Habits) -> Drives {
        Drives { meals: (0.5 * habits.appetite).ceil() as u32, since_meal: 0.0, since_mating: 0.0 }
    }

    /// H = min(1 − n_e R(Δt_H)/α, 1) with R(x) = 1 − p₀ x, in [0, 1]. A stomach that has digested everything
    /// is empty from then on.
    pub fn hunger(&mut self, habits: &Habits) -> f64 {
        let rest = 1.0 - habits.digestion * self.since_meal;
        if rest <= 0.0 {
            self.meals = 0;
        }
        let undigested = f64::from(self.meals) * rest.max(0.0);
        (1.0 - undigested / habits.appetite).clamp(0.0, 1.0)
    }

    /// L = min(s(Δt_L)(1 − H), 1) with s(x) = p₁ x.
    pub fn libido(&self, hunger: f64, habits: &Habits) -> f64 {
        (habits.ardour * self.since_mating * (1.0 - hunger)).clamp(0.0, 1.0)
    }

    /// Time passes.
    pub fn pass(&mut self, time: f64) {
        self.since_meal += time;
        self.since_mating += time;
    }

    /// A meal is swallowed.
    pub fn eat(&mut self) {
        self.meals = self.meals.saturating_add(1);
        self.since_meal = 0.0;
    }

    /// A mating is done.
    pub fn mate(&mut self) {
        self.since_mating = 0.0;
    }
}

/// What predators in sight do to a fish.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fear {
    /// F, in [0, 1].
    pub total: f64,
    /// F_m, of the most dangerous one.
    pub worst: f64,
    /// m, the most dangerous one; the lower id of two alike.
    pub of: Option<FishId>,
}

impl Fear {
    /// F = min(Σ Fⁱ, 1), Fⁱ = min(D₀/dⁱ, 1), over sighted predators in ascending order and their distances; at
    /// distance 0 all the fear there is (A-61, AF-9).
    pub fn of(predators: impl IntoIterator<Item = (FishId, f64)>) -> Fear {
        let mut fear = Fear::default();
        for (id, distance) in predators {
            let one = if distance > FEAR_DISTANCE { FEAR_DISTANCE / distance } else { 1.0 };
            fear.total += one;
            if one > fear.worst {
                (fear.worst, fear.of) = (one, Some(id));
            }
        }
        fear.total = fear.total.min(1.0);
        fear
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::habits::{Nature, Sex};

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
    }

    fn habits(digestion: f64, ardour: f64) -> Habits {
        Habits { digestion, ardour, ..Habits::published(Nature::Pacifist, Sex::Male) }
    }

    /// T-17
    #[test]
    fn hunger_grows_as_meals_are_digested() {
        for (meals, since_meal, digestion, expected) in [
            (0, 0.0, 0.00067, 1.0),
            (1, 0.0, 0.00067, 0.8),
            (3, 500.0, 0.00067, 0.601),
            (5, 1000.0, 0.00067, 0.67),
            (8, 100.0, 0.00067, 0.0),
            (3, 100.0, 0.005, 0.7),
        ] {
            let mut drives = Drives { meals, since_meal, since_mating: 0.0 };
            close(drives.hunger(&habits(digestion, 0.0025)), expected);
            assert_eq!(drives.meals, meals);
        }
        let mut drives = Drives { meals: 3, since_meal: 1600.0, since_mating: 0.0 };
        close(drives.hunger(&habits(0.00067, 0.0025)), 1.0);
        assert_eq!(drives.meals, 0, "what is digested is gone");
        drives.eat();
        close(drives.hunger(&habits(0.00067, 0.0025)), 0.8);
    }

    /// T-18
    #[test]
    fn libido_grows_with_time_in_a_fish_that_is_not_hungry() {
        for (since_mating, hunger, ardour, expected) in [
            (100.0, 0.2, 0.0025, 0.2),
            (400.0, 0.5, 0.0025, 0.5),
            (1000.0, 0.1, 0.0025, 1.0),
            (100.0, 0.2, 0.01, 0.8),
            (400.0, 1.0, 0.0025, 0.0),
        ] {
            let drives = Drives { meals: 0, since_meal: 0.0, since_mating };
            close(drives.libido(hunger, &habits(0.00067, ardour)), expected);
        }
    }

    /// T-19, AF-9
    #[test]
    fn fear_adds_up_over_predators_in_sight() {
        let of =
            |distances: &[f64]| Fear::of(distances.iter().enumerate().map(|(i, &d)| (FishId(i as u32), d)));
        close(of(&[400.0]).total, 0.25);
        close(of(&[250.0, 500.0]).total, 0.6);
        close(of(&[50.0, 400.0]).total, 1.0);
        let two = of(&[150.0, 150.0]);
        close(two.total, 1.0);
        close(two.worst, 2.0 / 3.0);
        assert_eq!(two.of, Some(FishId(0)), "the lower id of two alike");
        assert_eq!(of(&[]), Fear::default(), "a predator out of sight frightens nobody");
        assert_eq!((of(&[0.0]).total, of(&[0.0]).worst), (1.0, 1.0));
    }

    #[test]
    fn a_fish_starts_half_full() {
        assert_eq!(Drives::new(&Habits::published(Nature::Prey, Sex::Male)).meals, 3);
    }
}

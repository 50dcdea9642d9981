//! Food and plankton: specks that drift with the water, sink, and are sucked in. They take no
//! room and stop nobody's sight.

use super::{ParticleId, Tank};
use crate::fish::mechanics::TIME_STEP;
use crate::random::{Stream, stream};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// How fast a speck takes on the water's velocity, 1/time.
const FOLLOW: f64 = 5.0;
/// How far plankton wanders by itself, length by the root of time.
const WALK: f64 = 0.05;
/// Specks appear at least this far from the tank's faces, where fishes dare to go.
const MARGIN: f64 = 30.0;

/// One kind of specks, as a scenario stocks it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stuff {
    /// How many.
    pub count: u32,
    /// How fast it sinks in still water, length by time.
    pub sink: f64,
    /// Whether it moves by itself.
    pub plankton: bool,
    /// Time until an eaten one is replaced at a seeded place; not at all if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub respawn: Option<f64>,
}

impl Default for Stuff {
    fn default() -> Self {
        Stuff { count: 15, sink: 0.0, plankton: false, respawn: None }
    }
}

/// A speck.
#[derive(Debug, Clone)]
pub struct Particle {
    /// Which one.
    pub id: ParticleId,
    /// Where it is.
    pub position: DVec3,
    /// How it moves, length by time, suction not counted.
    pub velocity: DVec3,
    /// Whether it is there to be eaten.
    pub present: bool,
    stuff: Stuff,
    /// Time until it is replaced.
    absent_for: f64,
    draws: Stream,
}

impl Particle {
    /// At a place that the stream of its seed, trial and id draws, clear of what `free` does not hold of.
    pub fn new(
        id: ParticleId,
        stuff: Stuff,
        tank: &Tank,
        seed: u64,
        trial: u32,
        free: impl Fn(DVec3) -> bool,
    ) -> Particle {
        let draws = stream(seed, [trial, id.0, 0], "fish world particle");
        let mut particle = Particle {
            id,
            position: DVec3::ZERO,
            velocity: DVec3::ZERO,
            present: true,
            stuff,
            absent_for: 0.0,
            draws,
        };
        particle.appear(tank, free);
        particle
    }

    /// One step in water of some velocity, with suction on top.
    pub fn drift(&mut self, water: DVec3, suction: DVec3, tank: &Tank, free: impl Fn(DVec3) -> bool) {
        if !self.present {
            let Some(delay) = self.stuff.respawn else { return };
            self.absent_for += TIME_STEP;
            if self.absent_for >= delay {
                self.present = true;
                self.appear(tank, free);
            }
            return;
        }
        let drawn = water - DVec3::Z * self.stuff.sink - self.velocity;
        self.velocity += drawn * (FOLLOW * TIME_STEP);
        self.position += (self.velocity + suction) * TIME_STEP;
        if self.stuff.plankton {
            let step = DVec3::new(self.draws.normal(), self.draws.normal(), self.draws.normal());
            self.position += step * (WALK * TIME_STEP.sqrt());
        }
        self.position = self.position.clamp(-tank.half, tank.half);
    }

    /// It is swallowed.
    pub fn vanish(&mut self) {
        (self.present, self.absent_for) = (false, 0.0);
    }

    fn appear(&mut self, tank: &Tank, free: impl Fn(DVec3) -> bool) {
        const TRIES: u32 = 100;
        let half = (tank.half - MARGIN).max(DVec3::ZERO);
        self.velocity = DVec3::ZERO;
        for _ in 0..TRIES {
            let draw = DVec3::new(self.draws.unit(), self.draws.unit(), self.draws.unit());
            self.position = (draw * 2.0 - 1.0) * half;
            if free(self.position) {
                return; // a tank so full that no try succeeds has food in its obstacles
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::world::tank::PUBLISHED;

    fn speck(stuff: Stuff) -> Particle {
        let tank = Tank::new(PUBLISHED);
        Particle::new(ParticleId(3), stuff, &tank, 7, 1, |at| at.x > 0.0)
    }

    /// the closed form of explicit relaxation.
    #[test]
    fn a_speck_takes_on_the_velocity_of_the_water_and_sinks() {
        let tank = Tank::new(PUBLISHED);
        let mut food = speck(Stuff { sink: 0.5, ..Stuff::default() });
        assert!(food.position.x > 0.0 && tank.holds(food.position, MARGIN));
        let start = food.position;
        food.drift(DVec3::X, DVec3::ZERO, &tank, |_| true);
        let expected = DVec3::new(0.275, 0.0, -0.1375);
        assert!((food.velocity - expected).length() < 1e-12, "{}", food.velocity);
        assert!((food.position - start - expected * TIME_STEP).length() < 1e-12);
        food.drift(food.velocity + DVec3::Z * 0.5, DVec3::Y, &tank, |_| true);
        assert!(
            (food.position - start - expected * (2.0 * TIME_STEP) - DVec3::Y * TIME_STEP).length() < 1e-12
        );
    }

    #[test]
    fn what_was_eaten_comes_back_when_its_time_is_up_or_never() {
        let tank = Tank::new(PUBLISHED);
        let mut food = speck(Stuff { respawn: Some(1.0), ..Stuff::default() });
        let mut gone = speck(Stuff::default());
        let before = food.position;
        food.vanish();
        gone.vanish();
        for step in 0..19 {
            assert!(!food.present && !gone.present, "{step}");
            food.drift(DVec3::ZERO, DVec3::ZERO, &tank, |_| true);
            gone.drift(DVec3::ZERO, DVec3::ZERO, &tank, |_| true);
        }
        assert!(food.present && food.position != before && !gone.present);
    }

    #[test]
    fn plankton_walks_as_far_as_the_root_of_time() {
        let tank = Tank::new(PUBLISHED);
        let mut plankton = speck(Stuff { plankton: true, ..Stuff::default() });
        let (start, steps) = (plankton.position, 4000);
        let mut square = 0.0;
        for _ in 0..steps {
            let before = plankton.position;
            plankton.drift(DVec3::ZERO, DVec3::ZERO, &tank, |_| true);
            square += (plankton.position - before).length_squared();
        }
        let expected = 3.0 * WALK * WALK * TIME_STEP * f64::from(steps);
        assert!((square / expected - 1.0).abs() < 0.1, "{square} {expected}");
        assert_ne!(plankton.position, start);
    }
}

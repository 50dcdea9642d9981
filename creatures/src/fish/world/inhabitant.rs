//! One fish of a world: body, habits, mind and routines together, and what it has done (A-51, steps 2 to 7).

use super::FishId;
use crate::fish::behaviour::{Routines, SEARCH, Stage, avoid, escape, feed, school};
use crate::fish::habits::{Habits, Nature};
use crate::fish::mechanics::TIME_STEP;
use crate::fish::mind::{Cause, Drives, Fear, Intention, Memory, Mind, Situation, Target, decide};
use crate::fish::perception::{Figure, Hazard, Horizon, Preferences, Room, Scene, Senses, focus};
use crate::fish::{Body, Command, Swimmer};
use crate::random::stream;
use glam::DVec3;
use std::sync::Arc;

/// A living fish, or what is left of it.
#[derive(Debug, Clone)]
pub struct Inhabitant {
    /// What it is like.
    pub habits: Habits,
    /// Its body.
    pub swimmer: Swimmer,
    /// What goes on in it.
    pub mind: Mind,
    /// What its routines remember.
    pub routines: Routines,
    /// What it has done.
    pub deeds: Deeds,
}

/// What a fish has done and suffered so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deeds {
    /// Meals swallowed.
    pub meals: u32,
    /// Rituals completed.
    pub matings: u32,
    /// Steps in contact with something that stands still.
    pub contact_steps: u32,
    /// Changes of intention.
    pub changes: u32,
    /// The least C of a prey that was attended to; infinite before any was.
    pub least_cost: Option<f64>,
    /// When it was eaten.
    pub died: Option<f64>,
}

impl Inhabitant {
    /// At rest at a place; its draws are named by the seed, the trial and its id.
    pub fn new(
        id: FishId,
        habits: Habits,
        body: Arc<Body>,
        place: DVec3,
        heading: f64,
        seed: u64,
        trial: u32,
    ) -> Inhabitant {
        let draws = |purpose| stream(seed, [trial, id.0, 0], purpose);
        let drives = Drives::new(&habits);
        let mind = Mind {
            drives,
            felt: [0.0; 3],
            intention: Intention::default(),
            cause: Cause::default(),
            target: None,
            memory: None,
            coins: draws("fish world coin"),
        };
        Inhabitant {
            swimmer: Swimmer::new(body, place, heading),
            mind,
            routines: Routines::new(draws("fish world wander")),
            deeds: Deeds::default(),
            habits,
        }
    }

    /// How it looks to others.
    pub fn figure(&self, id: FishId) -> Figure {
        let mut figure =
            Figure::new(id, &self.habits, &self.swimmer.motion.positions, self.swimmer.velocity());
        figure.alive = self.deeds.died.is_none();
        figure.intention = self.mind.intention;
        figure.partner = self.routines.courtship.partner;
        figure.stage = self.routines.courtship.stage;
        figure
    }

    /// Perceives, feels, intends and acts, for one step.
    pub fn live(
        &mut self,
        scene: &Scene<'_>,
        me: &Figure,
        horizon: &mut Horizon,
        room: &mut Room,
    ) -> Command {
        // The habits are lent to the senses for as long as the step takes.
        let habits = self.habits.clone();
        let senses = horizon.scan(scene, me, &habits);
        let prey = self.mind.target.filter(|_| habits.nature == Nature::Predator);
        let hazard = Hazard::of(&senses, self.mind.intention, prey, &mut room.near);
        let fear = self.feel(&senses);
        self.intend(&senses, hazard.is_some(), fear);
        self.mind.drives.pass(TIME_STEP);
        self.act(&senses, hazard, fear, room)
    }

    /// Mental state.
    fn feel(&mut self, senses: &Senses<'_>) -> Fear {
        let fear = if self.habits.nature == Nature::Prey {
            let predators = senses.fishes(|figure| figure.nature == Nature::Predator);
            Fear::of(predators.map(|predator| (predator.figure.id, predator.distance)))
        } else {
            Fear::default()
        };
        let hunger = self.mind.drives.hunger(&self.habits);
        let courts = self.habits.nature == Nature::Pacifist;
        let libido = if courts { self.mind.drives.libido(hunger, &self.habits) } else { 0.0 };
        self.mind.felt = [hunger, libido, fear.total];
        fear
    }

    /// Intention and memory (A-63..A-67).
    fn intend(&mut self, senses: &Senses<'_>, collision: bool, fear: Fear) {
        let time = senses.scene.time;
        let mind = &mut self.mind;
        let mut in_sight = true;
        if let Some(memory) = mind.memory {
            let alive = memory.target.is_none_or(|target| senses.scene.has(target));
            in_sight = memory.target.is_none_or(|target| senses.target(target).is_some());
            mind.memory = memory.kept(alive, in_sight, time);
        }
        let [hunger, libido, _] = mind.felt;
        let situation = Situation {
            collision,
            fear,
            hunger,
            libido,
            memory: mind.memory.filter(|_| in_sight),
            previous: mind.intention,
        };
        let coins = &mut mind.coins;
        let (intention, cause) =
            decide(senses.habits, &situation, || senses.comfortable(), || coins.chance(0.5));
        if intention != mind.intention {
            self.change(intention, time);
        }
        self.mind.cause = cause;
        let courting = self.mind.memory.is_some_and(|memory| memory.intention == Intention::Mate);
        if intention != Intention::Mate && !courting {
            self.routines.courtship.reset();
        }
    }

    fn change(&mut self, intention: Intention, time: f64) {
        let mind = &mut self.mind;
        let put_off = Memory::of_change(mind.intention, intention, mind.target, time);
        match mind.memory {
            Some(memory) if memory.intention == intention => {
                (mind.target, mind.memory) = (memory.target, None);
            }
            memory => {
                (mind.memory, mind.target) = (memory.or(put_off), None);
            }
        }
        mind.intention = intention;
        self.deeds.changes += 1;
        self.routines.chase.straight = false;
        self.routines.wander.forget();
    }

    /// The routine of the intention (A-68..A-84).
    fn act(&mut self, senses: &Senses<'_>, hazard: Option<Hazard>, fear: Fear, room: &mut Room) -> Command {
        let posture = self.swimmer.posture();
        let time = senses.scene.time;
        let routines = &mut self.routines;
        let predator = fear.of.and_then(|id| senses.fish(id));
        let wander = |routines: &mut Routines, swim| routines.wander.about(&posture, time, swim);
        match (self.mind.intention, hazard) {
            (Intention::Avoid, Some(Hazard::Surface(surface))) => {
                let avoid = Preferences::of(senses, None, Some(surface.index), &mut room.near);
                avoid::surface(senses, &posture, &surface, avoid)
            }
            (Intention::Avoid, Some(Hazard::Fish(id))) => {
                let preferences = Preferences::of(senses, Some(id), None, &mut room.near);
                let other =
                    crate::fish::perception::Percept::new(senses.me, &senses.scene.figures[id.index()]);
                avoid::fish(senses, &other, preferences)
            }
            (Intention::Escape, _) => match predator {
                Some(predator) => escape::from(senses, &predator),
                None => school::alone(&posture),
            },
            (Intention::School, _) => {
                let kept = school::keep(senses, &mut routines.chase, &posture, &mut room.near);
                kept.unwrap_or_else(|| match predator {
                    Some(predator) => Command { swim: 0.7, ..escape::from(senses, &predator) },
                    None => school::alone(&posture),
                })
            }
            (Intention::Eat, _) => {
                let chosen = focus::food(senses, self.mind.target, room);
                let target = chosen.map(|(target, _)| target);
                if target != self.mind.target {
                    routines.chase.straight = false;
                }
                self.mind.target = target;
                match chosen.and_then(|(target, cost)| senses.target(target).map(|at| (at, cost))) {
                    Some((at, cost)) => {
                        if self.habits.nature == Nature::Predator {
                            let least = self.deeds.least_cost.map_or(cost, |least| least.min(cost));
                            self.deeds.least_cost = Some(least);
                        }
                        feed::eat(
                            &mut routines.chase,
                            &mut routines.bite,
                            at,
                            &posture,
                            self.habits.size,
                            time,
                        )
                    }
                    None => wander(routines, SEARCH),
                }
            }
            (Intention::Mate, _) => {
                let courted = routines.courtship.court(senses, &mut routines.chase, &posture);
                self.mind.target = routines.courtship.partner.map(Target::Fish);
                courted.unwrap_or_else(|| wander(routines, SEARCH))
            }
            (Intention::Leave, _) => routines.wander.leave(senses, &posture, time),
            (Intention::Wander | Intention::Avoid, _) => wander(routines, self.habits.cruise),
        }
    }

    /// The farthest stage of courtship it has reached.
    pub fn best_stage(&self) -> Stage {
        self.routines.courtship.best
    }
}

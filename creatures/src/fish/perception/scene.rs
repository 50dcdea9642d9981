//! All there is to perceive at one instant, and one fish's way into it. It is the same for all fishes of a
//! step, whichever is asked first.

use super::capsule::Capsule;
use super::{Figure, Percept, brightness, vision};
use crate::fish::habits::Habits;
use crate::fish::mind::Target;
use crate::fish::world::{Climate, FishId, Grid, Obstacle, Particle, ParticleId, Tank};
use glam::DVec3;

/// The world at an instant.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// Time units since the start.
    pub time: f64,
    /// Its faces are obstacles.
    pub tank: Tank,
    /// What stands still.
    pub obstacles: &'a [Obstacle],
    /// Light and warmth.
    pub climate: &'a Climate,
    /// (fishes), the dead ones too.
    pub figures: &'a [Figure],
    /// (fishes), what stands in the light, the dead ones' too.
    pub shadows: &'a [Shadow],
    /// (particles), the absent ones too.
    pub particles: &'a [Particle],
    /// The living fishes by place.
    pub grid: &'a Grid,
    /// No fish is faster, length by time.
    pub speed_max: f64,
    /// No fish is larger, S.
    pub size_max: f64,
}

/// What a living fish hides: kept apart from all else that is known of it, since most looking is past it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shadow {
    /// Whose it is.
    pub id: FishId,
    /// The middle of the capsule, and the radius of a ball about it that holds it.
    pub center: DVec3,
    /// As said.
    pub reach: f64,
    /// Its exact shape.
    pub capsule: Capsule,
}

impl Shadow {
    /// Of a fish as it looks now.
    pub fn of(figure: &Figure) -> Shadow {
        let capsule = figure.shadow;
        Shadow { id: figure.id, center: capsule.center(), reach: capsule.reach(), capsule }
    }

    /// Whether it meets a ray (unit direction) within a distance.
    #[inline]
    pub fn meets(&self, origin: DVec3, direction: DVec3, distance: f64) -> bool {
        let way = self.center - origin;
        let along = way.dot(direction);
        // Most rays pass it by.
        way.length_squared() - along * along <= self.reach * self.reach
            && self.capsule.hit(origin, direction, distance).is_some()
    }
}

impl<'a> Scene<'a> {
    /// How some fishes look.
    pub fn figures_of<'b>(
        &self,
        ids: &'b [FishId],
    ) -> impl Iterator<Item = &'a Figure> + Clone + use<'a, 'b> {
        let figures = self.figures;
        ids.iter().map(move |id| &figures[id.index()])
    }

    /// Whether a target is there at all.
    pub fn has(&self, target: Target) -> bool {
        match target {
            Target::Fish(id) => self.figures[id.index()].alive,
            Target::Particle(id) => self.particles[id.index()].present,
        }
    }
}

/// The fishes near enough for one to see them, found once a step: all that it looks at and all that can stand in
/// its way lies among them. Room is kept from fish to fish.
#[derive(Debug, Default)]
pub struct Horizon {
    /// Ascending.
    others: Vec<FishId>,
    /// Of the others.
    shadows: Vec<Shadow>,
}

impl Horizon {
    /// Room for so many fishes.
    pub fn with_room(fishes: usize) -> Horizon {
        Horizon { others: Vec::with_capacity(fishes), shadows: Vec::with_capacity(fishes) }
    }

    /// Looks about with a fish's reach of sight.
    pub fn scan<'a>(&'a mut self, scene: &'a Scene<'a>, me: &'a Figure, habits: &'a Habits) -> Senses<'a> {
        // No node is as far from b as the body is long.
        scene.grid.within(me.eye, habits.vision + 20.0 * scene.size_max, &mut self.others);
        self.others.retain(|&id| id != me.id);
        self.shadows.clear();
        self.shadows.extend(self.others.iter().map(|id| scene.shadows[id.index()]));
        Senses { scene, me, habits, others: &self.others, shadows: &self.shadows }
    }
}

/// Room for the lists that a fish makes in a step, kept from fish to fish, so that no step allocates.
#[derive(Debug, Default)]
pub struct Room {
    /// Who is near.
    pub near: Vec<FishId>,
    /// What there is to eat, and what it costs.
    pub costs: Vec<(f64, Target)>,
}

impl Room {
    /// Enough for so many fishes and particles.
    pub fn with_room(fishes: usize, particles: usize) -> Room {
        Room { near: Vec::with_capacity(fishes), costs: Vec::with_capacity(fishes.max(particles)) }
    }
}

/// One fish's senses.
#[derive(Debug, Clone, Copy)]
pub struct Senses<'a> {
    /// What there is.
    pub scene: &'a Scene<'a>,
    /// Who perceives it.
    pub me: &'a Figure,
    /// What it is like.
    pub habits: &'a Habits,
    /// Whoever else may be within sight, ascending.
    pub others: &'a [FishId],
    /// What they hide.
    pub shadows: &'a [Shadow],
}

impl<'a> Senses<'a> {
    /// Temperature at b.
    pub fn temperature(&self) -> f64 {
        self.scene.climate.temperature(self.me.center)
    }

    /// Mean intensity of what the eye gets.
    pub fn brightness(&self) -> f64 {
        brightness::mean(self)
    }

    /// Whether light and temperature are what the fish likes.
    pub fn comfortable(&self) -> bool {
        let Habits { brightness_min, brightness_max, temperature_min, temperature_max, .. } = *self.habits;
        (temperature_min..=temperature_max).contains(&self.temperature())
            && (brightness_min..=brightness_max).contains(&self.brightness())
    }

    /// Another fish, if it is seen.
    pub fn fish(&self, id: FishId) -> Option<Percept<'a>> {
        let figure = &self.scene.figures[id.index()];
        let seen = id != self.me.id && figure.alive && vision::sees_fish(self, figure);
        seen.then(|| Percept::new(self.me, figure))
    }

    /// The fishes that may be seen, if nothing is in the way, ascending.
    pub fn figures(&self) -> impl Iterator<Item = &'a Figure> + use<'a> {
        self.scene.figures_of(self.others)
    }

    /// The fishes that are seen among those for whom something holds, ascending.
    pub fn seen(&self, which: impl Fn(&Figure) -> bool) -> impl Iterator<Item = &'a Figure> {
        self.figures().filter(move |figure| which(figure) && vision::sees_fish(self, figure))
    }

    /// What is made of them.
    pub fn fishes(&self, which: impl Fn(&Figure) -> bool) -> impl Iterator<Item = Percept<'a>> {
        self.seen(which).map(|figure| Percept::new(self.me, figure))
    }

    /// Where a particle is, if it is seen.
    pub fn particle(&self, id: ParticleId) -> Option<DVec3> {
        let particle = &self.scene.particles[id.index()];
        (particle.present && vision::sees_point(self, particle.position, None)).then_some(particle.position)
    }

    /// Where a target is, if it is seen: b of a fish.
    pub fn target(&self, target: Target) -> Option<DVec3> {
        match target {
            Target::Fish(id) => self.fish(id).map(|percept| percept.figure.center),
            Target::Particle(id) => self.particle(id),
        }
    }
}

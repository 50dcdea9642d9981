//! A pond to look around in.

use super::scene::Shadow;
use super::*;
use crate::fish::habits::{Habits, Nature, Sex};
use crate::fish::world::{Climate, FishId, Grid, Obstacle, Particle, Tank, tank};
use crate::fish::{Body, Swimmer};
use glam::DVec3;
use std::sync::Arc;

/// Fishes at rest among obstacles.
pub(in crate::fish) struct Pond {
    pub(in crate::fish) figures: Vec<Figure>,
    pub(in crate::fish) habits: Vec<Habits>,
    pub(in crate::fish) obstacles: Vec<Obstacle>,
    pub(in crate::fish) particles: Vec<Particle>,
    pub(in crate::fish) climate: Climate,
    pub(in crate::fish) time: f64,
}

impl Pond {
    pub(in crate::fish) fn empty() -> Pond {
        Pond {
            figures: Vec::new(),
            habits: Vec::new(),
            obstacles: Vec::new(),
            particles: Vec::new(),
            climate: Climate::default(),
            time: 0.0,
        }
    }

    /// One prey that looks along y from the origin.
    pub(in crate::fish) fn with_eye_at_origin() -> Pond {
        let mut pond = Pond::empty();
        pond.add(DVec3::new(0.0, -6.0, 0.0), 0.0);
        pond
    }

    /// Another prey.
    pub(in crate::fish) fn add(&mut self, place: DVec3, heading: f64) {
        self.add_of(Habits::published(Nature::Prey, Sex::Male), place, heading);
    }

    pub(in crate::fish) fn add_of(&mut self, habits: Habits, place: DVec3, heading: f64) {
        let swimmer = Swimmer::new(Arc::new(Body::published(habits.size)), place, heading);
        let id = FishId(self.figures.len() as u32);
        self.figures.push(Figure::new(id, &habits, &swimmer.motion.positions, DVec3::ZERO));
        self.habits.push(habits);
    }

    pub(in crate::fish) fn senses<T>(&self, fish: usize, ask: impl FnOnce(&Senses<'_>) -> T) -> T {
        let mut grid = Grid::default();
        let living = self.figures.iter().filter(|figure| figure.alive);
        grid.sort(living.map(|figure| (figure.id, figure.center)));
        let shadows: Vec<Shadow> = self.figures.iter().map(Shadow::of).collect();
        let scene = Scene {
            shadows: &shadows,
            time: self.time,
            tank: Tank::new(tank::PUBLISHED),
            obstacles: &self.obstacles,
            climate: &self.climate,
            figures: &self.figures,
            particles: &self.particles,
            grid: &grid,
            speed_max: self.figures.iter().fold(0.0, |most, figure| figure.velocity.length().max(most)),
            size_max: self.figures.iter().fold(0.0, |most, figure| figure.size.max(most)),
        };
        ask(&Horizon::default().scan(&scene, &self.figures[fish], &self.habits[fish]))
    }
}

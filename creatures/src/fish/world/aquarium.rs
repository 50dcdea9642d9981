//! The world at work: everything that is in it moves on by one step from the same state. It ends nothing
//! and judges nothing.

use super::{Environment, FishId, Grid, Inhabitant, Particle, ParticleId, suction};
use crate::fish::Command;
use crate::fish::Water;
use crate::fish::behaviour::Stage;
use crate::fish::habits::Nature;
use crate::fish::mechanics::{Fault, TIME_STEP};
use crate::fish::mind::{Cause, Intention, Mind};
use crate::fish::perception::scene::Shadow;
use crate::fish::perception::{Figure, Horizon, Room, Scene};
use glam::DVec3;

/// The mouth sucks when it is all open.
const OPEN: f64 = 1.0;

/// What happened in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Event {
    /// A fish means to do something else than before, by the rule that said so.
    Change {
        /// Who.
        fish: FishId,
        /// What it meant to do.
        from: Intention,
        /// What it means to do now.
        to: Intention,
        /// The rule.
        cause: Cause,
    },
    /// A fish swallowed a particle.
    Meal(FishId, ParticleId),
    /// A predator swallowed a prey, which is dead.
    Kill(FishId, FishId),
    /// A male and a female mated.
    Mating(FishId, FishId),
}

/// A fish that has left the model.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{fish}: {fault}")]
pub struct Lost {
    /// Which fish.
    pub fish: FishId,
    /// What is wrong with it.
    pub fault: Fault,
}

/// A tank with everything in it.
#[derive(Debug)]
pub struct Aquarium {
    /// What does not act.
    pub environment: Environment,
    /// In order of id.
    pub fishes: Vec<Inhabitant>,
    /// In order of id.
    pub particles: Vec<Particle>,
    /// How the fishes look now.
    pub figures: Vec<Figure>,
    /// What happened in the last step: changes of intention first, then meals, then matings.
    pub events: Vec<Event>,
    /// Steps done.
    pub steps: u32,
    grid: Grid,
    shadows: Vec<Shadow>,
    commands: Vec<Command>,
    /// Whose mouths were open when the step began, ascending.
    mouths: Vec<FishId>,
    /// (nodes of one fish).
    forces: Vec<DVec3>,
    horizon: Horizon,
    room: Room,
    claims: Vec<Claim>,
}

/// A mouth at something to swallow.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Claim {
    distance: f64,
    eater: FishId,
    event: Event,
}

impl Aquarium {
    /// At time 0.
    pub fn new(environment: Environment, mut fishes: Vec<Inhabitant>, particles: Vec<Particle>) -> Aquarium {
        let ids = (0..).map(FishId);
        let figures: Vec<Figure> = fishes.iter().zip(ids).map(|(fish, id)| fish.figure(id)).collect();
        // Room for all that a step may list, so that none allocates.
        let (count, specks) = (fishes.len(), particles.len());
        let pacifist = |fish: &Inhabitant| fish.habits.nature == Nature::Pacifist;
        let partners = fishes.iter().filter(|fish| pacifist(fish)).count();
        for fish in fishes.iter_mut().filter(|fish| pacifist(fish)) {
            fish.routines.courtship.make_room(partners);
        }
        Aquarium {
            grid: Grid::with_room(environment.tank.half, count),
            environment,
            particles,
            events: Vec::with_capacity(3 * count),
            steps: 0,
            shadows: Vec::with_capacity(count),
            commands: vec![Command::default(); count],
            forces: vec![DVec3::ZERO; crate::fish::body::NODES],
            mouths: Vec::with_capacity(count),
            horizon: Horizon::with_room(count),
            room: Room::with_room(count, specks),
            claims: Vec::with_capacity(count + specks),
            figures,
            fishes,
        }
    }

    /// t.
    pub fn time(&self) -> f64 {
        f64::from(self.steps) * TIME_STEP
    }

    /// One step: all fishes decide on the state as it is, then all move, then particles, then events.
    ///
    /// # Errors
    /// The first fish that has left the model; the world is then of no use.
    pub fn step(&mut self) -> Result<(), Lost> {
        self.events.clear();
        self.decide();
        self.swim()?;
        self.drift();
        self.steps += 1;
        for (index, fish) in self.fishes.iter().enumerate() {
            if self.figures[index].alive {
                self.figures[index] = fish.figure(FishId(index as u32));
            }
        }
        self.feed();
        self.mate();
        Ok(())
    }

    /// Steps 1 to 6: percepts, mental states, intentions, routines.
    fn decide(&mut self) {
        let living = self.figures.iter().filter(|figure| figure.alive);
        self.grid.sort(living.clone().map(|figure| (figure.id, figure.center)));
        let largest = |of: fn(&Figure) -> f64| living.clone().map(of).fold(0.0, f64::max);
        self.shadows.clear();
        self.shadows.extend(self.figures.iter().map(Shadow::of));
        let scene = Scene {
            shadows: &self.shadows,
            time: self.time(),
            tank: self.environment.tank,
            obstacles: &self.environment.obstacles,
            climate: &self.environment.climate,
            figures: &self.figures,
            particles: &self.particles,
            grid: &self.grid,
            speed_max: largest(|figure| figure.velocity.length()),
            size_max: largest(|figure| figure.size),
        };
        for ((fish, figure), command) in self.fishes.iter_mut().zip(&self.figures).zip(&mut self.commands) {
            if figure.alive {
                let from = fish.mind.intention;
                *command = fish.live(&scene, figure, &mut self.horizon, &mut self.room);
                let Mind { intention: to, cause, .. } = fish.mind;
                if to != from {
                    self.events.push(Event::Change { fish: figure.id, from, to, cause });
                }
            }
        }
    }

    /// Steps 7 to 9: controllers, external forces, bodies.
    fn swim(&mut self) -> Result<(), Lost> {
        let open = |(fish, figure): (&Inhabitant, &Figure)| {
            (figure.alive && fish.swimmer.motor.mouth >= OPEN).then_some(figure.id)
        };
        self.mouths.clear();
        self.mouths.extend(self.fishes.iter().zip(&self.figures).filter_map(open));
        let time = self.time();
        for (index, fish) in self.fishes.iter_mut().enumerate() {
            let figure = &self.figures[index];
            if !figure.alive {
                continue;
            }
            self.forces.fill(DVec3::ZERO);
            let positions = &fish.swimmer.motion.positions;
            let reach = figure.length(); // no node is as far from b
            let touched =
                self.environment.push(positions, figure.size, figure.center, reach, &mut self.forces);
            fish.deeds.contact_steps += u32::from(touched);
            if figure.nature == Nature::Prey {
                for mouth in self.mouths.iter().map(|id| &self.figures[id.index()]) {
                    if mouth.nature == Nature::Predator {
                        suction::force(mouth, figure, &fish.swimmer.body, &mut self.forces);
                    }
                }
            }
            let water = self.environment.currents.at(time);
            fish.swimmer
                .step(&self.commands[index], &water, &self.forces)
                .map_err(|fault| Lost { fish: figure.id, fault })?;
        }
        Ok(())
    }

    /// Step 10: particles, in the suction of the mouths that were open.
    fn drift(&mut self) {
        let water = self.environment.currents.at(self.time());
        let mouths = || self.mouths.iter().map(|id| &self.figures[id.index()]);
        for particle in &mut self.particles {
            let at = particle.position;
            let suction: DVec3 = mouths().map(|mouth| suction::velocity(mouth, at)).sum();
            particle.drift(water.velocity(at), suction, &self.environment.tank, |at| {
                self.environment.obstacles.iter().all(|solid| solid.contact(at).distance > CLEARANCE)
            });
        }
    }

    /// Step 11, meals: claims by distance, then by id; each thing is swallowed once (AF-13).
    fn feed(&mut self) {
        self.claims.clear();
        for (figure, fish) in self.figures.iter().zip(&self.fishes) {
            if !figure.alive || fish.swimmer.motor.mouth < OPEN {
                continue;
            }
            let eater = figure.id;
            if figure.nature == Nature::Predator {
                for prey in self.figures.iter().filter(|one| one.alive && one.nature == Nature::Prey) {
                    if let Some(distance) = suction::swallows_prey(figure, prey) {
                        self.claims.push(Claim { distance, eater, event: Event::Kill(eater, prey.id) });
                    }
                }
            } else {
                for particle in self.particles.iter().filter(|particle| particle.present) {
                    if let Some(distance) = suction::swallows_particle(figure, particle.position) {
                        self.claims.push(Claim { distance, eater, event: Event::Meal(eater, particle.id) });
                    }
                }
            }
        }
        // Of two things at one distance from one mouth, the lower id.
        let order = |claim: &Claim| (claim.eater, claim.event);
        self.claims.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(order(a).cmp(&order(b))));
        let time = self.time();
        for claim in &self.claims {
            match claim.event {
                Event::Meal(_, id) if self.particles[id.index()].present => {
                    self.particles[id.index()].vanish();
                }
                Event::Kill(_, id) if self.figures[id.index()].alive => {
                    self.figures[id.index()].alive = false;
                    self.fishes[id.index()].deeds.died = Some(time);
                }
                _ => continue, // it is gone already
            }
            let eater = &mut self.fishes[claim.eater.index()];
            eater.deeds.meals += 1;
            eater.mind.drives.eat();
            self.events.push(claim.event);
        }
    }

    /// Step 11, matings: a male who is done, and the female who is done with him.
    fn mate(&mut self) {
        for index in 0..self.fishes.len() {
            let figure = &self.figures[index];
            if figure.stage != Stage::Done || !figure.alive {
                continue;
            }
            let (male, Some(female)) = (figure.id, figure.partner) else { continue };
            let other = &self.figures[female.index()];
            let mutual = other.alive && other.partner == Some(male);
            let pair: &[FishId] = if mutual { &[male, female] } else { &[male] };
            for id in pair {
                let fish = &mut self.fishes[id.index()];
                fish.routines.courtship.reset();
                if mutual {
                    fish.deeds.matings += 1;
                    fish.mind.drives.mate();
                }
                self.figures[id.index()] = fish.figure(*id);
            }
            if mutual {
                self.events.push(Event::Mating(male, female));
            }
        }
    }
}

/// Food appears at least this far from obstacles, where fishes dare to go.
pub const CLEARANCE: f64 = 15.0;

#[cfg(test)]
mod tests;

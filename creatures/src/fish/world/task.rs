//! The worlds as tasks: who is in the tank, whose habits are under test, and what is legal. How a trial
//! goes is in `trial.rs`.

use super::trial::Trial;
use super::{
    Climate, Current, Currents, Environment, FishId, Inhabitant, Obstacle, Particle, ParticleId, Stuff, Tank,
    tank,
};
use crate::fish::habits::variation::{Focus, Settings};
use crate::fish::habits::{Genotype, Habits, Nature, Sex};
use crate::fish::mechanics::TIME_STEP;
use crate::fish::task::life::Watch;
use crate::fish::{Body, ControllerSet};
use crate::random::{Stream, stream};
use crate::{Cull, DecodeError, Observer, Outcome, Proof, SpecError, Task, read_spec};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Fishes of one world at most.
const FISHES_MAX: u64 = 1000;
/// Steps of all trials at most.
const STEPS_MAX: f64 = 1e6;
/// Fishes start at least so many body lengths apart.
const APART: f64 = 2.0;
/// The share of the tank that balls of that distance may take; beyond, no start can be drawn.
const CROWDED: f64 = 0.25;
/// Draws of a start before the best so far is taken.
const TRIES: u32 = 200;

/// The `[task]` table of a world experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldTask {
    /// Whose habits are under test; the others have the published ones.
    pub scenario: Focus,
    /// Time of a trial.
    pub duration: f64,
    /// Trials, from different starts; fitness is their mean.
    pub trials: u32,
    /// Fishes of each kind; ids go through them in this order.
    pub predators: u32,
    /// Prey, of one species.
    pub prey: u32,
    /// Pacifists that court females.
    pub males: u32,
    /// Pacifists that court males.
    pub females: u32,
    /// What drifts and sinks.
    pub food: Stuff,
    /// What drifts and swims a little.
    pub plankton: Stuff,
    /// Extents of the tank.
    pub tank: [f64; 3],
    /// What stands in it.
    pub obstacles: Vec<Obstacle>,
    /// How its water moves.
    pub currents: Currents,
    /// Its light and warmth.
    pub climate: Climate,
    /// Starts that are given rather than drawn.
    pub starts: Vec<Start>,
    /// What every fish swims by, as it was learned; none for the hand-made controllers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controllers: Option<ControllerSet>,
    /// What counts how much.
    pub weights: Weights,
}

/// Where a fish starts, in every trial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Its number.
    pub fish: u32,
    /// Of its rest shape's origin.
    pub position: [f64; 3],
    /// To the left of y.
    #[serde(default)]
    pub heading_degrees: f64,
}

/// What counts how much in the fitness of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Weights {
    /// Of the share of time that a prey is alive.
    pub alive: f64,
    /// Of a prey's meal, of which ten count.
    pub meal: f64,
    /// Of a step in contact with something that stands still.
    pub contact: f64,
    /// Of a prey eaten.
    pub kill: f64,
    /// Of how cheap the cheapest prey came.
    pub chase: f64,
    /// Of a mating.
    pub mating: f64,
    /// Of the farthest stage of courtship.
    pub stage: f64,
    /// Of a pacifist's meal, of which ten count.
    pub bite: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Weights {
            alive: 1.0,
            meal: 0.05,
            contact: 0.001,
            kill: 1.0,
            chase: 0.1,
            mating: 1.0,
            stage: 0.1,
            bite: 0.02,
        }
    }
}

impl WorldTask {
    /// The published world of a scenario.
    pub fn published(scenario: Focus) -> WorldTask {
        let courting = scenario == Focus::Pacifist;
        WorldTask {
            scenario,
            duration: if courting { 1500.0 } else { 300.0 },
            trials: 2,
            predators: u32::from(!courting),
            prey: if courting { 0 } else { 5 },
            males: 2,
            females: 2,
            food: Stuff { respawn: courting.then_some(50.0), ..Stuff::default() },
            plankton: Stuff { count: 0, plankton: true, ..Stuff::default() },
            tank: tank::PUBLISHED,
            obstacles: if courting { Vec::new() } else { published_obstacles() },
            currents: Currents::default(),
            climate: Climate::default(),
            starts: Vec::new(),
            controllers: None,
            weights: Weights::default(),
        }
    }

    /// Whose habits a `[task]` table tests, if it is of a world.
    pub fn scenario_of(table: &Value) -> Option<Focus> {
        Focus::deserialize(table.get("scenario")?).ok()
    }

    /// Whether a `[task]` table is of a world.
    pub fn is(table: &Value) -> bool {
        WorldTask::scenario_of(table).is_some()
    }

    /// Reads a `[task]` table, of which the scenario gives the defaults.
    ///
    /// # Errors
    /// An unknown key, a wrong type, or a number out of range (AF-10, AF-18).
    pub fn read(table: Value) -> Result<WorldTask, SpecError> {
        let scenario = read_spec(table.get("scenario").cloned().unwrap_or_default())
            .map_err(|error| SpecError::new("scenario", error.problem))?;
        let published = WorldTask::published(scenario);
        let mut filled = serde_json::to_value(published).expect("a plain struct serialises");
        if let (Value::Object(filled), Value::Object(table)) = (&mut filled, table) {
            filled.extend(table);
        }
        let task: WorldTask = read_spec(filled)?;
        task.check()?;
        Ok(task)
    }

    fn check(&self) -> Result<(), SpecError> {
        let refuse = |key: &str, problem: String| Err(SpecError::new(key, problem));
        let fishes: u64 = [self.predators, self.prey, self.males, self.females].map(u64::from).iter().sum();
        if !(1..=FISHES_MAX).contains(&fishes) {
            return refuse("prey", format!("{fishes} fishes in all, where 1 to {FISHES_MAX} are legal"));
        }
        let (key, tested) = match self.scenario {
            Focus::Prey => ("prey", self.prey),
            Focus::Predator => ("predators", self.predators),
            Focus::Pacifist => ("males", self.males + self.females),
        };
        if tested == 0 {
            return refuse(key, "none, though their habits are under test".to_owned());
        }
        if !(1..=100).contains(&self.trials) {
            return refuse("trials", format!("{} is not within 1 to 100", self.trials));
        }
        let most = STEPS_MAX * TIME_STEP / f64::from(self.trials);
        if !(self.duration >= 4.0 * TIME_STEP && self.duration <= most) {
            return refuse("duration", format!("{} is not within 0.22 to {most}", self.duration));
        }
        for (key, stuff) in [("food", self.food), ("plankton", self.plankton)] {
            let legal = stuff.count <= 10_000
                && (0.0..=10.0).contains(&stuff.sink)
                && stuff.respawn.is_none_or(|delay| delay >= 0.0);
            if !legal {
                return refuse(key, "count within 10000, sink within 0 to 10, respawn at least 0".to_owned());
            }
        }
        if !self.tank.iter().all(|extent| (100.0..=20_000.0).contains(extent)) {
            return refuse("tank", "extents are not within 100 to 20000".to_owned());
        }
        let volume: f64 = self.tank.iter().product();
        let distance = APART * 20.0;
        if fishes as f64 * PI / 6.0 * distance * distance * distance > CROWDED * volume {
            return refuse("tank", format!("is too small for {fishes} fishes two body lengths apart"));
        }
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            obstacle.check().map_err(|error| error.below(&format!("obstacles[{index}]")))?;
        }
        self.currents.check().map_err(|error| error.below("currents"))?;
        self.climate.check().map_err(|error| error.below("climate"))?;
        self.check_weights()?;
        if let Some(Err(error)) = self.controllers.as_ref().map(ControllerSet::check) {
            return refuse("controllers", error.to_string());
        }
        self.check_starts(fishes)
    }

    fn check_weights(&self) -> Result<(), SpecError> {
        let Weights { alive, meal, contact, kill, chase, mating, stage, bite } = self.weights;
        let all = [alive, meal, contact, kill, chase, mating, stage, bite];
        let legal = all.iter().all(|weight| (0.0..=1e6).contains(weight));
        if legal { Ok(()) } else { Err(SpecError::new("weights", "are not all within 0 to 1000000")) }
    }

    /// AF-10, AF-18
    fn check_starts(&self, fishes: u64) -> Result<(), SpecError> {
        let environment = self.environment();
        for (index, start) in self.starts.iter().enumerate() {
            let refuse =
                |key: &str, problem: String| Err(SpecError::new(format!("starts[{index}].{key}"), problem));
            let id = FishId(start.fish);
            if u64::from(start.fish) >= fishes {
                return refuse("fish", format!("there is no {id} among {fishes}"));
            }
            if self.starts[..index].iter().any(|other| other.fish == start.fish) {
                return refuse("fish", format!("{id} starts twice"));
            }
            let at = DVec3::from_array(start.position);
            if !(at.is_finite() && environment.tank.holds(at, 0.0)) {
                return refuse("position", format!("{id} starts outside the tank"));
            }
            if !environment.free(at, 0.0) {
                return refuse("position", format!("{id} starts inside an obstacle"));
            }
            if !start.heading_degrees.is_finite() {
                return refuse("heading_degrees", format!("{id} heads nowhere"));
            }
        }
        Ok(())
    }

    /// What does not act.
    pub fn environment(&self) -> Environment {
        Environment {
            tank: Tank::new(self.tank),
            currents: self.currents.clone(),
            climate: self.climate.clone(),
            obstacles: self.obstacles.clone(),
        }
    }

    /// Steps of a trial.
    pub fn steps(&self) -> u32 {
        (self.duration / TIME_STEP).round() as u32
    }

    /// Nature and sex of every fish, in order of id.
    fn kinds(&self) -> impl Iterator<Item = (Nature, Sex)> {
        let of = |count: u32, nature, sex| std::iter::repeat_n((nature, sex), count as usize);
        of(self.predators, Nature::Predator, Sex::Male)
            .chain(of(self.prey, Nature::Prey, Sex::Male))
            .chain(of(self.males, Nature::Pacifist, Sex::Male))
            .chain(of(self.females, Nature::Pacifist, Sex::Female))
    }

    /// The inhabitants at the start of a trial: those under test with the genotype's habits.
    pub(super) fn inhabitants(&self, genotype: &Genotype, seed: u64, trial: u32) -> Vec<Inhabitant> {
        let environment = self.environment();
        let mut bodies: BTreeMap<u64, Arc<Body>> = BTreeMap::new();
        let mut taken: Vec<(DVec3, f64)> = Vec::new();
        let mut fishes = Vec::new();
        for (id, (nature, sex)) in (0..).map(FishId).zip(self.kinds()) {
            let tested = self.scenario.vectors().iter().position(|&kind| kind == (nature, sex));
            let habits = tested
                .map_or_else(|| Habits::published(nature, sex), |vector| genotype.habits[vector].clone());
            let mut draws = stream(seed, [trial, id.0, 0], "fish world start");
            let given = self.starts.iter().find(|start| start.fish == id.0);
            let (place, heading) = match given {
                Some(start) => (DVec3::from_array(start.position), start.heading_degrees.to_radians()),
                None => start(&environment, habits.length(), &taken, &mut draws),
            };
            taken.push((place, habits.length()));
            let size = habits.size;
            let body = bodies.entry(size.to_bits()).or_insert_with(|| Arc::new(Body::published(size)));
            let mut fish = Inhabitant::new(id, habits, Arc::clone(body), place, heading, seed, trial);
            if let Some(set) = &self.controllers {
                fish.swimmer = fish.swimmer.taught(set);
            }
            fishes.push(fish);
        }
        fishes
    }

    /// What there is to eat at the start of a trial.
    pub(super) fn particles(&self, seed: u64, trial: u32) -> Vec<Particle> {
        let environment = self.environment();
        let free = |at| {
            environment.obstacles.iter().all(|solid| solid.contact(at).distance > super::aquarium::CLEARANCE)
        };
        let stuff = [self.food, self.plankton];
        let all = stuff.iter().flat_map(|stuff| std::iter::repeat_n(*stuff, stuff.count as usize));
        let particle =
            |(id, stuff)| Particle::new(ParticleId(id), stuff, &environment.tank, seed, trial, free);
        (0..).zip(all).map(particle).collect()
    }

    /// Reads a genotype that fits the scenario.
    fn genotype(&self, bytes: &[u8]) -> Result<Genotype, DecodeError> {
        let genotype = Genotype::decode(bytes)?;
        let kinds = self.scenario.vectors();
        let found: Vec<(Nature, Sex)> =
            genotype.habits.iter().map(|habits| (habits.nature, habits.sex)).collect();
        if found == kinds {
            return Ok(genotype);
        }
        Err(DecodeError::illegal("habits", format!("are of {found:?} where the scenario tests {kinds:?}")))
    }
}

/// A place in free water, away from those taken, and a heading; of places that are all too near to others the one
/// that is least so.
fn start(environment: &Environment, length: f64, taken: &[(DVec3, f64)], draws: &mut Stream) -> (DVec3, f64) {
    let heading = draws.between(-PI, PI);
    let half = (environment.tank.half - length).max(DVec3::ZERO);
    let mut best = (f64::NEG_INFINITY, DVec3::ZERO);
    for _ in 0..TRIES {
        let draw = DVec3::new(draws.unit(), draws.unit(), draws.unit());
        let place = (draw * 2.0 - 1.0) * half;
        let room = if environment.free(place, length.min(environment.tank.half.z)) { 1.0 } else { 0.0 };
        let nearest = taken.iter().fold(f64::INFINITY, |least: f64, (other, their)| {
            least.min((*other - place).length() / (APART * length.max(*their)))
        });
        let merit = room + nearest.min(1.0);
        if merit > best.0 {
            best = (merit, place);
        }
        if merit >= 2.0 {
            break;
        }
    }
    (best.1, heading)
}

/// Two posts, two balls and a block.
fn published_obstacles() -> Vec<Obstacle> {
    vec![
        Obstacle::Cylinder { center: [-90.0, 60.0, 0.0], radius: 12.0, half_height: 100.0 },
        Obstacle::Cylinder { center: [80.0, -90.0, 0.0], radius: 15.0, half_height: 100.0 },
        Obstacle::Sphere { center: [70.0, 80.0, 30.0], radius: 20.0 },
        Obstacle::Sphere { center: [-70.0, -80.0, -40.0], radius: 25.0 },
        Obstacle::Box { center: [0.0, 0.0, -80.0], half: [30.0, 30.0, 20.0] },
    ]
}

/// A short life in each scenario, in moving water: founders among the published world's fishes.
pub fn proofs() -> Vec<Proof> {
    let proof = |focus: Focus| {
        let settings = Settings { focus, ..Settings::default() };
        let genotype = Genotype::random(&settings, &mut stream(0, [0, 0, 0], "fish world proof"));
        let world = WorldTask::published(focus);
        let currents = Currents(vec![Current::Vortex { center: [40.0, 0.0], core: 30.0, speed: 0.2 }]);
        let task = WorldTask { duration: 8.0, trials: 1, currents, predators: 1, prey: 5, ..world };
        let task = serde_json::to_string(&task).expect("a plain struct serialises");
        Proof { task, genotype: genotype.encode(), seed: 0 }
    };
    [Focus::Prey, Focus::Predator, Focus::Pacifist].map(proof).to_vec()
}

impl Task for WorldTask {
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError> {
        self.genotype(genotype).map(drop)
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        seed: u64,
        cull: Option<&Cull>,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        let genotype = self.genotype(genotype)?;
        let steps = self.steps() * self.trials;
        let mut watch = Watch::new(steps, cull, observer);
        Ok(Trial::all(self, &genotype, seed, &mut watch))
    }
}

//! A trial in the tank: from its start to its end or to where its end is known, what it is worth, and what it can
//! be worth at most.

use super::{Aquarium, Event, Inhabitant, WorldTask, scene};
use crate::Outcome;
use crate::fish::behaviour::Stage;
use crate::fish::habits::variation::Focus;
use crate::fish::habits::{Genotype, Nature};
use crate::fish::task::life::{End, Watch};

/// Meals that count.
const MEALS_MAX: f64 = 10.0;
/// C of a prey that is worth nothing.
const COST_MAX: f64 = 400.0;
/// The farthest stage of courtship.
const RANK_MAX: f64 = 6.0;
/// Nobody eats, kills or mates faster, time by each.
const MEAL_TIME: f64 = 5.0;
const KILL_TIME: f64 = 10.0;
const MATING_TIME: f64 = 200.0;

/// One trial under way.
pub(super) struct Trial<'a> {
    task: &'a WorldTask,
    aquarium: Aquarium,
    counts: Counts,
}

/// What has happened.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Counts {
    meals: u32,
    kills: u32,
    matings: u32,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.meals += other.meals;
        self.kills += other.kills;
        self.matings += other.matings;
    }
}

impl<'a> Trial<'a> {
    fn new(task: &'a WorldTask, genotype: &Genotype, seed: u64, trial: u32) -> Trial<'a> {
        let fishes = task.inhabitants(genotype, seed, trial);
        let particles = task.particles(seed, trial);
        let aquarium = Aquarium::new(task.environment(), fishes, particles);
        Trial { task, aquarium, counts: Counts::default() }
    }

    /// All trials of a task, one after the other.
    pub(super) fn all(task: &WorldTask, genotype: &Genotype, seed: u64, watch: &mut Watch<'_>) -> Outcome {
        let trials = f64::from(task.trials);
        let (mut sum, mut counts, mut end) = (0.0, Counts::default(), Ok(()));
        let (mut contacts, mut changes, mut best, mut note) = (0u32, 0u32, Stage::Search, None);
        let mut hasher = blake3::Hasher::new();
        for index in 0..task.trials {
            let mut trial = Trial::new(task, genotype, seed, index);
            watch.trial(index, || scene::scene(&trial.aquarium));
            watch.frame(0, || scene::frame(&trial.aquarium));
            // What trials to come can be worth at most is what this one could at its start.
            let later = f64::from(task.trials - index - 1) * trial.bound();
            end = trial.run(watch, |here| (sum + here + later) / trials, &mut note);
            sum += trial.fitness();
            counts += trial.counts;
            for fish in &trial.aquarium.fishes {
                contacts += fish.deeds.contact_steps;
                changes += fish.deeds.changes;
                for node in &fish.swimmer.motion.positions {
                    for value in node.to_array() {
                        hasher.update(&value.to_bits().to_le_bytes());
                    }
                }
            }
            best = trial.tested().map(Inhabitant::best_stage).fold(best, Stage::max);
            if end.is_err() {
                break;
            }
        }
        let mut mark = [0; 8];
        mark[..6].copy_from_slice(&hasher.finalize().as_bytes()[..6]);
        let measures = [
            ("meals", f64::from(counts.meals)),
            ("deaths", f64::from(counts.kills)),
            ("matings", f64::from(counts.matings)),
            ("best_stage", f64::from(best.rank())),
            ("contact_steps", f64::from(contacts)),
            ("intention_changes", f64::from(changes)),
            // 48 bits of a hash of where everything was at the end of every trial.
            ("state_hash", u64::from_le_bytes(mark) as f64),
        ];
        let mut outcome = watch.outcome(end, sum / trials, measures);
        if let Some(note) = note {
            outcome.note = format!("{note}: {}", outcome.note);
        }
        outcome
    }

    /// Runs to the end, or to where nothing that counts can happen any more. `worth` is the measure of the whole
    /// evaluation, from what this trial can be worth at most. A fish that leaves the model is named in `note`.
    fn run(
        &mut self,
        watch: &mut Watch<'_>,
        worth: impl Fn(f64) -> f64,
        note: &mut Option<String>,
    ) -> Result<(), End> {
        while self.aquarium.steps < self.task.steps() && !self.settled() {
            if let Err(lost) = self.aquarium.step() {
                *note = Some(lost.fish.to_string());
                return Err(lost.fault.into());
            }
            self.note_events();
            for &event in &self.aquarium.events {
                watch.event(|| scene::event(&self.aquarium, event));
            }
            watch.frame(self.aquarium.steps, || scene::frame(&self.aquarium));
            watch.count(|| worth(self.bound()))?;
        }
        Ok(())
    }

    fn note_events(&mut self) {
        for event in &self.aquarium.events {
            match event {
                Event::Meal(..) => self.counts.meals += 1,
                Event::Kill(..) => self.counts.kills += 1,
                Event::Mating(..) => self.counts.matings += 1,
                Event::Change { .. } => {}
            }
        }
    }

    /// The fishes under test, dead or alive.
    fn tested(&self) -> impl Iterator<Item = &Inhabitant> {
        let nature = match self.task.scenario {
            Focus::Prey => Nature::Prey,
            Focus::Predator => Nature::Predator,
            Focus::Pacifist => Nature::Pacifist,
        };
        self.aquarium.fishes.iter().filter(move |fish| fish.habits.nature == nature)
    }

    /// Whether the fitness is known: prey or predators are under test, and all prey are dead.
    fn settled(&self) -> bool {
        self.task.scenario != Focus::Pacifist && self.task.prey == self.counts.kills
    }

    /// What has happened is worth.
    fn fitness(&self) -> f64 {
        self.worth(0.0)
    }

    /// What the trial can be worth at most, from where it is.
    fn bound(&self) -> f64 {
        self.worth((self.task.duration - self.aquarium.time()).max(0.0))
    }

    /// What has happened is worth, if as much again happens in the time left as can; 0 left adds
    /// nothing.
    fn worth(&self, left: f64) -> f64 {
        let weights = self.task.weights;
        let more = |each: f64| if left > 0.0 { (left / each).floor() + 1.0 } else { 0.0 };
        let count = self.tested().count() as f64;
        let mean = |of: &dyn Fn(&Inhabitant) -> f64| self.tested().map(of).sum::<f64>() / count;
        let meals = |fish: &Inhabitant| {
            let hopes = if fish.deeds.died.is_none() { more(MEAL_TIME) } else { 0.0 };
            (f64::from(fish.deeds.meals) + hopes).min(MEALS_MAX)
        };
        match self.task.scenario {
            Focus::Prey => {
                let alive = |fish: &Inhabitant| {
                    let until = self.aquarium.time() + left;
                    (fish.deeds.died.unwrap_or(until) / self.task.duration).min(1.0)
                };
                weights.alive * mean(&alive) + weights.meal * mean(&meals)
                    - weights.contact * mean(&|fish| f64::from(fish.deeds.contact_steps))
            }
            Focus::Predator => {
                let prey = f64::from(self.task.prey);
                let eaten = (f64::from(self.counts.kills) + count * more(KILL_TIME)).min(prey);
                let least = self.tested().filter_map(|fish| fish.deeds.least_cost).fold(COST_MAX, f64::min);
                let least = if left > 0.0 { 0.0 } else { least };
                weights.kill * eaten + weights.chase * (1.0 - least / COST_MAX)
            }
            Focus::Pacifist => {
                let pairs = f64::from(self.task.males.min(self.task.females));
                // Libido has to outgrow its threshold between two matings.
                let slowest = self
                    .tested()
                    .map(|fish| fish.habits.urge / fish.habits.ardour)
                    .fold(MATING_TIME, f64::max);
                let matings = pairs * more(slowest);
                let reached = self.tested().map(|fish| fish.best_stage().rank()).max().unwrap_or(0);
                let rank = if left > 0.0 { RANK_MAX } else { f64::from(reached) };
                weights.mating * (f64::from(self.counts.matings) + matings)
                    + weights.stage * rank / RANK_MAX
                    + weights.bite * mean(&meals)
            }
        }
    }
}

#[cfg(test)]
mod tests;

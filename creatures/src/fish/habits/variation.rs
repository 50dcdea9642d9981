//! How habits vary: founders, mutation scaled to the width of each bound, crossover by groups. Who
//! breeds with whom is not decided here; nature, species and sex are the scenario's and never vary.

use super::{GENES, Genotype, Group, Habits, Nature, Sex};
use crate::SpecError;
use crate::random::Stream;
use serde::{Deserialize, Serialize};

/// Least distance between the two thresholds of fear.
const FEAR_GAP: f64 = 0.01;

/// Whose habits are under test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(rename_all = "snake_case")]
pub enum Focus {
    /// One vector for all prey.
    #[default]
    Prey,
    /// One vector for all predators.
    Predator,
    /// One vector for the males and one for the females.
    Pacifist,
}

impl Focus {
    /// Nature and sex of each vector of a genotype under test.
    pub fn vectors(self) -> &'static [(Nature, Sex)] {
        match self {
            Focus::Prey => &[(Nature::Prey, Sex::Male)],
            Focus::Predator => &[(Nature::Predator, Sex::Male)],
            Focus::Pacifist => &[(Nature::Pacifist, Sex::Male), (Nature::Pacifist, Sex::Female)],
        }
    }
}

/// The `[search.variation]` table of a world experiment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Whose habits are under test.
    pub focus: Focus,
    /// Probability that a number mutates.
    pub rate: f64,
    /// Standard deviation of a mutation by the width of the number's bounds.
    pub deviation: f64,
    /// Probability that the habit of schooling is turned round.
    pub schooling: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { focus: Focus::Prey, rate: 0.15, deviation: 0.1, schooling: 0.02 }
    }
}

impl Settings {
    /// Checks every rate.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        for (key, value) in
            [("rate", self.rate), ("deviation", self.deviation), ("schooling", self.schooling)]
        {
            if !(0.0..=1.0).contains(&value) {
                return Err(SpecError::new(key, format!("{value} is not within 0 to 1")));
            }
        }
        Ok(())
    }
}

impl Genotype {
    /// A founder: every number uniform within its bounds, comfort excepted, which starts as published so that
    /// not every founder lives in flight from its own waters.
    pub fn random(settings: &Settings, stream: &mut Stream) -> Genotype {
        let founder = |&(nature, sex): &(Nature, Sex)| {
            let mut habits = Habits::published(nature, sex);
            for gene in GENES.iter().filter(|gene| gene.group != Group::Comfort) {
                (gene.write)(&mut habits, stream.between(gene.bounds[0], gene.bounds[1]));
            }
            habits.schooling = stream.chance(0.5);
            habits.settle();
            habits
        };
        Genotype { habits: settings.focus.vectors().iter().map(founder).collect() }
    }

    /// Mutates numbers, each with the settings' probability, reflected into their bounds; the names of those
    /// that did, in order.
    pub fn mutate(&mut self, settings: &Settings, stream: &mut Stream) -> Vec<&'static str> {
        let mut mutated = Vec::new();
        for habits in &mut self.habits {
            for gene in &GENES {
                if stream.chance(settings.rate) {
                    let [least, most] = gene.bounds;
                    let step = stream.normal() * settings.deviation * (most - least);
                    (gene.write)(habits, reflect((gene.read)(habits) + step, least, most));
                    mutated.push(gene.name);
                }
            }
            if stream.chance(settings.schooling) {
                habits.schooling = !habits.schooling;
                mutated.push("schooling");
            }
            habits.settle();
        }
        mutated
    }

    /// A child with each group of habits from one parent or the other, by a fair coin.
    pub fn crossover(first: &Genotype, second: &Genotype, stream: &mut Stream) -> Genotype {
        let mut child = first.clone();
        for (to, from) in child.habits.iter_mut().zip(&second.habits) {
            for group in Group::ALL {
                if stream.chance(0.5) {
                    to.take(group, from);
                }
            }
        }
        child
    }

    /// A child of the first parent with one group of habits of the second.
    pub fn graft(first: &Genotype, second: &Genotype, stream: &mut Stream) -> Genotype {
        let mut child = first.clone();
        let vector = stream.below(child.habits.len());
        let group = Group::ALL[stream.below(Group::ALL.len())];
        if let Some(from) = second.habits.get(vector) {
            child.habits[vector].take(group, from);
        }
        child
    }
}

impl Habits {
    /// Takes the habits of a group from another; schooling goes with what is feared.
    fn take(&mut self, group: Group, from: &Habits) {
        for gene in GENES.iter().filter(|gene| gene.group == group) {
            (gene.write)(self, (gene.read)(from));
        }
        if group == Group::Fear {
            self.schooling = from.schooling;
        }
    }

    /// Puts pairs in order after numbers were varied one by one.
    fn settle(&mut self) {
        if self.brightness_min > self.brightness_max {
            std::mem::swap(&mut self.brightness_min, &mut self.brightness_max);
        }
        if self.temperature_min > self.temperature_max {
            std::mem::swap(&mut self.temperature_min, &mut self.temperature_max);
        }
        if self.panic < self.fear_min + FEAR_GAP {
            self.panic = self.fear_min + FEAR_GAP;
        }
    }
}

/// Turns a value back at the bounds; one that is farther off than they are wide stops at the bound.
fn reflect(value: f64, least: f64, most: f64) -> f64 {
    let turned = if value < least {
        2.0 * least - value
    } else if value > most {
        2.0 * most - value
    } else {
        value
    };
    turned.clamp(least, most)
}

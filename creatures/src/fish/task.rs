//! The fishes' tasks: what a genotype is put to, and what is legal there. How each goes is in its own
//! file.

mod buoys;
mod drill;
pub(in crate::fish) mod life;
mod race;

pub use buoys::Buoys;
pub use drill::{Drill, Lesson};
pub use race::Race;

use super::body::Design;
use super::{Body, Genotype, Swimmer};
use crate::{Cull, DecodeError, Observer, Outcome, SpecError, Task, read_spec};
use glam::DVec3;
use life::Watch;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::sync::Arc;

/// Steps that a trial may have at most.
const STEPS_MAX: u32 = 1_000_000;

/// The `[task]` table of a fish experiment, by its `scenario`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "scenario", rename_all = "snake_case")]
pub enum FishTask {
    /// Practise one lesson: samples or a controller, judged by A-35's objective.
    Drill(Drill),
    /// Swim straight and far: samples, repeated, or a controller.
    Race(Race),
    /// Find one buoy after the other with a controller set.
    Buoys(Buoys),
    /// A whole curriculum: samples are drilled, controllers raced, sets sent to the buoys.
    Learning(Learning),
}

/// The `[task]` table of scenario `learning`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Learning {
    /// The fish.
    pub body: BodyPlan,
    /// What is practised; samples name theirs by number, from 0.
    pub lessons: Vec<Lesson>,
    /// How controllers are measured.
    pub race: race::Course,
    /// How sets are tried.
    pub buoys: buoys::Course,
}

impl Default for Learning {
    /// A straight swim and a turn.
    fn default() -> Self {
        Learning {
            body: BodyPlan::default(),
            lessons: vec![Lesson::default(), Lesson::turn(30.0)],
            race: race::Course::default(),
            buoys: buoys::Course::default(),
        }
    }
}

/// The fish that a task is for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BodyPlan {
    /// S, within 0.1 to 10.
    pub size: f64,
    /// Linearisations of a step, 1 to 4.
    pub newton: u32,
    /// A body other than the published one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub design: Option<Design>,
}

impl Default for BodyPlan {
    fn default() -> Self {
        BodyPlan { size: 1.0, newton: 1, design: None }
    }
}

impl BodyPlan {
    /// The fish at rest at the origin, heading along y.
    ///
    /// # Errors
    /// The key that is out of range, or the first fault of the design (AF-1).
    fn fish(&self) -> Result<Swimmer, SpecError> {
        if !(0.1..=10.0).contains(&self.size) {
            return Err(SpecError::new("body.size", format!("{} is not within 0.1 to 10", self.size)));
        }
        if !(1..=4).contains(&self.newton) {
            return Err(SpecError::new("body.newton", format!("{} is not within 1 to 4", self.newton)));
        }
        let body = match &self.design {
            None => Body::published(self.size),
            Some(design) => Body::new(design, self.size)
                .map_err(|fault| SpecError::new("body.design", fault.to_string()))?,
        };
        Ok(Swimmer::linearised(Arc::new(body), DVec3::ZERO, 0.0, self.newton))
    }
}

impl FishTask {
    /// Reads a `[task]` table.
    ///
    /// # Errors
    /// No scenario or an unknown one, an unknown key, a wrong type, a number out of range.
    pub fn read(mut table: Value) -> Result<FishTask, SpecError> {
        const SCENARIOS: &str = "one of `drill`, `race`, `buoys`, `learning`, `prey`, `predator`, `pacifist`";
        let scenario = table.as_object_mut().and_then(|table| table.remove("scenario"));
        let task = match scenario.as_ref().map(|name| name.as_str().unwrap_or_default()) {
            None => return Err(SpecError::new("scenario", format!("is missing: {SCENARIOS}"))),
            Some("drill") => FishTask::Drill(read_spec(table)?),
            Some("race") => FishTask::Race(read_spec(table)?),
            Some("buoys") => FishTask::Buoys(read_spec(table)?),
            Some("learning") => FishTask::Learning(read_spec(table)?),
            Some(other) => {
                return Err(SpecError::new("scenario", format!("`{other}` is none, expected {SCENARIOS}")));
            }
        };
        Ok(task)
    }

    /// Makes it ready to evaluate.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn prepare(self) -> Result<Ready, SpecError> {
        let (body, lessons) = match &self {
            FishTask::Drill(drill) => (&drill.body, vec![("lesson".to_owned(), &drill.lesson)]),
            FishTask::Race(race) => (&race.body, vec![]),
            FishTask::Buoys(buoys) => (&buoys.body, vec![]),
            FishTask::Learning(learning) => {
                if learning.lessons.is_empty() {
                    return Err(SpecError::new("lessons", "has none"));
                }
                let paths = (0..).map(|index| format!("lessons[{index}]"));
                (&learning.body, paths.zip(&learning.lessons).collect())
            }
        };
        let fish = body.fish()?;
        let started = lessons.into_iter().map(|(path, lesson)| {
            lesson.check().and_then(|()| lesson.start(&fish)).map_err(|error| error.below(&path))
        });
        let starts = started.collect::<Result<_, _>>()?;
        match &self {
            FishTask::Drill(_) => {}
            FishTask::Race(race) => race.course.check().map_err(|error| error.below("course"))?,
            FishTask::Buoys(buoys) => buoys.course.check().map_err(|error| error.below("course"))?,
            FishTask::Learning(learning) => {
                learning.race.check().map_err(|error| error.below("race"))?;
                learning.buoys.check().map_err(|error| error.below("buoys"))?;
            }
        }
        Ok(Ready { task: self, fish, starts })
    }

    /// The lesson of a number, of tasks that have it.
    fn lesson(&self, index: usize) -> Option<&Lesson> {
        match self {
            FishTask::Drill(drill) => Some(&drill.lesson).filter(|_| index == 0),
            FishTask::Learning(learning) => learning.lessons.get(index),
            FishTask::Race(_) | FishTask::Buoys(_) => None,
        }
    }

    fn scenario(&self) -> &'static str {
        match self {
            FishTask::Drill(_) => "drill",
            FishTask::Race(_) => "race",
            FishTask::Buoys(_) => "buoys",
            FishTask::Learning(_) => "learning",
        }
    }
}

/// A task with the fish that it starts with.
#[derive(Debug)]
pub struct Ready {
    task: FishTask,
    /// At rest.
    fish: Swimmer,
    /// The fish at the start of each lesson.
    starts: Vec<Swimmer>,
}

/// What a genotype is put to in a task.
enum Trial<'a> {
    Drill(&'a Lesson, &'a Swimmer),
    Race(&'a race::Course),
    Buoys(&'a buoys::Course),
}

impl Ready {
    /// Which trial it is for a genotype.
    fn trial(&self, genotype: &Genotype) -> Result<Trial<'_>, DecodeError> {
        let drill = |index: usize| Some(Trial::Drill(self.task.lesson(index)?, self.starts.get(index)?));
        match (&self.task, genotype) {
            (FishTask::Drill(_) | FishTask::Learning(_), Genotype::MuscleSamples(samples)) => {
                let trial = drill(samples.lesson as usize).ok_or_else(|| {
                    let problem = format!("{} is none of {} lessons", samples.lesson, self.starts.len());
                    DecodeError::illegal("samples.lesson", problem)
                })?;
                match trial {
                    Trial::Drill(lesson, _) if samples.steps != lesson.steps => {
                        let problem = format!("{} where the lesson has {}", samples.steps, lesson.steps);
                        Err(DecodeError::illegal("samples.steps", problem))
                    }
                    trial => Ok(trial),
                }
            }
            (FishTask::Drill(drill), Genotype::Controller(_)) => {
                Ok(Trial::Drill(&drill.lesson, &self.starts[0]))
            }
            (FishTask::Race(race), Genotype::MuscleSamples(_) | Genotype::Controller(_)) => {
                Ok(Trial::Race(&race.course))
            }
            (FishTask::Learning(learning), Genotype::Controller(_)) => Ok(Trial::Race(&learning.race)),
            (FishTask::Buoys(buoys), Genotype::ControllerSet(_)) => Ok(Trial::Buoys(&buoys.course)),
            (FishTask::Learning(learning), Genotype::ControllerSet(_)) => Ok(Trial::Buoys(&learning.buoys)),
            (task, genotype) => {
                let problem = format!("`{}` has no place in `{}`", genotype.kind(), task.scenario());
                Err(DecodeError::illegal("genotype", problem))
            }
        }
    }
}

impl Task for Ready {
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError> {
        self.trial(&Genotype::decode(genotype)?).map(drop)
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        seed: u64,
        cull: Option<&Cull>,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        let genotype = Genotype::decode(genotype)?;
        let outcome = match (self.trial(&genotype)?, &genotype) {
            (Trial::Drill(lesson, start), genotype) => {
                drill::live(lesson, start, genotype, &mut Watch::new(lesson.steps, cull, observer))
            }
            (Trial::Race(course), genotype) => {
                race::live(course, &self.fish, genotype, &mut Watch::new(course.steps, cull, observer))
            }
            (Trial::Buoys(course), Genotype::ControllerSet(set)) => buoys::live(
                course,
                &self.fish,
                set,
                seed,
                &mut Watch::new(course.all_steps(), cull, observer),
            ),
            (Trial::Buoys(_), _) => unreachable!("only sets are sent to the buoys"),
        };
        Ok(outcome)
    }
}

#[cfg(test)]
mod tests;

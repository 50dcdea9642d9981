//! The drill: practise muscle functions for a while and be judged by the objective (A-35..A-37, A-93).

use super::life::{End, Watch};
use super::{BodyPlan, STEPS_MAX};
use crate::fish::mechanics::TIME_STEP;
use crate::fish::objective::{Trace, distance_to_path};
use crate::fish::practice::Practice;
use crate::fish::samples::{HORIZONS, MuscleFunctions, STEPS};
use crate::fish::scene;
use crate::fish::{Command, Criterion, Genotype, Interpolation, Objective, Still, Swimmer};
use crate::math::wrap_angle;
use crate::{Outcome, SpecError};
use serde::{Deserialize, Serialize};

/// The `[task]` table of scenario `drill`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Drill {
    /// The fish.
    pub body: BodyPlan,
    /// What it practises.
    pub lesson: Lesson,
}

/// What is practised.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Lesson {
    /// Steps of hand-made swimming at σ = 1 before it begins.
    pub approach: u32,
    /// Steps of practice.
    pub steps: u32,
    /// How functions go between their samples.
    pub interpolation: Interpolation,
    /// What it is for.
    pub objective: Objective,
}

impl Default for Lesson {
    /// The straight swim of A-37.
    fn default() -> Self {
        Lesson {
            approach: 0,
            steps: STEPS,
            interpolation: Interpolation::default(),
            objective: Objective::default(),
        }
    }
}

impl Lesson {
    /// The turn of A-37, by an angle in degrees, left positive.
    pub fn turn(degrees: f64) -> Lesson {
        let objective = Objective { criterion: Criterion::HeadingDegrees(degrees), ..Objective::default() };
        Lesson { approach: 420, objective, ..Lesson::default() }
    }

    /// # Errors
    /// The key that is out of range and what is allowed (AF-17).
    pub(super) fn check(&self) -> Result<(), SpecError> {
        if !HORIZONS.contains(&self.steps) {
            let problem = format!("{} is not within {} to {}", self.steps, HORIZONS.start(), HORIZONS.end());
            return Err(SpecError::new("steps", problem));
        }
        if self.approach > STEPS_MAX {
            return Err(SpecError::new("approach", format!("{} is above {STEPS_MAX}", self.approach)));
        }
        self.objective.check().map_err(|error| error.below("objective"))
    }

    /// The fish as practice finds it.
    ///
    /// # Errors
    /// A body that cannot swim so far.
    pub(super) fn start(&self, fish: &Swimmer) -> Result<Swimmer, SpecError> {
        let mut fish = fish.clone();
        let command = Command { swim: 1.0, ..Command::default() };
        for step in 0..self.approach {
            fish.step(&command, &Still, &[]).map_err(|fault| {
                SpecError::new("approach", format!("the fish fails at step {step}: {fault}"))
            })?;
        }
        Ok(fish)
    }
}

/// Practises samples or a controller.
pub(super) fn live(lesson: &Lesson, start: &Swimmer, genotype: &Genotype, watch: &mut Watch<'_>) -> Outcome {
    let (mut practice, roughness) = match genotype {
        Genotype::MuscleSamples(samples) => (
            Practice::Samples(MuscleFunctions::new(samples, lesson.interpolation)),
            lesson.objective.roughness(samples),
        ),
        Genotype::Controller(controller) => (
            Practice::of_controller(controller),
            lesson.objective.roughness(&controller.sampled(lesson.steps)),
        ),
        Genotype::ControllerSet(_) => unreachable!("sets are not drilled"),
    };
    let mut drilled = Drilled { lesson, start, fish: start.clone(), strayed: 0.0, steps: 0 };
    let end = drilled.practise(&mut practice, watch);
    let trace = drilled.trace();
    let criterion = lesson.objective.criterion_value(&trace);
    let speed = (trace.end - trace.start).length() / trace.time / trace.length;
    watch.outcome(
        end,
        lesson.objective.value(roughness, criterion),
        [
            ("progress", lesson.objective.progress(&trace)),
            ("criterion", criterion),
            ("roughness", roughness),
            ("heading_change_degrees", trace.heading_change.to_degrees()),
            ("speed", speed),
        ],
    )
}

/// A drill under way.
struct Drilled<'a> {
    lesson: &'a Lesson,
    start: &'a Swimmer,
    fish: Swimmer,
    /// Sum of distances to the path.
    strayed: f64,
    steps: u32,
}

impl Drilled<'_> {
    fn practise(&mut self, practice: &mut Practice<'_>, watch: &mut Watch<'_>) -> Result<(), End> {
        watch.trial(0, || scene::alone(&self.fish));
        watch.frame(0, || scene::frame(&self.fish));
        for step in 1..=self.lesson.steps {
            self.fish.practise(&practice.step(step), &Still)?;
            self.steps = step;
            watch.frame(step, || scene::frame(&self.fish));
            if let Criterion::Path(path) = &self.lesson.objective.criterion {
                self.strayed += distance_to_path(self.fish.center_of_mass(), path);
            }
            watch.count(|| self.lesson.objective.progress(&self.trace()))?;
        }
        Ok(())
    }

    /// What was seen so far.
    fn trace(&self) -> Trace {
        let steps = f64::from(self.steps.max(1));
        let turned = self.fish.posture().heading() - self.start.posture().heading();
        Trace {
            start: self.start.center_of_mass(),
            end: self.fish.center_of_mass(),
            time: steps * TIME_STEP,
            heading_change: wrap_angle(turned),
            stray: self.strayed / steps,
            length: self.fish.body.length(),
        }
    }
}

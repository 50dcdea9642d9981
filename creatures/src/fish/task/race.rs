//! The race: swim from rest for a while, and get on along the heading at the start. It measures
//! speed and turning as well, by which controllers are put into maps.

use super::life::{End, Watch};
use super::{BodyPlan, STEPS_MAX};
use crate::fish::mechanics::TIME_STEP;
use crate::fish::practice::Practice;
use crate::fish::samples::MuscleFunctions;
use crate::fish::scene;
use crate::fish::{Genotype, Interpolation, Still, Swimmer};
use crate::math::wrap_angle;
use crate::{Outcome, SpecError};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The `[task]` table of scenario `race`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Race {
    /// The fish.
    pub body: BodyPlan,
    /// Where it swims.
    pub course: Course,
}

/// The course of a race.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Course {
    /// Steps from rest; speed and turning are measured over the second half.
    pub steps: u32,
    /// How functions go between their samples.
    pub interpolation: Interpolation,
}

impl Default for Course {
    /// 60 time units.
    fn default() -> Self {
        Course { steps: 1091, interpolation: Interpolation::default() }
    }
}

impl Course {
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        if (2..=STEPS_MAX).contains(&self.steps) {
            return Ok(());
        }
        Err(SpecError::new("steps", format!("{} is not within 2 to {STEPS_MAX}", self.steps)))
    }
}

/// Swims samples or a controller.
pub(super) fn live(course: &Course, fish: &Swimmer, genotype: &Genotype, watch: &mut Watch<'_>) -> Outcome {
    let mut practice = match genotype {
        Genotype::MuscleSamples(samples) => {
            Practice::Samples(MuscleFunctions::new(samples, course.interpolation))
        }
        Genotype::Controller(controller) => Practice::of_controller(controller),
        Genotype::ControllerSet(_) => unreachable!("sets do not race"),
    };
    let mut racer = Racer {
        forward: fish.posture().forward,
        start: fish.center_of_mass(),
        fish: fish.clone(),
        steps: 0,
        turned: 0.0,
        half: None,
    };
    let end = racer.swim(course, &mut practice, watch);
    let distance = racer.distance();
    // Who was stopped on the way has no speed; as no number it is left out.
    let (speed, turn_rate) = racer.second_half(course).unwrap_or((f64::NAN, f64::NAN));
    watch.outcome(
        end,
        distance,
        [
            ("progress", distance),
            ("speed", speed),
            ("turn_rate", turn_rate),
            ("turned_degrees", racer.turned.to_degrees()),
        ],
    )
}

/// A race under way.
struct Racer {
    fish: Swimmer,
    start: DVec3,
    forward: DVec3,
    /// Done.
    steps: u32,
    /// Accumulated change of heading, rad, left positive.
    turned: f64,
    /// c and the accumulated change of heading half way.
    half: Option<(DVec3, f64)>,
}

impl Racer {
    fn swim(
        &mut self,
        course: &Course,
        practice: &mut Practice<'_>,
        watch: &mut Watch<'_>,
    ) -> Result<(), End> {
        watch.trial(0, || scene::alone(&self.fish));
        watch.frame(0, || scene::frame(&self.fish));
        for step in 1..=course.steps {
            let before = self.fish.posture().heading();
            self.fish.practise(&practice.step(step), &Still)?;
            self.turned += wrap_angle(self.fish.posture().heading() - before);
            self.steps = step;
            watch.frame(step, || scene::frame(&self.fish));
            if step == course.steps / 2 {
                self.half = Some((self.fish.center_of_mass(), self.turned));
            }
            watch.count(|| self.distance())?;
        }
        Ok(())
    }

    /// Along the heading at the start, body lengths.
    fn distance(&self) -> f64 {
        (self.fish.center_of_mass() - self.start).dot(self.forward) / self.fish.body.length()
    }

    /// Speed, L by time, and turn rate, rad by time, over the second half; none before the end.
    ///
    /// Speed is that of the way as the crow flies along the arc: a turning fish's chord is stretched to its arc.
    fn second_half(&self, course: &Course) -> Option<(f64, f64)> {
        let (place, turned) = self.half.filter(|_| self.steps == course.steps)?;
        let time = f64::from(course.steps - course.steps / 2) * TIME_STEP;
        let (chord, angle) = ((self.fish.center_of_mass() - place).length(), self.turned - turned);
        let half_angle = 0.5 * angle;
        let stretch = match crate::math::sin(half_angle) {
            sine if half_angle.abs() < std::f64::consts::FRAC_PI_2 && sine != 0.0 => half_angle / sine,
            _ => 1.0,
        };
        Some((chord * stretch / time / self.fish.body.length(), angle / time))
    }
}

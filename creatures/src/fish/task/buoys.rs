//! The buoys: chase one target after the other with a learned controller set.

use super::life::{End, Watch};
use super::{BodyPlan, STEPS_MAX};
use crate::fish::scene;
use crate::fish::{Chase, ControllerSet, Still, Swimmer};
use crate::math::{cos, sin};
use crate::random::stream;
use crate::record::{Frame, Part, Pose, Scene, Shape};
use crate::{Outcome, SpecError};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The `[task]` table of scenario `buoys`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Buoys {
    /// The fish.
    pub body: BodyPlan,
    /// Where its buoys are.
    pub course: Course,
}

/// Where buoys are, and for how long they are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Course {
    /// Trials, each with buoys of its own; the fitness is their mean.
    pub trials: u32,
    /// Steps of a trial.
    pub steps: u32,
    /// The nearest that a buoy is to the one before, body lengths.
    pub distance_min: f64,
    /// The farthest.
    pub distance_max: f64,
    /// The steepest elevation of a buoy from the one before, degrees.
    pub elevation_degrees: f64,
    /// How near the mouth has to come, body lengths.
    pub reach: f64,
}

impl Default for Course {
    /// Three trials of 400 time units.
    fn default() -> Self {
        Course {
            trials: 3,
            steps: 7273,
            distance_min: 2.0,
            distance_max: 6.0,
            elevation_degrees: 29.0,
            reach: 0.15,
        }
    }
}

impl Course {
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        let refuse = |key: &str, problem: String| Err(SpecError::new(key, problem));
        if !(1..=100).contains(&self.trials) {
            return refuse("trials", format!("{} is not within 1 to 100", self.trials));
        }
        if !(1..=STEPS_MAX).contains(&self.steps) {
            return refuse("steps", format!("{} is not within 1 to {STEPS_MAX}", self.steps));
        }
        let (least, most) = (self.distance_min, self.distance_max);
        if !(least > 0.0 && least <= most && most <= 1e3) {
            return refuse("distance_max", format!("{least} to {most} are no distances within 0 to 1000"));
        }
        if !(0.0..=89.0).contains(&self.elevation_degrees) {
            return refuse("elevation_degrees", format!("{} is not within 0 to 89", self.elevation_degrees));
        }
        if !(self.reach > 0.0 && self.reach <= 1.0) {
            return refuse("reach", format!("{} is not within 0 to 1, 0 left out", self.reach));
        }
        Ok(())
    }

    /// Steps of all trials.
    pub(super) fn all_steps(&self) -> u32 {
        self.trials * self.steps
    }

    /// A buoy of a trial, `length` L from the one before by the course's distances.
    fn buoy(&self, seed: u64, trial: u32, number: u32, from: DVec3, length: f64) -> DVec3 {
        let mut draws = stream(seed, [trial, number, 0], "buoy");
        let distance = length * draws.between(self.distance_min, self.distance_max);
        let heading = draws.between(-PI, PI);
        let elevation = (self.elevation_degrees * draws.between(-1.0, 1.0)).to_radians();
        let level = distance * cos(elevation);
        from + DVec3::new(-level * sin(heading), level * cos(heading), distance * sin(elevation))
    }
}

/// Swims all trials.
pub(super) fn live(
    course: &Course,
    fish: &Swimmer,
    set: &ControllerSet,
    seed: u64,
    watch: &mut Watch<'_>,
) -> Outcome {
    let fish = fish.clone().taught(set);
    let (mut sum, mut reached, mut time) = (0.0, 0, 0.0);
    let mut end = Ok(());
    for trial in 0..course.trials {
        let mut hunt = Hunt::new(course, fish.clone(), seed, trial);
        end = hunt.swim(watch, |standing| (sum + standing) / f64::from(course.trials));
        sum += hunt.standing();
        reached += hunt.reached;
        time += hunt.last_reached_at;
        if end.is_err() {
            break;
        }
    }
    let fitness = sum / f64::from(course.trials);
    watch.outcome(
        end,
        fitness,
        [
            ("progress", fitness),
            ("reached", f64::from(reached)),
            // What no buoy was reached in has no pace; as no number it is left out.
            ("time_per_buoy", time / f64::from(reached)),
        ],
    )
}

/// One trial under way.
struct Hunt<'a> {
    course: &'a Course,
    fish: Swimmer,
    chase: Chase,
    seed: u64,
    trial: u32,
    buoy: DVec3,
    /// How far the buoy was when the last one was reached.
    leg: f64,
    reached: u32,
    /// Since the trial began.
    last_reached_at: f64,
}

impl<'a> Hunt<'a> {
    fn new(course: &'a Course, fish: Swimmer, seed: u64, trial: u32) -> Hunt<'a> {
        let mouth = fish.posture().mouth();
        let buoy = course.buoy(seed, trial, 0, mouth, fish.body.length());
        let leg = (buoy - mouth).length();
        let chase = Chase::default();
        Hunt { course, fish, chase, seed, trial, buoy, leg, reached: 0, last_reached_at: 0.0 }
    }

    fn swim(&mut self, watch: &mut Watch<'_>, measure: impl Fn(f64) -> f64) -> Result<(), End> {
        let length = self.fish.body.length();
        watch.trial(self.trial, || self.scene());
        watch.frame(0, || self.frame());
        for step in 1..=self.course.steps {
            let posture = self.fish.posture();
            let command = self.chase.toward(self.buoy, 1.0, &posture, self.fish.body.size);
            self.fish.step(&command, &Still, &[])?;
            let mouth = self.fish.posture().mouth();
            if (mouth - self.buoy).length() < self.course.reach * length {
                self.reached += 1;
                self.last_reached_at = f64::from(step) * crate::fish::mechanics::TIME_STEP;
                self.buoy = self.course.buoy(self.seed, self.trial, self.reached, self.buoy, length);
                self.leg = (self.buoy - mouth).length();
                self.chase = Chase::default();
            }
            watch.frame(step, || self.frame());
            watch.count(|| measure(self.standing()))?;
        }
        Ok(())
    }

    /// The fish and the buoy that it is after, as large as the mouth's reach.
    fn scene(&self) -> Scene {
        let mut scene = scene::alone(&self.fish);
        let radius = self.course.reach * self.fish.body.length();
        let shapes = vec![Shape::Sphere { radius }];
        scene.parts.push(Part { name: "buoy".to_owned(), creature: None, shapes });
        scene
    }

    fn frame(&self) -> Frame {
        let mut frame = scene::frame(&self.fish);
        frame.poses.push(Pose::at(self.buoy));
        frame
    }

    /// Buoys reached + 1 − distance left / leg.
    fn standing(&self) -> f64 {
        let left = (self.fish.posture().mouth() - self.buoy).length();
        f64::from(self.reached) + 1.0 - left / self.leg
    }
}

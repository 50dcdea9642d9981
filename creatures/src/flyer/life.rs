//! A flyer's life: one evaluation from its start pose to landing, the last step, or what ends it before
//! (F-23, F-39, F-48..F-59). It draws nothing.

use super::fitness::Flight;
use super::phenotype::{Phenotype, Survey};
use super::scene;
use super::skeleton::{Bone, grow, intersects_itself, span};
use super::task::{FlyerTask, Measure};
use super::{Brain, Genotype};
use crate::physics::articulated::StepFault;
use crate::{Cull, Interim, Observer, Outcome, Reason, Status, Verdict};
use glam::DVec3;

/// How far a hinge has to swing to either side of its mean to count as beating, rad: far below any stroke,
/// far above rounding.
const STROKE_MIN: f64 = 1e-6;

/// Body and brain at work, and what is measured on the way.
#[derive(Debug)]
pub(super) struct Life<'a> {
    task: &'a FlyerTask,
    /// In the start pose.
    bones: Vec<Bone>,
    phenotype: Phenotype,
    brain: Brain,
    intersects: bool,
    start: DVec3,
    /// Steps simulated.
    steps: u32,
    flight: Flight,
    landed: bool,
    speed_max: f64,
    quarter: Option<Quarter>,
    interim: Option<Interim>,
    span: f64,
    /// Angle of the first left hinge at the start of every step, rad.
    flaps: Vec<f64>,
}

/// A creature's standing after a quarter of the steps (F-68).
#[derive(Debug, Clone, Copy)]
struct Quarter {
    distance: f64,
    fitness: f64,
}

/// How a life ended.
#[derive(Debug)]
pub(super) enum End {
    /// The last step is done, or the ground is reached.
    Completed,
    Culled,
    Aborted(Reason, String),
}

impl<'a> Life<'a> {
    pub(super) fn new(task: &'a FlyerTask, genotype: &Genotype) -> Life<'a> {
        let bones = grow(genotype, task.start_height);
        let phenotype = Phenotype::develop(&bones, task);
        Life {
            task,
            start: phenotype.world().center_of_mass(),
            phenotype,
            brain: Brain::new(genotype),
            intersects: intersects_itself(&bones),
            steps: 0,
            flight: Flight::default(),
            landed: false,
            speed_max: 0.0,
            quarter: None,
            interim: None,
            span: span(&bones),
            flaps: Vec::with_capacity(task.steps as usize),
            bones,
        }
    }

    /// Steps in the order of F-49: move; then blow-up, fitness, landing, culling.
    pub(super) fn live(&mut self, cull: Option<&Cull>, observer: &mut dyn Observer) -> End {
        observer.trial(0, &|| scene::scene(&self.bones, self.task.dt));
        self.show(observer);
        if self.intersects {
            return End::Aborted(Reason::SelfIntersecting, "films cross in the start pose".to_owned());
        }
        let steps = self.task.steps;
        let cull = cull.map(|cull| (cull, ((cull.at * f64::from(steps)) as u32).max(1)));
        while self.steps < steps {
            if let Err(fault) = self.step() {
                let reason = match fault {
                    StepFault::NonFinite { .. } => Reason::NonFinite,
                    StepFault::Singular { .. } | StepFault::Duration => Reason::BlowUp,
                };
                return End::Aborted(reason, format!("{fault} at step {}", self.steps + 1));
            }
            self.steps += 1;
            self.show(observer);
            let Survey { velocity, speed, landed } = self.phenotype.survey();
            if speed >= self.task.blow_up_speed {
                let note = format!("speed {speed:.1} m/s at step {}", self.steps);
                return End::Aborted(Reason::BlowUp, note);
            }
            self.speed_max = if speed > self.speed_max { speed } else { self.speed_max };
            self.flight.add(velocity);
            if landed {
                self.landed = true;
                return End::Completed;
            }
            if self.steps == steps / 4 {
                self.quarter = Some(Quarter { distance: self.distance(), fitness: self.fitness() });
            }
            if let Some((cull, _)) = cull.filter(|&(_, step)| step == self.steps) {
                let interim = Interim { step: self.steps, measure: self.measure() };
                self.interim = Some(interim);
                observer.interim(interim);
                if cull.verdict(interim.measure) == Verdict::Cull {
                    return End::Culled;
                }
            }
        }
        End::Completed
    }

    /// Lets the observer see where everything is.
    fn show(&self, observer: &mut dyn Observer) {
        observer.frame(f64::from(self.steps) * self.task.dt, &|| scene::frame(&self.phenotype));
    }

    /// Sense, decide, drive, move (F-30, F-49).
    fn step(&mut self) -> Result<(), StepFault> {
        let FlyerTask { dt, brain_substeps, .. } = *self.task;
        self.phenotype.sense(self.brain.sensors_mut());
        self.flaps.push(self.phenotype.flap());
        let now = f64::from(self.steps) * dt;
        for substep in 0..brain_substeps {
            self.brain.step(now + f64::from(substep) * dt / f64::from(brain_substeps));
        }
        self.phenotype.drive(self.brain.effectors());
        self.phenotype.step()
    }

    /// Horizontal way from the start to where the centre of mass is, as the crow flies, m (F-52).
    fn distance(&self) -> f64 {
        let moved = self.phenotype.world().center_of_mass() - self.start;
        DVec3::new(moved.x, 0.0, moved.z).length()
    }

    fn fitness(&self) -> f64 {
        self.flight.fitness(self.task.w_hover, self.task.w_speed)
    }

    /// What a culling rule compares (F-54).
    fn measure(&self) -> f64 {
        match self.task.interim {
            Measure::Distance => self.distance(),
            Measure::Fitness => self.fitness(),
        }
    }

    pub(super) fn outcome(&self, end: End) -> Outcome {
        let (status, note) = match end {
            End::Completed => (Status::Completed, String::new()),
            End::Culled => (Status::Culled, String::new()),
            End::Aborted(reason, note) => (Status::Aborted(reason), note),
        };
        let seconds = f64::from(self.steps) * self.task.dt;
        let quarter = self.quarter;
        let measures = [
            ("distance", Some(self.distance())),
            ("hover_steps", Some(f64::from(self.flight.steps))),
            ("speed_sum", Some(self.flight.speed_sum)),
            ("landed", Some(f64::from(u8::from(self.landed)))),
            ("quarter_distance", quarter.map(|quarter| quarter.distance)),
            ("quarter_fitness", quarter.map(|quarter| quarter.fitness)),
            ("max_speed", Some(self.speed_max)),
            ("mass", Some(self.phenotype.mass())),
            ("span", Some(self.span)),
            ("flap_frequency", Some(beat(&self.flaps, seconds))),
        ];
        // What went wrong may have left infinities behind, which no table can hold; the note says it.
        let known = measures.into_iter().filter_map(|(name, value)| Some((name, value?)));
        Outcome {
            fitness: if status == Status::Completed { self.fitness() } else { 0.0 },
            status,
            steps: self.steps,
            measures: known
                .filter(|(_, value)| value.is_finite())
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
            interim: self.interim,
            note,
        }
    }
}

/// Beats a second of a hinge whose angles are given, rad, over so many seconds: half its crossings of their
/// mean (F-70). 0 for a hinge that stays where it is.
fn beat(angles: &[f64], seconds: f64) -> f64 {
    if angles.is_empty() {
        return 0.0;
    }
    let mean = angles.iter().sum::<f64>() / angles.len() as f64;
    let (mut crossings, mut side) = (0u32, 0.0);
    for swing in angles.iter().map(|angle| angle - mean).filter(|swing| swing.abs() > STROKE_MIN) {
        crossings += u32::from(swing * side < 0.0);
        side = swing;
    }
    f64::from(crossings) / (2.0 * seconds)
}

#[cfg(test)]
mod tests;

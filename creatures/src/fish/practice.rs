//! Muscles driven without a mind: what a genotype's functions say step by step. It does not
//! judge them.

use super::body::MUSCLES;
use super::controller::{self, Controller, Phases};
use super::motor::Actuation;
use super::samples::{COUNT, Encoding, MuscleFunctions, Samples};

/// Functions being practised.
#[derive(Debug, Clone)]
pub enum Practice<'a> {
    /// Samples, again from the beginning after the last.
    Samples(MuscleFunctions<'a>),
    /// A controller and where it is in its oscillations.
    Controller(&'a Controller, Phases),
}

impl<'a> Practice<'a> {
    /// Of a controller at its beginning.
    pub fn of_controller(controller: &'a Controller) -> Practice<'a> {
        Practice::Controller(controller, Phases::default())
    }

    /// What the muscles are to do at the end of a step; steps are asked for in order, from 1.
    pub fn step(&mut self, step: u32) -> Actuation {
        match self {
            Practice::Samples(functions) => functions.at(step),
            Practice::Controller(controller, phases) => {
                controller::advance(phases, &controller.frequency);
                controller.actuation(phases)
            }
        }
    }
}

impl Controller {
    /// As many samples as published over so many steps, for a roughness to compare with that of samples.
    pub fn sampled(&self, steps: u32) -> Samples {
        let time = f64::from(steps) * super::mechanics::TIME_STEP;
        let at = |i: u32| {
            let time = time * f64::from(i) / f64::from(COUNT - 1);
            let mut phases = Phases::default();
            for (phase, w) in phases.iter_mut().zip(&self.frequency) {
                *phase = w * time;
            }
            self.actuation(&phases)
        };
        let moments: Vec<Actuation> = (0..COUNT).map(at).collect();
        let values = (0..MUSCLES).flat_map(|muscle| moments.iter().map(move |moment| moment[muscle]));
        Samples { lesson: 0, encoding: Encoding::Full, count: COUNT, steps, values: values.collect() }
    }
}

//! Controller sets: what a fish has learned, as maps from how fast and how sharply to the controller for it
//! . They are put together elsewhere.

use super::controller::Controller;
use super::turn::STRENGTH;
use crate::DecodeError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// The genotype that the buoy task drives: learned swims and turns with what they were measured to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerSet {
    /// Straight swims, the slowest first: the forward-speed map.
    pub swims: Vec<Calibrated>,
    /// Left turns, the gentlest first: the steering map. The right ones are their mirror images.
    pub turns: Vec<Calibrated>,
}

/// A controller and what it was measured to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibrated {
    /// Its name in the set.
    pub name: String,
    /// The controller.
    pub controller: Controller,
    /// Of a swim its speed, L by time; of a turn its rate, rad by time, left positive.
    pub measured: f64,
}

impl ControllerSet {
    /// Sorts what was measured into maps whose beats agree with the fastest swim's. What does not get on, or not
    /// farther than the one before, is left out; no set without a swim and a turn.
    pub fn assembled(swims: Vec<Calibrated>, turns: Vec<Calibrated>) -> Option<ControllerSet> {
        let (swims, turns) = (ascending(swims), ascending(turns));
        let fastest = swims.last()?.controller.clone();
        let align = |map: Vec<Calibrated>| -> Vec<Calibrated> {
            let aligned = |entry: Calibrated| {
                let controller = entry.controller.aligned(&fastest);
                Calibrated { controller, ..entry }
            };
            map.into_iter().map(aligned).collect()
        };
        (!turns.is_empty()).then(|| ControllerSet { swims: align(swims), turns: align(turns) })
    }

    ///
    ///
    /// # Errors
    /// The field that is wrong.
    pub fn check(&self) -> Result<(), DecodeError> {
        let mut names = BTreeSet::new();
        let mut oscillations = None;
        for (map, entries) in [("swims", &self.swims), ("turns", &self.turns)] {
            if entries.is_empty() {
                return Err(DecodeError::illegal(format!("controller_set.{map}"), "has no controller"));
            }
            let mut before = 0.0;
            for (index, entry) in entries.iter().enumerate() {
                let path = format!("controller_set.{map}[{index}]");
                let refuse = |field: &str, problem: String| {
                    Err(DecodeError::illegal(format!("{path}.{field}"), problem))
                };
                entry.controller.check(&format!("{path}.controller"))?;
                let m = entry.controller.oscillations();
                if *oscillations.get_or_insert(m) != m {
                    return refuse("controller.frequency", format!("{m} oscillations beside others"));
                }
                if !names.insert(&entry.name) {
                    return refuse("name", format!("`{}` is there twice", entry.name));
                }
                if !(entry.measured > before && entry.measured.is_finite()) {
                    return refuse("measured", format!("{} is not above {before}", entry.measured));
                }
                before = entry.measured;
            }
        }
        Ok(())
    }
}

fn ascending(mut entries: Vec<Calibrated>) -> Vec<Calibrated> {
    entries.sort_by(|a, b| a.measured.total_cmp(&b.measured)); // stable: of equals the first stays
    let mut before = 0.0;
    entries.retain(|entry| {
        let farther = entry.measured > before && entry.measured.is_finite();
        before = if farther { entry.measured } else { before };
        farther
    });
    entries
}

/// The maps of a set, laid out to be looked up step by step without allocating.
#[derive(Debug, Clone)]
pub struct Maps {
    swims: Map,
    left: Map,
    /// The left turns' mirror images half a beat later, so that the beat goes on where straight swims pass into a
    /// turn on either side.
    right: Map,
    straight: Controller,
    turning: Controller,
}

/// Controllers by what they were measured to do, the least first.
type Map = Vec<(f64, Controller)>;

impl Maps {
    /// Of a legal set.
    pub fn new(set: &ControllerSet) -> Maps {
        let map = |entries: &[Calibrated], of: fn(&Controller) -> Controller| -> Map {
            entries.iter().map(|entry| (entry.measured, of(&entry.controller))).collect()
        };
        let slowest = &set.swims[0].controller;
        let mut swims = vec![(0.0, slowest.amplified(0.0))];
        swims.extend(map(&set.swims, Controller::clone));
        Maps {
            swims,
            left: map(&set.turns, Controller::clone),
            right: map(&set.turns, |turn| turn.mirrored().later(PI)),
            straight: slowest.clone(),
            turning: slowest.clone(),
        }
    }

    /// The controller for σ in [0, 1], the share of the fastest swim's speed, and a bias e: at 0 straight, at
    /// ±0.75 and beyond the sharpest turn. Below the slowest swim its amplitudes shrink.
    pub fn controller(&mut self, swim: f64, bias: f64) -> &Controller {
        let fastest = self.swims.last().map_or(0.0, |&(speed, _)| speed);
        look_up(&mut self.straight, &self.swims[0].1, &self.swims, swim * fastest);
        if bias == 0.0 {
            return &self.straight;
        }
        let turns = if bias > 0.0 { &self.left } else { &self.right };
        let sharpest = turns.last().map_or(0.0, |&(rate, _)| rate);
        let share = (bias.abs() / STRENGTH).min(1.0);
        look_up(&mut self.turning, &self.straight, turns, share * sharpest);
        &self.turning
    }
}

/// What a map has at a measure: between its neighbours, with `least` at 0 and the last beyond the end.
fn look_up(found: &mut Controller, least: &Controller, map: &Map, at: f64) {
    let (mut low, mut low_measured) = (least, 0.0);
    for (measured, controller) in map {
        if at <= *measured && *measured > low_measured {
            return found.blend(low, controller, (at - low_measured) / (measured - low_measured));
        }
        (low, low_measured) = (controller, *measured);
    }
    found.blend(low, low, 0.0);
}

#[cfg(test)]
pub(crate) mod tests;

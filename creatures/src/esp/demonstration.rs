//! A skill shown under a light that moves along a path (E-83, R-11): how far away the creature was, and how far it
//! looked past it. It scores nothing.

use super::Genotype;
use super::brain::{Circuit, Forced, TICK};
use super::creature::Creature;
use super::fault::Fault;
use super::fitness::Start;
use super::fitness::setup::{LIGHT_HEIGHT, LIGHT_STRENGTH, SECONDS_MAX, steps};
use super::task::EspTask;
use super::trial::{Light, Lights, Living, Origin, Show, sense};
use crate::math::{atan2, wrap_angle};
use crate::{DecodeError, Observer, SpecError, read_spec};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The farthest that a light may go from the start, m, ahead or aside.
const FAR: f64 = 1000.0;
/// The highest light, m.
const HIGH: f64 = 100.0;
/// The strongest light.
const STRONG: f64 = 100.0;

/// Where a light goes. The frame is that of the trial's start: ahead of the creature and to its left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightScript {
    /// m above the ground.
    #[serde(default = "height")]
    height: f64,
    /// S of E-29.
    #[serde(default = "strength")]
    strength: f64,
    /// In order of time, the first at 0; straight lines between them.
    point: Vec<WayPoint>,
}

/// Where a light is at a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WayPoint {
    /// s since the start.
    at: f64,
    /// m from the start, ahead.
    ahead: f64,
    /// m from the start, to the left.
    left: f64,
}

fn height() -> f64 {
    LIGHT_HEIGHT
}

fn strength() -> f64 {
    LIGHT_STRENGTH
}

/// What was seen at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sighting {
    /// s since the start.
    pub seconds: f64,
    /// Of the centre of mass, m from the start: ahead and to the left.
    pub creature: [f64; 2],
    /// Of the light, likewise.
    pub light: [f64; 2],
    /// Between the two, m, horizontally.
    pub distance: f64,
    /// From the forward axis to the light, degrees, left positive, within ±180.
    pub heading_error_degrees: f64,
}

/// What a demonstration came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Demonstration {
    /// The skill that was on.
    pub skill: String,
    /// At the start and after every step.
    pub sightings: Vec<Sighting>,
    /// What ended it before the light's path did.
    pub fault: Option<Fault>,
}

/// Why there is nothing to show.
#[derive(Debug, thiserror::Error)]
pub enum DemonstrationError {
    /// The creature cannot do that.
    #[error("{0}")]
    Skill(String),
    /// The genotype is none.
    #[error(transparent)]
    Genotype(#[from] DecodeError),
}

impl LightScript {
    /// Reads the table of a script's file.
    ///
    /// # Errors
    /// The key that is wrong, and what is allowed.
    pub fn read(table: serde_json::Value) -> Result<LightScript, SpecError> {
        let script: LightScript = read_spec(table)?;
        script.check().map(|()| script)
    }

    /// Whether it is a path: times that rise from 0, and places and strengths within bounds.
    fn check(&self) -> Result<(), SpecError> {
        let within = |key: String, value: f64, least: f64, most: f64| {
            let legal = (least..=most).contains(&value);
            let problem = format!("{value} is not within [{least}, {most}]");
            if legal { Ok(()) } else { Err(SpecError::new(key, problem)) }
        };
        within("height".to_owned(), self.height, 0.0, HIGH)?;
        within("strength".to_owned(), self.strength, 0.0, STRONG)?;
        if self.point.len() < 2 {
            let problem = "a path takes two points or more: where the light starts and where it ends";
            return Err(SpecError::new("point", problem));
        }
        let mut before = None;
        for (place, point) in self.point.iter().enumerate() {
            within(format!("point[{place}].at"), point.at, 0.0, SECONDS_MAX)?;
            within(format!("point[{place}].ahead"), point.ahead, -FAR, FAR)?;
            within(format!("point[{place}].left"), point.left, -FAR, FAR)?;
            let problem = match before {
                None if point.at > 0.0 => Some("the first point is at 0 s".to_owned()),
                Some(before) if point.at < before + TICK => {
                    Some(format!("{} s is not later than the point before, at {before} s", point.at))
                }
                _ => None,
            };
            if let Some(problem) = problem {
                return Err(SpecError::new(format!("point[{place}].at"), problem));
            }
            before = Some(point.at);
        }
        Ok(())
    }

    /// Where the light is after so many seconds, start frame, m; at the end of its path it stands still.
    pub fn position(&self, seconds: f64) -> DVec3 {
        let place = |point: &WayPoint| DVec3::new(point.ahead, point.left, self.height);
        let next = self.point.partition_point(|point| point.at <= seconds);
        match (next.checked_sub(1).and_then(|last| self.point.get(last)), self.point.get(next)) {
            (Some(last), Some(next)) => {
                let share = (seconds - last.at) / (next.at - last.at);
                place(last) + share * (place(next) - place(last))
            }
            (Some(only), None) | (None, Some(only)) => place(only),
            (None, None) => DVec3::ZERO.with_z(self.height),
        }
    }

    /// How long it takes, s.
    pub fn seconds(&self) -> f64 {
        self.point.last().map_or(0.0, |last| last.at)
    }
}

impl EspTask {
    /// Lets a creature live with a light of a script, one skill being on: the one named, or else the one that it
    /// is tested in last.
    ///
    /// # Errors
    /// No genotype, or no such skill.
    pub fn demonstrate(
        &self,
        genotype: &[u8],
        skill: Option<&str>,
        script: &LightScript,
        observer: &mut dyn Observer,
    ) -> Result<Demonstration, DemonstrationError> {
        let (Genotype { brain, .. }, phenotype) = self.read(genotype)?;
        let skill = match skill {
            Some(name) => self.find(name).map_err(DemonstrationError::Skill)?,
            None => self.last_tested(),
        };
        let name = self.name(skill).to_owned();
        if brain.control(skill).is_none() {
            let problem = format!("it has not learned `{name}`");
            return Err(DemonstrationError::Skill(problem));
        }
        let forced = [Forced { skill, sigma: 1.0 }];
        let mut circuit = Circuit::new(&brain, &phenotype.instances(), self.syllabus(), &forced);
        let mut show = Show { observer, number: 0 };
        let (sightings, fault) = match Creature::spawn(&phenotype, self.physics(), Start::Rest) {
            Ok(mut creature) => follow(&mut creature, &mut circuit, script, &mut show),
            Err(fault) => (Vec::new(), Some(fault)),
        };
        Ok(Demonstration { skill: name, sightings, fault })
    }
}

/// Lives as long as the light moves, or until a fault.
fn follow<L: Living>(
    creature: &mut L,
    circuit: &mut Circuit,
    script: &LightScript,
    show: &mut Show,
) -> (Vec<Sighting>, Option<L::Fault>) {
    let origin = Origin::of(&creature.state());
    let light = |seconds: f64| Light {
        position: origin.to_world(script.position(seconds)),
        strength: script.strength,
    };
    let mut sightings = vec![sighting(creature, &origin, light(0.0), 0.0)];
    show.begin(creature, &[light(0.0)]);
    for step in 0..steps(script.seconds()) {
        sense(creature, &[light(step as f64 * TICK)], circuit);
        if let Err(fault) = creature.step(circuit.tick()) {
            return (sightings, Some(fault));
        }
        let seconds = (step + 1) as f64 * TICK;
        sightings.push(sighting(creature, &origin, light(seconds), seconds));
        show.go_on(creature, seconds, &|| Lights::one(light(seconds)));
    }
    (sightings, None)
}

fn sighting<L: Living>(creature: &L, origin: &Origin, light: Light, seconds: f64) -> Sighting {
    let state = creature.state();
    let flat = |position: DVec3| [position.x, position.y];
    let way = (light.position - state.centre).with_z(0.0);
    Sighting {
        seconds,
        creature: flat(origin.to_start(state.centre)),
        light: flat(origin.to_start(light.position)),
        distance: way.length(),
        heading_error_degrees: wrap_angle(atan2(way.y, way.x) - state.heading).to_degrees(),
    }
}

#[cfg(test)]
mod tests;

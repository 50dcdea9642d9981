//! The syllabus as a file has it: names, not yet looked up. It says what may be written, and checks nothing.

use super::{SkillId, Syllabus};
use crate::esp::pandemonium::Winner;
use serde::{Deserialize, Serialize};

/// Skills and groups, as written.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SyllabusTable {
    /// In the order of learning.
    #[serde(default)]
    pub skill: Vec<SkillTable>,
    /// The groups.
    #[serde(default)]
    pub pandemonium: Vec<GroupTable>,
}

impl Syllabus {
    /// The syllabus as a file has it, with every default filled in.
    pub fn table(&self) -> SyllabusTable {
        let names = |ids: &[SkillId]| ids.iter().map(|id| self.skills[id.index()].name.clone()).collect();
        let skill = self.skills.iter().map(|skill| SkillTable {
            id: skill.name.clone(),
            uses: names(&skill.uses),
            grow: skill.grow.clone(),
            sensors: skill.sensors.clone(),
            drive_body: skill.drive_body,
            body: if skill.evolve_body { BodyRule::Evolve } else { BodyRule::Locked },
            fitness: serde_json::to_value(&skill.fitness).expect("parameters are plain structs"),
        });
        let group = |group: &super::Group| GroupTable {
            members: names(&group.members),
            winner: group.winner,
            floor: group.floor,
        };
        SyllabusTable { skill: skill.collect(), pandemonium: self.groups.iter().map(group).collect() }
    }
}

/// One skill, as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkillTable {
    /// Its name, unlike every other's.
    pub id: String,
    /// Names of the skills whose sigmas it drives.
    #[serde(default)]
    pub uses: Vec<String>,
    /// What may be added to the body for it.
    #[serde(default)]
    pub grow: Vec<Growth>,
    /// Senses besides muscles and photoreceptors.
    #[serde(default)]
    pub sensors: Vec<Sensor>,
    /// Whether it drives muscles although it uses other skills.
    #[serde(default)]
    pub drive_body: bool,
    /// Whether the body evolves although a skill that is no leaf comes before.
    #[serde(default)]
    pub body: BodyRule,
    /// `kind` and the parameters of that kind.
    pub fitness: serde_json::Value,
}

/// What happens to the body while a leaf skill is learned in General mode after one that is no leaf (E-68).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyRule {
    /// It stays as it is.
    #[default]
    Locked,
    /// It evolves, and every earlier skill is tested again.
    Evolve,
}

/// What may be added to the body for a skill (E-59).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Growth {
    /// Muscles.
    Muscles,
    /// Photoreceptors.
    Photoreceptors,
}

/// A sense that exists only for skills that declare it (E-32).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// How upright the root is: 0 upside down, 1 upright.
    Tilt,
}

impl Sensor {
    /// Every sensor.
    pub const ALL: [Sensor; 1] = [Sensor::Tilt];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Sensor::Tilt => "tilt",
        }
    }
}

/// One group, as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupTable {
    /// Names of skills, in the order that breaks ties.
    pub members: Vec<String>,
    /// How loud the winner speaks.
    #[serde(default)]
    pub winner: Winner,
    /// Calls up to this are silence, within [0, 1).
    #[serde(default = "floor")]
    pub floor: f64,
}

/// E-50
fn floor() -> f64 {
    0.01
}

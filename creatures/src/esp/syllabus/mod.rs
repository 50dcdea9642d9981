//! The syllabus: which skills there are, which use which, and which groups compete (E-54..E-58). Here is what a
//! creature's life needs of it, checked; how long a skill is evolved and who is picked is for the search.

mod check;
mod stages;
mod table;

pub use stages::{Mode, Stage};
pub use table::{BodyRule, GroupTable, Growth, Sensor, SkillTable, SyllabusTable};

use super::fitness::Fitness;
use super::pandemonium::Winner;
use serde::{Deserialize, Serialize};

/// A skill: its place in the syllabus's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SkillId(pub u16);

impl SkillId {
    /// As an index into [`Syllabus::skills`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// Skills in their order of learning, and the groups in which they compete. Legal by construction:
/// [`SyllabusTable::check`] is the way to one.
#[derive(Debug, Clone, PartialEq)]
pub struct Syllabus {
    skills: Vec<Skill>,
    groups: Vec<Group>,
    /// Skills that share groups, directly or in a chain; users before used (E-54).
    clusters: Vec<Vec<SkillId>>,
}

/// One skill.
#[derive(Debug, Clone, PartialEq)]
pub struct Skill {
    name: String,
    uses: Vec<SkillId>,
    grow: Vec<Growth>,
    sensors: Vec<Sensor>,
    drive_body: bool,
    evolve_body: bool,
    fitness: Fitness,
}

/// Skills of which one at a time is active (E-50).
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// In the order that breaks ties.
    pub members: Vec<SkillId>,
    /// How loud the winner speaks.
    pub winner: Winner,
    /// Calls up to this are silence.
    pub floor: f64,
}

impl Syllabus {
    /// Every skill, in the file's order.
    pub fn skills(&self) -> &[Skill] {
        &self.skills
    }

    /// A skill by its place.
    pub fn skill(&self, id: SkillId) -> Option<&Skill> {
        self.skills.get(id.index())
    }

    /// The place of a skill of a name.
    pub fn find(&self, name: &str) -> Option<SkillId> {
        self.ids().find(|id| self.skills[id.index()].name == name)
    }

    /// Every place, in the file's order.
    pub fn ids(&self) -> impl Iterator<Item = SkillId> + use<> {
        (0..self.skills.len()).map(id)
    }

    /// The groups, in the file's order.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// The order in which sigmas are computed (E-47, E-54): what uses a member of a cluster, or a skill of its
    /// groups, stands in an earlier one. Every skill is in exactly one cluster.
    pub fn clusters(&self) -> &[Vec<SkillId>] {
        &self.clusters
    }
}

impl Skill {
    /// Its id in the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The skills whose sigmas it drives, in the file's order.
    pub fn uses(&self) -> &[SkillId] {
        &self.uses
    }

    /// Whether it uses no other skill.
    pub fn is_leaf(&self) -> bool {
        self.uses.is_empty()
    }

    /// Whether its nodes may drive muscles (E-35).
    pub fn drives_body(&self) -> bool {
        self.is_leaf() || self.drive_body
    }

    /// What may be added to the body while it is learned (E-59).
    pub fn grow(&self) -> &[Growth] {
        &self.grow
    }

    /// Senses besides muscles and photoreceptors (E-32).
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }

    /// Whether the body evolves although a skill that is no leaf was learned before (E-68).
    pub fn evolves_body(&self) -> bool {
        self.evolve_body
    }

    /// How it is scored.
    pub fn fitness(&self) -> &Fitness {
        &self.fitness
    }
}

fn id(index: usize) -> SkillId {
    SkillId(u16::try_from(index).expect("a checked syllabus has at most SKILLS_MAX skills"))
}

#[cfg(test)]
pub(super) mod tests;

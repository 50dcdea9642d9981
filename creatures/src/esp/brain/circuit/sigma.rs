//! The combinational layer: sigmas, gates and groups, computed within a tick, users before used (E-47, E-50..E-54).

use super::Forced;
use super::wiring::index;
use crate::esp::brain::genotype::{Brain, Target};
use crate::esp::brain::node::clamp;
use crate::esp::pandemonium::{Winner, decide};
use crate::esp::syllabus::{Group, SkillId, Syllabus};

/// A wire out of a skill: a signal, behind the gate of its control.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    /// Which control, in the brain's order.
    pub(super) control: u32,
    pub(super) signal: u32,
}

/// Sigmas of every control.
#[derive(Debug, Clone)]
pub(super) struct Sigmas {
    skills: Vec<SkillId>,
    /// Effective sigmas, in the brain's order: what gates multiply by.
    gains: Vec<f64>,
    /// Raw sigmas, in the brain's order.
    raw: Vec<f64>,
    /// What is decided, in order.
    stages: Vec<Stage>,
}

/// One cluster: sigmas that are decided together.
#[derive(Debug, Clone)]
struct Stage {
    calls: Vec<Call>,
    groups: Vec<Arena>,
}

/// How one member's raw sigma comes about.
#[derive(Debug, Clone)]
struct Call {
    control: usize,
    forced: Option<f64>,
    links: Vec<Link>,
    /// Whether groups have a say in what becomes of it.
    grouped: bool,
}

/// One group at work.
#[derive(Debug, Clone)]
struct Arena {
    /// Controls of those members that have one, in the group's order.
    members: Vec<usize>,
    winner: Winner,
    floor: f64,
    previous: Option<usize>,
}

impl Sigmas {
    /// `nodes` are the signals of each control's first node.
    pub(super) fn of(brain: &Brain, syllabus: &Syllabus, forced: &[Forced], nodes: &[u32]) -> Sigmas {
        let controls = &brain.controls;
        let place = |skill: SkillId| controls.iter().position(|control| control.skill == skill);
        let force =
            |skill: SkillId| forced.iter().find(|forced| forced.skill == skill).map(|forced| forced.sigma);
        let sealed = |skill: &SkillId| place(*skill).filter(|&at| controls[at].is_encapsulated());
        // What is open has no sigma: it is on if forced, and in no group.
        let gain = |at: usize| {
            if controls[at].is_encapsulated() { 0.0 } else { force(controls[at].skill).unwrap_or(0.0) }
        };
        let callers = |skill: SkillId| {
            let outputs = controls
                .iter()
                .enumerate()
                .flat_map(|(at, control)| control.outputs.iter().map(move |output| (at, output)));
            let calls = outputs.filter(move |(_, output)| output.target == Target::Skill(skill));
            calls.map(|(at, output)| Link { control: index(at), signal: nodes[at] + u32::from(output.node) })
        };
        let stage = |cluster: &Vec<SkillId>| {
            let members = cluster.iter().filter_map(sealed);
            let call = |control: usize| {
                let skill = controls[control].skill;
                let grouped = syllabus.groups().iter().any(|group| group.members.contains(&skill));
                Call { control, forced: force(skill), links: callers(skill).collect(), grouped }
            };
            let groups = syllabus.groups().iter().filter(|group| cluster.contains(&group.members[0]));
            let arena = |group: &Group| Arena {
                members: group.members.iter().filter_map(sealed).collect(),
                winner: group.winner,
                floor: group.floor,
                previous: None,
            };
            Stage { calls: members.map(call).collect(), groups: groups.map(arena).collect() }
        };
        Sigmas {
            skills: controls.iter().map(|control| control.skill).collect(),
            gains: (0..controls.len()).map(gain).collect(),
            raw: vec![0.0; controls.len()],
            stages: syllabus.clusters().iter().map(stage).filter(|stage| !stage.calls.is_empty()).collect(),
        }
    }

    /// Computes every sigma from the signals of this tick: of each cluster all raw ones, then its groups.
    pub(super) fn decide(&mut self, signals: &[f64]) {
        for stage in &mut self.stages {
            for call in &stage.calls {
                let raw = call.forced.unwrap_or_else(|| sum(&call.links, &self.gains, signals));
                self.raw[call.control] = raw;
            }
            // No link of a cluster starts in it: gains may be set once all its raw sigmas are known.
            for call in &stage.calls {
                self.gains[call.control] = if call.grouped { 1.0 } else { self.raw[call.control] };
            }
            for arena in &mut stage.groups {
                arena.decide(&self.raw, &mut self.gains);
            }
        }
    }

    /// The sum of gated signals, within [0, 1].
    pub(super) fn sum(&self, links: &[Link], signals: &[f64]) -> f64 {
        sum(links, &self.gains, signals)
    }

    /// Every effective sigma, in the brain's order.
    #[cfg(test)]
    pub(super) fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// The effective sigma of a skill that has a control.
    pub(super) fn effective(&self, skill: SkillId) -> Option<f64> {
        self.skills.iter().position(|&known| known == skill).map(|at| self.gains[at])
    }
}

impl Arena {
    /// Silences all but the winner, whose gain becomes no more than what the group grants: what is in several
    /// groups has to win in all of them (E-53).
    fn decide(&mut self, raw: &[f64], gains: &mut [f64]) {
        let winner = decide(self.members.iter().map(|&member| raw[member]), self.floor, self.previous);
        for (place, &member) in self.members.iter().enumerate() {
            let granted = if winner == Some(place) { self.winner.effective(raw[member]) } else { 0.0 };
            if granted < gains[member] {
                gains[member] = granted;
            }
        }
        self.previous = winner.or(self.previous);
    }
}

/// The sum of gated signals, within [0, 1]: a gate is its signal times its skill's sigma, a sigma the sum of its
/// inputs (E-34).
fn sum(links: &[Link], gains: &[f64], signals: &[f64]) -> f64 {
    let gated = links.iter().map(|link| signals[link.signal as usize] * gains[link.control as usize]);
    clamp(gated.sum())
}

//! Stages: in which order the skills are learned, and what each stage has to test again (E-56, E-59..E-68).

use super::{SkillId, Syllabus};
use serde::{Deserialize, Serialize};

/// The two ways to go through a syllabus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// The body stays what the first skill made of it; only muscles and receptors are added (E-59..E-61).
    #[default]
    Fast,
    /// The body goes on evolving while leaf skills are learned, and what was learned is tested again
    /// (E-62..E-68).
    General,
}

/// The evolution of one skill.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stage {
    /// What is learned.
    pub skill: SkillId,
    /// Whether the whole body evolves.
    pub opens_body: bool,
    /// What is tested again before it, in the order of learning; also what is reconciled after it.
    pub retests: Vec<SkillId>,
}

impl Stage {
    /// Tests of skills that one individual takes, if none stops it (E-69).
    pub fn tests(&self) -> impl Iterator<Item = SkillId> + '_ {
        self.retests.iter().copied().chain([self.skill])
    }
}

impl Syllabus {
    /// The stages that are left, in order.
    ///
    /// `learned` are the skills of earlier stages in their order. Fast mode keeps the file's order. General mode
    /// takes leaf skills first (E-62), opens the body for them, and for a leaf after a skill that is none only
    /// if that leaf says so (E-68).
    pub fn stages(&self, mode: Mode, learned: &[SkillId]) -> Vec<Stage> {
        let mut open: Vec<SkillId> = self.ids().filter(|id| !learned.contains(id)).collect();
        if mode == Mode::General {
            open.sort_by_key(|id| !self.skills[id.index()].is_leaf()); // stable
        }
        let mut learned = learned.to_vec();
        let mut stages = Vec::with_capacity(open.len());
        for skill in open {
            let late = learned.iter().any(|id| !self.skills[id.index()].is_leaf());
            let this = &self.skills[skill.index()];
            let again = mode == Mode::General && this.is_leaf() && (!late || this.evolves_body());
            stages.push(Stage {
                skill,
                opens_body: learned.is_empty() || again,
                retests: if again { learned.clone() } else { Vec::new() },
            });
            learned.push(skill);
        }
        stages
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::fitness::tests::context;
    use crate::esp::syllabus::tests::ten_skills;

    /// Per stage: tests of skills, trials, reconciliations.
    fn costs(mode: Mode) -> Vec<(usize, usize, usize)> {
        let syllabus = context().syllabus;
        let trials = |id: SkillId| syllabus.skills()[id.index()].fitness().scoring().trials(&context()).len();
        let cost =
            |stage: &Stage| (stage.tests().count(), stage.tests().map(trials).sum(), stage.retests.len());
        syllabus.stages(mode, &[]).iter().map(cost).collect()
    }

    fn totals(costs: &[(usize, usize, usize)]) -> (usize, usize, usize) {
        costs.iter().fold((0, 0, 0), |sum, cost| (sum.0 + cost.0, sum.1 + cost.1, sum.2 + cost.2))
    }

    /// T-12, R-3
    #[test]
    fn fast_mode_tests_one_skill_a_stage() {
        let costs = costs(Mode::Fast);
        let trials: Vec<usize> = costs.iter().map(|cost| cost.1).collect();
        assert_eq!(trials, [1, 1, 1, 4, 5, 1, 5, 13, 13, 8]);
        assert_eq!(totals(&costs), (10, 52, 0));
    }

    /// T-12, R-4
    #[test]
    fn general_mode_tests_again_while_leaf_skills_are_learned() {
        let costs = costs(Mode::General);
        let tests: Vec<usize> = costs.iter().map(|cost| cost.0).collect();
        assert_eq!(tests, [1, 2, 3, 4, 1, 1, 1, 1, 1, 1]);
        assert_eq!(totals(&costs), (16, 58, 6));
    }

    /// T-12: what it would cost to test everything again, in the file's order.
    #[test]
    fn testing_everything_again_costs_more() {
        let so_far = costs(Mode::Fast).into_iter().scan((0, 0, 0), |sum, cost| {
            *sum = totals(&[*sum, cost]);
            Some(*sum)
        });
        assert_eq!(totals(&so_far.collect::<Vec<_>>()), (55, 183, 0));
    }

    /// E-62
    #[test]
    fn general_mode_learns_leaf_skills_first() {
        let order: Vec<u16> =
            context().syllabus.stages(Mode::General, &[]).iter().map(|stage| stage.skill.0 + 1).collect();
        assert_eq!(order, [1, 2, 3, 6, 4, 5, 7, 8, 9, 10]);
    }

    /// E-68, E-86: what was learned keeps its order, and a late leaf opens the body only if it says so.
    #[test]
    fn a_late_leaf_skill_opens_the_body_only_if_it_says_so() {
        let late = |body: &str| {
            let mut table = ten_skills();
            let leaf = serde_json::json!({ "id": "jump", "body": body, "fitness": { "kind": "high_reach" } });
            table.skill.push(serde_json::from_value(leaf).unwrap());
            let syllabus = table.check().unwrap();
            let learned: Vec<SkillId> = (0..10).map(SkillId).collect();
            syllabus.stages(Mode::General, &learned).remove(0)
        };
        let stage = late("locked");
        assert_eq!((stage.skill, stage.opens_body, stage.retests.len()), (SkillId(10), false, 0));
        let stage = late("evolve");
        assert_eq!((stage.opens_body, stage.retests), (true, (0..10).map(SkillId).collect()));
    }
}

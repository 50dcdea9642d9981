//! The stages of the search: of each skill its phases of shaping, its own fitness, what is reconciled after it,
//! and a measurement; each with a task of its own (ESP E-43, E-63..E-68). It evolves nothing.

use super::learned::Learned;
use super::settings::Settings;
use creatures::esp::syllabus::{self, SkillId};
use serde_json::{Map, Value, json};

/// One stage of the search on the way to one skill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Shaping, by its place among the phases.
    Phase(usize),
    /// The skill under its own fitness; then someone is picked.
    Skill,
    /// The control of an older skill gets used to the body as it has become (Algorithm 2).
    Reconcile(SkillId),
    /// The creature that goes on is tested in all that it knows.
    Measure,
}

/// What is done for a skill, in order. One that a creature brings along is measured alone (E-90).
pub(super) fn parts(settings: &Settings, stage: &syllabus::Stage, brought: bool) -> Vec<Part> {
    if brought {
        return vec![Part::Measure];
    }
    let phases = settings.lesson(stage.skill).phases().len();
    let reconcile = stage.retests.iter().map(|&older| Part::Reconcile(older));
    (0..phases).map(Part::Phase).chain([Part::Skill]).chain(reconcile).chain([Part::Measure]).collect()
}

impl Part {
    /// The stage's name.
    pub(super) fn name(self, settings: &Settings, skill: SkillId) -> String {
        let name = settings.name(skill);
        match self {
            Part::Phase(index) => format!("{name}: phase {}", index + 1),
            Part::Skill => name.to_owned(),
            Part::Reconcile(older) => format!("{name}: reconcile {}", settings.name(older)),
            Part::Measure => format!("{name}: measure"),
        }
    }

    /// How many generations it takes.
    pub(super) fn generations(self, settings: &Settings, skill: SkillId) -> u32 {
        let lesson = settings.lesson(skill);
        match self {
            Part::Phase(index) => lesson.phases()[index].generations,
            Part::Skill => lesson.final_generations(),
            Part::Reconcile(older) => settings.lesson(older).regime.reconcile_generations,
            Part::Measure => 1,
        }
    }

    /// How many populations are side by side, and how many individuals each has.
    pub(super) fn populations(self, settings: &Settings, skill: SkillId) -> (u32, u32) {
        let of = |skill| &settings.lesson(skill).regime;
        match self {
            Part::Phase(_) | Part::Skill => (of(skill).populations, of(skill).population),
            Part::Reconcile(older) => (1, of(older).population), // one run a skill (E-67)
            Part::Measure => (1, 1),
        }
    }

    /// The resolved task of its evaluations.
    pub(super) fn task(self, settings: &Settings, stage: &syllabus::Stage, learned: &[Learned]) -> Value {
        let known = |skill: SkillId| learned.iter().find(|one| one.skill == skill);
        let test = |skill: SkillId| json!({ "skill": settings.name(skill) });
        let retest = |&skill: &SkillId| {
            let least = known(skill).map(|one| one.least(settings.lesson(skill).regime.retest_tolerance));
            json!({ "skill": settings.name(skill), "stop_below": least })
        };
        let retests = stage.retests.iter().map(retest);
        let tests: Vec<Value> = match self {
            Part::Phase(index) => {
                let fitness = &settings.lesson(stage.skill).phases()[index].fitness;
                let shaped = json!({ "skill": settings.name(stage.skill), "fitness": fitness });
                retests.chain([shaped]).collect()
            }
            Part::Skill => retests.chain([test(stage.skill)]).collect(),
            Part::Reconcile(older) => vec![test(older)],
            Part::Measure => learned.iter().map(|one| one.skill).chain([stage.skill]).map(test).collect(),
        };
        let impacts: Map<String, Value> = learned
            .iter()
            .filter_map(|one| Some((settings.name(one.skill).to_owned(), json!(one.impact?))))
            .collect();
        let [skill, pandemonium] = [json!(settings.table.skill), json!(settings.table.pandemonium)];
        json!({ "skill": skill, "pandemonium": pandemonium, "tests": tests, "impacts": impacts })
    }
}

//! The task of an ESP creature: skills to be tested one after the other (E-49, E-63, E-87). Here is what may be
//! written, and what comes out of an evaluation; how a test goes is for the examination.

use super::Genotype;
use super::body::Phenotype;
use super::creature::Creature;
use super::examination::{Candidate, Report, Test};
use super::fault::Fault;
use super::fitness::{Context, Fitness, Setup};
use super::physics::Physics;
use super::syllabus::{GroupTable, SkillId, SkillTable, Syllabus, SyllabusTable};
use crate::{Cull, DecodeError, Observer, Outcome, Reason, SpecError, Status, Task};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The greatest impact that a task may give, body weights.
const IMPACT_MAX: f64 = 1e6;

/// A task as it is written: the syllabus, and what to test of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskTable {
    /// Every skill, in the order of the file.
    #[serde(default)]
    pub skill: Vec<SkillTable>,
    /// The groups.
    #[serde(default)]
    pub pandemonium: Vec<GroupTable>,
    /// In order; the last one gives the fitness.
    #[serde(default)]
    pub tests: Vec<TestTable>,
    /// The measured impact of skills that strike, body weights, by name (E-74, E-75).
    #[serde(default)]
    pub impacts: BTreeMap<String, f64>,
    /// What holds in the world.
    #[serde(default)]
    pub physics: Physics,
}

/// One skill to test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestTable {
    /// Its name.
    pub skill: String,
    /// How it is scored, if otherwise than in the syllabus: that of a phase of shaping (E-43).
    #[serde(default)]
    pub fitness: Option<Value>,
    /// The score below which no further test is made, and the fitness is 0 (E-64).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop_below: Option<f64>,
}

/// A task ready to evaluate.
#[derive(Debug, Clone, PartialEq)]
pub struct EspTask {
    syllabus: Syllabus,
    tests: Vec<Test>,
    impacts: BTreeMap<String, f64>,
    physics: Physics,
}

impl TaskTable {
    /// Looks up every name and checks every number.
    ///
    /// # Errors
    /// EF-1..EF-6, EF-16 of the syllabus; a test or an impact of an unknown skill; an attack without the impact
    /// that it needs. With the path of the key.
    pub fn check(&self) -> Result<EspTask, SpecError> {
        let syllabus = self.syllabus().check()?;
        if self.tests.is_empty() {
            return Err(SpecError::new("tests", "there is none, and the last one gives the fitness"));
        }
        let mut tests: Vec<Test> = Vec::with_capacity(self.tests.len());
        for (place, table) in self.tests.iter().enumerate() {
            let test =
                self.test(&syllabus, table).map_err(|error| error.below(&format!("tests[{place}]")))?;
            if tests.iter().any(|other| other.skill == test.skill) {
                let problem = format!("`{}` is tested already", table.skill);
                return Err(SpecError::new(format!("tests[{place}].skill"), problem));
            }
            tests.push(test);
        }
        self.check_impacts(&syllabus, &tests)?;
        let physics = self.physics.checked().map_err(|error| error.below("physics"))?;
        Ok(EspTask { syllabus, tests, impacts: self.impacts.clone(), physics })
    }

    /// The table with every default filled in.
    ///
    /// # Errors
    /// As [`TaskTable::check`].
    pub fn resolved(mut self) -> Result<TaskTable, SpecError> {
        let EspTask { syllabus, tests, .. } = self.check()?;
        let text = |fitness: &Fitness| serde_json::to_value(fitness).expect("a plain enum serialises");
        for (table, skill) in self.skill.iter_mut().zip(syllabus.skills()) {
            table.fitness = text(skill.fitness());
        }
        for (table, test) in self.tests.iter_mut().zip(&tests) {
            table.fitness = Some(text(&test.fitness));
        }
        Ok(self)
    }

    fn syllabus(&self) -> SyllabusTable {
        SyllabusTable { skill: self.skill.clone(), pandemonium: self.pandemonium.clone() }
    }

    fn test(&self, syllabus: &Syllabus, table: &TestTable) -> Result<Test, SpecError> {
        let skill = find(syllabus, &table.skill).map_err(|problem| SpecError::new("skill", problem))?;
        if let Some(least) = table.stop_below.filter(|least| !least.is_finite()) {
            return Err(SpecError::new("stop_below", format!("{least} is no number")));
        }
        let usual = syllabus.skills()[skill.index()].fitness();
        let fitness = match &table.fitness {
            None => usual.clone(),
            Some(phase) => {
                let fitness = Fitness::read(phase).map_err(|error| error.below("fitness"))?;
                if fitness.kind() != usual.kind() {
                    let problem = format!("`{}` is of kind `{}`", table.skill, usual.kind());
                    return Err(SpecError::new("fitness.kind", problem));
                }
                // With it in its skill's place, the syllabus says whether its references are legal.
                let mut shaped = self.syllabus();
                shaped.skill[skill.index()].fitness = phase.clone();
                shaped.check().map_err(|error| {
                    let field = error.path.split_once(".fitness.").map_or("kind", |(_, field)| field);
                    SpecError::new(format!("fitness.{field}"), error.problem)
                })?;
                fitness
            }
        };
        Ok(Test { skill, fitness, stop_below: table.stop_below })
    }

    fn check_impacts(&self, syllabus: &Syllabus, tests: &[Test]) -> Result<(), SpecError> {
        for (name, &impact) in &self.impacts {
            let path = format!("impacts.{name}");
            let skill = find(syllabus, name).map_err(|problem| SpecError::new(&path, problem))?;
            let kind = syllabus.skills()[skill.index()].fitness().kind();
            if kind != "strike" {
                return Err(SpecError::new(path, format!("`{name}` is of kind `{kind}`, not `strike`")));
            }
            if !(0.0..=IMPACT_MAX).contains(&impact) {
                return Err(SpecError::new(path, format!("{impact} is not within [0, {IMPACT_MAX}]")));
            }
        }
        for (place, test) in tests.iter().enumerate() {
            if let Some(strike) =
                strikes(syllabus, &test.fitness).find(|name| !self.impacts.contains_key(name))
            {
                let problem =
                    format!("its impact is measured by `{strike}`, and `impacts` has none of that name");
                return Err(SpecError::new(format!("tests[{place}].skill"), problem));
            }
        }
        Ok(())
    }
}

/// The skill of a name, or the problem.
fn find(syllabus: &Syllabus, name: &str) -> Result<SkillId, String> {
    syllabus.find(name).ok_or_else(|| {
        let known = syllabus.skills().iter().map(super::syllabus::Skill::name);
        let nearest = known.min_by_key(|known| strsim::damerau_levenshtein(known, name));
        let nearest = nearest.expect("a syllabus has a skill");
        format!("there is no skill `{name}`, did you mean `{nearest}`?")
    })
}

/// The skills that strike whose impact a fitness needs, itself or by a skill that it refers to.
fn strikes(syllabus: &Syllabus, fitness: &Fitness) -> impl Iterator<Item = String> {
    let mut open: Vec<&Fitness> = vec![fitness];
    let mut strikes = Vec::new();
    while let Some(fitness) = open.pop() {
        for reference in fitness.references() {
            let skill = syllabus.find(reference.name).expect("a checked syllabus has what it refers to");
            match reference.kind {
                "strike" => strikes.push(reference.name.to_owned()),
                _ => open.push(syllabus.skills()[skill.index()].fitness()),
            }
        }
    }
    strikes.into_iter()
}

impl EspTask {
    /// Every skill.
    pub(super) fn syllabus(&self) -> &Syllabus {
        &self.syllabus
    }

    /// What holds in the world.
    pub(super) fn physics(&self) -> Physics {
        self.physics
    }

    /// The skill of the test that gives the fitness.
    pub(super) fn last_tested(&self) -> SkillId {
        self.tests.last().expect("a task has a test").skill
    }

    /// A skill's name.
    pub(super) fn name(&self, skill: SkillId) -> &str {
        self.syllabus.skills()[skill.index()].name()
    }

    /// The skill of a name, or the problem.
    pub(super) fn find(&self, name: &str) -> Result<SkillId, String> {
        find(&self.syllabus, name)
    }

    /// Reads a genotype and expresses it; nothing that is not legal is ever lived (E-19).
    pub(super) fn read(&self, genotype: &[u8]) -> Result<(Genotype, Phenotype), DecodeError> {
        let genotype = Genotype::decode(genotype)?;
        let phenotype = genotype.check(&self.syllabus)?;
        if let Some(test) = self.tests.iter().find(|test| genotype.brain.control(test.skill).is_none()) {
            let name = self.syllabus.skills()[test.skill.index()].name();
            let problem = format!("there is no control of `{name}`, which is tested");
            return Err(DecodeError::illegal("brain.controls", problem));
        }
        Ok((genotype, phenotype))
    }

    /// What an examination comes to.
    fn outcome(&self, genotype: &Genotype, phenotype: &Phenotype, report: Report<Fault>) -> Outcome {
        let last = report.tests.last().expect("a task has a test, and the first is always made");
        // Who fails in some trials has a score for the others; who fails in all has none.
        let fault = last.faults.first().filter(|_| last.faults.len() == last.trials.len());
        let (status, fitness) = match fault {
            Some((_, fault)) => (Status::Aborted(fault.kind.reason()), 0.0),
            None => (Status::Completed, report.fitness),
        };
        Outcome {
            status,
            fitness,
            steps: u32::try_from(report.steps).unwrap_or(u32::MAX),
            measures: self.measures(genotype, phenotype, &report),
            interim: None,
            note: fault.map(|(trial, fault)| format!("trial {trial}: {fault}")).unwrap_or_default(),
        }
    }

    fn measures(
        &self,
        genotype: &Genotype,
        phenotype: &Phenotype,
        report: &Report<Fault>,
    ) -> Vec<(String, f64)> {
        let mut measures = Vec::new();
        let mut tell = |name: String, value: f64| measures.push((name, value));
        for (test, result) in self.tests.iter().zip(&report.tests) {
            let skill = self.syllabus.skills()[test.skill.index()].name();
            tell(format!("score.{skill}"), result.score);
            for (name, value) in &result.measures {
                tell(format!("{name}.{skill}"), *value);
            }
        }
        let last = report.tests.last().into_iter().flat_map(|test| &test.trials);
        for (trial, score) in last.enumerate() {
            tell(format!("trial.{trial}"), *score);
        }
        let count = |count: usize| count as f64;
        tell("tests".to_owned(), count(report.tests.len()));
        tell("trials".to_owned(), count(report.tests.iter().map(|test| test.trials.len()).sum()));
        let stopped_by = if self.fell_short(report) { count(report.tests.len() - 1) } else { -1.0 };
        tell("stopped_by".to_owned(), stopped_by);
        for reason in Reason::ALL {
            let faults = report.tests.iter().flat_map(|test| &test.faults);
            let found = faults.filter(|(_, fault)| fault.kind.reason() == reason).count();
            if found > 0 {
                tell(format!("fault.{}", reason.word()), count(found));
            }
        }
        tell("parts".to_owned(), count(phenotype.parts.len()));
        tell("muscles".to_owned(), count(phenotype.muscles.len()));
        tell("receptors".to_owned(), count(phenotype.receptors.len()));
        tell("mass".to_owned(), phenotype.mass());
        tell("inert_wires".to_owned(), count(genotype.brain.inert(&phenotype.instances())));
        measures
    }

    /// Whether the last test that was made fell below its limit.
    fn fell_short(&self, report: &Report<Fault>) -> bool {
        let made = self.tests.iter().zip(&report.tests).next_back();
        made.is_some_and(|(test, result)| test.stop_below.is_some_and(|least| result.score < least))
    }
}

impl Task for EspTask {
    fn check(&self, genotype: &[u8]) -> Result<(), DecodeError> {
        self.read(genotype).map(drop)
    }

    fn evaluate(
        &self,
        genotype: &[u8],
        _seed: u64,           // a trial draws nothing (E-44)
        _cull: Option<&Cull>, // a creature is stopped by its tests (E-64); an experiment may have no culling
        observer: &mut dyn Observer,
    ) -> Result<Outcome, DecodeError> {
        let (genotype, phenotype) = self.read(genotype)?;
        let body = phenotype.instances();
        let context = Context { syllabus: &self.syllabus, impacts: &self.impacts };
        // Trials differ after they have begun: who settles in one start pose settles so in all of them.
        let mut settled = BTreeMap::new();
        let mut candidate = Candidate {
            brain: &genotype.brain,
            body: &body,
            spawn: |setup: &Setup| {
                let spawn = || Creature::spawn(&phenotype, self.physics, setup.start);
                settled.entry(setup.start).or_insert_with(spawn).clone()
            },
        };
        let report = candidate.examine(&self.tests, &context, observer);
        Ok(self.outcome(&genotype, &phenotype, report))
    }
}

#[cfg(test)]
mod tests;

//! An examination: skills tested one after the other, each in its trials (E-49, E-63, E-66, E-87). A creature
//! that has lost too much of what it knew is not tried any further.

use super::brain::{Brain, Circuit, Forced, Instances};
use super::fitness::{Context, Fitness, Record, Setup};
use super::syllabus::SkillId;
use super::trial::{Living, Show, live};
use crate::Observer;

/// One skill to test.
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    /// Which.
    pub skill: SkillId,
    /// How it is scored: as the syllabus says, or as a phase of shaping does.
    pub fitness: Fitness,
    /// The score below which the examination ends, with a fitness of 0 (E-64).
    pub stop_below: Option<f64>,
}

/// What came out.
#[derive(Debug, Clone, PartialEq)]
pub struct Report<F> {
    /// The score of the last test; 0 if one before stopped the examination.
    pub fitness: f64,
    /// Of every test that was made, in order.
    pub tests: Vec<TestReport<F>>,
    /// Tests that were not made, since one before stopped the examination.
    pub skipped: usize,
    /// Physics steps of all trials, without settling.
    pub steps: u64,
}

/// What came out of one test.
#[derive(Debug, Clone, PartialEq)]
pub struct TestReport<F> {
    /// The fitness of the skill.
    pub score: f64,
    /// Of every trial, in order.
    pub trials: Vec<f64>,
    /// What else was measured, by name.
    pub measures: Vec<(&'static str, f64)>,
    /// What went wrong in trials, by their place.
    pub faults: Vec<(usize, F)>,
}

/// A creature as it is examined: its brain, its body's instances, and how to spawn it.
pub struct Candidate<'a, S> {
    /// Checked against the syllabus.
    pub brain: &'a Brain,
    /// What its body expresses.
    pub body: &'a Instances,
    /// Spawns it in the start pose of a trial and lets it settle (E-20), or says what went wrong.
    pub spawn: S,
}

impl<S, L> Candidate<'_, S>
where
    S: FnMut(&Setup) -> Result<L, L::Fault>,
    L: Living,
{
    /// Makes the tests in order, and shows their trials to who watches. Draws nothing.
    pub fn examine(
        &mut self,
        tests: &[Test],
        context: &Context,
        observer: &mut dyn Observer,
    ) -> Report<L::Fault> {
        let mut report = Report { fitness: 0.0, tests: Vec::new(), skipped: 0, steps: 0 };
        let mut record = Record::default();
        let mut show = Show { observer, number: 0 };
        for (place, test) in tests.iter().enumerate() {
            let result = self.test(test, context, &mut record, &mut report.steps, &mut show);
            let score = result.score;
            report.tests.push(result);
            if test.stop_below.is_some_and(|least| score < least) {
                report.skipped = tests.len() - place - 1;
                report.fitness = 0.0;
                return report;
            }
            report.fitness = score;
        }
        report
    }

    /// Tests one skill, which is on alone: every other is only on as far as it calls (E-49).
    fn test(
        &mut self,
        test: &Test,
        context: &Context,
        record: &mut Record,
        steps: &mut u64,
        show: &mut Show,
    ) -> TestReport<L::Fault> {
        let scoring = test.fitness.scoring();
        let forced = [Forced { skill: test.skill, sigma: 1.0 }];
        let fresh = Circuit::new(self.brain, self.body, context.syllabus, &forced);
        let mut report =
            TestReport { score: 0.0, trials: Vec::new(), measures: Vec::new(), faults: Vec::new() };
        for (place, setup) in scoring.trials(context).iter().enumerate() {
            record.moments.clear(); // a creature that does not settle has lived no step of its trial
            let lived = (self.spawn)(setup)
                .and_then(|mut creature| live(&mut creature, &mut fresh.clone(), setup, record, show));
            *steps += record.lived().len() as u64;
            let score = match lived {
                Ok(()) => {
                    report.measures.extend(scoring.gauge(record));
                    scoring.score(setup, record, context)
                }
                Err(fault) => {
                    report.faults.push((place, fault));
                    scoring.score_of_fault(setup)
                }
            };
            report.trials.push(score);
        }
        report.score = scoring.combine(&report.trials);
        report.measures.extend(scoring.measures(&report.trials));
        report
    }
}

#[cfg(test)]
mod tests;

//! What all trials have in common: counting steps, the interim report, and how an end becomes an outcome. It
//! knows no task.

use crate::fish::mechanics::{Fault, TIME_STEP};
use crate::record::{Event, Frame, Scene};
use crate::{Cull, Interim, Observer, Outcome, Reason, Status, Verdict};

/// Watches one evaluation.
pub(in crate::fish) struct Watch<'a> {
    /// Steps done.
    pub(in crate::fish) steps: u32,
    cull: Option<(&'a Cull, u32)>,
    observer: &'a mut dyn Observer,
    interim: Option<Interim>,
}

/// How an evaluation ended before its last step.
#[derive(Debug)]
pub(in crate::fish) enum End {
    Culled,
    Diverged(Fault),
}

impl From<Fault> for End {
    fn from(fault: Fault) -> End {
        End::Diverged(fault)
    }
}

impl<'a> Watch<'a> {
    /// Of an evaluation of so many steps.
    pub(in crate::fish) fn new(
        steps: u32,
        cull: Option<&'a Cull>,
        observer: &'a mut dyn Observer,
    ) -> Watch<'a> {
        let cull = cull.map(|cull| (cull, ((cull.at * f64::from(steps)) as u32).max(1)));
        Watch { steps: 0, cull, observer, interim: None }
    }

    /// A trial of a number begins.
    pub(in crate::fish) fn trial(&mut self, number: u32, scene: impl Fn() -> Scene) {
        self.observer.trial(number, &scene);
    }

    /// A trial stands after so many steps of its own.
    pub(in crate::fish) fn frame(&mut self, steps: u32, frame: impl Fn() -> Frame) {
        self.observer.frame(f64::from(steps) * TIME_STEP, &frame);
    }

    /// Something happened in the step whose frame comes next.
    pub(in crate::fish) fn event(&mut self, event: impl Fn() -> Event) {
        self.observer.event(&event);
    }

    /// Counts a step, and makes the interim report if it is due.
    ///
    /// # Errors
    /// The creature is culled.
    pub(in crate::fish) fn count(&mut self, measure: impl FnOnce() -> f64) -> Result<(), End> {
        self.steps += 1;
        let Some((cull, _)) = self.cull.filter(|&(_, step)| step == self.steps) else {
            return Ok(());
        };
        let interim = Interim { step: self.steps, measure: measure() };
        self.interim = Some(interim);
        self.observer.interim(interim);
        if cull.verdict(interim.measure) == Verdict::Cull { Err(End::Culled) } else { Ok(()) }
    }

    /// The outcome of an evaluation. What has gone out of bounds is named with its step; measures that are no
    /// numbers then are left out (AF-7, AF-8).
    pub(in crate::fish) fn outcome<const N: usize>(
        &self,
        end: Result<(), End>,
        fitness: f64,
        measures: [(&str, f64); N],
    ) -> Outcome {
        let (status, note) = match end {
            Ok(()) => (Status::Completed, String::new()),
            Err(End::Culled) => (Status::Culled, String::new()),
            Err(End::Diverged(fault)) => {
                let reason = match fault {
                    Fault::NonFinite(_) => Reason::NonFinite,
                    Fault::Pivot(_) | Fault::Collapsed(_) | Fault::TooFast { .. } => Reason::BlowUp,
                };
                (Status::Aborted(reason), format!("{fault} at step {}", self.steps + 1))
            }
        };
        let measures = measures.into_iter().filter(|(_, value)| value.is_finite());
        Outcome {
            fitness: if status == Status::Completed { fitness } else { 0.0 },
            status,
            steps: self.steps,
            measures: measures.map(|(name, value)| (name.to_owned(), value)).collect(),
            interim: self.interim,
            note,
        }
    }
}

//! Culling: the cutoff of a generation, derived from the completed previous one, and the control sample.
//! Pure: the same outcomes give the same cutoff, whoever reported first. It rules on nobody; that is
//! [`creatures::Cull`].

use crate::Place;
use creatures::{Outcome, SpecError, Status};
use serde::{Deserialize, Serialize};

/// The `[culling]` table (design: culling; flyer F-53 in general form).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Culling {
    /// The share of a task's steps after which the interim report is made, within (0, 1).
    pub at: f64,
    /// The cutoff is this share of what the least fit of the previous generation reached, within [0, 1].
    pub fraction: f64,
    /// Share of individuals that are ruled on yet run to their end, to measure false culls, within [0, 1].
    pub control: f64,
}

impl Default for Culling {
    fn default() -> Self {
        Culling { at: 0.25, fraction: 0.2, control: 0.0 }
    }
}

/// Which number of an outcome the interim measure becomes by the end of an evaluation.
///
/// [`creatures::System::interim_measure`] says so: `fitness`, or the name of one of the outcome's measures.
pub fn final_measure(outcome: &Outcome, interim_measure: &str) -> Option<f64> {
    if interim_measure == "fitness" {
        return Some(outcome.fitness);
    }
    outcome.measures.iter().find(|(name, _)| name == interim_measure).map(|&(_, value)| value)
}

impl Culling {
    /// Checks the ranges.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        if !(self.at > 0.0 && self.at < 1.0) {
            return Err(SpecError::new("at", format!("{} is not within (0, 1)", self.at)));
        }
        for (key, share) in [("fraction", self.fraction), ("control", self.control)] {
            if !(0.0..=1.0).contains(&share) {
                return Err(SpecError::new(key, format!("{share} is not within [0, 1]")));
            }
        }
        Ok(())
    }

    /// The cutoff of the generation after the given one: `fraction` of the final measure of its least fit
    /// individual, the lowest index among equals. Only completed evaluations count; without any there is no
    /// cutoff and nobody is culled (F-53, F-55). A share of a negative measure would lie above it: of fitness
    /// the cutoff is then 0 (F-54), of any other measure it is the measure itself.
    pub fn cutoff(&self, previous: &[Option<Outcome>], interim_measure: &str) -> Option<f64> {
        previous
            .iter()
            .flatten()
            .filter(|outcome| outcome.status == Status::Completed)
            .min_by(|a, b| a.fitness.total_cmp(&b.fitness)) // the first of equals
            .and_then(|least| final_measure(least, interim_measure))
            .map(|measure| match (measure < 0.0, interim_measure) {
                (false, _) => self.fraction * measure,
                (true, "fitness") => 0.0,
                (true, _) => measure,
            })
    }

    /// Whether the individual of a place is of the control sample.
    pub fn in_control(&self, seed: u64, place: Place) -> bool {
        self.control > 0.0 && place.stream(seed, "control").chance(self.control)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use creatures::{Cull, Reason, Verdict};

    fn outcome(status: Status, fitness: f64, distance: f64) -> Option<Outcome> {
        let measures = vec![("speed".to_owned(), 99.0), ("distance".to_owned(), distance)];
        Some(Outcome { status, fitness, steps: 1500, measures, interim: None, note: String::new() })
    }

    fn verdict(cutoff: Option<f64>, measure: f64) -> Verdict {
        Cull { at: 0.25, cutoff, control: false }.verdict(measure)
    }

    /// Flyer T-19, the rows that concern the rule, and fishes AF-19: θ is a fifth of the distance of the least fit.
    #[test]
    fn the_cutoff_is_a_fifth_of_what_the_least_fit_completed_individual_reached() {
        use Status::{Aborted, Completed, Culled};
        let cutoff = |previous: &[Option<Outcome>]| Culling::default().cutoff(previous, "distance");
        let fit = outcome(Completed, 900.0, 400.0);

        assert_eq!(cutoff(&[]), None, "generation 1 has no generation before it");
        assert_eq!(verdict(None, 0.0), Verdict::Pass);

        let theta = cutoff(&[fit.clone(), outcome(Completed, 100.0, 40.0)]);
        assert_eq!(theta, Some(8.0));
        assert_eq!(verdict(theta, 7.999), Verdict::Cull);
        assert_eq!(verdict(theta, 8.0), Verdict::Pass, "strictly below");

        assert_eq!(cutoff(&[fit.clone(), outcome(Completed, 100.0, 0.0)]), Some(0.0));
        assert_eq!(verdict(Some(0.0), 0.0), Verdict::Pass);

        let none_valid =
            [outcome(Culled, 0.0, 3.0), outcome(Aborted(Reason::BlowUp), 0.0, 5.0), Option::<Outcome>::None];
        assert_eq!(cutoff(&none_valid), None, "no completed individual, no cutoff");

        let mut some_valid = none_valid.to_vec();
        some_valid.extend([fit, outcome(Completed, 100.0, 25.0)]);
        assert_eq!(cutoff(&some_valid), Some(5.0), "culled and aborted ones do not set the cutoff");
    }

    #[test]
    fn among_equally_unfit_individuals_the_lowest_index_sets_the_cutoff() {
        let equals = [outcome(Status::Completed, 1.0, 10.0), outcome(Status::Completed, 1.0, 20.0)];
        assert_eq!(Culling::default().cutoff(&equals, "distance"), Some(2.0));
    }

    #[test]
    fn fitness_itself_may_be_the_measure() {
        let previous = [outcome(Status::Completed, 2000.0, 40.0)];
        assert_eq!(Culling::default().cutoff(&previous, "fitness"), Some(400.0), "flyer T-19, last row");
        assert_eq!(Culling::default().cutoff(&previous, "unheard_of"), None);
    }

    /// Flyer F-54.
    #[test]
    fn a_cutoff_of_fitness_is_never_negative() {
        let previous = [outcome(Status::Completed, -50.0, 40.0)];
        let theta = Culling::default().cutoff(&previous, "fitness");
        assert_eq!(theta, Some(0.0));
        assert_eq!([verdict(theta, -0.001), verdict(theta, 0.0)], [Verdict::Cull, Verdict::Pass]);
    }

    /// A walker's distance is negative where it walked back (walker G-61).
    #[test]
    fn a_negative_measure_is_a_cutoff_as_it_is() {
        let previous = [outcome(Status::Completed, 0.0, -20.0), outcome(Status::Completed, 3.0, 3.0)];
        assert_eq!(Culling::default().cutoff(&previous, "distance"), Some(-20.0), "and not -4, above it");
    }

    #[test]
    fn the_control_sample_has_its_share_and_depends_on_place_and_seed_alone() {
        let rule = Culling { control: 0.05, ..Culling::default() };
        let sample = |seed| -> Vec<u32> {
            let place = |index| Place { stage: 0, generation: 2, index };
            (0..20_000).filter(|&index| rule.in_control(seed, place(index))).collect()
        };
        assert!((850..1150).contains(&sample(1).len()), "{}", sample(1).len());
        assert_eq!(sample(1), sample(1));
        assert_ne!(sample(1), sample(2));
        assert!(!Culling::default().in_control(1, Place { stage: 0, generation: 2, index: 0 }));
    }

    #[test]
    fn a_cutoff_of_the_whole_run_is_refused() {
        let refused = |rule: Culling| rule.check().unwrap_err().path;
        assert_eq!(refused(Culling { at: 1.0, ..Culling::default() }), "at");
        assert_eq!(refused(Culling { at: f64::NAN, ..Culling::default() }), "at");
        assert_eq!(refused(Culling { fraction: -0.1, ..Culling::default() }), "fraction");
        assert_eq!(refused(Culling { control: 2.0, ..Culling::default() }), "control");
    }
}

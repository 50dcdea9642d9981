//! The culling rule, applied by the coordinator (design: culling). A worker stops a creature by itself; what
//! counts is decided here, from the numbers alone.

use crate::lineage::Ruling;
use creatures::{Cull, Interim, Outcome, Status, Verdict};

/// Rules on one interim report.
pub(super) fn rule(cull: &Cull, Interim { step, measure }: Interim) -> Ruling {
    Ruling { step, measure, cutoff: cull.cutoff, verdict: cull.verdict(measure) }
}

/// The outcome as it counts, with the ruling that it follows. An outcome that went on in spite of the cutoff
/// is culled all the same.
///
/// `ruled` is the ruling on an interim report that came before; the one within the outcome outweighs it.
///
/// # Errors
/// For an outcome that was culled without a verdict to that effect: it says nothing of the creature, and
/// another attempt must be made.
pub(super) fn admit(
    outcome: Outcome,
    cull: Option<&Cull>,
    ruled: Option<Ruling>,
) -> Result<(Outcome, Option<Ruling>), String> {
    let ruling = match (cull, outcome.interim) {
        (Some(cull), Some(interim)) => Some(rule(cull, interim)),
        _ => ruled,
    };
    let verdict = ruling.map(|ruling| ruling.verdict);
    match (ruling, outcome.status) {
        (_, Status::Culled) if verdict != Some(Verdict::Cull) => Err(match ruling {
            Some(Ruling { measure, cutoff: Some(cutoff), .. }) => {
                format!("culled against the rule: measure {measure}, cutoff {cutoff}")
            }
            _ => "culled without a cutoff".to_owned(),
        }),
        (Some(Ruling { step, measure, verdict: Verdict::Cull, .. }), status) if status != Status::Culled => {
            let culled = Outcome {
                status: Status::Culled,
                fitness: 0.0,
                steps: step,
                measures: Vec::new(),
                interim: Some(Interim { step, measure }),
                note: "went on below the cutoff, and is culled all the same".to_owned(),
            };
            Ok((culled, ruling))
        }
        _ => Ok((outcome, ruling)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CULL: Cull = Cull { at: 0.5, cutoff: Some(1.0), control: false };

    fn outcome(status: Status, measure: Option<f64>) -> Outcome {
        Outcome {
            status,
            fitness: if status == Status::Completed { 7.0 } else { 0.0 },
            steps: 100,
            measures: vec![("height".to_owned(), 2.0)],
            interim: measure.map(|measure| Interim { step: 50, measure }),
            note: String::new(),
        }
    }

    #[test]
    fn an_outcome_at_or_above_the_cutoff_counts_as_it_is() {
        let passed = outcome(Status::Completed, Some(1.0));
        let (admitted, ruling) = admit(passed.clone(), Some(&CULL), None).unwrap();
        assert_eq!(admitted, passed);
        let passed = Ruling { step: 50, measure: 1.0, cutoff: Some(1.0), verdict: Verdict::Pass };
        assert_eq!(ruling, Some(passed));
    }

    #[test]
    fn an_outcome_that_went_on_below_the_cutoff_is_culled_all_the_same() {
        let (admitted, ruling) = admit(outcome(Status::Completed, Some(0.5)), Some(&CULL), None).unwrap();
        assert_eq!((admitted.status, admitted.fitness, admitted.steps), (Status::Culled, 0.0, 50));
        assert!(admitted.measures.is_empty() && admitted.note.contains("went on below the cutoff"));
        assert_eq!(ruling.map(|ruling| ruling.verdict), Some(Verdict::Cull));
    }

    #[test]
    fn an_outcome_without_its_interim_report_follows_the_ruling_that_was_made() {
        let ruled = rule(&CULL, Interim { step: 50, measure: 0.5 });
        let (admitted, _) = admit(outcome(Status::Completed, None), Some(&CULL), Some(ruled)).unwrap();
        assert_eq!(admitted.status, Status::Culled);
    }

    #[test]
    fn a_spared_creature_of_the_control_sample_lives_to_its_end() {
        let control = Cull { control: true, ..CULL };
        let lived = outcome(Status::Completed, Some(0.5));
        let (admitted, ruling) = admit(lived.clone(), Some(&control), None).unwrap();
        assert_eq!(admitted, lived);
        assert_eq!(ruling.map(|ruling| ruling.verdict), Some(Verdict::Spare));
    }

    #[test]
    fn a_cull_that_the_rule_did_not_ask_for_is_no_outcome() {
        let rejected = |cull: Option<&Cull>, measure| admit(outcome(Status::Culled, measure), cull, None);
        assert_eq!(
            rejected(Some(&CULL), Some(2.0)).unwrap_err(),
            "culled against the rule: measure 2, cutoff 1"
        );
        assert_eq!(rejected(None, None).unwrap_err(), "culled without a cutoff");
        let first = Cull { cutoff: None, ..CULL };
        assert_eq!(rejected(Some(&first), Some(0.0)).unwrap_err(), "culled without a cutoff");
        assert!(rejected(Some(&CULL), Some(0.5)).is_ok());
    }
}

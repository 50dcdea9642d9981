//! The registry of kinds, and records for the tests of each kind.

use super::*;
use crate::esp::brain::TICK;
use crate::esp::syllabus::tests::ten_skills;
use serde_json::json;
use std::sync::LazyLock;

/// The ten skills, without a measured impact.
pub(crate) fn context() -> Context<'static> {
    static SYLLABUS: LazyLock<Syllabus> = LazyLock::new(|| ten_skills().check().expect("it is legal"));
    static IMPACTS: BTreeMap<String, f64> = BTreeMap::new();
    Context { syllabus: &SYLLABUS, impacts: &IMPACTS }
}

/// A trial of so many seconds whose moments are filled in by time, s.
pub(crate) fn lived(seconds: f64, fill: impl Fn(f64, &mut Moment)) -> Record {
    let moment = |step| {
        let mut moment = Moment::default();
        fill(step as f64 * TICK, &mut moment);
        moment
    };
    Record { moments: (0..=setup::steps(seconds)).map(moment).collect(), ..Record::default() }
}

/// EF-4
#[test]
fn an_unknown_kind_key_or_value_is_named_with_what_is_allowed() {
    for (table, path, words) in [
        (json!({ "kind": "locomotoin" }), "kind", "\"locomotoin\" is none; known are `locomotion`, `turn`"),
        (json!({ "seconds": 5.0 }), "kind", "is missing; known are"),
        (json!("locomotion"), "", "not a table"),
        (
            json!({ "kind": "locomotion", "secs": 5.0 }),
            "secs",
            "unknown field `secs`, expected one of `seconds`",
        ),
        (json!({ "kind": "locomotion", "seconds": 0.0 }), "seconds", "0 is not within [0.1, 600]"),
        (json!({ "kind": "locomotion", "speed_step": 4.0 }), "speed_step", "not within (0, 3]"),
        (json!({ "kind": "turn" }), "", "missing field `direction`"),
        (json!({ "kind": "turn", "direction": "up" }), "direction", "expected `left` or `right`"),
        (
            json!({ "kind": "turn", "direction": "left", "drift_free": 2.0 }),
            "drift_free",
            "below `drift_zero`",
        ),
        (json!({ "kind": "face_light", "headings": [] }), "headings", "0 headings where 1 to 100"),
        (json!({ "kind": "face_light", "headings": [45, 0] }), "headings[1]", "0 is not legal"),
        (json!({ "kind": "reach_light", "headings": [181] }), "headings[0]", "not within [-180, 180]"),
        (json!({ "kind": "avert_light", "headings": [-180] }), "headings[0]", "not legal"),
        (json!({ "kind": "flee_light", "gain_ref": 0 }), "gain_ref", "not within (0, 1000]"),
        (json!({ "kind": "attack", "impact_from": "s", "dark_trials": 2 }), "dark_trials", "neither 0 nor 1"),
        (json!({ "kind": "strike", "body_weights": -1 }), "body_weights", "not within"),
        (json!({ "kind": "high_reach", "target_height": "high" }), "target_height", "invalid type"),
        (json!({ "kind": "expression", "score": "mean(up)" }), "score", "(column 6)"),
    ] {
        let error = Fitness::read(&table).unwrap_err();
        assert_eq!(error.path, path, "{error}");
        assert!(error.problem.contains(words), "{error}");
    }
}

#[test]
fn every_kind_is_read_as_it_was_written() {
    for skill in ten_skills().skill {
        let fitness = Fitness::read(&skill.fitness).unwrap();
        let written = serde_json::to_value(&fitness).unwrap();
        assert_eq!(written["kind"], fitness.kind());
        assert_eq!(Fitness::read(&written).unwrap(), fitness);
        for (key, value) in skill.fitness.as_object().unwrap() {
            let same =
                value.as_f64().map_or(&written[key] == value, |number| written[key].as_f64() == Some(number));
            assert!(same || value.is_array(), "{key} of {}", skill.id);
        }
    }
    assert_eq!(Fitness::kinds().count(), 11);
}

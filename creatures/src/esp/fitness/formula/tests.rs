//! Formulas: values, and what is said of a text that is none.

use super::*;
use crate::esp::fitness::tests::lived;
use proptest::prelude::*;

/// Ten seconds in which the creature rises from 0 to 1, and its angle to the light is −2.
fn rising() -> Record {
    lived(10.0, |seconds, moment| {
        moment.up = seconds / 10.0;
        moment.light_angle = -2.0;
        moment.touched = seconds > 5.0;
    })
}

fn value(text: &str) -> f64 {
    Formula::new(text).unwrap().value(&rising())
}

#[test]
fn operators_have_their_ranks_and_associate_to_the_left() {
    for (text, expected) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("8 / 4 / 2", 1.0),
        ("8 - 4 - 2", 2.0),
        ("-2 * -3", 6.0),
        ("2 - -.5", 2.5),
        ("min(3, 1, 2) + max(1, 4)", 5.0),
        ("abs(1 - 3) + clamp01(7) + clamp01(-7)", 3.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

/// E-58
#[test]
fn reducers_make_one_number_of_a_measure() {
    for (text, expected) in [
        ("first(up_z)", 0.0),
        ("last(up_z)", 1.0),
        ("mean(up_z)", 0.5 + 0.5 / 600.0),
        ("min(up_z)", 1.0 / 600.0),
        ("max( up_z )", 1.0),
        ("mean_last(up_z, 2)", 0.9 + 0.5 / 600.0),
        ("mean_last(up_z, 99)", 0.5),
        ("max(last(light_angle), 0.25)", 0.25),
        ("max(light_angle)", -2.0),
        ("mean(touched)", 0.5),
    ] {
        assert!((value(text) - expected).abs() < 1e-9, "{text}: {}", value(text));
    }
}

#[test]
fn what_is_not_finite_is_0() {
    assert_eq!([value("1 / 0"), value("0 / 0"), value("mean(speed) / 0")], [0.0; 3]);
}

/// EF-4
#[test]
fn errors_say_where_and_what_is_expected() {
    for (text, column, words) in [
        ("", 1, "ends where a number or a name"),
        ("1 +", 4, "ends where a number or a name"),
        ("1 + * 2", 5, "`*` where a number or a name"),
        ("up_z", 1, "needs a reducer, as in `mean(up_z)`"),
        ("min(up_z, 2)", 5, "needs a reducer"),
        ("mean(upz)", 6, "`upz` where a measure is expected, one of com_x"),
        ("avg(up_z)", 1, "`avg` where one of first, last"),
        ("mean(up_z", 10, "ends where `)`"),
        ("mean_last(up_z, 0)", 16, "some seconds"),
        ("1.2.3", 1, "`1.2.3` where a number"),
        ("clamp01(1, 2)", 13, "`clamp01` of 2 numbers where it takes 1"),
        ("1 2", 3, "`2` where an operator or the end"),
        ("ä", 1, "`ä` where a number or a name"),
    ] {
        let error = Formula::new(text).unwrap_err();
        assert_eq!(error.column, column, "{text}: {error}");
        assert!(error.problem.contains(words), "{text}: {error}");
    }
}

#[test]
fn depth_and_length_have_limits() {
    let nested = |depth| format!("{}1{}", "(".repeat(depth), ")".repeat(depth));
    assert!(Formula::new(nested(31)).is_ok());
    assert!(Formula::new(nested(5000)).unwrap_err().problem.contains("where 2000 are the most"));
    assert!(Formula::new(nested(40)).unwrap_err().problem.contains("deeper"));
    assert!(Formula::new("-".repeat(1000)).unwrap_err().problem.contains("deeper"));
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in "[-+*/(),. a-z_0-9]{0,60}|.{0,20}") {
        if let Ok(formula) = Formula::new(text) {
            prop_assert!(formula.value(&rising()).is_finite());
        }
    }
}

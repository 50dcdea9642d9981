//! Refusals X-1..X-4 and the round trip.

use super::*;
use crate::random::stream;
use crate::walker::grn::Settings;
use crate::walker::{Genotype as Walker, genotype::VERSION};
use proptest::prelude::*;
use serde_json::{Value, json};

fn founder(body: BodyKind) -> Genotype {
    Genotype::random(body, &Settings::default(), &mut stream(1, [0, 0, 0], "genotype test"))
}

/// The payload as JSON, for crafting bad ones.
fn payload(genotype: &Genotype) -> Value {
    encoding::decode(&genotype.encode()).unwrap()
}

/// The field and the problem of a refusal.
fn refusal(payload: &Value) -> (String, String) {
    match Walker::decode(&encoding::encode(payload)).unwrap_err() {
        DecodeError::Illegal { field, problem } => (field, problem),
        error => panic!("{error:?} names no field"),
    }
}

#[test]
fn a_genotype_carries_version_body_and_controller_in_front() {
    let genotype = founder(BodyKind::Hopper);
    let payload = payload(&genotype);
    assert_eq!((&payload["version"], &payload["body"]), (&json!(VERSION), &json!("hopper")));
    assert_eq!(payload["controller"], "grn");
    let decoded = Walker::decode(&genotype.encode()).unwrap();
    assert_eq!(decoded, Walker::Grn(genotype.clone()));
    assert_eq!(decoded.encode(), genotype.encode());
}

///
#[test]
fn a_tag_out_of_range_or_no_integer_is_refused_by_name() {
    for tag in [json!(33), json!(-1), json!(300), json!(1.5), json!("8"), json!(null)] {
        let mut payload = payload(&founder(BodyKind::Crawler));
        payload["proteins"][3]["enh"] = tag.clone();
        assert_eq!(refusal(&payload).0, "proteins[3].enh", "tag {tag}");
    }
}

///
#[test]
fn a_wrong_number_of_proteins_is_refused_with_expected_and_found() {
    let mut payload = payload(&founder(BodyKind::Crawler));
    for (count, legal) in [(20, false), (21, true), (37, true), (38, false)] {
        payload["proteins"] = vec![json!({"id": 1, "enh": 2, "inh": 3}); count].into();
        if legal {
            Walker::decode(&encoding::encode(&payload)).unwrap();
        } else {
            let (field, problem) = refusal(&payload);
            assert_eq!(field, "proteins");
            assert_eq!(problem, format!("{count} proteins where crawler has 21 to 37"));
        }
    }
}

///
#[test]
fn scaling_factors_out_of_range_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, 0.499, 2.001, -1.0] {
        for (field, genotype) in [
            ("beta", Genotype { beta: bad, ..founder(BodyKind::Arm) }),
            ("delta", Genotype { delta: bad, ..founder(BodyKind::Arm) }),
        ] {
            let error = Walker::decode(&genotype.encode()).unwrap_err();
            assert!(matches!(&error, DecodeError::Illegal { field: f, .. } if f == field), "{error}");
        }
    }
}

///
#[test]
fn strangers_are_told_which_side_to_upgrade() {
    let good = payload(&founder(BodyKind::Runner));
    let with = |field: &str, value: Value| {
        let mut payload = good.clone();
        payload[field] = value;
        Walker::decode(&encoding::encode(&payload)).unwrap_err().to_string()
    };
    assert_eq!(with("version", json!(2)), "genotype version 2 is not 1: upgrade the receiver");
    assert_eq!(with("version", json!(0)), "genotype version 0 is not 1: upgrade the sender");
    let body = with("body", json!("snail"));
    assert!(body.contains("`snail` is none of crawler, arm, hopper, runner"), "{body}");
    let controller = with("controller", json!("cpg"));
    assert!(controller.contains("`cpg`") && controller.contains("upgrade the receiver"), "{controller}");
    assert!(with("colour", json!(1)).contains("colour"));
}

#[test]
fn traits_tell_what_people_ask_about() {
    let genotype = Genotype { beta: 1.25, delta: 0.5, ..founder(BodyKind::Crawler) };
    let regulatory = genotype.proteins.len() - 17;
    let expected = json!({"regulatory": regulatory, "beta": 1.25, "delta": 0.5});
    assert_eq!(genotype.traits(), expected);
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = Walker::decode(&bytes);
    }

    /// Bytes damaged in one place are refused or are another legal genotype, and never panic.
    #[test]
    fn damaged_bytes_never_panic(place: proptest::sample::Index, byte: u8) {
        let mut bytes = founder(BodyKind::Crawler).encode();
        let place = place.index(bytes.len());
        bytes[place] = byte;
        if let Ok(genotype) = Walker::decode(&bytes) {
            prop_assert_eq!(&Walker::decode(&genotype.encode()).unwrap(), &genotype);
        }
    }
}

use super::*;
use proptest::prelude::*;
use prost::Message;

/// Every double there is, NaN payloads, infinities and -0 included.
fn any_bits() -> impl Strategy<Value = f64> {
    prop_oneof![any::<u64>().prop_map(f64::from_bits), Just(-0.0), Just(0.0), Just(f64::NAN)]
}

fn statuses() -> impl Strategy<Value = Status> {
    let aborted = Reason::ALL.map(Status::Aborted);
    prop::sample::select([&[Status::Completed, Status::Culled], &aborted[..]].concat())
}

fn interims() -> impl Strategy<Value = Interim> {
    (any::<u32>(), any_bits()).prop_map(|(step, measure)| Interim { step, measure })
}

fn outcomes() -> impl Strategy<Value = Outcome> {
    let fitness = any_bits().prop_filter("a fitness is finite", |f| f.is_finite());
    let measures = prop::collection::vec((".{0,9}", any_bits()), 0..5);
    (statuses(), fitness, any::<u32>(), measures, prop::option::of(interims()), ".{0,20}").prop_map(
        |(status, fitness, steps, measures, interim, note)| {
            let fitness = if status == Status::Completed { fitness } else { 0.0 };
            Outcome { status, fitness, steps, measures, interim, note }
        },
    )
}

/// Through the bytes, as it really travels.
fn wire<T: Message + Default>(message: T) -> T {
    T::decode(&message.encode_to_vec()[..]).expect("what was encoded decodes")
}

proptest! {
    #[test]
    fn an_outcome_survives_the_wire_bit_for_bit(outcome in outcomes()) {
        let back = Outcome::try_from(wire(v1::Outcome::from(outcome.clone()))).unwrap();
        prop_assert_eq!(back.digest(), outcome.digest());
    }

    #[test]
    fn an_interim_report_survives_the_wire_bit_for_bit(interim in interims()) {
        let back = Interim::try_from(wire(v1::Interim::from(interim))).unwrap();
        prop_assert_eq!(back.step, interim.step);
        prop_assert_eq!(back.measure.to_bits(), interim.measure.to_bits());
    }

    #[test]
    fn a_culling_rule_survives_the_wire(
        at in 1e-300..1.0f64, cutoff in prop::option::of(any_bits()), control: bool
    ) {
        let cutoff = cutoff.filter(|cutoff| !cutoff.is_nan());
        let cull = Cull { at, cutoff, control };
        let back = Cull::try_from(wire(v1::Cull::from(cull))).unwrap();
        prop_assert_eq!(back.cutoff.map(f64::to_bits), cutoff.map(f64::to_bits));
        prop_assert_eq!(back, cull);
    }

    #[test]
    fn no_bytes_make_a_conversion_panic(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
        if let Ok(outcome) = v1::Outcome::decode(&bytes[..]) {
            let _ = Outcome::try_from(outcome);
        }
        if let Ok(cull) = v1::Cull::decode(&bytes[..]) {
            let _ = Cull::try_from(cull);
        }
        if let Ok(task) = v1::Task::decode(&bytes[..]) {
            let _ = task.verified();
        }
    }
}

fn completed() -> v1::Outcome {
    v1::Outcome { status: v1::Status::Completed.into(), fitness: Some(1.5), ..Default::default() }
}

fn refused(outcome: v1::Outcome) -> String {
    Outcome::try_from(outcome).unwrap_err().to_string()
}

/// Fishes AF-15, of a fitness that is no number.
#[test]
fn a_bad_outcome_is_refused_by_the_name_of_its_field() {
    assert!(Outcome::try_from(completed()).is_ok());
    let nan = v1::Outcome { fitness: Some(f64::NAN), ..completed() };
    assert_eq!(refused(nan), "`fitness` is NaN, must be finite in a completed outcome");
    let culled = v1::Outcome { status: v1::Status::Culled.into(), ..completed() };
    assert_eq!(refused(culled), "`fitness` is 1.5, must be 0 unless completed");
    assert_eq!(refused(v1::Outcome { status: 0, ..completed() }), "`status` is missing");
    assert_eq!(refused(v1::Outcome { status: 99, ..completed() }), "`status` has the unknown value 99");
    assert_eq!(refused(v1::Outcome { fitness: None, ..completed() }), "`fitness` is missing");
    let interim = Some(v1::Interim::default());
    assert_eq!(refused(v1::Outcome { interim, ..completed() }), "`interim.measure` is missing");
    let measures = vec![v1::Measure::default()];
    assert_eq!(refused(v1::Outcome { measures, ..completed() }), "`measures[0].value` is missing");
    let note = "x".repeat(NOTE_SIZE_MAX + 1);
    assert_eq!(refused(v1::Outcome { note, ..completed() }), "`note` has the size 4097, the limit is 4096");
    let measures = vec![v1::Measure { value: Some(0.0), ..Default::default() }; MEASURES_MAX + 1];
    assert_eq!(
        refused(v1::Outcome { measures, ..completed() }),
        "`measures` has the size 257, the limit is 256"
    );
    let mut measures = vec![v1::Measure { value: Some(0.0), ..Default::default() }; 3];
    measures[2].name = "x".repeat(MEASURE_NAME_SIZE_MAX + 1);
    let text = refused(v1::Outcome { measures, ..completed() });
    assert_eq!(text, "`measures[2].name` has the size 129, the limit is 128");
}

#[test]
fn a_bad_culling_rule_is_refused_by_the_name_of_its_field() {
    let rule = v1::Cull { at: 0.25, cutoff: Some(0.1), control: false };
    for at in [0.0, 1.0, -0.5, 2.0, f64::NAN] {
        let error = Cull::try_from(v1::Cull { at, ..rule }).unwrap_err().within("cull");
        assert_eq!(error.to_string(), format!("`cull.at` is {at}, must be within (0, 1)"));
    }
    let error = Cull::try_from(v1::Cull { cutoff: Some(f64::NAN), ..rule }).unwrap_err();
    assert_eq!(error.to_string(), "`cutoff` is NaN, must be a number");
}

#[test]
fn a_task_is_named_by_all_of_its_parts() {
    let here = task_hash("walker", 1, "{}");
    assert_eq!(
        here.to_string(),
        "21933676d9e8551c2f66049eee372e13",
        "a change here parts old workers from new coordinators"
    );
    for other in [task_hash("walke", 1, "r{}"), task_hash("walker", 2, "{}"), task_hash("walker", 1, "{ }")] {
        assert_ne!(here, other);
    }
    let bytes = Bytes::from(here);
    assert_eq!(TaskHash::try_from(&bytes), Ok(here));
    let error = TaskHash::try_from(&bytes.slice(1..)).unwrap_err();
    assert_eq!(error.to_string(), "`task` has 15 bytes, must have 16");
}

#[test]
fn a_task_must_be_what_its_hash_says() {
    let task = v1::Task::named("walker", 1, "{}");
    assert_eq!(wire(task.clone()).verified(), Ok(task_hash("walker", 1, "{}")));
    assert_eq!(v1::Task { hash: Bytes::new(), ..task.clone() }.verified(), task.verified());
    let error = v1::Task { hash: Bytes::from_static(&[7; 16]), ..task.clone() }.verified().unwrap_err();
    assert!(error.to_string().starts_with("`hash` is 07070707"), "{error}");
    let system = "x".repeat(SYSTEM_NAME_SIZE_MAX + 1);
    let error = v1::Task { system, hash: Bytes::new(), ..task }.verified().unwrap_err();
    assert_eq!(error.to_string(), "`system` has the size 65, the limit is 64");
}

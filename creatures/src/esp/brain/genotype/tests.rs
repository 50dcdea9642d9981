//! The brain's genotype: what is legal, and what is said of what is not (EF-8).

use super::*;
use crate::encoding;
use crate::esp::brain::tests::{key, legal_brain};
use crate::esp::syllabus::tests::ten_skills;
use proptest::prelude::*;

fn syllabus() -> Syllabus {
    ten_skills().check().unwrap()
}

/// What is said of a brain that was legal before it was changed.
#[track_caller]
fn refused(change: impl FnOnce(&mut Brain), field: &str, words: &str) {
    let mut brain = legal_brain(5, &syllabus());
    brain.check(&syllabus()).unwrap();
    change(&mut brain);
    let error = brain.check(&syllabus()).unwrap_err();
    let DecodeError::Illegal { field: found, problem } = &error else { panic!("{error}") };
    assert_eq!(found, field, "{error}");
    assert!(problem.contains(words), "{error}");
}

/// EF-8
#[test]
fn wires_to_what_does_not_exist_are_named() {
    let divide = |source| Node { kind: NodeKind::Divide, inputs: vec![None, Some(source)] };
    refused(
        |brain| brain.controls[2].nodes[1] = divide(Source::Node(40)),
        "controls[2].nodes[1].inputs[1]",
        "there is no node 40",
    );
    refused(
        |brain| brain.controls[0].outputs[1].node = 99,
        "controls[0].outputs[1].node",
        "there is no node 99",
    );
    refused(
        |brain| brain.controls[0].nodes[0] = divide(Source::Sensor(Sensor::Tilt)),
        "controls[0].nodes[0].inputs[1]",
        "does not declare the sensor tilt",
    );
    refused(
        |brain| brain.controls[3].skill = SkillId(10),
        "controls[3].skill",
        "10 where there are 10 skills",
    );
}

/// EF-8
#[test]
fn more_inputs_than_a_type_has_are_refused() {
    let complement = Node { kind: NodeKind::Complement, inputs: vec![None, None] };
    refused(|brain| brain.controls[1].nodes[0] = complement, "controls[1].nodes[0].inputs", "has 1 at most");
}

/// E-34
#[test]
fn a_parameter_outside_its_range_is_named() {
    let set = |kind, field: &str| {
        let node = Node { kind, inputs: vec![] };
        refused(
            |brain| brain.controls[1].nodes[0] = node,
            &format!("controls[1].nodes[0].kind.{field}"),
            "not within",
        );
    };
    set(NodeKind::Sinusoidal { frequency: 5.1, phase: 0.0 }, "frequency");
    set(NodeKind::Sinusoidal { frequency: 5.0, phase: f64::NAN }, "phase");
    set(NodeKind::Scale { factor: -0.1 }, "factor");
    set(NodeKind::Derivative { tau: 0.0 }, "tau");
    set(NodeKind::Delay { ticks: 0 }, "ticks");
    set(NodeKind::Delay { ticks: 121 }, "ticks");
}

/// E-35
#[test]
fn a_skill_drives_what_it_may_alone() {
    let drive = |target| Output { node: 0, target };
    refused(
        |brain| brain.controls[3].outputs = vec![drive(Target::Muscle(key(0)))],
        "controls[3].outputs[0].target",
        "drives no muscle",
    );
    refused(
        |brain| {
            brain.controls[0].outputs = vec![drive(Target::Muscle(key(0))), drive(Target::Muscle(key(0)))]
        },
        "controls[0].outputs[1].target",
        "already",
    );
    refused(
        |brain| brain.controls[3].outputs = vec![drive(Target::Skill(SkillId(0)))],
        "controls[3].outputs[0].target",
        "does not use skill 0",
    );
}

/// E-46: what has no sigma cannot be driven.
#[test]
fn a_skill_drives_no_skill_that_is_not_encapsulated() {
    refused(
        |brain| brain.controls[1].seal = Seal::Open,
        "controls[3].outputs[0].target",
        "skill 1 is not encapsulated",
    );
    refused(
        |brain| drop(brain.controls.remove(1)),
        "controls[2].outputs[0].target",
        "skill 1 is not encapsulated",
    );
}

#[test]
fn one_skill_at_a_time_is_open_and_none_is_there_twice() {
    refused(
        |brain| {
            brain.controls[8].seal = Seal::Reopened;
            brain.controls[9].seal = Seal::Open;
        },
        "controls",
        "2 skills are open",
    );
    refused(
        |brain| brain.controls.push(Control::new(SkillId(4))),
        "controls[10].skill",
        "skill 4 has a control already",
    );
}

/// E-17
#[test]
fn a_control_has_limits() {
    let constant = Node { kind: NodeKind::Constant { value: 0.0 }, inputs: vec![] };
    refused(|brain| brain.controls[0].nodes = vec![constant; 41], "controls[0].nodes", "41 nodes where 40");
    let sum = Node { kind: NodeKind::Sum, inputs: vec![Some(Source::Length(key(0))); 8] };
    refused(
        |brain| {
            brain.controls[0].nodes = vec![sum; 15];
            brain.controls[0].outputs = vec![Output { node: 0, target: Target::Muscle(key(0)) }];
        },
        "controls[0].outputs",
        "121 wires in all where 120",
    );
}

#[test]
fn an_unknown_field_of_a_node_is_refused() {
    let mut value = serde_json::to_value(legal_brain(5, &syllabus())).unwrap();
    value["controls"][0]["nodes"][0]["weight"] = 1.0.into();
    let error = encoding::decode::<Brain>(&encoding::encode(&value)).unwrap_err();
    assert!(error.to_string().contains("weight"), "{error}");
}

proptest! {
    #[test]
    fn what_was_encoded_is_decoded_bit_for_bit(seed in 0u64..1 << 40) {
        let brain = legal_brain(seed, &syllabus());
        brain.check(&syllabus()).unwrap();
        let bytes = encoding::encode(&brain);
        let decoded: Brain = encoding::decode(&bytes).unwrap();
        prop_assert_eq!(&decoded, &brain);
        prop_assert_eq!(encoding::encode(&decoded), bytes);
    }
}

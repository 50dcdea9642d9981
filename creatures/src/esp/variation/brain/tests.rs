//! Variation of a control: legal for ever, and closed to what is locked.

use super::*;
use crate::esp::brain::tests::{body, key, legal_brain};
use crate::esp::brain::{Source, Target};
use crate::esp::syllabus::tests::ten_skills;
use crate::random::stream;
use proptest::prelude::*;
use std::collections::BTreeSet;

fn syllabus() -> Syllabus {
    ten_skills().check().unwrap()
}

/// A brain in which the last of so many skills is being learned.
fn learning(seed: u64, skills: u16, syllabus: &Syllabus) -> Brain {
    let mut brain = legal_brain(seed, syllabus);
    brain.controls.truncate(usize::from(skills) - 1);
    brain.begin(SkillId(skills - 1), &body(), syllabus, &mut stream(seed, [0, 0, 0], "begin"));
    brain
}

fn oscillates(control: &Control) -> bool {
    control.nodes.iter().any(|node| matches!(node.kind, NodeKind::Sinusoidal { .. }))
}

/// E-42
#[test]
fn a_skill_begins_with_some_nodes_and_drives_something() {
    let syllabus = syllabus();
    let mut counts = BTreeSet::new();
    for seed in 0..200 {
        let brain = learning(seed, 1, &syllabus);
        let control = &brain.controls[0];
        assert!(FIRST_NODES.contains(&control.nodes.len()) && !control.outputs.is_empty());
        assert!(oscillates(control));
        brain.check(&syllabus).unwrap();

        assert!(
            oscillates(&learning(seed, 2, &syllabus).controls[1]),
            "a later leaf skill drives muscles too"
        );

        let brain = learning(seed, 7, &syllabus);
        let control = &brain.controls[6];
        counts.insert(control.nodes.len());
        assert!(!control.outputs.is_empty() && control.seal == Seal::Open);
        assert!(control.outputs.iter().all(|output| matches!(output.target, Target::Skill(_))));
        brain.check(&syllabus).unwrap();
    }
    assert_eq!(counts, NEW_NODES.collect());
}

/// E-41
#[test]
fn every_operator_is_drawn_by_its_weight() {
    let syllabus = syllabus();
    let mut counts = std::collections::BTreeMap::<&str, u32>::new();
    let mut draws = stream(1, [0, 0, 0], "mutate");
    for seed in 0..4000 {
        let mut brain = learning(seed % 50, 1, &syllabus);
        *counts.entry(brain.mutate(&body(), &syllabus, &mut draws).unwrap()).or_default() += 1;
    }
    // Of 21.5 in all, while every operator is legal; copies are for two siblings of six muscles alone.
    let shares = [
        ("parameter", 6.0),
        ("node_type", 1.5),
        ("split_wire", 2.0),
        ("add_node", 2.0),
        ("remove_node", 1.0),
        ("add_wire", 4.0),
        ("remove_wire", 2.0),
        ("redirect_wire", 2.0),
    ];
    for (name, weight) in shares {
        let expected = 4000.0 * weight / 21.5;
        let found = f64::from(counts[name]);
        assert!((found - expected).abs() < 0.25 * expected, "{name}: {found} where {expected} are expected");
    }
    assert!(counts["copy_wiring"] > 50, "{counts:?}");
}

/// E-41
#[test]
fn a_muscle_can_be_driven_as_its_sibling_is() {
    let syllabus = syllabus();
    let siblings = &body().muscles[2..];
    let mut brain = Brain { controls: vec![Control::new(SkillId(0))] };
    brain.controls[0].nodes =
        vec![Node { kind: NodeKind::Multiply, inputs: vec![Some(Source::Photo(body().photos[1].clone()))] }];
    brain.controls[0].outputs = vec![Output { node: 0, target: Target::Muscle(siblings[0].clone()) }];
    let mut seen = BTreeSet::new();
    let mut draws = stream(1, [0, 0, 0], "copy");
    for _ in 0..500 {
        let mut child = brain.clone();
        if child.mutate(&body(), &syllabus, &mut draws) == Some("copy_wiring") {
            let control = &child.controls[0];
            if control.outputs.len() == 2 {
                assert_eq!(
                    control.outputs[1],
                    Output { node: 0, target: Target::Muscle(siblings[1].clone()) }
                );
                seen.insert("drive");
            } else {
                assert_eq!(control.nodes[0].inputs[1], Some(Source::Photo(body().photos[2].clone())));
                seen.insert("read");
            }
        }
    }
    assert_eq!(seen.len(), 2);
}

#[test]
fn references_follow_their_nodes() {
    let node =
        |of| Node { kind: NodeKind::Difference, inputs: vec![Some(Source::Node(of)), Some(Source::Node(1))] };
    let drive = |node, muscle| Output { node, target: Target::Muscle(key(muscle)) };
    let mut control = Control::new(SkillId(0));
    control.nodes = vec![node(2), node(0), node(2)];
    control.outputs = vec![drive(1, 0), drive(2, 1)];
    control.remove_node(1);
    assert_eq!(control.nodes[0].inputs, [Some(Source::Node(1))]);
    assert_eq!(control.nodes[1].inputs, [Some(Source::Node(1))]);
    assert_eq!(control.outputs, [drive(1, 1)]);
}

/// E-39
#[test]
fn a_child_has_nodes_of_both_parents_at_their_places() {
    let syllabus = syllabus();
    let parent = |value: f64, count: usize| {
        let mut control = Control::new(SkillId(0));
        control.nodes = vec![Node { kind: NodeKind::Constant { value }, inputs: vec![] }; count];
        let muscles = body().muscles.into_iter().take(count).enumerate();
        control.outputs =
            muscles.map(|(node, key)| Output { node: node as u16, target: Target::Muscle(key) }).collect();
        Brain { controls: vec![control] }
    };
    let (first, second) = (parent(0.25, 4), parent(0.75, 9));
    let mut shapes = BTreeSet::new();
    for seed in 0..300 {
        let child = first.crossover(&second, &body(), &syllabus, &mut stream(seed, [0, 0, 0], "cross"));
        child.check(&syllabus).unwrap();
        let control = &child.controls[0];
        let of_second: Vec<bool> =
            control.nodes.iter().map(|node| node.kind == NodeKind::Constant { value: 0.75 }).collect();
        assert!(!of_second[0], "the first parent begins");
        let cuts = of_second.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(cuts <= 2);
        assert!(of_second.len() == 4 || of_second.len() == 9, "it ends where a parent does");
        assert_eq!(control.outputs.len(), control.nodes.len().min(4), "outputs come with their nodes");
        shapes.insert(of_second);
    }
    assert_eq!(shapes.len(), 1 + 4 + 6, "uncut, cut once, cut twice");
}

/// E-40
#[test]
fn a_graft_brings_what_feeds_its_muscles_and_no_more() {
    let node = |kind, inputs: &[Source]| Node { kind, inputs: inputs.iter().cloned().map(Some).collect() };
    let drive = |node, muscle| Output { node, target: Target::Muscle(key(muscle)) };
    let mut donor = Control::new(SkillId(0));
    donor.nodes = vec![
        node(NodeKind::Complement, &[Source::Node(2)]),
        node(NodeKind::Constant { value: 0.5 }, &[]),
        node(NodeKind::Sum, &[Source::Length(key(8)), Source::Photo(key(9)), Source::Node(0)]),
    ];
    donor.outputs = vec![drive(1, 7), drive(0, 8)];
    let mut child = Control::new(SkillId(0));
    child.nodes = vec![node(NodeKind::Complement, &[])];
    child.outputs = vec![drive(0, 0)];
    let mut brain = Brain { controls: vec![child] };
    // Muscle 8 came along as muscle 1; muscle 7 and receptor 9 did not.
    brain.graft(&Brain { controls: vec![donor] }, |old| (*old == key(8)).then(|| key(1)));
    let control = &brain.controls[0];
    assert_eq!(control.outputs, [drive(0, 0), drive(1, 1)]);
    assert_eq!(
        control.nodes[1..],
        [
            node(NodeKind::Complement, &[Source::Node(2)]),
            node(NodeKind::Sum, &[Source::Length(key(1)), Source::Node(1)]),
        ]
    );
}

proptest! {
    #[test]
    fn descent_stays_legal_and_what_is_locked_stays_as_it_is(seed in 0u64..1 << 40, skills in 1u16..=10) {
        let syllabus = syllabus();
        let founders = [learning(seed, skills, &syllabus), learning(seed ^ 1, skills, &syllabus)];
        let locked = founders[0].controls[..usize::from(skills) - 1].to_vec();
        let [mut brain, mut mate] = founders;
        mate.controls.splice(..usize::from(skills) - 1, locked.clone());
        let mut draws = stream(seed, [0, 0, 0], "descent");
        for generation in 0..60 {
            prop_assert!(brain.mutate(&body(), &syllabus, &mut draws).is_some());
            if generation % 5 == 4 {
                let child = brain.crossover(&mate, &body(), &syllabus, &mut draws);
                mate = std::mem::replace(&mut brain, child);
            }
            if generation % 7 == 6 {
                brain.graft(&mate, |key| body().muscles.contains(key).then(|| key.clone()));
            }
            if let Err(error) = brain.check(&syllabus) {
                prop_assert!(false, "generation {}: {}", generation, error);
            }
            prop_assert_eq!(&brain.controls[..locked.len()], &locked[..]);
        }
    }

    #[test]
    fn variation_is_named_by_its_stream(seed in 0u64..1 << 40) {
        let syllabus = syllabus();
        let vary = || {
            let mut brain = learning(seed, 2, &syllabus);
            let mut draws = stream(seed, [0, 0, 1], "vary");
            let names: Vec<_> = (0..20).map(|_| brain.mutate(&body(), &syllabus, &mut draws)).collect();
            (brain, names)
        };
        prop_assert_eq!(vary(), vary());
    }
}

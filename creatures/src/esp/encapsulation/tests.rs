//! Encapsulation: T-2, and T-13 at every level of nesting.

use crate::esp::brain::circuit::Census;
use crate::esp::brain::tests::{key, legal_brain, senses};
use crate::esp::brain::{
    Brain, Circuit, Control, Forced, Instances, Node, NodeKind, Output, Seal, Source, Target,
};
use crate::esp::syllabus::tests::ten_skills;
use crate::esp::syllabus::{SkillId, Syllabus};
use proptest::prelude::*;

const FIRST: SkillId = SkillId(0);
const SECOND: SkillId = SkillId(5);

fn syllabus() -> Syllabus {
    ten_skills().check().unwrap()
}

fn body() -> Instances {
    Instances { muscles: vec![key(0), key(1)], photos: vec![] }
}

/// The example: a sine drives muscle A, its complement drives B.
fn example() -> Brain {
    let drive = |node, muscle| Output { node, target: Target::Muscle(key(muscle)) };
    let nodes = vec![
        Node { kind: NodeKind::Sinusoidal { frequency: 5.0, phase: 0.0 }, inputs: vec![] },
        Node { kind: NodeKind::Complement, inputs: vec![Some(Source::Node(0))] },
    ];
    let control = Control { skill: FIRST, seal: Seal::Open, nodes, outputs: vec![drive(0, 0), drive(1, 1)] };
    Brain { controls: vec![control] }
}

/// The example with a second skill, which has a constant drive A.
fn with_second() -> Brain {
    let mut brain = example();
    let constant = Node { kind: NodeKind::Constant { value: 0.7 }, inputs: vec![] };
    let outputs = vec![Output { node: 0, target: Target::Muscle(key(0)) }];
    brain.controls.push(Control { skill: SECOND, seal: Seal::Open, nodes: vec![constant], outputs });
    brain
}

/// Activations of A and B in six ticks.
fn run_in(syllabus: &Syllabus, brain: &Brain, forced: &[(SkillId, f64)]) -> [[f64; 6]; 2] {
    brain.check(syllabus).unwrap();
    let forced: Vec<Forced> = forced.iter().map(|&(skill, sigma)| Forced { skill, sigma }).collect();
    let mut circuit = Circuit::new(brain, &body(), syllabus, &forced);
    let ticks = [(); 6].map(|()| circuit.tick().to_vec());
    [0, 1].map(|muscle| ticks.each_ref().map(|activations| activations[muscle]))
}

/// In the syllabus of ten skills.
fn run(brain: &Brain, forced: &[(SkillId, f64)]) -> [[f64; 6]; 2] {
    run_in(&syllabus(), brain, forced)
}

/// In a syllabus without groups, where an effective sigma is the raw one.
fn run_ungrouped(brain: &Brain, forced: &[(SkillId, f64)]) -> [[f64; 6]; 2] {
    let mut table = ten_skills();
    table.pandemonium.clear();
    run_in(&table.check().unwrap(), brain, forced)
}

#[track_caller]
fn near(found: [[f64; 6]; 2], expected: [[f64; 6]; 2]) {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
    }
}

/// T-2: nodes and wires.
#[test]
fn encapsulation_adds_a_gate_an_output_and_sigmas() {
    let census = |brain: &Brain| brain.census(2);
    let mut brain = example();
    assert_eq!(census(&brain), Census { nodes: 4, wires: 3 });
    brain.encapsulate(FIRST);
    assert_eq!(census(&brain), Census { nodes: 9, wires: 9 });
    let mut brain = with_second();
    brain.encapsulate(FIRST);
    brain.encapsulate(SECOND);
    assert_eq!(census(&brain), Census { nodes: 12, wires: 12 });
}

/// T-2: activations.
#[test]
fn outputs_are_multiplied_by_the_sigma_and_equal_to_the_bit_at_1() {
    let before = run(&example(), &[(FIRST, 1.0)]);
    let sine = [0.0, 0.5, 0.75, 0.933013, 1.0, 0.933013];
    let complement = [0.0, 1.0, 0.5, 0.25, 0.066987, 0.0];
    near(before, [sine, complement]);

    let mut brain = example();
    brain.encapsulate(FIRST);
    assert_eq!(run_ungrouped(&brain, &[(FIRST, 1.0)]), before);
    assert_eq!(run(&brain, &[(FIRST, 1.0)]), before, "in its groups too");
    near(
        run_ungrouped(&brain, &[(FIRST, 0.4)]),
        [[0.0, 0.2, 0.3, 0.373205, 0.4, 0.373205], [0.0, 0.4, 0.2, 0.1, 0.026795, 0.0]],
    );
    assert_eq!(run_ungrouped(&brain, &[(FIRST, 0.0)]), [[0.0; 6]; 2]);
    assert_eq!(run_ungrouped(&brain, &[]), [[0.0; 6]; 2], "nobody calls it");

    let both = [[0.0, 0.9, 1.0, 1.0, 1.0, 1.0], [0.0, 0.4, 0.2, 0.1, 0.026795, 0.0]];
    let mut brain = with_second();
    brain.encapsulate(FIRST);
    near(run_ungrouped(&brain, &[(FIRST, 0.4), (SECOND, 1.0)]), both);
    brain.encapsulate(SECOND);
    near(run_ungrouped(&brain, &[(FIRST, 0.4), (SECOND, 1.0)]), both);
}

/// E-49: what is being learned stays out of the tests of what was learned.
#[test]
fn a_skill_that_runs_alone_is_alone() {
    let mut brain = with_second();
    brain.encapsulate(FIRST);
    let mut alone = example();
    alone.encapsulate(FIRST);
    assert_eq!(run(&brain, &[(FIRST, 1.0)]), run(&alone, &[(FIRST, 1.0)]));
}

/// E-67
#[test]
fn a_reopened_skill_keeps_its_gates() {
    let mut brain = with_second();
    brain.encapsulate(FIRST);
    brain.encapsulate(SECOND);
    let (before, census) = (run(&brain, &[(SECOND, 1.0)]), brain.census(2));
    brain.reopen(FIRST);
    assert_eq!((run(&brain, &[(SECOND, 1.0)]), brain.census(2)), (before, census));
    brain.encapsulate(FIRST);
    assert_eq!(brain.control(FIRST).unwrap().seal, Seal::Locked);
}

proptest! {
    /// T-13, E-48: at every level of the ten skills, with everything below encapsulated.
    #[test]
    fn encapsulation_is_transparent_at_every_level(seed in 0u64..1 << 40, level in 0u16..10) {
        let (syllabus, body) = (syllabus(), crate::esp::brain::tests::body());
        let mut brain = legal_brain(seed, &syllabus);
        brain.controls.truncate(usize::from(level) + 1);
        brain.controls.last_mut().unwrap().seal = Seal::Open;
        let forced = [Forced { skill: SkillId(level), sigma: 1.0 }];
        let mut open = Circuit::new(&brain, &body, &syllabus, &forced);
        brain.encapsulate(SkillId(level));
        let mut sealed = Circuit::new(&brain, &body, &syllabus, &forced);
        for tick in 0..200 {
            senses(seed, tick, &mut open);
            senses(seed, tick, &mut sealed);
            let bits = |circuit: &mut Circuit| circuit.tick().iter().map(|a| a.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&mut open), bits(&mut sealed), "tick {}", tick);
        }
    }
}

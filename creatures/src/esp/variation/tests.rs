//! Whole creatures: every child is legal, and no scope is overstepped (E-19, E-38..E-42, E-59..E-67).

use super::*;
use crate::esp::brain::Seal;
use crate::esp::genotype::Genotype;
use crate::esp::syllabus::tests::ten_skills;
use crate::esp::syllabus::{Growth, Mode, SkillId, Syllabus};
use crate::random::{Stream, stream};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

fn syllabus() -> Syllabus {
    ten_skills().check().unwrap()
}

fn draws(seed: u64, index: u32) -> Stream {
    stream(seed, [0, 0, index], "variation test")
}

fn founder(seed: u64) -> Genotype {
    Genotype::founder(SkillId(0), &syllabus(), &mut draws(seed, 0)).genotype
}

/// A founder that has learned the first so many skills, as they come.
fn learned(seed: u64, skills: u16, syllabus: &Syllabus) -> Genotype {
    let mut creature = founder(seed);
    creature.encapsulate(SkillId(0));
    for skill in (1..skills).map(SkillId) {
        creature = creature.begin_skill(skill, syllabus, &mut draws(seed, 1)).genotype;
        creature.encapsulate(skill);
    }
    creature
}

/// A child by one of the three ways.
fn breed(
    way: u32,
    one: &Genotype,
    two: &Genotype,
    scope: Scope,
    syllabus: &Syllabus,
    draws: &mut Stream,
) -> Child {
    match way % 3 {
        0 => one.mutate(scope, syllabus, draws),
        1 => one.crossover(two, scope, syllabus, draws),
        _ => one.graft(two, scope, syllabus, draws),
    }
}

/// E-42
#[test]
fn founders_have_any_number_of_segments_and_a_muscle() {
    let syllabus = syllabus();
    let mut counts = BTreeMap::<usize, u32>::new();
    let mut refused = 0;
    for index in 0..300 {
        let child = Genotype::founder(SkillId(0), &syllabus, &mut draws(1, index));
        let body = child.genotype.check(&syllabus).unwrap();
        assert!(!body.muscles.is_empty() && child.operators == ["random"]);
        *counts.entry(child.genotype.body.segments.len()).or_default() += 1;
        refused += child.refused.len();
    }
    assert!((1..=6).all(|count| counts[&count] > 25) && counts.len() == 6, "{counts:?}");
    assert!(refused < 300 * 100, "{refused} draws were refused");
}

/// E-42
#[test]
fn a_later_skill_begins_on_the_chosen_body_with_something_to_drive() {
    let syllabus = syllabus();
    let chosen = learned(2, 1, &syllabus);
    let first = chosen.begin_skill(SkillId(1), &syllabus, &mut draws(2, 2));
    assert_eq!((first.genotype.body == chosen.body, &first.operators[..]), (true, &["begin"][..]));
    let scope = Scope::Added { grow: &[Growth::Muscles] };
    let mut grown = 0;
    for index in 0..200 {
        let child = chosen.begin_skill_varied(SkillId(1), scope, &syllabus, &mut draws(3, index));
        child.genotype.check(&syllabus).unwrap();
        assert_eq!(child.operators[0], "begin");
        assert!((1..=3).contains(&(child.operators.len() - 1)), "{:?}", child.operators);
        let control = child.genotype.brain.open().unwrap();
        assert!(control.skill == SkillId(1) && !control.outputs.is_empty());
        assert_eq!(child.genotype.brain.controls[0], chosen.brain.controls[0]);
        grown += u32::from(child.genotype.body != chosen.body);
    }
    assert!((20..160).contains(&grown), "{grown} of 200 have another muscle");
}

/// E-42: a skill that may look begins with eyes, on as many bodies as begin it by chance.
#[test]
fn a_skill_that_may_grow_receptors_begins_with_one() {
    let syllabus = syllabus();
    let chosen = learned(2, 3, &syllabus);
    let skill = SkillId(3);
    let first = chosen.begin_skill(skill, &syllabus, &mut draws(2, 2)).genotype;
    assert_eq!(first.body, chosen.body, "individual 0 stays as it was");
    let scope = Scope::Added { grow: &[Growth::Photoreceptors] };
    for index in 0..100 {
        let child = chosen.begin_skill_varied(skill, scope, &syllabus, &mut draws(3, index));
        assert_eq!(child.operators[..2], ["begin", "add_receptor"]);
        let removed = child.operators.iter().filter(|&&name| name == "remove_receptor").count();
        let own = child.genotype.body.segments.iter().flat_map(|gene| &gene.receptors);
        assert!(own.filter(|gene| gene.owner == skill).count() + removed > 0, "{:?}", child.operators);
        child.genotype.check(&syllabus).unwrap();
    }
}

/// E-41
#[test]
fn the_scope_says_how_many_events_are_of_the_body() {
    let syllabus = syllabus();
    let of_body: BTreeSet<&str> = body::Operator::names().collect();
    let share = |creature: &Genotype, scope| {
        let (mut body, mut all) = (0, 0);
        for index in 0..1000 {
            let child = creature.mutate(scope, &syllabus, &mut draws(4, index));
            if child.refused.is_empty() {
                body += child.operators.iter().filter(|name| of_body.contains(*name)).count();
                all += child.operators.len();
            }
        }
        (body as f64 / all as f64, all as f64 / 1000.0)
    };
    let first = founder(4);
    let later = learned(4, 1, &syllabus).begin_skill(SkillId(1), &syllabus, &mut draws(4, 0)).genotype;
    // Illegal draws are left out above, and those of many body events are illegal more often.
    let (body, _) = share(&first, Scope::Everything);
    assert!((0.28..0.44).contains(&body), "{body}");
    let (body, events) = share(&later, Scope::Added { grow: &[Growth::Muscles] });
    assert!((0.15..0.25).contains(&body) && (2.8..3.2).contains(&events), "{body} of {events}");
    assert_eq!(share(&later, Scope::Added { grow: &[] }).0, 0.0);
    assert_eq!(share(&later, Scope::Control).0, 0.0);
}

/// E-59, E-62, E-63, E-68
#[test]
fn a_stage_has_its_scope() {
    let syllabus = syllabus();
    let scopes = |mode| {
        let stages = syllabus.stages(mode, &[]);
        stages.iter().map(|stage| format!("{:?}", Scope::of(stage, &syllabus))).collect::<Vec<_>>()
    };
    let (muscles, photos) = ("Added { grow: [Muscles] }", "Added { grow: [Photoreceptors] }");
    let fast = scopes(Mode::Fast);
    assert_eq!(fast[..4], ["Everything", muscles, muscles, photos]);
    let general = scopes(Mode::General);
    assert_eq!(general[..5], ["Everything", "Morphology", "Morphology", "Morphology", photos]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// E-19, E-1: the first stage, where everything varies.
    #[test]
    fn descent_of_whole_creatures_stays_legal(seed in 0u64..1 << 40) {
        let syllabus = syllabus();
        let (mut one, mut two) = (founder(seed), founder(seed ^ 1));
        let mut stream = draws(seed, 9);
        for round in 0..18 {
            let child = breed(round, &one, &two, Scope::Everything, &syllabus, &mut stream);
            if let Err(error) = child.genotype.check(&syllabus) {
                prop_assert!(false, "round {}, {:?}: {}", round, child.operators, error);
            }
            prop_assert_eq!(&Genotype::decode(&child.genotype.encode()).unwrap(), &child.genotype);
            prop_assert!(child.genotype.body.next_id >= one.body.next_id, "ids are never used again");
            prop_assert!(!child.operators.is_empty() && child.refused.len() <= REDRAWS + 1);
            let instances = child.genotype.body.develop().unwrap().instances();
            prop_assert_eq!(child.genotype.brain.inert(&instances), 0, "E-36");
            (one, two) = (two, child.genotype);
        }
    }

    /// E-45, E-61: later stages on a body that stays.
    #[test]
    fn what_is_locked_stays_as_it_is(seed in 0u64..1 << 40, skill in 1u16..10) {
        let syllabus = syllabus();
        let chosen = learned(seed, skill, &syllabus);
        let before = chosen.body.develop().unwrap();
        let grow = syllabus.skill(SkillId(skill)).unwrap().grow();
        let scope = Scope::Added { grow };
        let mut stream = draws(seed, 9);
        let mut begin = || chosen.begin_skill_varied(SkillId(skill), scope, &syllabus, &mut stream).genotype;
        let (mut one, mut two) = (begin(), begin());
        for round in 0..18 {
            let child = breed(round, &one, &two, scope, &syllabus, &mut stream).genotype;
            let after = child.check(&syllabus).unwrap();
            prop_assert_eq!(&child.brain.controls[..usize::from(skill)], &chosen.brain.controls[..]);
            prop_assert_eq!(&after.parts, &before.parts);
            let known: Vec<_> = after.muscles.iter().filter(|new| before.muscles.contains(new)).collect();
            prop_assert_eq!(known.len(), before.muscles.len());
            if !grow.contains(&Growth::Muscles) {
                prop_assert_eq!(after.muscles.len(), before.muscles.len());
            }
            if !grow.contains(&Growth::Photoreceptors) {
                prop_assert_eq!(after.receptors.len(), before.receptors.len());
            }
            prop_assert_eq!(child.brain.inert(&after.instances()), 0);
            (one, two) = (two, child);
        }
    }

    /// E-63, E-65: General mode's leaf stages vary the body and keep the control of what was learned.
    #[test]
    fn morphology_varies_and_learned_control_does_not(seed in 0u64..1 << 40) {
        let syllabus = syllabus();
        let chosen = learned(seed, 1, &syllabus);
        let mut stream = draws(seed, 9);
        let mut begin = || {
            chosen.begin_skill_varied(SkillId(1), Scope::Morphology, &syllabus, &mut stream).genotype
        };
        let (mut one, mut two) = (begin(), begin());
        let of_body: BTreeSet<&str> = body::Operator::names().collect();
        for round in 0..18 {
            let child = breed(round, &one, &two, Scope::Morphology, &syllabus, &mut stream);
            child.genotype.check(&syllabus).unwrap();
            prop_assert_eq!(&child.genotype.brain.controls[0], &chosen.brain.controls[0]);
            prop_assert!(!child.operators.contains(&"graft"));
            if !child.operators.iter().any(|name| of_body.contains(name)) {
                prop_assert_eq!(&child.genotype.body, &one.body, "bodies do not mate");
            }
            (one, two) = (two, child.genotype);
        }
        prop_assert!(one.body != chosen.body || two.body != chosen.body);
    }

    /// E-67: reconciliation opens the control of one skill, and nothing else.
    #[test]
    fn reconciliation_leaves_the_body_and_other_skills_alone(seed in 0u64..1 << 40) {
        let syllabus = syllabus();
        let mut chosen = learned(seed, 3, &syllabus);
        chosen.brain.reopen(SkillId(1));
        let mut stream = draws(seed, 9);
        let (mut one, mut two) = (chosen.clone(), chosen.clone());
        for round in 0..18 {
            let child = breed(round, &one, &two, Scope::Control, &syllabus, &mut stream).genotype;
            child.check(&syllabus).unwrap();
            prop_assert_eq!(&child.body, &chosen.body);
            for kept in [0, 2] {
                prop_assert_eq!(&child.brain.controls[kept], &chosen.brain.controls[kept]);
            }
            prop_assert_eq!(child.brain.controls[1].seal, Seal::Reopened);
            (one, two) = (two, child);
        }
        prop_assert!(one.brain != chosen.brain);
    }

    /// E-44
    #[test]
    fn a_child_is_named_by_its_stream(seed in 0u64..1 << 40, way in 0u32..3) {
        let syllabus = syllabus();
        let child = || {
            let (one, two) = (founder(seed), founder(seed ^ 1));
            breed(way, &one, &two, Scope::Everything, &syllabus, &mut draws(seed, 7))
        };
        prop_assert_eq!(child(), child());
    }
}

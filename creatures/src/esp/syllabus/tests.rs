//! Syllabi: the ten skills of the paper, and files that are refused.

use super::*;
use crate::SpecError;
use serde_json::{Value, json};

/// Ten skills, as the paper's figure 6 has them.
pub(in crate::esp) fn ten_skills() -> SyllabusTable {
    let text = include_str!("ten_skills.json");
    serde_json::from_str(text).expect("the ten skills are well-formed")
}

/// A skill of a name that uses others.
fn skill(name: &str, uses: &[&str]) -> Value {
    json!({ "id": name, "uses": uses, "fitness": { "kind": "locomotion" } })
}

fn check(skills: &[Value], groups: &[&[&str]]) -> Result<Syllabus, SpecError> {
    let groups: Vec<Value> = groups.iter().map(|members| json!({ "members": members })).collect();
    let table = json!({ "skill": skills, "pandemonium": groups });
    serde_json::from_value::<SyllabusTable>(table).unwrap().check()
}

#[track_caller]
fn refused(skills: &[Value], groups: &[&[&str]], path: &str, words: &[&str]) {
    let error = check(skills, groups).unwrap_err();
    assert_eq!(error.path, path, "{error}");
    for word in words {
        assert!(error.problem.contains(word), "{error} does not say {word}");
    }
}

fn names(syllabus: &Syllabus, ids: &[SkillId]) -> Vec<String> {
    ids.iter().map(|id| syllabus.skills()[id.index()].name().to_owned()).collect()
}

/// E-54, E-56
#[test]
fn the_ten_skills_are_legal_and_decided_from_the_top() {
    let syllabus = ten_skills().check().unwrap();
    let clusters: Vec<Vec<String>> = syllabus.clusters().iter().map(|ids| names(&syllabus, ids)).collect();
    let place =
        |name: &str| clusters.iter().position(|cluster| cluster.iter().any(|other| other == name)).unwrap();
    assert_eq!(place("fight_or_flight"), 0);
    assert_eq!(
        clusters[place("forward_locomotion")],
        ["forward_locomotion", "turn_to_light", "turn_from_light"]
    );
    for skill in syllabus.skills() {
        for used in names(&syllabus, skill.uses()) {
            assert!(place(skill.name()) < place(&used), "{} before {used}", skill.name());
        }
    }
    assert_eq!(clusters.iter().map(Vec::len).sum::<usize>(), 10);
}

#[test]
fn a_checked_syllabus_is_written_with_every_default() {
    let syllabus = ten_skills().check().unwrap();
    let table = syllabus.table();
    assert_eq!(table.check().unwrap(), syllabus);
    assert_eq!(table.skill[0].fitness["speed_max"], 3.0);
    assert_eq!(check(&[skill("a", &[])], &[]).unwrap().table().skill[0].fitness["seconds"], 10.0);
}

/// EF-1
#[test]
fn a_cycle_is_named() {
    let skills = [skill("a", &[]), skill("b", &["d"]), skill("c", &["b"]), skill("d", &["c", "a"])];
    refused(&skills, &[], "skill[1].uses", &["b → d → c → b"]);
    refused(&[skill("a", &["a"])], &[], "skill[0].uses", &["a → a"]);
}

/// EF-2
#[test]
fn a_skill_that_is_used_before_it_is_learned_is_named_with_its_user() {
    let skills = [skill("a", &[]), skill("b", &["c"]), skill("c", &[])];
    refused(&skills, &[], "skill[1].uses", &["`b`", "`c`", "learned after"]);
}

/// EF-3
#[test]
fn an_unknown_skill_is_named_with_its_place_and_the_nearest() {
    let skills = [skill("left_turn", &[]), skill("strike", &["left_trun"])];
    refused(&skills, &[], "skill[1].uses[0]", &["`left_trun`", "did you mean `left_turn`?"]);
    let skills = [skill("left_turn", &[]), skill("strike", &[])];
    refused(&skills, &[&["strike", "stroke"]], "pandemonium[0].members[1]", &["`stroke`", "`strike`"]);
    let attack = json!({ "id": "attack", "fitness": { "kind": "attack", "impact_from": "smash" } });
    let path = "skill[2].fitness.impact_from";
    refused(&[skill("left_turn", &[]), skill("strike", &[]), attack], &[], path, &["`smash`"]);
    let fight = json!({ "id": "f", "fitness": { "kind": "fight_or_flight", "fight": "b", "flight": "c" } });
    refused(&[skill("left_turn", &[]), fight], &[], "skill[1].fitness.fight", &["there is no skill `b`"]);
}

/// EF-3: what exists has to be what is needed, and learned by then.
#[test]
fn a_fitness_refers_to_an_earlier_skill_of_the_right_kind() {
    let strike = json!({ "id": "strike", "fitness": { "kind": "strike" } });
    let attack = |from: &str| json!({ "id": "attack", "fitness": { "kind": "attack", "impact_from": from } });
    let path = |index: usize| format!("skill[{index}].fitness.impact_from");
    refused(&[skill("walk", &[]), attack("walk")], &[], &path(1), &["`locomotion`, not `strike`"]);
    refused(&[attack("strike"), strike.clone()], &[], &path(0), &["`strike` is not learned before `attack`"]);
    assert!(check(&[strike, attack("strike")], &[]).is_ok());
}

/// EF-4
#[test]
fn a_fault_in_a_fitness_has_its_whole_path() {
    let bad = json!({ "id": "b", "fitness": { "kind": "face_light", "headings": [10, 400] } });
    refused(&[skill("a", &[]), bad], &[], "skill[1].fitness.headings[1]", &["400"]);
    let bad = json!({ "id": "b", "fitness": { "kind": "dance" } });
    refused(&[skill("a", &[]), bad], &[], "skill[1].fitness.kind", &["`locomotion`", "`expression`"]);
}

/// EF-5
#[test]
fn a_group_whose_members_depend_on_each_other_is_refused() {
    let skills = [skill("a", &[]), skill("b", &["a"]), skill("c", &["b"])];
    refused(&skills, &[&["c", "a"]], "pandemonium[0].members", &["[c, a]", "`c` depends on `a`"]);
}

/// EF-5: neither group alone is at fault.
#[test]
fn groups_that_depend_on_each_other_in_a_cycle_are_refused() {
    let skills = [skill("a", &[]), skill("b", &[]), skill("c", &["a"]), skill("d", &["b"])];
    refused(&skills, &[&["a", "d"], &["b", "c"]], "pandemonium[0].members", &["[a, d]", "[b, c]"]);
    // Groups that share a member are one vertex.
    let skills = [skill("a", &[]), skill("b", &[]), skill("c", &["a"])];
    refused(&skills, &[&["a", "b"], &["b", "c"]], "pandemonium[0].members", &["[a, b]", "[b, c]"]);
    assert!(check(&skills, &[&["a", "b"]]).is_ok());
}

/// EF-6
#[test]
fn a_syllabus_starts_with_a_leaf_and_has_no_name_twice() {
    refused(&[], &[], "skill", &["0 skills"]);
    refused(&[skill("a", &[]), skill("a", &[])], &[], "skill[1].id", &["`a` is the id of an earlier skill"]);
    refused(&[skill("a b", &[])], &[], "skill[0].id", &["`a b`"]);
    refused(&[skill("a", &["b"]), skill("b", &[])], &[], "skill[0].uses", &["`b`"]);
}

#[test]
fn a_group_has_at_least_two_members_and_a_floor_below_1() {
    let skills = [skill("a", &[]), skill("b", &[])];
    refused(&skills, &[&["a"]], "pandemonium[0].members", &["1 members"]);
    refused(&skills, &[&["a", "a"]], "pandemonium[0].members[1]", &["`a` is there already"]);
    let mut table = ten_skills();
    table.pandemonium[1].floor = 1.0;
    assert_eq!(table.check().unwrap_err().path, "pandemonium[1].floor");
}

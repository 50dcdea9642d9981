//! A syllabus in an experiment file: what overrides what, and where in the text a fault stands (ESP E-88).

use super::*;
use crate::{Experiment, Overrides};

const TEXT: &str = r#"name = "two"
system = "esp"
[search]
kind = "syllabus"
population = 10
generations = 5
[[skill]]
id = "walk"
fitness = { kind = "locomotion", seconds = 4.0 }
[[skill]]
id = "see"
uses = ["walk"]
generations = 9
fitness = { kind = "face_light", headings = [45, -45] }
[[skill]]
id = "strike"
fitness = { kind = "strike" }
[[pandemonium]]
members = ["walk", "strike"]
[profile.smoke]
search.generations = 2
[profile.longer]
search.generations = 2
skill.see.generations = 3
skill.see.fitness.seconds = 2.0
"#;

fn parse(text: &str, profile: Option<&str>, set: &[(&str, &str)]) -> Result<Experiment, Vec<String>> {
    let set = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let over = Overrides { profile: profile.map(str::to_owned), set };
    let told = |problems: Vec<crate::Problem>| problems.iter().map(ToString::to_string).collect();
    Experiment::parse(text, &over).map(|mut experiments| experiments.remove(0)).map_err(told)
}

/// The problems of the text with a part of it replaced.
fn edited(from: &str, to: &str) -> Vec<String> {
    assert!(TEXT.contains(from), "{from}");
    parse(&TEXT.replacen(from, to, 1), None, &[]).unwrap_err()
}

/// The generations of the three skills.
fn generations(profile: Option<&str>, set: &[(&str, &str)]) -> [u64; 3] {
    let resolved: toml::Table = parse(TEXT, profile, set).unwrap().resolved().parse().unwrap();
    let skills = resolved["skill"].as_array().unwrap();
    [0, 1, 2].map(|skill| skills[skill]["generations"].as_integer().unwrap() as u64)
}

/// E-88: what is laid over `[search]` holds for every skill; a key names a skill by its id.
#[test]
fn what_overrides_search_overrides_every_skill() {
    assert_eq!(generations(None, &[]), [5, 9, 5]);
    assert_eq!(generations(Some("smoke"), &[]), [2, 2, 2]);
    assert_eq!(generations(Some("longer"), &[]), [2, 3, 2]);
    assert_eq!(generations(None, &[("search.generations", "4")]), [4, 4, 4]);
    assert_eq!(
        generations(None, &[("search.generations", "4"), ("skill.strike.generations", "6")]),
        [4, 4, 6]
    );
    let matrix = format!("{TEXT}[matrix]\n\"search.generations\" = [7]\n");
    assert_eq!(parse(&matrix, None, &[]).unwrap().generations(), Some(3 * 7 + 3));
    let longer = parse(TEXT, Some("longer"), &[]).unwrap();
    assert!(longer.resolved().contains("headings = [45.0, -45.0]"), "{}", longer.resolved());
    let unknown = parse(TEXT, None, &[("skill.sea.generations", "3")]).unwrap_err();
    let told = "`skill.sea`: there is no `sea` in the list `skill`; did you mean `see`? there are: walk, see, strike";
    assert_eq!(unknown, [told]);
}

#[test]
fn a_resolved_syllabus_is_a_file_of_the_same_experiment_and_has_no_task() {
    let experiment = parse(TEXT, Some("smoke"), &[]).unwrap();
    let resolved = experiment.resolved();
    assert!(!resolved.contains("[task"), "{resolved}");
    assert_eq!(Experiment::parse_resolved(&resolved).unwrap().resolved(), resolved);
    assert_eq!(experiment.planned(), Some(3 * (2 * 5 * 10 + 1)));
    let stage = experiment.start(1).stage();
    let task = stage.task.unwrap();
    assert_eq!(creatures::system("esp").unwrap().resolve(task.clone()).unwrap(), task);
    assert_eq!(serde_json::from_str::<Value>(&experiment.task_json()).unwrap(), task);
}

/// EF-1..EF-6, EF-16
#[test]
fn every_fault_of_a_syllabus_is_told_with_its_line() {
    assert_eq!(
        edited(r#"id = "walk""#, "id = \"walk\"\nuses = [\"see\"]"),
        ["line 9, column 8: `skill[0].uses`: skills use each other in a cycle: walk → see → walk"]
    );
    assert_eq!(
        edited(r#"uses = ["walk"]"#, r#"uses = ["strike"]"#),
        ["line 12, column 8: `skill[1].uses`: `see` uses `strike`, which is learned after it"]
    );
    assert_eq!(
        edited(r#"uses = ["walk"]"#, r#"uses = ["wlak"]"#),
        ["line 12, column 9: `skill[1].uses[0]`: there is no skill `wlak`, did you mean `walk`?"]
    );
    let group = edited(r#"members = ["walk", "strike"]"#, r#"members = ["walk", "see"]"#);
    assert_eq!(group.len(), 1, "{group:?}");
    assert!(
        group[0].starts_with("line 19, column 11: `pandemonium[0].members`: in the group [walk, see]"),
        "{group:?}"
    );
    assert_eq!(
        edited(r#"id = "see""#, r#"id = "walk""#),
        ["line 11, column 6: `skill[1].id`: `walk` is the id of an earlier skill"]
    );
    assert_eq!(
        edited("generations = 9", "generations = 0"),
        ["line 13, column 15: `skill[1].generations`: 0 is not within 1 to 10000000"]
    );
    assert_eq!(
        edited("population = 10", "population = 10\nelites = 10"),
        ["line 6, column 10: `search.elites`: 10 is not within 1 to 9, below the population"]
    );
    let kind = edited(r#"kind = "face_light""#, r#"kind = "face_lamp""#);
    assert_eq!(kind.len(), 1, "{kind:?}");
    assert!(
        kind[0].starts_with(r#"line 14, column 20: `skill[1].fitness.kind`: "face_lamp" is none; known are"#),
        "{kind:?}"
    );
    let headings = edited("headings = [45, -45]", "headings = []");
    assert!(headings[0].starts_with("line 14, column 45: `skill[1].fitness.headings`"), "{headings:?}");
    let unknown = edited("generations = 9", "generatons = 9");
    assert!(
        unknown[0].starts_with(
            "line 13, column 1: `skill[1].generatons`: unknown key `generatons`; did you mean `generations`?"
        ),
        "{unknown:?}"
    );
}

/// One reading finds faults of several skills.
#[test]
fn faults_of_several_skills_are_told_at_once() {
    let text =
        TEXT.replacen("generations = 9", "generations = 0", 1).replacen("seconds = 4.0", "seconds = -4.0", 1);
    let told = parse(&text, None, &[]).unwrap_err();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].starts_with("line 9,") && told[1].starts_with("line 13,"), "{told:?}");
}

#[test]
fn a_syllabus_takes_no_task_and_no_culling_and_other_searches_take_no_skills() {
    let task = edited("[search]", "[task]\nbody = 1\n[search]");
    assert_eq!(
        task,
        [
            "line 3, column 2: `task`: is not written: the task of each stage follows from [[skill]] and [[pandemonium]]"
        ]
    );
    assert!(
        edited("[search]", "[culling]\n[search]")[0].starts_with("line 3, column 2: `culling`: is not for")
    );
    let walker = "name = \"w\"\nsystem = \"walker\"\n[task]\nbody = \"crawler\"\n[search]\nkind = \"grn\"\n[[skill]]\nid = \"a\"\n";
    let told = parse(walker, None, &[]).unwrap_err();
    assert_eq!(told.len(), 1);
    assert!(told[0].contains("`skill`: is no part of a search of kind `grn`"), "{told:?}");
}

//! The tables of an experiment file (ESP E-88, EF-1..EF-6, EF-16). Places in the text are the experiment reader's.

use super::*;

fn refused(change: impl Fn(&mut Value)) -> String {
    let mut table = ten_skills(json!({}));
    change(&mut table);
    Settings::read(table).unwrap_err().to_string()
}

/// E-37, E-38, E-42, E-64, E-67, E-81
#[test]
fn the_papers_numbers_and_the_specifications_choices_are_the_defaults() {
    let skill = json!([{ "id": "walk", "fitness": { "kind": "locomotion" } }]);
    let plan = Settings::read(json!({ "kind": "syllabus", "skill": skill })).unwrap();
    assert_eq!(
        Plan::table(&plan),
        json!({
            "kind": "syllabus", "mode": "fast", "import": "", "populations": 5, "population": 200, "generations": 80, "elites": 4,
            "selection": "rank", "rank_pressure": 1.8,
            "reproduction": { "mutate": 0.4, "crossover": 0.3, "graft": 0.3 },
            "pick": "best", "keep_candidates": 10, "retest_tolerance": 0.2, "reconcile_generations": 30,
        })
    );
    assert_eq!((plan.population(), plan.generations()), (1000, 81));
}

#[test]
fn a_skill_overrides_what_search_says_and_is_written_with_every_default() {
    let mut table = ten_skills(json!({}));
    table["skill"][1]["generations"] = json!(9);
    table["skill"][1]["phase"] = json!([{ "share": 0.5, "seconds": 3.0 }]);
    let plan = Settings::read(table).unwrap();
    let [(_, skills), (_, groups)] = Plan::lists(&plan).try_into().unwrap();
    assert_eq!((&skills[0]["generations"], &skills[1]["generations"]), (&json!(3), &json!(9)));
    assert_eq!(groups[1]["floor"], 0.01);
    let mut again = Plan::table(&plan);
    (again["skill"], again["pandemonium"]) = (skills, groups);
    assert_eq!(Settings::read(again).unwrap(), plan, "what is written is the same syllabus");
}

/// EF-4, EF-16
#[test]
fn what_is_out_of_range_is_named_with_its_place() {
    let skill =
        |key: &'static str, value: Value| refused(move |table| table["skill"][2][key] = value.clone());
    assert_eq!(skill("generations", json!(0)), "`skill[2].generations`: 0 is not within 1 to 10000000");
    assert_eq!(skill("population", json!(1)), "`skill[2].population`: 1 is not within 2 to 50000");
    assert_eq!(skill("elites", json!(6)), "`skill[2].elites`: 6 is not within 1 to 5, below the population");
    assert!(skill("generations", json!(-3)).starts_with("`skill[2].generations`: invalid value"));
    let mutate = skill("reproduction", json!({ "mutate": 0.9 }));
    assert!(
        mutate.starts_with("`skill[2].reproduction`: mutate, crossover and graft add up to 1.5"),
        "{mutate}"
    );
    let unknown = skill("generation", json!(3));
    assert!(
        unknown.starts_with("`skill[2].generation`: unknown field `generation`, expected one of `id`"),
        "{unknown}"
    );
    let empty = refused(|table| table["skill"][3]["fitness"]["headings"] = json!([]));
    assert!(empty.starts_with("`skill[3].fitness.headings`"), "{empty}");
    assert!(refused(|table| table["elites"] = json!(0)).starts_with("`elites`: 0 is not within 1 to 5"));
    assert!(refused(|table| table["mood"] = json!(0)).starts_with("`mood`: unknown field"));
    assert!(
        refused(|table| table["pandemonium"][0]["ceiling"] = json!(0))
            .starts_with("`pandemonium[0].ceiling`")
    );
}

/// E-43
#[test]
fn phases_leave_generations_for_the_skills_own_fitness() {
    let phase = |rows: Value| refused(move |table| table["skill"][0]["phase"] = rows.clone());
    let path = "`skill[0].phase[1]`: the phases leave none of the skill's 3 generations to its own fitness";
    assert_eq!(phase(json!([{ "share": 0.7 }, { "share": 0.1 }])), path);
    assert_eq!(phase(json!([{ "share": 1.0 }])), "`skill[0].phase[0].share`: 1 is not between 0 and 1");
    assert!(
        phase(json!([{ "share": 0.3, "pace": 1 }])).starts_with("`skill[0].phase[0].pace`: unknown field")
    );
    assert!(phase(json!([{ "seconds": 1.0 }])).starts_with("`skill[0].phase[0]`: missing field `share`"));
}

/// E-62: General mode has an order of its own, in which nothing may be missing.
#[test]
fn general_mode_refuses_a_reference_to_what_it_learns_later() {
    let change = |table: &mut Value| {
        table["mode"] = json!("general");
        table["skill"][5]["uses"] = json!(["left_turn"]); // strike is no leaf any more
        table["skill"][6]["uses"] = json!([]); // and attack is one
    };
    assert_eq!(
        refused(change),
        "`skill[6].fitness.impact_from`: general mode learns leaf skills first, and so `attack` before `strike`, \
         which it refers to"
    );
}

//! Going on with a changed file (ESP E-86, EF-11).

use super::*;

/// The checkpoint at which the third skill of ten is being learned in Fast mode.
fn checkpoint() -> Vec<u8> {
    let mut run = Run::new(settings(json!({})).start(7, 0));
    while run.stages.last().is_none_or(|stage| stage.name != "right_turn") {
        run.step();
    }
    run.search.checkpoint()
}

fn amended(change: impl Fn(&mut Value)) -> Result<Vec<String>, String> {
    let mut table = ten_skills(json!({}));
    change(&mut table);
    let plan = Settings::read(table).unwrap();
    let checkpoint = checkpoint();
    let told = plan.amend(&checkpoint);
    assert_eq!(plan.restore(7, 0, &checkpoint).is_ok(), told.is_ok(), "what is accepted can go on");
    told.map(|differences| differences.iter().map(ToString::to_string).collect())
        .map_err(|error| error.to_string())
}

#[test]
fn what_the_search_has_not_come_to_may_change() {
    assert_eq!(amended(|_| {}).unwrap(), [""; 0]);
    assert_eq!(
        amended(|table| table["skill"][3]["generations"] = json!(9)).unwrap(),
        ["skill `turn_to_light` has changed"]
    );
    let appended = |table: &mut Value| {
        let skill = json!({ "id": "jump", "fitness": { "kind": "high_reach" } });
        table["skill"].as_array_mut().unwrap().push(skill);
        table["pandemonium"].as_array_mut().unwrap().push(json!({ "members": ["jump", "fight_or_flight"] }));
    };
    assert_eq!(amended(appended).unwrap(), ["skill `jump` is new", "group [jump, fight_or_flight] is new"]);
    let removed = |table: &mut Value| {
        table["skill"].as_array_mut().unwrap().pop();
    };
    assert_eq!(amended(removed).unwrap(), ["skill `fight_or_flight` is gone"]);
}

/// Also of a skill that is being learned: nobody has gone on from it (E-82). So does a fork, which picks anew.
#[test]
fn who_picks_may_change_until_someone_was_picked() {
    let by_hand = |skill: usize| amended(|table| table["skill"][skill]["pick"] = json!("human"));
    assert_eq!(by_hand(2).unwrap(), ["skill `right_turn` has another `pick`"]);
    assert_eq!(by_hand(5).unwrap(), ["skill `strike` has another `pick`"]);
    let refused = by_hand(1).unwrap_err();
    assert_eq!(refused, "skill `left_turn` has another `pick`, and someone was picked already");
}

#[test]
fn what_was_evolved_already_may_not_change() {
    let refused = |change: &dyn Fn(&mut Value)| amended(change).unwrap_err();
    let learned = refused(&|table| table["skill"][1]["fitness"]["seconds"] = json!(8.0));
    assert_eq!(learned, "skill `left_turn` has changed, and it was evolved already");
    let current = refused(&|table| table["skill"][2]["population"] = json!(8));
    assert_eq!(current, "skill `right_turn` has changed, and it was evolved already");
    let mode = refused(&|table| table["mode"] = json!("general"));
    assert_eq!(mode, "`search.mode` has changed, and skills were evolved with it already");
    let moved = refused(&|table| {
        let skill = json!({ "id": "jump", "fitness": { "kind": "high_reach" } });
        table["skill"].as_array_mut().unwrap().insert(1, skill);
    });
    assert!(moved.contains("skill `left_turn` stands at another place"), "{moved}");
    let group = refused(&|table| table["pandemonium"][0]["winner"] = json!("own"));
    assert!(
        group.contains("group [left_turn, right_turn] is gone, and a member of it was evolved"),
        "{group}"
    );
}

/// A learned skill that another learned skill calls would be called otherwise in a new group (E-55, E-86).
#[test]
fn a_new_group_may_not_hold_what_a_learned_skill_uses() {
    let table = |groups: Value| {
        let mut table = ten_skills(json!({}));
        table["skill"] = json!([
            { "id": "walk", "fitness": { "kind": "locomotion" } },
            { "id": "see", "uses": ["walk"], "grow": ["photoreceptors"], "fitness": { "kind": "face_light" } },
            { "id": "jump", "fitness": { "kind": "high_reach" } },
        ]);
        table["pandemonium"] = groups;
        Settings::read(table).unwrap()
    };
    let mut run = Run::new(table(json!([])).start(7, 0));
    while run.stages.last().is_none_or(|stage| stage.name != "see: measure") {
        run.step();
    }
    let checkpoint = run.search.checkpoint();
    assert!(table(json!([{ "members": ["see", "jump"] }])).amend(&checkpoint).is_ok());
    let error = table(json!([{ "members": ["walk", "jump"] }])).amend(&checkpoint).unwrap_err().to_string();
    assert_eq!(
        error,
        "group [walk, jump] is new, and a member of it is used by a skill that was evolved already"
    );
}

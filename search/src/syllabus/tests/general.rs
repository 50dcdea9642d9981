//! General mode: retests, reconciliation and what they cost (ESP E-62..E-69).

use super::*;

fn general(search: Value) -> Value {
    let mut search = search;
    search["mode"] = json!("general");
    search
}

/// E-62, E-66, E-67
#[test]
fn general_mode_learns_leaf_skills_first_and_reconciles_each_older_one() {
    let run = run(general(json!({})));
    assert_eq!(
        names(&run.stages)[..14],
        [
            "forward_locomotion",
            "forward_locomotion: measure",
            "left_turn",
            "left_turn: reconcile forward_locomotion",
            "left_turn: measure",
            "right_turn",
            "right_turn: reconcile forward_locomotion",
            "right_turn: reconcile left_turn",
            "right_turn: measure",
            "strike",
            "strike: reconcile forward_locomotion",
            "strike: reconcile left_turn",
            "strike: reconcile right_turn",
            "strike: measure",
        ]
    );
    assert_eq!(names(&run.stages)[14..16], ["turn_to_light", "turn_to_light: measure"]);
    assert_eq!(run.stages.len(), 2 * 10 + 6, "T-12: six reconciliations");
    assert!(run.search.failure().is_none());
}

/// E-63, E-64: older skills are tested before the new one, each with the least that may be left of what it scored
/// when it was encapsulated.
#[test]
fn older_skills_are_tested_again_against_what_they_scored_first() {
    let run = run(general(json!({ "retest_tolerance": 0.25 })));
    let baseline = |skill: &str| {
        let stage = run.stages.iter().find(|stage| stage.name == format!("{skill}: measure")).unwrap();
        let outcome = run.outcomes[&Place { stage: stage.number, generation: 1, index: 0 }].as_ref().unwrap();
        outcome.fitness
    };
    let strike = run.stages.iter().find(|stage| stage.name == "strike").unwrap();
    let tests = tested(strike);
    assert_eq!(tests.len(), 4);
    for (test, skill) in tests.iter().zip(["forward_locomotion", "left_turn", "right_turn"]) {
        assert_eq!(test.0, skill);
        assert!((test.1.unwrap() - 0.75 * baseline(skill)).abs() < 1e-12, "{skill}");
    }
    assert_eq!(tests[3], ("strike", None));
    // retests end with the leaf skills.
    for stage in run.stages.iter().skip_while(|stage| stage.name != "turn_to_light") {
        assert!(stage.name.ends_with("measure") || tested(stage).len() == 1, "{}", stage.name);
    }
}

/// E-37, E-63: who has lost too much is no parent, no elite and no candidate; counted by what was lost (E-69).
#[test]
fn who_has_lost_an_older_skill_does_not_go_on() {
    let run = run(general(json!({})));
    let stopped = |place: &Place| learned::stopped_by(run.outcomes[place].as_ref().unwrap()).is_some();
    let mut fresh = 0;
    for stage in
        run.stages.iter().filter(|stage| ["left_turn", "right_turn", "strike"].contains(&stage.name.as_str()))
    {
        for (place, individual) in run.of(stage.number) {
            let parents = individual.parents.iter().filter(|parent| parent.place.stage == stage.number);
            assert!(parents.clone().all(|parent| !stopped(&parent.place)), "{place:?}");
            fresh += usize::from(stopped(place) && individual.inherits.is_none());
        }
    }
    assert!(fresh > 10, "made-up bodies often lose what they knew: {fresh}");
    for choice in &run.picks {
        assert!(choice.candidates.iter().all(|candidate| !stopped(&candidate.place)));
    }
    let counted: u64 = ["forward_locomotion", "left_turn", "right_turn"]
        .iter()
        .map(|skill| run.sum(&format!("stopped_by.{skill}")))
        .sum();
    assert_eq!(counted, fresh as u64);
    let notes = &run.picks[1].candidates[0].notes;
    assert!(
        notes.contains_key("score.forward_locomotion") && notes.contains_key("baseline.forward_locomotion")
    );
}

/// E-64, E-66: the unchanged creature passes every test of what it knows, so that a stage never ends without anyone.
#[test]
fn the_creature_from_which_a_stage_starts_passes_by_definition() {
    let run = run(general(json!({})));
    for stage in
        run.stages.iter().filter(|stage| ["left_turn", "right_turn", "strike"].contains(&stage.name.as_str()))
    {
        for population in 0..2 {
            let place = Place { stage: stage.number, generation: 1, index: 6 * population };
            assert_eq!(learned::stopped_by(run.outcomes[&place].as_ref().unwrap()), None, "{}", stage.name);
        }
    }
}

/// E-67: the older skill's control alone changes, it never gets worse, and it is locked again.
#[test]
fn reconciliation_changes_one_control_and_never_makes_it_worse() {
    let run = run(general(json!({ "reconcile_generations": 4 })));
    for stage in run.stages.iter().filter(|stage| stage.name.contains("reconcile")) {
        let older = stage.name.rsplit(' ').next().unwrap();
        let skills = stage.task.as_ref().unwrap()["skill"].as_array().unwrap();
        let older = SkillId(skills.iter().position(|skill| skill["id"] == older).unwrap() as u16);
        let first = Place { stage: stage.number, generation: 1, index: 0 };
        let unchanged = run.genotype(first);
        let fitness = |place: &Place| run.outcomes[place].as_ref().unwrap().fitness;
        for (place, _) in run.of(stage.number) {
            let genotype = run.genotype(*place);
            assert_eq!(genotype.body, unchanged.body);
            for (control, before) in genotype.brain.controls.iter().zip(&unchanged.brain.controls) {
                assert!(control.skill == older || control == before, "{}", stage.name);
            }
        }
        let best = run.of(stage.number).map(|(place, _)| fitness(place)).fold(0.0, f64::max);
        let last: Vec<_> = run.of(stage.number).filter(|(place, _)| place.generation == 4).collect();
        assert_eq!(last.iter().map(|(place, _)| fitness(place)).fold(0.0, f64::max), best);
        assert!(best >= fitness(&first));
        // The next stage starts from it.
        let next = run.of(stage.number + 1).next().unwrap();
        let parent = next.1.parents[0].place;
        assert_eq!((parent.stage, fitness(&parent)), (stage.number, best));
        let goes_on = run.genotype(*next.0);
        let mut picked = run.genotype(parent);
        picked.encapsulate(older);
        assert_eq!(goes_on.body, picked.body);
        assert_eq!(goes_on.brain.control(older).unwrap(), picked.brain.control(older).unwrap());
    }
}

/// EF-15
#[test]
fn a_population_that_always_fails_its_retests_is_warned_of_and_goes_on() {
    let plan = settings(general(json!({ "generations": 8 })));
    let mut run = Run::new(plan.start(7, 0));
    while run.search.stage().name != "left_turn" {
        run.step();
    }
    // The first generation is told.
    for generation in 2..=8 {
        let asked = run.search.ask();
        let task = run.search.stage().task.unwrap();
        let stop = |individual: &Individual| {
            let mut outcome = examine(&individual.genotype, &task);
            if individual.inherits.is_none() {
                outcome.fitness = 0.0;
                outcome.measures.retain(|(name, _)| name != "stopped_by");
                outcome.measures.push(("stopped_by".to_owned(), 0.0));
            }
            Some(outcome)
        };
        let outcomes: Vec<_> = asked.iter().map(stop).collect();
        let notes = run.search.tell(&outcomes).notes;
        assert_eq!(notes.contains_key("warning.1"), generation >= 6, "{generation}: {notes:?}");
    }
    assert!(run.search.failure().is_none());
    assert!(!run.search.choice().unwrap().candidates.is_empty());
}

/// E-68: a leaf skill after one that is none opens the body only if it says so, and then all are reconciled.
#[test]
fn a_late_leaf_skill_that_opens_the_body_reconciles_all_earlier_ones() {
    let mut table = ten_skills(general(json!({ "generations": 2 })));
    table["skill"] = json!([
        { "id": "walk", "fitness": { "kind": "locomotion" } },
        { "id": "see", "uses": ["walk"], "grow": ["photoreceptors"], "fitness": { "kind": "face_light" } },
        { "id": "jump", "body": "evolve", "fitness": { "kind": "high_reach" } },
    ]);
    table["pandemonium"] = json!([]);
    // General mode takes leaf skills first; a late one is one that was appended to a finished syllabus.
    let short = {
        let mut short = table.clone();
        short["skill"].as_array_mut().unwrap().pop();
        Settings::read(short).unwrap()
    };
    let first = Run::new(short.start(7, 0)).finish();
    let plan = Settings::read(table).unwrap();
    let added = plan.amend(&first.search.checkpoint()).unwrap();
    assert_eq!(added.iter().map(ToString::to_string).collect::<Vec<_>>(), ["skill `jump` is new"]);
    let mut run = Run { search: plan.restore(7, 0, &first.search.checkpoint()).unwrap(), ..first };
    while run.step() {}
    assert_eq!(
        names(&run.stages)[4..],
        ["jump", "jump: reconcile walk", "jump: reconcile see", "jump: measure"]
    );
    assert_eq!(tested(&run.stages[4]).len(), 3);
}

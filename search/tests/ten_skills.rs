//! The ten skills of `fight-or-flight.toml` learned by real creatures, small and short, in both modes (ESP E-92): what
//! a stage may not change, it has not changed, to the bit.

use creatures::{Nobody, Outcome, Task};
use search::{Experiment, Overrides, Place};
use std::collections::BTreeMap;

const TEXT: &str = include_str!("../../experiments/fight-or-flight.toml");

/// What was measured at the end of each skill: its name, what the picked candidate had scored, and the scores of all
/// learned skills.
type Measurements = Vec<(String, f64, BTreeMap<String, f64>)>;

/// Runs the syllabus to its end.
fn learn(mode: &str) -> Measurements {
    let set = vec![("search.mode".to_owned(), mode.to_owned())];
    let over = Overrides { profile: Some("smoke".to_owned()), set };
    let experiment = Experiment::parse(TEXT, &over).expect("the file is legal").remove(0);
    let system = creatures::system("esp").expect("there is such a system");
    let mut search = experiment.start(1);
    let (mut told, mut fitness) = (Measurements::new(), f64::NAN);
    let mut outcomes: BTreeMap<Place, Outcome> = BTreeMap::new();
    let (mut stage, mut generation) = (None, 0);
    loop {
        // As after a kill between any two generations (E-85).
        search = experiment.restore(1, &search.checkpoint()).expect("its own checkpoint is understood");
        let asked = search.ask();
        if asked.is_empty() {
            let Some(choice) = search.choice() else { break };
            fitness = choice.candidates[0].fitness;
            search.pick(choice.candidates[0].place).expect("it is a candidate");
            continue;
        }
        let now = search.stage();
        generation = if stage == Some(now.number) { generation + 1 } else { 1 };
        stage = Some(now.number);
        let text = now.task.expect("a stage of a syllabus has a task").to_string();
        let task: Box<dyn Task> = system.task(&text).expect("the task is legal");
        let mut all = Vec::new();
        for (index, individual) in (0..).zip(asked) {
            let place = Place { stage: now.number, generation, index };
            let outcome = match individual.inherits {
                Some(from) => outcomes[&from].clone(),
                None => task
                    .evaluate(&individual.genotype, 1, None, &mut Nobody)
                    .expect("the search asks for legal creatures"),
            };
            outcomes.insert(place, outcome.clone());
            all.push(Some(outcome));
        }
        search.tell(&all);
        if let Some(skill) = now.name.strip_suffix(": measure") {
            let measures = &all[0].as_ref().expect("it was evaluated").measures;
            let scores =
                measures.iter().filter_map(|(name, score)| Some((name.strip_prefix("score.")?, score)));
            let scores = scores.map(|(name, score)| (name.to_owned(), *score)).collect();
            told.push((skill.to_owned(), fitness, scores));
        }
    }
    assert_eq!(search.failure(), None);
    told
}

/// E-48, E-59, T-13: what is encapsulated scores what it scored before, and in Fast mode for good.
#[test]
fn in_fast_mode_every_skill_scores_for_good_what_it_scored_when_it_was_picked() {
    let told = learn("fast");
    assert_eq!(told.len(), 10);
    let mut first: BTreeMap<String, u64> = BTreeMap::new();
    for (skill, picked, scores) in &told {
        assert_eq!(scores[skill].to_bits(), picked.to_bits(), "{skill} after encapsulation");
        first.insert(skill.clone(), picked.to_bits());
        for (known, score) in scores {
            assert_eq!(score.to_bits(), first[known], "{known} once {skill} is learned");
        }
        assert_eq!(scores.len(), first.len());
    }
}

/// E-64, E-67: the new skill scores after reconciliation what it scored before, and no older one has lost more than
/// it may.
#[test]
fn in_general_mode_no_skill_loses_more_than_it_may() {
    let told = learn("general");
    assert_eq!(told.len(), 10);
    let order: Vec<&str> = told.iter().map(|(skill, _, _)| skill.as_str()).collect();
    assert_eq!(order[..4], ["forward_locomotion", "left_turn", "right_turn", "strike"]);
    let mut baselines: BTreeMap<String, f64> = BTreeMap::new();
    for (skill, picked, scores) in &told {
        assert_eq!(scores[skill].to_bits(), picked.to_bits(), "{skill} after reconciliation");
        baselines.insert(skill.clone(), scores[skill]);
        for (known, score) in scores {
            let baseline = baselines[known];
            assert!(*score >= baseline - 0.2 * baseline.abs(), "{known} once {skill} is learned: {score}");
        }
    }
}

use super::*;

/// The lineage was read at the end of a stage, the driver a moment later, in the next one.
#[test]
fn a_stage_that_has_just_begun_shows_no_generation_of_the_one_before() {
    let old = v1::Run {
        run: 1,
        stage_name: "walk".into(),
        generation: 40,
        generations: 40,
        done: 20,
        size: 20,
        best: Some(0.75),
        best_individual: 800,
        finished: true,
        ..Default::default()
    };
    let mut rendered = v1::Experiment { progress: vec![old], ..Default::default() };
    let live = Live {
        stage: 1,
        stage_name: "turn".into(),
        generation: 1,
        generations: Some(60),
        size: 30,
        done: 4,
        ..Default::default()
    };
    bring_up_to_date(&mut rendered, &[live]);
    let expected = v1::Run {
        run: 1,
        stage: 1,
        stage_name: "turn".into(),
        generation: 1,
        generations: 60,
        size: 30,
        done: 4,
        ..Default::default()
    };
    assert_eq!(rendered.progress, [expected]);
}

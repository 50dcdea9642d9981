//! How a genotype that kills its workers is told from its neighbours, and what becomes of it.

use super::rig::Op::*;
use super::rig::{HEARTBEAT, PAROLE, Rig, outcome};
use super::tests::{A, B, C, D, fate, fates};

#[test]
fn a_genotype_that_kills_three_workers_is_set_aside() {
    let rig = Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Lose(A),
        Join(B),
        Lose(B),
        Join(C),
        Holds(C, &[0]),
        Lose(C),
        Join(D),
        Advance(PAROLE),
        Holds(D, &[]),
        SetAside(&[]),
        Advance(HEARTBEAT),
        SetAside(&[0]),
    ]);
    let reason = &rig.settled[&0].result.as_ref().unwrap_err().reason;
    assert_eq!(reason, "three attempts ended badly (A: stream broke; B: stream broke; C: stream broke)");
}

#[test]
fn the_neighbours_of_a_genotype_that_kills_are_not_set_aside() {
    let rig = Rig::new().run(&[
        Submit(0, 2),
        JoinWith(A, 2, 2),
        Lose(A),
        JoinWith(B, 2, 2),
        Holds(B, &[0, 1]),
        Lose(B),
        // Both are suspects now: each gets a worker for itself alone.
        JoinWith(C, 2, 2),
        Holds(C, &[0]),
        Lose(C),
        Join(D),
        Holds(D, &[1]),
        Advance(PAROLE + HEARTBEAT),
        SetAside(&[0]),
        Report(D, 1),
        Settled(&[0, 1]),
        SetAside(&[0]),
    ]);
    assert_eq!(rig.settled[&1].result, Ok(outcome(1)));
}

#[test]
fn a_suspect_waits_until_its_worker_is_empty_and_nothing_joins_it() {
    Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Lose(A),
        Join(B),
        Lose(B),
        Pause(0),
        Open(1),
        JoinWith(C, 2, 4),
        Submit(1, 5),
        Holds(C, &[1, 2, 3, 4]),
        Resume(0),
        Report(C, 1),
        Report(C, 2),
        Report(C, 3),
        Holds(C, &[4]),
        Report(C, 4),
        Holds(C, &[0]),
        Report(C, 0),
        Holds(C, &[5]),
    ]);
}

#[test]
fn what_had_not_begun_is_not_suspected() {
    let rig = Rig::new().run(&[
        Submit(0, 3),
        Join(A),
        Lose(A),
        Join(B),
        Lose(B),
        Join(C),
        Lose(C),
        Join(D),
        Holds(D, &[1, 2]),
        Report(D, 1),
        Report(D, 2),
        Advance(PAROLE + HEARTBEAT),
        SetAside(&[0]),
    ]);
    // 1 waited behind 0 on A and B, and began nowhere but on D.
    let reasons: Vec<_> = fates(&rig, 1).into_iter().map(|(_, worker, _)| worker).collect();
    assert_eq!(reasons, ["A", "B", "D"]);
}

#[test]
fn a_worker_that_comes_back_with_an_evaluation_clears_it() {
    Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Lose(A),
        Back(A),
        Lose(A),
        Back(A),
        Lose(A),
        Back(A),
        Lose(A),
        Back(A),
        SetAside(&[]),
        Report(A, 0),
        Settled(&[0]),
    ]);
}

#[test]
fn an_evaluation_that_was_cleared_may_be_tried_twice_as_any_straggler() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 4),
        Report(A, 0),
        Report(A, 1),
        Report(A, 2),
        Lose(A),
        Back(A),
        Join(B),
        Advance(HEARTBEAT),
        Holds(A, &[3]),
        Holds(B, &[3]),
    ]);
}

#[test]
fn what_may_have_ended_a_worker_is_not_risked_on_two() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 4),
        Report(A, 0),
        Report(A, 1),
        Report(A, 2),
        Lose(A),
        Join(B),
        Join(C),
        Advance(HEARTBEAT),
        Holds(B, &[3]),
        Holds(C, &[]),
    ]);
}

#[test]
fn the_third_strike_falls_only_on_a_worker_of_its_own() {
    Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Lose(A),
        Join(B),
        Lose(B),
        Join(C),
        Holds(C, &[0]),
        // A is cleared, and runs it beside C without having been emptied for it.
        Back(A),
        Holds(A, &[0]),
        Lose(C),
        Lose(A),
        Join(D),
        Holds(D, &[0]),
        Lose(D),
        Join('E'),
        Advance(PAROLE + HEARTBEAT),
        SetAside(&[0]),
    ]);
}

#[test]
fn once_others_stand_in_the_place_of_those_that_ended_it_is_certain() {
    Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Lose(A),
        Join(B),
        Lose(B),
        Join(C),
        Lose(C),
        Join(A),
        Join(B),
        SetAside(&[]),
        Join(C),
        SetAside(&[0]),
    ]);
}

#[test]
fn nobody_is_set_aside_while_a_worker_is_at_it() {
    let three =
        [Submit(0, 1), Join(D), Leave(D), Join(A), Lose(A), Join(B), Lose(B), Join(C), Back(D), Lose(C)];
    let others = [Join(A), Join(B), Join(C), Holds(D, &[0]), SetAside(&[])];
    let certain = || Rig::new().run(&three).run(&others);
    certain().run(&[Report(D, 0), Settled(&[0]), SetAside(&[])]);
    certain().run(&[Lose(D), SetAside(&[0])]);
}

#[test]
fn the_end_of_a_worker_that_drains_is_held_against_nobody() {
    let once = [Join(A), Drain(A), Lose(A)];
    let rig = Rig::new().run(&[Submit(0, 1)]).run(&once).run(&once).run(&once).run(&once);
    rig.run(&[Join(B), Report(B, 0), Settled(&[0]), SetAside(&[])]);
}

#[test]
fn nobody_comes_back_to_a_coordinator_that_is_cut_off() {
    Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Lose(A),
        Join(B),
        Lose(B),
        Join(C),
        Lose(C),
        Advance(10 * PAROLE),
        SetAside(&[]),
        Back(C),
        Report(C, 0),
        Settled(&[0]),
        SetAside(&[]),
    ]);
}

#[test]
fn a_process_that_comes_back_was_not_ended_by_what_it_holds_no_more() {
    let once = [Lose(A), Return(A), Holds(A, &[0])];
    let rig = Rig::new().run(&[Join(A), Submit(0, 1)]).run(&once).run(&once).run(&once).run(&once);
    rig.run(&[SetAside(&[]), Report(A, 0), Settled(&[0])]);
}

#[test]
fn whoever_comes_back_in_time_clears_what_was_about_to_be_set_aside() {
    let three = [Submit(0, 1), Join(A), Lose(A), Join(B), Lose(B), Join(C), Lose(C)];
    let lost = || Rig::new().run(&three).run(&[Join(D), Advance(PAROLE / 2), Holds(D, &[])]);
    lost().run(&[Return(B), Holds(D, &[0]), Report(D, 0), Settled(&[0]), SetAside(&[])]);
    lost().run(&[Back(B), Holds(B, &[0]), Report(B, 0), Settled(&[0]), SetAside(&[])]);
    let rig = lost().run(&[Jump(100 * PAROLE), SetAside(&[]), Return(B), Holds(D, &[0])]);
    assert_eq!(rig.scheduler.summary().condemned, 0, "nobody could come back while nobody listened");
}

#[test]
fn a_late_outcome_acquits() {
    Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Lose(A),
        Join(B),
        Lose(B),
        Join(C),
        Silence(C),
        Join(D),
        Advance(PAROLE),
        Holds(D, &[]),
        SetAside(&[]),
        Back(C),
        Report(C, 0),
        Settled(&[0]),
        SetAside(&[]),
    ]);
}

#[test]
fn a_failure_is_tried_again_elsewhere_and_the_third_one_sets_aside() {
    let rig = Rig::new().run(&[
        Submit(0, 1),
        Join(A),
        Join(B),
        Fail(A, false),
        Holds(B, &[0]),
        Fail(B, false),
        Holds(A, &[0]),
        Fail(A, false),
        SetAside(&[0]),
    ]);
    assert_eq!(
        fates(&rig, 0),
        [fate(1, A, "failed:it broke"), fate(2, B, "failed:it broke"), fate(3, A, "failed:it broke")]
    );
}

#[test]
fn a_lasting_failure_sets_aside_at_once() {
    let rig = Rig::new().run(&[Submit(0, 1), Join(A), Fail(A, true), SetAside(&[0])]);
    assert_eq!(rig.settled[&0].result.as_ref().unwrap_err().reason, "it broke");
}

#[test]
fn a_worker_that_fails_everything_takes_nobody_down() {
    let mut rig = Rig::new().run(&[Join(A), JoinWith(B, 1, 1), Submit(0, 20)]);
    for _ in 0..200 {
        rig.apply(&Fail(A, false));
        rig.apply(&ReportFirst(B));
    }
    rig.apply(&SetAside(&[]));
    assert_eq!(rig.settled.len(), 20);
}

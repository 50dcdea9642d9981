//! How audits find a worker that lies, and what becomes of it and of what it said.

use super::WorkerState;
use super::audit::ALONE_MS;
use super::rig::Op::*;
use super::rig::{HEARTBEAT, Op, PAROLE, Rig, TIMEOUT, outcome};
use super::tests::{A, B, C, D, fate, fates};
use crate::lineage::{Audited, Fate};
use proptest::prelude::*;

/// A rig in which everything is audited.
fn audited() -> Rig {
    let mut rig = Rig::new();
    rig.audit = true;
    rig
}

fn state(rig: &Rig, name: char) -> WorkerState {
    let workers = rig.scheduler.workers();
    workers.iter().find(|worker| worker.name == name.to_string()).expect("it was attached").state
}

#[test]
fn an_audited_evaluation_counts_once_another_worker_finds_the_same() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 1),
        Report(A, 0),
        Settled(&[]),
        Holds(A, &[]),
        Join(B),
        Holds(B, &[0]),
        Report(B, 0),
        Settled(&[0]),
    ]);
    assert_eq!(fates(&rig, 0), [fate(1, A, "counted"), fate(2, B, "confirmed")]);
    assert_eq!(rig.settled[&0].audit, Some(Audited::Agreed));
    assert!(rig.quarantined.is_empty());
}

#[test]
fn what_was_not_chosen_counts_at_once() {
    let rig = Rig::new().run(&[Join(A), Join(B), Submit(0, 1), Report(A, 0), Settled(&[0])]);
    assert_eq!(rig.settled[&0].audit, None);
}

#[test]
fn a_third_worker_decides_and_the_liar_gets_nothing_more() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 1),
        Lie(A),
        Join(B),
        Report(B, 0),
        Settled(&[]),
        Submit(0, 3),
        Holds(A, &[1, 3]),
        Holds(B, &[2]),
        Join(C),
        Holds(C, &[0]),
        Report(C, 0),
        Settled(&[0]),
        Holds(A, &[]),
        Holds(B, &[2, 3]),
        Holds(C, &[1]),
    ]);
    assert_eq!(fates(&rig, 0), [fate(1, A, "refuted"), fate(2, B, "counted"), fate(3, C, "confirmed")]);
    assert_eq!(rig.settled[&0].result, Ok(outcome(0)));
    let [verdict] = &rig.quarantined[..] else { panic!("one liar: {:?}", rig.quarantined) };
    assert_eq!((&*verdict.worker, verdict.evaluation), ("A", 0));
    assert_eq!(verdict.witnesses, ["B", "C"]);
    assert_ne!(verdict.found, verdict.against);
    assert_eq!(state(&rig, A), WorkerState::Quarantined);
    // Its leases were no fault of the evaluations.
    let rig = rig.run(&[Report(B, 2), Report(C, 1), Report(C, 2), Report(B, 3), Report(B, 1), Report(C, 3)]);
    assert_eq!(fates(&rig, 1)[0], fate(1, A, "lost:worker quarantined"));
    assert_eq!(rig.settled.len(), 4);
}

#[test]
fn two_that_differ_wait_for_a_third_however_long() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 1),
        Lie(A),
        Join(B),
        Report(B, 0),
        Lose(A),
        Advance(4 * ALONE_MS),
        Settled(&[]),
    ]);
    assert_eq!((rig.scheduler.summary().disputed, rig.scheduler.summary().ready), (1, 1));
    let rig = rig.run(&[Join(C), Report(C, 0), Settled(&[0])]);
    assert_eq!(rig.settled[&0].result, Ok(outcome(0)));
    // It was gone before it was found out, and is known when it comes back.
    assert_eq!(state(&rig, A), WorkerState::Gone);
    let rig = rig.run(&[Join(A), Leave(B), Leave(C), Submit(0, 1), Holds(A, &[])]);
    assert_eq!(state(&rig, A), WorkerState::Quarantined);
}

#[test]
fn a_worker_alone_counts_unaudited_once_it_has_been_alone_for_a_while() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 1),
        Report(A, 0),
        Advance(ALONE_MS - HEARTBEAT),
        Settled(&[]),
        Advance(2 * HEARTBEAT),
        Settled(&[0]),
        // Nobody has come since, so nothing more is waited for.
        Submit(0, 1),
        Report(A, 1),
        Settled(&[0, 1]),
        Join(B),
        Submit(0, 1),
        Report(A, 2),
        Leave(B),
        Settled(&[0, 1]),
    ]);
    assert_eq!(rig.settled[&0].audit, Some(Audited::Skipped));
    assert_eq!(fates(&rig, 0), [fate(1, A, "counted")]);
}

#[test]
fn a_worker_that_comes_after_another_has_left_audits_it() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 1),
        Report(A, 0),
        Leave(A),
        Advance(4 * ALONE_MS),
        Settled(&[]),
        Join(B),
        Report(B, 0),
        Settled(&[0]),
    ]);
    assert_eq!(rig.settled[&0].audit, Some(Audited::Agreed));
}

#[test]
fn the_word_of_a_liar_on_what_is_open_is_dropped() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 2),
        Lie(A),
        // True or not, nobody can tell.
        Report(A, 1),
        Join(B),
        Holds(B, &[0, 1]),
        Report(B, 0),
        Join(C),
        Report(C, 0),
        Settled(&[0]),
        Report(B, 1),
        Settled(&[0]),
        Report(C, 1),
        Settled(&[0, 1]),
    ]);
    let told = [fate(1, A, "lost:worker quarantined"), fate(2, B, "counted"), fate(3, C, "confirmed")];
    assert_eq!(fates(&rig, 1), told);
    assert_eq!(rig.quarantined.len(), 1, "one verdict a liar");
}

#[test]
fn a_paused_queue_hands_out_no_audits() {
    audited().run(&[
        Join(A),
        Submit(0, 1),
        Pause(0),
        Report(A, 0),
        Join(B),
        Holds(B, &[]),
        Resume(0),
        Holds(B, &[0]),
    ]);
}

#[test]
fn that_an_evaluation_is_impossible_is_an_opinion_as_well() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 2),
        Fail(A, true),
        Fail(A, true),
        Settled(&[]),
        Join(B),
        Fail(B, true),
        SetAside(&[0]),
        Report(B, 1),
        Join(C),
        Report(C, 1),
        SetAside(&[0]),
        Settled(&[0, 1]),
    ]);
    assert_eq!(rig.settled[&0].audit, Some(Audited::Agreed));
    assert_eq!(rig.quarantined.iter().map(|verdict| &*verdict.worker).collect::<Vec<_>>(), ["A"]);
}

#[test]
fn one_on_which_two_workers_differ_waits_for_a_third_whoever_is_lost_meanwhile() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 1),
        Lie(A),
        Join(B),
        Report(B, 0),
        Join(C),
        Lose(C),
        Join(C),
        Lose(C),
        Join(C),
        Lose(C),
        Join(C),
        Lose(C),
        Advance(2 * PAROLE),
        Settled(&[]),
        Join(C),
        Report(C, 0),
        Settled(&[0]),
        SetAside(&[]),
    ]);
    assert_eq!(rig.quarantined.iter().map(|verdict| &*verdict.worker).collect::<Vec<_>>(), ["A"]);
}

#[test]
fn one_that_a_worker_lived_through_counts_when_nobody_else_does() {
    let rig = audited().run(&[
        Join(A),
        Submit(0, 1),
        Report(A, 0),
        Join(B),
        Lose(B),
        Join(C),
        Lose(C),
        Join(D),
        Lose(D),
        Settled(&[]),
        Advance(PAROLE + HEARTBEAT),
        Settled(&[0]),
    ]);
    assert_eq!(rig.settled[&0].audit, Some(Audited::Skipped));
    assert_eq!(rig.settled[&0].result, Ok(outcome(0)));
}

#[test]
fn a_straggling_audit_is_tried_by_others_than_those_who_have_an_opinion() {
    audited().run(&[
        Join(A),
        Join(B),
        Submit(0, 3),
        Report(A, 0),
        Report(A, 2),
        Report(B, 1),
        Report(A, 1),
        Report(B, 0),
        Report(B, 2),
        Settled(&[0, 1, 2]),
        Submit(0, 1),
        Report(A, 3),
        Holds(B, &[3]),
        Advance(HEARTBEAT),
        // It runs for longer than twice the median of 10 ms, and A is idle, but has had its say.
        Holds(A, &[]),
        Join(C),
        Advance(HEARTBEAT),
        Holds(C, &[3]),
    ]);
}

#[test]
fn an_audit_takes_the_worker_that_was_being_emptied_for_a_queue_that_pauses() {
    audited().run(&[
        Open(1),
        Submit(0, 1),
        JoinWith(A, 1, 1),
        Lose(A),
        JoinWith(B, 1, 1),
        JoinWith(C, 1, 2),
        Submit(1, 1),
        JoinWith(D, 1, 1),
        Submit(1, 1),
        Holds(C, &[1]),
        Holds(D, &[2]),
        // A suspect, for which C is emptied.
        Lose(B),
        Report(D, 2),
        Holds(C, &[1]),
        Pause(0),
        Holds(C, &[1, 2]),
    ]);
}

#[test]
fn a_cancelled_queue_leaves_no_audits() {
    let rig = audited().run(&[Join(A), Submit(0, 2), Report(A, 0), Cancel(0), Join(B), Holds(B, &[])]);
    assert_eq!(rig.scheduler.summary().ready, 0);
}

fn op() -> impl Strategy<Value = Op> {
    let name = || prop::sample::select(&[A, B, C, D][..]);
    prop_oneof![
        3 => (name(), 1..3u32, 1..5u32).prop_map(|(name, slots, window)| JoinWith(name, slots, window)),
        2 => name().prop_map(Back),
        4 => (0..2usize, 1..6u32).prop_map(|(queue, count)| Submit(queue, count)),
        1 => (0..2usize).prop_map(Pause),
        2 => (0..2usize).prop_map(Resume),
        12 => name().prop_map(ReportFirst),
        3 => prop::sample::select(&[A, D][..]).prop_map(Lie),
        1 => name().prop_map(ReportTwice),
        2 => name().prop_map(Lose),
        1 => name().prop_map(Leave),
        1 => name().prop_map(Drain),
        1 => name().prop_map(Silence),
        3 => (1..3 * HEARTBEAT).prop_map(Advance),
        1 => (TIMEOUT..2 * ALONE_MS).prop_map(Advance),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    /// Whatever A and D say, and whenever: what two workers agreed on is true, and nobody honest is blamed.
    #[test]
    fn what_an_audit_confirms_is_true_and_the_honest_are_never_blamed(ops in prop::collection::vec(op(), 1..250)) {
        let mut rig = Rig::new().run(&[Open(2)]);
        rig.audit = true;
        let rig = rig.run(&ops).finish();
        for (id, settled) in &rig.settled {
            if settled.audit == Some(Audited::Agreed) {
                let confirmed = settled.attempts.iter().filter(|attempt| attempt.fate == Fate::Confirmed);
                prop_assert!(confirmed.count() >= 1);
                prop_assert_eq!(&settled.result, &Ok(outcome(*id)));
            }
        }
        for verdict in &rig.quarantined {
            prop_assert!(["A", "D"].contains(&&*verdict.worker), "{} is honest", verdict.worker);
        }
    }
}

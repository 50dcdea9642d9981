//! What the scheduler does, as lists of operations.

use super::rig::Op::*;
use super::rig::{HEARTBEAT, OVERDUE, Rig, TIMEOUT, outcome};
use super::*;
use crate::lineage::Fate;
use creatures::{Cull, Interim, Outcome, Status, Verdict};

pub(super) const A: char = 'A';
pub(super) const B: char = 'B';
pub(super) const C: char = 'C';
pub(super) const D: char = 'D';

pub(super) fn fates(rig: &Rig, evaluation: u64) -> Vec<(u32, String, String)> {
    let attempts = rig.settled[&evaluation].attempts.iter();
    attempts.map(|attempt| (attempt.number, attempt.worker.clone(), attempt.fate.word())).collect()
}

pub(super) fn fate(number: u32, worker: char, fate: &str) -> (u32, String, String) {
    (number, worker.to_string(), fate.to_owned())
}

#[test]
fn evaluations_go_out_in_order_up_to_the_window_and_a_report_asks_for_more() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 4),
        Holds(A, &[0, 1]),
        Report(A, 0),
        Holds(A, &[1, 2]),
        Window(A, 3),
        Holds(A, &[1, 2, 3]),
        Window(A, 1),
        Report(A, 1),
        Submit(0, 1),
        Holds(A, &[2, 3]),
        Report(A, 2),
        Report(A, 3),
        Holds(A, &[4]),
        Settled(&[0, 1, 2, 3]),
    ]);
}

#[test]
fn the_least_loaded_worker_is_served_first() {
    Rig::new().run(&[
        JoinWith(A, 4, 8),
        JoinWith(B, 1, 8),
        Submit(0, 6),
        Holds(A, &[0, 2, 3, 4, 5]),
        Holds(B, &[1]),
    ]);
}

/// Fishes AF-16.
#[test]
fn a_dead_worker_costs_time_and_nothing_else() {
    let rig = Rig::new().run(&[
        Join(A),
        Submit(0, 3),
        Join(B),
        Holds(A, &[0, 1]),
        Holds(B, &[2]),
        Lose(A),
        Holds(B, &[2, 0]),
        Report(B, 2),
        Report(B, 0),
        Report(B, 1),
        Settled(&[0, 1, 2]),
    ]);
    assert_eq!(fates(&rig, 0), [fate(1, A, "lost:stream broke"), fate(2, B, "counted")]);
    assert_eq!(rig.settled[&0].result, Ok(outcome(0)));
}

/// Walker X-18.
#[test]
fn a_silent_worker_loses_its_leases_after_the_timeout_and_not_before() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 1),
        Silence(A),
        Advance(TIMEOUT),
        Holds(A, &[0]),
        Join(B),
        Advance(HEARTBEAT),
        Holds(B, &[0]),
        Report(B, 0),
        Settled(&[0]),
    ]);
}

#[test]
fn heartbeats_keep_a_lease_for_ever_but_not_that_of_an_evaluation_that_hangs() {
    let rig = Rig::new().run(&[
        Join(A),
        Submit(0, 2),
        Advance(OVERDUE),
        Holds(A, &[0, 1]),
        Advance(HEARTBEAT),
        Join(B),
        Holds(B, &[0, 1]),
        // It still runs there, and is not wanted from that worker again.
        Back(A),
        Holds(A, &[]),
        Report(B, 0),
        Report(B, 1),
    ]);
    assert_eq!(fates(&rig, 0), [fate(1, A, "lost:overdue"), fate(2, B, "counted")]);
}

#[test]
fn nobody_is_silent_while_nobody_listens() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 1),
        Jump(2 * OVERDUE),
        Holds(A, &[0]),
        Silence(A),
        Advance(TIMEOUT + HEARTBEAT),
        Join(B),
        Holds(B, &[0]),
    ]);
}

#[test]
fn coming_back_is_no_way_to_run_for_ever() {
    let half = [Advance(OVERDUE / 2 + HEARTBEAT), Lose(A), Back(A)];
    let rig = Rig::new().run(&[Join(A), Submit(0, 1)]).run(&half).run(&[Holds(A, &[0])]);
    rig.run(&half[..1]).run(&[Join(B), Holds(B, &[0])]);
}

#[test]
fn a_worker_that_comes_back_goes_on_with_what_it_ran() {
    let rig = Rig::new().run(&[
        Join(A),
        Submit(0, 2),
        Lose(A),
        Back(A),
        Holds(A, &[0, 1]),
        Report(A, 0),
        Report(A, 1),
        Settled(&[0, 1]),
    ]);
    assert_eq!(fates(&rig, 0), [fate(1, A, "counted")]);
    assert_eq!(fates(&rig, 1), [fate(1, A, "lost:stream broke"), fate(2, A, "counted")]);
}

#[test]
fn a_lease_that_was_handed_on_meanwhile_is_restored_beside_and_the_first_outcome_wins() {
    let rig = Rig::new().run(&[
        Join(A),
        Submit(0, 1),
        Lose(A),
        Join(B),
        Holds(B, &[0]),
        Back(A),
        Holds(A, &[0]),
        Report(A, 0),
        Holds(B, &[]),
        Settled(&[0]),
    ]);
    assert_eq!(fates(&rig, 0), [fate(1, A, "counted"), fate(2, B, "duplicate")]);
}

#[test]
fn what_a_worker_holds_in_vain_is_revoked() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 1),
        Lose(A),
        Join(B),
        Report(B, 0),
        Back(A),
        Holds(A, &[]),
        Settled(&[0]),
    ]);
}

/// Walker X-18, fishes AF-15.
#[test]
fn a_result_sent_twice_changes_nothing_and_one_of_other_bits_raises_an_alarm() {
    let rig = Rig::new().run(&[
        Join(A),
        Submit(0, 1),
        Lose(A),
        Join(B),
        Report(B, 0),
        ReportTwice(B),
        Conflicts(0),
        ReportOtherwise(B),
        Conflicts(1),
        Settled(&[0]),
    ]);
    let conflict = &rig.conflicts[0];
    assert_eq!((conflict.first.0.fitness, conflict.second.0.fitness), (0.0, 1.0));
    assert_eq!((&*conflict.first.1, &*conflict.second.1), ("B", "B"));
    assert_eq!(rig.settled[&0].result, Ok(outcome(0)), "the first one stands");
}

#[test]
fn a_late_outcome_of_a_lost_lease_settles_what_is_queued_again() {
    let mut rig = Rig::new().run(&[Join(A), Submit(0, 1), Lose(A), Join(A)]);
    rig.apply(&Pause(0));
    // Attached anew without holding anything, it got a new attempt; the pause came after that.
    rig.apply(&Holds(A, &[0]));
    rig.apply(&Lose(A));
    rig.apply(&Join(A));
    let late = AttemptId { evaluation: 0, number: 1 };
    rig.report(A, late, News::Outcome(outcome(0)));
    rig.round();
    assert_eq!(fates(&rig, 0)[0], fate(1, A, "counted"));
    rig.apply(&Resume(0));
    rig.apply(&Holds(A, &[]));
}

#[test]
fn a_report_on_an_attempt_of_somebody_else_changes_nothing() {
    let mut rig = Rig::new().run(&[Join(A), Submit(0, 1), Join(B)]);
    for attempt in [
        AttemptId { evaluation: 0, number: 1 },
        AttemptId { evaluation: 0, number: 2 },
        AttemptId { evaluation: 9, number: 1 },
    ] {
        rig.report(B, attempt, News::Outcome(outcome(0)));
        rig.round();
    }
    rig.apply(&Settled(&[]));
    rig.apply(&Holds(A, &[0]));
}

#[test]
fn stragglers_get_a_second_attempt_on_an_idle_slot_and_the_loser_is_revoked() {
    let rig = Rig::new().run(&[
        Join(A),
        Join(B),
        Submit(0, 5),
        Report(A, 0),
        Report(A, 2),
        Report(A, 4),
        Holds(A, &[]),
        Holds(B, &[1, 3]),
        Advance(HEARTBEAT),
        // 1 runs for longer than twice the median of 10 ms and 3 waits behind it: the older one is tried on
        // the idle slot, and then none is left.
        Holds(A, &[1]),
        Report(A, 1),
        Holds(B, &[3]),
        Report(B, 3),
        Settled(&[0, 1, 2, 3, 4]),
    ]);
    assert_eq!(fates(&rig, 1), [fate(1, B, "duplicate"), fate(2, A, "counted")]);
}

#[test]
fn nothing_is_tried_twice_while_there_is_something_else_to_do() {
    Rig::new().run(&[
        Join(A),
        Join(B),
        Submit(0, 3),
        Submit(0, 40),
        Report(A, 0),
        Report(A, 2),
        Report(A, 4),
        Advance(10 * HEARTBEAT),
        Holds(B, &[1, 3]),
    ]);
}

#[test]
fn queues_share_the_fleet_by_weight() {
    let mut rig = Rig::new().run(&[Open(3), Submit(0, 400), Submit(1, 400), JoinWith(A, 1, 1)]);
    for _ in 0..200 {
        rig.apply(&ReportFirst(A));
        let heavy = rig.handed.iter().filter(|id| **id >= 400).count() as f64;
        let light = rig.handed.len() as f64 - heavy;
        assert!((heavy / 3.0 - light).abs() <= 4.0 / 3.0, "{heavy} of weight 3 and {light} of weight 1");
    }
}

#[test]
fn a_queue_that_slept_hoards_no_claim() {
    let mut rig = Rig::new().run(&[Open(1), Submit(0, 100), JoinWith(A, 1, 1)]);
    (0..50).for_each(|_| rig.apply(&ReportFirst(A)));
    rig.apply(&Submit(1, 100));
    let before = rig.handed.len();
    (0..20).for_each(|_| rig.apply(&ReportFirst(A)));
    let late = rig.handed[before..].iter().filter(|id| **id >= 100).count();
    assert_eq!(late, 10);
}

#[test]
fn a_paused_queue_hands_out_nothing_and_delivers_what_runs() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 4),
        Pause(0),
        Report(A, 0),
        Report(A, 1),
        Holds(A, &[]),
        Settled(&[0, 1]),
        Resume(0),
        Holds(A, &[2, 3]),
    ]);
}

#[test]
fn a_cancelled_queue_gives_its_workers_back() {
    Rig::new().run(&[
        Join(A),
        Submit(0, 4),
        Open(1),
        Submit(1, 2),
        Cancel(0),
        Holds(A, &[4, 5]),
        Report(A, 4),
        Report(A, 5),
        Settled(&[4, 5]),
    ]);
}

#[test]
fn a_draining_worker_finishes_what_it_runs_and_gives_the_rest_back() {
    let rig = Rig::new().run(&[
        Join(A),
        Submit(0, 2),
        Drain(A),
        Holds(A, &[0]),
        Join(B),
        Holds(B, &[1]),
        Report(A, 0),
        Leave(A),
        Report(B, 1),
        Settled(&[0, 1]),
    ]);
    assert_eq!(fates(&rig, 1), [fate(1, A, "lost:returned"), fate(2, B, "counted")]);
}

#[test]
fn what_crossed_the_word_of_a_drain_is_given_back_by_hanging_up() {
    let rig = Rig::new().run(&[
        Join(A),
        Submit(0, 2), // on its way to A, which is idle and leaves
        DrainIdle(A),
        Leave(A),
        Join(B),
        Report(B, 0),
        Report(B, 1),
        Settled(&[0, 1]),
    ]);
    for evaluation in [0, 1] {
        assert_eq!(fates(&rig, evaluation), [fate(1, A, "lost:returned"), fate(2, B, "counted")]);
    }
    let gone = rig.scheduler.workers().into_iter().find(|worker| worker.name == "A").unwrap();
    assert_eq!((gone.state, gone.lost), (WorkerState::Gone, 0));
}

#[test]
fn a_name_is_taken_while_its_worker_is_alive() {
    let mut rig = Rig::new().run(&[Join(A), Submit(0, 1)]);
    let hello = Hello {
        name: "A".to_owned(),
        host: "there".to_owned(),
        incarnation: 2,
        version: "1".to_owned(),
        slots: 1,
        window: 2,
        holding: vec![],
        labels: BTreeMap::new(),
    };
    assert_eq!(rig.scheduler.attach(hello.clone(), rig.now), Err(NameTaken("A".to_owned())));
    let later = Millis(rig.now.0 + 2 * HEARTBEAT + 1);
    rig.scheduler.attach(hello, later).unwrap();
    let orders = rig.scheduler.dispatch(later);
    assert!(matches!(orders[0], Order::Dismiss { loss: Loss::Replaced, .. }));
}

#[test]
fn counts_go_on_when_a_worker_comes_back_under_its_name() {
    let rig = Rig::new().run(&[Join(A), Submit(0, 2), Report(A, 0), Lose(A), Join(A), Report(A, 1)]);
    let workers = rig.scheduler.workers();
    assert_eq!(workers.len(), 1);
    assert_eq!((workers[0].completed, workers[0].lost, workers[0].state), (2, 1, WorkerState::Attached));
    let rig = rig.run(&[Leave(A)]);
    assert_eq!(rig.scheduler.workers()[0].state, WorkerState::Gone);
}

#[test]
fn every_interim_report_is_ruled_on_and_the_rule_outweighs_the_worker() {
    let mut rig = Rig::new();
    rig.cull = Some(Cull { at: 0.5, cutoff: Some(1.0), control: false });
    let mut rig = rig.run(&[Join(A), Submit(0, 2)]);
    let first = AttemptId { evaluation: 0, number: 1 };
    rig.report(A, first, News::Interim(Interim { step: 50, measure: 0.0 }));
    rig.apply(&Report(A, 0)); // completed, with an interim measure of 0
    rig.apply(&Report(A, 1)); // completed, with an interim measure of 1
    let rulings = [0, 1].map(|id| {
        let settled = &rig.settled[&id];
        (settled.ruling.unwrap().verdict, settled.result.as_ref().unwrap().status)
    });
    assert_eq!(rulings, [(Verdict::Cull, Status::Culled), (Verdict::Pass, Status::Completed)]);
}

#[test]
fn an_outcome_that_breaks_the_rule_is_tried_again() {
    let mut rig = Rig::new().run(&[Join(A), Submit(0, 1)]);
    let culled = Outcome { status: Status::Culled, fitness: 0.0, ..outcome(0) };
    rig.report(A, AttemptId { evaluation: 0, number: 1 }, News::Outcome(culled));
    rig.round();
    rig.apply(&Holds(A, &[0]));
    rig.apply(&Report(A, 0));
    assert_eq!(fates(&rig, 0)[0], fate(1, A, "failed:culled without a cutoff"));
}

#[test]
fn an_evaluation_that_loses_many_workers_without_fault_keeps_its_latest_attempts() {
    let mut rig = Rig::new().run(&[Submit(0, 1)]);
    for _ in 0..100 {
        rig.apply(&Join(A));
        rig.apply(&Leave(A));
    }
    rig.apply(&Join(A));
    rig.apply(&Report(A, 0));
    let attempts = &rig.settled[&0].attempts;
    assert_eq!((attempts.len(), attempts.last().map(|last| last.number)), (ATTEMPTS_KEPT, Some(101)));
    assert_eq!(attempts.last().map(|last| last.fate.clone()), Some(Fate::Counted));
}

#[test]
fn after_the_stop_nothing_is_handed_out() {
    let mut rig = Rig::new().run(&[Join(A), Submit(0, 1)]);
    rig.scheduler.stop();
    rig.scheduler.submit(rig.queues[0], vec![]);
    let late = AttemptId { evaluation: 0, number: 1 };
    rig.scheduler.report(
        WorkerId(1),
        super::Report { attempt: late, seconds: 0.0, news: News::Outcome(outcome(0)) },
        rig.now,
    );
    let orders = rig.scheduler.dispatch(rig.now);
    assert!(matches!(&orders[..], [Order::Deliver { settled, .. }] if settled.len() == 1));
}

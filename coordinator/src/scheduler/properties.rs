//! What stays true whatever happens: random sequences of operations, held after each against the rig's
//! invariants, and brought to an end at which everything is settled once.

use super::rig::{HEARTBEAT, Op, PAROLE, Rig, TIMEOUT};
use creatures::random::stream;
use proptest::prelude::*;

const NAMES: [char; 4] = ['A', 'B', 'C', 'D'];
const QUEUES: usize = 3;

fn name() -> impl Strategy<Value = char> {
    prop::sample::select(&NAMES[..])
}

fn op() -> impl Strategy<Value = Op> {
    prop_oneof![
        2 => (name(), 1..4u32, 1..6u32).prop_map(|(name, slots, window)| Op::JoinWith(name, slots, window)),
        3 => name().prop_map(Op::Back),
        1 => name().prop_map(Op::Return),
        4 => (0..QUEUES, 1..8u32).prop_map(|(queue, count)| Op::Submit(queue, count)),
        1 => (0..QUEUES).prop_map(Op::Pause),
        2 => (0..QUEUES).prop_map(Op::Resume),
        10 => name().prop_map(Op::ReportFirst),
        1 => name().prop_map(Op::ReportTwice),
        1 => (name(), 0..40u64).prop_map(|(name, evaluation)| Op::Report(name, evaluation)),
        2 => (name(), prop::bool::weighted(0.1)).prop_map(|(name, lasting)| Op::Fail(name, lasting)),
        3 => name().prop_map(Op::Lose),
        1 => name().prop_map(Op::Leave),
        1 => name().prop_map(Op::Silence),
        1 => (name(), 1..6u32).prop_map(|(name, window)| Op::Window(name, window)),
        1 => name().prop_map(Op::Drain),
        1 => name().prop_map(Op::DrainIdle),
        4 => (1..3 * HEARTBEAT).prop_map(Op::Advance),
        1 => (1..3 * TIMEOUT).prop_map(Op::Jump),
        1 => Just(Op::Advance(PAROLE + HEARTBEAT)),
    ]
}

fn rig() -> Rig {
    Rig::new().run(&[Op::Open(1), Op::Open(2)])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    /// The rig asserts after each operation; this gives it 10⁵ and more.
    #[test]
    fn nothing_is_lost_and_nothing_is_settled_twice(ops in prop::collection::vec(op(), 1..250)) {
        rig().run(&ops).finish();
    }

    #[test]
    fn a_cancelled_queue_takes_nothing_else_with_it(
        before in prop::collection::vec(op(), 1..60),
        queue in 0..QUEUES,
        after in prop::collection::vec(op(), 1..60),
    ) {
        rig().run(&before).run(&[Op::Cancel(queue)]).run(&after).finish();
    }

    /// Leases end by themselves: whoever is attached falls silent, and everything waits again.
    #[test]
    fn every_lease_of_silent_workers_ends(ops in prop::collection::vec(op(), 1..100)) {
        let mut rig = rig().run(&ops);
        for name in rig.attached() {
            rig.apply(&Op::Silence(name));
        }
        rig.apply(&Op::Advance(TIMEOUT + 3 * HEARTBEAT));
        prop_assert_eq!(rig.scheduler.summary().in_flight, 0);
        prop_assert_eq!(rig.scheduler.summary().workers, 0);
    }

    /// Without deaths and failures nobody is set aside, however often lines break and fall silent, if each process
    /// comes back before the parole is over, with what it holds or without.
    #[test]
    fn the_innocent_are_never_set_aside(
        ops in prop::collection::vec(op().prop_filter("fails", |op| !matches!(op, Op::Fail(..))), 1..250),
        holding in any::<bool>(),
    ) {
        let mut rig = rig().run(&NAMES.map(|name| Op::JoinWith(name, 1 + u32::from(name) % 3, 4)));
        for op in ops {
            if matches!(op, Op::JoinWith(..) | Op::Leave(_) | Op::Drain(_) | Op::DrainIdle(_)) {
                continue; // these end processes
            }
            if matches!(op, Op::Advance(_) | Op::Jump(_)) {
                rig = rig.run(&NAMES.map(|name| if holding { Op::Back(name) } else { Op::Return(name) }));
            }
            rig.apply(&op);
        }
        let rig = rig.run(&NAMES.map(Op::Return)).finish();
        prop_assert!(rig.settled.values().all(|settled| settled.result.is_ok()));
        prop_assert!(rig.conflicts.is_empty());
    }
}

/// One long life: state does not pile up, whatever comes and goes.
#[test]
fn a_long_life_leaves_nothing_behind() {
    let mut draws = stream(1, [0, 0, 0], "long life");
    let mut rig = rig();
    for _ in 0..30_000 {
        let name = NAMES[draws.below(NAMES.len())];
        let op = match draws.below(12) {
            0 => Op::JoinWith(name, 1 + draws.below(3) as u32, 1 + draws.below(6) as u32),
            1 => Op::Back(name),
            2 | 3 => Op::Submit(draws.below(QUEUES), draws.below(4) as u32),
            4 if draws.chance(0.3) => Op::Lose(name),
            5 => Op::Advance(draws.within(1, 60) as u64),
            6 if draws.chance(0.2) => Op::Fail(name, false),
            _ => Op::ReportFirst(name),
        };
        // An overload would only grow the queue.
        if !matches!(op, Op::Submit(..)) || rig.scheduler.summary().ready < 50 {
            rig.apply(&op);
        }
    }
    let rig = rig.finish();
    assert!(rig.settled.len() > 5_000, "only {} were settled", rig.settled.len());
    assert!(rig.events > 25_000);
    assert!(rig.scheduler.evaluations.is_empty() && rig.scheduler.suspects.is_empty());
    assert!(rig.scheduler.condemned.is_empty() && rig.scheduler.presumptions.is_empty());
    assert!(rig.scheduler.remembered.len() <= 1024 && rig.scheduler.workers().len() <= 6);
}

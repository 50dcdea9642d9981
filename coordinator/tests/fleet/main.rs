//! The fleet over real streams on loopback: workers that are in the hands of each test, word by word.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

mod bare;
mod conducted;
mod hands;

use bytes::Bytes;
use coordinator::fleet::{Change, Fate, TaskText};
use hands::{
    LINEAGE, PATIENCE, Raw, evaluations, fates, hello, outcome, serve, serve_patiently, serve_until_overdue,
    take,
};
use proto::hello::HOLDING_MAX;
use proto::v1::coordinator_message::Kind as Told;
use proto::v1::fleet_client::FleetClient;
use proto::v1::report::What;
use proto::v1::worker_message::Kind as Said;
use proto::{PROTOCOL, REPORTS_MAX, WORKER_MESSAGE_SIZE_MAX, v1};
use std::time::Duration;
use tokio::time::timeout;
use tonic::Code;

#[tokio::test]
async fn a_worker_is_told_its_task_once_and_asks_for_more_by_reporting() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 2).await;
    assert_eq!(
        (&a.welcome.lineage[..], a.welcome.heartbeat_ms, a.welcome.timeout_ms),
        (&LINEAGE[..], 60_000, 600_000)
    );
    queue.submit(evaluations(1..4)).await;
    let Some(Told::Task(task)) = a.hear().await.unwrap() else { panic!("a task comes first") };
    assert_eq!(task.verified().unwrap(), TaskText::new("probe", 1, r#"{"work":0}"#).hash);
    let Some(Told::Batch(batch)) = a.hear().await.unwrap() else { panic!("a batch comes next") };
    assert_eq!(batch.assignments.len(), 2);
    let first = &batch.assignments[0];
    assert_eq!(first.attempt, Some(v1::Attempt { evaluation: 1, number: 1 }));
    assert_eq!((&first.genotype[..], first.seed, &first.task), (&[1; 4][..], 1, &task.hash));
    a.complete(first).await;
    let Some(Told::Batch(more)) = a.hear().await.unwrap() else { panic!("the task is known") };
    assert_eq!(more.assignments[0].attempt, Some(v1::Attempt { evaluation: 3, number: 1 }));
    a.complete(&more.assignments[0]).await;
    a.complete(&batch.assignments[1]).await;
    let settled = take(&mut output, 3).await;
    assert_eq!(settled.iter().map(|one| one.id).collect::<Vec<_>>(), [1, 3, 2]);
    assert_eq!(settled[0].result, Ok(outcome(1.0)));
    assert_eq!(fates(&settled[0]), [(1, "a", Fate::Counted)]);
    assert_eq!((settled[0].attempts[0].steps, settled[0].attempts[0].seconds), (10, 0.01));
}

#[tokio::test]
async fn a_broken_stream_hands_its_leases_on_at_once() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    a.batch().await;
    let mut b = service.join("b", 1, 1).await;
    drop(a);
    let handed_on = b.batch().await;
    assert_eq!(handed_on[0].attempt, Some(v1::Attempt { evaluation: 1, number: 2 }));
    b.complete(&handed_on[0]).await;
    assert_eq!(take(&mut output, 1).await[0].attempts.len(), 2);
}

#[tokio::test]
async fn a_worker_that_comes_back_holding_a_lease_reports_on_it_as_if_nothing_had_happened() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 2).await;
    queue.submit(evaluations(1..3)).await;
    let batch = a.batch().await;
    drop(a);
    let held = v1::Attempt { evaluation: 1, number: 1 };
    let back = v1::Hello {
        lineage: Bytes::copy_from_slice(&LINEAGE),
        holding: vec![held, v1::Attempt { evaluation: 99, number: 1 }],
        ..hello("a", 1, 2)
    };
    // The old stream may take a moment to be found gone.
    let mut a = loop {
        match service.attach(back.clone()).await {
            Ok(a) => break a,
            Err(status) => assert_eq!(status.code(), Code::AlreadyExists),
        }
    };
    let Some(Told::Revoke(revoked)) = a.hear().await.unwrap() else {
        panic!("what is not wanted is revoked")
    };
    assert_eq!(revoked.attempts, [v1::Attempt { evaluation: 99, number: 1 }]);
    let again = a.batch().await;
    assert_eq!(again[0].attempt, Some(v1::Attempt { evaluation: 2, number: 2 }), "what had not begun");
    a.complete(&batch[0]).await;
    a.complete(&again[0]).await;
    let settled = take(&mut output, 2).await;
    assert_eq!(fates(&settled[0]), [(1, "a", Fate::Counted)]);
}

#[tokio::test]
async fn what_is_held_for_another_lineage_is_evaluated_again() {
    let service = serve_patiently().await;
    let (queue, _output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    a.batch().await;
    a.sender.send(v1::WorkerMessage { kind: Some(Said::Drain(v1::Drain::default())) }).await.unwrap();
    drop(a.sender);
    while a.incoming.message().await.unwrap().is_some() {}
    let stranger = v1::Hello {
        lineage: Bytes::from(vec![8; 16]),
        holding: vec![v1::Attempt { evaluation: 1, number: 1 }],
        ..hello("a", 1, 1)
    };
    let mut a = service.attach(stranger).await.unwrap();
    assert_eq!(a.batch().await[0].attempt, Some(v1::Attempt { evaluation: 1, number: 2 }));
}

#[tokio::test]
async fn a_worker_that_differs_is_refused_with_both_values_and_the_side_to_upgrade() {
    let service = serve_patiently().await;
    let refused = async |hello: v1::Hello| service.attach(hello).await.map(drop).unwrap_err();
    let status = refused(v1::Hello { protocol: PROTOCOL + 1, ..hello("a", 1, 1) }).await;
    assert_eq!(status.code(), Code::FailedPrecondition);
    assert!(status.message().contains("upgrade the coordinator"), "{status}");
    let status = refused(v1::Hello { version: "1.2.2".to_owned(), ..hello("a", 1, 1) }).await;
    assert_eq!(status.code(), Code::FailedPrecondition);
    assert!(status.message().contains("1.2.2") && status.message().contains("1.2.3"), "{status}");
    let status = refused(v1::Hello { fingerprint: Bytes::from(vec![1; 32]), ..hello("a", 1, 1) }).await;
    assert_eq!(status.code(), Code::FailedPrecondition);
    assert!(status.message().contains("0101") && status.message().contains("0909"), "{status}");
}

#[tokio::test]
async fn a_hello_out_of_bounds_is_refused_by_the_name_of_its_field() {
    let service = serve_patiently().await;
    for (hello, field) in [
        (hello("", 1, 1), "`name`"),
        (hello(&"x".repeat(129), 1, 1), "`name`"),
        (hello("a\nb", 1, 1), "`name`"),
        (hello("a", 0, 1), "`slots`"),
        (hello("a", 4097, 1), "`slots`"),
        (hello("a", 1, 0), "`window`"),
        (hello("a", 1, 65_537), "`window`"),
        (v1::Hello { fingerprint: Bytes::new(), ..hello("a", 1, 1) }, "`fingerprint`"),
        (v1::Hello { incarnation: 0, ..hello("a", 1, 1) }, "`incarnation`"),
    ] {
        let status = service.attach(hello).await.map(drop).unwrap_err();
        assert_eq!(status.code(), Code::InvalidArgument);
        assert!(status.message().contains(field), "{status}");
    }
    let status = service.begin(Said::Heartbeat(v1::Heartbeat {})).await.map(drop).unwrap_err();
    assert_eq!((status.code(), status.message()), (Code::InvalidArgument, "hello: it must come first"));
}

#[tokio::test]
async fn a_name_is_taken_until_its_worker_is_gone() {
    let service = serve_patiently().await;
    let a = service.join("a", 1, 1).await;
    let status = service.attach(hello("a", 1, 1)).await.map(drop).unwrap_err();
    assert_eq!(status.code(), Code::AlreadyExists);
    drop(a);
    let freed = async {
        while service.attach(hello("a", 1, 1)).await.is_err() {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    };
    timeout(PATIENCE, freed).await.unwrap();
}

#[tokio::test]
async fn a_silent_worker_is_dismissed_and_one_that_beats_is_not() {
    let service = serve(50, 200).await;
    let (queue, mut output) = service.queue().await;
    let mut silent = service.join("silent", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    silent.batch().await;
    let mut alive = service.join("alive", 1, 1).await;
    let sender = alive.sender.clone();
    let beats = tokio::spawn(async move {
        loop {
            let beat = v1::WorkerMessage { kind: Some(Said::Heartbeat(v1::Heartbeat {})) };
            sender.send(beat).await.unwrap();
            tokio::time::sleep(Duration::from_millis(25)).await;
        }
    });
    let status = silent.hear().await.unwrap_err();
    assert_eq!((status.code(), status.message()), (Code::Unavailable, "dismissed: silent"));
    let handed_on = alive.batch().await;
    alive.complete(&handed_on[0]).await;
    let settled = take(&mut output, 1).await;
    assert_eq!(fates(&settled[0])[0], (1, "silent", Fate::Lost("silent".to_owned())));
    beats.abort();
}

#[tokio::test]
async fn a_worker_with_an_evaluation_that_hangs_is_told_to_start_again() {
    let service = serve_until_overdue(200, 60_000, 1).await;
    let (queue, mut output) = service.queue().await;
    let mut hung = service.join("hung", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    hung.batch().await;
    let status = hung.hear().await.unwrap_err();
    assert!(proto::refusal::is_lasting(&status), "attaching again does not rid it of what hangs: {status}");
    assert!(status.message().contains("start this worker again"), "{status}");
    let mut sound = service.join("sound", 1, 1).await;
    let handed_on = sound.batch().await;
    sound.complete(&handed_on[0]).await;
    let settled = take(&mut output, 1).await;
    assert_eq!(fates(&settled[0])[0], (1, "hung", Fate::Lost("overdue".to_owned())));
}

#[tokio::test]
async fn a_worker_leaves_before_another_joins_under_its_name() {
    let service = serve(50, 60_000).await;
    let mut changes = service.fleet.changes();
    let old = service.join("a", 1, 1).await;
    tokio::time::sleep(Duration::from_millis(150)).await; // two heartbeats and more
    let _new = service.join("a", 1, 1).await;
    drop(old);
    let words =
        [changes.recv().await, changes.recv().await, changes.recv().await].map(|change| match change {
            Ok(Change::Joined(_)) => "joined",
            Ok(Change::Left { reason, .. }) => reason,
            other => panic!("{other:?}"),
        });
    assert_eq!(words, ["joined", "attached anew", "joined"]);
}

#[tokio::test]
async fn what_a_worker_says_has_its_limits() {
    let service = serve_patiently().await;
    let returned = vec![v1::Attempt::default(); HOLDING_MAX + 1];
    let reports = vec![v1::Report::default(); REPORTS_MAX + 1];
    for (said, field) in [
        (Said::Drain(v1::Drain { returned }), "`drain.returned`"),
        (Said::Reports(v1::Reports { reports }), "`reports`"),
    ] {
        let mut a = service.join("a", 1, 1).await;
        a.say(said).await;
        let status = a.hear().await.unwrap_err();
        assert_eq!(status.code(), Code::InvalidArgument);
        assert!(status.message().contains(field), "{status}");
    }
    let mut a = service.join("a", 1, 1).await;
    let reason = "x".repeat(WORKER_MESSAGE_SIZE_MAX);
    let failure = What::Failure(v1::Failure { reason, r#final: true });
    a.report(v1::Attempt { evaluation: 1, number: 1 }, failure).await;
    assert!(!matches!(a.hear().await, Ok(Some(_))), "refused before it is decoded");
}

#[tokio::test]
async fn a_straggler_is_tried_elsewhere_and_the_loser_is_told() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..5)).await;
    for _ in 0..3 {
        let batch = a.batch().await;
        a.complete(&batch[0]).await;
    }
    a.batch().await;
    let mut b = service.join("b", 1, 1).await;
    let second = b.batch().await;
    assert_eq!(second[0].attempt, Some(v1::Attempt { evaluation: 4, number: 2 }));
    b.complete(&second[0]).await;
    let Some(Told::Revoke(revoked)) = a.hear().await.unwrap() else { panic!("the loser is revoked") };
    assert_eq!(revoked.attempts, [v1::Attempt { evaluation: 4, number: 1 }]);
    let settled = take(&mut output, 4).await;
    assert_eq!(fates(&settled[3]), [(1, "a", Fate::Duplicate), (2, "b", Fate::Counted)]);
    // Its outcome was underway: equal bits change nothing, others raise an alarm.
    let late = v1::Attempt { evaluation: 4, number: 1 };
    a.report(late, What::Outcome(outcome(4.0).into())).await;
    a.report(late, What::Outcome(outcome(5.0).into())).await;
    assert_eq!(timeout(PATIENCE, output.next()).await.unwrap(), Some(vec![]));
    let conflicts = output.take_conflicts();
    assert_eq!(conflicts.len(), 1);
    assert_eq!(
        (conflicts[0].first.clone(), conflicts[0].second.clone()),
        ((outcome(4.0), "b".to_owned()), (outcome(5.0), "a".to_owned()))
    );
}

#[tokio::test]
async fn an_outcome_that_means_nothing_ends_its_attempt_and_nothing_else() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..2)).await;
    let first = a.batch().await;
    let wrong = v1::Outcome { fitness: Some(f64::NAN), ..outcome(1.0).into() };
    a.report(first[0].attempt.unwrap(), What::Outcome(wrong)).await;
    let second = a.batch().await;
    assert_eq!(second[0].attempt, Some(v1::Attempt { evaluation: 1, number: 2 }));
    a.complete(&second[0]).await;
    let settled = take(&mut output, 1).await;
    let Fate::Failed(reason) = &settled[0].attempts[0].fate else { panic!("it failed") };
    assert!(reason.contains("`fitness` is NaN"), "{reason}");
}

#[tokio::test]
async fn a_worker_that_breaks_the_protocol_is_told_and_let_go() {
    let service = serve_patiently().await;
    for (wrong, word) in [
        (Said::Hello(hello("a", 1, 1)), "a second hello"),
        (Said::Window(v1::Window { evaluations: 0 }), "`window.evaluations` is 0"),
        (Said::Reports(v1::Reports { reports: vec![v1::Report::default()] }), "`reports.attempt` is missing"),
    ] {
        let name = format!("worker {word}");
        let mut a = service.join(&name, 1, 1).await;
        a.say(wrong).await;
        let status = a.hear().await.unwrap_err();
        assert_eq!(status.code(), Code::InvalidArgument);
        assert!(status.message().contains(word), "{status}");
    }
}

#[tokio::test]
async fn a_draining_worker_gives_back_what_it_has_not_begun_and_hangs_up_in_peace() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 2).await;
    queue.submit(evaluations(1..3)).await;
    let batch = a.batch().await;
    let mut b = service.join("b", 1, 1).await;
    let returned = vec![batch[1].attempt.unwrap()];
    a.say(Said::Drain(v1::Drain { returned })).await;
    let handed_on = b.batch().await;
    assert_eq!(handed_on[0].attempt, Some(v1::Attempt { evaluation: 2, number: 2 }));
    a.complete(&batch[0]).await;
    let Raw { sender, mut incoming, .. } = a;
    drop(sender);
    assert!(timeout(PATIENCE, incoming.message()).await.unwrap().unwrap().is_none(), "the stream ends well");
    b.complete(&handed_on[0]).await;
    assert_eq!(take(&mut output, 2).await.len(), 2);
    let reply = FleetClient::new(service.channel.clone()).workers(v1::WorkersRequest {}).await.unwrap();
    let workers = reply.into_inner().workers;
    let told: Vec<_> =
        workers.iter().map(|w| (w.name.as_str(), w.state.as_str(), w.completed, w.lost)).collect();
    assert_eq!(told, [("b", "attached", 1, 0), ("a", "gone", 1, 0)]);
    assert!(workers[0].attached_ms > 1_600_000_000_000 && workers[0].heard_ms >= workers[0].attached_ms);
}

#[tokio::test]
async fn a_goodbye_reaches_the_workers_and_the_owners() {
    let service = serve_patiently().await;
    let (queue, mut output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..3)).await;
    a.batch().await;
    service.fleet.goodbye().await;
    let Some(Told::Goodbye(goodbye)) = a.hear().await.unwrap() else { panic!("no goodbye") };
    assert_eq!(goodbye.reason, "the coordinator goes away");
    assert!(a.hear().await.unwrap().is_none());
    assert_eq!(output.next().await, None);
    let status = service.attach(hello("b", 1, 1)).await.map(drop).unwrap_err();
    assert_eq!(status.code(), Code::Unavailable);
    // Nothing of this waits for ever.
    queue.submit(evaluations(5..6)).await;
    service.fleet.goodbye().await;
    assert_eq!(service.fleet.queue("late".to_owned(), 1).await.1.next().await, None);
    assert_eq!(service.fleet.workers().await, []);
}

#[tokio::test]
async fn an_owner_that_goes_away_leaves_nothing_running() {
    let service = serve(50, 60_000).await;
    let (queue, output) = service.queue().await;
    let mut a = service.join("a", 1, 1).await;
    queue.submit(evaluations(1..3)).await;
    let batch = a.batch().await;
    drop(output);
    let Some(Told::Revoke(revoked)) = a.hear().await.unwrap() else { panic!("nothing was revoked") };
    assert_eq!(revoked.attempts, [batch[0].attempt.unwrap()]);
}

//! The worker against a coordinator that does exactly what each test says, over real sockets.

mod leaving;
mod stage;

use super::*;
use creatures::Nobody;
use proto::v1::report::What;
use stage::{Stage, actor, assignment, attempt, failure, outcome};
use std::time::Instant;

#[tokio::test]
async fn an_outcome_is_what_the_function_gives() {
    let mut stage = Stage::set(2).await;
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!((hello.protocol, hello.slots, hello.window), (PROTOCOL, 2, 3));
    assert_eq!(hello.fingerprint[..], creatures::fingerprint());
    assert!(hello.holding.is_empty() && hello.lineage.is_empty());
    let task = v1::Task::named("probe", 1, r#"{"work":50}"#);
    link.say(Incoming::Task(task.clone())).await;
    link.assign((0..20).map(|evaluation| assignment(evaluation, &task, "dna")).collect()).await;
    let probe = creatures::system("probe").unwrap().task(&task.spec).unwrap();
    let expected = probe.evaluate(b"dna", 7, None, &mut Nobody).unwrap();
    let mut reports = link.reports(20).await;
    reports.sort_by_key(|(evaluation, _)| *evaluation);
    for (index, (evaluation, what)) in reports.into_iter().enumerate() {
        assert_eq!(evaluation, index as u64);
        assert_eq!(outcome(what).digest(), expected.digest());
    }
}

#[tokio::test]
async fn an_interim_report_goes_ahead_and_the_cutoff_stops_the_creature() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = v1::Task::named("probe", 1, r#"{"work":100}"#);
    link.say(Incoming::Task(task.clone())).await;
    let cull = Some(v1::Cull { at: 0.25, cutoff: Some(2.0), control: false });
    link.assign(vec![v1::Assignment { cull, ..assignment(1, &task, "dna") }]).await;
    let [(_, What::Interim(interim)), (_, what)] = &link.reports(2).await[..] else {
        panic!("interim first")
    };
    let outcome = outcome(what.clone());
    assert_eq!((outcome.status, outcome.steps), (creatures::Status::Culled, 25));
    assert_eq!(outcome.interim, Some((*interim).try_into().unwrap()));
}

#[tokio::test]
async fn what_has_no_outcome_is_told_with_its_reason_and_the_worker_goes_on() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    let stranger = v1::Task::named("actor", 1, r#"{"never":"sent"}"#);
    let unknown = v1::Task::named("unicorn", 1, "{}");
    link.say(Incoming::Task(task.clone())).await;
    link.say(Incoming::Task(unknown.clone())).await;
    let cull = Some(v1::Cull { at: 1.5, ..Default::default() });
    let batch = vec![
        assignment(1, &task, "panic"),
        assignment(2, &task, "illegal"),
        assignment(3, &task, "nan"),
        assignment(4, &stranger, ""),
        assignment(5, &unknown, ""),
        v1::Assignment { cull, ..assignment(6, &task, "") },
        assignment(7, &task, "well"),
    ];
    link.assign(batch).await;
    let mut reports = link.reports(7).await;
    reports.sort_by_key(|(evaluation, _)| *evaluation);
    let (_, last) = reports.pop().unwrap();
    assert_eq!(outcome(last).fitness, 1.0);
    let failures: Vec<_> = reports.iter().map(|(_, what)| failure(what)).collect();
    let never_sent = format!("task {} was not sent before its evaluation", stranger.verified().unwrap());
    assert_eq!(
        failures,
        [
            ("evaluation panicked: broken invariant 7", false),
            ("genotype field `genes[3]`: must be within 0..=9", true),
            ("outcome: `fitness` is NaN, must be finite in a completed outcome", true),
            (&*never_sent, false),
            ("this worker knows no system `unicorn`", false),
            ("assignment: `cull.at` is 1.5, must be within (0, 1)", true),
        ]
    );
}

#[tokio::test]
async fn a_report_finished_without_a_coordinator_is_delivered_to_the_next() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep"), assignment(2, &task, "never begun")]).await;
    sleep(Duration::from_millis(100)).await;
    drop(link);
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!((&hello.lineage[..], hello.holding), (&b"here"[..], vec![attempt(1)]));
    let [(1, what)] = &link.reports(1).await[..] else { panic!("the first evaluation alone") };
    assert_eq!(outcome(what.clone()).fitness, 1.0);
}

#[tokio::test]
async fn reports_that_may_not_have_arrived_are_sent_again_and_others_are_not() {
    let mut stage = Stage::set(1).await;
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!(hello.window, 2);
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign((1..=2).map(|evaluation| assignment(evaluation, &task, "sleep")).collect()).await;
    link.reports(2).await;
    // Within a window of two this proves that the first report was read, and says nothing of the second.
    link.assign(vec![assignment(3, &task, "sleep")]).await;
    link.reports(1).await;
    drop(link);
    let (mut link, hello) = stage.welcome(b"here").await;
    assert_eq!(hello.holding, [attempt(2), attempt(3)]);
    let again: Vec<u64> = link.reports(2).await.into_iter().map(|(evaluation, _)| evaluation).collect();
    assert_eq!(again, [2, 3]);
}

#[tokio::test]
async fn another_lineage_gets_no_report_of_the_former() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep")]).await;
    sleep(Duration::from_millis(100)).await;
    drop(link);
    let (mut link, _) = stage.welcome(b"elsewhere").await;
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(2, &task, "well")]).await;
    let reports = link.reports(1).await;
    assert_eq!(reports.iter().map(|(evaluation, _)| *evaluation).collect::<Vec<_>>(), [2]);
}

#[tokio::test]
async fn a_refused_worker_stops_and_shows_both_sides() {
    let mut stage = Stage::set(1).await;
    let mut link = stage.link().await;
    let hello = link.hello().await;
    let theirs = proto::Refusal::Version { worker: hello.version, coordinator: "9.9.9".to_owned() };
    link.to_worker.send(Err(theirs.into())).await.unwrap();
    let text = stage.end().await.unwrap_err().to_string();
    assert!(text.contains("coordinator 9.9.9"), "{text}");
    assert!(
        text.contains(&format!("version {}, protocol {PROTOCOL}, fingerprint", env!("CARGO_PKG_VERSION"))),
        "{text}"
    );
}

#[tokio::test]
async fn a_taken_name_is_tried_again() {
    let mut stage = Stage::set(1).await;
    let link = stage.link().await;
    link.to_worker.send(Err(Status::already_exists("still attached"))).await.unwrap();
    stage.welcome(b"here").await;
}

#[tokio::test]
async fn a_coordinator_that_says_goodbye_is_attached_to_again() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    link.say(Incoming::Goodbye(v1::Goodbye { reason: "upgrade".to_owned() })).await;
    stage.welcome(b"here").await;
}

#[tokio::test]
async fn what_is_revoked_is_not_begun_and_not_reported() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign((1..=3).map(|evaluation| assignment(evaluation, &task, "sleep")).collect()).await;
    sleep(Duration::from_millis(100)).await;
    link.say(Incoming::Revoke(v1::Revoke { attempts: vec![attempt(1), attempt(2)] })).await;
    let start = Instant::now();
    let reports = link.reports(1).await;
    assert_eq!(reports.iter().map(|(evaluation, _)| *evaluation).collect::<Vec<_>>(), [3]);
    assert!(start.elapsed() < Duration::from_millis(750), "the second was dropped, not lived");
}

#[tokio::test]
async fn heartbeats_go_on_while_every_slot_is_busy() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep")]).await;
    let mut beats = 0;
    while let Some(Outgoing::Heartbeat(_)) = link.hear().await {
        beats += 1;
    }
    assert!(beats >= 4, "{beats} heartbeats in 300 ms, with one promised within each 50");
}

#[tokio::test]
async fn short_evaluations_widen_the_window_and_share_messages() {
    let mut stage = Stage::set(2).await;
    let (mut link, hello) = stage.welcome(b"here").await;
    let task = v1::Task::named("probe", 1, "{}");
    link.say(Incoming::Task(task.clone())).await;
    link.assign((0..5000).map(|evaluation| assignment(evaluation, &task, "dna")).collect()).await;
    let (mut reports, mut messages, mut widest) = (0, 0, hello.window);
    while reports < 5000 || widest == hello.window {
        match link.hear().await {
            Some(Outgoing::Reports(batch)) => {
                reports += batch.reports.len();
                messages += 1;
            }
            Some(Outgoing::Window(window)) => widest = widest.max(window.evaluations),
            other => assert!(matches!(other, Some(Outgoing::Heartbeat(_))), "{other:?}"),
        }
    }
    assert!(widest > 64, "a window of {widest} for evaluations of some microseconds");
    assert!(messages < 2500, "{messages} messages for 5000 reports");
}

#[tokio::test]
async fn a_hello_says_what_the_starter_says_of_the_worker() {
    let label = ("rack".to_owned(), "2".to_owned());
    let mut stage =
        Stage::set_with(1, |config| config.with_labels(std::slice::from_ref(&label)).unwrap()).await;
    let (_link, hello) = stage.welcome(b"here").await;
    assert_eq!(hello.labels.into_iter().collect::<Vec<_>>(), [label]);
}

//! A worker that leaves: drained, out of time, or idle for too long.

use super::stage::Link;
use super::*;

/// There is nothing more to hear, and the worker ends well.
async fn hangs_up(stage: Stage, mut link: Link) {
    assert!(link.hear().await.is_none());
    drop(link);
    stage.end().await.unwrap();
}

#[tokio::test]
async fn draining_gives_back_what_has_not_begun_and_delivers_what_runs() {
    let mut stage = Stage::set(1).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign((1..=3).map(|evaluation| assignment(evaluation, &task, "sleep")).collect()).await;
    sleep(Duration::from_millis(100)).await;
    stage.drain();
    assert_eq!(link.drain().await, [2, 3]);
    // Sent before the drain was read: it comes back as well.
    link.assign(vec![assignment(4, &task, "sleep")]).await;
    assert_eq!(link.drain().await, [4]);
    let [(1, what)] = &link.reports(1).await[..] else { panic!("the running one alone") };
    assert_eq!(outcome(what.clone()).fitness, 1.0);
    while let Some(message) = link.hear().await {
        assert!(matches!(message, Outgoing::Heartbeat(_)), "{message:?} after the last report");
    }
    drop(link);
    stage.end().await.unwrap();
}

#[tokio::test]
async fn a_draining_worker_begins_nothing_even_with_a_slot_idle() {
    let mut stage = Stage::set(2).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep")]).await;
    sleep(Duration::from_millis(100)).await;
    stage.drain();
    assert!(link.drain().await.is_empty());
    for evaluation in 2..100 {
        link.assign(vec![assignment(evaluation, &task, "well")]).await;
        assert_eq!(link.drain().await, [evaluation]);
    }
    assert_eq!(link.reports(1).await.len(), 1);
}

#[tokio::test]
async fn draining_an_idle_worker_ends_it_at_once_and_so_does_a_lost_coordinator() {
    let mut stage = Stage::set(1).await;
    let (link, _) = stage.welcome(b"here").await;
    drop(link);
    stage.drain();
    stage.end().await.unwrap();
}

#[tokio::test]
async fn what_still_runs_when_the_grace_is_over_is_given_back() {
    let grace = Duration::from_millis(50);
    let mut stage = Stage::set_with(1, |config| Config { grace, ..config }).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    link.assign(vec![assignment(1, &task, "sleep"), assignment(2, &task, "never begun")]).await;
    sleep(Duration::from_millis(100)).await;
    stage.drain();
    assert_eq!(link.drain().await, [2], "at once");
    assert_eq!(link.drain().await, [1], "after the grace, before its 300 ms are over");
    hangs_up(stage, link).await;
}

#[tokio::test]
async fn a_worker_leaves_when_its_time_is_over() {
    let time_limit = Some(Duration::from_millis(200));
    let mut stage = Stage::set_with(1, |config| Config { time_limit, ..config }).await;
    let (mut link, _) = stage.welcome(b"here").await;
    assert!(link.drain().await.is_empty());
    hangs_up(stage, link).await;
}

#[tokio::test]
async fn a_worker_leaves_when_it_was_idle_for_too_long_and_not_while_it_is_busy() {
    let idle_timeout = Some(Duration::from_millis(200));
    let mut stage = Stage::set_with(1, |config| Config { idle_timeout, ..config }).await;
    let (mut link, _) = stage.welcome(b"here").await;
    let task = actor();
    link.say(Incoming::Task(task.clone())).await;
    // Busy for longer than the timeout, and all of it is reported.
    link.assign(vec![assignment(1, &task, "sleep"), assignment(2, &task, "sleep")]).await;
    assert_eq!(link.reports(2).await.len(), 2);
    assert!(link.drain().await.is_empty());
    hangs_up(stage, link).await;
}

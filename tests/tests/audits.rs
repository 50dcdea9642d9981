//! Workers that lie, found out by audits between real processes: the lineage comes out as honest workers' would.

use std::time::{Duration, Instant};

use hatchery_tests::client::PATIENCE;
use hatchery_tests::samples::{audited, probe};
use hatchery_tests::{Hatchery, local};

/// Two honest workers, and one that lies now and then.
fn with_a_liar(every: &str) -> Hatchery {
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.join_as("liar", "lying-worker", &["--every", every]);
    hatchery.wait_attached(3);
    hatchery
}

fn state(hatchery: &Hatchery, name: &str) -> String {
    let workers = hatchery.client().workers();
    workers.into_iter().find(|worker| worker.name == name).map(|worker| worker.state).unwrap_or_default()
}

#[test]
fn a_liar_among_honest_workers_is_named_and_changes_nothing() {
    let text = probe(51, 60, 4, 50);
    let mut hatchery = with_a_liar("5");
    assert_eq!(hatchery.lineage_of(&audited(&text, 1.0)), local::lineage(&text));
    assert_eq!(state(&hatchery, "liar"), "quarantined");
    let client = hatchery.client();
    let count = |sql: &str| client.count(&format!("SELECT count(*) FROM {sql}"));
    assert_eq!(count("v_events WHERE kind = 'quarantine' AND json_extract(data, '$.worker') = 'liar'"), 1);
    assert_eq!(count("v_workers WHERE quarantined_ms IS NOT NULL AND name = 'liar'"), 1);
    assert_eq!(count("v_workers WHERE quarantined_ms IS NOT NULL AND name <> 'liar'"), 0);
    assert!(count("v_evaluations WHERE fate = 'refuted' AND worker = 'liar'") >= 1);
    assert_eq!(count("v_evaluations WHERE fate = 'refuted' AND worker <> 'liar'"), 0);
    assert_eq!(count("v_evaluations WHERE fate = 'counted' AND audit IS NOT 'agreed'"), 0);
    assert_eq!(client.count("SELECT sum(chosen) - sum(agreed) FROM v_audits"), 0);
    assert_eq!(
        client.count("SELECT sum(chosen) FROM v_audits"),
        count("v_evaluations WHERE fate = 'counted'")
    );
    // It is known when the coordinator comes back, and gets nothing, audit or not.
    hatchery.restart_coordinator();
    let deadline = Instant::now() + PATIENCE;
    while hatchery.client().workers().len() < 3 {
        assert!(Instant::now() < deadline, "they attach again: {:#?}", hatchery.client().workers());
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(state(&hatchery, "liar"), "quarantined");
    let text = probe(52, 60, 2, 50);
    assert_eq!(hatchery.lineage_of(&text), local::lineage(&text));
}

#[test]
fn what_a_liar_delivered_in_an_open_generation_is_found_again() {
    let text = probe(53, 600, 2, 100);
    let hatchery = with_a_liar("2");
    assert_eq!(hatchery.lineage_of(&audited(&text, 0.3)), local::lineage(&text));
    assert_eq!(state(&hatchery, "liar"), "quarantined");
    let client = hatchery.client();
    let alone = "SELECT count(*) FROM v_evaluations WHERE worker = 'liar' AND fate = 'counted' AND audit IS NOT 'agreed'";
    assert_eq!(client.count(alone), 0, "nothing rests on its word");
    let told = client.count(
        "SELECT coalesce(sum(json_extract(data, '$.retracted')), 0) FROM v_events WHERE kind = 'retraction'",
    );
    assert_eq!(told, client.count("SELECT count(*) FROM v_evaluations WHERE fate = 'retracted'"));
    let chosen = client.count("SELECT sum(chosen) FROM v_audits");
    assert!((250..470).contains(&chosen), "three of ten among 1200: {chosen}");
}

#[test]
fn a_worker_alone_is_believed_and_the_lineage_says_so() {
    let text = probe(54, 12, 2, 0);
    let hatchery = Hatchery::with_workers(1);
    assert_eq!(hatchery.lineage_of(&audited(&text, 1.0)), local::lineage(&text));
    let client = hatchery.client();
    let skipped = client.count("SELECT sum(skipped) FROM v_audits WHERE agreed = 0");
    assert_eq!(skipped, client.count("SELECT count(*) FROM v_evaluations WHERE fate = 'counted'"));
    assert!(skipped > 0);
}

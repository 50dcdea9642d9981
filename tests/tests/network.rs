//! Real workers behind bad networks, through relays: lines that are slow, thin or ragged, that stall, reset or fall
//! silent one way, cost time and nothing else.

use std::time::{Duration, Instant};

use hatchery_tests::client::PATIENCE;
use hatchery_tests::samples::probe;
use hatchery_tests::{Hatchery, Relay, Way, Weather, local};

/// Across an ocean: long ways, whole packets.
const FAR: Weather = Weather { seed: 61, latency_ms: [40.0, 60.0], fragment_size_max: 1400, ..Weather::FAIR };
/// A modem: eight kilobytes a second.
const THIN: Weather = Weather { seed: 62, bandwidth: 8e3, fragment_size_max: 256, ..Weather::FAIR };
/// Crumbs, each late by its own measure, and every now and then nothing for a while.
const RAGGED: Weather = Weather {
    seed: 63,
    latency_ms: [0.0, 10.0],
    fragment_size_max: 24,
    stall_share: 0.02,
    stall_ms: 300.0,
    ..Weather::FAIR
};

const NAMES: [&str; 3] = ["far", "thin", "ragged"];
const WEATHERS: [Weather; 3] = [FAR, THIN, RAGGED];

/// Evaluations that take a few milliseconds, so that slow lines get their share.
const WORK: u32 = 2000;

#[test]
fn slow_thin_and_ragged_lines_cost_no_lease() {
    let text = probe(51, 40, 4, WORK);
    // Far longer than a line of these takes for anything.
    let mut hatchery = Hatchery::with_heartbeat(200, 10_000);
    let _relays = join(&mut hatchery);
    assert_eq!(hatchery.lineage_of(&text), local::lineage(&text));
    assert_shared(&hatchery);
    assert_eq!(lost(&hatchery, "%"), 0, "every line moved");
}

#[test]
fn lines_that_stall_reset_and_fall_silent_end_leases_and_the_workers_come_back() {
    let text = probe(52, 60, 8, WORK);
    let mut hatchery = Hatchery::with_credentials();
    let relays = join(&mut hatchery);
    let id = begin(&hatchery, &text);

    // Longer than the timeout. The lines stay open, and lead on when they move again.
    relays.iter().for_each(Relay::stall);
    hatchery.wait_attached(0);
    let settled = hatchery.client().experiment(id).expect("it was submitted").evaluated;
    relays.iter().for_each(Relay::mend);
    hatchery.wait_attached(3);
    hatchery.client().wait_until(id, |experiment| experiment.evaluated >= settled + 30);

    dial_again(&hatchery, &relays, Relay::reset);
    hatchery.client().wait_until(id, |experiment| experiment.evaluated >= settled + 90);

    // The coordinator hears nothing more, and says so; nobody mends that line.
    dial_again(&hatchery, &relays, |relay| relay.silence(Way::Up));
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text), "nobody was set aside");
    assert_shared(&hatchery);
    for reason in ["silent", "stream broke"] {
        assert!(lost(&hatchery, reason) > 0, "no lease ended with a worker that was lost: {reason}");
    }
}

/// It keeps telling that it is alive, and never learns what it is to do: both ends find out by HTTP/2's pings.
#[test]
fn a_worker_that_hears_nothing_any_more_is_worked_around_and_comes_back() {
    let text = probe(53, 40, 4, WORK);
    let mut hatchery = Hatchery::with_heartbeat(200, 10_000);
    hatchery.join("near");
    let relay = hatchery.join_through("deaf", FAR);
    hatchery.wait_attached(2);
    let id = begin(&hatchery, &text);
    let before = relay.connections();
    relay.silence(Way::Down);
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
    assert_eq!(relay.connections(), before, "the run waited for nobody");
    wait_for(&hatchery, "the deaf one has dialled again", |_| relay.connections() > before);
    hatchery.kill("near");
    hatchery.wait_attached(1);
    let text = probe(54, 8, 2, WORK);
    assert_eq!(hatchery.lineage_of(&text), local::lineage(&text), "it is of use again");
}

/// A worker behind each of the bad lines, all attached.
fn join(hatchery: &mut Hatchery) -> [Relay; 3] {
    let mut number = 0;
    let relays = WEATHERS.map(|weather| {
        number += 1;
        hatchery.join_through(NAMES[number - 1], weather)
    });
    hatchery.wait_attached(3);
    relays
}

/// Submits an experiment, and gives its number once each worker has done something.
fn begin(hatchery: &Hatchery, text: &str) -> u64 {
    let id = hatchery.submit(text);
    wait_for(hatchery, "each worker has done something", |hatchery| {
        hatchery.client().workers().iter().all(|worker| worker.completed > 0)
    });
    id
}

/// Lets something happen to every line, upon which each worker makes another and is attached.
fn dial_again(hatchery: &Hatchery, relays: &[Relay], happens: impl Fn(&Relay)) {
    let before: Vec<_> = relays.iter().map(Relay::connections).collect();
    relays.iter().for_each(happens);
    wait_for(hatchery, "each worker has dialled again", |_| {
        relays.iter().zip(&before).all(|(relay, &before)| relay.connections() > before)
    });
    hatchery.wait_attached(3);
}

/// Each worker has outcomes in the lineage.
fn assert_shared(hatchery: &Hatchery) {
    for name in NAMES {
        let counted =
            format!("SELECT count(*) FROM v_evaluations WHERE fate = 'counted' AND worker = '{name}'");
        assert!(hatchery.client().count(&counted) > 0, "{name} did nothing that counts");
    }
}

/// Attempts whose lease ended before they did.
fn lost(hatchery: &Hatchery, reason: &str) -> i64 {
    let lost = format!("SELECT count(*) FROM v_evaluations WHERE fate LIKE 'lost:{reason}'");
    hatchery.client().count(&lost)
}

fn wait_for(hatchery: &Hatchery, what: &str, condition: impl Fn(&Hatchery) -> bool) {
    let deadline = Instant::now() + PATIENCE;
    while !condition(hatchery) {
        assert!(Instant::now() < deadline, "waited in vain until {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

//! What a scrape of a working coordinator says, against what its lineage says.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use coordinator::Config;
use coordinator::driver::{Driver, Submission};
use hatchery_tests::client::PATIENCE;
use hatchery_tests::samples;
use tokio::sync::oneshot;

/// Each sample by its name and labels, as written.
type Samples = BTreeMap<String, f64>;

fn get(address: SocketAddr, path: &str) -> (String, String) {
    let mut stream = TcpStream::connect(address).expect("the coordinator listens");
    write!(stream, "GET {path} HTTP/1.1\r\nHost: hatchery\r\nConnection: close\r\n\r\n").expect("it reads");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("it answers in text");
    let (head, body) = answer.split_once("\r\n\r\n").expect("a head and a body");
    (head.to_owned(), body.to_owned())
}

async fn scrape(address: SocketAddr) -> Samples {
    let page = tokio::task::spawn_blocking(move || get(address, "/metrics"));
    let (head, body) = page.await.expect("it does not panic");
    assert!(head.starts_with("HTTP/1.1 200"), "{head}");
    assert!(head.contains("openmetrics-text"), "{head}");
    assert!(body.ends_with("# EOF\n"), "{body}");
    let lines = body.lines().filter(|line| !line.starts_with('#'));
    let samples = lines.map(|line| {
        let (name, value) = line.rsplit_once(' ').expect("a sample has a value");
        (name.to_owned(), value.parse().expect("a value is a number"))
    });
    samples.collect()
}

async fn until(address: SocketAddr, condition: impl Fn(&Samples) -> bool) -> Samples {
    let scraping = async {
        loop {
            let samples = scrape(address).await;
            if condition(&samples) {
                return samples;
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    };
    tokio::time::timeout(PATIENCE, scraping).await.expect("the metrics get there in time")
}

async fn submit(driver: &Driver, text: String) {
    let submission = Submission { text, overrides: Default::default(), resume: false };
    driver.submit(submission).await.expect("a sound experiment");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_scrape_says_what_the_lineage_says() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let any = "127.0.0.1:0".parse().expect("an address");
    let config = Config { metrics: Some(any), ..Config::embedded(folder.path().join("lineage.db")) };
    let coordinator = coordinator::start(config).await.expect("a coordinator starts");
    let address = coordinator.metrics().expect("metrics were asked for");
    let (head, _) = get(address, "/elsewhere");
    assert!(head.starts_with("HTTP/1.1 404"), "{head}");

    // Nobody works: what waits can be seen, and so can the open generation.
    submit(coordinator.driver(), samples::culled(&samples::probe(5, 12, 4, 50))).await;
    let waiting = until(address, |samples| samples["hatchery_queue_depth"] == 72.0).await;
    assert_eq!(waiting["hatchery_slots{state=\"idle\"}"], 0.0);
    assert_eq!(waiting["hatchery_generation{experiment=\"1\",name=\"probe\",run=\"6\"}"], 1.0);
    assert!(waiting["hatchery_lineage_bytes{file=\"wal\"}"] > 0.0);

    let worker = worker::Config::new(&format!("http://{}", coordinator.address())).expect("an address");
    let worker = worker.with_slots(2).expect("two slots");
    let (stop, stopped) = oneshot::channel::<()>();
    let working = tokio::spawn(worker::run(worker, async move { drop(stopped.await) }));
    let total = 6.0 * 12.0 * 4.0;
    // What is committed counts at once, what waits and runs some milliseconds later.
    let done = until(address, |samples| {
        samples.get("hatchery_outcomes_committed_total").is_some_and(|&committed| committed >= total)
            && (samples["hatchery_queue_depth"], samples["hatchery_in_flight"]) == (0.0, 0.0)
    });
    let done = done.await;
    assert_eq!(done["hatchery_workers{state=\"attached\"}"], 1.0);
    assert_eq!(done["hatchery_slots{state=\"idle\"}"], 2.0);
    let culled = done["hatchery_evaluations_total{outcome=\"culled\"}"];
    assert_eq!(culled + done["hatchery_evaluations_total{outcome=\"completed\"}"], total);
    assert!(culled > 0.0, "nine tenths of four generations stand to be culled");
    // 50 steps, culled after a quarter of them: 12 or 13 lived, and the rest spared.
    let spared = done["hatchery_steps_spared_total"] / culled;
    assert!((36.0..=39.0).contains(&spared), "{spared} steps spared a cull");
    assert!(done["hatchery_commit_seconds_count"] >= 4.0 && done["hatchery_commit_seconds_sum"] > 0.0);

    // A worker that goes is counted with its reason.
    stop.send(()).expect("the worker waits for it");
    working.await.expect("it does not panic").expect("it was not refused");
    until(address, |samples| samples.get("hatchery_workers_left_total{reason=\"left\"}") == Some(&1.0)).await;
    coordinator.shutdown().await;
    assert!(TcpStream::connect(address).is_err(), "metrics end with their coordinator");
}

#[tokio::test(flavor = "multi_thread")]
async fn callers_that_ask_nothing_are_hung_up_on_and_keep_nobody_else_out() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let any = "127.0.0.1:0".parse().expect("an address");
    let config = Config { metrics: Some(any), ..Config::embedded(folder.path().join("lineage.db")) };
    let coordinator = coordinator::start(config).await.expect("a coordinator starts");
    let address = coordinator.metrics().expect("metrics were asked for");
    let mut silent: Vec<TcpStream> =
        (0..40).map(|_| TcpStream::connect(address).expect("the system takes calls")).collect();
    let closed =
        tokio::task::spawn_blocking(move || silent[0].read(&mut [0]).expect("it is closed in peace"));
    assert_eq!(closed.await.expect("it does not panic"), 0);
    scrape(address).await;
    coordinator.shutdown().await;
}

//! Many workers at one coordinator: what a stream costs in memory and in processor time while it is idle, and
//! what evaluations cost when each of them crosses another stream. The coordinator and its lineage are real; the
//! workers are streams of this process, which answer with outcomes that they have not computed.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use bytes::Bytes;
use creatures::{Outcome, Status};
use hatchery_benches::processes::{processor_seconds, resident_bytes};
use hatchery_benches::report::Report;
use hatchery_tests::Hatchery;
use proto::v1::coordinator_message::Kind as Told;
use proto::v1::fleet_client::FleetClient;
use proto::v1::report::What;
use proto::v1::worker_message::Kind as Said;
use proto::{PROTOCOL, v1};
use serde_json::json;
use tokio::sync::{Semaphore, mpsc};
use tokio_stream::wrappers::ReceiverStream;
use tonic::transport::Endpoint;

/// How many streams; the last is the one that the service promises to carry.
const COUNTS: [usize; 3] = [100, 1_000, 10_000];
/// A stream says so often that it is alive.
const HEARTBEAT: Duration = Duration::from_millis(5_000);
/// Connections that are being made at once.
const DIALS_MAX: usize = 64;
/// Idle for so long while it is measured.
const IDLE: Duration = Duration::from_secs(10);

fn main() -> Result<()> {
    let counts: Vec<usize> = match std::env::args().nth(1) {
        Some(count) => vec![count.parse().context("the argument is a number of streams")?],
        None => COUNTS.to_vec(),
    };
    let fingerprint = creatures::fingerprint();
    let columns = [
        "streams",
        "attached_s",
        "kib_a_stream",
        "idle_us_a_heartbeat",
        "evaluations_per_second",
        "coordinator_us",
        "kib_a_stream_after",
    ];
    let mut report = Report::new("streams", &columns);
    for count in counts {
        let mut hatchery = Hatchery::with_heartbeat(10_000, 60_000);
        let address = hatchery.url().trim_start_matches("http://").parse()?;
        let id = hatchery.coordinator().id();
        let empty = resident_bytes(id);
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
        let attached = Arc::new(AtomicU64::new(0));
        let start = Instant::now();
        for number in 0..count {
            runtime.spawn(stand_in(address, number, fingerprint, attached.clone()));
        }
        while attached.load(Ordering::Relaxed) < count as u64 {
            if start.elapsed() > Duration::from_secs(300) {
                bail!("{} of {count} streams attached", attached.load(Ordering::Relaxed));
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        let attached_seconds = start.elapsed().as_secs_f64();
        std::thread::sleep(Duration::from_secs(2));
        let idle = (resident_bytes(id) - empty) as f64 / count as f64 / 1024.0;
        let before = processor_seconds(id);
        std::thread::sleep(IDLE);
        let beats = count as f64 * IDLE.as_secs_f64() / HEARTBEAT.as_secs_f64();
        let idle_us = (processor_seconds(id) - before) / beats * 1e6;

        let (population, generations) = (20_000, 5);
        let text = hatchery_tests::samples::probe(1, population, generations, 0);
        let (before, start) = (processor_seconds(id), Instant::now());
        let experiment = hatchery.submit(&text);
        hatchery.client().wait(experiment);
        let evaluations = f64::from(population * generations);
        report.row(&[
            json!(count),
            json!(attached_seconds),
            json!(idle),
            json!(idle_us),
            json!(evaluations / start.elapsed().as_secs_f64()),
            json!((processor_seconds(id) - before) / evaluations * 1e6),
            json!((resident_bytes(id) - empty) as f64 / count as f64 / 1024.0),
        ]);
        runtime.shutdown_background();
    }
    Ok(())
}

/// One worker of one slot: attaches, beats, and answers whatever it is asked at once.
async fn stand_in(address: SocketAddr, number: usize, fingerprint: [u8; 32], attached: Arc<AtomicU64>) {
    static DIALS: Semaphore = Semaphore::const_new(DIALS_MAX);
    if let Err(error) = live(address, number, fingerprint, &attached, &DIALS).await {
        eprintln!("stream {number}: {error:#}");
    }
}

async fn live(
    address: SocketAddr,
    number: usize,
    fingerprint: [u8; 32],
    attached: &AtomicU64,
    dials: &Semaphore,
) -> Result<()> {
    let (sender, receiver) = mpsc::channel(4);
    let dialling = dials.acquire().await?;
    let channel = Endpoint::from_shared(format!("http://{address}"))?.tcp_nodelay(true).connect().await?;
    let hello = v1::Hello {
        protocol: PROTOCOL,
        name: format!("stand-in-{number}"),
        host: "bench".to_owned(),
        slots: 1,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: Bytes::copy_from_slice(&fingerprint),
        window: 2,
        lineage: Bytes::new(),
        holding: vec![],
        labels: Default::default(),
        incarnation: number as u64,
    };
    say(&sender, Said::Hello(hello)).await?;
    let mut told = FleetClient::new(channel).attach(ReceiverStream::new(receiver)).await?.into_inner();
    drop(dialling);
    let mut beat = tokio::time::interval(HEARTBEAT);
    loop {
        let message = tokio::select! {
            message = told.message() => message?,
            _ = beat.tick() => {
                say(&sender, Said::Heartbeat(v1::Heartbeat {})).await?;
                continue;
            }
        };
        match message.and_then(|message| message.kind) {
            Some(Told::Welcome(_)) => drop(attached.fetch_add(1, Ordering::Relaxed)),
            Some(Told::Batch(batch)) => {
                let reports = batch.assignments.into_iter().map(|assignment| v1::Report {
                    attempt: assignment.attempt,
                    seconds: 0.0,
                    what: Some(What::Outcome(outcome(assignment.seed).into())),
                });
                say(&sender, Said::Reports(v1::Reports { reports: reports.collect() })).await?;
            }
            Some(Told::Goodbye(_)) | None => return Ok(()),
            Some(Told::Task(_) | Told::Revoke(_)) => {}
        }
    }
}

async fn say(sender: &mpsc::Sender<v1::WorkerMessage>, kind: Said) -> Result<()> {
    sender.send(v1::WorkerMessage { kind: Some(kind) }).await.context("the stream has ended")
}

/// Something to record; a lineage of stand-ins is no lineage.
fn outcome(seed: u64) -> Outcome {
    Outcome {
        status: Status::Completed,
        fitness: (seed >> 11) as f64 / (1u64 << 53) as f64,
        steps: 0,
        measures: vec![("echo".to_owned(), 0.0)],
        interim: None,
        note: String::new(),
    }
}

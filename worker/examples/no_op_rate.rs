//! What a worker costs: no-op evaluations a second and its processor time for each, as a process of its own
//! against a coordinator that does nothing but hand them out. It measures no lineage and no scheduler.
//!
//! `cargo build --release -p worker && cargo run --release -p worker --example no_op_rate -- [SLOTS] [WORK]`
//! with WORK in BLAKE3 compressions of some 0.1 microseconds each. Linux alone: it reads `/proc`.

use bytes::Bytes;
use proto::v1::coordinator_message::Kind as ToWorker;
use proto::v1::fleet_server::{Fleet, FleetServer};
use proto::v1::worker_message::Kind as FromWorker;
use proto::{MESSAGE_SIZE_MAX, v1};
use std::error::Error;
use std::process::{Child, Command};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};
use std::{env, fs};
use tokio::net::TcpListener;
use tokio::sync::mpsc;
use tokio_stream::wrappers::{ReceiverStream, TcpListenerStream};
use tonic::{Request, Response, Status, Streaming};

const GENOTYPE_SIZE: usize = 2048; // bytes
const WARM_UP: Duration = Duration::from_secs(1);
const MEASURED: Duration = Duration::from_secs(4);
/// Of `/proc`'s processor times, on every Linux that people run.
const TICKS_A_SECOND: f64 = 100.0;

#[derive(Default)]
struct Counts {
    evaluations: AtomicU64,
    messages: AtomicU64,
    window: AtomicU64,
}

struct Source {
    task: v1::Task,
    counts: Arc<Counts>,
}

#[tonic::async_trait]
impl Fleet for Source {
    type AttachStream = ReceiverStream<Result<v1::CoordinatorMessage, Status>>;

    async fn attach(
        &self,
        request: Request<Streaming<v1::WorkerMessage>>,
    ) -> Result<Response<Self::AttachStream>, Status> {
        let (sender, receiver) = mpsc::channel(64);
        tokio::spawn(feed(request.into_inner(), sender, self.task.clone(), Arc::clone(&self.counts)));
        Ok(Response::new(ReceiverStream::new(receiver)))
    }

    async fn workers(&self, _: Request<v1::WorkersRequest>) -> Result<Response<v1::WorkersReply>, Status> {
        Err(Status::unimplemented("nobody asks"))
    }
}

/// Fills the worker's window, and fills it again with each message of reports.
async fn feed(
    mut from: Streaming<v1::WorkerMessage>,
    to: mpsc::Sender<Result<v1::CoordinatorMessage, Status>>,
    task: v1::Task,
    counts: Arc<Counts>,
) -> Option<()> {
    let say = async |kind| to.send(Ok(v1::CoordinatorMessage { kind: Some(kind) })).await.ok();
    let genotype = Bytes::from(vec![7; GENOTYPE_SIZE]);
    let (mut assigned, mut ended, mut window) = (0u64, 0u64, 0u64);
    while let Ok(Some(v1::WorkerMessage { kind: Some(kind) })) = from.message().await {
        match kind {
            FromWorker::Hello(hello) => {
                window = hello.window.into();
                let (heartbeat_ms, timeout_ms) = (1000, 5000);
                say(ToWorker::Welcome(v1::Welcome { heartbeat_ms, timeout_ms, ..Default::default() }))
                    .await?;
                say(ToWorker::Task(task.clone())).await?;
            }
            FromWorker::Window(wider) => window = wider.evaluations.into(),
            FromWorker::Reports(reports) => {
                ended += reports.reports.len() as u64;
                counts.evaluations.store(ended, Relaxed);
                counts.messages.fetch_add(1, Relaxed);
            }
            FromWorker::Heartbeat(_) | FromWorker::Drain(_) => {}
        }
        counts.window.store(window, Relaxed);
        let assignments: Vec<_> = (assigned..ended + window)
            .map(|evaluation| v1::Assignment {
                attempt: Some(v1::Attempt { evaluation, number: 1 }),
                task: task.hash.clone(),
                genotype: genotype.clone(),
                seed: evaluation,
                cull: None,
            })
            .collect();
        if !assignments.is_empty() {
            assigned += assignments.len() as u64;
            say(ToWorker::Batch(v1::Batch { assignments })).await?;
        }
    }
    None
}

/// Processor time of a process so far, seconds.
fn processor_seconds(process: u32) -> Result<f64, Box<dyn Error>> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat"))?;
    let after_name = stat.rsplit(')').next().ok_or("no name in /proc stat")?;
    let fields: Vec<&str> = after_name.split_whitespace().collect();
    Ok((fields[11].parse::<f64>()? + fields[12].parse::<f64>()?) / TICKS_A_SECOND)
}

fn start_worker(url: &str, slots: &str) -> Result<Child, Box<dyn Error>> {
    let worker = env::current_exe()?.parent().and_then(|examples| examples.parent()).map(|target| {
        Command::new(target.join("hatchery-worker"))
            .args(["--coordinator", url, "--slots", slots])
            .env("HATCHERY_LOG", "warn")
            .spawn()
    });
    Ok(worker.ok_or("no target directory")??)
}

#[tokio::main(flavor = "current_thread")]
async fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let slots = arguments.first().map_or("1", String::as_str);
    let work: u32 = arguments.get(1).map_or(Ok(0), |work| work.parse())?;
    let task = v1::Task::named("probe", 1, &format!("{{\"work\":{work}}}"));
    let counts = Arc::new(Counts::default());
    let listener = TcpListener::bind("127.0.0.1:0").await?;
    let url = format!("http://{}", listener.local_addr()?);
    let fleet = FleetServer::new(Source { task, counts: Arc::clone(&counts) })
        .max_decoding_message_size(MESSAGE_SIZE_MAX);
    let mut server = tonic::transport::Server::builder().tcp_nodelay(true).max_frame_size(128 << 10);
    tokio::spawn(server.add_service(fleet).serve_with_incoming(TcpListenerStream::new(listener)));

    let mut worker = start_worker(&url, slots)?;
    tokio::time::sleep(WARM_UP).await;
    let read = || (counts.evaluations.load(Relaxed), counts.messages.load(Relaxed));
    let (start, busy, before) = (Instant::now(), processor_seconds(worker.id())?, read());
    let own = processor_seconds(std::process::id())?;
    tokio::time::sleep(MEASURED).await;
    let (seconds, busy) = (start.elapsed().as_secs_f64(), processor_seconds(worker.id())? - busy);
    let own = processor_seconds(std::process::id())? - own;
    let (evaluations, messages) = (read().0 - before.0, read().1 - before.1);
    worker.kill()?;
    worker.wait()?;
    println!("slots {slots}, work {work}, window {}", counts.window.load(Relaxed));
    println!("{:.0} evaluations a second", evaluations as f64 / seconds);
    println!("{:.2} us of processor an evaluation in the worker", busy / evaluations as f64 * 1e6);
    println!("{:.2} us of processor an evaluation in this source", own / evaluations as f64 * 1e6);
    println!("{:.1} reports a message", evaluations as f64 / messages as f64);
    Ok(())
}

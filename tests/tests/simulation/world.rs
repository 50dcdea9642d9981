//! The hosts that a plan asks for, real coordinator and worker code on each, and the faults at their time.

use crate::owner::{Disk, Undisturbed, conduct};
use crate::plan::{Fault, Plan};
use crate::wire;
use coordinator::fleet::{Fleet, FleetSettings, WorkerState};
use coordinator::service;
use proto::dial::Address;
use std::error::Error;
use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::sync::Notify;
use tokio::time::{Instant, sleep};
use tonic::transport::Server;
use turmoil::Sim;

const HEARTBEAT_MS: u32 = 200;
const TIMEOUT_MS: u32 = 1_000;
/// The network's and the hosts' clock moves in steps of this.
const TICK: Duration = Duration::from_millis(10);
/// By then everything is over: the faults, a connection's death (15 s of keepalive), and the work.
const PATIENCE: Duration = Duration::from_secs(120);
/// The network's latencies change so often.
const STRETCH: Duration = Duration::from_millis(400);
const COORDINATOR: &str = "coordinator";
const FINGERPRINT: [u8; 32] = [7; 32];
/// Each process of a worker has another one.
static INCARNATIONS: AtomicU64 = AtomicU64::new(1);

/// Why a seed fails, and what had happened until then.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) reason: String,
    pub(crate) trace: String,
}

/// What hosts and the world outside share.
struct Shared {
    disk: Mutex<Disk>,
    trace: Mutex<String>,
    /// Nothing is leased any more, and the lineage stands.
    rested: Mutex<bool>,
}

impl Shared {
    fn note(&self, at: Duration, what: &str) {
        let at = at.as_millis();
        writeln!(self.trace.lock().expect("one thread"), "{at} {what}").expect("a string takes it");
    }
}

/// Lives a plan to its end, and gives its trace.
pub(crate) fn run(plan: &Plan, expected: &Arc<Undisturbed>) -> Result<String, Failure> {
    let shared =
        Arc::new(Shared { disk: Mutex::default(), trace: Mutex::default(), rested: Mutex::new(false) });
    let lived = catch_unwind(AssertUnwindSafe(|| live(plan, expected, &shared)));
    let lived = lived.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        Err(text.or_else(|| panic.downcast_ref::<&str>().map(|t| (*t).to_owned())).unwrap_or_default().into())
    });
    let trace = std::mem::take(&mut *shared.trace.lock().expect("one thread"));
    match lived {
        Ok(()) => Ok(trace),
        Err(error) => Err(Failure { reason: error.to_string(), trace }),
    }
}

fn live(plan: &Plan, expected: &Arc<Undisturbed>, shared: &Arc<Shared>) -> Result<(), Box<dyn Error>> {
    let mut sim =
        turmoil::Builder::new().tick_duration(TICK).simulation_duration(PATIENCE).rng_seed(plan.seed).build();
    let (of, with) = (expected.clone(), shared.clone());
    sim.host(COORDINATOR, move || coordinator_host(of.clone(), with.clone()));
    let mut drains = Vec::new();
    for (index, &slots) in plan.workers.iter().enumerate() {
        let drain = Arc::new(Notify::new());
        drains.push(drain.clone());
        sim.host(worker(index), move || worker_host(index, slots, drain.clone()));
    }
    let mut troubles = plan.faults.iter().peekable();
    let mut repairs: Vec<(Duration, Fault)> = Vec::new();
    let mut stretch = 0;
    while !*shared.rested.lock().expect("one thread") {
        while let Some((_, fault)) = troubles.next_if(|(at, _)| *at <= sim.elapsed()) {
            shared.note(sim.elapsed(), &format!("{fault:?}"));
            begin(&mut sim, *fault, &drains);
            repairs.extend(fault.lasts().map(|away| (sim.elapsed() + away, *fault)));
        }
        let now = sim.elapsed();
        if now >= STRETCH * stretch {
            for index in 0..plan.workers.len() {
                sim.set_link_latency(worker(index), COORDINATOR, plan.latency(stretch, index));
            }
            stretch += 1;
        }
        for (_, fault) in repairs.extract_if(.., |(at, _)| *at <= now) {
            end(&mut sim, fault);
        }
        if now > PATIENCE {
            return Err(format!("not over after {PATIENCE:?}: something is lost or leased for ever").into());
        }
        sim.step()?;
    }
    let lineage = shared.disk.lock().expect("one thread").lineage.clone();
    if lineage.as_deref() != Some(expected.lineage()) {
        return Err(format!("lineage {lineage:?} is not {}", expected.lineage()).into());
    }
    Ok(())
}

impl Fault {
    fn lasts(self) -> Option<Duration> {
        match self {
            Fault::Kill { away, .. }
            | Fault::KillCoordinator { away }
            | Fault::Cut { away, .. }
            | Fault::Stall { away, .. } => Some(away),
            Fault::Drain { .. } => None,
        }
    }
}

fn begin(sim: &mut Sim<'_>, fault: Fault, drains: &[Arc<Notify>]) {
    match fault {
        Fault::Kill { worker: index, .. } => sim.crash(worker(index)),
        Fault::KillCoordinator { .. } => sim.crash(COORDINATOR),
        Fault::Cut { worker: index, .. } => sim.partition(worker(index), COORDINATOR),
        Fault::Stall { worker: index, .. } => sim.hold(worker(index), COORDINATOR),
        Fault::Drain { worker } => drains[worker].notify_one(),
    }
}

fn end(sim: &mut Sim<'_>, fault: Fault) {
    match fault {
        // Killed twice, it is started once.
        Fault::Kill { worker: index, .. } if !sim.is_host_running(worker(index)) => {
            sim.bounce(worker(index));
        }
        Fault::KillCoordinator { .. } if !sim.is_host_running(COORDINATOR) => sim.bounce(COORDINATOR),
        Fault::Cut { worker: index, .. } => sim.repair(worker(index), COORDINATOR),
        Fault::Stall { worker: index, .. } => sim.release(worker(index), COORDINATOR),
        Fault::Kill { .. } | Fault::KillCoordinator { .. } | Fault::Drain { .. } => {}
    }
}

fn worker(index: usize) -> String {
    format!("w{index}")
}

/// A coordinator from its start to its end or its death: the fleet and its service, and who owns the queue.
async fn coordinator_host(of: Arc<Undisturbed>, shared: Arc<Shared>) -> turmoil::Result {
    let start = Instant::now();
    let fleet = Fleet::start(FleetSettings {
        heartbeat_ms: HEARTBEAT_MS,
        timeout_ms: TIMEOUT_MS,
        overdue_s: 900,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: FINGERPRINT,
        lineage: [1; 16],
        quarantined: vec![],
    });
    let router = Server::builder().add_service(service::fleet(fleet.clone()));
    tokio::spawn(router.serve_with_incoming(wire::listen().await?));
    let note = |what: String| shared.note(turmoil::sim_elapsed().unwrap_or_default(), &what);
    tokio::select! {
        biased;
        conducted = conduct(&of, &fleet, &shared.disk, note) => conducted?,
        found = watch(&fleet, start) => return Err(found.into()),
    }
    // What is not needed any more is revoked at once.
    let mut summary = fleet.summary();
    let rest = summary.wait_for(|summary| summary.in_flight == 0 && summary.ready == 0);
    let at_rest = tokio::time::timeout(Duration::from_secs(1), rest).await;
    at_rest.map_err(|_| "leases are left when everything is settled")??;
    *shared.rested.lock().expect("one thread") = true;
    std::future::pending().await
}

/// Leases end in time: nobody who is silent for longer than allowed stays attached. Returns only what is wrong.
async fn watch(fleet: &Fleet, start: Instant) -> String {
    let silence_max = u64::from(TIMEOUT_MS + 2 * HEARTBEAT_MS);
    loop {
        sleep(Duration::from_millis(100)).await;
        let now = start.elapsed().as_millis() as u64;
        for one in fleet.workers().await {
            let silent = now.saturating_sub(one.heard.0);
            if one.state != WorkerState::Gone && silent > silence_max {
                return format!("worker {} is silent for {silent} ms and holds {}", one.name, one.in_flight);
            }
        }
    }
}

/// A worker that starts again whenever it has been drained.
async fn worker_host(index: usize, slots: usize, drain: Arc<Notify>) -> turmoil::Result {
    loop {
        let config = worker::Config {
            coordinator: Address::plain(&format!("http://{COORDINATOR}:{}", wire::PORT))?,
            name: worker(index),
            host: "simulated".to_owned(),
            incarnation: INCARNATIONS.fetch_add(1, Ordering::Relaxed),
            slots,
            systems: creatures::system,
            fingerprint: FINGERPRINT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            labels: Default::default(),
            time_limit: None,
            idle_timeout: None,
            grace: worker::config::GRACE,
            dial: Some(wire::dial),
            hands: worker::Hands::Simulated(takes),
        };
        worker::run(config, drain.notified()).await?;
        sleep(Duration::from_millis(300)).await;
    }
}

/// Most evaluations are short, some take as long as a fault does.
fn takes(_genotype: &[u8], seed: u64) -> Duration {
    Duration::from_millis(if seed.is_multiple_of(5) { 600 + seed % 1_900 } else { 20 + seed % 280 })
}

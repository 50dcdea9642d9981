//! Puts a coordinator together and takes it down again. It decides nothing.

use std::net::SocketAddr;
use std::time::Duration;

use creatures::Outcome;
use proto::dial::FRAME_SIZE_MAX;
use serde_json::json;
use tokio::net::TcpListener;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, oneshot, watch};
use tokio::task::{JoinHandle, JoinSet};
use tonic::transport::Server;
use tonic::transport::server::TcpIncoming;
use tonic_health::ServingStatus;
use tonic_health::server::HealthReporter;

use crate::credentials::{Credentials, FolderError, Guard};
use crate::driver::{Driver, ResumeError};
use crate::fleet::{Change, Fleet, FleetSettings, Quarantine, SetAside};
use crate::lineage::{Event, Health, Lineage, OpenError};
use crate::service::experiments::ExperimentsService;
use crate::service::lineage::LineageService;
use crate::{Config, service};

/// The longest that a call may take to answer, or a stream to begin.
const CALL_WITHIN: Duration = Duration::from_secs(600);

/// Why a coordinator does not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// Anybody could reach it.
    #[error(
        "{0} can be reached from other machines: make credentials with `hatchery-coordinator init` and name them with \
         --credentials DIR, or listen on a loopback address"
    )]
    Insecure(SocketAddr),
    /// Every worker would be silent for too long.
    #[error(
        "--timeout-ms {timeout_ms} ends leases before the second heartbeat: it has to be twice --heartbeat-ms {heartbeat_ms}"
    )]
    Impatient {
        /// How often a worker shows that it is alive.
        heartbeat_ms: u32,
        /// How long it may be silent.
        timeout_ms: u32,
    },
    /// The credentials cannot be used.
    #[error("cannot use the credentials")]
    Credentials(#[from] FolderError),
    /// The lineage cannot be used.
    #[error(transparent)]
    Lineage(#[from] OpenError),
    /// The address is taken, or not of this machine.
    #[error("cannot listen on {address}")]
    Listen {
        /// What was asked for.
        address: SocketAddr,
        /// The operating system's word.
        #[source]
        source: std::io::Error,
    },
    /// The address file cannot be written.
    #[error("cannot write the address to {path}")]
    AddressFile {
        /// Where to.
        path: std::path::PathBuf,
        /// The operating system's word.
        #[source]
        source: std::io::Error,
    },
    /// What was running cannot be taken up.
    #[error("cannot take up the experiments of this lineage")]
    Resume(#[from] ResumeError),
    /// The transport's word.
    #[error("cannot serve")]
    Serve(#[from] tonic::transport::Error),
}

/// A coordinator at work. Dropping it stops the server without a goodbye, as a kill would.
pub struct Running {
    address: SocketAddr,
    metrics: Option<SocketAddr>,
    stop: oneshot::Sender<()>,
    server: JoinHandle<Result<(), tonic::transport::Error>>,
    /// Ends when this is dropped.
    chores: JoinSet<()>,
    driver: Driver,
    fleet: Fleet,
    lineage: Lineage,
}

/// Opens the lineage, takes up every experiment that was running, and listens.
///
/// # Errors
/// An address beyond this machine, a lineage that cannot be opened, an address that is taken.
pub async fn start(config: Config) -> Result<Running, StartError> {
    if !config.listen.ip().is_loopback() && config.credentials.is_none() {
        return Err(StartError::Insecure(config.listen));
    }
    let (heartbeat_ms, timeout_ms) = (config.heartbeat_ms, config.timeout_ms);
    if timeout_ms < 2 * heartbeat_ms {
        return Err(StartError::Impatient { heartbeat_ms, timeout_ms });
    }
    let credentials = config.credentials.as_deref().map(Credentials::open).transpose()?;
    let lineage = Lineage::open(&config.db).await?;
    let listen_error = |source| StartError::Listen { address: config.listen, source };
    let listener = TcpListener::bind(config.listen).await.map_err(listen_error)?;
    let address = listener.local_addr().map_err(listen_error)?;
    let fingerprint = tokio::task::spawn_blocking(creatures::fingerprint)
        .await
        .expect("the fingerprint of a sound build does not panic; a test says so");
    let fleet = Fleet::start(FleetSettings {
        heartbeat_ms,
        timeout_ms,
        overdue_s: config.overdue_s,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint,
        lineage: lineage.identity(),
        quarantined: lineage.reader().quarantined().await.map_err(ResumeError::Read)?,
    });
    tokio::spawn(note_workers(fleet.changes(), lineage.clone()));
    let driver = Driver::start(lineage.clone(), fleet.clone(), fingerprint).await?;

    let mut chores = JoinSet::new();
    let mut metrics = None;
    if let Some(address) = config.metrics {
        let refused = |source| StartError::Listen { address, source };
        let listener = TcpListener::bind(address).await.map_err(refused)?;
        metrics = Some(listener.local_addr().map_err(refused)?);
        chores.spawn(crate::metrics::serve(listener, driver.clone(), config.db.clone()));
    }

    let (health, health_service) = tonic_health::server::health_reporter();
    health.set_service_status("", ServingStatus::Serving).await;
    chores.spawn(tell_health(health, lineage.health()));
    let reflection = tonic_reflection::server::Builder::configure()
        .register_encoded_file_descriptor_set(proto::DESCRIPTORS)
        .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
        .build_v1()
        .expect("the descriptors are those that the build compiled");
    let (stop, stopped) = oneshot::channel::<()>();
    let (tls, keyring) = credentials.map(|Credentials { tls, keyring }| (tls, keyring)).unzip();
    let mut server = Server::builder().timeout(CALL_WITHIN);
    if let Some(tls) = tls {
        server = server.tls_config(tls)?;
    }
    let router = server
        .layer(Guard(keyring))
        .max_frame_size(Some(FRAME_SIZE_MAX))
        .http2_keepalive_interval(Some(Duration::from_secs(5)))
        .http2_keepalive_timeout(Some(Duration::from_secs(10)))
        .add_service(health_service)
        .add_service(reflection)
        .add_service(service::fleet(fleet.clone()))
        .add_service(service::evaluation(fleet.clone()))
        .add_service(ExperimentsService::new(driver.clone()).into_server())
        .add_service(LineageService::new(lineage.clients().clone()).into_server());
    let incoming = TcpIncoming::from(listener).with_nodelay(Some(true));
    let server = tokio::spawn(router.serve_with_incoming_shutdown(incoming, async move {
        // A dropped sender is a stop as well.
        let _ = stopped.await;
    }));
    if let Some(path) = &config.address_file {
        write_whole(path, &address.to_string())
            .map_err(|source| StartError::AddressFile { path: path.clone(), source })?;
    }
    let credentials = config.credentials.as_deref().map(|folder| folder.display().to_string());
    let scraped = metrics.map(|address| address.to_string());
    tracing::info!(%address, db = %config.db.display(), metrics = scraped, credentials, "listening");
    Ok(Running { address, metrics, stop, server, chores, driver, fleet, lineage })
}

impl Running {
    /// The address listened on.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Where metrics are read, if that was asked for.
    pub fn metrics(&self) -> Option<SocketAddr> {
        self.metrics
    }

    /// The experiments, for those who embed a coordinator.
    pub fn driver(&self) -> &Driver {
        &self.driver
    }

    /// Stops handing out, commits what has arrived, says goodbye to the workers, closes the lineage.
    /// Experiments stay `running` in it and are taken up at the next start.
    pub async fn shutdown(mut self) {
        self.chores.shutdown().await;
        self.driver.stop().await;
        self.fleet.goodbye().await;
        let _ = self.stop.send(());
        // Watchers may hold their streams open: they had their goodbye.
        if tokio::time::timeout(Duration::from_secs(2), self.server).await.is_err() {
            tracing::debug!("clients still hold streams; closing them");
        }
        if let Err(error) = self.lineage.close().await {
            tracing::warn!(%error, "the lineage was not closed in order; what is committed is safe");
        }
    }
}

/// Tells probes of each service whether it is of use: none is while nothing reaches the disk. The process as a
/// whole (the empty name) is alive all the same, and to restart it would mend nothing.
async fn tell_health(reporter: HealthReporter, mut lineage: watch::Receiver<Health>) {
    loop {
        let status = match *lineage.borrow_and_update() {
            Health::Good => ServingStatus::Serving,
            Health::Stuck { .. } => ServingStatus::NotServing,
        };
        for name in ["Fleet", "Experiments", "Lineage", "Evaluation"] {
            reporter.set_service_status(format!("hatchery.v1.{name}"), status).await;
        }
        if lineage.changed().await.is_err() {
            return; // the lineage is closed
        }
    }
}

/// Writes down which workers come and go.
async fn note_workers(mut changes: broadcast::Receiver<Change>, lineage: Lineage) {
    loop {
        let written = match changes.recv().await {
            Ok(Change::Joined(worker)) => {
                tracing::info!(
                    worker = worker.name,
                    host = worker.host,
                    slots = worker.slots,
                    "worker joined"
                );
                lineage.worker_joined(worker).await
            }
            Ok(Change::Left { name, reason }) => {
                tracing::info!(worker = name, reason, "worker left");
                lineage.worker_left(name, reason.to_owned()).await
            }
            Ok(Change::Quarantined(verdict)) => {
                let event = denunciation(&verdict);
                match lineage.worker_quarantined(verdict.worker).await {
                    Ok(()) => lineage.event(event).await,
                    Err(closed) => Err(closed),
                }
            }
            Err(RecvError::Lagged(missed)) => {
                tracing::warn!(missed, "comings and goings of workers were not written down");
                Ok(())
            }
            Err(RecvError::Closed) => return,
        };
        if written.is_err() {
            return; // The lineage is closed; so will be the fleet.
        }
    }
}

/// A quarantine as an event of the service.
fn denunciation(verdict: &Quarantine) -> Event {
    let side = |found: &Result<Outcome, SetAside>| match found {
        Ok(outcome) => json!({
            "fitness": outcome.fitness,
            "fitness_bits": format!("{:016x}", outcome.fitness.to_bits()),
            "steps": outcome.steps,
        }),
        Err(aside) => json!({ "failed": aside.reason }),
    };
    Event {
        experiment: None,
        kind: "quarantine".to_owned(),
        text: format!(
            "worker `{}` found other bits than `{}` for evaluation {}, and is trusted no more",
            verdict.worker,
            verdict.witnesses.join("` and `"),
            verdict.evaluation
        ),
        data: json!({
            "worker": verdict.worker,
            "evaluation": verdict.evaluation,
            "found": side(&verdict.found),
            "against": side(&verdict.against),
            "witnesses": verdict.witnesses,
        }),
    }
}

/// Writes beside and renames, so that a reader sees all of it or nothing.
fn write_whole(path: &std::path::Path, text: &str) -> std::io::Result<()> {
    let beside = path.with_extension("part");
    std::fs::write(&beside, text)?;
    std::fs::rename(&beside, path)
}

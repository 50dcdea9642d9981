//! What a coordinator is told when it starts: flags over environment over defaults. It opens nothing.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

/// The settings of one coordinator.
#[derive(Debug, Clone, clap::Args)]
pub struct Config {
    /// The lineage file; made if it does not exist
    #[arg(long, value_name = "FILE", default_value = "hatchery.db", env = "HATCHERY_DB")]
    pub db: PathBuf,
    /// The address to listen on; port 0 takes a free one
    #[arg(long, value_name = "ADDR", default_value_t = LISTEN, env = "HATCHERY_LISTEN")]
    pub listen: SocketAddr,
    /// The folder that `hatchery-coordinator init` made: serve over TLS, and let in who has a token of it. Without
    /// it only this machine is listened to
    #[arg(long, value_name = "DIR", env = "HATCHERY_CREDENTIALS")]
    pub credentials: Option<PathBuf>,
    /// Write the address listened on to a file once it is open, for scripts that use port 0
    #[arg(long, value_name = "FILE")]
    pub address_file: Option<PathBuf>,
    /// Answer GET /metrics with Prometheus text on this address; anybody who reaches it can read it
    #[arg(long, value_name = "ADDR", env = "HATCHERY_METRICS")]
    pub metrics: Option<SocketAddr>,
    /// How often a worker has to show that it is alive, milliseconds
    #[arg(long, value_name = "MS", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(10..=60_000))]
    pub heartbeat_ms: u32,
    /// Silence after which a worker's leases end, milliseconds
    #[arg(long, value_name = "MS", default_value_t = 5000, value_parser = clap::value_parser!(u32).range(30..=600_000))]
    pub timeout_ms: u32,
    /// Time after which an evaluation that still runs counts as hung, seconds: its worker is told to end, and the
    /// evaluation is tried elsewhere, three times at most
    #[arg(long, value_name = "S", default_value_t = OVERDUE_S, value_parser = clap::value_parser!(u32).range(1..=604_800))]
    pub overdue_s: u32,
}

/// Where it listens, unless told otherwise.
pub(crate) const LISTEN: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 7878);
/// A quarter of an hour: thousands of times what any published system takes.
const OVERDUE_S: u32 = 900;

impl Config {
    /// A coordinator on a free loopback port, with the defaults: what `hatchery run` embeds.
    pub fn embedded(db: PathBuf) -> Config {
        Config {
            db,
            listen: SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0),
            credentials: None,
            address_file: None,
            metrics: None,
            heartbeat_ms: 1000,
            timeout_ms: 5000,
            overdue_s: OVERDUE_S,
        }
    }
}

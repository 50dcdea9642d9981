//! `hatchery-coordinator health`: asks the coordinator on this machine how it is, for those who start it again: their
//! own probes by gRPC know no TLS. It needs no token.

use crate::config::LISTEN;
use crate::credentials;
use anyhow::{Context as _, bail};
use proto::dial::Address;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::PathBuf;
use std::time::Duration;
use tokio::time::timeout;
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;

/// `health`.
#[derive(Debug, clap::Args)]
#[command(after_help = HELP)]
pub struct Health {
    /// Where it listens
    #[arg(long, value_name = "ADDR", default_value_t = LISTEN, env = "HATCHERY_LISTEN")]
    listen: SocketAddr,
    /// The folder of its credentials, if it has some
    #[arg(long, value_name = "DIR", env = "HATCHERY_CREDENTIALS")]
    credentials: Option<PathBuf>,
    /// Ask also whether it can write its lineage: without that it lives, and is of no use for the moment
    #[arg(long)]
    ready: bool,
    /// How long it may take to answer, seconds
    #[arg(long, value_name = "S", default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..=600))]
    within: u64,
}

const HELP: &str = "\
Exits with 0 if all is well, else with 1 and a word on standard error.

Examples:
  hatchery-coordinator health
  hatchery-coordinator health --ready --listen 0.0.0.0:7878 --credentials /etc/hatchery/credentials";

impl Health {
    /// Asks.
    ///
    /// # Errors
    /// Nobody answers in time, or whoever does is somebody else or not well.
    pub async fn execute(self) -> anyhow::Result<()> {
        let here = reachable(self.listen);
        let address = match &self.credentials {
            Some(folder) => credentials::address(folder, here)?,
            None => Address::plain(&format!("http://{here}"))?,
        };
        let within = Duration::from_secs(self.within);
        // Which of the services is all the same: they need the lineage alike.
        let service = if self.ready { "hatchery.v1.Experiments" } else { "" };
        let asked = async {
            let mut client = HealthClient::new(address.connect().await?);
            let answer = client.check(HealthCheckRequest { service: service.to_owned() }).await;
            anyhow::Ok(answer.context("it does not say how it is")?.into_inner().status())
        };
        let status = timeout(within, asked).await;
        match status
            .with_context(|| format!("the coordinator at {here} does not answer within {within:?}"))??
        {
            ServingStatus::Serving => Ok(()),
            _ if self.ready => bail!("the coordinator at {here} cannot write its lineage: its log says why"),
            _ => bail!("the coordinator at {here} says that it is not well"),
        }
    }
}

/// Whoever listens on every address is reached on the loopback.
fn reachable(listen: SocketAddr) -> SocketAddr {
    let ip = match listen.ip() {
        IpAddr::V4(Ipv4Addr::UNSPECIFIED) => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(Ipv6Addr::UNSPECIFIED) => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    SocketAddr::new(ip, listen.port())
}

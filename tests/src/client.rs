//! Questions over gRPC, as any client may ask them. A coordinator that is away is waited for, since tests kill
//! it.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use proto::dial::{Address, Line};
use proto::v1::experiments_client::ExperimentsClient;
use proto::v1::fleet_client::FleetClient;
use proto::v1::lineage_client::LineageClient;
use proto::v1::{self, query_request::What, value::Kind};
use tonic::{Code, Status};

/// How long an answer may take while nothing is wrong; a machine under load included.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// A client with a runtime of its own, so that tests stay plain functions.
#[derive(Debug)]
pub struct Client {
    runtime: tokio::runtime::Runtime,
    channel: Line,
}

impl Client {
    /// A client of a coordinator without credentials; it connects when first asked.
    pub fn new(address: SocketAddr) -> Client {
        Client::of(Address::plain(&format!("http://{address}")).expect("an address makes a URL"))
    }

    /// A client of any coordinator.
    pub fn of(address: Address) -> Client {
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.expect("a runtime starts");
        let address = address.with(|endpoint| endpoint.connect_timeout(Duration::from_secs(1)));
        let channel = runtime.block_on(async { address.connect_lazy() });
        Client { runtime, channel }
    }

    /// The connection, for services that this client does not wrap.
    pub fn channel(&self) -> Line {
        self.channel.clone()
    }

    /// Runs a conversation to its end.
    pub fn converse<T>(&self, conversation: impl Future<Output = T>) -> T {
        self.runtime.block_on(conversation)
    }

    /// Asks until there is an answer: `UNAVAILABLE` and broken connections are asked again.
    fn ask<T, F: Future<Output = Result<T, Status>>>(
        &self,
        question: impl Fn(Line) -> F,
    ) -> Result<T, Status> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            match self.converse(question(self.channel.clone())) {
                Err(status) if broken(&status) && Instant::now() < deadline => {
                    std::thread::sleep(Duration::from_millis(20));
                }
                answer => return answer,
            }
        }
    }

    /// Submits an experiment file; the experiments that it makes.
    ///
    /// # Errors
    /// The coordinator's refusal.
    pub fn submit(&self, text: &str, set: &[&str]) -> Result<Vec<v1::Experiment>, Status> {
        let request = v1::SubmitRequest {
            text: text.to_owned(),
            set: set.iter().map(|&s| s.to_owned()).collect(),
            ..Default::default()
        };
        let reply = self.ask(|channel| {
            let request = request.clone();
            async move { ExperimentsClient::new(channel).submit(request).await }
        });
        Ok(reply?.into_inner().experiments)
    }

    /// An experiment's state and progress.
    ///
    /// # Errors
    /// `NOT_FOUND`.
    pub fn experiment(&self, id: u64) -> Result<v1::Experiment, Status> {
        let reference = v1::GetRequest { experiment: id.to_string() };
        let reply = self.ask(|channel| {
            let reference = reference.clone();
            async move { ExperimentsClient::new(channel).get(reference).await }
        });
        Ok(reply?.into_inner())
    }

    /// Waits until an experiment satisfies a condition.
    ///
    /// # Panics
    /// When it does not in time.
    pub fn wait_until(&self, id: u64, condition: impl Fn(&v1::Experiment) -> bool) -> v1::Experiment {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let experiment = self.experiment(id).expect("the experiment was submitted");
            if condition(&experiment) {
                return experiment;
            }
            assert!(Instant::now() < deadline, "waited {PATIENCE:?} in vain: {experiment:#?}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Waits for an experiment to finish, by watching it: a question again and again would be work for the
    /// coordinator that is waited for.
    ///
    /// # Panics
    /// When it fails, is cancelled or takes too long.
    pub fn wait(&self, id: u64) -> v1::Experiment {
        let request = v1::WatchRequest { experiment: id.to_string() };
        // A coordinator that is away, or goes away meanwhile, is watched anew.
        let watching = async {
            while self.watch(&request).await.is_err() {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
        };
        let watched = self.converse(async { tokio::time::timeout(PATIENCE, watching).await });
        let experiment = self.experiment(id).expect("the experiment was submitted");
        assert!(watched.is_ok(), "waited {PATIENCE:?} in vain: {experiment:#?}");
        assert_eq!(experiment.state, "finished", "{}", experiment.reason);
        experiment
    }

    /// Returns when the experiment has ended.
    async fn watch(&self, request: &v1::WatchRequest) -> Result<(), Status> {
        let mut experiments = ExperimentsClient::new(self.channel.clone());
        let mut events = experiments.watch(request.clone()).await?.into_inner();
        while events.message().await?.is_some() {}
        Ok(())
    }

    /// The choices of an experiment at the end of its stages so far.
    pub fn choices(&self, id: u64) -> Vec<v1::Choice> {
        let request = v1::CandidatesRequest { experiment: id.to_string(), stage: String::new() };
        let reply = self.ask(|channel| {
            let request = request.clone();
            async move { ExperimentsClient::new(channel).candidates(request).await }
        });
        reply.expect("the experiment was submitted").into_inner().choices
    }

    /// Picks who goes on.
    ///
    /// # Errors
    /// The coordinator's refusal.
    pub fn pick(&self, id: u64, individual: u64) -> Result<v1::Experiment, Status> {
        let request = v1::PickRequest { experiment: id.to_string(), individual, note: String::new() };
        let reply = self.converse(ExperimentsClient::new(self.channel.clone()).pick(request));
        Ok(reply?.into_inner())
    }

    /// The lineage hash of an experiment, in hexadecimal.
    pub fn hash(&self, id: u64) -> String {
        let request = v1::HashRequest { experiment: id.to_string() };
        let reply = self.ask(|channel| {
            let request = request.clone();
            async move { LineageClient::new(channel).hash(request).await }
        });
        let hashes = reply.expect("the experiment was submitted").into_inner().hashes;
        assert_eq!(hashes.len(), 1, "one experiment has one hash");
        assert!(hashes[0].finished, "tests compare finished lineages");
        hashes[0].hash.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// The rows of a question in SQL.
    ///
    /// # Errors
    /// The lineage's refusal.
    pub fn rows(&self, sql: &str) -> Result<Vec<Vec<Option<Kind>>>, Status> {
        let request = v1::QueryRequest { what: Some(What::Sql(sql.to_owned())), ..Default::default() };
        self.ask(|channel| {
            let request = request.clone();
            async move {
                let mut replies = LineageClient::new(channel).query(request).await?.into_inner();
                let mut rows = Vec::new();
                while let Some(reply) = replies.message().await? {
                    let values = |row: v1::Row| row.values.into_iter().map(|value| value.kind).collect();
                    rows.extend(reply.rows.into_iter().map(values));
                }
                Ok(rows)
            }
        })
    }

    /// The one whole number that a question comes to.
    ///
    /// # Panics
    /// When the answer is anything else.
    pub fn count(&self, sql: &str) -> i64 {
        match self.rows(sql).unwrap_or_else(|status| panic!("{sql}: {status}")).as_slice() {
            [row] if matches!(row.as_slice(), [Some(Kind::Integer(_))]) => match row[0] {
                Some(Kind::Integer(number)) => number,
                _ => unreachable!("matched above"),
            },
            other => panic!("{sql}: expected one whole number, found {other:?}"),
        }
    }

    /// Whether a service, as in `hatchery.v1.Fleet`, tells probes that it is of use.
    pub fn serves(&self, service: &str) -> bool {
        use tonic_health::pb::{
            HealthCheckRequest, health_check_response::ServingStatus, health_client::HealthClient,
        };
        let request = HealthCheckRequest { service: service.to_owned() };
        let reply = self.ask(|channel| {
            let request = request.clone();
            async move { HealthClient::new(channel).check(request).await }
        });
        reply.expect("health answers").into_inner().status() == ServingStatus::Serving
    }

    /// Who is attached.
    pub fn workers(&self) -> Vec<v1::WorkerInfo> {
        let reply =
            self.ask(|channel| async move { FleetClient::new(channel).workers(v1::WorkersRequest {}).await });
        reply.expect("the fleet answers").into_inner().workers
    }
}

/// Whether a status only says that the coordinator was away.
fn broken(status: &Status) -> bool {
    match status.code() {
        Code::Unavailable => true,
        // A connection that breaks under a call comes as one of these, with the transport's error as source.
        Code::Unknown | Code::Internal | Code::Cancelled => std::error::Error::source(status).is_some(),
        _ => false,
    }
}

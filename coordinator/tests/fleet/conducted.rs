//! Experiments of a whole coordinator, with a worker in the hands of each test.

use super::hands::{PATIENCE, Raw, Service, hello};
use bytes::Bytes;
use coordinator::{Config, Running};
use proto::v1;
use proto::v1::experiments_client::ExperimentsClient;
use sqlx::{ConnectOptions as _, Connection as _, Executor as _};
use std::path::Path;
use std::time::Duration;
use tokio::time::timeout;
use tonic::transport::Channel;

const PROBE: &str =
    "name = \"load\"\nsystem = \"probe\"\n[search]\nkind = \"probe\"\npopulation = 8\ngenerations = 3\n";

/// A coordinator, as its clients and workers know it.
struct House {
    running: Running,
    service: Service,
}

impl House {
    async fn open(db: &Path) -> House {
        let running = coordinator::start(Config::embedded(db.to_owned())).await.unwrap();
        let channel = Channel::from_shared(format!("http://{}", running.address())).unwrap();
        let service =
            Service { fleet: running.driver().fleet().clone(), channel: channel.connect().await.unwrap() };
        House { running, service }
    }

    fn client(&self) -> ExperimentsClient<Channel> {
        ExperimentsClient::new(self.service.channel.clone())
    }

    async fn submit(&self) {
        let request = v1::SubmitRequest { text: PROBE.to_owned(), ..Default::default() };
        self.client().submit(request).await.unwrap();
    }

    /// A worker of one slot that is handed one at a time.
    async fn join(&self) -> Raw {
        let fingerprint = Bytes::copy_from_slice(&creatures::fingerprint());
        let version = env!("CARGO_PKG_VERSION").to_owned();
        self.service.attach(v1::Hello { fingerprint, version, ..hello("a", 1, 1) }).await.unwrap()
    }

    async fn experiment(&self) -> v1::Experiment {
        let request = v1::GetRequest { experiment: "last".to_owned() };
        self.client().get(request).await.unwrap().into_inner()
    }
}

fn last() -> v1::ControlRequest {
    v1::ControlRequest { experiment: "last".to_owned() }
}

#[tokio::test(flavor = "multi_thread")]
async fn who_cancels_keeps_what_was_settled() {
    let folder = tempfile::tempdir().unwrap();
    let house = House::open(&folder.path().join("test.db")).await;
    house.submit().await;
    let mut worker = house.join().await;
    for _ in 0..3 {
        let batch = worker.batch().await;
        worker.complete(&batch[0]).await;
    }
    worker.batch().await; // the third is settled, and perhaps not on disk
    house.client().cancel(last()).await.unwrap();
    let cancelled = house.experiment().await;
    assert_eq!((cancelled.state.as_str(), cancelled.evaluated), ("cancelled", 3));
    house.running.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_lineage_that_cannot_be_read_pauses_its_experiments_and_fails_none() {
    let folder = tempfile::tempdir().unwrap();
    let db = folder.path().join("test.db");
    let house = House::open(&db).await;
    house.submit().await;
    house.join().await.batch().await;
    house.running.shutdown().await;
    // What a run is taken up from is away, and no more.
    let mut beside = sqlx::sqlite::SqliteConnectOptions::new().filename(&db).connect().await.unwrap();
    beside.execute("ALTER TABLE checkpoint RENAME TO mislaid").await.unwrap();
    let house = House::open(&db).await;
    let rests = async {
        loop {
            let experiment = house.experiment().await;
            if experiment.state != "running" {
                return experiment;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    };
    let rests = timeout(PATIENCE, rests).await.unwrap();
    assert_eq!(rests.state, "paused", "{}", rests.reason);
    assert!(
        rests.reason.contains("could not be read") && rests.reason.contains("hatchery resume 1"),
        "{}",
        rests.reason
    );
    beside.execute("ALTER TABLE mislaid RENAME TO checkpoint").await.unwrap();
    beside.close().await.unwrap();
    house.client().resume(last()).await.unwrap();
    assert_eq!(house.join().await.batch().await.len(), 1, "it goes on");
    house.running.shutdown().await;
}

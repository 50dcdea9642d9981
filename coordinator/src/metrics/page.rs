//! One page of metrics: the counters of fleet and lineage as they stand, and gauges that are read off when
//! somebody asks.

use crate::driver::Driver;
use crate::fleet::WorkerState;
use crate::lineage::Health;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::Registry;
use std::path::PathBuf;
use std::sync::atomic::AtomicU64;
use tokio::sync::Mutex;

type Labels = Vec<(&'static str, String)>;
type Figure = Gauge<f64, AtomicU64>;

pub(super) struct Page {
    driver: Driver,
    database: PathBuf,
    /// Whoever asks sets the gauges and reads them before the next one does.
    gauges: Mutex<Gauges>,
}

struct Gauges {
    registry: Registry,
    queue_depth: Gauge,
    in_flight: Gauge,
    workers: Family<[(&'static str, &'static str); 1], Gauge>,
    slots: Family<[(&'static str, &'static str); 1], Gauge>,
    stuck: Gauge,
    bytes: Family<[(&'static str, &'static str); 1], Gauge>,
    stage: Family<Labels, Gauge>,
    generation: Family<Labels, Gauge>,
    best: Family<Labels, Figure>,
}

impl Page {
    pub(super) fn new(driver: Driver, database: PathBuf) -> Page {
        let mut registry = Registry::with_prefix("hatchery");
        let fingerprint = driver.fleet().settings().fingerprint;
        let build = Info::new([
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("fingerprint", fingerprint[..6].iter().map(|byte| format!("{byte:02x}")).collect()),
        ]);
        registry.register("build", "The release, and the beginning of its physics fingerprint", build);
        driver.fleet().counts().register(&mut registry);
        driver.lineage().commits().register(&mut registry);
        Page { driver, database, gauges: Mutex::new(Gauges::new(registry)) }
    }

    /// The page as of now.
    pub(super) async fn text(&self) -> String {
        let workers = self.driver.fleet().workers().await;
        let summary = *self.driver.fleet().summary().borrow();
        let gauges = self.gauges.lock().await;
        gauges.queue_depth.set(summary.ready as i64);
        gauges.in_flight.set(summary.in_flight as i64);
        gauges.take_workers(&workers);
        let is_stuck = *self.driver.lineage().health().borrow() != Health::Good;
        gauges.stuck.set(i64::from(is_stuck));
        for (file, suffix) in [("database", ""), ("wal", "-wal")] {
            let mut path = self.database.as_os_str().to_owned();
            path.push(suffix);
            // A log that is not there has no bytes.
            let size = std::fs::metadata(PathBuf::from(path)).map_or(0, |metadata| metadata.len());
            gauges.bytes.get_or_create(&[("file", file)]).set(size as i64);
        }
        gauges.take_progress(&self.driver);
        let mut text = String::new();
        encode(&mut text, &gauges.registry).expect("a string takes whatever is written to it");
        text
    }
}

impl Gauges {
    fn new(mut registry: Registry) -> Gauges {
        let mut gauges = Gauges {
            registry: Registry::default(),
            queue_depth: Gauge::default(),
            in_flight: Gauge::default(),
            workers: Family::default(),
            slots: Family::default(),
            stuck: Gauge::default(),
            bytes: Family::default(),
            stage: Family::default(),
            generation: Family::default(),
            best: Family::new_with_constructor(Figure::default),
        };
        let r = &mut registry;
        r.register(
            "queue_depth",
            "Evaluations that wait to be handed out, those of paused experiments included",
            gauges.queue_depth.clone(),
        );
        r.register("in_flight", "Evaluations that workers hold", gauges.in_flight.clone());
        r.register("workers", "Workers attached, by state", gauges.workers.clone());
        r.register("slots", "Slots of the workers attached, by state", gauges.slots.clone());
        r.register("lineage_stuck", "1 while commits fail", gauges.stuck.clone());
        r.register("lineage_bytes", "Size of the lineage's files", gauges.bytes.clone());
        r.register("stage", "Stage that a run is in, from 0", gauges.stage.clone());
        r.register(
            "generation",
            "Generation of its stage that a run is in, from 1",
            gauges.generation.clone(),
        );
        r.register("best_fitness", "Best fitness of a run since it was taken up", gauges.best.clone());
        gauges.registry = registry;
        gauges
    }

    fn take_workers(&self, workers: &[crate::fleet::WorkerInfo]) {
        let (mut attached, mut draining, mut quarantined, mut slots) = (0, 0, 0, [0u64; 3]);
        for worker in workers {
            let busy = u64::from(worker.in_flight.min(worker.slots));
            let rest = u64::from(worker.slots) - busy;
            match worker.state {
                WorkerState::Attached => (attached, slots[1]) = (attached + 1, slots[1] + rest),
                WorkerState::Draining => (draining, slots[2]) = (draining + 1, slots[2] + rest),
                // It has nothing, and is asked for nothing.
                WorkerState::Quarantined => {
                    quarantined += 1;
                    continue;
                }
                WorkerState::Gone => continue,
            }
            slots[0] += busy;
        }
        for (state, count) in [("attached", attached), ("draining", draining), ("quarantined", quarantined)] {
            self.workers.get_or_create(&[("state", state)]).set(count);
        }
        for (state, count) in ["busy", "idle", "draining"].into_iter().zip(slots) {
            self.slots.get_or_create(&[("state", state)]).set(count as i64);
        }
    }

    /// Experiments that have ended leave the page.
    fn take_progress(&self, driver: &Driver) {
        self.stage.clear();
        self.generation.clear();
        self.best.clear();
        for (id, name, progress) in driver.conducted() {
            for (index, run) in progress.counts().runs.iter().enumerate() {
                let labels = vec![
                    ("experiment", id.to_string()),
                    ("name", name.clone()),
                    ("run", (index + 1).to_string()),
                ];
                self.stage.get_or_create(&labels).set(run.stage.into());
                self.generation.get_or_create(&labels).set(run.generation.into());
                if let Some((_, fitness)) = run.best {
                    self.best.get_or_create(&labels).set(fitness);
                }
            }
        }
    }
}

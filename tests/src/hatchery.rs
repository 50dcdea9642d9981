//! One hatchery at work: a coordinator on a free port, its lineage in a temporary folder, and named workers,
//! each a process that can be killed, frozen and started again.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use rustix::process::Signal;
use tempfile::TempDir;

use proto::dial::Address;
use proto::join::Token;

use crate::client::{Client, PATIENCE};
use crate::keeper::Keeper;
use crate::process::Process;
use crate::programs::program;
use crate::relay::{Relay, Weather};

/// Short, so that a silent worker is missed within a test; long enough for a machine under load.
const HEARTBEAT_MS: u32 = 100;
const TIMEOUT_MS: u32 = 1000;

/// A coordinator and its workers. Everything ends when this is dropped.
#[derive(Debug)]
pub struct Hatchery {
    workers: BTreeMap<String, Process>,
    coordinator: Process,
    address: SocketAddr,
    client: Client,
    /// Who keeps the credentials, if it has some.
    keeper: Option<Keeper>,
    /// What its processes log.
    level: &'static str,
    folder: TempDir,
    /// Heartbeat and timeout, ms.
    pace: [u32; 2],
}

impl Hatchery {
    /// Starts a coordinator on a new lineage.
    pub fn new() -> Hatchery {
        let folder = tempfile::tempdir().expect("a temporary folder");
        Hatchery::in_folder(folder)
    }

    /// Starts a coordinator on a new lineage and workers `w1`, `w2`, … of one slot each.
    pub fn with_workers(count: usize) -> Hatchery {
        let mut hatchery = Hatchery::new();
        for number in 1..=count {
            hatchery.join(&format!("w{number}"));
        }
        hatchery
    }

    /// Starts a coordinator on a new lineage that hears of its workers at a pace of its own, milliseconds.
    pub fn with_heartbeat(heartbeat_ms: u32, timeout_ms: u32) -> Hatchery {
        let folder = tempfile::tempdir().expect("a temporary folder");
        Hatchery::start(folder, [heartbeat_ms, timeout_ms])
    }

    /// Starts a coordinator in a folder, which may hold a lineage already.
    pub fn in_folder(folder: TempDir) -> Hatchery {
        Hatchery::start(folder, [HEARTBEAT_MS, TIMEOUT_MS])
    }

    fn start(folder: TempDir, pace: [u32; 2]) -> Hatchery {
        let any_port = "127.0.0.1:0".parse().expect("an address");
        let (coordinator, address) = start_coordinator(folder.path(), any_port, pace, None, "info");
        let client = Client::new(address);
        let (workers, keeper) = (BTreeMap::new(), None);
        Hatchery { workers, coordinator, address, client, keeper, level: "info", folder, pace }
    }

    /// Starts a coordinator behind TLS, on a new lineage, with a token for workers and one for clients.
    pub fn with_credentials() -> Hatchery {
        Hatchery::with_credentials_and_log("info")
    }

    /// The same, with logs of a level, from its workers as well.
    pub fn with_credentials_and_log(level: &'static str) -> Hatchery {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut keeper = Keeper::found(folder.path());
        let any_port = "127.0.0.1:0".parse().expect("an address");
        let pace = [HEARTBEAT_MS, TIMEOUT_MS];
        let (coordinator, address) = start_coordinator(folder.path(), any_port, pace, Some(&keeper), level);
        keeper.moved(address);
        let client = Client::of(Address::of(keeper.client()));
        let (workers, keeper) = (BTreeMap::new(), Some(keeper));
        Hatchery { workers, coordinator, address, client, keeper, level, folder, pace }
    }

    /// Who keeps the credentials.
    ///
    /// # Panics
    /// When there are none.
    pub fn keeper(&self) -> &Keeper {
        self.keeper.as_ref().expect("it was started with credentials")
    }

    /// Where everything is.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The lineage file.
    pub fn db(&self) -> PathBuf {
        self.folder.path().join("lineage.db")
    }

    /// What clients and workers dial.
    pub fn url(&self) -> String {
        format!("http://{}", self.address)
    }

    /// Questions to the coordinator.
    pub fn client(&self) -> &Client {
        &self.client
    }

    /// The coordinator's process.
    pub fn coordinator(&mut self) -> &mut Process {
        &mut self.coordinator
    }

    /// Where the coordinator listens.
    pub fn address(&self) -> String {
        self.address.to_string()
    }

    /// Asks the coordinator how it is, as a probe does.
    pub fn health(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(program("hatchery-coordinator"));
        command.args(["health", "--listen", &self.address()]).args(arguments);
        if let Some(keeper) = &self.keeper {
            command.arg("--credentials").arg(keeper.folder());
        }
        command.output().expect("the binary was built")
    }

    /// SIGKILL to the coordinator; nothing is started in its stead.
    pub fn kill_coordinator(&mut self) {
        self.coordinator.kill();
    }

    /// Starts the coordinator again on the same lineage and address.
    pub fn restart_coordinator(&mut self) {
        self.coordinator.kill();
        let keeper = self.keeper.as_ref();
        (self.coordinator, _) =
            start_coordinator(self.folder.path(), self.address, self.pace, keeper, self.level);
    }

    /// Starts a worker of one slot.
    pub fn join(&mut self, name: &str) {
        self.join_as(name, "hatchery-worker", &[]);
    }

    /// Starts a worker of one slot from a binary of its own, with further arguments.
    pub fn join_as(&mut self, name: &str, binary: &str, arguments: &[&str]) {
        self.join_at(self.address, name, binary, arguments);
    }

    /// Starts a worker of one slot that reaches the coordinator through a relay of its own, and gives the relay.
    pub fn join_through(&mut self, name: &str, weather: Weather) -> Relay {
        let relay = Relay::new(self.address, weather);
        self.join_at(relay.address(), name, "hatchery-worker", &[]);
        relay
    }

    fn join_at(&mut self, address: SocketAddr, name: &str, binary: &str, arguments: &[&str]) {
        let mut command = Command::new(program(binary));
        command.args(["--slots", "1", "--name", name]).args(arguments);
        match &self.keeper {
            Some(keeper) => {
                let token = Token { address: address.to_string(), ..keeper.worker().clone() };
                command.env("HATCHERY_JOIN", token.to_string())
            }
            None => command.args(["--coordinator", &format!("http://{address}")]),
        };
        self.join_by(name, &mut command);
    }

    /// Starts a worker by a command line of the test's.
    pub fn join_by(&mut self, name: &str, command: &mut Command) {
        command.env("HATCHERY_LOG", self.level);
        let log = self.folder.path().join(format!("{name}.log"));
        self.workers.insert(name.to_owned(), Process::start(command, &log));
    }

    /// A worker's process.
    ///
    /// # Panics
    /// When none of that name was started.
    pub fn worker(&mut self, name: &str) -> &mut Process {
        self.workers.get_mut(name).unwrap_or_else(|| panic!("no worker {name} was started"))
    }

    /// SIGKILL to a worker.
    pub fn kill(&mut self, name: &str) {
        self.worker(name).kill();
    }

    /// SIGSTOP to a worker: its connection stays open, and nothing more comes from it.
    pub fn freeze(&mut self, name: &str) {
        self.worker(name).signal(Signal::STOP);
    }

    /// SIGCONT to a worker.
    pub fn thaw(&mut self, name: &str) {
        self.worker(name).signal(Signal::CONT);
    }

    /// Waits until so many workers are attached.
    ///
    /// # Panics
    /// When they are not in time.
    pub fn wait_attached(&self, count: usize) {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let workers = self.client.workers();
            if workers.iter().filter(|worker| worker.state == "attached").count() == count {
                return;
            }
            assert!(Instant::now() < deadline, "{count} workers should be attached: {workers:#?}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Submits one experiment; its number.
    ///
    /// # Panics
    /// When it is refused.
    pub fn submit(&self, text: &str) -> u64 {
        let experiments =
            self.client.submit(text, &[]).unwrap_or_else(|status| panic!("refused: {status:?}"));
        assert_eq!(experiments.len(), 1, "a file without a matrix makes one experiment");
        experiments[0].id
    }

    /// Submits one experiment, waits for its end and gives its lineage hash.
    pub fn lineage_of(&self, text: &str) -> String {
        let id = self.submit(text);
        self.client.wait(id);
        self.client.hash(id)
    }
}

impl Default for Hatchery {
    fn default() -> Self {
        Hatchery::new()
    }
}

fn start_coordinator(
    folder: &Path,
    listen: SocketAddr,
    pace: [u32; 2],
    keeper: Option<&Keeper>,
    level: &str,
) -> (Process, SocketAddr) {
    let file = folder.join("address");
    // One of an earlier start would be read before this one is there.
    let _ = std::fs::remove_file(&file);
    let mut command = Command::new(program("hatchery-coordinator"));
    command.arg("--db").arg(folder.join("lineage.db"));
    command.arg("--listen").arg(listen.to_string()).arg("--address-file").arg(&file);
    command.arg("--heartbeat-ms").arg(pace[0].to_string());
    command.arg("--timeout-ms").arg(pace[1].to_string());
    command.env("HATCHERY_LOG", level);
    if let Some(keeper) = keeper {
        command.arg("--credentials").arg(keeper.folder());
    }
    let mut process = Process::start(&mut command, &folder.join("coordinator.log"));
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(address) = std::fs::read_to_string(&file).ok().and_then(|text| text.trim().parse().ok()) {
            return (process, address);
        }
        if let Some(status) = process.ended() {
            panic!("the coordinator ended with {status}:\n{}", process.log());
        }
        assert!(Instant::now() < deadline, "the coordinator does not listen:\n{}", process.log());
        std::thread::sleep(Duration::from_millis(5));
    }
}

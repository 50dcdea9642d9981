//! Real processes on a network of their own: a namespace for the coordinator and one for each worker, joined by
//! links that are cut and slowed down. Needs root and `ip`; where these are missing it says so and is skipped.

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use hatchery_tests::client::PATIENCE;
use hatchery_tests::command::{count, hash};
use hatchery_tests::keeper::Keeper;
use hatchery_tests::programs::program;
use hatchery_tests::samples::walkers;
use hatchery_tests::{Process, local};

const POPULATION: u32 = 40;
const GENERATIONS: u32 = 60;

/// Namespaces `hN-c` and `hN-w1`, `hN-w2`, …, deleted when this is dropped.
struct Network {
    prefix: String,
    workers: usize,
}

impl Network {
    /// `None` where the system does not let us.
    fn lay(workers: usize) -> Option<Network> {
        let network = Network { prefix: format!("h{}", std::process::id()), workers };
        let hub = network.name(0);
        let is_laid = ip(&["netns", "add", &hub])
            && ip(&["-n", &hub, "link", "set", "lo", "up"])
            && (1..=workers).all(|number| network.join(number));
        is_laid.then_some(network)
    }

    /// A worker's namespace, with a link of its own to the hub.
    fn join(&self, number: usize) -> bool {
        let (hub, leaf, port) = (self.name(0), self.name(number), port(number));
        ip(&["netns", "add", &leaf])
            && ip(&["-n", &hub, "link", "add", &port, "type", "veth", "peer", "name", "up0", "netns", &leaf])
            && ip(&["-n", &hub, "address", "add", &format!("10.77.{number}.1/30"), "dev", &port])
            && ip(&["-n", &leaf, "address", "add", &format!("10.77.{number}.2/30"), "dev", "up0"])
            && ip(&["-n", &hub, "link", "set", &port, "up"])
            && ip(&["-n", &leaf, "link", "set", "up0", "up"])
    }

    fn name(&self, number: usize) -> String {
        if number == 0 { format!("{}-c", self.prefix) } else { format!("{}-w{number}", self.prefix) }
    }

    /// A command that runs in a namespace, as the process that is started here.
    fn command(&self, number: usize, binary: &str) -> Command {
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &self.name(number)]).arg(program(binary));
        command.env("HATCHERY_LOG", "info");
        command
    }

    fn cut(&self, number: usize) {
        assert!(ip(&["-n", &self.name(0), "link", "set", &port(number), "down"]));
    }

    fn mend(&self, number: usize) {
        assert!(ip(&["-n", &self.name(0), "link", "set", &port(number), "up"]));
    }

    /// Delay and loss on a worker's link, if this kernel has them.
    fn slow(&self, number: usize) -> bool {
        let shape = ["qdisc", "add", "dev", "up0", "root", "netem", "delay", "10ms", "5ms", "loss", "2%"];
        let tc = Command::new("tc").args(["-n", &self.name(number)]).args(shape).output();
        tc.is_ok_and(|output| output.status.success())
    }

    fn coordinator(&self, folder: &Path, keeper: &Keeper) -> Process {
        let mut command = self.command(0, "hatchery-coordinator");
        command.arg("--db").arg(folder.join("hatchery.db"));
        command.args(["--listen", "0.0.0.0:7878", "--credentials"]).arg(keeper.folder());
        command.args(["--heartbeat-ms", "100", "--timeout-ms", "1000"]);
        Process::start(&mut command, &folder.join("coordinator.log"))
    }

    fn worker(&self, folder: &Path, keeper: &Keeper, number: usize) -> Process {
        let mut command = self.command(number, "hatchery-worker");
        // Each reaches the coordinator under another address.
        let mut token = keeper.worker().clone();
        token.address = format!("10.77.{number}.1:7878");
        command.env("HATCHERY_JOIN", token.to_string());
        command.args(["--slots", "1", "--name", &format!("w{number}")]);
        Process::start(&mut command, &folder.join(format!("w{number}.log")))
    }

    /// A client beside the coordinator, which may not listen yet, or not at present.
    fn ask(&self, keeper: &Keeper, arguments: &[&str]) -> Output {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let mut command = self.command(0, "hatchery");
            let output = command.args(arguments).env("HATCHERY_JOIN", keeper.client().to_string()).output();
            let output = output.expect("ip ran before");
            if output.status.success() {
                return output;
            }
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(Instant::now() < deadline, "hatchery {arguments:?}: {said}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        for number in 0..=self.workers {
            ip(&["netns", "delete", &self.name(number)]);
        }
    }
}

/// The hub's end of a worker's link.
fn port(number: usize) -> String {
    format!("down{number}")
}

fn ip(arguments: &[&str]) -> bool {
    Command::new("ip").args(arguments).output().is_ok_and(|output| output.status.success())
}

/// Waits until a count in the lineage has come to a goal.
fn wait(folder: &Path, query: &str, goal: i64) {
    let deadline = Instant::now() + PATIENCE;
    while count(folder, query) < goal {
        assert!(Instant::now() < deadline, "waited in vain for {goal} of {query}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Waits until so many workers are attached: a fault that comes before them meets nothing.
fn attach(folder: &Path, workers: i64) {
    wait(folder, "SELECT count(*) FROM v_workers WHERE left_ms IS NULL", workers);
}

/// Waits until so many more individuals are settled, or all of them.
fn advance(folder: &Path, by: i64) {
    let settled = "SELECT count(*) FROM v_individuals WHERE status <> 'pending'";
    wait(folder, settled, (count(folder, settled) + by).min(i64::from(POPULATION * GENERATIONS)));
}

#[test]
fn cut_links_and_kills_on_a_real_network_cost_time_and_nothing_else() {
    let Some(network) = Network::lay(3) else {
        eprintln!("SKIPPED: network namespaces need root and `ip`, and this test has not got both");
        return;
    };
    for number in 1..=3 {
        if !network.slow(number) {
            eprintln!("without delay and loss: this kernel has no netem (tc qdisc … netem)");
            break;
        }
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let text = walkers("crawler", "grn", 21, POPULATION, GENERATIONS);
    let file = folder.join("experiment.toml");
    std::fs::write(&file, &text).expect("the folder is writable");
    let mut keeper = Keeper::found(folder);
    keeper.moved("127.0.0.1:7878".parse().expect("an address"));
    let keeper = keeper;
    let mut coordinator = network.coordinator(folder, &keeper);
    let mut workers: Vec<Process> = (1..=3).map(|number| network.worker(folder, &keeper, number)).collect();
    network.ask(&keeper, &["workers"]);
    attach(folder, 3);
    network.ask(&keeper, &["submit", &file.to_string_lossy()]);
    advance(folder, 15);

    // Longer than the silence that ends leases.
    network.cut(1);
    advance(folder, 15);
    std::thread::sleep(Duration::from_millis(1500));
    network.mend(1);

    workers[1].kill();
    advance(folder, 15);
    workers[1] = network.worker(folder, &keeper, 2);

    // Everybody is cut off, and meanwhile the coordinator is killed.
    (1..=3).for_each(|number| network.cut(number));
    coordinator.kill();
    coordinator = network.coordinator(folder, &keeper);
    std::thread::sleep(Duration::from_millis(1200));
    (1..=3).for_each(|number| network.mend(number));

    network.ask(&keeper, &["watch", "last"]);
    assert_eq!(hash(folder, "last"), local::lineage(&text));
    let lost = count(folder, "SELECT count(*) FROM v_evaluations WHERE fate LIKE 'lost%'");
    assert!(lost > 0, "no fault met an evaluation under way");
    assert_eq!(count(folder, "SELECT count(*) FROM v_individuals WHERE status = 'failed'"), 0);
    coordinator.kill();
}

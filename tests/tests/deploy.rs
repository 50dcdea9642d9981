//! The scripts of `deploy/`, with a stand-in for what starts them.

use std::process::Command;
use std::time::Duration;

use hatchery_tests::programs::{program, workspace};
use hatchery_tests::samples::walkers;
use hatchery_tests::{Hatchery, Process, local};
use rustix::process::Signal;

/// As sbatch starts it, and as `--signal=B:TERM` ends it: the shell alone gets the signal.
fn slurm(hatchery: &Hatchery, task: u32) -> Process {
    let mut command = Command::new("bash");
    command.arg(workspace().join("deploy/slurm/workers.sh")).arg(hatchery.url());
    command.env("HATCHERY_WORKER_PROGRAM", program("hatchery-worker"));
    command.env("SLURM_JOB_ID", "4711").env("SLURM_ARRAY_TASK_ID", task.to_string());
    command.env("SLURM_CPUS_PER_TASK", "1").env("HATCHERY_LOG", "info");
    Process::start(&mut command, &hatchery.folder().join(format!("slurm-{task}.log")))
}

#[test]
fn a_slurm_job_whose_time_is_up_delivers_what_it_runs_and_ends_well() {
    let text = walkers("crawler", "grn", 31, 30, 3);
    let hatchery = Hatchery::new();
    let (mut first, mut second) = (slurm(&hatchery, 1), slurm(&hatchery, 2));
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |e| e.evaluated >= 5);
    first.signal(Signal::TERM);
    assert_eq!(first.wait(Duration::from_secs(20)).code(), Some(0), "{}", first.log());
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
    let thrown_away =
        "SELECT count(*) FROM v_evaluations WHERE fate LIKE 'lost%' AND fate <> 'lost:returned'";
    assert_eq!(hatchery.client().count(thrown_away), 0, "what ran was delivered");
    second.signal(Signal::TERM);
    assert_eq!(second.wait(Duration::from_secs(20)).code(), Some(0), "{}", second.log());
}

#[test]
fn a_slurm_job_without_a_coordinator_says_what_it_wants() {
    let script = workspace().join("deploy/slurm/workers.sh");
    let mut command = Command::new("bash");
    command.arg(script).env("SLURM_JOB_ID", "1").env_remove("HATCHERY_COORDINATOR");
    command.env_remove("HATCHERY_JOIN").env_remove("HATCHERY_JOIN_FILE");
    let output = command.output().expect("bash starts");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("sbatch --array"));
}

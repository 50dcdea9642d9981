//! The worker processes of `hatchery run`: this executable started again, a slot each, on a leash that ends
//! them when this process does. One that dies is started again after a while; a crew that only dies gives up.
//! It evaluates nothing itself.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::process::Stdio;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::process::{Child, Command};
use tokio::sync::mpsc;
use tokio::task::JoinSet;

/// Waits before a worker is started again, when it keeps dying young.
const BACKOFF_MIN: Duration = Duration::from_millis(100);
const BACKOFF_MAX: Duration = Duration::from_secs(5);
/// A worker that lived so long died of something new.
const LIFE_MIN: Duration = Duration::from_secs(10);
/// Last lines of a worker's standard error that are kept, to tell why it died.
const LAST_WORDS: usize = 6;

/// What the crew has to say.
#[derive(Debug)]
pub(crate) enum News {
    /// One died and is started again.
    Restarted(String),
    /// They only die: nothing more will be evaluated.
    Lost(String),
}

/// The running worker processes. Dropping it kills them; they hold nothing that cannot be evaluated again.
#[derive(Debug)]
pub(crate) struct Crew {
    roster: Arc<Roster>,
    news: mpsc::Receiver<News>,
    _members: JoinSet<()>,
}

/// What the members of a crew share.
#[derive(Debug)]
struct Roster {
    /// The command line that starts a worker.
    program: OsString,
    arguments: Vec<OsString>,
    /// Evaluations on file: deaths are in vain while it stays.
    evaluated: AtomicU64,
    deaths: Mutex<Deaths>,
    deaths_max: u32,
    news: mpsc::Sender<News>,
}

/// Deaths since an evaluation was last completed.
#[derive(Debug, Default)]
struct Deaths {
    in_vain: u32,
    evaluated: u64,
}

impl Crew {
    /// Starts workers for a coordinator.
    pub(crate) fn start(count: u16, coordinator: &str) -> Crew {
        let arguments = ["worker", "--leashed", "--slots", "1", "--coordinator", coordinator];
        Crew::start_program(own_executable(), arguments.map(OsString::from).to_vec(), count)
    }

    fn start_program(program: OsString, arguments: Vec<OsString>, count: u16) -> Crew {
        let (sender, news) = mpsc::channel(64);
        let roster = Arc::new(Roster {
            program,
            arguments,
            evaluated: AtomicU64::new(0),
            deaths: Mutex::default(),
            // A genotype that kills its workers is set aside after three, and every worker may have one such
            // at once: only beyond that is it the workers' own fault.
            deaths_max: 4 * u32::from(count) + 4,
            news: sender,
        });
        let mut members = JoinSet::new();
        for number in 1..=count {
            members.spawn(member(number, roster.clone()));
        }
        Crew { roster, news, _members: members }
    }

    /// Takes note of how many evaluations are on file by now.
    pub(crate) fn evaluated(&self, count: u64) {
        self.roster.evaluated.store(count, Ordering::Relaxed);
    }

    /// What the crew says next. Pending for ever once nobody is left to say anything.
    pub(crate) async fn news(&mut self) -> News {
        match self.news.recv().await {
            Some(news) => news,
            None => std::future::pending().await,
        }
    }
}

/// This executable, also after its file has been replaced: a worker of another release would be refused.
fn own_executable() -> OsString {
    let named = std::env::current_exe().ok().filter(|path| path.exists());
    named.map_or_else(|| "/proc/self/exe".into(), OsString::from)
}

/// Keeps one place of the crew filled.
async fn member(number: u16, roster: Arc<Roster>) {
    let mut wait = BACKOFF_MIN;
    loop {
        let born = Instant::now();
        let end = match roster.spawn(number) {
            Ok(child) => attend(child).await,
            Err(error) => format!("cannot be started: {error}"),
        };
        if roster.gives_up() {
            // The first member that says so ends the run; the others may find nobody listening.
            let _ = roster.news.try_send(News::Lost(format!("worker {number} {end}")));
            return;
        }
        if born.elapsed() >= LIFE_MIN {
            wait = BACKOFF_MIN;
        }
        let text = format!("worker {number} {end}; started again in {:.1} s", wait.as_secs_f64());
        tracing::info!("{text}");
        // Words beyond what anybody takes in are dropped; the log has them.
        let _ = roster.news.try_send(News::Restarted(text));
        tokio::time::sleep(wait).await;
        wait = (wait * 2).min(BACKOFF_MAX);
    }
}

/// Waits for a worker's end, and says how it came, with the worker's last words.
async fn attend(mut child: Child) -> String {
    // The leash: it closes when this process ends, however it ends, or when the worker has gone.
    let leash = child.stdin.take();
    let mut last_words = VecDeque::new();
    if let Some(stderr) = child.stderr.take() {
        let is_wanted = is_log_wanted();
        let mut lines = BufReader::new(stderr).lines();
        while let Ok(Some(line)) = lines.next_line().await {
            if is_wanted {
                // A log that cannot be written is not worth a run.
                let _ = tokio::io::stderr().write_all(format!("{line}\n").as_bytes()).await;
            }
            last_words.push_back(line.trim().to_owned());
            if last_words.len() > LAST_WORDS {
                last_words.pop_front();
            }
        }
    }
    let status = child.wait().await;
    drop(leash);
    let mut end = match status {
        Ok(status) => format!("ended ({status})"),
        Err(error) => format!("was lost ({error})"),
    };
    for (place, words) in last_words.iter().enumerate() {
        end.push_str(if place == 0 { ": " } else { " / " });
        end.push_str(words);
    }
    end
}

fn is_log_wanted() -> bool {
    std::env::var_os("HATCHERY_LOG").is_some_and(|value| !value.is_empty())
}

impl Roster {
    /// Starts a member. Whoever follows one that died has its name, which tells the coordinator that it died.
    fn spawn(&self, number: u16) -> std::io::Result<Child> {
        let mut command = Command::new(&self.program);
        command
            .arg0("hatchery")
            .args(&self.arguments)
            .args(["--name", &format!("run-{}-{number}", std::process::id())])
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            // A group of its own: Ctrl-C is for this process alone, which then sees to an orderly end.
            .process_group(0)
            .kill_on_drop(true);
        if !is_log_wanted() {
            command.env("HATCHERY_LOG", "error");
        }
        // What is set for the workers of another coordinator is not meant for these.
        for setting in worker::command::SETTINGS {
            command.env_remove(setting);
        }
        command.spawn()
    }

    /// Counts a death, and says whether there have been too many in vain.
    fn gives_up(&self) -> bool {
        let mut deaths = self.deaths.lock().unwrap_or_else(PoisonError::into_inner);
        let evaluated = self.evaluated.load(Ordering::Relaxed);
        if evaluated != deaths.evaluated {
            *deaths = Deaths { in_vain: 0, evaluated };
        }
        deaths.in_vain += 1;
        deaths.in_vain > self.deaths_max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crew(script: &str) -> Crew {
        Crew::start_program("/bin/sh".into(), ["-c", script].map(OsString::from).to_vec(), 1)
    }

    /// Restarts until the crew gives up, and why.
    async fn end(mut crew: Crew) -> (u32, String) {
        let mut restarts = 0;
        loop {
            match crew.news().await {
                News::Restarted(_) => restarts += 1,
                News::Lost(why) => return (restarts, why),
            }
        }
    }

    #[tokio::test(start_paused = true)]
    async fn a_crew_that_only_dies_gives_up_and_tells_the_last_words() {
        let (restarts, why) = end(crew("echo no such library >&2; exit 3")).await;
        assert_eq!(restarts, 8);
        assert!(why.contains("worker 1 ended") && why.contains("3): no such library"), "{why}");
    }

    #[tokio::test(start_paused = true)]
    async fn a_crew_that_cannot_be_started_gives_up_as_well() {
        let (_, why) = end(Crew::start_program("/no/such/program".into(), vec![], 2)).await;
        assert!(why.contains("cannot be started"), "{why}");
    }

    #[tokio::test(start_paused = true)]
    async fn deaths_between_which_something_is_evaluated_are_not_in_vain() {
        let mut crew = crew("exit 1");
        for evaluated in 1..=30 {
            assert!(matches!(crew.news().await, News::Restarted(_)));
            crew.evaluated(evaluated);
        }
    }

    #[tokio::test]
    async fn a_worker_ends_with_the_crew() {
        let folder = tempfile::tempdir().unwrap();
        let pid_file = folder.path().join("pid");
        let crew = crew(&format!("echo $$ > {}; exec sleep 600", pid_file.display()));
        let pid = loop {
            match std::fs::read_to_string(&pid_file) {
                Ok(text) if text.ends_with('\n') => break text.trim().to_owned(),
                _ => tokio::time::sleep(Duration::from_millis(10)).await,
            }
        };
        drop(crew);
        let process = std::path::PathBuf::from(format!("/proc/{pid}/stat"));
        let is_alive = || std::fs::read_to_string(&process).is_ok_and(|stat| !stat.contains(" Z "));
        for _ in 0..500 {
            if !is_alive() {
                return;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
        panic!("process {pid} lives on");
    }
}

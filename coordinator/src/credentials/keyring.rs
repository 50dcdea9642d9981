//! The ledger as a running coordinator sees it: read again when its file has changed, so that a token that is revoked
//! counts within a second or two, and a new one at once. It writes nothing.

use super::folder::{Folder, FolderError, LEDGER};
use super::ledger::{Ledger, UnixMs};
use proto::join::{Kind, Pass, TokenError, TokenId};
use std::collections::BTreeSet;
use std::fs::Metadata;
use std::os::unix::fs::MetadataExt as _;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use tokio::sync::watch;
use tonic::{Code, Status};

/// How often the file is looked at.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// How soon it is looked at again for a token that is not known: strangers can have that done, no more often.
const LOOK_AGAIN: Duration = Duration::from_millis(50);

/// Why a call is not let in.
#[derive(Debug, thiserror::Error)]
pub enum Denied {
    /// It shows no pass.
    #[error(
        "this coordinator lets nobody in without a join token: give one as --join-file, HATCHERY_JOIN or --join"
    )]
    Missing,
    /// What it shows is no pass.
    #[error("the `authorization` of this call is no pass")]
    Malformed(#[source] TokenError),
    /// Nobody was given it.
    #[error("token {0} is not known to this coordinator: ask its keeper for a new one")]
    Unknown(TokenId),
    /// It was good.
    #[error("{} token {id} was revoked: ask the coordinator's keeper for a new one", .kind.word())]
    Revoked {
        /// Whom it let in.
        kind: Kind,
        /// Which one.
        id: TokenId,
    },
    /// It was good.
    #[error("{} token {id} has expired: ask the coordinator's keeper for a new one", .kind.word())]
    Expired {
        /// Whom it let in.
        kind: Kind,
        /// Which one.
        id: TokenId,
    },
    /// It is good for other calls.
    #[error("a {} token is not for {call}: that takes a {} token", .has.word(), .needs.word())]
    Kind {
        /// What was shown.
        has: Kind,
        /// What is needed.
        needs: Kind,
        /// For what.
        call: String,
    },
}

/// UNAUTHENTICATED: another token is needed. PERMISSION_DENIED: this one is good, and not for that.
impl From<Denied> for Status {
    fn from(denied: Denied) -> Status {
        let code = match denied {
            Denied::Kind { .. } => Code::PermissionDenied,
            _ => Code::Unauthenticated,
        };
        Status::new(code, denied.to_string())
    }
}

/// Who may come in, as of late. Clones share it.
#[derive(Debug, Clone)]
pub(crate) struct Keyring {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    folder: Folder,
    known: watch::Sender<Arc<Known>>,
    looked: Mutex<Looked>,
}

/// When the file was last looked at, and what it was then.
#[derive(Debug)]
struct Looked {
    at: Instant,
    seen: Option<Mark>,
}

/// The ledger, and which of its tokens are good. It changes with either.
#[derive(Debug)]
struct Known {
    ledger: Ledger,
    good: BTreeSet<TokenId>,
}

impl Known {
    fn new(ledger: Ledger, now: UnixMs) -> Known {
        let good = ledger.entries.iter().filter(|entry| entry.is_good(now)).map(|entry| entry.id).collect();
        Known { ledger, good }
    }
}

impl Keyring {
    /// Reads the ledger of a folder, and follows it until nobody has a clone any more.
    pub(super) fn follow(folder: Folder) -> Result<Keyring, FolderError> {
        if let Some(file) = folder.exposed() {
            tracing::warn!(file = %file.display(), "others on this machine may read this: `chmod 600` it");
        }
        let looked = Mutex::new(Looked { at: Instant::now(), seen: seen(&folder) });
        let known = watch::Sender::new(Arc::new(Known::new(Ledger::read(&folder)?, now())));
        let shared = Arc::new(Shared { folder, known, looked });
        tokio::spawn(follow(Arc::downgrade(&shared)));
        Ok(Keyring { shared })
    }

    /// Lets a pass in that is good for a call.
    pub(crate) fn admit(&self, pass: &Pass, needs: Kind, call: &str) -> Result<Admission, Denied> {
        if self.shared.known.borrow().ledger.find(pass).is_none() {
            self.shared.look_again(); // it may be new
        }
        let known = self.shared.known.borrow();
        let entry = known.ledger.find(pass).ok_or(Denied::Unknown(pass.id))?;
        let admission = Admission { kind: entry.kind, id: entry.id, known: self.shared.known.subscribe() };
        if !known.good.contains(&entry.id) {
            return Err(admission.why_ended());
        }
        if entry.kind != needs {
            return Err(Denied::Kind { has: entry.kind, needs, call: call.to_owned() });
        }
        Ok(admission)
    }
}

/// A call that was let in, for as long as its token is good.
#[derive(Debug, Clone)]
pub(crate) struct Admission {
    kind: Kind,
    id: TokenId,
    known: watch::Receiver<Arc<Known>>,
}

impl Admission {
    /// Waits until its token is good no more.
    pub(crate) async fn ended(mut self) -> Denied {
        let id = self.id;
        match self.known.wait_for(|known| !known.good.contains(&id)).await.map(drop) {
            Ok(()) => self.why_ended(),
            // The coordinator goes away, and says so itself.
            Err(_) => std::future::pending().await,
        }
    }

    fn why_ended(&self) -> Denied {
        let (kind, id) = (self.kind, self.id);
        let known = self.known.borrow();
        match known.ledger.entries.iter().find(|entry| entry.id == id) {
            Some(entry) if entry.revoked_ms.is_none() => Denied::Expired { kind, id },
            Some(_) => Denied::Revoked { kind, id },
            None => Denied::Unknown(id),
        }
    }
}

impl Shared {
    /// Looks at the file unless that was done just now.
    fn look_again(&self) {
        let mut looked = self.looked();
        if looked.at.elapsed() >= LOOK_AGAIN {
            self.look(&mut looked);
        }
    }

    /// Looks at the file, and reads it if it has changed. One that cannot be read changes nothing: what was good stays
    /// so.
    fn look(&self, looked: &mut Looked) {
        let found = seen(&self.folder);
        let mut ledger = None;
        if found != looked.seen {
            match Ledger::read(&self.folder) {
                Ok(read) => ledger = Some(read),
                Err(error) => tracing::error!("{error}; the tokens stay as they were"),
            }
        }
        *looked = Looked { at: Instant::now(), seen: found };
        self.known.send_if_modified(|known| {
            let next = Known::new(ledger.unwrap_or_else(|| known.ledger.clone()), now());
            let is_news = next.good != known.good || next.ledger != known.ledger;
            if is_news {
                tracing::info!(good = next.good.len(), "the tokens have changed");
                *known = Arc::new(next);
            }
            is_news
        });
    }

    fn looked(&self) -> MutexGuard<'_, Looked> {
        self.looked.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Looks at the file now and then, as long as there is a keyring.
async fn follow(shared: Weak<Shared>) {
    let mut ticks = tokio::time::interval(LOOK_EVERY);
    ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        let Some(shared) = shared.upgrade() else { return };
        shared.look(&mut shared.looked());
    }
}

/// What tells one state of a file from another: it is always replaced, never changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Mark {
    inode: u64,
    size: u64,
    changed: (i64, i64),
}

fn seen(folder: &Folder) -> Option<Mark> {
    let mark =
        |of: Metadata| Mark { inode: of.ino(), size: of.len(), changed: (of.mtime(), of.mtime_nsec()) };
    folder.file(LEDGER).metadata().ok().map(mark)
}

/// The wall clock, which tokens expire by.
pub(super) fn now() -> UnixMs {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_millis() as UnixMs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::join::{KEY_SIZE, SECRET_SIZE};

    fn new(folder: &Folder) -> Pass {
        let add = |ledger: &mut Ledger| Ok(ledger.add(Kind::Client, String::new(), 1, None).unwrap());
        Ledger::edit::<_, FolderError>(folder, add).unwrap()
    }

    #[tokio::test]
    async fn a_new_token_is_good_at_once_and_strangers_have_the_file_read_no_more_than_now_and_then() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::at(place.path());
        Ledger::new("head:7878".to_owned(), [4; KEY_SIZE]).write(&folder).unwrap();
        let keyring = Keyring::follow(folder.clone()).unwrap();
        let admit = |pass: &Pass| keyring.admit(pass, Kind::Client, "a call");
        let first = new(&folder);
        assert!(matches!(admit(&first), Err(Denied::Unknown(_))), "the file was read just now");
        std::thread::sleep(LOOK_AGAIN);
        assert!(admit(&first).is_ok());
        std::thread::sleep(LOOK_AGAIN);
        let second = new(&folder);
        assert!(admit(&Pass { secret: [0; SECRET_SIZE], ..first }).is_err());
        assert!(admit(&second).is_ok(), "the stranger had it read");
    }
}

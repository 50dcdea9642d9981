//! The ledger as a running coordinator sees it: read again when its file has changed, so that a token that is made
//! or revoked counts within a second or two. It writes nothing.

use super::folder::{Folder, FolderError, LEDGER};
use super::ledger::{Ledger, UnixMs};
use proto::join::{Kind, Pass, TokenError, TokenId};
use std::collections::BTreeSet;
use std::fs::Metadata;
use std::os::unix::fs::MetadataExt as _;
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tokio::sync::watch;
use tonic::{Code, Status};

/// How often the file is looked at.
const LOOK_EVERY: Duration = Duration::from_secs(1);

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
    known: watch::Receiver<Arc<Known>>,
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
        let seen = seen(&folder);
        let (sender, known) = watch::channel(Arc::new(Known::new(Ledger::read(&folder)?, now())));
        tokio::spawn(look(folder, seen, sender));
        Ok(Keyring { known })
    }

    /// Lets a pass in that is good for a call.
    pub(crate) fn admit(&self, pass: &Pass, needs: Kind, call: &str) -> Result<Admission, Denied> {
        let known = self.known.borrow();
        let entry = known.ledger.find(pass).ok_or(Denied::Unknown(pass.id))?;
        let admission = Admission { kind: entry.kind, id: entry.id, known: self.known.clone() };
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

/// Looks at the ledger's file now and then. One that cannot be read changes nothing: what was good stays so.
async fn look(folder: Folder, mut seen: Option<Mark>, known: watch::Sender<Arc<Known>>) {
    let mut ticks = tokio::time::interval(LOOK_EVERY);
    ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    while !known.is_closed() {
        ticks.tick().await;
        let found = self::seen(&folder);
        let mut ledger = None;
        if found != seen {
            seen = found;
            match Ledger::read(&folder) {
                Ok(read) => ledger = Some(read),
                Err(error) => tracing::error!("{error}; the tokens stay as they were"),
            }
        }
        known.send_if_modified(|known| {
            let next = Known::new(ledger.unwrap_or_else(|| known.ledger.clone()), now());
            let is_news = next.good != known.good || next.ledger != known.ledger;
            if is_news {
                tracing::info!(good = next.good.len(), "the tokens have changed");
                *known = Arc::new(next);
            }
            is_news
        });
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

//! Keeps the write-ahead log short, beside the writer: copies what is committed into the database while the
//! writer goes on. It never waits for a reader, nor lets the writer wait.

use super::file::beside;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Connection as _, Executor as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Notify;
use tokio::task::JoinHandle;

/// A log below this is left alone, bytes.
const SHORT: u64 = 8 << 20;

/// Between two copies, at least.
const PAUSE: Duration = Duration::from_millis(250);

/// The loop that copies, told of every commit.
pub(super) struct WalKeeper {
    committed: Arc<Notify>,
    stop: Arc<Notify>,
    copying: JoinHandle<()>,
}

impl WalKeeper {
    /// Starts it on a database that the writer has opened.
    pub(super) fn start(database: &Path, options: SqliteConnectOptions) -> WalKeeper {
        let (committed, stop) = (Arc::new(Notify::new()), Arc::new(Notify::new()));
        let copying = tokio::spawn(copy(beside(database, "-wal"), options, committed.clone(), stop.clone()));
        WalKeeper { committed, stop, copying }
    }

    /// There may be something to copy.
    pub(super) fn committed(&self) {
        self.committed.notify_one();
    }

    /// Ends it, after a copy that is under way.
    pub(super) async fn stop(self) {
        self.stop.notify_one();
        let _ = self.copying.await; // a panic there is no reason for one here
    }
}

async fn copy(log: PathBuf, options: SqliteConnectOptions, committed: Arc<Notify>, stop: Arc<Notify>) {
    let Ok(mut connection) = options.connect().await else { return };
    loop {
        tokio::select! {
            () = committed.notified() => {}
            () = stop.notified() => break,
        }
        if std::fs::metadata(&log).is_ok_and(|log| log.len() >= SHORT) {
            // What hinders it (a full disk, a damaged page) the writer will meet and tell.
            if let Err(error) = connection.execute("PRAGMA wal_checkpoint(PASSIVE)").await {
                tracing::debug!(%error, "the write-ahead log was not copied");
            }
            tokio::select! {
                () = tokio::time::sleep(PAUSE) => {}
                () = stop.notified() => break,
            }
        }
    }
    let _ = connection.close().await; // the writer's own close tidies up
}

//! The folder of credentials: which files stand in it, for their owner's eyes alone, each written whole or not at
//! all. It knows what none of them means.

use std::fs::{self, DirBuilder, File, OpenOptions, Permissions};
use std::io::{self, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

/// The authority's certificate, for stock clients.
pub(super) const AUTHORITY: &str = "ca.pem";
/// Its key; not needed to serve, so it may be kept elsewhere.
pub(super) const AUTHORITY_KEY: &str = "ca.key";
/// The server's certificate.
pub(super) const SERVER: &str = "server.pem";
/// Its key.
pub(super) const SERVER_KEY: &str = "server.key";
/// The tokens.
pub(super) const LEDGER: &str = "tokens.toml";
/// Held while the ledger is edited.
const LOCK: &str = "tokens.lock";

/// A folder of credentials.
#[derive(Debug, Clone)]
pub(super) struct Folder {
    path: PathBuf,
}

/// What is wrong with a folder of credentials.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// It was never made.
    #[error("there are no credentials in {}: make some with `hatchery-coordinator init --dir {}`", .path.display(), .path.display())]
    Missing {
        /// Where.
        path: PathBuf,
    },
    /// It was made before.
    #[error("{} holds credentials already: add tokens with `hatchery-coordinator tokens new`, or choose another folder", .path.display())]
    Taken {
        /// Where.
        path: PathBuf,
    },
    /// The operating system refuses.
    #[error("{}", .path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// Its word.
        #[source]
        source: io::Error,
    },
    /// A file's text is not what it should be.
    #[error("{}: {problem}", .path.display())]
    Text {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
}

impl Folder {
    pub(super) fn at(path: &Path) -> Folder {
        Folder { path: path.to_owned() }
    }

    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Makes it, for its owner alone. One that is there may be empty.
    pub(super) fn make(&self) -> Result<(), FolderError> {
        if self.file(LEDGER).exists() || self.file(AUTHORITY).exists() {
            return Err(FolderError::Taken { path: self.path.clone() });
        }
        let made = DirBuilder::new().recursive(true).mode(0o700).create(&self.path);
        made.map_err(|source| FolderError::File { path: self.path.clone(), source })
    }

    /// The text of a file.
    pub(super) fn read(&self, name: &str) -> Result<String, FolderError> {
        let path = self.file(name);
        let text = fs::read_to_string(&path);
        text.map_err(|source| match source.kind() {
            io::ErrorKind::NotFound if !self.file(LEDGER).exists() => {
                FolderError::Missing { path: self.path.clone() }
            }
            _ => FolderError::File { path, source },
        })
    }

    /// Writes a file, readable for its owner alone: beside, then renamed, so that a reader sees all of it or what
    /// was there before, also after a kill.
    pub(super) fn write(&self, name: &str, text: &str) -> Result<(), FolderError> {
        let (path, beside) = (self.file(name), self.file(&format!("{name}.part")));
        let written = || {
            let mut file =
                OpenOptions::new().write(true).create(true).truncate(true).mode(0o600).open(&beside)?;
            // One that a kill left behind keeps its mode.
            file.set_permissions(Permissions::from_mode(0o600))?;
            file.write_all(text.as_bytes())?;
            file.sync_all()?;
            fs::rename(&beside, &path)
        };
        written().map_err(|source| FolderError::File { path: path.clone(), source })
    }

    /// Waits until nobody else edits the ledger. It is free again when the guard is dropped.
    pub(super) fn lock(&self) -> Result<File, FolderError> {
        let path = self.file(LOCK);
        let locked = OpenOptions::new().write(true).create(true).truncate(false).mode(0o600).open(&path);
        let locked = locked.and_then(|file| file.lock().map(|()| file));
        locked.map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => FolderError::Missing { path: self.path.clone() },
            _ => FolderError::File { path, source },
        })
    }

    /// A file that others on this machine may read, if there is one.
    pub(super) fn exposed(&self) -> Option<PathBuf> {
        let files = [SERVER_KEY, AUTHORITY_KEY, LEDGER].map(|name| self.file(name));
        let is_open = |file: &PathBuf| file.metadata().is_ok_and(|of| of.permissions().mode() & 0o077 != 0);
        files.into_iter().find(is_open)
    }

    /// An error about the text of a file.
    pub(super) fn misread(&self, name: &str, problem: impl ToString) -> FolderError {
        FolderError::Text { path: self.file(name), problem: problem.to_string() }
    }
}

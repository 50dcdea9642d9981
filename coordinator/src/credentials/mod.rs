//! Credentials: who may call what, and how a coordinator proves itself. A folder that `hatchery-coordinator init`
//! makes and `tokens` edits, also while a coordinator runs on it. No secret of a token is kept: its hash is.
//!
//! ```text
//! folder     the files, private and whole         authority  the small CA and the server's certificate
//! ledger     the tokens, good and revoked         keyring    the ledger as a running coordinator sees it
//! guard      the door: a layer before all services  command  `init` and `tokens`
//! ```

mod authority;
pub mod command;
mod folder;
mod guard;
mod keyring;
mod ledger;

pub use folder::FolderError;
pub(crate) use guard::Guard;
pub use keyring::Denied;
pub(crate) use keyring::{Admission, Keyring};

use folder::Folder;
use ledger::Ledger;
use proto::dial::Address;
use proto::join::{Kind, Pass, SECRET_SIZE, Token, TokenId};
use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;
use tonic::transport::{Identity, ServerTlsConfig};

/// A caller that has not shaken hands by then is let go.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(10);

/// What a coordinator needs to serve behind TLS.
pub(crate) struct Credentials {
    pub(crate) tls: ServerTlsConfig,
    pub(crate) keyring: Keyring,
}

impl Credentials {
    /// Reads a folder, and follows its ledger from now on, on the present runtime.
    ///
    /// # Errors
    /// A folder that is not there, or not whole.
    pub(crate) fn open(path: &Path) -> Result<Credentials, FolderError> {
        let folder = Folder::at(path);
        let (certificate, key) = (folder.read(folder::SERVER)?, folder.read(folder::SERVER_KEY)?);
        let tls =
            ServerTlsConfig::new().identity(Identity::from_pem(certificate, key)).timeout(HANDSHAKE_TIMEOUT);
        Ok(Credentials { tls, keyring: Keyring::follow(folder)? })
    }
}

/// How to reach the coordinator that serves behind a folder's credentials, with nothing to show it.
///
/// # Errors
/// A folder that is not there, or not whole.
pub(crate) fn address(path: &Path, at: SocketAddr) -> Result<Address, FolderError> {
    let authority = Ledger::read(&Folder::at(path))?.authority;
    let pass = Pass { kind: Kind::Client, id: TokenId(0), secret: [0; SECRET_SIZE], authority };
    Ok(Address::of(&Token { address: at.to_string(), pass }).without_pass())
}

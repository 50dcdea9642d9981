//! The keeper of a coordinator's credentials: makes them, and hands tokens out and takes them back, with the program
//! that a person would use.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use proto::join::Token;

use crate::command::printed;
use crate::programs::program;

/// Credentials, and the first token of each kind.
#[derive(Debug)]
pub struct Keeper {
    folder: PathBuf,
    worker: Token,
    client: Token,
}

impl Keeper {
    /// Makes credentials in a folder.
    ///
    /// # Panics
    /// When that fails.
    pub fn found(folder: &Path) -> Keeper {
        let folder = folder.join("credentials");
        let output = keep(&folder, &["init", "--host", "127.0.0.1", "--port", "1"]);
        assert!(output.status.success(), "{}", printed(&output));
        let text = String::from_utf8(output.stdout).expect("it prints text");
        let token = |kind: &str| {
            let line = text.lines().find_map(|line| line.strip_prefix(kind)?.strip_prefix(' '));
            line.and_then(|token| token.parse().ok()).unwrap_or_else(|| panic!("no {kind} token"))
        };
        Keeper { worker: token("worker"), client: token("client"), folder }
    }

    /// The coordinator listens there from now on: tokens say so.
    pub fn moved(&mut self, address: SocketAddr) {
        self.worker.address = address.to_string();
        self.client.address = address.to_string();
    }

    /// Where the credentials are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The first token for workers.
    pub fn worker(&self) -> &Token {
        &self.worker
    }

    /// The first token for clients.
    pub fn client(&self) -> &Token {
        &self.client
    }

    /// Makes another token.
    ///
    /// # Panics
    /// When that fails.
    pub fn token(&self, kind: &str, arguments: &[&str]) -> Token {
        let address = ["--address", &self.worker.address];
        let output = self.tokens(&[&["new", kind], &address[..], arguments].concat());
        assert!(output.status.success(), "{}", printed(&output));
        let text = String::from_utf8(output.stdout).expect("it prints text");
        text.trim().parse().expect("a token and nothing else")
    }

    /// Takes a token back.
    ///
    /// # Panics
    /// When that fails.
    pub fn revoke(&self, token: &Token) {
        let output = self.tokens(&["revoke", &token.pass.id.to_string()]);
        assert!(output.status.success(), "{}", printed(&output));
    }

    /// `hatchery-coordinator tokens …`.
    pub fn tokens(&self, arguments: &[&str]) -> Output {
        keep(&self.folder, &[&["tokens"], arguments].concat())
    }
}

/// The coordinator's program on a folder of credentials.
fn keep(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(program("hatchery-coordinator"));
    command.args(arguments).arg("--dir").arg(folder).env_remove("HATCHERY_CREDENTIALS");
    command.output().expect("the binary was built")
}

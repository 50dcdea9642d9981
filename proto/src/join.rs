//! Join tokens: all that a new machine needs to find a coordinator, to know it, and to be let in. Text in, value
//! out, and back. It dials nothing and judges nobody.
//!
//! ```text
//! hatchery://head.example:7878#worker-AQ3k…      what a person copies
//!            └ where it is      └ the pass: who may do what, shown at every call
//! ```
//!
//! A pass is its kind and, in base64url: version (1 byte), id (8), secret (32), public key of the coordinator's
//! authority (65), checksum (4). The address stands outside of it, and may be edited when a coordinator moves.

use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use tonic::codegen::http::uri::Authority;

/// The layout of a pass.
const VERSION: u8 = 1;
/// Bytes of a secret.
pub const SECRET_SIZE: usize = 32;
/// Bytes of an authority's public key: a point of P-256, uncompressed.
pub const KEY_SIZE: usize = 65;
const CHECKSUM_SIZE: usize = 4;
const PASS_SIZE: usize = 1 + 8 + SECRET_SIZE + KEY_SIZE + CHECKSUM_SIZE;
const SCHEME: &str = "hatchery://";

/// Who may use a token, and so what for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Workers: to attach to the fleet.
    Worker,
    /// Clients: everything else.
    Client,
}

impl Kind {
    /// Its word in tokens, files and messages.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Worker => "worker",
            Kind::Client => "client",
        }
    }

    /// The kind of a word.
    pub fn of(word: &str) -> Option<Kind> {
        [Kind::Worker, Kind::Client].into_iter().find(|kind| kind.word() == word)
    }
}

/// Which token: no secret.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TokenId(pub u64);

impl fmt::Display for TokenId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl FromStr for TokenId {
    type Err = TokenError;

    fn from_str(text: &str) -> Result<Self, TokenError> {
        // A sign before them would be a number too.
        let digits = Some(text).filter(|text| text.len() == 16 && !text.starts_with('+'));
        let id = digits.and_then(|digits| u64::from_str_radix(digits, 16).ok());
        id.map(TokenId).ok_or_else(|| TokenError::Id { found: text.to_owned() })
    }
}

/// What is shown at the door. Its `Debug` leaves the secret out.
#[derive(Clone, PartialEq, Eq)]
pub struct Pass {
    /// Who it lets in.
    pub kind: Kind,
    /// Which token it belongs to.
    pub id: TokenId,
    /// Known to whoever holds the token; the coordinator has its hash alone.
    pub secret: [u8; SECRET_SIZE],
    /// The public key of the authority whose signature proves the coordinator.
    pub authority: [u8; KEY_SIZE],
}

/// A pass, and where to show it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// `host:port`.
    pub address: String,
    /// To be shown there.
    pub pass: Pass,
}

/// Why a text is no token. The text itself is never repeated: it may hold a secret.
#[derive(Debug, thiserror::Error)]
pub enum TokenError {
    /// Something else.
    #[error("a join token has the form hatchery://HOST:PORT#worker-… or hatchery://HOST:PORT#client-…")]
    Form,
    /// Its address is none.
    #[error("join token: `{found}` is not HOST:PORT")]
    Address {
        /// What stands before the `#`.
        found: String,
    },
    /// A letter is missing or wrong.
    #[error("join token: it is damaged; was it copied whole?")]
    Damaged,
    /// Another release made it.
    #[error("join token: it has version {found}, this release reads {VERSION}: upgrade this machine")]
    Version {
        /// Its version.
        found: u8,
    },
    /// A token's id has 16 hexadecimal digits.
    #[error("`{found}` is no token's id, which has 16 hexadecimal digits")]
    Id {
        /// As given.
        found: String,
    },
    /// Its file cannot be read.
    #[error("cannot read the join token in {}", .path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// The operating system's word.
        #[source]
        source: std::io::Error,
    },
}

impl Token {
    /// Reads a token from a file that holds nothing else.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no token.
    pub fn read(path: &Path) -> Result<Token, TokenError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| TokenError::File { path: path.to_owned(), source })?;
        text.trim().parse()
    }
}

impl FromStr for Token {
    type Err = TokenError;

    fn from_str(text: &str) -> Result<Self, TokenError> {
        let rest = text.strip_prefix(SCHEME).ok_or(TokenError::Form)?;
        let (address, pass) = rest.split_once('#').ok_or(TokenError::Form)?;
        Ok(Token { address: authority(address)?, pass: pass.parse()? })
    }
}

/// `host:port`, both there, and nothing else.
fn authority(text: &str) -> Result<String, TokenError> {
    let text = text.strip_suffix('/').unwrap_or(text);
    let authority = Authority::from_str(text).ok();
    let whole = authority
        .filter(|whole| !whole.host().is_empty() && whole.port_u16().is_some() && !text.contains('@'));
    whole.map(|whole| whole.to_string()).ok_or_else(|| TokenError::Address { found: text.to_owned() })
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{SCHEME}{}#{}", self.address, self.pass)
    }
}

impl fmt::Display for Pass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut bytes = Vec::with_capacity(PASS_SIZE);
        bytes.push(VERSION);
        bytes.extend(self.id.0.to_be_bytes());
        bytes.extend(self.secret);
        bytes.extend(self.authority);
        bytes.extend(checksum(self.kind, &bytes));
        write!(f, "{}-{}", self.kind.word(), URL_SAFE_NO_PAD.encode(bytes))
    }
}

impl FromStr for Pass {
    type Err = TokenError;

    fn from_str(text: &str) -> Result<Self, TokenError> {
        let (word, data) = text.split_once('-').ok_or(TokenError::Form)?;
        let kind = Kind::of(word).ok_or(TokenError::Form)?;
        let bytes = URL_SAFE_NO_PAD.decode(data).map_err(|_| TokenError::Damaged)?;
        match bytes.first() {
            Some(&VERSION) => {}
            Some(&found) => return Err(TokenError::Version { found }),
            None => return Err(TokenError::Damaged),
        }
        if bytes.len() != PASS_SIZE {
            return Err(TokenError::Damaged);
        }
        let (said, found) = bytes.split_at(PASS_SIZE - CHECKSUM_SIZE);
        if checksum(kind, said) != found {
            return Err(TokenError::Damaged);
        }
        let (id, rest) = said[1..].split_at(8);
        let (secret, key) = rest.split_at(SECRET_SIZE);
        Ok(Pass {
            kind,
            id: TokenId(u64::from_be_bytes(id.try_into().expect("split to this size"))),
            secret: secret.try_into().expect("split to this size"),
            authority: key.try_into().expect("split to this size"),
        })
    }
}

impl fmt::Debug for Pass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Pass({} {})", self.kind.word(), self.id)
    }
}

/// Tells a slip of the hand; proves nothing.
fn checksum(kind: Kind, bytes: &[u8]) -> [u8; CHECKSUM_SIZE] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(kind.word().as_bytes()).update(bytes);
    let hash = *hasher.finalize().as_bytes();
    *hash.first_chunk().expect("a hash is longer than a checksum")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn token() -> Token {
        let pass = Pass {
            kind: Kind::Worker,
            id: TokenId(7),
            secret: [0xab; SECRET_SIZE],
            authority: [4; KEY_SIZE],
        };
        Token { address: "head.example:7878".to_owned(), pass }
    }

    #[test]
    fn a_token_says_where_and_who_and_can_be_moved() {
        let text = token().to_string();
        assert!(text.starts_with("hatchery://head.example:7878#worker-"), "{text}");
        assert_eq!(text.parse::<Token>().unwrap(), token());
        let moved = text.replace("head.example:7878", "[::1]:9");
        assert_eq!(moved.parse::<Token>().unwrap(), Token { address: "[::1]:9".to_owned(), ..token() });
    }

    #[test]
    fn what_is_no_token_says_why_and_shows_no_secret() {
        let text = token().to_string();
        let secret = &text[40..];
        for (text, why) in [
            ("http://head:7878".to_owned(), "has the form"),
            (text.replace('#', "?"), "has the form"),
            (text.replace("worker-", "keeper-"), "has the form"),
            (text.replace("worker-", "client-"), "copied whole"),
            (text[..text.len() - 1].to_owned(), "copied whole"),
            (text.replace("worker-A", "worker-B"), "version 5"),
            (text.replace(":7878", ""), "`head.example` is not HOST:PORT"),
            (text.replace("head.example", "me@head"), "is not HOST:PORT"),
            (text.replace("head.example", ""), "is not HOST:PORT"),
        ] {
            let error = text.parse::<Token>().unwrap_err().to_string();
            assert!(error.contains(why) && !error.contains(secret), "{error}");
        }
    }

    #[test]
    fn nobody_prints_a_secret_by_mistake() {
        assert_eq!(format!("{:?}", token().pass), "Pass(worker 0000000000000007)");
    }

    #[test]
    fn a_token_s_id_is_digits_and_nothing_else() {
        assert_eq!("00000000000000ff".parse::<TokenId>().unwrap(), TokenId(255));
        for text in ["+0000000000000ff", "ff", "00000000000000fg", ""] {
            assert!(text.parse::<TokenId>().is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn any_pass_survives_its_text(id: u64, secret: [u8; 32], is_worker: bool) {
            let kind = if is_worker { Kind::Worker } else { Kind::Client };
            let pass = Pass { kind, id: TokenId(id), secret, authority: [9; KEY_SIZE] };
            prop_assert_eq!(pass.to_string().parse::<Pass>().unwrap(), pass);
            prop_assert_eq!(TokenId(id).to_string().parse::<TokenId>().unwrap(), TokenId(id));
        }

        #[test]
        fn any_text_is_read_or_refused(text in "(hatchery://)?[a-z:0-9@/]{0,20}#?(worker-|client-)?[A-Za-z0-9_=-]{0,160}") {
            let _ = text.parse::<Token>();
        }
    }
}

//! The ledger of tokens: which were given out, to whom, and which are good no more. It holds hashes, from which no
//! secret comes back, and is edited by one at a time.

use super::authority::PublicKey;
use super::folder::{Folder, FolderError, LEDGER};
use proto::join::{Kind, Pass, SECRET_SIZE, TokenId};
use serde::{Deserialize, Serialize};

/// The format of the file.
const VERSION: u32 = 1;
/// What a hash of a secret is for, so that it is good for nothing else.
const CONTEXT: &str = "hatchery 2026-11 secret of a join token";

/// Milliseconds of Unix time.
pub(super) type UnixMs = i64;

/// All tokens of one coordinator, in order of making.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ledger {
    /// Where tokens say that the coordinator is: `host:port`.
    pub(super) address: String,
    pub(super) authority: PublicKey,
    pub(super) entries: Vec<Entry>,
}

/// One token.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) id: TokenId,
    pub(super) kind: Kind,
    /// For people.
    pub(super) label: String,
    hash: blake3::Hash,
    pub(super) made_ms: UnixMs,
    pub(super) expires_ms: Option<UnixMs>,
    pub(super) revoked_ms: Option<UnixMs>,
}

impl Entry {
    /// Whether it lets anybody in.
    pub(super) fn is_good(&self, now: UnixMs) -> bool {
        self.revoked_ms.is_none() && !self.has_expired(now)
    }

    pub(super) fn has_expired(&self, now: UnixMs) -> bool {
        self.expires_ms.is_some_and(|end| end <= now)
    }
}

impl Ledger {
    pub(super) fn new(address: String, authority: PublicKey) -> Ledger {
        Ledger { address, authority, entries: Vec::new() }
    }

    /// Reads the ledger of a folder.
    pub(super) fn read(folder: &Folder) -> Result<Ledger, FolderError> {
        let text = folder.read(LEDGER)?;
        let file: File = toml::from_str(&text).map_err(|error| folder.misread(LEDGER, error))?;
        file.try_into().map_err(|problem: String| folder.misread(LEDGER, problem))
    }

    /// Writes it whole.
    pub(super) fn write(&self, folder: &Folder) -> Result<(), FolderError> {
        let text = toml::to_string(&File::from(self)).expect("the file is made of tables and text");
        folder.write(LEDGER, &text)
    }

    /// Changes the ledger of a folder while nobody else does.
    pub(super) fn edit<T, E: From<FolderError>>(
        folder: &Folder,
        change: impl FnOnce(&mut Ledger) -> Result<T, E>,
    ) -> Result<T, E> {
        let _lock = folder.lock()?;
        let mut ledger = Ledger::read(folder)?;
        let changed = change(&mut ledger)?;
        ledger.write(folder)?;
        Ok(changed)
    }

    /// Adds a token. The pass is nowhere but in what this gives.
    pub(super) fn add(
        &mut self,
        kind: Kind,
        label: String,
        now: UnixMs,
        expires_ms: Option<UnixMs>,
    ) -> Result<Pass, getrandom::Error> {
        let mut secret = [0; SECRET_SIZE];
        getrandom::fill(&mut secret)?;
        let id = TokenId(getrandom::u64()?);
        let hash = hash(&secret);
        self.entries.push(Entry { id, kind, label, hash, made_ms: now, expires_ms, revoked_ms: None });
        Ok(Pass { kind, id, secret, authority: self.authority })
    }

    /// The token of a pass, if its secret is right. Hashes are compared in constant time.
    pub(super) fn find(&self, pass: &Pass) -> Option<&Entry> {
        let entry = self.entries.iter().find(|entry| entry.id == pass.id)?;
        (entry.hash == hash(&pass.secret) && entry.kind == pass.kind).then_some(entry)
    }
}

/// Secrets are drawn at random from 2²⁵⁶, so a fast hash is as good as a slow one.
fn hash(secret: &[u8; SECRET_SIZE]) -> blake3::Hash {
    blake3::Hasher::new_derive_key(CONTEXT).update(secret).finalize()
}

/// The ledger as text.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    version: u32,
    address: String,
    authority: String,
    #[serde(default, rename = "token")]
    tokens: Vec<Row>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    id: String,
    kind: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    label: String,
    hash: String,
    made_ms: UnixMs,
    expires_ms: Option<UnixMs>,
    revoked_ms: Option<UnixMs>,
}

impl From<&Ledger> for File {
    fn from(ledger: &Ledger) -> File {
        let row = |entry: &Entry| Row {
            id: entry.id.to_string(),
            kind: entry.kind.word().to_owned(),
            label: entry.label.clone(),
            hash: entry.hash.to_hex().to_string(),
            made_ms: entry.made_ms,
            expires_ms: entry.expires_ms,
            revoked_ms: entry.revoked_ms,
        };
        File {
            version: VERSION,
            address: ledger.address.clone(),
            authority: ledger.authority.iter().map(|byte| format!("{byte:02x}")).collect(),
            tokens: ledger.entries.iter().map(row).collect(),
        }
    }
}

impl TryFrom<File> for Ledger {
    type Error = String;

    fn try_from(file: File) -> Result<Ledger, String> {
        if file.version != VERSION {
            return Err(format!("it has version {}, this release reads {VERSION}", file.version));
        }
        let entry = |row: Row| {
            let place = format!("token `{}`", row.id);
            Ok(Entry {
                id: row.id.parse().map_err(|error| format!("{place}: {error}"))?,
                kind: Kind::of(&row.kind).ok_or_else(|| format!("{place}: kind `{}`", row.kind))?,
                hash: blake3::Hash::from_hex(&row.hash).map_err(|error| format!("{place}: hash: {error}"))?,
                label: row.label,
                made_ms: row.made_ms,
                expires_ms: row.expires_ms,
                revoked_ms: row.revoked_ms,
            })
        };
        let authority = bytes(&file.authority).ok_or("`authority` is no public key")?;
        let entries = file.tokens.into_iter().map(entry).collect::<Result<_, String>>()?;
        Ok(Ledger { address: file.address, authority, entries })
    }
}

fn bytes(hexadecimal: &str) -> Option<PublicKey> {
    let pairs = hexadecimal.as_bytes().chunks(2);
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    pairs.map(byte).collect::<Option<Vec<u8>>>()?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::join::KEY_SIZE;

    fn ledger() -> (Ledger, Pass, Pass) {
        let mut ledger = Ledger::new("head:7878".to_owned(), [4; KEY_SIZE]);
        let worker = ledger.add(Kind::Worker, "rack 2".to_owned(), 10, None).unwrap();
        let client = ledger.add(Kind::Client, String::new(), 20, Some(30)).unwrap();
        (ledger, worker, client)
    }

    #[test]
    fn a_ledger_survives_its_file_which_holds_no_secret() {
        let folder = tempfile::tempdir().unwrap();
        let place = Folder::at(folder.path());
        let (ledger, worker, _) = ledger();
        ledger.write(&place).unwrap();
        assert_eq!(Ledger::read(&place).unwrap(), ledger);
        let text = std::fs::read_to_string(place.file(LEDGER)).unwrap();
        let secret: String = worker.secret.iter().map(|byte| format!("{byte:02x}")).collect();
        assert!(!text.contains(&secret) && !text.contains(&worker.to_string()[60..]));
        assert_eq!(place.exposed(), None, "for its owner's eyes alone");
    }

    #[test]
    fn a_pass_is_known_by_its_secret_and_good_while_it_lasts() {
        let (mut ledger, worker, client) = ledger();
        let forged = Pass { secret: [0; SECRET_SIZE], ..worker.clone() };
        assert!(ledger.find(&forged).is_none());
        assert!(ledger.find(&Pass { kind: Kind::Client, ..worker.clone() }).is_none());
        assert!(ledger.find(&client).unwrap().is_good(29) && !ledger.find(&client).unwrap().is_good(30));
        ledger.entries[0].revoked_ms = Some(25);
        assert!(!ledger.find(&worker).unwrap().is_good(26));
    }

    #[test]
    fn a_damaged_ledger_says_where() {
        let folder = tempfile::tempdir().unwrap();
        let place = Folder::at(folder.path());
        let (ledger, ..) = ledger();
        let whole = toml::to_string(&File::from(&ledger)).unwrap();
        for (text, why) in [
            (whole.replace("version = 1", "version = 2"), "it has version 2"),
            (whole.replace("\"worker\"", "\"keeper\""), "kind `keeper`"),
            (whole.replace("authority = \"04", "authority = \"0x"), "`authority` is no public key"),
            (whole.replace("made_ms", "mode_ms"), "mode_ms"),
        ] {
            place.write(LEDGER, &text).unwrap();
            let error = Ledger::read(&place).unwrap_err().to_string();
            assert!(error.contains("tokens.toml") && error.contains(why), "{error}");
        }
    }
}

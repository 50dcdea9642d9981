//! `hatchery-coordinator init` and `tokens`: make credentials, and hand tokens out and take them back. Tokens go to
//! standard output and nowhere else; words about them go to standard error.

use super::authority::{certify, found};
use super::folder::Folder;
use super::keyring::now;
use super::ledger::{Entry, Ledger, UnixMs};
use anyhow::{Context as _, anyhow, bail};
use proto::hello::LABEL_SIZE_MAX;
use proto::join::{Kind, Token};
use std::net::Ipv6Addr;
use std::path::{Path, PathBuf};
use time::OffsetDateTime;

/// Where credentials are, unless told otherwise.
const FOLDER: &str = "credentials";
const DAY_MS: UnixMs = 24 * 3600 * 1000;

/// `init`.
#[derive(Debug, clap::Args)]
#[command(after_help = INIT_HELP)]
pub struct Init {
    /// The folder to make
    #[arg(long, value_name = "DIR", default_value = FOLDER, env = "HATCHERY_CREDENTIALS")]
    dir: PathBuf,
    /// A name or an address under which the coordinator is reached; the first one goes into the tokens
    /// [default: the name of this machine]
    #[arg(long = "host", value_name = "NAME")]
    hosts: Vec<String>,
    /// The port that goes into the tokens
    #[arg(long, default_value_t = 7878)]
    port: u16,
    /// Make a new key and certificate for the server under the authority that is there; tokens stay good
    #[arg(long)]
    renew: bool,
}

const INIT_HELP: &str = "\
Prints two join tokens, `worker TOKEN` and `client TOKEN`. They are shown once: the folder holds their hashes.

Examples:
  hatchery-coordinator init --host head.example --host 10.0.0.1
  hatchery-coordinator init | awk '$1 == \"worker\" { print $2 }' > worker.token   (under umask 077)";

/// `tokens`.
#[derive(Debug, clap::Args)]
pub struct Tokens {
    /// The folder that `init` made
    #[arg(long, value_name = "DIR", default_value = FOLDER, env = "HATCHERY_CREDENTIALS", global = true)]
    dir: PathBuf,
    #[command(subcommand)]
    order: Order,
}

#[derive(Debug, clap::Subcommand)]
enum Order {
    /// List the tokens; no secret is shown, since none is kept
    List,
    /// Make a token, and print it
    New(New),
    /// Take tokens back: within two seconds a running coordinator ends what came in with them
    Revoke(Revoke),
}

#[derive(Debug, clap::Args)]
struct New {
    /// Whom it lets in
    #[arg(value_parser = kind)]
    kind: Kind,
    /// What it is for, for people, and to revoke it by: no other good token has it
    #[arg(long, default_value = "", value_parser = label)]
    label: String,
    /// Days until it expires [default: never]
    #[arg(long, value_name = "DAYS", value_parser = clap::value_parser!(u32).range(1..=36_500))]
    days: Option<u32>,
    /// The address to write into the token [default: that of `init`]
    #[arg(long, value_name = "HOST:PORT")]
    address: Option<String>,
}

#[derive(Debug, clap::Args)]
struct Revoke {
    /// The ids or labels of tokens
    #[arg(value_name = "ID", required = true)]
    tokens: Vec<String>,
}

fn kind(word: &str) -> Result<Kind, String> {
    Kind::of(word).ok_or_else(|| "expected `worker` or `client`".to_owned())
}

impl Init {
    /// Makes the credentials and prints their first tokens.
    ///
    /// # Errors
    /// A folder that is taken or cannot be written; a name that no certificate can hold.
    pub fn execute(self) -> anyhow::Result<()> {
        let hosts = if self.hosts.is_empty() { vec![own_name()] } else { self.hosts };
        let folder = Folder::at(&self.dir);
        if self.renew {
            certify(&folder, &hosts)?;
            eprintln!("a new certificate for {} counts when the coordinator starts again", hosts.join(", "));
            return Ok(());
        }
        let address = address(&hosts[0], self.port);
        folder.make()?;
        let authority = found(&folder, &hosts)?;
        let mut ledger = Ledger::new(address.clone(), authority);
        let mut tokens = Vec::new();
        for kind in [Kind::Worker, Kind::Client] {
            let pass = ledger.add(kind, "init".to_owned(), now(), None).context("no random numbers")?;
            tokens.push(Token { address: address.clone(), pass }.to_string().parse::<Token>()?);
        }
        ledger.write(&folder)?;
        for token in tokens {
            println!("{} {token}", token.pass.kind.word());
        }
        eprintln!("{}", told(&self.dir, &address));
        Ok(())
    }
}

/// What to do with new credentials.
fn told(dir: &Path, address: &str) -> String {
    let dir = dir.display();
    format!(
        "Made {dir}. The tokens above are shown this once: keep them as you keep passwords.\n\
         \n\
         here      hatchery-coordinator --listen 0.0.0.0:{} --credentials {dir}\n\
         workers   hatchery-worker --join-file FILE     with the worker token in FILE, or in HATCHERY_JOIN\n\
         clients   hatchery list --join-file FILE       with the client token in FILE, or in HATCHERY_JOIN",
        address.rsplit(':').next().unwrap_or_default()
    )
}

impl Tokens {
    /// Carries out what is asked.
    ///
    /// # Errors
    /// A folder that holds no credentials; a token that is not there.
    pub fn execute(self) -> anyhow::Result<()> {
        let folder = Folder::at(&self.dir);
        match self.order {
            Order::List => {
                let ledger = Ledger::read(&folder)?;
                println!("{:16}  {:6}  {:7}  {:16}  {:16}  label", "id", "kind", "state", "made", "expires");
                ledger.entries.iter().for_each(|entry| println!("{}", line(entry, now())));
            }
            Order::New(new) => println!("{}", new.make(&folder)?),
            Order::Revoke(revoke) => {
                for id in Ledger::edit(&folder, |ledger| revoke.take_back(ledger))? {
                    eprintln!("revoked {id}");
                }
            }
        }
        Ok(())
    }
}

/// A label that a terminal can show.
fn label(typed: &str) -> Result<String, String> {
    if typed.len() > LABEL_SIZE_MAX || typed.chars().any(char::is_control) {
        return Err(format!("a label has at most {LABEL_SIZE_MAX} bytes and no control characters"));
    }
    Ok(typed.to_owned())
}

impl New {
    fn make(self, folder: &Folder) -> anyhow::Result<Token> {
        let expires_ms = self.days.map(|days| now() + UnixMs::from(days) * DAY_MS);
        Ledger::edit(folder, |ledger| {
            let mut good = ledger.entries.iter().filter(|entry| entry.revoked_ms.is_none());
            if let Some(other) = good.find(|entry| !self.label.is_empty() && entry.label == self.label) {
                bail!("token {} has the label `{}` already: choose another one", other.id, self.label);
            }
            let pass = ledger.add(self.kind, self.label, now(), expires_ms).context("no random numbers")?;
            let token = Token { address: self.address.unwrap_or_else(|| ledger.address.clone()), pass };
            // Read back, so that nobody is handed what no machine takes.
            Ok(token.to_string().parse::<Token>()?)
        })
    }
}

impl Revoke {
    /// All of them or, if one is not there, none.
    fn take_back(&self, ledger: &mut Ledger) -> anyhow::Result<Vec<String>> {
        let mut revoked = Vec::new();
        for name in &self.tokens {
            let is_labelled = |entry: &Entry| entry.label == *name && entry.revoked_ms.is_none();
            let is_meant = |entry: &&mut Entry| entry.id.to_string() == *name || is_labelled(entry);
            let meant: Vec<_> = ledger.entries.iter_mut().filter(is_meant).collect();
            match meant.as_slice() {
                [] => return Err(anyhow!("there is no good token `{name}`: `tokens list` has them all")),
                [_] => {}
                _ => bail!("{} tokens have the label `{name}`: name one by its id", meant.len()),
            }
            for entry in meant {
                entry.revoked_ms.get_or_insert(now());
                revoked.push(entry.id.to_string());
            }
        }
        Ok(revoked)
    }
}

fn line(entry: &Entry, now: UnixMs) -> String {
    let state = match entry {
        Entry { revoked_ms: Some(_), .. } => "revoked",
        _ if entry.has_expired(now) => "expired",
        _ => "good",
    };
    let expires = entry.expires_ms.map_or("never".to_owned(), date);
    let (kind, made) = (entry.kind.word(), date(entry.made_ms));
    let line = format!("{}  {kind:6}  {state:7}  {made:16}  {expires:16}  {}", entry.id, entry.label);
    line.trim_end().to_owned()
}

/// In UTC, to the minute.
fn date(time: UnixMs) -> String {
    match OffsetDateTime::from_unix_timestamp(time / 1000) {
        Ok(time) => format!("{} {:02}:{:02}", time.date(), time.hour(), time.minute()),
        Err(_) => "never".to_owned(), // beyond the calendar
    }
}

fn address(host: &str, port: u16) -> String {
    match host.parse::<Ipv6Addr>() {
        Ok(host) => format!("[{host}]:{port}"),
        Err(_) => format!("{host}:{port}"),
    }
}

/// This machine's name: the kernel's word where there is one.
fn own_name() -> String {
    let kernel = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = kernel.or_else(|| std::env::var("HOSTNAME").ok()).unwrap_or_default();
    match name.trim() {
        "" => "localhost".to_owned(),
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::join::KEY_SIZE;

    fn ledger() -> Ledger {
        let mut ledger = Ledger::new("head:7878".to_owned(), [4; KEY_SIZE]);
        for label in ["a", "b", "b"] {
            ledger.add(Kind::Worker, label.to_owned(), 1_700_000_000_000, Some(1_700_086_400_000)).unwrap();
        }
        ledger
    }

    #[test]
    fn a_token_is_revoked_by_its_id_or_by_a_label_that_it_has_alone() {
        let mut ledger = ledger();
        let id = ledger.entries[2].id.to_string();
        let revoke = |tokens: &[&str]| Revoke { tokens: tokens.iter().map(|&t| t.to_owned()).collect() };
        let ambiguous = revoke(&["b"]).take_back(&mut ledger.clone()).unwrap_err().to_string();
        assert_eq!(ambiguous, "2 tokens have the label `b`: name one by its id");
        assert_eq!(revoke(&["a", &id]).take_back(&mut ledger).unwrap().len(), 2);
        let revoked: Vec<_> = ledger.entries.iter().map(|entry| entry.revoked_ms.is_some()).collect();
        assert_eq!(revoked, [true, false, true]);
        let error = |name| revoke(&[name]).take_back(&mut ledger.clone()).unwrap_err().to_string();
        assert_eq!(revoke(&["b"]).take_back(&mut ledger.clone()).unwrap().len(), 1, "the other one is good");
        assert!(error("a").contains("no good token `a`"), "it was revoked");
        assert!(error("c").contains("no good token `c`"));
    }

    #[test]
    fn a_line_tells_when_a_token_was_made_and_whether_it_is_good() {
        let entry = &ledger().entries[0];
        let shown = |now| line(entry, now).split_once("  ").unwrap().1.to_owned();
        assert_eq!(shown(1_700_000_000_001), "worker  good     2023-11-14 22:13  2023-11-15 22:13  a");
        assert_eq!(shown(1_700_086_400_000), "worker  expired  2023-11-14 22:13  2023-11-15 22:13  a");
    }

    #[test]
    fn an_address_of_the_sixth_version_stands_in_brackets() {
        assert_eq!(address("::1", 1), "[::1]:1");
        assert_eq!(address("head", 1), "head:1");
    }
}

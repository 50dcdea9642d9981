//! TLS and join tokens between real processes: who gets in, who does not and is told why, and that nothing secret
//! lies about.

use std::os::unix::fs::PermissionsExt;
use std::process::Command;
use std::time::{Duration, Instant};

use hatchery_tests::client::PATIENCE;
use hatchery_tests::keeper::Keeper;
use hatchery_tests::programs::program;
use hatchery_tests::samples::{probe, walkers};
use hatchery_tests::{Client, Hatchery, Process, command, local};
use proto::dial::Address;
use proto::join::{Kind, Token};
use proto::v1;
use proto::v1::experiments_client::ExperimentsClient;
use proto::v1::fleet_client::FleetClient;
use tonic::{Code, Status};

const SOON: Duration = Duration::from_secs(20);

#[test]
fn a_run_over_tls_comes_out_as_one_in_plain() {
    let text = walkers("crawler", "grn", 41, 16, 2);
    let mut hatchery = Hatchery::with_credentials();
    hatchery.join("w1");
    // The second one has its token in a file, as on a machine of its own.
    let file = hatchery.folder().join("worker.token");
    std::fs::write(&file, format!("{}\n", hatchery.keeper().worker())).expect("the folder is writable");
    let mut command = Command::new(program("hatchery-worker"));
    command.args(["--slots", "1", "--name", "w2", "--label", "rack=2", "--join-file"]).arg(&file);
    hatchery.join_by("w2", &mut command);
    hatchery.wait_attached(2);
    assert_eq!(hatchery.lineage_of(&text), local::lineage(&text));
    let token = hatchery.keeper().client().to_string();
    let listed =
        command::hatchery(hatchery.folder(), &["workers", "--json"]).env("HATCHERY_JOIN", &token).output();
    let listed = command::printed(&listed.expect("the binary was built"));
    assert!(listed.contains("\"rack\""), "{listed}");
}

#[test]
fn whoever_shows_no_token_is_told_what_is_missing() {
    let hatchery = Hatchery::with_credentials();
    let plain = command::run(hatchery.folder(), &["workers", "--coordinator", &hatchery.url()]);
    assert_eq!(plain.status.code(), Some(2), "{}", command::printed(&plain));
    assert!(
        command::printed(&plain).contains("speaks TLS: its coordinator wants"),
        "{}",
        command::printed(&plain)
    );
    let mut command = Command::new(program("hatchery-worker"));
    command.args(["--coordinator", &hatchery.url()]);
    let mut worker = Process::start(&mut command, &hatchery.folder().join("plain.log"));
    assert_eq!(worker.wait(SOON).code(), Some(1), "{}", worker.log());
    assert!(worker.log().contains("HATCHERY_JOIN"), "{}", worker.log());
    // Over TLS, but with empty hands: only health answers.
    let (naked, health) = hatchery.client().converse(async {
        let channel = naked(hatchery.keeper().client()).connect().await.expect("TLS alone lets one dial");
        let naked =
            FleetClient::new(channel.clone()).workers(v1::WorkersRequest {}).await.expect_err("refused");
        let request = tonic_health::pb::HealthCheckRequest { service: String::new() };
        (naked, tonic_health::pb::health_client::HealthClient::new(channel).check(request).await)
    });
    assert_eq!(naked.code(), Code::Unauthenticated, "{naked}");
    assert!(naked.message().contains("without a join token"), "{naked}");
    assert!(health.is_ok(), "{health:?}");
}

#[test]
fn a_probe_asks_over_tls_without_a_token() {
    let mut hatchery = Hatchery::with_credentials();
    let well = hatchery.health(&["--ready"]);
    assert_eq!(well.status.code(), Some(0), "{}", command::printed(&well));
    let mut command = Command::new(program("hatchery-coordinator"));
    let plain =
        command.args(["health", "--listen", &hatchery.address()]).output().expect("the binary was built");
    assert_eq!(plain.status.code(), Some(1));
    assert!(command::printed(&plain).contains("speaks TLS"), "{}", command::printed(&plain));
    hatchery.kill_coordinator();
    let dead = hatchery.health(&["--within", "1"]);
    assert_eq!(dead.status.code(), Some(1));
    assert!(command::printed(&dead).contains("no coordinator answers"), "{}", command::printed(&dead));
}

#[test]
fn a_token_is_good_for_its_kind_alone() {
    let hatchery = Hatchery::with_credentials();
    let (worker, client) = (hatchery.keeper().worker(), hatchery.keeper().client());
    // Both programs see it before they dial.
    let mut command = command::hatchery(hatchery.folder(), &["workers"]);
    let output = command.env("HATCHERY_JOIN", worker.to_string()).output().expect("the binary was built");
    assert_eq!(output.status.code(), Some(2));
    assert!(command::printed(&output).contains("a worker's join token"), "{}", command::printed(&output));
    // Others are told by the coordinator.
    let ask = |token: &Token| {
        let client = Client::of(Address::of(token));
        client.converse(async {
            let listed = FleetClient::new(client.channel()).workers(v1::WorkersRequest {}).await.map(drop);
            let attached = FleetClient::new(client.channel()).attach(tokio_stream::empty()).await.map(drop);
            (listed, attached)
        })
    };
    let (listed, attached) = ask(worker);
    let listed = listed.expect_err("a worker lists nobody");
    assert_eq!(listed.code(), Code::PermissionDenied, "{listed}");
    assert!(listed.message().contains("a worker token is not for hatchery.v1.Fleet/Workers"), "{listed}");
    // It gets as far as the hello that it does not say.
    assert_eq!(attached.expect_err("no hello").code(), Code::InvalidArgument);
    let (listed, attached) = ask(client);
    assert!(listed.is_ok(), "{listed:?}");
    assert_eq!(attached.expect_err("a client does not attach").code(), Code::PermissionDenied);
}

#[test]
fn a_token_of_another_coordinator_or_of_nobody_opens_nothing() {
    let hatchery = Hatchery::with_credentials();
    let elsewhere = tempfile::tempdir().expect("a temporary folder");
    let mut other = Keeper::found(elsewhere.path());
    other.moved(hatchery.url().trim_start_matches("http://").parse().expect("an address"));
    let mut command = command::hatchery(hatchery.folder(), &["list"]);
    let output =
        command.env("HATCHERY_JOIN", other.client().to_string()).output().expect("the binary was built");
    assert_eq!(output.status.code(), Some(2));
    assert!(command::printed(&output).contains("another authority"), "{}", command::printed(&output));
    let mut command = Command::new(program("hatchery-worker"));
    command.env("HATCHERY_JOIN", other.worker().to_string());
    let mut worker = Process::start(&mut command, &hatchery.folder().join("stranger.log"));
    assert_eq!(worker.wait(SOON).code(), Some(1), "{}", worker.log());
    assert!(worker.log().contains("another authority"), "{}", worker.log());
    // The right authority, and a secret that was guessed.
    let mut forged = hatchery.keeper().client().clone();
    forged.pass.secret[0] ^= 1;
    let status = refusal(&forged);
    assert_eq!(status.code(), Code::Unauthenticated);
    assert!(status.message().contains("not known to this coordinator"), "{status}");
    // And a token for a coordinator that has no TLS.
    let plain = Hatchery::new();
    let mut lost = hatchery.keeper().client().clone();
    lost.address = plain.url().trim_start_matches("http://").to_owned();
    let mut command = command::hatchery(hatchery.folder(), &["list"]);
    let output = command.env("HATCHERY_JOIN", lost.to_string()).output().expect("the binary was built");
    assert_eq!(output.status.code(), Some(2));
    assert!(command::printed(&output).contains("does not speak TLS"), "{}", command::printed(&output));
}

#[test]
fn a_revoked_worker_is_shown_out_and_a_new_token_lets_the_run_go_on() {
    let text = walkers("hopper", "grn", 42, 30, 3);
    let mut hatchery = Hatchery::with_credentials();
    hatchery.join("w1");
    let id = hatchery.submit(&text);
    hatchery.client().wait_until(id, |experiment| experiment.evaluated >= 5);
    let new = hatchery.keeper().token("worker", &["--label", "rotated"]);
    let again = hatchery.keeper().tokens(&["new", "worker", "--label", "rotated"]);
    assert!(
        command::printed(&again).contains("has the label `rotated` already"),
        "{}",
        command::printed(&again)
    );
    let shown = hatchery.keeper().tokens(&["new", "worker", "--label", "a\u{1b}[31m"]);
    assert_eq!((again.status.code(), shown.status.code()), (Some(1), Some(2)), "what a terminal would obey");
    hatchery.keeper().revoke(hatchery.keeper().worker());
    assert_eq!(hatchery.worker("w1").wait(SOON).code(), Some(1));
    assert!(hatchery.worker("w1").log().contains("was revoked"), "it says why it went");
    let mut command = Command::new(program("hatchery-worker"));
    command.args(["--slots", "1", "--name", "w2"]).env("HATCHERY_JOIN", new.to_string());
    hatchery.join_by("w2", &mut command);
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text));
    let left = "SELECT count(*) FROM v_workers WHERE name = 'w1' AND reason = 'its token ended'";
    assert_eq!(hatchery.client().count(left), 1);
}

#[test]
fn tokens_survive_a_restart_and_end_by_revocation_and_by_their_date() {
    let mut hatchery = Hatchery::with_credentials();
    let [revoked, expired] = [&["--label", "spare"][..], &["--days", "1"]]
        .map(|arguments| hatchery.keeper().token("client", arguments));
    hatchery.restart_coordinator();
    assert!(hatchery.client().workers().is_empty(), "the first token is good");
    for token in [&revoked, &expired] {
        assert!(Client::of(Address::of(token)).workers().is_empty(), "and so are the others");
    }
    // A watcher's stream ends with its token.
    let id = hatchery.submit(&probe(43, 10, 2, 0));
    let watcher = Client::of(Address::of(&revoked));
    let watched = watcher.converse(async {
        let request = v1::WatchRequest { experiment: id.to_string() };
        let mut events = ExperimentsClient::new(watcher.channel()).watch(request).await?.into_inner();
        hatchery.keeper().revoke(&revoked);
        while events.message().await?.is_some() {}
        Ok::<(), Status>(())
    });
    let status = watched.expect_err("nothing is evaluated, so it would go on for ever");
    assert_eq!(status.code(), Code::Unauthenticated, "{status}");
    assert!(status.message().contains("was revoked"), "{status}");
    // A day passes.
    let ledger = hatchery.keeper().folder().join("tokens.toml");
    let text = std::fs::read_to_string(&ledger).expect("the ledger is there");
    let date = text.lines().find(|line| line.starts_with("expires_ms")).expect("one token has a date");
    std::fs::write(&ledger, text.replace(date, "expires_ms = 1")).expect("it is ours");
    let deadline = Instant::now() + PATIENCE;
    let status = loop {
        match list(&expired) {
            Err(status) => break status,
            Ok(()) => assert!(Instant::now() < deadline, "the ledger is read again"),
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    assert_eq!(status.code(), Code::Unauthenticated, "{status}");
    assert!(status.message().contains("has expired"), "{status}");
    let listed = command::printed(&hatchery.keeper().tokens(&["list"]));
    for (token, state) in [(&revoked, "revoked"), (&expired, "expired"), (hatchery.keeper().client(), "good")]
    {
        let line = listed.lines().find(|line| line.starts_with(&token.pass.id.to_string()));
        assert!(line.is_some_and(|line| line.contains(state)), "{state}: {listed}");
    }
}

#[test]
fn nothing_secret_lies_about() {
    let mut hatchery = Hatchery::with_credentials_and_log("trace");
    hatchery.join("w1");
    hatchery.wait_attached(1);
    hatchery.lineage_of(&probe(44, 20, 2, 0));
    let folder = hatchery.keeper().folder().to_owned();
    for file in std::fs::read_dir(&folder).expect("it was made") {
        let file = file.expect("it can be listed");
        let mode = file.metadata().expect("it is there").permissions().mode() & 0o777;
        assert_eq!(mode, 0o600, "{}", file.path().display());
    }
    let cmdline = |id| std::fs::read(format!("/proc/{id}/cmdline")).unwrap_or_default();
    let mut seen = vec![
        ("the worker's arguments", cmdline(hatchery.worker("w1").id())),
        ("the coordinator's arguments", cmdline(hatchery.coordinator().id())),
        ("the worker's log", hatchery.worker("w1").log().into_bytes()),
        ("the coordinator's log", hatchery.coordinator().log().into_bytes()),
        ("the ledger", std::fs::read(folder.join("tokens.toml")).expect("it was made")),
    ];
    for file in ["lineage.db", "lineage.db-wal"] {
        seen.push((file, std::fs::read(hatchery.folder().join(file)).unwrap_or_default()));
    }
    for token in [hatchery.keeper().worker(), hatchery.keeper().client()] {
        let (pass, secret) = (token.pass.to_string(), token.pass.secret);
        let hexadecimal: String = secret.iter().map(|byte| format!("{byte:02x}")).collect();
        // Version and id go before the secret; what comes after it is public.
        let middle = &pass[token.pass.kind.word().len() + 1 + 16..][..36];
        for (place, bytes) in &seen {
            for text in [middle.as_bytes(), hexadecimal.as_bytes(), &secret] {
                assert!(
                    !bytes.windows(text.len()).any(|window| window == text),
                    "a secret stands in {place}"
                );
            }
        }
    }
    assert!(seen[3].1.windows(5).any(|window| window == b"TRACE"), "everything was logged");
}

#[test]
fn beyond_this_machine_nobody_listens_without_credentials() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let listen = |arguments: &[&str]| {
        let mut command = Command::new(program("hatchery-coordinator"));
        command.current_dir(folder.path()).env_remove("HATCHERY_CREDENTIALS");
        command.args(["--listen", "0.0.0.0:0"]).args(arguments);
        let mut process = Process::start(&mut command, &folder.path().join("coordinator.log"));
        assert_eq!(process.wait(SOON).code(), Some(1), "{}", process.log());
        process.log()
    };
    assert!(listen(&[]).contains("hatchery-coordinator init"));
    assert!(listen(&["--credentials", "nowhere"]).contains("no credentials in nowhere"));
    let keeper = Keeper::found(folder.path());
    let mut again = Command::new(program("hatchery-coordinator"));
    again.args(["init", "--dir"]).arg(keeper.folder());
    let output = again.output().expect("the binary was built");
    assert!(!output.status.success() && command::printed(&output).contains("holds credentials already"));
}

/// The address of a token, without its pass.
fn naked(token: &Token) -> Address {
    Address::of(token).without_pass()
}

fn list(token: &Token) -> Result<(), Status> {
    let client = Client::of(Address::of(token));
    client
        .converse(async { FleetClient::new(client.channel()).workers(v1::WorkersRequest {}).await.map(drop) })
}

fn refusal(token: &Token) -> Status {
    assert_eq!(token.pass.kind, Kind::Client);
    list(token).expect_err("it is refused")
}

//! The services as a program in another language sees them: health, reflection, bare evaluation, several
//! experiments at once.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use creatures::Nobody;
use creatures::random::stream;
use hatchery_tests::client::PATIENCE;
use hatchery_tests::samples::{culled, probe, walkers};
use hatchery_tests::{Hatchery, local};
use proto::v1;
use proto::v1::evaluate_reply::What as Reply;
use proto::v1::evaluate_request::What as Request;
use proto::v1::evaluation_client::EvaluationClient;
use proto::v1::experiments_client::ExperimentsClient;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Connection as _, Executor as _};
use tokio_stream::StreamExt;

#[test]
fn health_and_reflection_answer() {
    use tonic_reflection::pb::v1::{
        ServerReflectionRequest, server_reflection_client::ServerReflectionClient,
        server_reflection_request::MessageRequest, server_reflection_response::MessageResponse,
    };
    let hatchery = Hatchery::new();
    let client = hatchery.client();
    let services =
        ["Fleet", "Experiments", "Lineage", "Evaluation"].map(|name| format!("hatchery.v1.{name}"));
    for service in &services {
        assert!(client.serves(service), "{service}");
    }
    let request = ServerReflectionRequest {
        message_request: Some(MessageRequest::ListServices(String::new())),
        ..Default::default()
    };
    let listed = client.converse(async {
        let mut reflection = ServerReflectionClient::new(client.channel());
        let mut replies = reflection.server_reflection_info(tokio_stream::once(request)).await?.into_inner();
        replies.message().await
    });
    let Some(MessageResponse::ListServicesResponse(list)) =
        listed.expect("reflection answers").unwrap().message_response
    else {
        panic!("a list of services was asked for");
    };
    for service in &services {
        assert!(
            list.service.iter().any(|listed| &listed.name == service),
            "{service} is not listed: {list:?}"
        );
    }
}

#[test]
fn a_bare_evaluation_gives_the_outcome_of_the_library_bit_for_bit() {
    let hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let system = creatures::system("probe").expect("registered");
    let spec = system.resolve(serde_json::json!({ "work": 20 })).expect("legal").to_string();
    let task = system.task(&spec).expect("resolved");
    let mut bytes = stream(21, [0, 0, 0], "genotypes");
    let genotypes: Vec<Vec<u8>> = (0..50)
        .map(|_| {
            let mut genotype = vec![0; 64];
            bytes.fill(&mut genotype);
            genotype
        })
        .collect();
    let named =
        v1::Task { hash: Default::default(), system: "probe".to_owned(), version: system.version(), spec };
    let mut requests = vec![v1::EvaluateRequest { what: Some(Request::Task(named)) }];
    for (id, payload) in (0..).zip(&genotypes) {
        let genotype = v1::Genotype {
            system: "probe".to_owned(),
            version: system.version(),
            payload: payload.clone().into(),
        };
        let one = v1::EvaluateGenotype { id, genotype: Some(genotype), seed: id + 100, cull: None };
        requests.push(v1::EvaluateRequest { what: Some(Request::Genotype(one)) });
    }
    let replies = evaluate(&hatchery, requests);
    assert_eq!(replies.len(), genotypes.len());
    for (id, genotype) in (0..).zip(&genotypes) {
        let Some(Reply::Outcome(outcome)) = &replies[&id] else { panic!("{id}: {:?}", replies[&id]) };
        let expected = task.evaluate(genotype, id + 100, None, &mut Nobody).expect("legal");
        let outcome = creatures::Outcome::try_from(outcome.clone()).expect("a legal outcome");
        assert_eq!(outcome.digest(), expected.digest(), "{id}");
    }
}

#[test]
fn a_bare_genotype_that_is_illegal_is_refused_by_field_and_the_stream_goes_on() {
    let hatchery = Hatchery::with_workers(1);
    hatchery.wait_attached(1);
    let system = creatures::system("walker").expect("registered");
    let spec =
        system.resolve(serde_json::json!({ "body": "crawler", "seconds": 0.5 })).expect("legal").to_string();
    let legal = system.proofs().into_iter().find(|proof| {
        let task = system.task(&spec).expect("resolved");
        task.check(&proof.genotype).is_ok()
    });
    let legal = legal.expect("one of the proofs is of a crawler").genotype;
    let named =
        v1::Task { hash: Default::default(), system: "walker".to_owned(), version: system.version(), spec };
    let genotype = |id, payload: Vec<u8>| {
        let genotype =
            v1::Genotype { system: "walker".to_owned(), version: system.version(), payload: payload.into() };
        let one = v1::EvaluateGenotype { id, genotype: Some(genotype), seed: 1, cull: None };
        v1::EvaluateRequest { what: Some(Request::Genotype(one)) }
    };
    let replies = evaluate(
        &hatchery,
        vec![
            v1::EvaluateRequest { what: Some(Request::Task(named)) },
            genotype(1, b"no genotype".to_vec()),
            genotype(2, legal),
        ],
    );
    let Some(Reply::Error(error)) = &replies[&1] else { panic!("refused: {:?}", replies[&1]) };
    assert!(error.contains("genotype"), "{error}");
    assert!(matches!(replies[&2], Some(Reply::Outcome(_))), "{:?}", replies[&2]);
}

/// Another program holds the lineage locked, so that orders wait.
#[test]
fn an_order_is_carried_out_though_its_giver_has_gone_and_refused_while_nothing_can_be_written() {
    let text = probe(17, 10, 2, 10);
    let hatchery = Hatchery::with_workers(1);
    let client = hatchery.client();
    let submit = |patience: Duration| {
        let request = v1::SubmitRequest { text: text.clone(), ..Default::default() };
        client.converse(async {
            let mut experiments = ExperimentsClient::new(client.channel());
            tokio::time::timeout(patience, experiments.submit(request)).await
        })
    };
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let held = runtime.block_on(async {
        let options = SqliteConnectOptions::new().filename(hatchery.db()).busy_timeout(PATIENCE);
        let mut other = options.connect().await?;
        other.execute("BEGIN IMMEDIATE").await.map(|_| other)
    });
    let other = held.expect("a lineage can be locked");
    submit(Duration::from_millis(200)).expect_err("it gives up before it is answered");
    let deadline = Instant::now() + PATIENCE;
    while client.serves("hatchery.v1.Experiments") {
        assert!(Instant::now() < deadline, "nobody notices the lock");
        std::thread::sleep(Duration::from_millis(20));
    }
    let refused = submit(Duration::from_secs(5)).expect("an answer at once").expect_err("a refusal");
    assert!(
        refused.message().contains("locked") && refused.message().contains("nothing was done"),
        "{refused}"
    );
    runtime.block_on(other.close()).expect("it lets go");
    let deadline = Instant::now() + PATIENCE;
    while client.count("SELECT count(*) FROM v_experiments WHERE state = 'finished'") == 0 {
        assert!(Instant::now() < deadline, "what was ordered is not done");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(client.count("SELECT count(*) FROM v_experiments"), 1, "nothing of what was refused");
    assert_eq!(client.hash(1), local::lineage(&text));
}

#[test]
fn two_experiments_at_once_share_the_workers_fairly() {
    let hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    // A long one first: the second must not wait for its end.
    let long = hatchery.submit(&probe(31, 4000, 20, 500));
    let client = hatchery.client();
    client.wait_until(long, |e| e.evaluated >= 100);
    let short = hatchery.submit(&probe(32, 200, 4, 500));
    client.wait(short);
    let behind = client.experiment(long).expect("it was submitted");
    assert_eq!(behind.state, "running", "the long experiment ended first: the short one had to wait for it");
    assert!(behind.evaluated < 4000 * 20 / 2, "the short one waited for most of it: {behind:#?}");
}

/// Fishes AF-19, of a first generation.
#[test]
fn a_cull_is_recorded_with_its_rule_step_measure_and_cutoff() {
    let hatchery = Hatchery::with_workers(2);
    let id = hatchery.submit(&culled(&walkers("crawler", "grn", 33, 24, 3)));
    let client = hatchery.client();
    let experiment = client.wait(id);
    assert!(experiment.culled > 0, "seed 33 has culls: {experiment:#?}");
    let culls = client
        .count("SELECT count(*) FROM v_culls WHERE verdict = 'cull' AND measure < cutoff AND step = 60");
    assert_eq!(culls as u64, experiment.culled, "every one stopped a quarter of the way, below its cutoff");
    let first = client.count(
        "SELECT count(*) FROM v_culls JOIN v_individuals ON v_individuals.id = v_culls.individual WHERE v_individuals.generation = 1 AND v_culls.verdict = 'cull'",
    );
    assert_eq!(first, 0, "a first generation has no cutoff");
    let scored = client.count("SELECT count(*) FROM v_individuals WHERE status = 'culled' AND fitness <> 0");
    assert_eq!(scored, 0);
    let spared = client.count("SELECT count(*) FROM v_culls WHERE verdict = 'spare'");
    assert!(spared > 0, "the control sample runs on, and says what the rule would have done");
}

#[test]
fn questions_that_write_attach_never_end_or_return_too_much_are_refused_while_a_run_goes_on() {
    let hatchery = Hatchery::with_workers(1);
    let id = hatchery.submit(&probe(34, 300, 10, 200));
    let client = hatchery.client();
    let refusals: BTreeMap<&str, tonic::Code> = BTreeMap::from([
        ("DELETE FROM individual", tonic::Code::PermissionDenied),
        ("UPDATE experiment SET name = 'mine'", tonic::Code::PermissionDenied),
        ("CREATE TABLE t (x)", tonic::Code::PermissionDenied),
        ("ATTACH '/etc/passwd' AS p", tonic::Code::PermissionDenied),
        ("PRAGMA journal_mode = DELETE", tonic::Code::PermissionDenied),
        ("SELECT load_extension('x')", tonic::Code::PermissionDenied),
        (
            "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT sum(x) FROM n",
            tonic::Code::ResourceExhausted,
        ),
        (
            "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x FROM n",
            tonic::Code::ResourceExhausted,
        ),
        ("SELECT hex(zeroblob(900000000))", tonic::Code::ResourceExhausted),
        ("SELECT 1; SELECT 2", tonic::Code::InvalidArgument),
        ("SELEC 1", tonic::Code::InvalidArgument),
        ("SELECT nothing FROM v_individuals", tonic::Code::InvalidArgument),
    ]);
    for (sql, code) in refusals {
        let status = client.rows(sql).expect_err(sql);
        assert_eq!(status.code(), code, "{sql}: {status}");
        assert!(!status.message().is_empty(), "{sql}: says why");
    }
    client.wait(id);
}

/// One conversation with the bare service; the replies by id.
fn evaluate(hatchery: &Hatchery, requests: Vec<v1::EvaluateRequest>) -> BTreeMap<u64, Option<Reply>> {
    let client = hatchery.client();
    client.converse(async {
        let mut evaluation = EvaluationClient::new(client.channel());
        let replies =
            evaluation.evaluate(tokio_stream::iter(requests)).await.expect("the stream opens").into_inner();
        let replies: Vec<_> = replies.collect().await;
        replies
            .into_iter()
            .map(|reply| reply.expect("the stream goes on"))
            .map(|reply| (reply.id, reply.what))
            .collect()
    })
}

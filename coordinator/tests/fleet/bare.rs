//! The bare service, for any optimiser in any language: genotypes in, outcomes out.

use crate::hands::{PATIENCE, Raw, serve, serve_patiently};
use bytes::Bytes;
use creatures::Nobody;
use proto::v1;
use proto::v1::coordinator_message::Kind as Told;
use proto::v1::evaluate_reply::What as Answer;
use proto::v1::evaluate_request::What as Ask;
use proto::v1::evaluation_client::EvaluationClient;
use proto::v1::report::What;
use std::time::Duration;
use tokio::time::timeout;
use tonic::Code;

/// Evaluates as a worker does, until its stream ends.
async fn evaluate_all(mut a: Raw) {
    let system = creatures::system("probe").unwrap();
    let mut task = None;
    while let Ok(Some(told)) = a.hear().await {
        match told {
            Told::Task(text) => task = Some(system.task(&text.spec).unwrap()),
            Told::Batch(batch) => {
                for one in batch.assignments {
                    let task = task.as_ref().expect("the task comes first");
                    let attempt = one.attempt.unwrap();
                    let cull = one.cull.map(|cull| creatures::Cull::try_from(cull).unwrap());
                    let what = if one.genotype.is_empty() {
                        What::Failure(v1::Failure { reason: "too short to live".to_owned(), r#final: true })
                    } else {
                        let lived = task.evaluate(&one.genotype, one.seed, cull.as_ref(), &mut Nobody);
                        What::Outcome(lived.unwrap().into())
                    };
                    a.report(attempt, what).await;
                }
            }
            _ => {}
        }
    }
}

fn bare_task() -> v1::EvaluateRequest {
    v1::EvaluateRequest { what: Some(Ask::Task(v1::Task::named("probe", 1, r#"{"work": 3}"#))) }
}

fn bare(id: u64, payload: &[u8]) -> v1::EvaluateRequest {
    let genotype =
        v1::Genotype { system: "probe".to_owned(), version: 1, payload: Bytes::copy_from_slice(payload) };
    let genotype = v1::EvaluateGenotype { id, genotype: Some(genotype), seed: 5, cull: None };
    v1::EvaluateRequest { what: Some(Ask::Genotype(genotype)) }
}

#[tokio::test]
async fn the_bare_service_answers_each_genotype_by_its_id() {
    let service = serve_patiently().await;
    let a = service.join("a", 1, 4).await;
    tokio::spawn(evaluate_all(a));
    let other = v1::Genotype { system: "walker".to_owned(), version: 1, payload: Bytes::from_static(b"x") };
    let other = v1::EvaluateGenotype { id: 13, genotype: Some(other), ..Default::default() };
    let asked = [
        bare_task(),
        bare(11, b"one"),
        bare(12, b""),
        v1::EvaluateRequest { what: Some(Ask::Genotype(other)) },
        bare(11, b"two"),
    ];
    let mut client = EvaluationClient::new(service.channel.clone());
    let response = client.evaluate(tokio_stream::iter(asked)).await.unwrap();
    assert_eq!(response.metadata().get("x-hatchery-limit").unwrap(), "1024");
    let mut replies = response.into_inner();
    let mut answers = Vec::new();
    while let Some(reply) = timeout(PATIENCE, replies.message()).await.unwrap().unwrap() {
        answers.push((reply.id, reply.what.unwrap()));
    }
    assert_eq!(answers.len(), 4);
    let task = creatures::system("probe").unwrap().task(r#"{"work":3}"#).unwrap();
    for genotype in [b"one", b"two"] {
        let lived = Answer::Outcome(task.evaluate(genotype, 5, None, &mut Nobody).unwrap().into());
        assert!(answers.contains(&(11, lived)));
    }
    assert!(answers.contains(&(12, Answer::Error("set aside: too short to live".to_owned()))));
    let (_, Answer::Error(error)) = answers.iter().find(|(id, _)| *id == 13).unwrap() else {
        panic!("refused")
    };
    assert!(error.contains("of `walker`, the task is of version 1 of `probe`"), "{error}");
}

#[tokio::test]
async fn the_bare_service_says_what_is_wrong_with_a_task() {
    let service = serve_patiently().await;
    let named = |system, version, spec| v1::EvaluateRequest {
        what: Some(Ask::Task(v1::Task::named(system, version, spec))),
    };
    for (request, code, word) in [
        (named("unicorn", 1, "{}"), Code::InvalidArgument, "`task.system` is `unicorn`, known are probe"),
        (named("probe", 0, "{}"), Code::FailedPrecondition, "upgrade the caller"),
        (named("probe", 99, "{}"), Code::FailedPrecondition, "upgrade the coordinator"),
        (named("probe", 1, "{"), Code::InvalidArgument, "`task.spec`"),
        (named("probe", 1, r#"{"wrok":1}"#), Code::InvalidArgument, "wrok"),
        (bare(1, b"x"), Code::FailedPrecondition, "a task must come first"),
        (v1::EvaluateRequest::default(), Code::InvalidArgument, "neither task nor genotype"),
    ] {
        let mut client = EvaluationClient::new(service.channel.clone());
        let mut replies = client.evaluate(tokio_stream::iter([request])).await.unwrap().into_inner();
        let status = timeout(PATIENCE, replies.message()).await.unwrap().unwrap_err();
        assert_eq!(status.code(), code);
        assert!(status.message().contains(word), "{status}");
    }
}

#[tokio::test]
async fn the_bare_service_reads_no_more_than_its_limit_and_drops_all_with_its_caller() {
    let service = serve(50, 60_000).await;
    let asked = std::iter::once(bare_task()).chain((0..5000).map(|id| bare(id, b"x")));
    let mut client = EvaluationClient::new(service.channel.clone());
    let replies = client.evaluate(tokio_stream::iter(asked)).await.unwrap();
    let mut summary = service.fleet.summary();
    timeout(PATIENCE, summary.wait_for(|summary| summary.ready == 1024)).await.unwrap().unwrap();
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert_eq!(summary.borrow_and_update().ready, 1024);
    drop(replies);
    timeout(PATIENCE, summary.wait_for(|summary| summary.ready == 0)).await.unwrap().unwrap();
}

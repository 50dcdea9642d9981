//! Writes the beginning of the corpus anew: founders of every ready experiment, the experiments themselves, and
//! messages of every kind. What a fuzzer has found stays as it is.

use creatures::{Cull, Interim, Outcome, Status};
use hatchery_fuzz::tasks;
use prost::Message as _;
use proto::join::{KEY_SIZE, Kind, Pass, SECRET_SIZE, Token, TokenId};
use proto::v1::{self, coordinator_message, report::What, worker_message};
use std::path::Path;

fn write(target: &str, name: &str, bytes: &[u8]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    std::fs::create_dir_all(&folder).expect("the corpus can be written");
    std::fs::write(folder.join(name), bytes).expect("the corpus can be written");
}

fn main() {
    for (name, experiment) in tasks() {
        let founders = experiment.start(1).ask();
        for (which, founder) in [("first", founders.first()), ("last", founders.last())] {
            // Large ones teach a mutation nothing that small ones do not.
            let Some(founder) = founder.filter(|founder| founder.genotype.len() <= 4096) else { continue };
            let input = [name.as_bytes(), &[0], &founder.genotype].concat();
            write("genotype", &format!("{name}-{which}"), &input);
            write("life", &format!("{name}-{which}"), &input);
        }
        write("task", &name, experiment.task_json().as_bytes());
        write("experiment", &name, experiment.resolved().as_bytes());
    }
    write("experiment", "override", b"!search.population=4\n!seed=7\nname = \"p\"\nsystem = \"probe\"\n");
    messages();
    tokens();
    for (name, text) in [
        ("sum", "min(3, 1, 2) + max(1, 4)"),
        ("quotient", "first(up_z) / (last(up_z) - 2)"),
        ("nested", "clamp01(mean(up_z) * -2.5e-1) - -.5"),
    ] {
        write("expression", name, text.as_bytes());
    }
    let skills = include_str!("../../creatures/src/esp/syllabus/ten_skills.json");
    write("syllabus", "ten_skills", skills.as_bytes());
}

/// Of an authority that never was.
fn tokens() {
    let pass = |kind, id| Pass { kind, id, secret: [0x5a; SECRET_SIZE], authority: [4; KEY_SIZE] };
    let worker = Token { address: "head.example:7878".to_owned(), pass: pass(Kind::Worker, TokenId(7)) };
    let client = Token { address: "[::1]:9".to_owned(), pass: pass(Kind::Client, TokenId(u64::MAX)) };
    write("token", "worker", worker.to_string().as_bytes());
    write("token", "client", client.to_string().as_bytes());
    write("token", "slash", worker.to_string().replace('#', "/#").as_bytes());
    write("token", "pass", client.pass.to_string().as_bytes());
    write("token", "id", worker.pass.id.to_string().as_bytes());
    write("token", "plus", b"+00000000000000f");
}

fn messages() {
    let outcome = Outcome {
        status: Status::Completed,
        fitness: 1.5,
        steps: 100,
        measures: vec![("height".to_owned(), 2.0)],
        interim: Some(Interim { step: 25, measure: 0.5 }),
        note: String::new(),
    };
    let attempt = Some(v1::Attempt { evaluation: 1, number: 1 });
    let report = |what| v1::Report { attempt, seconds: 0.25, what: Some(what) };
    let reports = vec![
        report(What::Interim(Interim { step: 25, measure: 0.5 }.into())),
        report(What::Outcome(outcome.into())),
        report(What::Failure(v1::Failure { reason: "a panic".to_owned(), r#final: false })),
    ];
    let said = worker_message::Kind::Reports(v1::Reports { reports });
    write("worker_message", "reports", &v1::WorkerMessage { kind: Some(said) }.encode_to_vec());
    let hello = v1::Hello {
        protocol: proto::PROTOCOL,
        name: "w1".to_owned(),
        host: "rack-2".to_owned(),
        slots: 2,
        version: "1.2.3".to_owned(),
        fingerprint: vec![9; 32].into(),
        window: 8,
        lineage: vec![7; 16].into(),
        holding: vec![v1::Attempt { evaluation: 3, number: 1 }],
        labels: [("rack".to_owned(), "2".to_owned())].into(),
        incarnation: 5,
    };
    let said = worker_message::Kind::Hello(hello);
    write("worker_message", "hello", &v1::WorkerMessage { kind: Some(said) }.encode_to_vec());
    let task = v1::Task::named("probe", 1, "{}");
    let assignment = v1::Assignment {
        attempt,
        task: task.hash.clone(),
        genotype: b"genotype".to_vec().into(),
        seed: 7,
        cull: Some(Cull { at: 0.25, cutoff: Some(1.0), control: false }.into()),
    };
    let told = |kind| v1::CoordinatorMessage { kind: Some(kind) }.encode_to_vec();
    write("coordinator_message", "task", &told(coordinator_message::Kind::Task(task)));
    let batch = v1::Batch { assignments: vec![assignment] };
    write("coordinator_message", "batch", &told(coordinator_message::Kind::Batch(batch)));
}

//! The lineage's contract, over real files.

mod asking;
mod opening;
mod resuming;
mod writing;

use super::*;
use creatures::{Interim, Outcome, Reason, Status, Verdict};
use search::{Individual, Parent, Place, Record, Species};
use serde_json::json;
use std::path::PathBuf;
use tempfile::TempDir;

/// A lineage in a folder of its own.
struct House {
    folder: TempDir,
    lineage: Lineage,
}

impl House {
    async fn new() -> House {
        let folder = tempfile::tempdir().unwrap();
        let lineage = Lineage::open(&folder.path().join("test.db")).await.unwrap();
        House { folder, lineage }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("test.db")
    }

    /// As SIGKILL leaves it: nothing flushed, nothing tidied up.
    async fn kill(self) -> (TempDir, PathBuf) {
        let path = self.path();
        let writer = self.lineage.shared.writer.lock().unwrap().take().unwrap();
        writer.abort();
        let _ = writer.await;
        self.lineage.shared.reader.close().await;
        (self.folder, path)
    }

    async fn reopened(self) -> House {
        let House { folder, lineage } = self;
        lineage.close().await.unwrap();
        let lineage = Lineage::open(&folder.path().join("test.db")).await.unwrap();
        House { folder, lineage }
    }

    async fn begin(&self, name: &str) -> (ExperimentId, StageId) {
        let [experiment] = self.lineage.create(vec![experiment(name)]).await.unwrap().try_into().unwrap();
        (experiment, self.stage(experiment, 1).await)
    }

    async fn stage(&self, experiment: ExperimentId, run: u32) -> StageId {
        let name = "whole".to_owned();
        let stage =
            NewStage { experiment, run, stage: 0, name, seed: 5, generations: Some(4), task_json: None };
        self.lineage.open_stage(stage).await.unwrap()
    }

    /// Opens a generation of `size`, closing the one before if there is one.
    async fn generation(&self, stage: StageId, generation: u32, size: u32) -> Vec<IndividualId> {
        self.lineage.open_generation(opening(stage, generation, size)).await.unwrap().1
    }

    /// Records an outcome for each.
    async fn settle(&self, ids: &[IndividualId]) {
        let evaluated = ids.iter().enumerate().map(|(i, id)| settled(*id, outcome(i as f64))).collect();
        self.lineage.record(evaluated).await.unwrap();
    }

    async fn all(&self, sql: &str) -> Vec<Vec<Cell>> {
        ask(self.lineage.reader(), sql, WIDE).await.unwrap()
    }

    async fn one(&self, sql: &str) -> Cell {
        self.all(sql).await.remove(0).remove(0)
    }
}

const WIDE: Limits = Limits { rows: 1_000_000, bytes: 1 << 30, time: std::time::Duration::from_secs(60) };

async fn ask(reader: &Reader, sql: &str, limits: Limits) -> Result<Vec<Vec<Cell>>, QueryError> {
    let mut answer = reader.query(sql, limits).await?;
    let mut rows = Vec::new();
    while let Some(chunk) = answer.next().await {
        rows.extend(chunk?);
    }
    Ok(rows)
}

fn experiment(name: &str) -> NewExperiment {
    NewExperiment {
        name: name.to_owned(),
        group: None,
        cell: json!({}),
        system: "probe".to_owned(),
        system_version: 3,
        search_kind: "probe".to_owned(),
        seed: u64::MAX - 1,
        runs: 2,
        task_json: r#"{"steps":10}"#.to_owned(),
        resolved: format!("name = \"{name}\"\n"),
        digest: *blake3::hash(name.as_bytes()).as_bytes(),
        published: json!([{"mean": 1.5}]),
        program_version: "0.1.0".to_owned(),
        fingerprint: [7; 32],
        planned: Some(16),
        origin: None,
    }
}

/// Founders in generation 1; later every individual has its neighbours of the generation before as parents.
fn opening(stage: StageId, generation: u32, size: u32) -> OpenGeneration {
    OpenGeneration {
        stage: InStage::Open(stage, 0),
        generation,
        checkpoint: checkpoint(generation),
        culling: (generation > 1).then_some(Culling { at: 0.25, cutoff: Some(1.5) }),
        individuals: (0..size).map(|index| individual(generation, index, size)).collect(),
        close: (generation > 1).then(|| closing(Record::default())),
        ends: None,
        choice: None,
    }
}

fn checkpoint(generation: u32) -> Vec<u8> {
    format!("before generation {generation}").repeat(50).into_bytes()
}

fn closing(record: Record) -> CloseGeneration {
    CloseGeneration { record, wall_seconds: 1.25 }
}

fn ending(stage: StageId, checkpoint: &[u8]) -> EndStage {
    EndStage { stage, close: closing(Record::default()), checkpoint: checkpoint.to_vec(), over: true }
}

fn individual(generation: u32, index: u32, size: u32) -> Individual {
    let parent = |index: u32, role: &str| Parent {
        place: Place { stage: 0, generation: generation - 1, index: index % size },
        role: role.to_owned(),
    };
    let founder = generation == 1;
    Individual {
        genotype: genotype(generation, index),
        parents: if founder { vec![] } else { vec![parent(index, "first"), parent(index + 1, "second")] },
        operator: if founder { "random" } else { "crossover+mutate" }.to_owned(),
        traits: json!({"nodes": index}),
        inherits: None,
    }
}

fn genotype(generation: u32, index: u32) -> Vec<u8> {
    let mut bytes = vec![0; 600];
    creatures::random::stream(1, [0, 0, index], "genotype").fill(&mut bytes);
    bytes[generation as usize] ^= 0x5a;
    bytes
}

fn outcome(fitness: f64) -> Outcome {
    Outcome {
        status: Status::Completed,
        fitness,
        steps: 10,
        measures: vec![("dis".to_owned(), fitness / 3.0), ("height".to_owned(), fitness / 5.0)],
        interim: Some(Interim { step: 2, measure: fitness / 7.0 }),
        note: String::new(),
    }
}

fn settled(individual: IndividualId, outcome: Outcome) -> Evaluated {
    let ruling = outcome.interim.map(|interim| Ruling {
        step: interim.step,
        measure: interim.measure,
        cutoff: Some(1.5),
        verdict: Verdict::Pass,
    });
    let attempts = vec![counted("w1")];
    Evaluated { individual, ending: Ending::Settled(Ok(outcome)), ruling, audit: None, attempts }
}

fn counted(worker: &str) -> Attempt {
    Attempt { number: 1, worker: worker.to_owned(), fate: Fate::Counted, steps: 10, seconds: 0.125 }
}

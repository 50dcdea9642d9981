//! A kill costs what was in flight, and nothing else.

use super::*;

#[tokio::test]
async fn a_kill_loses_what_was_not_flushed_and_nothing_else() {
    let house = House::new().await;
    let (experiment, stage) = house.begin("killed").await;
    let first = house.generation(stage, 1, 3).await;
    house.settle(&first).await;
    let second = house.generation(stage, 2, 3).await;
    house.lineage.record(vec![settled(second[0], outcome(0.5))]).await.unwrap();
    let set_aside = Err(SetAside { reason: "3 workers died".to_owned() });
    let failed = Evaluated {
        individual: second[1],
        ending: Ending::Settled(set_aside.clone()),
        ruling: None,
        audit: None,
        attempts: vec![],
    };
    house.lineage.record(vec![failed]).await.unwrap();
    house.lineage.flush().await.unwrap();
    house.lineage.record(vec![settled(second[2], outcome(0.75))]).await.unwrap();
    let (folder, path) = house.kill().await;

    let house = House { lineage: Lineage::open(&path).await.unwrap(), folder };
    let reader = house.lineage.reader();
    let [unfinished] = reader.unfinished().await.unwrap().try_into().unwrap();
    assert_eq!((unfinished.id, unfinished.stages.len()), (experiment, 1));
    assert_eq!((unfinished.stages[0].id, unfinished.stages[0].ended), (stage, false));
    let point = reader.resume_point(stage).await.unwrap().unwrap();
    assert_eq!((point.generation, point.task_json), (2, None));
    assert_eq!(reader.checkpoint(stage, 2).await.unwrap(), Some(checkpoint(2)));
    assert_eq!(point.culling, Some(Culling { at: 0.25, cutoff: Some(1.5) }));
    let endings: Vec<_> = point.individuals.iter().map(|one| one.ending.clone()).collect();
    assert_eq!(endings, [Some(Ok(outcome(0.5))), Some(set_aside), None]);
    for (standing, index) in point.individuals.iter().zip(0..) {
        assert_eq!((standing.id, standing.index), (second[index as usize], index));
        assert!(standing.has(&genotype(2, index)) && !standing.has(&genotype(1, index)));
    }
    let previous: Vec<_> = point.previous.iter().map(|one| (one.id, one.ending.clone())).collect();
    let expected = first.iter().zip(0..).map(|(id, i)| (*id, Some(Ok(outcome(f64::from(i))))));
    assert_eq!(previous, expected.collect::<Vec<_>>());

    // And it goes on: ids follow, and the genotypes of before need no dictionary to be read.
    house.lineage.record(vec![settled(second[2], outcome(0.75))]).await.unwrap();
    let third = house.generation(stage, 3, 3).await;
    assert_eq!(third, [7, 8, 9].map(IndividualId));
    assert_eq!(house.lineage.reader().individual(third[1]).await.unwrap().genotype, genotype(3, 1));
}

#[tokio::test]
async fn a_stage_without_a_generation_begins_anew_and_one_that_ended_is_done() {
    let house = House::new().await;
    let (experiment, stage) = house.begin("edges").await;
    assert!(house.lineage.reader().resume_point(stage).await.unwrap().is_none());
    let ids = house.generation(stage, 1, 2).await;
    house.settle(&ids).await;
    house.lineage.end_stage(ending(stage, b"the end"), None).await.unwrap();
    assert!(house.lineage.reader().resume_point(stage).await.unwrap().is_none());
    let digest = experiment_digest("edges");
    assert_eq!(house.lineage.reader().find_unfinished(&digest).await.unwrap(), Some(experiment));
    house.lineage.set_state(experiment, State::Cancelled, "enough".to_owned()).await.unwrap();
    assert_eq!(house.lineage.reader().find_unfinished(&digest).await.unwrap(), None);
    assert!(house.lineage.reader().unfinished().await.unwrap().is_empty());
}

fn experiment_digest(name: &str) -> [u8; 32] {
    experiment(name).digest
}

#[tokio::test]
async fn the_hash_knows_places_and_bits_and_nothing_of_order_or_attempts() {
    let mut hashes = Vec::new();
    for reversed in [false, true] {
        let house = House::new().await;
        if reversed {
            house.begin("another, so that every id differs").await;
        }
        let (experiment, _) = house.begin("hashed").await;
        let stage = house.lineage.reader().experiment(experiment).await.unwrap().stages[0].id;
        let other = house.stage(experiment, 2).await;
        // Two runs, interleaved one way and the other.
        let runs = if reversed { [other, stage] } else { [stage, other] };
        for generation in 1..=20 {
            for run in runs {
                let ids = house.generation(run, generation, 4).await;
                let mut evaluated: Vec<_> =
                    ids.iter().zip(0..).map(|(id, i)| settled(*id, outcome(f64::from(i) / 3.0))).collect();
                if reversed {
                    evaluated.reverse();
                    evaluated[0].attempts[0].worker = "another".to_owned();
                }
                for evaluated in evaluated {
                    house.lineage.record(vec![evaluated]).await.unwrap();
                }
            }
        }
        house.lineage.flush().await.unwrap();
        let hash = house.lineage.reader().hash(experiment).await.unwrap();
        assert_eq!((hash.individuals, hash.finished), (160, false));
        hashes.push(hash.hash);
    }
    assert_eq!(hashes[0], hashes[1]);

    let house = House::new().await;
    let (experiment, stage) = house.begin("hashed").await;
    let ids = house.generation(stage, 1, 4).await;
    let before = house.lineage.reader().hash(experiment).await.unwrap();
    house.lineage.record(vec![settled(ids[0], outcome(1.0))]).await.unwrap();
    house.lineage.flush().await.unwrap();
    assert_ne!(house.lineage.reader().hash(experiment).await.unwrap().hash, before.hash);
}

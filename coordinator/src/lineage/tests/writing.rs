//! What is written stands as it was written, once.

use super::*;
use std::time::Duration;

fn text(text: &str) -> Cell {
    Cell::Text(text.to_owned())
}

#[tokio::test]
async fn everything_written_is_read_again() {
    let house = House::new().await;
    let (experiment, stage) = house.begin("crawler").await;
    let first = house.generation(stage, 1, 4).await;
    assert_eq!(first, [1, 2, 3, 4].map(IndividualId));
    let joined = Joined {
        name: "w1".to_owned(),
        host: "lab".to_owned(),
        slots: 2,
        version: "0.1.0".to_owned(),
        fingerprint: [7; 32],
    };
    house.lineage.worker_joined(joined).await.unwrap();
    house.settle(&first).await;
    let species = Species {
        id: 3,
        size: 4,
        best: 3.0,
        share: 1.5,
        quota: 4,
        representative: Place { stage: 0, generation: 1, index: 2 },
        stagnant: 0,
    };
    let notes = json!({"register": 17}).as_object().unwrap().clone();
    let mut next = opening(stage, 2, 4);
    next.individuals[3].inherits = Some(Place { stage: 0, generation: 1, index: 3 });
    next.close = Some(closing(Record { species: vec![species], notes }));
    let (_, second) = house.lineage.open_generation(next).await.unwrap();

    let mut culled = outcome(0.0);
    culled.status = Status::Culled;
    let mut culled = settled(second[0], culled);
    culled.ruling = culled.ruling.map(|ruling| Ruling { verdict: Verdict::Cull, ..ruling });
    let lost = Fate::Lost("silent for 10 s".to_owned());
    culled.attempts = vec![
        Attempt { number: 1, worker: "w2".to_owned(), fate: lost, steps: 4, seconds: 1.0 },
        Attempt { number: 2, ..counted("w1") },
    ];
    let mut blown = outcome(0.0);
    blown.status = Status::Aborted(Reason::BlowUp);
    blown.note = "speed at step 7".to_owned();
    blown.measures = vec![("elsewhere".to_owned(), f64::NAN)];
    let set_aside = Err(SetAside { reason: "3 workers died".to_owned() });
    let failed = Attempt { fate: Fate::Failed("it crashed".to_owned()), ..counted("w2") };
    let recorded = vec![
        culled,
        settled(second[1], blown.clone()),
        Evaluated {
            individual: second[2],
            ending: Ending::Settled(set_aside),
            ruling: None,
            audit: None,
            attempts: vec![failed],
        },
        Evaluated {
            individual: second[3],
            ending: Ending::Inherits(first[3]),
            ruling: None,
            audit: None,
            attempts: vec![],
        },
    ];
    house.lineage.record(recorded).await.unwrap();
    house.lineage.end_stage(ending(stage, b"the end"), None).await.unwrap();
    house.lineage.set_state(experiment, State::Finished, String::new()).await.unwrap();
    house.lineage.worker_left("w1".to_owned(), "drained".to_owned()).await.unwrap();
    let event = Event {
        experiment: Some(experiment),
        kind: "conflict".to_owned(),
        text: "unequal bits".to_owned(),
        data: json!({"individual": 1}),
    };
    house.lineage.event(event).await.unwrap();
    let house = house.reopened().await;

    let stored = house.lineage.reader().experiment(experiment).await.unwrap();
    assert_eq!((stored.seed, stored.system_version, stored.runs), (u64::MAX - 1, 3, 2));
    assert_eq!((stored.state, stored.published.clone()), (State::Finished, json!([{"mean": 1.5}])));
    assert!(stored.stages[0].ended && stored.ended_ms.is_some());
    let end = house.lineage.reader().checkpoint(stage, 3).await.unwrap();
    assert_eq!(end.as_deref(), Some(&b"the end"[..]));

    let statuses =
        house.all("SELECT status, fitness, idx, operator FROM v_individuals WHERE generation = 2").await;
    assert_eq!(
        statuses,
        [("culled", Some(0.0)), ("aborted:blow_up", Some(0.0)), ("failed", None), ("completed", Some(3.0))]
            .iter()
            .zip(0..)
            .map(|((status, fitness), idx)| vec![
                text(status),
                fitness.map_or(Cell::Null, Cell::Real),
                Cell::Integer(idx),
                text("crossover+mutate")
            ])
            .collect::<Vec<_>>()
    );
    let sql =
        "SELECT completed, culled, aborted, failed, inherited, best, mean, worst, best_individual, steps
        FROM v_generations ORDER BY generation";
    let counts = house.all(sql).await;
    let (i, r) = (Cell::Integer, Cell::Real);
    assert_eq!(
        counts,
        [
            vec![i(4), i(0), i(0), i(0), i(0), r(3.0), r(1.5), r(0.0), i(4), i(40)],
            vec![i(1), i(1), i(1), i(1), i(1), r(3.0), r(0.75), r(0.0), i(8), i(20)],
        ]
    );
    let one = house.lineage.reader().individual(second[1]).await.unwrap();
    assert_eq!(one.measures, r#"{"elsewhere":"NaN 0x7ff8000000000000"}"#);
    assert_eq!((one.note.as_str(), one.children), ("speed at step 7", 0));
    let heir = house.lineage.reader().individual(second[3]).await.unwrap();
    assert_eq!((heir.inherits, heir.fitness, heir.attempts.len()), (Some(first[3]), Some(3.0), 0));
    assert_eq!(heir.measures, r#"{"dis":1.0,"height":0.6}"#);
    let place = Place { stage: 0, generation: 1, index: 3 };
    assert_eq!((heir.seed, heir.cull), (evaluation_seed(5, place), None), "as its giver was evaluated");
    let culled = house.lineage.reader().individual(second[0]).await.unwrap();
    assert_eq!(culled.cull.map(|cull| (cull.at, cull.cutoff)), Some((0.25, Some(1.5))));
    let fates: Vec<_> = culled.attempts.iter().map(|one| (one.worker.as_str(), one.fate.as_str())).collect();
    assert_eq!(fates, [("w2", "lost:silent for 10 s"), ("w1", "counted")]);
    assert_eq!(culled.parents.iter().map(|link| link.parent.0).collect::<Vec<_>>(), [1, 2]);
    for (generation, ids) in [(1, &first), (2, &second)] {
        for (index, id) in (0..).zip(ids) {
            assert_eq!(
                house.lineage.reader().individual(*id).await.unwrap().genotype,
                genotype(generation, index)
            );
        }
    }
    assert_eq!(house.one("SELECT count(*) FROM genotype WHERE base IS NOT NULL").await, i(4));
    assert_eq!(
        house.all("SELECT individual, verdict, measure, cutoff FROM v_culls").await,
        [vec![i(5), text("cull"), r(0.0), r(1.5)]]
    );
    assert_eq!(
        house.all("SELECT species, size, representative, quota FROM v_species").await,
        [vec![i(3), i(4), i(3), i(4)]]
    );
    assert_eq!(
        house.one("SELECT notes FROM v_generations WHERE generation = 1").await,
        text(r#"{"register":17}"#)
    );
    assert_eq!(house.one("SELECT reason FROM v_workers WHERE host = 'lab'").await, text("drained"));
    assert_eq!(house.one("SELECT text FROM event").await, text("unequal bits"));
}

#[tokio::test]
async fn fitness_keeps_its_bits() {
    let house = House::new().await;
    let (_, stage) = house.begin("bits").await;
    let values = [-0.0, 0.1 + 0.2, f64::MIN_POSITIVE / 8.0, f64::MAX, f64::INFINITY, f64::NAN, -f64::NAN];
    let ids = house.generation(stage, 1, values.len() as u32).await;
    let settle = ids.iter().zip(values).map(|(id, value)| settled(*id, outcome(value)));
    house.lineage.record(settle.collect()).await.unwrap();
    house.lineage.flush().await.unwrap();
    let point = house.lineage.reader().resume_point(stage).await.unwrap().unwrap();
    for (standing, value) in point.individuals.iter().zip(values) {
        let stored = standing.ending.clone().unwrap().unwrap();
        assert_eq!(stored.fitness.to_bits(), value.to_bits());
        assert_eq!(stored.measures[0].1.to_bits(), (value / 3.0).to_bits());
        assert_eq!(stored.measures[1].1.to_bits(), (value / 5.0).to_bits());
    }
}

#[tokio::test]
async fn a_second_ending_changes_nothing() {
    let house = House::new().await;
    let (_, stage) = house.begin("twice").await;
    let ids = house.generation(stage, 1, 1).await;
    house.lineage.record(vec![settled(ids[0], outcome(1.0))]).await.unwrap();
    house.lineage.record(vec![settled(ids[0], outcome(2.0))]).await.unwrap();
    house.lineage.flush().await.unwrap();
    assert_eq!(house.one("SELECT fitness FROM v_individuals").await, Cell::Real(1.0));
}

#[tokio::test]
async fn what_contradicts_the_lineage_is_refused_and_costs_nothing_else() {
    let house = House::new().await;
    let (experiment, stage) = house.begin("strict").await;
    let refused = |result: Result<(StageId, Vec<IndividualId>), WriteError>| match result {
        Err(WriteError::Contradiction { problem, .. }) => problem,
        other => panic!("{other:?}"),
    };
    let late = house.lineage.open_generation(opening(stage, 2, 2)).await;
    assert_eq!(refused(late), format!("generation 1 of stage {stage} is due"));
    let ids = house.generation(stage, 1, 2).await;
    let early = house.lineage.open_generation(opening(stage, 2, 2)).await;
    assert_eq!(refused(early), "2 individuals have no outcome yet");
    house.settle(&ids).await;
    let mut orphan = opening(stage, 2, 2);
    orphan.individuals[0].parents[0].place.index = 9;
    let orphan = house.lineage.open_generation(orphan).await;
    assert_eq!(refused(orphan), "nobody stands at stage 0, generation 1, index 9 of run 1");
    let empty = house.lineage.open_generation(opening(stage, 2, 0)).await;
    assert_eq!(refused(empty), "it has no individuals");
    // Of outcomes recorded together, those that make sense stand.
    let ids = house.generation(stage, 2, 2).await;
    let stranger = settled(IndividualId(999), outcome(1.0));
    let recorded = vec![settled(ids[0], outcome(1.0)), stranger, settled(ids[1], outcome(2.0))];
    house.lineage.record(recorded).await.unwrap();
    house.lineage.flush().await.unwrap();
    assert_eq!(house.one("SELECT evaluated FROM v_experiments").await, Cell::Integer(4));
    let again = NewStage {
        experiment,
        run: 1,
        stage: 0,
        name: String::new(),
        seed: 0,
        generations: None,
        task_json: None,
    };
    assert!(matches!(house.lineage.open_stage(again).await, Err(WriteError::Contradiction { .. })));
    assert_eq!(*house.lineage.health().borrow(), Health::Good);
}

#[tokio::test]
async fn names_are_made_unique_and_cells_stay_together() {
    let house = House::new().await;
    let cell = |cell: &str| NewExperiment {
        group: Some("table".to_owned()),
        ..experiment(&format!("table/{cell}"))
    };
    house.lineage.create(vec![experiment("one")]).await.unwrap();
    house.lineage.create(vec![experiment("one")]).await.unwrap();
    house.lineage.create(vec![cell("a"), cell("b")]).await.unwrap();
    house.lineage.create(vec![cell("a"), cell("b")]).await.unwrap();
    house.lineage.create(vec![experiment("table")]).await.unwrap();
    let reader = house.lineage.reader();
    let names = |summaries: Vec<Summary>| summaries.into_iter().map(|one| one.name).collect::<Vec<_>>();
    assert_eq!(
        names(reader.summaries(None).await.unwrap()),
        ["one", "one-2", "table/a", "table/b", "table-2/a", "table-2/b", "table-3"]
    );
    for (reference, meant) in
        [("last", vec![7]), ("2", vec![2]), ("one-2", vec![2]), ("table-2", vec![5, 6]), ("table/b", vec![4])]
    {
        assert_eq!(
            reader.find(reference).await.unwrap(),
            meant.into_iter().map(ExperimentId).collect::<Vec<_>>()
        );
    }
    assert!(matches!(reader.find("nobody").await, Err(ReadError::NotFound { .. })));
    let several = reader.find_one("table").await.unwrap_err();
    assert_eq!(several.to_string(), "`table` names 2 experiments: table/a, table/b");
}

#[tokio::test]
async fn a_full_disk_stops_the_writer_until_there_is_room() {
    let house = House::new().await;
    let mut health = house.lineage.health();
    house.lineage.send(Queued { entry: Entry::FullFor(3.into()), answer: None }).await.unwrap();
    let lineage = house.lineage.clone();
    let large = NewExperiment { resolved: "#".repeat(300_000), ..experiment("large") };
    let waiting = tokio::spawn(async move { lineage.create(vec![large]).await });
    let stuck = health.wait_for(|health| *health != Health::Good).await.unwrap().clone();
    assert_eq!(stuck, Health::Stuck { reason: "the disk is full".to_owned() });
    assert!(!waiting.is_finished());
    assert_eq!(waiting.await.unwrap().unwrap(), [ExperimentId(1)]);
    assert_eq!(*health.borrow(), Health::Good);
    assert_eq!(house.one("SELECT length(resolved) FROM experiment").await, Cell::Integer(300_000));
}

#[tokio::test]
async fn a_lock_of_another_program_stops_the_writer_until_it_is_gone() {
    use sqlx::{ConnectOptions as _, Connection as _, Executor as _};
    let house = House::new().await;
    let mut health = house.lineage.health();
    let mut other = file::writing(&house.path()).connect().await.unwrap();
    other.execute("BEGIN IMMEDIATE").await.unwrap();
    let lineage = house.lineage.clone();
    let waiting = tokio::spawn(async move { lineage.create(vec![experiment("late")]).await });
    let stuck = health.wait_for(|health| *health != Health::Good).await.unwrap().clone();
    assert_eq!(stuck, Health::Stuck { reason: "another program holds it locked".to_owned() });
    other.close().await.unwrap();
    assert_eq!(waiting.await.unwrap().unwrap(), [ExperimentId(1)]);
    assert_eq!(*health.borrow(), Health::Good);
}

#[tokio::test]
async fn nothing_is_written_into_files_that_nobody_can_find_any_more() {
    let house = House::new().await;
    let mut health = house.lineage.health();
    let log = file::beside(&house.path(), "-wal");
    for (name, place) in [("moved", house.path()), ("cut off from its log", log)] {
        let elsewhere = file::beside(&place, "-elsewhere");
        std::fs::rename(&place, &elsewhere).unwrap();
        std::fs::write(&place, b"another file").unwrap();
        let lineage = house.lineage.clone();
        let waiting = tokio::spawn(async move { lineage.create(vec![experiment(name)]).await });
        let stuck = health.wait_for(|health| *health != Health::Good).await.unwrap().clone();
        let Health::Stuck { reason } = stuck else { panic!("{stuck:?}") };
        assert!(reason.contains("replaced") && reason.contains("start it again"), "{reason}");
        std::fs::rename(&elsewhere, &place).unwrap();
        waiting.await.unwrap().unwrap();
        assert_eq!(*health.borrow(), Health::Good, "it is back");
    }
}

#[tokio::test]
async fn closing_gives_up_what_the_disk_does_not_take_and_says_so() {
    use sqlx::{ConnectOptions as _, Executor as _};
    let house = House::new().await;
    let mut other = file::writing(&house.path()).connect().await.unwrap();
    other.execute("BEGIN IMMEDIATE").await.unwrap();
    let event = Event { experiment: None, kind: "k".to_owned(), text: "t".to_owned(), data: json!({}) };
    house.lineage.event(event).await.unwrap();
    let closed = tokio::time::timeout(Duration::from_secs(20), house.lineage.clone().close()).await.unwrap();
    assert!(matches!(closed, Err(WriteError::Closed { .. })), "{closed:?}");
    assert!(matches!(house.lineage.flush().await, Err(WriteError::Closed { .. })));
}

#[tokio::test]
async fn what_rests_on_the_word_of_a_liar_alone_is_taken_back_from_an_open_generation() {
    let house = House::new().await;
    let (experiment, stage) = house.begin("lied to").await;
    let by = |id, worker: &str, number| Evaluated {
        attempts: vec![Attempt { number, ..counted(worker) }],
        ..settled(id, outcome(1.0))
    };
    let first = house.generation(stage, 1, 1).await;
    house.lineage.record(vec![by(first[0], "liar", 1)]).await.unwrap();
    let mut next = opening(stage, 2, 6);
    let giver = Place { stage: 0, generation: 2, index: 0 };
    next.individuals[4] = Individual { inherits: Some(giver), ..next.individuals[0].clone() };
    let heir_of_heir = Place { index: 4, ..giver };
    next.individuals[5] = Individual { inherits: Some(heir_of_heir), ..next.individuals[0].clone() };
    for individual in &mut next.individuals {
        individual.parents.clear();
    }
    let (_, ids) = house.lineage.open_generation(next).await.unwrap();
    let inherits = |heir, giver| Evaluated {
        ending: Ending::Inherits(giver),
        ruling: None,
        attempts: vec![],
        ..settled(heir, outcome(1.0))
    };
    let failed = Attempt { fate: Fate::Failed("cannot be".to_owned()), ..counted("liar") };
    let set_aside = Ending::Settled(Err(SetAside { reason: "cannot be".to_owned() }));
    house
        .lineage
        .record(vec![
            by(ids[0], "liar", 3),
            Evaluated { audit: Some(Audited::Agreed), ..by(ids[1], "liar", 1) },
            by(ids[2], "honest", 1),
            Evaluated { ending: set_aside, ruling: None, attempts: vec![failed], ..by(ids[3], "liar", 1) },
            inherits(ids[4], ids[0]),
            inherits(ids[5], ids[4]),
        ])
        .await
        .unwrap();
    let retracted = house.lineage.retract(ids[0], 6, "liar".to_owned()).await.unwrap();
    let expected = [(0, 3), (3, 1), (4, 0), (5, 0)]
        .map(|(index, attempts): (usize, u32)| Retracted { individual: ids[index], attempts });
    assert_eq!(retracted, expected);
    let pending = house.all("SELECT id FROM v_individuals WHERE status = 'pending' ORDER BY id").await;
    assert_eq!(pending, expected.map(|one| vec![Cell::Integer(one.individual.sql())]));
    let fates = "SELECT attempt, fate FROM v_evaluations WHERE worker = 'liar' ORDER BY individual";
    let fate = |number, fate: &str| vec![Cell::Integer(number), Cell::Text(fate.to_owned())];
    let told = [fate(1, "counted"), fate(3, "retracted"), fate(1, "counted"), fate(1, "failed:cannot be")];
    assert_eq!(house.all(fates).await, told);
    // What has ended stands, and is counted.
    assert_eq!(house.lineage.reader().unaudited(experiment, "liar").await.unwrap(), 1);
    let refused = house.lineage.retract(first[0], 1, "liar".to_owned()).await.unwrap_err();
    assert!(refused.to_string().contains("retract outcomes of worker `liar`"), "{refused}");
    // Found again, it stands as anybody's.
    house.lineage.record(vec![by(ids[0], "honest", 4)]).await.unwrap();
    house.lineage.flush().await.unwrap();
    let again = format!("SELECT worker FROM v_individuals WHERE id = {}", ids[0]);
    assert_eq!(house.one(&again).await, Cell::Text("honest".to_owned()));
}

#[tokio::test]
async fn a_name_that_is_trusted_no_more_stays_so() {
    let house = House::new().await;
    let joined = |name: &str| Joined {
        name: name.to_owned(),
        host: "here".to_owned(),
        slots: 1,
        version: "1".to_owned(),
        fingerprint: [7; 32],
    };
    house.lineage.worker_joined(joined("liar")).await.unwrap();
    house.lineage.worker_joined(joined("honest")).await.unwrap();
    house.lineage.worker_quarantined("liar".to_owned()).await.unwrap();
    let house = house.reopened().await;
    assert_eq!(house.lineage.reader().quarantined().await.unwrap(), ["liar"]);
    house.lineage.worker_joined(joined("liar")).await.unwrap();
    house.lineage.flush().await.unwrap();
    let marked = "SELECT count(*) FROM v_workers WHERE name = 'liar' AND quarantined_ms IS NOT NULL";
    assert_eq!(house.one(marked).await, Cell::Integer(2));
}

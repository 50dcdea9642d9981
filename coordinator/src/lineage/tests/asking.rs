//! Questions: pedigrees, the best, and what users' SQL may not do.

use super::*;
use std::time::{Duration, Instant};

/// Three generations of three, settled.
async fn three() -> House {
    let house = House::new().await;
    let (_, stage) = house.begin("asked").await;
    for generation in 1..=3 {
        let ids = house.generation(stage, generation, 3).await;
        house.settle(&ids).await;
    }
    house.lineage.flush().await.unwrap();
    house
}

#[tokio::test]
async fn a_pedigree_goes_back_to_the_founders() {
    let house = three().await;
    let reader = house.lineage.reader();
    let ids = |ancestors: Vec<Ancestor>| -> Vec<(u64, u32)> {
        ancestors.into_iter().map(|one| (one.id.0, one.depth)).collect()
    };
    let one = IndividualId(7); // parents 4, 5, which come from 1, 2 and 2, 3
    assert_eq!(ids(reader.ancestry(one, 0, false).await.unwrap()), [(4, 1), (5, 1), (1, 2), (2, 2), (3, 2)]);
    assert_eq!(ids(reader.ancestry(one, 1, false).await.unwrap()), [(4, 1), (5, 1)]);
    let line = reader.ancestry(one, 0, true).await.unwrap();
    assert_eq!(
        line[0].parents.iter().map(|link| link.role.as_str()).collect::<Vec<_>>(),
        ["first", "second"]
    );
    assert_eq!(line[0].place, Place { stage: 0, generation: 2, index: 0 });
    assert_eq!((line[1].operator.as_str(), line[1].parents.len()), ("random", 0));
    assert_eq!(ids(line), [(4, 1), (1, 2)]);
    assert!(matches!(reader.ancestry(IndividualId(99), 0, false).await, Err(ReadError::NotFound { .. })));
    let view = house
        .all("SELECT ancestor, depth FROM v_ancestors WHERE individual = 7 ORDER BY depth, ancestor")
        .await;
    let expected = [(4, 1), (5, 1), (1, 2), (2, 2), (3, 2)];
    assert_eq!(view, expected.map(|(id, depth)| vec![Cell::Integer(id), Cell::Integer(depth)]));
}

#[tokio::test]
async fn the_best_are_the_fittest_and_the_earliest_of_equals() {
    let house = three().await;
    let reader = house.lineage.reader();
    let best = reader.best(ExperimentId(1), 4).await.unwrap();
    assert_eq!(best, [3, 6, 9, 2].map(IndividualId));
    assert_eq!(house.one("SELECT individual FROM v_best").await, Cell::Integer(3));
    let [summary] = reader.summaries(None).await.unwrap().try_into().unwrap();
    assert_eq!((summary.individuals, summary.evaluated, summary.planned), (9, 9, Some(16)));
    let [run] = summary.progress.try_into().unwrap();
    assert_eq!((run.generation, run.done, run.size, run.ended), (3, 3, 3, false));
    assert_eq!(run.best, Some((2.0, IndividualId(3))));
}

#[tokio::test]
async fn every_view_reads_whole_and_by_experiment() {
    let house = three().await;
    for name in VIEWS {
        for of in [None, Some(&[ExperimentId(1)][..])] {
            let mut answer = house.lineage.reader().view(name, of, WIDE).await.unwrap();
            while let Some(chunk) = answer.next().await {
                chunk.unwrap();
            }
        }
    }
    assert!(matches!(
        house.lineage.reader().view("individual", None, WIDE).await,
        Err(QueryError::Malformed(_))
    ));
}

#[tokio::test]
async fn the_columns_of_the_views_are_a_promise() {
    let house = House::new().await;
    let mut seen = String::new();
    for name in VIEWS {
        let answer = house.lineage.reader().view(name, None, WIDE).await.unwrap();
        seen += &format!("{name}: {}\n", answer.columns.join(" "));
    }
    assert_eq!(seen, include_str!("views.txt"), "docs/lineage.md names them all");
    let documented = include_str!("../../../../docs/lineage.md");
    for line in seen.lines() {
        let (view, columns) = line.split_once(": ").unwrap();
        let section = documented.split(&format!("### `{view}`")).nth(1).expect(view);
        let section = section.split("\n##").next().unwrap();
        for column in columns.split(' ') {
            assert!(section.contains(&format!("`{column}`")), "docs/lineage.md: {view}.{column}");
        }
    }
}

#[tokio::test]
async fn users_sql_can_only_read() {
    let house = three().await;
    let other = house.folder.path().join("secret.db");
    let attach = format!("ATTACH '{}' AS secret", other.display());
    let forbidden = [
        ("DELETE FROM outcome", "write to outcome"),
        ("INSERT INTO word (text) VALUES ('x')", "write to word"),
        ("UPDATE experiment SET name = 'x'", "write to experiment"),
        ("WITH a AS (SELECT 1) INSERT INTO word (text) SELECT * FROM a", "write to word"),
        ("DROP TABLE outcome", "write to sqlite_master"),
        ("CREATE TABLE t (a)", "write to sqlite_master"),
        ("CREATE TEMP TABLE t (a)", "write to sqlite_temp_master"),
        (attach.as_str(), "attach another database"),
        ("PRAGMA query_only = 0", "use PRAGMA query_only"),
        ("PRAGMA user_version = 7", "use PRAGMA user_version"),
        ("SELECT * FROM pragma_database_list", "use PRAGMA database_list"),
        ("BEGIN", "hold a transaction"),
        ("SAVEPOINT s", "hold a transaction"),
        ("ANALYZE", "write to"),
        ("SELECT load_extension('/tmp/x.so')", "call load_extension"),
    ];
    for (sql, why) in forbidden {
        match ask(house.lineage.reader(), sql, WIDE).await {
            Err(QueryError::Forbidden(text)) => assert!(text.contains(why), "{sql}: {text}"),
            other => panic!("{sql}: {other:?}"),
        }
    }
    assert!(!other.exists());
    // VACUUM INTO asks the authorizer for nothing we could name; it fails for want of a second database.
    let copy = house.folder.path().join("copy.db");
    let vacuum = format!("VACUUM INTO '{}'", copy.display());
    assert!(ask(house.lineage.reader(), &vacuum, WIDE).await.is_err());
    assert!(!copy.exists());
    let malformed = [
        ("SELECT 1; SELECT 2", "more than one statement"),
        ("SELECT 1; DROP TABLE outcome", "sqlite_master"),
        ("", "no statement"),
        ("-- nothing", "no statement"),
        ("SELEC 1", "syntax error"),
        ("SELECT nobody FROM v_best", "no such column"),
        ("SELECT writefile('/tmp/x', 'y')", "no such function"),
        ("SELECT 'a\0b'", "NUL"),
    ];
    for (sql, why) in malformed {
        let error = ask(house.lineage.reader(), sql, WIDE).await.unwrap_err();
        assert!(error.to_string().contains(why), "{sql}: {error}");
    }
    assert_eq!(house.all("SELECT 1; -- done").await.len(), 1);
    assert_eq!(house.one("SELECT count(*) FROM outcome").await, Cell::Integer(9));
}

#[tokio::test]
async fn users_sql_ends() {
    let house = three().await;
    let endless = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT";
    let reader = house.lineage.reader();
    let limits = Limits { rows: 1000, bytes: 1 << 20, time: Duration::from_millis(300) };
    for (select, why) in [
        ("count(*) FROM n", "stopped after 0.3 s"),
        ("i FROM n", "more than 1000 rows"),
        ("randomblob(100000) FROM n", "more than 1048576 bytes"),
        ("zeroblob(2000000000) FROM n", "too large"),
    ] {
        let before = Instant::now();
        match ask(reader, &format!("{endless} {select}"), limits).await {
            Err(QueryError::TooMuch(text)) => assert!(text.contains(why), "{select}: {text}"),
            other => panic!("{select}: {other:?}"),
        }
        assert!(before.elapsed() < Duration::from_secs(5));
    }
    // Those who ask and go away leave nothing running: their turns come back.
    for _ in 0..12 {
        let patient = Limits { time: Duration::from_secs(600), ..WIDE };
        let sql = format!("{endless} i FROM n WHERE i < 0");
        let question = reader.query(&sql, patient);
        drop(tokio::time::timeout(Duration::from_secs(10), question).await.expect("a turn comes").unwrap());
    }
}

#[tokio::test]
async fn values_come_as_they_are() {
    let house = House::new().await;
    let row =
        house.all("SELECT 1, 1.0, 'a', x'00ff', NULL, 9007199254740993, CAST(x'ff' AS TEXT)").await.remove(0);
    assert_eq!(
        row,
        [
            Cell::Integer(1),
            Cell::Real(1.0),
            Cell::Text("a".to_owned()),
            Cell::Blob(vec![0, 255]),
            Cell::Null,
            Cell::Integer(9_007_199_254_740_993),
            Cell::Text("\u{fffd}".to_owned())
        ]
    );
}

#[tokio::test]
async fn clients_hold_up_nobody_but_each_other() {
    let house = House::new().await;
    let (experiment, stage) = house.begin("crawler").await;
    let clients = house.lineage.clients().pool();
    let mut held = Vec::new();
    while held.len() < clients.options().get_max_connections() as usize {
        held.push(clients.acquire().await.unwrap());
    }
    assert!(clients.try_acquire().is_none());
    let first = house.generation(stage, 1, 3).await;
    house.settle(&first).await;
    assert_eq!(house.lineage.reader().experiment(experiment).await.unwrap().stages.len(), 1);
}

//! What opens, what does not, and that what does not is left as it was.

use super::*;
use sqlx::{ConnectOptions as _, Connection as _, Executor as _};

async fn error(path: &Path) -> OpenError {
    match Lineage::open(path).await {
        Err(error) => error,
        Ok(_) => panic!("it opened"),
    }
}

#[tokio::test]
async fn a_lineage_keeps_its_identity() {
    let house = House::new().await;
    let identity = house.lineage.identity();
    let other = House::new().await.lineage.identity();
    assert_ne!(identity, other);
    assert_eq!(house.reopened().await.lineage.identity(), identity);
}

#[tokio::test]
async fn a_second_coordinator_is_refused_and_told_who_holds_the_file() {
    let house = House::new().await;
    let refused = error(&house.path()).await;
    let OpenError::Held { holder, .. } = &refused else { panic!("{refused}") };
    assert!(holder.starts_with(&format!("process {}", std::process::id())), "{holder}");
    Reader::open(&house.path()).await.unwrap();
    house.reopened().await;
}

#[tokio::test]
async fn a_second_coordinator_is_refused_by_any_name_of_the_file() {
    let house = House::new().await;
    for (name, link) in
        [("soft.db", std::os::unix::fs::symlink as fn(_, _) -> _), ("hard.db", std::fs::hard_link)]
    {
        let other = house.folder.path().join(name);
        link(house.path(), other.clone()).unwrap();
        let refused = error(&other).await;
        assert!(matches!(refused, OpenError::Held { .. }), "{name}: {refused}");
    }
    house.reopened().await;
}

#[tokio::test]
async fn a_newer_schema_is_refused_untouched() {
    let house = House::new().await;
    let path = house.path();
    let House { folder: _folder, lineage } = house;
    lineage.close().await.unwrap();
    let mut connection = file::writing(&path).connect().await.unwrap();
    connection.execute("PRAGMA user_version = 99").await.unwrap();
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").await.unwrap();
    connection.close().await.unwrap();
    let before = std::fs::read(&path).unwrap();
    for refused in [error(&path).await, Reader::open(&path).await.err().unwrap()] {
        assert!(matches!(refused, OpenError::Newer { found: 99, .. }), "{refused}");
    }
    assert_eq!(std::fs::read(&path).unwrap(), before);
}

#[tokio::test]
async fn what_is_no_lineage_is_refused_untouched() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("notes.txt");
    std::fs::write(&text, "a letter, and rather a long one, since a header has a hundred bytes. ".repeat(5))
        .unwrap();
    assert!(matches!(error(&text).await, OpenError::Foreign { .. }));
    let other = folder.path().join("other.db");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(&other).create_if_missing(true);
    let mut connection = options.connect().await.unwrap();
    connection.execute("CREATE TABLE t (a)").await.unwrap();
    connection.close().await.unwrap();
    for path in [text, other] {
        let before = std::fs::read(&path).unwrap();
        assert!(matches!(error(&path).await, OpenError::Foreign { .. }));
        assert!(matches!(Reader::open(&path).await, Err(OpenError::Foreign { .. })));
        assert_eq!(std::fs::read(&path).unwrap(), before);
    }
    let missing = folder.path().join("missing.db");
    assert!(matches!(Reader::open(&missing).await, Err(OpenError::Missing { .. })));
    assert!(!missing.exists());
    let nowhere = folder.path().join("no/such/folder.db");
    assert!(matches!(error(&nowhere).await, OpenError::Unavailable { .. }));
}

#[tokio::test]
async fn a_damaged_file_is_called_so() {
    let house = House::new().await;
    let (_, stage) = house.begin("damaged").await;
    house.generation(stage, 1, 500).await;
    let path = house.path();
    let House { folder: _folder, lineage } = house;
    lineage.close().await.unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[4096..].fill(0xaa);
    std::fs::write(&path, bytes).unwrap();
    let refused = error(&path).await;
    assert!(matches!(refused, OpenError::Corrupt { .. }), "{refused}");
    assert!(refused.to_string().contains("the file is damaged"), "{refused}");
}

#[tokio::test]
async fn a_finished_file_opens_where_nothing_may_be_written() {
    let house = House::new().await;
    house.begin("finished").await;
    let path = house.path();
    let House { folder, lineage } = house;
    lineage.close().await.unwrap();
    // What a folder without permission comes to, also for root: no place for the index of the log.
    std::fs::create_dir(folder.path().join("test.db-shm")).unwrap();
    let reader = Reader::open(&path).await.unwrap();
    assert_eq!(reader.find("last").await.unwrap(), [ExperimentId(1)]);
    assert_eq!(ask(&reader, "SELECT name FROM v_experiments", WIDE).await.unwrap().len(), 1);
}

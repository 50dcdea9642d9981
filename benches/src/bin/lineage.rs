//! The lineage at a million individuals: rows a second against bare SQLite taking the same rows, how long its
//! ancestors take, how soon a coordinator that starts on it hands out work, and how much an individual weighs.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use clap::Parser;
use coordinator::lineage::Reader;
use hatchery_benches::pedigree::{Size, make};
use hatchery_benches::report::Report;
use hatchery_tests::Process;
use hatchery_tests::programs::program;
use proto::v1;
use proto::v1::coordinator_message::Kind as Incoming;
use proto::v1::fleet_client::FleetClient;
use proto::v1::worker_message::Kind as Outgoing;
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};
use sqlx::{ConnectOptions as _, Connection as _, Row as _};
use tonic::transport::Channel;

/// Rows in one INSERT, as the lineage's writer has it.
const BATCH: usize = 32;
/// Rows in one transaction of bare SQLite: an ordinary generation's.
const TRANSACTION: usize = 80;

/// Measure the lineage at a million individuals
#[derive(Debug, Parser)]
struct Arguments {
    /// Repetitions of 300 generations of 80; fewer for a quick look
    #[arg(long, default_value_t = Size::MILLION.runs)]
    runs: u32,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let size = Size { runs: Arguments::parse().runs, ..Size::MILLION };
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("million.db");
    let mut report = Report::new("lineage", &["what", "value", "unit", "peer", "ratio"]);

    let made = make(&file, size).await?;
    let written = size.individuals() as f64 / made.seconds;
    let bare = bare_rate(&file, &folder.path().join("bare.db")).await?;
    report.row(&[json!("individuals written"), json!(written), json!("1/s"), Value::Null, Value::Null]);
    report.row(&[
        json!("bare SQLite, same rows"),
        json!(bare),
        json!("1/s"),
        json!(written),
        json!(written / bare),
    ]);

    let reader = Reader::open(&file).await?;
    for (what, line) in [("one line of ancestors", true), ("whole pedigree", false)] {
        let (mut milliseconds, mut found) = (f64::INFINITY, 0);
        for _ in 0..20 {
            let start = Instant::now();
            found = reader.ancestry(made.youngest, 0, line).await?.len();
            milliseconds = milliseconds.min(start.elapsed().as_secs_f64() * 1000.0);
        }
        ensure!(
            found >= size.generations as usize - 1,
            "{what}: {found} ancestors do not reach the founders"
        );
        report.row(&[
            json!(format!("{what} ({found})")),
            json!(milliseconds),
            json!("ms"),
            Value::Null,
            Value::Null,
        ]);
    }
    reader.close().await;

    let bytes = bytes_besides_genotypes(&file, size.individuals()).await?;
    report.row(&[
        json!("an individual besides its genotype"),
        json!(bytes),
        json!("bytes"),
        Value::Null,
        Value::Null,
    ]);

    let mut seconds = f64::INFINITY;
    for _ in 0..3 {
        seconds = seconds.min(restart(folder.path(), &file).await?);
    }
    report.row(&[json!("restart to first dispatch"), json!(seconds), json!("s"), Value::Null, Value::Null]);
    Ok(())
}

/// Individuals a second that bare SQLite takes when it is given the rows of a lineage again: the same columns
/// in as few statements, the same durability, without foreign keys, compression or ids to resolve.
async fn bare_rate(from: &Path, to: &Path) -> anyhow::Result<f64> {
    const INDIVIDUALS: i64 = 100_000;
    let options = |path: &Path| {
        SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .page_size(16384)
            .pragma("wal_autocheckpoint", "0")
            .foreign_keys(false)
    };
    let mut source = options(from).connect().await?;
    let mut target = options(to).connect().await?;
    let mut tables = Vec::new();
    for (table, key) in
        [("individual", "id"), ("parent", "child"), ("genotype", "individual"), ("outcome", "individual")]
    {
        let schema: String = sqlx::query_scalar("SELECT sql FROM sqlite_schema WHERE name = ?")
            .bind(table)
            .fetch_one(&mut source)
            .await?;
        sqlx::raw_sql(sqlx::AssertSqlSafe(schema)).execute(&mut target).await?;
        let select = format!("SELECT * FROM {table} WHERE {key} <= {INDIVIDUALS}");
        let rows = sqlx::query(sqlx::AssertSqlSafe(select)).fetch_all(&mut source).await?;
        tables.push((table, key, rows));
    }
    let start = Instant::now();
    let mut next = vec![0; tables.len()];
    for last in (1..=INDIVIDUALS).step_by(TRANSACTION).map(|first| first + TRANSACTION as i64 - 1) {
        let mut transaction = target.begin().await?;
        for ((table, key, rows), next) in tables.iter().zip(&mut next) {
            let end = rows[*next..].partition_point(|row| row.get::<i64, _>(*key) <= last) + *next;
            for batch in rows[*next..end].chunks(BATCH) {
                insert(&mut transaction, table, batch).await?;
            }
            *next = end;
        }
        transaction.commit().await?;
    }
    let rate = INDIVIDUALS as f64 / start.elapsed().as_secs_f64();
    target.close().await?;
    source.close().await?;
    Ok(rate)
}

async fn insert(
    connection: &mut sqlx::SqliteConnection,
    table: &str,
    rows: &[sqlx::sqlite::SqliteRow],
) -> anyhow::Result<()> {
    use sqlx::sqlite::SqliteTypeInfo;
    use sqlx::{TypeInfo as _, ValueRef as _};
    let width = rows[0].len();
    let one = format!("({})", vec!["?"; width].join(","));
    let sql = format!("INSERT INTO {table} VALUES {}", vec![one; rows.len()].join(","));
    let mut query = sqlx::query(sqlx::AssertSqlSafe(sql));
    for row in rows {
        for column in 0..width {
            let value = row.try_get_raw(column)?;
            let kind: SqliteTypeInfo = value.type_info().into_owned();
            query = match kind.name() {
                _ if value.is_null() => query.bind(None::<i64>),
                "INTEGER" => query.bind(row.get::<i64, _>(column)),
                "REAL" => query.bind(row.get::<f64, _>(column)),
                "TEXT" => query.bind(row.get::<&str, _>(column)),
                _ => query.bind(row.get::<&[u8], _>(column)),
            };
        }
    }
    query.execute(connection).await?;
    Ok(())
}

/// Bytes of the file that are no genotype's, an individual.
async fn bytes_besides_genotypes(file: &Path, individuals: u64) -> anyhow::Result<f64> {
    let mut connection = SqliteConnectOptions::new().filename(file).read_only(true).connect().await?;
    let genotypes: i64 =
        sqlx::query_scalar("SELECT sum(length(bytes)) FROM genotype").fetch_one(&mut connection).await?;
    connection.close().await?;
    let whole = std::fs::metadata(file)?.len();
    Ok((whole as f64 - genotypes as f64) / individuals as f64)
}

/// Seconds from the start of a coordinator's process until a worker that attaches at once is handed its first
/// evaluation.
async fn restart(folder: &Path, file: &Path) -> anyhow::Result<f64> {
    let fingerprint = creatures::fingerprint().to_vec();
    let address_file = folder.join("address");
    let _ = std::fs::remove_file(&address_file);
    let mut command = Command::new(program("hatchery-coordinator"));
    command.arg("--db").arg(file).args(["--listen", "127.0.0.1:0"]).arg("--address-file").arg(&address_file);
    let start = Instant::now();
    let coordinator = Process::start(&mut command, &folder.join("coordinator.log"));
    let address = loop {
        if let Ok(address) = std::fs::read_to_string(&address_file) {
            break address;
        }
        ensure!(start.elapsed() < Duration::from_secs(60), "no address:\n{}", coordinator.log());
        tokio::time::sleep(Duration::from_millis(1)).await;
    };
    let mut fleet = FleetClient::new(Channel::from_shared(format!("http://{address}"))?.connect().await?);
    let hello = v1::Hello {
        protocol: proto::PROTOCOL,
        name: "bench".to_owned(),
        host: "here".to_owned(),
        slots: 1,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: fingerprint.into(),
        window: 1,
        lineage: Default::default(),
        holding: vec![],
        labels: Default::default(),
        incarnation: 1,
    };
    let (say, said) = tokio::sync::mpsc::channel(1);
    say.send(v1::WorkerMessage { kind: Some(Outgoing::Hello(hello)) }).await?;
    let mut messages = fleet.attach(tokio_stream::wrappers::ReceiverStream::new(said)).await?.into_inner();
    loop {
        let message = messages.message().await?.context("the coordinator hung up")?;
        if matches!(message.kind, Some(Incoming::Batch(_))) {
            return Ok(start.elapsed().as_secs_f64());
        }
    }
}

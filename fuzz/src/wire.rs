//! Messages off the wire, as far as the two ends of a stream read them.

use coordinator::service::words;
use creatures::{Cull, Interim, Outcome, Verdict};
use prost::Message as _;
use proto::hello::{HOLDING_MAX, SLOTS_MAX};
use proto::v1::coordinator_message::Kind as Told;
use proto::v1::report::What;
use proto::v1::worker_message::Kind as Said;
use proto::{TaskHash, v1};

/// What a worker says: a hello that is let in is within its bounds, and an outcome that is comes out of another
/// encoding to the same bits.
pub fn worker_message(bytes: &[u8]) {
    let Ok(message) = v1::WorkerMessage::decode(bytes) else { return };
    let reports = match message.kind {
        Some(Said::Hello(hello)) => {
            if let Ok(hello) = words::introduce(hello, &[7; 16]) {
                assert!((1..=SLOTS_MAX).contains(&hello.slots) && !hello.name.is_empty(), "{hello:?}");
                assert!(hello.holding.len() <= HOLDING_MAX && hello.incarnation != 0, "{hello:?}");
            }
            return;
        }
        Some(Said::Reports(reports)) => reports.reports,
        _ => return,
    };
    for report in reports {
        if let Ok(read) = words::report(report.clone()) {
            assert!(read.seconds >= 0.0 && read.seconds.is_finite(), "{read:?}");
        }
        match report.what {
            Some(What::Interim(interim)) => {
                // Any measure will do, NaN included: each has a verdict.
                let Ok(interim) = Interim::try_from(interim) else { continue };
                let cull = Cull { at: 0.5, cutoff: Some(0.0), control: false };
                let verdict = cull.verdict(interim.measure);
                assert_eq!(verdict == Verdict::Cull, interim.measure < 0.0, "{interim:?}");
            }
            Some(What::Outcome(outcome)) => {
                let Ok(outcome) = Outcome::try_from(outcome) else { continue };
                let again = v1::Outcome::from(outcome.clone()).encode_to_vec();
                let again = v1::Outcome::decode(&again[..]).expect("what was encoded is decoded");
                let again = Outcome::try_from(again).expect("what was let in is let in again");
                assert_eq!(outcome.digest(), again.digest());
                assert!(proto::convert::admissible(&outcome).is_ok(), "{outcome:?} was let in");
            }
            _ => {}
        }
    }
}

/// What a coordinator says: a task that is let in hashes to its name.
pub fn coordinator_message(bytes: &[u8]) {
    let Ok(message) = v1::CoordinatorMessage::decode(bytes) else { return };
    match message.kind {
        Some(Told::Task(task)) => {
            if let Ok(hash) = task.verified() {
                assert_eq!(hash, proto::task_hash(&task.system, task.version, &task.spec));
            }
        }
        Some(Told::Batch(batch)) => {
            for assignment in batch.assignments {
                // Either may be refused; neither may panic.
                let _ = TaskHash::try_from(&assignment.task);
                if let Some(Ok(cull)) = assignment.cull.map(Cull::try_from) {
                    assert!(cull.at > 0.0 && cull.at < 1.0, "{cull:?} was let in");
                }
            }
        }
        _ => {}
    }
}

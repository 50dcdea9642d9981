//! Messages off the wire, as far as the two ends of a stream read them.

use creatures::{Cull, Interim, Outcome, Verdict};
use prost::Message as _;
use proto::v1::coordinator_message::Kind as Told;
use proto::v1::report::What;
use proto::v1::worker_message::Kind as Said;
use proto::{TaskHash, v1};

/// What a worker says: an outcome that is let in comes out of another encoding to the same bits.
pub fn worker_message(bytes: &[u8]) {
    let Ok(message) = v1::WorkerMessage::decode(bytes) else { return };
    let Some(Said::Reports(reports)) = message.kind else { return };
    for report in reports.reports {
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

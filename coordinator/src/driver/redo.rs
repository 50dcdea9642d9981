//! What becomes of an open generation when one of its workers is trusted no more: outcomes that rest on its word
//! alone are taken back and found again. Generations that have ended stand, and the lineage says what rests on it.

use std::collections::BTreeMap;

use serde_json::json;

use super::conduct::{ConductError, Conductor, Run, STAGE};
use crate::fleet::Evaluation;
use crate::lineage::{Event, IndividualId};

impl Conductor {
    /// Takes back what a worker delivered in the generations that wait, and hands it out again. Everything settled
    /// must have been written. Gives the runs that miss nothing.
    pub(super) async fn redo(
        &self,
        worker: &str,
        waiting: &mut BTreeMap<IndividualId, Run>,
    ) -> Result<Vec<Run>, ConductError> {
        let lineage = &self.driver.shared.lineage;
        let mut count = 0;
        let mut again = Vec::new();
        for (&first, run) in waiting.iter_mut() {
            let size = run.generation.progress().0 as u32;
            let retracted = lineage.retract(first, size, worker.to_owned()).await?;
            for one in &retracted {
                let index = run.generation.index(one.individual);
                run.generation.unsettle(index.expect("what was taken back is of this generation"));
                // Heirs are settled with the one that they inherit from.
                if let Some(evaluation) = run.again.get(&one.individual) {
                    again.push(Evaluation { attempts_before: one.attempts, ..evaluation.clone() });
                }
            }
            if !retracted.is_empty() {
                count += retracted.len();
                self.progress.taken_back(run.number, retracted.len());
                self.progress.generation(run.number, STAGE, &run.generation);
            }
        }
        let standing = lineage.reader().unaudited(self.id, worker).await?;
        if count > 0 || standing > 0 {
            let event = Event {
                experiment: Some(self.id),
                kind: "retraction".to_owned(),
                text: format!(
                    "worker `{worker}` is trusted no more: {count} outcomes of open generations are found again, and \
                     {standing} of generations that have ended were not audited and stand"
                ),
                data: json!({ "worker": worker, "retracted": count, "standing": standing }),
            };
            tracing::warn!(experiment = %self.id, "{}", event.text);
            lineage.event(event).await?;
        }
        self.queue.submit(again).await;
        let complete: Vec<IndividualId> =
            waiting.iter().filter(|(_, run)| run.generation.complete()).map(|(&first, _)| first).collect();
        Ok(complete.into_iter().filter_map(|first| waiting.remove(&first)).collect())
    }
}

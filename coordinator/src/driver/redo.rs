//! What becomes of an open generation when one of its workers is trusted no more: outcomes that rest on its word
//! alone are taken back and found again. Generations that have ended stand, and the lineage says what rests on it.

use std::collections::BTreeMap;

use serde_json::json;

use super::conduct::{ConductError, Conductor};
use super::run::Run;
use crate::fleet::Evaluation;
use crate::lineage::{Event, IndividualId, ResumePoint, StageId};

impl Conductor {
    /// Where a stage stands, without what rests on the word of workers that are trusted no more: a kill may have
    /// come before it was taken back.
    pub(super) async fn resume_point(&self, stage: StageId) -> Result<Option<ResumePoint>, ConductError> {
        let lineage = &self.driver.shared.lineage;
        let Some(point) = lineage.reader().resume_point(stage).await? else { return Ok(None) };
        let Some(first) = point.individuals.first() else { return Ok(Some(point)) };
        let mut is_as_it_was = true;
        for worker in lineage.reader().quarantined().await? {
            let retracted = lineage.retract(first.id, point.individuals.len() as u32, worker).await?;
            is_as_it_was &= retracted.is_empty();
        }
        if is_as_it_was { Ok(Some(point)) } else { Ok(lineage.reader().resume_point(stage).await?) }
    }

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
                let index = index.expect("what was taken back is of this generation");
                run.generation.unsettle(index);
                let individual = lineage.reader().individual(one.individual).await?;
                // Heirs are settled with the one that they inherit from.
                if individual.inherits.is_none() {
                    let evaluation = self.evaluation(run, index, individual.genotype);
                    again.push(Evaluation { attempts_before: one.attempts, ..evaluation });
                }
            }
            if !retracted.is_empty() {
                count += retracted.len();
                self.progress.taken_back(run.number, retracted.len());
                self.progress.generation(run);
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

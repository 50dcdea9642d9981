//! A search where its run stands: from the checkpoint, or, where that is damaged, made again from the one
//! before and from what stands in the lineage (ESP EF-13). It goes back no further than one generation.

use creatures::Outcome;
use search::Search;
use serde_json::json;

use super::conduct::{ConductError, Conductor};
use super::run::{place, same};
use crate::lineage::{Event, ReadError, StageId, StoredStage};

/// Why a search is not restored from a checkpoint; another one may do.
type Problem = String;

impl Conductor {
    /// The search of a run before it asks for a generation of the last stage of its path; past the latest one,
    /// at the end of that stage.
    ///
    /// # Errors
    /// A lineage that cannot be read; no usable checkpoint.
    pub(super) async fn restore(
        &self,
        run: u32,
        path: &[StoredStage],
        generation: u32,
    ) -> Result<Box<dyn Search>, ConductError> {
        let stage = path.last().expect("a run that is restored has a stage");
        let at = place(&stage.name, generation);
        let problem = match self.kept(run, stage.id, generation).await? {
            Ok(search) => return Ok(search),
            Err(problem) => problem,
        };
        match self.made_again(run, path, generation).await? {
            Ok(search) => {
                let text = format!(
                    "run {run}, {at}: its checkpoint is damaged ({problem}); it was made again from the one before"
                );
                tracing::warn!(experiment = %self.id, "{text}");
                let data = json!({ "run": run, "stage": stage.stage, "generation": generation });
                let (experiment, kind) = (Some(self.id), "checkpoint".to_owned());
                self.driver.shared.lineage.event(Event { experiment, kind, text, data }).await?;
                Ok(search)
            }
            Err(again) => {
                let problem = format!("{problem}; nor can it be made again from the one before: {again}");
                Err(ConductError::Checkpoint { run, at, problem })
            }
        }
    }

    /// The search at a checkpoint.
    async fn kept(
        &self,
        run: u32,
        stage: StageId,
        generation: u32,
    ) -> Result<Result<Box<dyn Search>, Problem>, ConductError> {
        let checkpoint = match self.driver.shared.lineage.reader().checkpoint(stage, generation).await {
            Ok(Some(checkpoint)) => checkpoint,
            Ok(None) => return Ok(Err("there is none".to_owned())),
            Err(ReadError::Corrupt { problem }) => return Ok(Err(problem)),
            Err(error) => return Err(error.into()),
        };
        Ok(self.experiment.restore(run, &checkpoint).map_err(|error| error.to_string()))
    }

    /// The search told again of the generation before, or led again out of the stage before.
    async fn made_again(
        &self,
        run: u32,
        path: &[StoredStage],
        generation: u32,
    ) -> Result<Result<Box<dyn Search>, Problem>, ConductError> {
        let reader = self.driver.shared.lineage.reader();
        let (stage, before) = path.split_last().expect("a run that is restored has a stage");
        if generation > 1 {
            let mut search = match self.kept(run, stage.id, generation - 1).await? {
                Ok(search) => search,
                Err(problem) => return Ok(Err(problem)),
            };
            let standing = reader.standings(stage.id, generation - 1).await?;
            let outcomes: Option<Vec<Option<Outcome>>> =
                standing.iter().map(|one| Some(one.ending.clone()?.ok())).collect();
            return Ok(tokio::task::block_in_place(|| match outcomes {
                Some(outcomes) if same(&search.ask(), &standing) => {
                    search.tell(&outcomes);
                    Ok(search)
                }
                _ => Err("the search now asks for others than stand in the lineage".to_owned()),
            }));
        }
        let Some(before) = before.last() else { return Ok(Ok(self.experiment.start(run))) };
        let mut search = match self.kept(run, before.id, before.latest + 1).await? {
            Ok(search) => search,
            Err(problem) => return Ok(Err(problem)),
        };
        match reader.picked(self.id, before.id).await? {
            None => Ok(Ok(search)),
            Some(picked) => Ok(search.pick(picked).map(|()| search).map_err(|error| error.to_string())),
        }
    }
}

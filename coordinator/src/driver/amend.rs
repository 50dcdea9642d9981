//! Going on with a changed file, where it changes only what has not begun (ESP E-86, EF-11). What may differ,
//! the search says.

use search::{Experiment, Overrides, Problem};
use serde_json::json;

use super::{ControlError, Driver, incompatible};
use crate::lineage::{
    Amendment, ExperimentId, Lineage, ReadError, StageId, State, StoredExperiment, StoredStage, WriteError,
};

/// A changed experiment file.
#[derive(Debug, Clone)]
pub struct Changed {
    /// Its text.
    pub text: String,
    /// Which profile, and which keys are overridden.
    pub overrides: Overrides,
}

/// Why an experiment does not go on with a changed file.
#[derive(Debug, thiserror::Error)]
pub enum AmendError {
    /// Something moves.
    #[error("experiment {0} is running: pause it first")]
    Running(ExperimentId),
    /// It has ended for good.
    #[error("experiment {0} is {word}", word = .1.word())]
    Ended(ExperimentId, State),
    /// The file has problems.
    #[error("the experiment file has {} problem(s)", .0.len())]
    Problems(Vec<Problem>),
    /// It differs in what was evolved already; each difference.
    #[error("the file differs in what was evolved already: {}", .0.join("; "))]
    Refused(Vec<String>),
    /// It was begun by other physics, or cannot be taken up.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The lineage could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The lineage could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Gives an experiment at rest a changed file, and lets it run when it is taken up. Gives the differences.
///
/// # Errors
/// See [`AmendError`]; nothing is then written.
pub async fn amend_at_rest(
    lineage: &Lineage,
    fingerprint: [u8; 32],
    id: ExperimentId,
    changed: &Changed,
) -> Result<Vec<String>, AmendError> {
    let stored = lineage.reader().experiment(id).await?;
    match stored.state {
        State::Running => return Err(AmendError::Running(id)),
        State::Cancelled | State::Failed => return Err(AmendError::Ended(id, stored.state)),
        State::Paused | State::Awaiting | State::Finished => {}
    }
    if let Some(reason) = incompatible(&stored, &fingerprint) {
        return Err(ControlError::Incompatible(id, reason).into());
    }
    let experiment =
        Experiment::parse_one(&changed.text, &changed.overrides).map_err(AmendError::Problems)?;
    let mut ends = Vec::new();
    for run in 1..=stored.runs {
        if let Some(latest) = stored.stages.iter().rfind(|stage: &&StoredStage| stage.run == run) {
            ends.push((latest.id, if latest.ended { latest.latest + 1 } else { latest.latest }));
        }
    }
    let differences = differences(lineage, &stored, &experiment, &ends).await?;
    let data = json!({ "differences": differences, "resolved_before": stored.resolved });
    let amendment = Amendment {
        experiment: id,
        resolved: experiment.resolved(),
        digest: experiment.digest(),
        task_json: experiment.task_json(),
        planned: experiment.planned(),
        data,
    };
    lineage.amend(amendment).await?;
    Ok(differences)
}

/// What differs in a changed experiment, if each run can go on with it from its checkpoint, named by stage and
/// generation.
pub(super) async fn differences(
    lineage: &Lineage,
    stored: &StoredExperiment,
    changed: &Experiment,
    checkpoints: &[(StageId, u32)],
) -> Result<Vec<String>, AmendError> {
    let mut refused = Vec::new();
    let mut fixed = |key: &str, was: String, is: String| {
        if was != is {
            refused.push(format!("{key} is {is}, was {was}"));
        }
    };
    fixed("system", stored.system.clone(), changed.system.clone());
    fixed("search.kind", stored.search_kind.clone(), changed.search_kind().to_owned());
    fixed("seed", stored.seed.to_string(), changed.seed.to_string());
    fixed("runs", stored.runs.to_string(), changed.runs.to_string());
    if !refused.is_empty() {
        return Err(AmendError::Refused(refused));
    }
    let mut noted: Vec<String> = Vec::new();
    for &(stage, generation) in checkpoints {
        let Some(checkpoint) = lineage.reader().checkpoint(stage, generation).await? else { continue };
        let differences = changed.amend(&checkpoint);
        let differences = differences.map_err(|error| AmendError::Refused(vec![error.to_string()]))?;
        for difference in differences.iter().map(ToString::to_string) {
            if !noted.contains(&difference) {
                noted.push(difference);
            }
        }
    }
    Ok(noted)
}

impl Driver {
    /// Goes on with a changed file. Gives the differences.
    ///
    /// # Errors
    /// See [`AmendError`].
    pub async fn amend(&self, id: ExperimentId, changed: &Changed) -> Result<Vec<String>, AmendError> {
        let shared = &self.shared;
        let _nobody_picks = shared.picking.lock().await;
        let differences = amend_at_rest(&shared.lineage, shared.fingerprint, id, changed).await?;
        // One that is paused is still conducted, by the file of before; what it had not written is lived again.
        let active = self.active().remove(&id);
        if let Some(active) = active {
            active.control.cancel().await;
            active.conducting.abort();
        }
        self.tell(id);
        self.take_up(shared.lineage.reader().experiment(id).await?).await?;
        Ok(differences)
    }
}

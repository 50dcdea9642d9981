//! Picking who goes on from the end of a stage. The pick is on disk before anything goes on; a refused one
//! changes nothing (ESP EF-14).

use search::PickedBy;

use super::{ControlError, Driver};
use crate::lineage::{
    ExperimentId, IndividualId, Lineage, NewPick, ReadError, State, StoredChoice, WriteError,
};

/// Why nobody was picked.
#[derive(Debug, thiserror::Error)]
pub enum PickError {
    /// It waits for no pick.
    #[error("experiment {0} awaits no pick")]
    NotAwaited(ExperimentId),
    /// It waits for another one.
    #[error(
        "individual {individual} is no candidate of experiment {experiment}: see `hatchery candidates {experiment}`"
    )]
    NoCandidate {
        /// Who was to be picked.
        individual: IndividualId,
        /// Of which experiment.
        experiment: ExperimentId,
    },
    /// It is over.
    #[error("experiment {0} is {word}", word = .1.word())]
    Ended(ExperimentId, State),
    /// The lineage could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The lineage could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It was picked, and the experiment cannot go on here.
    #[error(transparent)]
    Control(#[from] ControlError),
}

/// Writes a person's pick into a lineage in which nothing of the experiment moves: it goes on with it whenever
/// it is taken up. Gives the choice that it ended.
///
/// # Errors
/// See [`PickError`]; nothing is then written.
pub async fn pick_at_rest(
    lineage: &Lineage,
    experiment: ExperimentId,
    individual: IndividualId,
    note: String,
) -> Result<StoredChoice, PickError> {
    let stored = lineage.reader().experiment(experiment).await?;
    if !stored.state.is_unfinished() {
        return Err(PickError::Ended(experiment, stored.state));
    }
    let mut awaited: Vec<_> = lineage.reader().choices(experiment).await?;
    awaited.retain(|choice| choice.picked.is_none());
    if awaited.is_empty() {
        return Err(PickError::NotAwaited(experiment));
    }
    let is_among = |choice: &StoredChoice| choice.candidates.iter().any(|one| one.individual == individual);
    let choice =
        awaited.into_iter().find(is_among).ok_or(PickError::NoCandidate { individual, experiment })?;
    let stage = choice.stage;
    lineage.pick(NewPick { experiment, stage, individual, by: PickedBy::Human, note }).await?;
    Ok(choice)
}

impl Driver {
    /// Picks who goes on, and lets the experiment go on unless it is paused.
    ///
    /// # Errors
    /// See [`PickError`].
    pub async fn pick(
        &self,
        experiment: ExperimentId,
        individual: IndividualId,
        note: String,
    ) -> Result<(), PickError> {
        let shared = &self.shared;
        // An experiment comes to rest, or is picked for: never both at once.
        let _one_at_a_time = shared.picking.lock().await;
        let before = shared.lineage.reader().experiment(experiment).await?.state;
        let choice = pick_at_rest(&shared.lineage, experiment, individual, note).await?;
        let reader = shared.lineage.reader();
        if before == State::Awaiting {
            self.tell(experiment);
            self.take_up(reader.experiment(experiment).await?).await?;
        } else if let Some(place) = reader.picked(experiment, choice.stage).await?
            && let Some(active) = self.active().get(&experiment)
        {
            // One that has just ended will find it in the lineage.
            let _ = active.picks.send((choice.stage, place));
        }
        Ok(())
    }
}

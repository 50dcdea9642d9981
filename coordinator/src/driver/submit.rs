//! Taking an experiment file: all of its cells are written down and begun, or none.

use search::{Experiment, Overrides, Problem};

use super::{ControlError, Driver};
use crate::lineage::{ExperimentId, NewExperiment, Origin, ReadError, WriteError};

/// What is submitted.
#[derive(Debug, Clone)]
pub struct Submission {
    /// The experiment file.
    pub text: String,
    /// Which profile, and which keys are overridden.
    pub overrides: Overrides,
    /// Take up an unfinished experiment of the same resolved text instead of making another one; also one that
    /// this coordinator took up when it started, and that has ended since, and the finished cells of a matrix
    /// of which others are unfinished.
    pub resume: bool,
}

/// Why nothing was begun.
#[derive(Debug, thiserror::Error)]
pub enum SubmitError {
    /// The file is no experiment; every problem found.
    #[error("the experiment file has {} problem(s)", .0.len())]
    Problems(Vec<Problem>),
    /// The lineage could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The lineage could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It stands in the lineage and cannot go on.
    #[error(transparent)]
    Control(#[from] ControlError),
}

impl Driver {
    /// Begins every cell of an experiment file, or goes on with them. Gives their numbers in order of cell,
    /// and whether any of them was taken up rather than begun.
    ///
    /// # Errors
    /// The problems of the file; a lineage that fails; an unfinished experiment begun by other physics.
    #[tracing::instrument(level = "info", skip_all)]
    pub async fn submit(&self, submission: Submission) -> Result<(Vec<ExperimentId>, bool), SubmitError> {
        let cells =
            Experiment::parse(&submission.text, &submission.overrides).map_err(SubmitError::Problems)?;
        let lineage = &self.shared.lineage;
        let ids = if submission.resume { self.find(&cells).await? } else { vec![None; cells.len()] };
        let new: Vec<_> = cells
            .iter()
            .zip(&ids)
            .filter(|(_, id)| id.is_none())
            .map(|(cell, _)| describe(cell, self.shared.fingerprint, None))
            .collect();
        let resumed = new.len() < cells.len();
        let mut created = if new.is_empty() { vec![] } else { lineage.create(new).await? }.into_iter();
        let mut all = Vec::with_capacity(ids.len());
        for id in ids {
            match id {
                Some(id) => {
                    match self.resume(id).await {
                        // One that was taken up at the start and has come to its end since.
                        Ok(()) | Err(ControlError::Ended(..)) => {}
                        Err(error) => return Err(error.into()),
                    }
                    all.push(id);
                }
                None => {
                    let id = created.next().expect("the lineage numbers each experiment created");
                    let stored = lineage.reader().experiment(id).await?;
                    self.take_up(stored).await?;
                    all.push(id);
                }
            }
        }
        Ok((all, resumed))
    }

    /// The experiments that go on with some cells. Of a matrix that does, the finished cells stay finished.
    async fn find(&self, cells: &[Experiment]) -> Result<Vec<Option<ExperimentId>>, ReadError> {
        let reader = self.shared.lineage.reader();
        let mut found = vec![None; cells.len()];
        for (id, cell) in found.iter_mut().zip(cells) {
            let digest = cell.digest();
            let taken_up = self.taken_up().remove(&digest);
            *id = reader.find_unfinished(&digest).await?.or(taken_up);
        }
        if let Some(&sibling) = found.iter().flatten().next() {
            for (id, cell) in found.iter_mut().zip(cells).filter(|(id, _)| id.is_none()) {
                *id = reader.find_finished(sibling, &cell.digest()).await?;
            }
        }
        Ok(found)
    }
}

/// An experiment as the lineage takes it.
pub(super) fn describe(cell: &Experiment, fingerprint: [u8; 32], origin: Option<Origin>) -> NewExperiment {
    let system = creatures::system(&cell.system).expect("a parsed experiment names a known system");
    NewExperiment {
        name: cell.name.clone(),
        group: cell.group.clone(),
        cell: cell.coordinates(),
        system: cell.system.clone(),
        system_version: system.version(),
        search_kind: cell.search_kind().to_owned(),
        seed: cell.seed,
        runs: cell.runs,
        task_json: cell.task_json(),
        resolved: cell.resolved(),
        digest: cell.digest(),
        published: cell.published(),
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint,
        planned: cell.planned(),
        origin,
    }
}

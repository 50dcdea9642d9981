//! Going on with a changed syllabus: what of it a checkpoint can take, and what it cannot (ESP E-86, EF-11). It
//! changes nothing; whoever is told yes restores the checkpoint with the changed settings.

use super::fingerprints::Difference;
use super::settings::{KIND, Settings};
use super::written;
use crate::checkpoint::RestoreError;

/// Why a checkpoint cannot go on with a changed experiment.
#[derive(Debug, thiserror::Error)]
pub enum AmendError {
    /// The experiment's search is no syllabus, so that there is nothing to change.
    #[error("only a search of kind `{KIND}` goes on with a changed file")]
    Kind,
    /// Something differs that the search has come to already. All differences, those that would do among them.
    #[error("{}", list(.0))]
    Refused(Vec<Difference>),
    /// The bytes are no checkpoint of a syllabus.
    #[error(transparent)]
    Checkpoint(#[from] RestoreError),
}

fn list(differences: &[Difference]) -> String {
    let refused = differences.iter().filter(|difference| difference.refused.is_some());
    refused.map(Difference::to_string).collect::<Vec<_>>().join("; ")
}

impl Settings {
    /// What differs between these settings and those with which a checkpoint was written, if the search can go on
    /// from there with these; empty if nothing does.
    ///
    /// # Errors
    /// A difference in what was evolved already; bytes that are no checkpoint.
    pub(super) fn differences(&self, checkpoint: &[u8]) -> Result<Vec<Difference>, AmendError> {
        let written = written::read(checkpoint)?;
        let differences = written.fingerprints.differences(self, &written.progress());
        if differences.iter().any(|difference| difference.refused.is_some()) {
            return Err(AmendError::Refused(differences));
        }
        written.state(self)?;
        Ok(differences)
    }
}

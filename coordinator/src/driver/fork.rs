//! Forking: a new experiment whose first stages are those of another, by reference, and which chooses anew who
//! goes on from the last of them (ESP E-86). It copies no individual and changes nothing of the other.

use search::{Experiment, Problem};
use serde_json::json;

use super::amend::{AmendError, Changed, differences};
use super::submit::describe;
use super::{ControlError, Driver, incompatible};
use crate::lineage::{
    Event, ExperimentId, Lineage, Origin, ReadError, StageId, StoredExperiment, StoredStage, WriteError,
};

/// What is forked.
#[derive(Debug, Clone)]
pub struct Fork {
    /// The other experiment.
    pub from: ExperimentId,
    /// The last stage that both have, by name or number.
    pub after: String,
    /// A changed file; `None` for the other's own.
    pub file: Option<Changed>,
}

/// Why nothing was forked.
#[derive(Debug, thiserror::Error)]
pub enum ForkError {
    /// It has no such stage.
    #[error("experiment {experiment} has no stage `{stage}`; it has {known}")]
    NoStage {
        /// Which experiment.
        experiment: ExperimentId,
        /// As it was asked for.
        stage: String,
        /// Those that it has.
        known: String,
    },
    /// One of its runs has yet to end that stage.
    #[error("run {run} of experiment {experiment} has not ended stage `{stage}`")]
    NotEnded {
        /// Which experiment.
        experiment: ExperimentId,
        /// As it was asked for.
        stage: String,
        /// Which run.
        run: u32,
    },
    /// That stage was the last one.
    #[error(
        "nothing comes after stage `{stage}` of experiment {experiment}: name an earlier stage or, for a syllabus, a FILE \
         with more skills; to evolve it again, run its file with another --seed"
    )]
    Over {
        /// Which experiment.
        experiment: ExperimentId,
        /// As it was asked for.
        stage: String,
    },
    /// The file has problems.
    #[error("the experiment file has {} problem(s)", .0.len())]
    Problems(Vec<Problem>),
    /// The file differs in what was evolved already.
    #[error(transparent)]
    Amend(#[from] AmendError),
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

/// Writes a fork down as running; it goes on when it is taken up.
///
/// # Errors
/// See [`ForkError`]; nothing is then written.
pub async fn fork_at_rest(
    lineage: &Lineage,
    fingerprint: [u8; 32],
    fork: Fork,
) -> Result<ExperimentId, ForkError> {
    let stored = lineage.reader().experiment(fork.from).await?;
    let (holder, stage) = find(lineage, &stored, &fork.after).await?;
    if let Some(reason) = incompatible(&stored, &fingerprint) {
        return Err(ControlError::Incompatible(fork.from, reason).into());
    }
    let experiment = match &fork.file {
        None => Experiment::parse_resolved(&stored.resolved).map_err(|one| ForkError::Problems(vec![one]))?,
        Some(Changed { text, overrides }) => {
            Experiment::parse_one(text, overrides).map_err(ForkError::Problems)?
        }
    };
    let mut ends = Vec::new();
    for run in 1..=experiment.runs {
        let own = |one: &&StoredStage| (one.run, one.stage) == (run, stage);
        match holder.stages.iter().find(own).filter(|stage| stage.ended) {
            Some(stage) => ends.push((stage.id, stage.latest + 1)),
            None => {
                let (experiment, stage) = (fork.from, fork.after);
                return Err(ForkError::NotEnded { experiment, stage, run });
            }
        }
    }
    let noted = match fork.file {
        None => Vec::new(),
        Some(_) => differences(lineage, &stored, &experiment, &ends).await?,
    };
    if is_over(lineage, &experiment, &ends).await? {
        return Err(ForkError::Over { experiment: fork.from, stage: fork.after });
    }
    let origin = Some(Origin { experiment: holder.id, stage });
    let ids = lineage.create(vec![describe(&experiment, fingerprint, origin)]).await?;
    let id = *ids.first().expect("the lineage numbers each experiment created");
    let text = format!("experiment {id} goes on from experiment {} after stage `{}`", fork.from, fork.after);
    let data = json!({ "origin": fork.from.0, "after": fork.after, "differences": noted });
    lineage.event(Event { experiment: Some(id), kind: "fork".to_owned(), text, data }).await?;
    Ok(id)
}

/// Whether no run of an experiment goes on from its checkpoint, named by stage and generation. One that cannot be
/// read is made again when the fork is taken up.
async fn is_over(
    lineage: &Lineage,
    experiment: &Experiment,
    checkpoints: &[(StageId, u32)],
) -> Result<bool, ReadError> {
    for (run, &(stage, generation)) in (1..).zip(checkpoints) {
        let Some(checkpoint) = lineage.reader().checkpoint(stage, generation).await? else {
            return Ok(false);
        };
        let Ok(mut search) = experiment.restore(run, &checkpoint) else { return Ok(false) };
        if !tokio::task::block_in_place(|| search.ask()).is_empty() || search.choice().is_some() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The experiment, this one or one that it comes from, that holds a stage, and the stage's number.
async fn find(
    lineage: &Lineage,
    stored: &StoredExperiment,
    wanted: &str,
) -> Result<(StoredExperiment, u32), ForkError> {
    let (mut holder, mut last) = (stored.clone(), u32::MAX);
    let mut known: Vec<String> = Vec::new();
    loop {
        let stages = holder.stages.iter().filter(|stage| stage.run == 1 && stage.stage <= last);
        for stage in stages {
            if stage.name == wanted || stage.stage.to_string() == wanted {
                let number = stage.stage;
                return Ok((holder, number));
            }
            known.push(format!("`{}`", if stage.name.is_empty() { "0" } else { &stage.name }));
        }
        let Some(origin) = holder.origin else {
            let (experiment, stage) = (stored.id, wanted.to_owned());
            return Err(ForkError::NoStage { experiment, stage, known: known.join(", ") });
        };
        holder = lineage.reader().experiment(origin.experiment).await?;
        last = last.min(origin.stage);
    }
}

impl Driver {
    /// Forks an experiment, and conducts the fork.
    ///
    /// # Errors
    /// See [`ForkError`].
    pub async fn fork(&self, fork: Fork) -> Result<ExperimentId, ForkError> {
        let id = fork_at_rest(&self.shared.lineage, self.shared.fingerprint, fork).await?;
        self.take_up(self.shared.lineage.reader().experiment(id).await?).await?;
        Ok(id)
    }
}

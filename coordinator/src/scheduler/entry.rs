//! One evaluation while it is open: its attempts, and how much it is suspected of. It is forgotten as a whole
//! once it is settled.

use super::audit::Opinion;
use super::hand_out::OUTSTANDING_MAX;
use super::queue::Rank;
use super::strikes::Strike;
use super::{Evaluation, QueueId, WorkerId};
use crate::lineage::{Attempt, Fate, Ruling};
use std::sync::Arc;

/// Attempts beyond these are forgotten, the oldest first, unless they run or count as strikes: an evaluation
/// may lose any number of workers through no fault of its own.
pub const ATTEMPTS_KEPT: usize = 32;
/// A genotype that has ended so many workers is set aside.
pub(super) const STRIKES_MAX: usize = 3;
/// From here on it is a suspect, and gets a worker for itself alone.
pub(super) const STRIKES_OF_A_SUSPECT: usize = STRIKES_MAX - 1;

/// Where an evaluation belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// With the workers that have it.
    UnderWay,
    /// In its queue.
    Ready,
    /// With a worker for itself alone, once there is one.
    Suspect,
    /// With a worker that has no opinion on it, once there is one.
    Awaiting,
    /// Nowhere, until a worker that was lost with it is back or has had its time.
    Condemned,
    /// Nowhere any more.
    Convicted,
}

#[derive(Debug)]
pub(super) struct Entry {
    pub(super) queue: QueueId,
    pub(super) evaluation: Evaluation,
    pub(super) attempts: Vec<Tried>,
    number_next: u32,
    /// What workers found, of an evaluation that is audited.
    pub(super) opinions: Vec<Opinion>,
}

/// One attempt.
#[derive(Debug)]
pub(super) struct Tried {
    pub(super) number: u32,
    pub(super) worker: WorkerId,
    pub(super) name: Arc<str>,
    /// Where it stands among the worker's leases.
    pub(super) seat: u64,
    /// The worker has nothing else: what ends it has ended for this evaluation's sake.
    pub(super) alone: bool,
    /// Counts against the evaluation.
    pub(super) strike: Option<Strike>,
    /// Its lease was lost, and comes back to life if the worker comes back with it.
    pub(super) restorable: bool,
    /// How long it may have run by then, milliseconds.
    pub(super) ran_ms: u64,
    /// `None` while its lease lasts.
    pub(super) fate: Option<Fate>,
    /// On its interim report.
    pub(super) ruling: Option<Ruling>,
    pub(super) steps: u64,
    pub(super) seconds: f64,
}

impl Entry {
    pub(super) fn new(queue: QueueId, evaluation: Evaluation) -> Entry {
        let number_next = evaluation.attempts_before + 1;
        Entry { queue, evaluation, attempts: Vec::new(), number_next, opinions: Vec::new() }
    }

    /// Where it stands in its queue while it waits to be handed out.
    pub(super) fn rank(&self) -> Rank {
        let fresh = self.attempts.is_empty();
        Rank { fresh, order: self.evaluation.order, evaluation: self.evaluation.id }
    }

    /// The number of the next attempt.
    pub(super) fn number(&mut self) -> u32 {
        let number = self.number_next;
        self.number_next += 1;
        number
    }

    /// Writes down an attempt that was handed out.
    pub(super) fn attempt(&mut self, number: u32, worker: WorkerId, name: Arc<str>, seat: u64, alone: bool) {
        if self.attempts.len() >= ATTEMPTS_KEPT
            && let Some(oldest) = self.attempts.iter().position(Tried::can_be_forgotten)
        {
            self.attempts.remove(oldest);
        }
        self.attempts.push(Tried {
            number,
            worker,
            name,
            seat,
            alone,
            strike: None,
            restorable: false,
            ran_ms: 0,
            fate: None,
            ruling: None,
            steps: 0,
            seconds: 0.0,
        });
    }

    /// Where an attempt of a worker stands, if it was made by one of that name.
    pub(super) fn find(&self, number: u32, name: &str) -> Option<usize> {
        self.attempts.iter().position(|tried| tried.number == number && &*tried.name == name)
    }

    /// Where an attempt stands that a worker brings back, if its lease can be restored.
    pub(super) fn wants_back(&self, number: u32, worker: WorkerId, name: &str) -> Option<usize> {
        let is_here = self.outstanding().any(|tried| tried.worker == worker);
        let is_enough = is_here || self.outstanding().count() == OUTSTANDING_MAX || self.has_opined(name);
        self.find(number, name).filter(|&at| self.attempts[at].restorable && !is_enough)
    }

    /// The attempts whose leases last.
    pub(super) fn outstanding(&self) -> impl Iterator<Item = &Tried> {
        self.attempts.iter().filter(|tried| tried.fate.is_none())
    }

    pub(super) fn strikes(&self) -> usize {
        self.attempts.iter().filter(|tried| tried.strike.is_some()).count()
    }

    /// What comes next, if none of its attempts has settled it.
    pub(super) fn standing(&self) -> Standing {
        let is_presumption = |tried: &Tried| matches!(tried.strike, Some(Strike::Presumed(_)));
        let is_guilty = self.strikes() >= STRIKES_MAX;
        match self.opinions.len() {
            _ if self.outstanding().next().is_some() => Standing::UnderWay,
            // Those have lived through it, and differ.
            2.. => Standing::Awaiting,
            _ if is_guilty && self.attempts.iter().any(is_presumption) => Standing::Condemned,
            _ if is_guilty => Standing::Convicted,
            1 => Standing::Awaiting,
            _ if self.is_suspect() => Standing::Suspect,
            _ => Standing::Ready,
        }
    }

    /// Whether it gets a worker for itself alone. One that a worker has lived through kills nobody.
    pub(super) fn is_suspect(&self) -> bool {
        self.opinions.is_empty() && self.strikes() >= STRIKES_OF_A_SUSPECT
    }

    /// Whether a worker of that name has said what it found.
    pub(super) fn has_opined(&self, name: &str) -> bool {
        self.opinions.iter().any(|opinion| &*opinion.worker == name)
    }

    /// Whether a worker of that name has a strike from it.
    pub(super) fn has_struck(&self, name: &str) -> bool {
        self.attempts.iter().any(|tried| tried.strike.is_some() && &*tried.name == name)
    }

    /// Why it is set aside, from its strikes.
    pub(super) fn account(&self) -> String {
        let strikes = self.attempts.iter().filter(|tried| tried.strike.is_some()).map(|tried| {
            let (Some(Fate::Lost(reason)) | Some(Fate::Failed(reason))) = &tried.fate else {
                return tried.name.to_string();
            };
            format!("{}: {reason}", tried.name)
        });
        format!("three attempts ended badly ({})", strikes.collect::<Vec<_>>().join("; "))
    }
}

impl Tried {
    /// Opinions that wait for others are kept.
    fn can_be_forgotten(&self) -> bool {
        self.strike.is_none() && self.fate.as_ref().is_some_and(|fate| *fate != Fate::Confirmed)
    }

    /// As it goes into the lineage. `fate` is that of an attempt whose lease lasts.
    pub(super) fn record(self, fate: &Fate) -> Attempt {
        Attempt {
            number: self.number,
            worker: self.name.to_string(),
            fate: self.fate.unwrap_or_else(|| fate.clone()),
            steps: self.steps,
            seconds: self.seconds,
        }
    }
}

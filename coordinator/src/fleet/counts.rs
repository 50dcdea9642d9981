//! What the fleet has done since it started, as counters that a scrape reads. Nothing is decided by them.

use super::{Conflict, Fate, Settled};
use crate::lineage::Audited;
use creatures::Status;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::registry::Registry;
use proto::refusal::Refusal;

/// One label, with a value from a closed list.
type Label = [(&'static str, &'static str); 1];

/// Counters of one fleet. Clones share them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Counts {
    evaluations: Family<Label, Counter>,
    attempts: Family<Label, Counter>,
    audits: Family<Label, Counter>,
    quarantined: Counter,
    handed_out: Counter,
    steps: Counter,
    steps_spared: Counter,
    conflicts: Counter,
    left: Family<Label, Counter>,
    leases_lost: Family<Label, Counter>,
    refused: Family<Label, Counter>,
}

impl Counts {
    pub(super) fn handed_out(&self, evaluations: usize) {
        self.handed_out.inc_by(evaluations as u64);
    }

    /// An evaluation is over, with every attempt at it.
    pub(super) fn settled(&self, settled: &Settled) {
        let outcome = match &settled.result {
            Err(_) => "failed",
            Ok(outcome) => match outcome.status {
                Status::Completed => "completed",
                Status::Culled => "culled",
                Status::Aborted(reason) => reason.word(),
            },
        };
        self.evaluations.get_or_create(&[("outcome", outcome)]).inc();
        self.steps_spared.inc_by(settled.steps_spared);
        if let Some(audit) = settled.audit {
            self.audits.get_or_create(&[("result", Audited::word(audit))]).inc();
        }
        for attempt in &settled.attempts {
            let fate = match &attempt.fate {
                Fate::Counted => "counted",
                Fate::Duplicate => "duplicate",
                Fate::Confirmed => "confirmed",
                Fate::Refuted => "refuted",
                Fate::Lost(_) => "lost",
                Fate::Failed(_) => "failed",
            };
            self.attempts.get_or_create(&[("fate", fate)]).inc();
            self.steps.inc_by(attempt.steps);
        }
    }

    /// A worker is trusted no more.
    pub(super) fn quarantined(&self) {
        self.quarantined.inc();
    }

    pub(super) fn contradicted(&self, conflicts: &[Conflict]) {
        self.conflicts.inc_by(conflicts.len() as u64);
    }

    /// A worker went, and so many leases with it.
    pub(super) fn left(&self, reason: &'static str, leases: u64) {
        self.left.get_or_create(&[("reason", reason)]).inc();
        self.leases_lost.get_or_create(&[("reason", reason)]).inc_by(leases);
    }

    pub(super) fn refused(&self, refusal: &Refusal) {
        self.refused.get_or_create(&[("reason", refusal.word())]).inc();
    }

    /// Names them for a scrape.
    pub(crate) fn register(&self, registry: &mut Registry) {
        registry.register("evaluations", "Evaluations settled, by outcome", self.evaluations.clone());
        registry.register(
            "attempts",
            "Attempts at evaluations that were settled, by fate",
            self.attempts.clone(),
        );
        registry.register("audits", "Audits of evaluations that were chosen for one", self.audits.clone());
        registry.register(
            "workers_quarantined",
            "Workers that found other bits than two others",
            self.quarantined.clone(),
        );
        registry.register(
            "evaluations_handed_out",
            "Evaluations sent to workers, every attempt counted",
            self.handed_out.clone(),
        );
        registry.register("steps", "Physics steps that workers reported", self.steps.clone());
        registry.register(
            "steps_spared",
            "Physics steps that culled creatures would have lived on",
            self.steps_spared.clone(),
        );
        registry.register(
            "conflicts",
            "Outcomes whose bits contradicted an earlier outcome of the same evaluation",
            self.conflicts.clone(),
        );
        registry.register("workers_left", "Workers that went, by reason", self.left.clone());
        registry.register(
            "leases_expired",
            "Leases that ended with their worker, by the reason why it went",
            self.leases_lost.clone(),
        );
        registry.register("workers_refused", "Workers turned away, by reason", self.refused.clone());
    }
}

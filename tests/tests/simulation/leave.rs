//! What workers leave behind: whoever takes leave has reported all that it ran, and gives back the rest.

use coordinator::fleet::{Change, Fate, Fleet, Settled};
use std::collections::BTreeSet;
use tokio::sync::broadcast::Receiver;

/// How a worker that has drained goes, in the lineage.
const IN_ORDER: &str = "left";

/// Holds every attempt against how its worker went.
pub(crate) struct Leave {
    changes: Receiver<Change>,
    /// Workers that once went otherwise than in order.
    torn: BTreeSet<String>,
}

impl Leave {
    /// From before the first worker.
    pub(crate) fn watch(fleet: &Fleet) -> Leave {
        Leave { changes: fleet.changes(), torn: BTreeSet::new() }
    }

    /// Checks the attempts at a settled evaluation.
    ///
    /// # Errors
    /// One was lost with a worker that took leave, or was not given back by one that was never torn away.
    pub(crate) fn check(&mut self, settled: &Settled) -> Result<(), String> {
        while let Ok(change) = self.changes.try_recv() {
            if let Change::Left { name, reason } = change
                && reason != IN_ORDER
            {
                self.torn.insert(name);
            }
        }
        for attempt in &settled.attempts {
            let Fate::Lost(reason) = &attempt.fate else { continue };
            if reason == IN_ORDER || (reason != "returned" && !self.torn.contains(&attempt.worker)) {
                let (id, worker, number) = (settled.id, &attempt.worker, attempt.number);
                return Err(format!("attempt {number} at evaluation {id} is lost ({reason}) with {worker}"));
            }
        }
        Ok(())
    }
}

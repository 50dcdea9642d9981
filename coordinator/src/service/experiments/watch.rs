//! Watching: what happens to experiments, as it happens, to whoever reads it. Nobody waits for a watcher.

use super::ExperimentsService;
use super::render::render_generation;
use crate::driver::Happening;
use crate::lineage::ExperimentId;
use proto::v1;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::mpsc;
use tonic::Status;

/// How often watchers are told the progress.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);

impl ExperimentsService {
    /// Sends a watcher what happens until every experiment has ended or waits for a pick, or nobody reads any
    /// more.
    pub(super) async fn watch_until_ended(
        self,
        ids: BTreeSet<ExperimentId>,
        events: mpsc::Sender<Result<v1::WatchEvent, Status>>,
    ) -> Result<(), Gone> {
        let mut happenings = self.driver.happenings();
        let mut ended = BTreeSet::new();
        let mut reasons = BTreeMap::new();
        for &id in &ids {
            self.send_state(id, &events, &mut ended).await?;
        }
        let mut ticks = tokio::time::interval(PROGRESS_EVERY);
        ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        while ended.len() < ids.len() {
            tokio::select! {
                happening = happenings.recv() => match happening {
                    Ok(Happening::State(id)) if ids.contains(&id) => {
                        self.send_state(id, &events, &mut ended).await?;
                    }
                    Ok(Happening::Generation(id, generation)) if ids.contains(&id) => {
                        send(&events, id, v1::watch_event::What::Generation(render_generation(*generation))).await?;
                    }
                    Ok(_) => {}
                    // A slow watcher misses generations; the lineage has them.
                    Err(RecvError::Lagged(missed)) => tracing::debug!(missed, "a watcher fell behind"),
                    Err(RecvError::Closed) => return Err(Gone),
                },
                _ = ticks.tick() => {
                    let held_up = self.driver.held_up();
                    for &id in ids.difference(&ended.clone()) {
                        if reasons.insert(id, held_up.clone()).unwrap_or_default() != held_up {
                            self.send_state(id, &events, &mut ended).await?;
                        }
                        if let Some(progress) = self.progress(id) {
                            send(&events, id, v1::watch_event::What::Progress(progress)).await?;
                        }
                    }
                }
                _ = events.closed() => return Err(Gone),
            }
        }
        Ok(())
    }

    fn progress(&self, id: ExperimentId) -> Option<v1::Progress> {
        let counts = self.driver.progress(id)?.counts();
        let fleet = *self.driver.fleet().summary().borrow();
        Some(v1::Progress {
            evaluated: counts.evaluated,
            planned: counts.planned.unwrap_or(0),
            rate: counts.rate(),
            workers: fleet.workers,
            slots: fleet.slots,
        })
    }

    async fn send_state(
        &self,
        id: ExperimentId,
        events: &mpsc::Sender<Result<v1::WatchEvent, Status>>,
        ended: &mut BTreeSet<ExperimentId>,
    ) -> Result<(), Gone> {
        match self.render(id).await {
            Ok(experiment) => {
                let over =
                    ["finished", "cancelled", "failed", "awaiting"].contains(&experiment.state.as_str());
                send(events, id, v1::watch_event::What::State(experiment)).await?;
                // One that waited may go on while others are still watched.
                if over {
                    ended.insert(id);
                } else {
                    ended.remove(&id);
                }
                Ok(())
            }
            Err(status) => {
                let _ = events.send(Err(status)).await;
                Err(Gone)
            }
        }
    }
}

/// Nobody reads the stream any more, or nothing will come.
#[derive(Debug)]
pub(super) struct Gone;

async fn send(
    events: &mpsc::Sender<Result<v1::WatchEvent, Status>>,
    id: ExperimentId,
    what: v1::watch_event::What,
) -> Result<(), Gone> {
    events.send(Ok(v1::WatchEvent { experiment: id.0, what: Some(what) })).await.map_err(|_| Gone)
}

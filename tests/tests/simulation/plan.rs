//! What a seed draws: how many machines, how far apart, and a list of faults. It makes nothing happen.

use creatures::random::{Stream, stream};
use std::time::Duration;

/// Ends of workers that tell nobody, at most, between two starts of the coordinator: a genotype with which the third one
/// ends is set aside, which is right and gives another lineage.
const ENDS_MAX: usize = 2;
/// Faults begin before this, milliseconds.
const TROUBLE_MS: usize = 8_000;

/// One life of a fleet.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub(crate) seed: u64,
    /// Slots of each worker.
    pub(crate) workers: Vec<usize>,
    /// Messages of a link take up to so long.
    pub(crate) latency_max: Duration,
    /// By when they happen.
    pub(crate) faults: Vec<(Duration, Fault)>,
}

/// What can go wrong. Workers are named by their index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fault {
    /// A worker's process ends at once, and is started again later.
    Kill { worker: usize, away: Duration },
    /// So does the coordinator's; what it had not committed is gone.
    KillCoordinator { away: Duration },
    /// Nothing gets through between a worker and the coordinator; what is sent meanwhile is lost, and with it
    /// the connections that it belonged to.
    Cut { worker: usize, away: Duration },
    /// Everything between the two is delayed, and then arrives at once.
    Stall { worker: usize, away: Duration },
    /// A worker is told to stop, as by SIGTERM, and starts again.
    Drain { worker: usize },
}

impl Plan {
    pub(crate) fn draw(seed: u64) -> Plan {
        let mut draws = stream(seed, [0; 3], "simulation");
        let workers: Vec<usize> = (0..draws.within(2, 4)).map(|_| draws.within(1, 2)).collect();
        let latency_max = millis(&mut draws, 2, 120);
        let count = draws.within(1, 8);
        let mut times: Vec<Duration> = (0..count).map(|_| millis(&mut draws, 200, TROUBLE_MS)).collect();
        times.sort_unstable();
        let drawn: Vec<Fault> = times.iter().map(|_| Fault::draw(&mut draws, workers.len())).collect();
        let is_lossy = drawn.iter().any(|fault| matches!(fault, Fault::Cut { .. } | Fault::Stall { .. }));
        let mut ends = 0;
        let mut faults = Vec::new();
        for (time, fault) in times.into_iter().zip(drawn) {
            match fault {
                Fault::KillCoordinator { .. } => ends = 0,
                // Word that a worker drains may be lost.
                Fault::Drain { .. } if !is_lossy => {}
                Fault::Kill { .. } | Fault::Drain { .. } if ends == ENDS_MAX => continue,
                Fault::Kill { .. } | Fault::Drain { .. } => ends += 1,
                Fault::Cut { .. } | Fault::Stall { .. } => {}
            }
            faults.push((time, fault));
        }
        Plan { seed, workers, latency_max, faults }
    }
}

impl Plan {
    /// How long messages between a worker and the coordinator take during one stretch of time.
    ///
    /// Drawn here and not by the network message for message: the streams of a host that dies are closed in an
    /// order that depends on what else runs in this process, and each draw would then be another one's.
    pub(crate) fn latency(&self, stretch: u32, worker: usize) -> Duration {
        let mut draws = stream(self.seed, [0, stretch, worker as u32], "latency");
        Duration::from_millis(draws.within(1, self.latency_max.as_millis() as usize) as u64)
    }
}

impl Fault {
    fn draw(draws: &mut Stream, workers: usize) -> Fault {
        let worker = draws.below(workers);
        match draws.below(6) {
            0 | 1 => Fault::Kill { worker, away: millis(draws, 10, 3_000) },
            2 => Fault::KillCoordinator { away: millis(draws, 10, 3_000) },
            3 => Fault::Cut { worker, away: millis(draws, 50, 4_000) },
            4 => Fault::Stall { worker, away: millis(draws, 50, 4_000) },
            _ => Fault::Drain { worker },
        }
    }
}

fn millis(draws: &mut Stream, low: usize, high: usize) -> Duration {
    Duration::from_millis(draws.within(low, high) as u64)
}

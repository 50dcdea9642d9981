//! A load for the whole service: probes of a given size and time, from submission to the last committed row.

use std::time::Instant;

use hatchery_tests::Hatchery;

use crate::processes::processor_seconds;

/// The size of a genotype.
pub const PAYLOAD_BYTES: u32 = 2048;

/// So many probes.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Of each, hash compressions.
    pub work: u32,
    /// Of a generation.
    pub population: u32,
    /// One after another.
    pub generations: u32,
}

/// What one run took, seconds.
#[derive(Debug, Clone, Copy)]
pub struct Taken {
    /// By the clock.
    pub seconds: f64,
    /// Of the processor, by the coordinator.
    pub coordinator: f64,
    /// Of the processor, by all workers together.
    pub workers: f64,
}

impl Load {
    /// Probes in all.
    pub fn count(&self) -> u32 {
        self.population * self.generations
    }

    /// The experiment file.
    pub fn text(&self) -> String {
        let Load { work, population, generations } = self;
        format!(
            "name = 'load'\nsystem = 'probe'\nseed = 1\n[task]\nwork = {work}\n[search]\nkind = 'probe'\n\
             population = {population}\ngenerations = {generations}\npayload = {PAYLOAD_BYTES}\n"
        )
    }

    /// Runs once, on workers `w1`, `w2`, … so many.
    ///
    /// # Panics
    /// When an outcome is no committed row.
    pub fn run(&self, hatchery: &mut Hatchery, workers: usize) -> Taken {
        hatchery.wait_attached(workers);
        let names: Vec<String> = (1..=workers).map(|number| format!("w{number}")).collect();
        let used = |hatchery: &mut Hatchery| {
            let workers = names.iter().map(|name| processor_seconds(hatchery.worker(name).id())).sum::<f64>();
            (processor_seconds(hatchery.coordinator().id()), workers)
        };
        let before = used(hatchery);
        let start = Instant::now();
        let id = hatchery.submit(&self.text());
        hatchery.client().wait(id);
        let seconds = start.elapsed().as_secs_f64();
        let after = used(hatchery);
        let committed =
            hatchery.client().count("SELECT count(*) FROM v_individuals WHERE status = 'completed'");
        assert_eq!(committed, i64::from(self.count()), "every outcome is a committed row");
        Taken { seconds, coordinator: after.0 - before.0, workers: after.1 - before.1 }
    }
}

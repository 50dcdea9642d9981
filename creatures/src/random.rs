//! Keyed random streams: a draw is named by where it is used, never by when. No stream is shared, none
//! outlives its purpose, none is saved.

use crate::math::{cos, log};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One keyed stream of draws.
#[derive(Debug, Clone)]
pub struct Stream(ChaCha8Rng);

/// The stream of a seed, a place and a purpose: ChaCha8 seeded by BLAKE3 of the three.
///
/// `place` is `[stage, generation, index]`, or whatever numbers name the place of use.
pub fn stream(seed: u64, place: [u32; 3], purpose: &str) -> Stream {
    let mut hasher = blake3::Hasher::new_derive_key("hatchery 2026-11 keyed random stream");
    hasher.update(&seed.to_le_bytes());
    for number in place {
        hasher.update(&number.to_le_bytes());
    }
    hasher.update(purpose.as_bytes());
    Stream(ChaCha8Rng::from_seed(*hasher.finalize().as_bytes()))
}

impl Stream {
    /// Uniform in [0, 1), of 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in 0..count; `count` must be positive.
    pub fn below(&mut self, count: usize) -> usize {
        let count = u32::try_from(count).expect("populations and genotypes are far below 2^32");
        self.0.random_range(0..count) as usize
    }

    /// Uniform in low..=high.
    pub fn within(&mut self, low: usize, high: usize) -> usize {
        low + self.below(high - low + 1)
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Normal with mean 0 and standard deviation 1, by Box and Muller's transform; two draws each.
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (1.0 - self.unit(), self.unit());
        (-2.0 * log(radius)).sqrt() * cos(std::f64::consts::TAU * angle)
    }

    /// Fills a buffer with uniform bytes.
    pub fn fill(&mut self, bytes: &mut [u8]) {
        self.0.fill_bytes(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_is_named_by_seed_place_and_purpose() {
        let first = |seed, place, purpose| stream(seed, place, purpose).unit().to_bits();
        let here = first(1, [0, 1, 2], "mutate");
        assert_eq!(here, first(1, [0, 1, 2], "mutate"));
        for other in
            [first(2, [0, 1, 2], "mutate"), first(1, [0, 2, 1], "mutate"), first(1, [0, 1, 2], "mate")]
        {
            assert_ne!(here, other);
        }
    }

    #[test]
    fn normal_draws_have_their_mean_and_deviation() {
        let mut draws = stream(3, [0, 0, 0], "normal");
        let values: Vec<f64> = (0..20_000).map(|_| draws.normal()).collect();
        let mean = values.iter().sum::<f64>() / 20_000.0;
        let square = values.iter().map(|value| value * value).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.03 && (square - 1.0).abs() < 0.05, "{mean}, {square}");
    }

    #[test]
    fn draws_are_the_same_on_every_machine() {
        let mut draws = stream(7, [1, 2, 3], "golden");
        let seen = (draws.unit(), draws.below(1000), draws.within(4, 20), draws.chance(0.5));
        assert_eq!(seen, (0.6504851121133278, 446, 13, true), "a change here changes every lineage");
    }
}

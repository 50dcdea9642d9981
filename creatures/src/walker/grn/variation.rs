//! How gene regulatory networks vary: founders, crossover, mutation (G-23, G-26, G-27). It selects nobody
//! and keeps every genotype legal.

use super::genotype::{Genotype, Protein, REGULATORY, SCALING, TAG_MAX, wired};
use crate::SpecError;
use crate::random::Stream;
use crate::walker::body::BodyKind;
use serde::{Deserialize, Serialize};

/// Shares of the mutations and ranges of the draws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Share of mutations that redraw one tag. Shares are relative to their sum.
    pub tag: f64,
    /// Share that append a regulatory protein.
    pub add: f64,
    /// Share that remove one.
    pub remove: f64,
    /// Share that redraw β or δ.
    pub scaling: f64,
    /// Largest tag drawn, 1..=32.
    pub p: u8,
    /// Fewest regulatory proteins, at least 4.
    pub reg_min: usize,
    /// Most regulatory proteins, at most 20.
    pub reg_max: usize,
    /// Range of β, within [0.5, 2].
    pub beta: [f64; 2],
    /// Range of δ, within [0.5, 2].
    pub delta: [f64; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            tag: 0.60,
            add: 0.15,
            remove: 0.15,
            scaling: 0.10,
            p: TAG_MAX,
            reg_min: *REGULATORY.start(),
            reg_max: *REGULATORY.end(),
            beta: [*SCALING.start(), *SCALING.end()],
            delta: [*SCALING.start(), *SCALING.end()],
        }
    }
}

impl Settings {
    /// Checks that every draw gives a legal genotype.
    ///
    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        let shares =
            [("tag", self.tag), ("add", self.add), ("remove", self.remove), ("scaling", self.scaling)];
        for (key, share) in shares {
            if !(0.0..=1.0).contains(&share) {
                return Err(SpecError::new(key, format!("{share} is not within [0, 1]")));
            }
        }
        if self.shares() <= 0.0 {
            return Err(SpecError::new("tag", "one of tag, add, remove and scaling must be positive"));
        }
        if !(1..=TAG_MAX).contains(&self.p) {
            return Err(SpecError::new("p", format!("{} is not within 1..=32", self.p)));
        }
        for (key, count) in [("reg_min", self.reg_min), ("reg_max", self.reg_max)] {
            if !REGULATORY.contains(&count) {
                return Err(SpecError::new(key, format!("{count} is not within 4..=20")));
            }
        }
        if self.reg_min > self.reg_max {
            return Err(SpecError::new("reg_min", format!("{} is above reg_max", self.reg_min)));
        }
        for (key, [low, high]) in [("beta", self.beta), ("delta", self.delta)] {
            if !(SCALING.contains(&low) && SCALING.contains(&high) && low <= high) {
                let problem = format!("[{low}, {high}] is no ascending range within [0.5, 2]");
                return Err(SpecError::new(key, problem));
            }
        }
        Ok(())
    }

    fn shares(&self) -> f64 {
        self.tag + self.add + self.remove + self.scaling
    }

    fn protein(&self, stream: &mut Stream) -> Protein {
        Protein { id: self.tag(stream), enh: self.tag(stream), inh: self.tag(stream) }
    }

    fn tag(&self, stream: &mut Stream) -> u8 {
        stream.within(0, usize::from(self.p)) as u8
    }
}

impl Genotype {
    /// A founder (G-23).
    pub fn random(body: BodyKind, settings: &Settings, stream: &mut Stream) -> Genotype {
        let regulatory = stream.within(settings.reg_min, settings.reg_max);
        let proteins = (0..wired(body) + regulatory).map(|_| settings.protein(stream)).collect();
        let [low, high] = settings.beta;
        let beta = stream.between(low, high);
        let [low, high] = settings.delta;
        Genotype { body, beta, delta: stream.between(low, high), proteins }
    }

    /// One-point crossover between proteins: `first` gives the head, `second` the tail and hence the
    /// length; each scaling factor comes from either by a fair coin (G-26). Both are of one body.
    pub fn crossover(first: &Genotype, second: &Genotype, stream: &mut Stream) -> Genotype {
        debug_assert_eq!(first.body, second.body);
        let shorter = first.proteins.len().min(second.proteins.len());
        let cut = stream.within(1, shorter - 1);
        let beta = if stream.chance(0.5) { first.beta } else { second.beta };
        let delta = if stream.chance(0.5) { first.delta } else { second.delta };
        Genotype { body: first.body, beta, delta, proteins: splice(&first.proteins, &second.proteins, cut) }
    }

    /// Applies exactly one mutation and names it: `tag`, `add`, `remove` or `scaling` (G-27).
    pub fn mutate(&mut self, settings: &Settings, stream: &mut Stream) -> &'static str {
        let draw = stream.unit() * settings.shares();
        let (add, remove) = (settings.tag + settings.add, settings.tag + settings.add + settings.remove);
        if draw < settings.tag {
            self.redraw_tag(settings, stream)
        } else if draw < add {
            if self.regulatory() >= settings.reg_max {
                return self.redraw_tag(settings, stream);
            }
            self.proteins.push(settings.protein(stream));
            "add"
        } else if draw < remove {
            if self.regulatory() <= settings.reg_min {
                return self.redraw_tag(settings, stream);
            }
            let index = wired(self.body) + stream.below(self.regulatory());
            self.proteins.remove(index);
            "remove"
        } else {
            let beta = stream.chance(0.5);
            let (factor, [low, high]) = match beta {
                true => (&mut self.beta, settings.beta),
                false => (&mut self.delta, settings.delta),
            };
            *factor = stream.between(low, high);
            "scaling"
        }
    }

    /// One tag of one protein anew; it may come out equal.
    fn redraw_tag(&mut self, settings: &Settings, stream: &mut Stream) -> &'static str {
        let index = stream.below(self.proteins.len());
        let protein = &mut self.proteins[index];
        let tag = match stream.below(3) {
            0 => &mut protein.id,
            1 => &mut protein.enh,
            _ => &mut protein.inh,
        };
        *tag = settings.tag(stream);
        "tag"
    }
}

/// The first `cut` proteins of one, then those of the other from `cut` on.
fn splice(head: &[Protein], tail: &[Protein], cut: usize) -> Vec<Protein> {
    head[..cut].iter().chain(&tail[cut..]).copied().collect()
}

#[cfg(test)]
mod tests;

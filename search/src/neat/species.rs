//! Species: who belongs together, what each is worth, and how many offspring it is granted (G-33..G-36).
//! It breeds nobody.

use super::Settings;
use crate::{Place, selection};
use creatures::walker::neat::Genotype;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What is kept of a species from one generation to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Species {
    pub(super) id: u32,
    /// Best raw fitness it ever had.
    pub(super) best: f64,
    /// Generations since that last rose.
    pub(super) stagnant: u32,
    /// Offspring granted in the next generation; a species without any ends.
    pub(super) quota: u32,
}

/// A generation sorted into species.
#[derive(Debug)]
pub(super) struct Sorting {
    /// The species of each individual, in order of index.
    pub(super) species: Vec<u32>,
    /// Who stood for each species when members were sought, members or not.
    pub(super) representatives: BTreeMap<u32, Place>,
    /// The id of the next species founded.
    pub(super) next_species: u32,
}

/// Sorts a generation: individuals in order of index join the first species, in order of creation, with
/// whose representative they are compatible, or found one and stand for it (G-34).
pub(super) fn sort<'a>(
    genotypes: impl Iterator<Item = &'a Genotype>,
    first: Place,
    mut representatives: BTreeMap<u32, (Place, &'a Genotype)>,
    mut next_species: u32,
    settings: &Settings,
) -> Sorting {
    let threshold = settings.speciation.threshold;
    let mut species = Vec::new();
    for (index, genotype) in (0..).zip(genotypes) {
        let compatible = representatives
            .iter()
            .find(|(_, (_, stands))| genotype.distance(stands, &settings.variation) < threshold)
            .map(|(&id, _)| id);
        let id = compatible.unwrap_or_else(|| {
            let id = next_species;
            next_species += 1;
            representatives.insert(id, (Place { index, ..first }, genotype));
            id
        });
        species.push(id);
    }
    let representatives = representatives.into_iter().map(|(id, (place, _))| (id, place)).collect();
    Sorting { species, representatives, next_species }
}

/// How a species stands at the end of a generation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standing {
    pub(super) species: Species,
    /// Members.
    pub(super) size: u32,
    /// Best raw fitness of this generation.
    pub(super) best: f64,
    /// The sum of its members' adjusted fitness f/size: the mean raw fitness (G-35).
    pub(super) share: f64,
}

/// Judges the species of a generation, ascending by id: fitness sharing, stagnation, quotas.
///
/// `scores` gives species and raw fitness of each individual in order of index; `previous` what was kept of
/// the generation before. The quotas add up to the population.
pub(super) fn assess(scores: &[(u32, f64)], previous: &[Species], settings: &Settings) -> Vec<Standing> {
    let mut members: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for &(id, fitness) in scores {
        members.entry(id).or_default().push(fitness);
    }
    let raw: Vec<f64> = scores.iter().map(|&(_, fitness)| fitness).collect();
    let holder = selection::best(&raw).map(|index| scores[index].0);
    let mut standings: Vec<Standing> = members
        .into_iter()
        .map(|(id, fitness)| {
            let best = fitness.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let before = previous.iter().find(|species| species.id == id);
            let (record, stagnant) = match before {
                Some(before) if best <= before.best => (before.best, before.stagnant + 1),
                _ => (best, 0),
            };
            Standing {
                species: Species { id, best: record, stagnant, quota: 0 },
                size: fitness.len() as u32,
                best,
                share: fitness.iter().sum::<f64>() / fitness.len() as f64,
            }
        })
        .collect();
    let quotas = quotas(&standings, holder, settings);
    for (standing, quota) in standings.iter_mut().zip(quotas) {
        standing.species.quota = quota;
    }
    standings
}

/// Offspring of each species, by its share. The species of the best individual gets one at least (G-35) and
/// never counts as stagnant (G-36).
fn quotas(standings: &[Standing], holder: Option<u32>, settings: &Settings) -> Vec<u32> {
    let ends = |standing: &Standing| {
        standing.species.stagnant >= settings.speciation.stagnation && Some(standing.species.id) != holder
    };
    let shares = |share: &dyn Fn(&Standing) -> f64| -> Vec<f64> {
        standings.iter().map(|standing| if ends(standing) { 0.0 } else { share(standing) }).collect()
    };
    let mut by_share = shares(&|standing| standing.share);
    if by_share.iter().sum::<f64>() <= 0.0 {
        by_share = shares(&|standing| f64::from(standing.size));
    }
    let mut quotas = selection::largest_remainder(&by_share, settings.population);
    let holder = standings.iter().position(|standing| Some(standing.species.id) == holder);
    if let Some(holder) = holder.filter(|&holder| quotas[holder] == 0) {
        // The lowest id of the largest quota gives one up.
        let largest = (0..quotas.len()).max_by(|&a, &b| quotas[a].cmp(&quotas[b]).then(b.cmp(&a)));
        if let Some(largest) = largest {
            quotas[largest] -= 1;
            quotas[holder] += 1;
        }
    }
    quotas
}

#[cfg(test)]
mod tests {
    use super::*;
    use creatures::random::stream;
    use creatures::walker::BodyKind;
    use serde_json::json;

    fn settings(body: &str) -> Settings {
        Settings::read(json!({}), &json!({ "body": body })).unwrap()
    }

    fn quotas_of(standings: &[Standing]) -> Vec<u32> {
        standings.iter().map(|standing| standing.species.quota).collect()
    }

    /// T-14: how many species 80 random genotypes form, as a mean over 30 seeds, within ±2.
    #[test]
    fn random_generations_form_as_many_species_as_they_should() {
        let expected = [
            (BodyKind::Crawler, 8.1),
            (BodyKind::Arm, 10.7),
            (BodyKind::Hopper, 9.6),
            (BodyKind::Runner, 10.7),
        ];
        let first = Place { stage: 0, generation: 1, index: 0 };
        for (body, mean) in expected {
            let settings = settings(body.name());
            let species = |seed| {
                let genotypes: Vec<Genotype> = (0..80)
                    .map(|index| {
                        Genotype::random(
                            body,
                            &settings.variation,
                            &mut stream(seed, [0, 1, index], "founder"),
                        )
                    })
                    .collect();
                let sorting = sort(genotypes.iter(), first, BTreeMap::new(), 1, &settings);
                sorting.next_species - 1
            };
            let sum: u32 = (1..=30).map(species).sum();
            let found = f64::from(sum) / 30.0;
            assert!((found - mean).abs() < 2.0, "{body:?}: {found} species where {mean} are expected");
        }
    }

    /// T-15: raw fitness {40,30,20,10}, {60,0}, {5,5,5}.
    #[test]
    fn offspring_follow_shared_fitness_by_the_largest_remainder() {
        let scores =
            [(1, 40.0), (1, 30.0), (1, 20.0), (1, 10.0), (2, 60.0), (2, 0.0), (3, 5.0), (3, 5.0), (3, 5.0)];
        let standings = assess(&scores, &[], &settings("crawler"));
        let shares: Vec<f64> = standings.iter().map(|standing| standing.share).collect();
        assert_eq!(shares, [25.0, 30.0, 5.0]);
        assert_eq!(quotas_of(&standings), [33, 40, 7]);
    }

    /// T-15, second part, and X-15.
    #[test]
    fn when_every_fitness_is_zero_sizes_count() {
        let zeros: Vec<(u32, f64)> =
            [(1, 50), (2, 20), (3, 10)].into_iter().flat_map(|(id, size)| vec![(id, 0.0); size]).collect();
        assert_eq!(quotas_of(&assess(&zeros, &[], &settings("crawler"))), [50, 20, 10]);
    }

    fn kept(id: u32, best: f64, stagnant: u32) -> Species {
        Species { id, best, stagnant, quota: 1 }
    }

    #[test]
    fn a_species_ends_after_fifteen_generations_without_a_rise() {
        let scores = [(1, 10.0), (2, 10.0), (3, 20.0)];
        // The first has just stood still for the 15th time, the second for the 14th.
        let previous = [kept(1, 10.0, 14), kept(2, 10.0, 13), kept(3, 15.0, 14)];
        let standings = assess(&scores, &previous, &settings("crawler"));
        let stagnant: Vec<u32> = standings.iter().map(|standing| standing.species.stagnant).collect();
        assert_eq!(stagnant, [15, 14, 0], "a strict rise begins anew");
        assert_eq!(quotas_of(&standings), [0, 27, 53]);
        assert_eq!(standings[2].species.best, 20.0);
    }

    ///
    #[test]
    fn when_all_species_are_stagnant_that_of_the_best_reproduces_alone() {
        let previous = [kept(1, 50.0, 20), kept(2, 50.0, 20)];
        let standings = assess(&[(1, 10.0), (2, 20.0)], &previous, &settings("crawler"));
        assert_eq!(quotas_of(&standings), [0, 80]);
        let zeros = assess(&[(1, 0.0), (2, 0.0)], &previous, &settings("crawler"));
        assert_eq!(quotas_of(&zeros), [80, 0], "the best of equals is the lowest slot");
    }

    /// X-17 and the last sentence of G-35.
    #[test]
    fn quotas_add_up_and_the_best_individual_is_never_without_offspring() {
        // The best of all sits in a species whose mean is negligible beside the others'.
        let mut scores = vec![(1, 100.0)];
        scores.extend([(1, 0.0); 99]);
        scores.extend((2..=120).map(|id| (id, 90.0)));
        let standings = assess(&scores, &[], &settings("crawler"));
        let quotas = quotas_of(&standings);
        assert_eq!(quotas.iter().sum::<u32>(), 80);
        assert_eq!(quotas[0], 1);
        assert!(quotas.iter().filter(|&&quota| quota == 0).count() >= 40, "some species end");
    }
}

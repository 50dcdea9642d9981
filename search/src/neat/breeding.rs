//! Breeding within species: a champion that passes unchanged, children of the best (G-37, G-38). New
//! innovations are numbered here, in order of index, when a generation is built (G-31).

use super::{Child, Neat};
use crate::{Parent, Place, selection};
use creatures::random::Stream;
use creatures::walker::neat::{Genotype, Register};

/// Draws after which a clone stays a clone. With the paper's rates a mutation happens in one of five; only
/// rates near 0 come to this.
const MUTATION_DRAWS: usize = 1000;

/// Who breeds in one species.
struct Stock {
    /// Its fittest member.
    champion: usize,
    /// Its best, the champion first.
    survivors: Vec<usize>,
    /// Offspring granted.
    quota: u32,
}

/// The children of the next generation in order of index: random ones in the first, then species by species.
pub(super) fn next(search: &Neat, register: &mut Register) -> Vec<Child> {
    let mut places = (0..search.settings.population).map(|index| search.place(search.generation + 1, index));
    if search.generation == 0 {
        return places.map(|place| founder(search, place)).collect();
    }
    let stocks: Vec<Stock> = stocks(search);
    let mut children = Vec::with_capacity(search.settings.population as usize);
    for (own, stock) in stocks.iter().enumerate() {
        for (rank, place) in (0..stock.quota).zip(&mut places) {
            children.push(match rank {
                0 => champion(search, stock.champion),
                _ => breed(search, &stocks, own, place, register),
            });
        }
    }
    children
}

/// The species that go on, ascending by id.
fn stocks(search: &Neat) -> Vec<Stock> {
    let fitness = |index: usize| search.population[index].scored.fitness;
    let goes_on = search.species.iter().filter(|species| species.quota > 0);
    goes_on
        .map(|species| {
            let members = search.members(species.id);
            let scores: Vec<f64> = members.iter().map(|&index| fitness(index)).collect();
            let ranked = selection::ranks(&scores).into_iter().map(|rank| members[rank]);
            // ⌈share · size⌉, where rounding must not turn 0.2 · 15 into 4.
            let share = search.settings.speciation.survivors * members.len() as f64;
            let count = ((share - 1e-9).ceil() as usize).clamp(1, members.len());
            let survivors: Vec<usize> = ranked.take(count).collect();
            Stock { champion: survivors[0], survivors, quota: species.quota }
        })
        .collect()
}

fn founder(search: &Neat, place: Place) -> Child {
    let mut draws = place.stream(search.seed, "founder");
    Child {
        genotype: Genotype::random(search.settings.body, &search.settings.variation, &mut draws),
        parents: Vec::new(),
        operator: "random".to_owned(),
    }
}

fn champion(search: &Neat, index: usize) -> Child {
    only_child(search, index, "champion")
}

/// An exact copy of one member.
fn only_child(search: &Neat, index: usize, operator: &str) -> Child {
    Child {
        genotype: search.population[index].genotype.clone(),
        parents: vec![parent(search, index, "only")],
        operator: operator.to_owned(),
    }
}

fn parent(search: &Neat, index: usize, role: &str) -> Parent {
    Parent { place: search.place(search.generation, index as u32), role: role.to_owned() }
}

/// One bred slot of a species (G-38).
fn breed(search: &Neat, stocks: &[Stock], own: usize, place: Place, register: &mut Register) -> Child {
    let variation = &search.settings.variation;
    let mut select = place.stream(search.seed, "select");
    let first = pick(&stocks[own].survivors, &mut select);
    let second =
        select.chance(search.settings.speciation.mate).then(|| mate(search, stocks, own, &mut select));
    let mut mutation = place.stream(search.seed, "mutate");
    match second.filter(|&second| second != first) {
        Some(second) => {
            let mut child = cross(search, first, second, &mut place.stream(search.seed, "crossover"));
            let applied = child.genotype.mutate(variation, register, &mut mutation);
            name(&mut child, &applied);
            child
        }
        None => {
            let mut child = only_child(search, first, "clone");
            let applied = (0..MUTATION_DRAWS)
                .map(|_| child.genotype.mutate(variation, register, &mut mutation))
                .find(|applied| !applied.is_empty());
            name(&mut child, &applied.unwrap_or_default());
            child
        }
    }
}

/// The second parent: now and then the champion of another species, else one of its own.
fn mate(search: &Neat, stocks: &[Stock], own: usize, select: &mut Stream) -> usize {
    if stocks.len() > 1 && select.chance(search.settings.speciation.interspecies) {
        let other = select.below(stocks.len() - 1);
        let other = if other < own { other } else { other + 1 };
        return stocks[other].champion;
    }
    pick(&stocks[own].survivors, select)
}

/// The child of two; the fitter gives the structure (G-39).
fn cross(search: &Neat, a: usize, b: usize, draws: &mut Stream) -> Child {
    let (lower, higher) = (a.min(b), a.max(b));
    let of = |index: usize| {
        let member = &search.population[index];
        (&member.genotype, member.scored.fitness)
    };
    let ((lower_genotype, lower_fitness), (higher_genotype, higher_fitness)) = (of(lower), of(higher));
    let (structure, other) = match lower_genotype.leads(lower_fitness, higher_genotype, higher_fitness) {
        true => (lower, higher),
        false => (higher, lower),
    };
    Child {
        genotype: Genotype::crossover(of(structure).0, of(other).0, &search.settings.variation, draws),
        parents: vec![parent(search, structure, "first"), parent(search, other, "second")],
        operator: "crossover".to_owned(),
    }
}

fn pick(from: &[usize], draws: &mut Stream) -> usize {
    from[draws.below(from.len())]
}

/// Adds the mutations applied to a child's operator.
fn name(child: &mut Child, applied: &[&str]) {
    for mutation in applied {
        child.operator.push('+');
        child.operator.push_str(mutation);
    }
}

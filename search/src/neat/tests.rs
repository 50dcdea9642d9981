use super::*;
use serde_json::json;

/// Generation 2 of a population with a fitness by index. Founders are of a dozen species.
fn second_generation(keys: Value, population: u32, fitness: fn(usize) -> f64) -> (Neat, Vec<Individual>) {
    let table = json!({ "population": population, "neat": keys });
    let settings = Settings::read(table, &json!({ "body": "crawler" })).unwrap();
    let mut search = Neat::start(&settings, 4, 0);
    let outcomes: Vec<_> = (0..search.ask().len())
        .map(|index| {
            Some(Outcome {
                status: creatures::Status::Completed,
                fitness: fitness(index),
                steps: 1,
                measures: vec![],
                interim: None,
                note: String::new(),
            })
        })
        .collect();
    search.tell(&outcomes);
    let next = search.ask();
    (search, next)
}

/// Some fitness without a pattern, and never twice the same.
fn scattered(index: usize) -> f64 {
    (index * 7919 % 10_007) as f64
}

/// The members of each species that goes on, the fittest first, with its quota.
fn ranked(search: &Neat) -> Vec<(Vec<usize>, u32)> {
    let fitness = |index: usize| search.population[index].scored.fitness;
    let mut species: Vec<(Vec<usize>, u32)> =
        search.species.iter().map(|species| (search.members(species.id), species.quota)).collect();
    species.retain(|(_, quota)| *quota > 0);
    for (members, _) in &mut species {
        members.sort_by(|&a, &b| fitness(b).total_cmp(&fitness(a)).then(a.cmp(&b)));
    }
    species
}

/// G-37: champion first, then children of the best fifth, species by species.
#[test]
fn a_species_passes_its_champion_and_breeds_from_its_best_fifth() {
    let (search, next) = second_generation(json!({ "interspecies": 0 }), 400, scattered);
    let mut slots = next.iter();
    let species = ranked(&search);
    assert!(species.len() > 5);
    for (members, quota) in species {
        let offspring: Vec<&Individual> = slots.by_ref().take(quota as usize).collect();
        let best_fifth = &members[..members.len().div_ceil(5)];
        assert_eq!(offspring[0].operator, "champion");
        assert_eq!(offspring[0].parents[0].place.index as usize, members[0]);
        assert_eq!(offspring[0].genotype, search.population[members[0]].scored.genotype.0);
        let mut bred: Vec<usize> = offspring[1..]
            .iter()
            .flat_map(|one| &one.parents)
            .map(|parent| parent.place.index as usize)
            .collect();
        bred.sort_unstable();
        bred.dedup();
        assert!(bred.iter().all(|index| best_fifth.contains(index)));
        assert!(offspring.len() < 40 || bred.len() == best_fifth.len(), "all of them breed");
        assert!(offspring[1..].iter().all(|one| one.operator != "champion"));
    }
    assert_eq!(slots.len(), 0, "the quotas fill the generation");
}

/// G-38: two parents in 0.80, fewer where a draw gives the same twice; a clone is never an exact copy.
#[test]
fn a_clone_is_always_mutated_and_a_crossover_as_often_as_the_rates_say() {
    let (search, next) = second_generation(json!({}), 10_000, scattered);
    let bred: Vec<&Individual> = next.iter().filter(|one| one.operator != "champion").collect();
    let clones: Vec<&&Individual> = bred.iter().filter(|one| one.operator.starts_with("clone")).collect();
    let expected: f64 = ranked(&search)
        .iter()
        .map(|(members, quota)| f64::from(quota - 1) * (0.2 + 0.8 / members.len().div_ceil(5) as f64))
        .sum();
    let error = (clones.len() as f64 - expected) / bred.len() as f64;
    assert!(error.abs() < 0.015, "{} clones where {expected} are expected", clones.len());
    for clone in clones {
        assert!(clone.operator.contains('+'));
        let parent = clone.parents[0].place.index as usize;
        assert_ne!(clone.genotype, search.population[parent].scored.genotype.0);
    }
    let crossed: Vec<_> = bred.iter().filter(|one| one.operator.starts_with("crossover")).collect();
    let share = |mutation: &str| {
        let hits = crossed.iter().filter(|one| one.operator.split('+').any(|word| word == mutation)).count();
        hits as f64 / crossed.len() as f64
    };
    assert!((share("add_node") - 0.03).abs() < 0.01, "{}", share("add_node"));
    assert!((share("weights") - 0.10).abs() < 0.015, "{}", share("weights"));
    // A founder is fully linked from sensors and bias, so that many draws of 20 find a pair that is not.
    assert!((share("add_link") - 0.07).abs() < 0.015, "{}", share("add_link"));
}

/// G-38: rarely a mate is another species' champion.
#[test]
fn a_mate_of_another_species_is_its_champion() {
    let (search, next) = second_generation(json!({ "interspecies": 0.5, "mate": 1.0 }), 400, scattered);
    let champions: Vec<usize> = ranked(&search).iter().map(|(members, _)| members[0]).collect();
    let mut strangers = 0;
    for one in next.iter().filter(|one| one.parents.len() == 2) {
        let [a, b] = [0, 1].map(|parent| one.parents[parent].place.index as usize);
        if search.population[a].species != search.population[b].species {
            strangers += 1;
            assert!(champions.contains(&a) || champions.contains(&b));
        }
    }
    assert!((140..260).contains(&strangers), "{strangers}");
}

/// G-39: the fitter parent gives the structure and is named first.
#[test]
fn the_first_parent_is_the_fitter_and_gives_the_structure() {
    let keys = json!({ "add_node": 0.5, "add_link": 0.5, "interspecies": 0 });
    let (mut search, next) = second_generation(keys, 200, scattered);
    let outcomes: Vec<_> = (0..next.len()).map(|_| None).collect();
    search.tell(&outcomes);
    // Every fitness is 0 now: the fewer links, then the lower slot.
    search.settings.variation.add_node = 0.0;
    search.settings.variation.add_link = 0.0;
    let mut unequal = 0;
    for one in search.ask().iter().filter(|one| one.operator.starts_with("crossover")) {
        let [first, second] = [0, 1].map(|parent| one.parents[parent].place.index as usize);
        let links = |index: usize| search.population[index].genotype.links.len();
        assert!((links(first), first) < (links(second), second));
        unequal += u32::from(links(first) != links(second));
        let child = neat::Genotype::decode(&one.genotype).unwrap();
        let structure = |genotype: &neat::Genotype| -> Vec<u32> {
            genotype.links.iter().map(|link| link.innovation).collect()
        };
        assert_eq!(structure(&child), structure(&search.population[first].genotype));
    }
    assert!(unequal > 10, "{unequal}");
}

/// With all rates at 0 a clone stays a clone, and the search goes on.
#[test]
fn rates_of_zero_end_no_search() {
    let keys = json!({ "add_node": 0, "add_link": 0, "weights": 0 });
    let (_, next) = second_generation(keys, 40, scattered);
    assert!(next.iter().any(|one| one.operator == "clone" && one.inherits.is_some()));
}

/// X-17, G-36: a species without offspring ends; nobody stands for it when members are next sought.
#[test]
fn only_species_with_offspring_are_carried_over() {
    // All the fitness is one individual's, so that its species is granted every slot.
    let (search, next) = second_generation(json!({}), 80, |index| if index == 40 { 1000.0 } else { 0.0 });
    let holder = search.population[40].species;
    assert!(search.species.len() > 3, "others are there to end");
    assert_eq!(search.representatives().into_keys().collect::<Vec<_>>(), [holder]);
    for one in &next {
        let species = one.traits["species"].as_u64().unwrap() as u32;
        assert!(species == holder || species >= search.next_species, "an id is not used again");
    }
}

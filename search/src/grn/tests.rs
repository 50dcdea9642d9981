use super::*;
use crate::Parent;
use serde_json::json;

/// Generation 2 of a population whose fitness falls with the index, so that index 0 is the best.
fn second_generation(keys: Value, population: u32) -> (Genetic, Vec<Individual>) {
    let table = json!({ "population": population, "grn": keys });
    let settings = Settings::read(table, &json!({ "body": "crawler" })).unwrap();
    let mut search = Genetic { settings, seed: 4, population: Population::new(0) };
    let outcomes: Vec<_> = (0..search.ask().len())
        .map(|index| {
            Some(Outcome {
                status: creatures::Status::Completed,
                fitness: 1e6 - index as f64,
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

fn share(individuals: &[Individual], holds: impl Fn(&str) -> bool) -> f64 {
    individuals.iter().filter(|one| holds(&one.operator)).count() as f64 / individuals.len() as f64
}

/// G-25, G-27: crossover 0.70, mutation 0.80, its kinds 0.60, 0.15, 0.15, 0.10.
#[test]
fn children_are_crossed_and_mutated_as_often_as_the_paper_says() {
    let (_, next) = second_generation(json!({}), 20_000);
    let near = |operator: &str, expected: f64| {
        let found = share(&next, |found| found.split('+').any(|word| word == operator));
        assert!((found - expected).abs() < 0.015, "{operator}: {found} where {expected} is expected");
    };
    near("crossover", 0.70);
    near("copy", 0.30);
    let mutated = share(&next, |operator| operator.contains('+'));
    assert!((mutated - 0.80).abs() < 0.015, "{mutated}");
    near("scaling", 0.80 * 0.10);
    // Add at 20 and remove at 4 become tag: each 1 of 17 founders' sizes, and a little more after crossover.
    near("add", 0.80 * 0.15 * 16.0 / 17.0);
    near("remove", 0.80 * 0.15 * 16.0 / 17.0);
}

/// G-25: the best of three uniform draws among n is of rank r with a mean of about n/4.
#[test]
fn parents_are_the_best_of_three() {
    let (_, next) = second_generation(json!({}), 4_000);
    let parents: Vec<f64> = next[1..]
        .iter()
        .flat_map(|one| &one.parents)
        .map(|parent| f64::from(parent.place.index) / 4_000.0)
        .collect();
    let mean = parents.iter().sum::<f64>() / parents.len() as f64;
    assert!((mean - 0.25).abs() < 0.01, "{mean}");
}

#[test]
fn the_elite_passes_unchanged_in_the_first_slots() {
    let (search, next) = second_generation(json!({ "elite": 3 }), 10);
    for (index, one) in next[..3].iter().enumerate() {
        let place = Place { stage: 0, generation: 1, index: index as u32 };
        assert_eq!(one.operator, "elite");
        assert_eq!(one.parents, [Parent { place, role: "only".to_owned() }]);
        assert_eq!(one.genotype, search.population.members()[index].scored.genotype.0);
        assert_eq!(one.inherits, Some(place));
    }
    assert!(next[3..].iter().all(|one| one.operator != "elite"));
    let (_, none) = second_generation(json!({ "elite": 0 }), 10);
    assert!(none.iter().all(|one| one.operator != "elite"));
}

/// G-26: the first parent gives the head, the second the length; the same slot twice gives a copy.
#[test]
fn crossover_has_two_different_parents_and_the_first_gives_the_head() {
    let (search, next) = second_generation(json!({ "mutate": 0 }), 200);
    let mut crossed = 0;
    for one in &next[1..] {
        let child = grn::Genotype::decode(&one.genotype).unwrap();
        let parent =
            |index: usize| &search.population.members()[one.parents[index].place.index as usize].genotype;
        if one.operator == "crossover" {
            crossed += 1;
            assert_ne!(one.parents[0].place, one.parents[1].place);
            assert_eq!(child.proteins[0], parent(0).proteins[0]);
            assert_eq!(child.proteins.len(), parent(1).proteins.len());
            assert_eq!(child.proteins.last(), parent(1).proteins.last());
        } else {
            assert_eq!(one.operator, "copy");
            assert_eq!(&child, parent(0));
            assert!(one.inherits.is_some());
        }
    }
    assert!(crossed > 100);
}

//! What every search promises, whatever its kind: asking is a pure function of the state, a checkpoint is
//! the whole state, every individual says truly where it comes from.

use creatures::walker::Genotype;
use creatures::{Outcome, Status};
use proptest::prelude::*;
use search::registry::{self, Plan};
use search::{Individual, Place, Search};
use serde_json::{Value, json};

/// A search of a kind on a small population.
fn plan(kind: &str, body: &str) -> Box<dyn Plan> {
    let system = if kind == "probe" { "probe" } else { "walker" };
    let mut table = json!({ "kind": kind, "population": 24, "generations": 12 });
    if kind == "neat" {
        // Structure grows fast enough to be seen within a few generations.
        table["neat"] = json!({ "add_node": 0.2, "add_link": 0.3, "weights": 0.4, "interspecies": 0.1 });
    }
    let kind = registry::kind(&table, system).expect("the kind fits");
    let task = if system == "probe" { json!({}) } else { json!({ "body": body }) };
    kind.plan(table, &task).expect("the table is legal")
}

const SEARCHES: [(&str, &str); 4] =
    [("grn", "crawler"), ("grn", "hopper"), ("neat", "crawler"), ("probe", "")];

/// A fitness that depends on the genotype alone and that selection can raise: the share of its bytes below
/// a bound, coarse enough for ties.
fn score(genotype: &[u8]) -> f64 {
    let below = genotype.iter().filter(|&&byte| byte < 0x10).count();
    (1000 * below / genotype.len()) as f64
}

fn outcome(status: Status, fitness: f64) -> Option<Outcome> {
    Some(Outcome { status, fitness, steps: 1, measures: vec![], interim: None, note: String::new() })
}

fn evaluate(generation: &[Individual]) -> Vec<Option<Outcome>> {
    generation.iter().map(|individual| outcome(Status::Completed, score(&individual.genotype))).collect()
}

/// Runs a search to its end; gives its generations.
fn history(search: &mut dyn Search) -> Vec<Vec<Individual>> {
    let mut generations = Vec::new();
    loop {
        let generation = search.ask();
        if generation.is_empty() {
            return generations;
        }
        search.tell(&evaluate(&generation));
        generations.push(generation);
    }
}

/// X-20: a search restored at the end of any generation goes on as if it had never stopped.
#[test]
fn a_restored_search_asks_for_the_same_individuals() {
    for (kind, body) in SEARCHES {
        let plan = plan(kind, body);
        let unbroken = history(plan.start(7, 0).as_mut());
        assert_eq!(unbroken.len(), 12);
        let mut search = plan.start(7, 0);
        for generation in &unbroken {
            search = plan.restore(7, 0, &search.checkpoint()).unwrap();
            let asked = search.ask();
            assert!(asked == *generation, "{kind} on {body}");
            // Killed within the generation: what was asked for and not told is asked for again.
            let before_tell = plan.restore(7, 0, &search.checkpoint());
            assert!(before_tell.unwrap().ask() == *generation, "{kind} on {body}");
            search.tell(&evaluate(&asked));
        }
        assert!(plan.restore(7, 0, &search.checkpoint()).unwrap().ask().is_empty());
    }
}

#[test]
fn asking_twice_gives_the_same_and_another_seed_or_stage_gives_another_history() {
    for (kind, body) in SEARCHES {
        let plan = plan(kind, body);
        let mut search = plan.start(7, 0);
        for _ in 0..3 {
            let asked = search.ask();
            assert!(asked == search.ask(), "{kind} on {body}");
            search.tell(&evaluate(&asked));
        }
        let first = |seed, stage| plan.start(seed, stage).ask().remove(0).genotype;
        assert_ne!(first(7, 0), first(8, 0));
        assert_ne!(first(7, 0), first(7, 1));
    }
}

#[test]
fn every_genotype_is_legal_and_every_parent_stands_in_the_generation_before() {
    for (kind, body) in SEARCHES.into_iter().filter(|(kind, _)| *kind != "probe") {
        let generations = history(plan(kind, body).start(3, 0).as_mut());
        for (number, generation) in (1u32..).zip(&generations) {
            assert_eq!(generation.len(), 24);
            for individual in generation {
                let genotype = Genotype::decode(&individual.genotype).unwrap();
                assert_eq!(genotype.body().name(), body);
                assert_eq!(genotype.encode(), individual.genotype, "canonical bytes");
                assert_eq!(individual.parents.is_empty(), number == 1);
                for parent in &individual.parents {
                    assert_eq!((parent.place.stage, parent.place.generation), (0, number - 1));
                    assert!(parent.place.index < 24);
                }
                let roles: Vec<&str> = individual.parents.iter().map(|parent| parent.role.as_str()).collect();
                assert!([&[][..], &["only"], &["first", "second"]].contains(&&roles[..]), "{roles:?}");
                let crossed = individual.operator.starts_with("crossover");
                assert_eq!(crossed, roles.len() == 2, "{}", individual.operator);
            }
        }
    }
}

/// G-74: no words but these, in the order of application.
#[test]
fn operators_are_named_in_the_words_of_the_specification() {
    let words = |kind| -> (&[&str], &[&str]) {
        match kind {
            "grn" => (&["random", "elite", "copy", "crossover"], &["tag", "add", "remove", "scaling"]),
            _ => (&["random", "champion", "clone", "crossover"], &["add_node", "add_link", "weights"]),
        }
    };
    for (kind, body) in SEARCHES.into_iter().filter(|(kind, _)| *kind != "probe") {
        let (origins, mutations) = words(kind);
        let mut seen = std::collections::BTreeSet::new();
        for individual in history(plan(kind, body).start(3, 0).as_mut()).iter().flatten() {
            let (origin, rest) = individual.operator.split_once('+').unwrap_or((&individual.operator, ""));
            assert!(origins.contains(&origin), "{}", individual.operator);
            seen.insert(origin.to_owned());
            for mutation in rest.split('+').filter(|word| !word.is_empty()) {
                assert!(mutations.contains(&mutation), "{}", individual.operator);
                seen.insert(mutation.to_owned());
            }
        }
        assert_eq!(seen.len(), origins.len() + mutations.len(), "all of them occur: {seen:?}");
    }
}

/// G-28.
#[test]
fn an_individual_inherits_exactly_if_an_equal_one_stands_before_it() {
    for (kind, body) in SEARCHES.into_iter().filter(|(kind, _)| *kind != "probe") {
        let generations = history(plan(kind, body).start(5, 0).as_mut());
        let mut inherited = 0;
        for (number, generation) in generations.iter().enumerate() {
            let previous = number.checked_sub(1).map_or(&[][..], |previous| &generations[previous]);
            for (index, individual) in generation.iter().enumerate() {
                let equal = |other: &Individual| other.genotype == individual.genotype;
                let at = |generation, index| Place { stage: 0, generation, index };
                let before = previous.iter().position(equal).map(|index| at(number as u32, index as u32));
                let earlier = generation[..index].iter().position(equal);
                let expected = before.or(earlier.map(|index| at(number as u32 + 1, index as u32)));
                assert_eq!(individual.inherits, expected);
                inherited += u32::from(expected.is_some());
            }
        }
        assert!(inherited >= 11, "the best passes unchanged in every generation");
    }
}

/// G-25, G-35, G-37: the best is kept, so that the best curve never falls, and it does rise.
#[test]
fn the_best_of_a_generation_is_never_lost() {
    for (kind, body) in SEARCHES.into_iter().filter(|(kind, _)| *kind != "probe") {
        let generations = history(plan(kind, body).start(11, 0).as_mut());
        let best: Vec<f64> = generations
            .iter()
            .map(|generation| generation.iter().map(|one| score(&one.genotype)).fold(0.0, f64::max))
            .collect();
        assert!(best.is_sorted(), "{kind} on {body}: {best:?}");
        assert!(best[11] > best[0], "{kind} on {body}: {best:?}");
    }
}

/// X-15, and whatever else may become of a generation.
#[test]
fn a_generation_without_any_fitness_does_not_stop_a_search() {
    let endings = [
        outcome(Status::Completed, 0.0),
        outcome(Status::Culled, 0.0),
        outcome(Status::Aborted(creatures::Reason::NonFinite), 0.0),
        None,
    ];
    for (kind, body) in SEARCHES {
        for ending in &endings {
            let mut search = plan(kind, body).start(2, 0);
            for _ in 0..12 {
                let asked = search.ask().len();
                assert_eq!(asked, 24);
                let record = search.tell(&vec![ending.clone(); asked]);
                let quotas: u32 = record.species.iter().map(|species| species.quota).sum();
                assert_eq!(quotas, if kind == "neat" { 24 } else { 0 });
            }
        }
    }
}

/// A culled individual is evaluated anew under the cutoff of its own generation; one that was set aside
/// would only kill more workers.
#[test]
fn nobody_inherits_from_the_culled_and_everybody_from_the_set_aside() {
    for (kind, body) in SEARCHES.into_iter().filter(|(kind, _)| *kind != "probe") {
        for (ending, expected) in [(outcome(Status::Culled, 0.0), false), (None, true)] {
            let mut search = plan(kind, body).start(2, 0);
            let asked = search.ask().len();
            search.tell(&vec![ending; asked]);
            let unchanged = ["elite", "champion"];
            let next = search.ask();
            let best = next.iter().find(|one| unchanged.contains(&one.operator.as_str())).unwrap();
            assert_eq!(best.inherits.is_some_and(|place| place.generation == 1), expected, "{kind}");
        }
    }
}

/// G-45, G-75.
#[test]
fn neat_tells_of_its_species_and_its_register() {
    let mut search = plan("neat", "crawler").start(3, 0);
    let (mut innovations, mut highest, mut grown) = (28, 0, 0);
    let mut carried: Vec<u32> = Vec::new();
    for number in 1..=12u32 {
        let generation = search.ask();
        let record = search.tell(&evaluate(&generation));
        let ids: Vec<u32> = record.species.iter().map(|species| species.id).collect();
        assert!(ids.is_sorted() && !ids.is_empty());
        for species in &record.species {
            let members: Vec<usize> =
                (0..24).filter(|&index| generation[index].traits["species"] == species.id).collect();
            assert_eq!(species.size as usize, members.len());
            let scores: Vec<f64> = members.iter().map(|&index| score(&generation[index].genotype)).collect();
            assert_eq!(species.best, scores.iter().copied().fold(0.0, f64::max));
            assert!((species.share - scores.iter().sum::<f64>() / scores.len() as f64).abs() < 1e-9);
            // A new species is represented by its founder, an old one by a member of before.
            let founded = species.id > highest;
            assert_eq!(species.representative.generation, if founded { number } else { number - 1 });
            if founded {
                assert_eq!(species.representative.index as usize, members[0]);
            } else {
                assert!(carried.contains(&species.id), "a species without offspring has ended");
            }
        }
        highest = highest.max(*ids.last().unwrap());
        carried =
            record.species.iter().filter(|species| species.quota > 0).map(|species| species.id).collect();
        let new = record.notes["innovations_new"].as_u64().unwrap();
        innovations += new;
        grown += new;
        assert_eq!(record.notes["innovations"], innovations);
        assert_eq!(record.notes["species"], ids.len());
    }
    assert!(grown > 10, "structure grew by {grown} innovations");
}

/// G-31, X-19: numbers are handed out when a generation is built, so that outcomes cannot change them; and
/// one number means one structure anywhere in a run.
#[test]
fn an_innovation_means_the_same_link_anywhere_in_a_run() {
    let mut ends = std::collections::BTreeMap::new();
    for individual in history(plan("neat", "crawler").start(3, 0).as_mut()).iter().flatten() {
        let Genotype::Neat(genotype) = Genotype::decode(&individual.genotype).unwrap() else {
            unreachable!()
        };
        for link in genotype.links {
            let here = (link.from, link.to, link.recurrent);
            assert_eq!(*ends.entry(link.innovation).or_insert(here), here);
        }
    }
    let mut structures: Vec<_> = ends.values().collect();
    structures.sort_unstable();
    structures.dedup();
    assert_eq!(structures.len(), ends.len(), "and one structure has one number");
}

#[test]
fn a_kind_of_search_fits_its_system_and_no_other() {
    let refused = |table: Value, system| registry::kind(&table, system).unwrap_err().to_string();
    assert_eq!(
        refused(json!({ "kind": "grn" }), "probe"),
        "`kind`: `grn` fits system `walker`; system `probe` has `probe`"
    );
    assert_eq!(refused(json!({}), "walker"), "`kind`: is missing; system `walker` has `grn`, `neat`");
    assert!(refused(json!({ "kind": "gnr" }), "walker").contains("expected one of `grn`, `neat`"));
    assert!(refused(json!({ "kind": 3 }), "walker").contains("3 is no kind of search"));
}

#[test]
fn every_key_of_a_search_is_checked() {
    let refused = |kind: &str, keys: Value| {
        let table = json!({ "kind": kind, kind: keys });
        registry::kind(&table, "walker").unwrap().plan(table, &json!({ "body": "arm" })).unwrap_err().path
    };
    for (key, value) in [
        ("mate", json!(1.1)),
        ("mutate", json!(-0.1)),
        ("tournament", json!(0)),
        ("elite", json!(81)),
        ("tag", json!(2)),
        ("add", json!(-1)),
        ("remove", json!("many")),
        ("scaling", json!(1.5)),
        ("p", json!(33)),
        ("reg_min", json!(3)),
        ("reg_max", json!(21)),
        ("beta", json!([0.4, 2])),
        ("delta", json!([2, 1])),
        ("unheard", json!(1)),
    ] {
        let path = refused("grn", json!({ key: value }));
        assert!(path.starts_with(&format!("grn.{key}")), "{path}");
    }
    for (key, value) in [
        ("threshold", json!(-1)),
        ("stagnation", json!(0)),
        ("survivors", json!(1.1)),
        ("mate", json!(2)),
        ("interspecies", json!(-0.5)),
        ("add_node", json!(1.5)),
        ("add_link", json!(1.5)),
        ("weights", json!(1.5)),
        ("replace", json!(1.5)),
        ("perturb", json!(1.5)),
        ("start", json!(9)),
        ("step", json!(9)),
        ("limit", json!(9)),
        ("keep_disabled", json!(2)),
        ("c1", json!(-1)),
        ("c2", json!(-1)),
        ("c3", json!(true)),
        ("unheard", json!(1)),
    ] {
        assert_eq!(refused("neat", json!({ key: value })), format!("neat.{key}"));
    }
    for kind in ["grn", "neat"] {
        for key in ["population", "generations"] {
            let table = json!({ "kind": kind, key: 0 });
            let refused = registry::kind(&table, "walker").unwrap().plan(table, &json!({ "body": "arm" }));
            assert_eq!(refused.unwrap_err().path, key);
        }
    }
}

/// Spec §13: every default of the paper.
#[test]
fn the_defaults_are_the_papers() {
    let resolved = |kind: &str| {
        let table = json!({ "kind": kind });
        registry::kind(&table, "walker").unwrap().plan(table, &json!({ "body": "arm" })).unwrap().table()
    };
    assert_eq!(
        resolved("grn"),
        json!({ "kind": "grn", "population": 80, "generations": 300, "grn": {
            "mate": 0.7, "mutate": 0.8, "tournament": 3, "elite": 1, "tag": 0.6, "add": 0.15, "remove": 0.15,
            "scaling": 0.1, "p": 32, "reg_min": 4, "reg_max": 20, "beta": [0.5, 2.0], "delta": [0.5, 2.0],
        } })
    );
    assert_eq!(
        resolved("neat"),
        json!({ "kind": "neat", "population": 80, "generations": 300, "neat": {
            "threshold": 0.26, "stagnation": 15, "survivors": 0.2, "mate": 0.8, "interspecies": 0.001,
            "add_node": 0.03, "add_link": 0.07, "weights": 0.1, "replace": 0.1, "perturb": 0.9,
            "start": 1.0, "step": 0.5, "limit": 8.0, "keep_disabled": 0.75, "c1": 1.0, "c2": 1.0, "c3": 0.4,
        } })
    );
}

/// A change here changes every lineage: draws, their order, encodings.
#[test]
fn histories_are_the_same_on_every_machine() {
    let hash = |kind, body| -> String {
        let mut hasher = search::LineageHasher::new();
        for (number, generation) in (1u32..).zip(history(plan(kind, body).start(1, 0).as_mut())) {
            for (index, one) in (0u32..).zip(&generation) {
                let parents: Vec<(Place, &str)> =
                    one.parents.iter().map(|parent| (parent.place, parent.role.as_str())).collect();
                hasher.row(&search::HashRow {
                    run: 1,
                    place: Place { stage: 0, generation: number, index },
                    genotype: &one.genotype,
                    parents: &parents,
                    operator: &one.operator,
                    status: "completed",
                    fitness: score(&one.genotype),
                });
            }
        }
        hasher.finish().iter().map(|byte| format!("{byte:02x}")).collect()
    };
    let hashes: Vec<String> = SEARCHES.iter().map(|(kind, body)| hash(kind, body)).collect();
    insta::assert_snapshot!(hashes.join("\n"), @r"
    1a5e6111e6bab23d6013c0a0917a40ad8982853c82b226fe95c8a476b1a58953
    4e3f1e58b2885df48ab7a0672b7c96f7e451706f44379d566482e111b63f7264
    10ab1a7a4dfc3ef61eed3d2f8361acaaddba22f825f3ef35939258e44f256bc8
    a49d2271c106d0838ba16c6c57e0f2131b16eb6a2abd73a579a53ea0564c60e5
    ");
}

#[test]
fn a_checkpoint_of_other_settings_is_refused() {
    for (kind, body) in SEARCHES.into_iter().filter(|(kind, _)| *kind != "probe") {
        let mut search = plan(kind, body).start(1, 0);
        let asked = search.ask();
        search.tell(&evaluate(&asked));
        let problem = |table: Value, body: &str| {
            let other =
                registry::kind(&table, "walker").unwrap().plan(table, &json!({ "body": body })).unwrap();
            other.restore(1, 0, &search.checkpoint()).err().map(|problem| problem.to_string())
        };
        let size = problem(json!({ "kind": kind, "population": 25 }), body);
        assert_eq!(size.unwrap(), "checkpoint does not fit its search: its population has another size");
        let other_body = problem(json!({ "kind": kind, "population": 24 }), "runner");
        assert_eq!(
            other_body.unwrap(),
            "checkpoint does not fit its search: its population has another body"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_bytes_make_a_restore_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        for (kind, body) in SEARCHES {
            prop_assert!(plan(kind, body).restore(1, 0, &bytes).is_err());
        }
    }

    #[test]
    fn a_damaged_checkpoint_is_refused_or_understood(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        for (kind, body) in SEARCHES {
            let plan = plan(kind, body);
            let mut search = plan.start(1, 0);
            let asked = search.ask();
            search.tell(&evaluate(&asked));
            let mut bytes = search.checkpoint();
            let at = at.index(bytes.len());
            bytes[at] = byte;
            // Damage that goes unnoticed changes a history, which the lineage notices; it breaks nothing.
            if let Ok(mut search) = plan.restore(1, 0, &bytes) {
                let asked = search.ask();
                search.tell(&evaluate(&asked));
                search.ask();
            }
        }
    }
}

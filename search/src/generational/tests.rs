use super::*;
use creatures::Reason;
use creatures::flyer::variation::Settings as Flyer;
use creatures::random::stream;

fn table(extra: Value) -> Value {
    let mut table = json!({ "kind": "generational", "population": 20, "generations": 4 });
    table.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
    table
}

fn settings(extra: Value) -> Settings<Flyer> {
    Settings::read(table(extra)).unwrap()
}

fn outcome(status: Status, fitness: f64) -> Option<Outcome> {
    let measures = vec![("hover_steps".to_owned(), fitness / 2.0), ("mass".to_owned(), 3.0)];
    Some(Outcome { status, fitness, steps: 10, measures, interim: None, note: String::new() })
}

/// Fitness drawn from the genotype; every fifth individual blows up.
fn score(individuals: &[Individual]) -> Vec<Option<Outcome>> {
    let one = |(index, individual): (usize, &Individual)| {
        let sum: u64 = individual.genotype.iter().map(|&byte| u64::from(byte)).sum();
        match index % 5 {
            4 => outcome(Status::Aborted(Reason::BlowUp), 0.0),
            _ => outcome(Status::Completed, (sum % 997) as f64 - 300.0),
        }
    };
    individuals.iter().enumerate().map(one).collect()
}

#[test]
fn the_published_numbers_are_the_defaults() {
    let settings: Settings<Flyer> = Settings::read(json!({ "kind": "generational" })).unwrap();
    assert_eq!((settings.population, settings.generations), (300, 100));
    assert_eq!((settings.elite, settings.tournament_p), (0.2, 0.9));
    assert_eq!(settings.operators, Operators { copy: 0.4, crossover: 0.3, grafting: 0.3 });
}

/// T-20.
#[test]
fn a_fifth_is_the_elite_and_one_at_least() {
    let elites = |population| settings(json!({ "population": population })).elites();
    assert_eq!([300, 7, 2, 5, 10].map(elites), [60, 1, 1, 1, 2]);
}

/// T-20.
#[test]
fn of_two_creatures_the_fitter_is_picked_with_the_published_probability() {
    let mut draws = stream(1, [0, 0, 0], "test");
    let wins = (0..100_000).filter(|_| tournament(2, 0.9, &mut draws) == 0).count();
    // Both draws the fitter one: 0.25; one of each: 0.5 · 0.9.
    assert!((wins as f64 / 1e5 - 0.70).abs() < 0.006, "{wins}");
}

/// T-20.
#[test]
fn offspring_come_about_in_the_published_shares() {
    let mut search = settings(json!({ "population": 3000 })).start(3, 0);
    let founders = search.ask();
    search.tell(&score(&founders));
    let mut ways = [0.0_f64; 4];
    for child in search.ask() {
        let way = child.operator.split('+').next().unwrap().to_owned();
        let way = ["elite", "copy", "crossover", "grafting"].iter().position(|known| *known == way).unwrap();
        ways[way] += 1.0;
    }
    assert_eq!(ways[0], 600.0);
    for (way, expected) in [(1, 0.4), (2, 0.3), (3, 0.3)] {
        assert!((ways[way] / 2400.0 - expected).abs() < 0.03, "{ways:?}");
    }
}

/// F-55: valid fitness can be negative, and still ranks above the 0 of those who were stopped.
#[test]
fn the_valid_rank_before_all_others() {
    let outcomes = [
        outcome(Status::Culled, 0.0),
        outcome(Status::Completed, -5.0),
        None,
        outcome(Status::Completed, 7.0),
        outcome(Status::Completed, -5.0),
    ];
    let scored: Vec<Scored> = outcomes.iter().map(|o| Scored::new(vec![], o.as_ref())).collect();
    assert_eq!(ranks(scored.iter()), [3, 1, 4, 0, 2]);
}

/// F-60: the elite stands first, in order of rank, and needs no evaluation.
#[test]
fn the_elite_passes_unchanged_and_is_not_evaluated_again() {
    let mut search = settings(json!({})).start(5, 2);
    let founders = search.ask();
    let outcomes = score(&founders);
    search.tell(&outcomes);
    let scored: Vec<Scored> = outcomes.iter().map(|o| Scored::new(vec![], o.as_ref())).collect();
    let next = search.ask();
    for (index, rank) in ranks(scored.iter()).into_iter().take(4).enumerate() {
        let place = Place { stage: 2, generation: 1, index: rank as u32 };
        assert_eq!(next[index].genotype, founders[rank].genotype);
        assert_eq!(next[index].inherits, Some(place));
        assert_eq!((next[index].operator.as_str(), next[index].parents[0].place), ("elite", place));
    }
    assert_ne!(next[4].operator, "elite");
}

/// X-15, T-20.
#[test]
fn a_generation_without_a_valid_creature_still_breeds_and_says_so() {
    let mut search = settings(json!({})).start(6, 0);
    let founders = search.ask();
    let record = search.tell(&vec![outcome(Status::Aborted(Reason::BlowUp), 0.0); founders.len()]);
    assert_eq!(Value::Object(record.notes), json!({ "valid": 0 }));
    let next = search.ask();
    assert_eq!(next.len(), 20);
    assert_eq!(next[0].genotype, founders[0].genotype, "ranked by index");
}

/// F-70.
#[test]
fn a_generation_is_recorded_with_its_median_and_its_best() {
    let outcomes = [
        outcome(Status::Completed, 8.0),
        outcome(Status::Aborted(Reason::BlowUp), 0.0),
        outcome(Status::Completed, -2.0),
        None,
    ];
    let expected = json!({ "valid": 2, "median": 3.0, "max_hover_steps": 4.0, "best_hover_steps": 4.0, "best_mass": 3.0 });
    assert_eq!(Value::Object(notes(&outcomes, Flyer::RECORDS)), expected);
    let odd = [1.0, 9.0, 4.0].map(|fitness| outcome(Status::Completed, fitness));
    assert_eq!(notes(&odd, &[])["median"], json!(4.0));
}

/// F-69.
#[test]
fn a_restored_search_asks_for_the_same() {
    let settings = settings(json!({}));
    let mut search = settings.start(7, 1);
    for _ in 0..4 {
        let mut restored = settings.restore(7, 1, &search.checkpoint()).unwrap();
        let asked = search.ask();
        assert_eq!(restored.ask(), asked);
        search.tell(&score(&asked));
    }
    assert!(search.ask().is_empty(), "four generations and no more");
}

#[test]
fn a_checkpoint_of_other_settings_is_refused() {
    let mut search = settings(json!({})).start(7, 1);
    let asked = search.ask();
    search.tell(&score(&asked));
    let smaller = settings(json!({ "population": 10 }));
    let refusal = smaller.restore(7, 1, &search.checkpoint()).map(|_| ()).unwrap_err();
    assert!(matches!(refusal, RestoreError::Unfit(_)), "{refusal}");
}

///
#[test]
fn numbers_that_make_no_search_are_refused_by_name() {
    let refused = |extra| Settings::<Flyer>::read(table(extra)).unwrap_err().path;
    assert_eq!(refused(json!({ "population": 1 })), "population");
    assert_eq!(refused(json!({ "elite": 1.5 })), "elite");
    assert_eq!(refused(json!({ "tournament_p": -0.1 })), "tournament_p");
    assert_eq!(refused(json!({ "operators": { "copy": 0.5 } })), "operators");
    assert_eq!(refused(json!({ "operators": { "copy": 1.5 } })), "operators.copy");
    assert_eq!(refused(json!({ "variation": { "scalar": 2.0 } })), "variation.scalar");
    assert!(refused(json!({ "mutation": 0.5 })).contains("mutation"));
}

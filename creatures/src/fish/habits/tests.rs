use super::variation::{Focus, Settings};
use super::*;
use crate::DecodeError;
use crate::random::stream;
use proptest::prelude::*;

fn problem(genotype: &Genotype) -> String {
    match Genotype::decode(&genotype.encode()) {
        Err(DecodeError::Illegal { field, problem }) => {
            assert_eq!(field, "habits");
            problem
        }
        other => panic!("illegal habits gave {other:?}"),
    }
}

fn prey() -> Genotype {
    Genotype { habits: vec![Habits::published(Nature::Prey, Sex::Male)] }
}

#[test]
fn published_habits_are_legal_and_travel_bit_for_bit() {
    for nature in [Nature::Predator, Nature::Prey, Nature::Pacifist] {
        for sex in [Sex::Male, Sex::Female] {
            let genotype = Genotype { habits: vec![Habits::published(nature, sex); 2] };
            assert_eq!(Genotype::decode(&genotype.encode()).unwrap(), genotype);
        }
    }
}

/// AF-5
#[test]
fn every_violation_is_told_at_once() {
    let mut genotype = prey();
    let habits = &mut genotype.habits[0];
    (habits.fear_min, habits.panic, habits.urge) = (0.4, 0.3, 0.5);
    (habits.appetite, habits.digestion, habits.size) = (0.0, -1.0, 2.1);
    (habits.temperature_min, habits.temperature_max) = (30.0, 20.0);
    habits.vision = f64::NAN;
    let problem = problem(&genotype);
    for part in [
        "`panic` 0.3 is not above `fear_min` 0.4",
        "`urge` 0.5 is not within",
        "`appetite` 0 is not within 1 to 20",
        "`digestion` -1",
        "`size` 2.1 is not within 0.5 to 2",
        "`temperature_min` 30 is above `temperature_max` 20",
        "`vision` NaN",
    ] {
        assert!(problem.contains(part), "{part} is not in {problem}");
    }
}

/// AF-5
#[test]
fn unknown_natures_and_sexes_are_told_with_the_rest() {
    let mut genotype = prey();
    genotype.habits[0].size = 3.0;
    let mut bytes = genotype.encode();
    for (word, other) in [("prey", "shoe"), ("male", "mole")] {
        let at = bytes.windows(4).position(|window| window == word.as_bytes()).unwrap();
        bytes[at..at + 4].copy_from_slice(other.as_bytes());
    }
    let error = Genotype::decode(&bytes).unwrap_err().to_string();
    for part in ["[0] `nature` `shoe`", "[0] `sex` `mole`", "[0] `size` 3"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn other_versions_and_empty_sets_are_refused() {
    let empty = Genotype { habits: Vec::new() };
    assert!(problem(&empty).contains("0 vectors"));
    let bytes = crate::encoding::encode(&serde_json::json!({"version": 2}));
    assert!(matches!(Genotype::decode(&bytes), Err(DecodeError::Version { found: 2, known: 1, .. })));
}

#[test]
fn a_crossover_takes_whole_groups() {
    let settings = Settings { focus: Focus::Pacifist, ..Settings::default() };
    let parents = [1, 2].map(|place| Genotype::random(&settings, &mut stream(5, [0, 0, place], "parent")));
    let child = Genotype::crossover(&parents[0], &parents[1], &mut stream(5, [0, 0, 3], "child"));
    for (vector, habits) in child.habits.iter().enumerate() {
        for group in Group::ALL {
            let of_group = |from: &Habits| -> Vec<f64> {
                GENES.iter().filter(|gene| gene.group == group).map(|gene| (gene.read)(from)).collect()
            };
            let found = of_group(habits);
            assert!(parents.iter().any(|parent| of_group(&parent.habits[vector]) == found), "{group:?}");
        }
    }
    assert!(child != parents[0] && child != parents[1], "this coin mixes them");
}

proptest! {
    ///
    #[test]
    fn descent_stays_legal(seed in any::<u64>(), deviation in 0.0..1.0f64, focus in 0usize..3) {
        let focus = [Focus::Prey, Focus::Predator, Focus::Pacifist][focus];
        let settings = Settings { focus, rate: 0.8, deviation, schooling: 0.5 };
        let mut draws = stream(seed, [0, 0, 0], "descent");
        let mut line = Genotype::random(&settings, &mut draws);
        for _ in 0..20 {
            let other = Genotype::random(&settings, &mut draws);
            line = Genotype::crossover(&line, &other, &mut draws);
            line = Genotype::graft(&line, &other, &mut draws);
            line.mutate(&settings, &mut draws);
            prop_assert_eq!(&Genotype::decode(&line.encode()).unwrap(), &line);
        }
    }

    #[test]
    fn bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = Genotype::decode(&bytes);
    }
}

#[test]
fn mutations_are_small_and_named() {
    let settings = Settings { rate: 1.0, deviation: 0.01, schooling: 0.0, focus: Focus::Prey };
    let mut child = prey();
    let names = child.mutate(&settings, &mut stream(1, [0, 0, 0], "mutate"));
    assert_eq!(names.len(), GENES.len());
    for gene in &GENES {
        let moved = (gene.read)(&child.habits[0]) - (gene.read)(&prey().habits[0]);
        assert!(moved.abs() < 0.06 * (gene.bounds[1] - gene.bounds[0]), "{}: {moved}", gene.name);
    }
    let still = Settings { rate: 0.0, ..settings };
    let mut same = prey();
    assert!(same.mutate(&still, &mut stream(1, [0, 0, 0], "mutate")).is_empty() && same == prey());
}

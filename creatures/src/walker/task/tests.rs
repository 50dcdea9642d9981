//! Fitness (T-9), whole evaluations, culling, and what goes wrong.

use super::*;
use crate::Nobody;
use crate::random::stream;

fn short(body: BodyKind) -> WalkerTask {
    WalkerTask { seconds: 0.5, ..WalkerTask::new(body) }
}

fn founder(body: BodyKind) -> Genotype {
    let mut stream = stream(1, [0, 0, 0], "task test");
    Genotype::Grn(grn::Genotype::random(body, &grn::Settings::default(), &mut stream))
}

fn measure(outcome: &Outcome, name: &str) -> f64 {
    outcome.measures.iter().find(|(measure, _)| measure == name).expect("a measure of the task").1
}

/// T-9
#[test]
fn fitness_counts_feet_ahead_and_punishes_drift() {
    let task = WalkerTask::new(BodyKind::Crawler);
    let score = |start: [f64; 2], end: [f64; 2]| {
        let at = |[x, y]: [f64; 2]| DVec3::new(x, y, 0.02);
        let dis = task.dis(at(start), at(end));
        (dis, fitness(dis))
    };
    let close = |(_, found): (f64, f64), expected: f64| {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    };
    close(score([0.0, 0.0], [0.3048, -1.524]), 49.0);
    let off_course = score([0.0, 0.0], [1.2192, -0.3048]);
    assert!((off_course.0 + 6.0).abs() < 1e-9);
    close(off_course, 0.0);
    close(score([0.0, 0.0], [0.0, 0.5]), 0.0);
    close(score([0.0, 0.0], [-0.1524, -3.048]), 99.75);
    // 40/0.3048 − (1/0.3048)².
    close(score([1.0, 1.0], [2.0, -3.0]), 120.469685384);
    close((0.0, fitness(f64::NAN)), 0.0);
}

/// G-62, and the same bits twice (T-20).
#[test]
fn an_evaluation_is_a_pure_function_with_every_measure() {
    for body in BodyKind::ALL {
        let task = short(body);
        let genotype = founder(body).encode();
        let live = |seed| task.evaluate(&genotype, seed, None, &mut Nobody).unwrap();
        let outcome = live(1);
        assert_eq!(outcome.status, Status::Completed);
        assert_eq!(outcome.steps, 120);
        let names = ["dis", "drift", "travel", "height_max", "speed_max", "somersaults", "silent_pairs"];
        let found: Vec<_> = outcome.measures.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(found, [&names[..], &["grn_collapse"]].concat());
        let dis = measure(&outcome, "dis");
        assert_eq!(outcome.fitness, fitness(dis));
        let end = DVec3::new(measure(&outcome, "drift"), measure(&outcome, "travel"), 0.0);
        assert!((task.dis(DVec3::ZERO, end) - dis).abs() < 1e-9);
        assert_eq!(live(1).digest(), outcome.digest());
        assert_eq!(live(2).digest(), outcome.digest(), "the seed is accepted and unused");
    }
}

/// G-20: a network of NEAT without links commands nothing, and the body stays.
#[test]
fn a_network_without_links_stays_where_it_is() {
    let genotype = Genotype::Neat(neat::Genotype { body: BodyKind::Hopper, hidden: vec![], links: vec![] });
    let task = WalkerTask::new(BodyKind::Hopper);
    let outcome = task.evaluate(&genotype.encode(), 0, None, &mut Nobody).unwrap();
    assert!(outcome.fitness <= 0.7, "fitness {}", outcome.fitness);
    assert_eq!((outcome.steps, measure(&outcome, "silent_pairs")), (1800, 0.0));
}

/// aborting is for the exceptional; random networks must not get there.
#[test]
fn random_creatures_live_to_the_end() {
    for (body, place) in BodyKind::ALL.into_iter().flat_map(|body| (0..20).map(move |place| (body, place))) {
        let task = WalkerTask { seconds: 2.0, ..WalkerTask::new(body) };
        let mut draws = stream(2, [0, 0, place], "task test");
        let grn = grn::Genotype::random(body, &grn::Settings::default(), &mut draws).encode();
        let neat = neat::Genotype::random(body, &neat::Settings::default(), &mut draws).encode();
        for genotype in [grn, neat] {
            let outcome = task.evaluate(&genotype, 0, None, &mut Nobody).unwrap();
            assert_eq!(outcome.status, Status::Completed, "{body:?} {place}: {}", outcome.note);
        }
    }
}

#[test]
fn a_genotype_of_another_body_is_refused() {
    let error = short(BodyKind::Arm).check(&founder(BodyKind::Crawler).encode()).unwrap_err();
    assert_eq!(error.to_string(), "genotype field `body`: crawler where the task has arm");
}

/// G-61
#[test]
fn a_creature_below_the_cutoff_stops_at_its_interim_report() {
    let (task, genotype) = (short(BodyKind::Crawler), founder(BodyKind::Crawler).encode());
    let live = |cull: Option<Cull>| {
        let mut seen = Vec::new();
        let outcome = task.evaluate(&genotype, 0, cull.as_ref(), &mut |interim| seen.push(interim)).unwrap();
        (outcome, seen)
    };
    let (free, silent) = live(None);
    assert_eq!((free.interim, silent.len()), (None, 0));
    let cull = Cull { at: 0.255, cutoff: Some(1e6), control: false };
    let (culled, seen) = live(Some(cull));
    assert_eq!((culled.status, culled.steps, culled.fitness), (Status::Culled, 30, 0.0));
    assert_eq!((culled.interim, seen.len()), (Some(seen[0]), 1));
    assert_eq!((seen[0].step, seen[0].measure), (30, measure(&culled, "dis")));
    let (spared, _) = live(Some(Cull { control: true, ..cull }));
    let (passed, _) = live(Some(Cull { cutoff: Some(-1e6), ..cull }));
    for outcome in [spared, passed] {
        assert_eq!((outcome.status, outcome.fitness), (Status::Completed, free.fitness));
        assert_eq!((outcome.interim, outcome.measures), (Some(seen[0]), free.measures.clone()));
    }
}

///
#[test]
fn a_body_out_of_bounds_ends_its_life_with_the_quantity_and_the_step() {
    let task = short(BodyKind::Runner);
    let genotype = founder(BodyKind::Runner);
    let thrown = |velocity: DVec3| {
        let mut life = Life::new(&task, &genotype);
        life.phenotype.throw(velocity);
        let end = life.live(None, &mut Nobody);
        life.outcome(end)
    };
    let cases = [(DVec3::new(0.0, 60.0, 1.0), "speed "), (DVec3::new(0.0, 0.0, 45.0), "torso height 10.")];
    for (velocity, quantity) in cases {
        let outcome = thrown(velocity);
        assert_eq!((outcome.status, outcome.fitness), (Status::Aborted(Reason::BlowUp), 0.0));
        assert!(outcome.note.starts_with(quantity), "{}", outcome.note);
        assert!(outcome.note.ends_with(&format!(" at step {}", outcome.steps)), "{}", outcome.note);
    }
    let far = WalkerTask { seconds: 7.5, ..task.clone() };
    let mut life = Life::new(&far, &genotype);
    life.start = DVec3::ZERO;
    life.phenotype.throw(DVec3::new(45.0, 0.0, 8.0));
    let end = life.live(None, &mut Nobody);
    let note = life.outcome(end).note;
    assert!(note.starts_with("distance 100."), "{note}");
}

///
#[test]
fn a_number_that_is_none_ends_a_life_with_fitness_zero() {
    let task = short(BodyKind::Crawler);
    let mut life = Life::new(&task, &founder(BodyKind::Crawler));
    life.phenotype.throw(DVec3::new(f64::NAN, 0.0, 0.0));
    let end = life.live(None, &mut Nobody);
    let outcome = life.outcome(end);
    assert_eq!((outcome.status, outcome.fitness), (Status::Aborted(Reason::NonFinite), 0.0));
    assert_eq!(outcome.note, "a sensor is not finite at step 0");
    assert!(outcome.measures.iter().all(|(_, value)| value.is_finite()), "{:?}", outcome.measures);
}

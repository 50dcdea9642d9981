//! Whole evaluations: measures, timing (F-30), landing and culling (T-19), and what goes wrong (X-6..X-12).

use super::*;
use crate::flyer::skeleton::tests::{creature, wing};
use crate::flyer::{Function, Kind, Neuron, Settings, Source};
use crate::random::stream;
use crate::{Nobody, Outcome, Task};

fn founder(place: u32) -> Genotype {
    Genotype::random(&Settings::default(), &mut stream(1, [0, 0, place], "life test"))
}

/// A plain creature without a brain, which falls.
fn faller() -> Genotype {
    creature((30.0, 2.0), 20.0, &[wing(40.0, 1, 10.0, 60.0)])
}

fn live(task: &FlyerTask, genotype: &Genotype) -> Outcome {
    task.evaluate(&genotype.encode(), 0, None, &mut Nobody).unwrap()
}

fn culled_at(task: &FlyerTask, genotype: &Genotype, cutoff: Option<f64>, control: bool) -> Outcome {
    let cull = Cull { at: 0.25, cutoff, control };
    task.evaluate(&genotype.encode(), 0, Some(&cull), &mut Nobody).unwrap()
}

fn measure(outcome: &Outcome, name: &str) -> Option<f64> {
    outcome.measures.iter().find(|(measure, _)| measure == name).map(|&(_, value)| value)
}

/// A founder that flies through its first quarter and moves, with its free evaluation.
fn flier(task: &FlyerTask) -> (Genotype, Outcome) {
    (0..200)
        .map(founder)
        .map(|genotype| {
            let outcome = live(task, &genotype);
            (genotype, outcome)
        })
        .find(|(_, outcome)| {
            let quarter = measure(outcome, "quarter_distance").unwrap_or(0.0);
            outcome.status == Status::Completed && quarter > 1.0
        })
        .expect("one of many founders gets through its first quarter")
}

/// F-68, F-70; the same bits twice, and whatever the seed is (F-5, F-67).
#[test]
fn an_evaluation_is_a_pure_function_with_every_measure() {
    let task = FlyerTask { steps: 200, ..FlyerTask::default() };
    let (genotype, outcome) = flier(&task);
    let names: Vec<_> = outcome.measures.iter().map(|(name, _)| name.as_str()).collect();
    let expected = [
        "distance",
        "hover_steps",
        "speed_sum",
        "landed",
        "quarter_distance",
        "quarter_fitness",
        "max_speed",
        "mass",
        "span",
        "flap_frequency",
    ];
    assert_eq!(names, expected);
    let of = |name| measure(&outcome, name).unwrap();
    assert_eq!(outcome.fitness, of("hover_steps") + of("speed_sum"));
    assert_eq!(outcome.steps, of("hover_steps") as u32);
    assert!(of("max_speed") > 0.0 && of("max_speed") < 1000.0 && of("mass") > 0.6);
    assert_eq!(live(&task, &genotype).digest(), outcome.digest());
    let again = task.evaluate(&genotype.encode(), 99, None, &mut Nobody).unwrap();
    assert_eq!(again.digest(), outcome.digest(), "the seed is accepted and unused");
}

/// F-52
#[test]
fn distance_is_horizontal_and_as_the_crow_flies() {
    let task = FlyerTask { steps: 200, ..FlyerTask::default() };
    let (genotype, outcome) = flier(&task);
    let mut life = Life::new(&task, &genotype);
    life.live(None, &mut Nobody);
    let moved = life.phenotype.world().center_of_mass() - life.start;
    assert!((moved.x.abs() - moved.z.abs()).abs() > 0.1 && moved.y.abs() > 0.1, "a telling way: {moved}");
    let expected = (moved.x * moved.x + moved.z * moved.z).sqrt();
    assert!((measure(&outcome, "distance").unwrap() - expected).abs() < 1e-9);
}

/// F-66: no key of the table is read and forgotten. Each is changed a little, and some creature's outcome
/// with it.
#[test]
fn every_parameter_matters() {
    let paper = FlyerTask { steps: 200, ..FlyerTask::default() };
    let creatures: Vec<Genotype> = (0..24).map(founder).collect();
    let lives = |task: &FlyerTask| -> Vec<[u8; 32]> {
        let cull = Cull { at: 0.25, cutoff: None, control: false };
        let live = |genotype: &Genotype| task.evaluate(&genotype.encode(), 0, Some(&cull), &mut Nobody);
        creatures.iter().map(|genotype| live(genotype).unwrap().digest()).collect()
    };
    let expected = lives(&paper);
    let changed = [
        ("steps", FlyerTask { steps: 199, ..paper.clone() }),
        ("dt", FlyerTask { dt: 0.049, ..paper.clone() }),
        ("start_height", FlyerTask { start_height: 30.0, ..paper.clone() }),
        ("gravity", FlyerTask { gravity: 9.8, ..paper.clone() }),
        ("density", FlyerTask { density: 0.011, ..paper.clone() }),
        ("alpha", FlyerTask { alpha: 1.1e-3, ..paper.clone() }),
        ("tail_weight", FlyerTask { tail_weight: 1.5, ..paper.clone() }),
        ("hinge_limit", FlyerTask { hinge_limit: 1.0, ..paper.clone() }),
        ("ball_limit", FlyerTask { ball_limit: 0.3, ..paper.clone() }),
        ("hinge_rate", FlyerTask { hinge_rate: 1.9, ..paper.clone() }),
        ("ball_rate", FlyerTask { ball_rate: 0.4, ..paper.clone() }),
        ("motor_k", FlyerTask { motor_k: 0.9, ..paper.clone() }),
        ("erp", FlyerTask { erp: 0.1, ..paper.clone() }),
        ("brain_substeps", FlyerTask { brain_substeps: 1, ..paper.clone() }),
        ("stop_fraction", FlyerTask { stop_fraction: 0.3, ..paper.clone() }),
        ("w_hover", FlyerTask { w_hover: 2.0, ..paper.clone() }),
        ("w_speed", FlyerTask { w_speed: 2.0, ..paper.clone() }),
        ("interim", FlyerTask { interim: Measure::Fitness, ..paper.clone() }),
        ("blow_up_speed", FlyerTask { blow_up_speed: 20.0, ..paper.clone() }),
        ("drag_limiter", FlyerTask { drag_limiter: true, ..paper.clone() }),
    ];
    for (key, task) in changed {
        assert_ne!(lives(&task), expected, "{key} changes nothing");
    }
}

/// F-30, F-31, F-34: two brain steps, at 0 and dt/2, pass a signal through two neurons before the motors hear
/// of it.
#[test]
fn a_signal_passes_two_neurons_in_a_step() {
    let mut genotype = faller();
    let neuron = |function, inputs| Neuron { function, delay: 1, inputs };
    let source = |index| Source { node: 0, kind: Kind::Neuron, index, cross: false };
    genotype.nodes[0].neurons =
        vec![neuron(Function::Cos, vec![]), neuron(Function::SawWave, vec![source(0)])];
    genotype.nodes[2].effectors[0].inputs = vec![source(1)];
    let task = FlyerTask { alpha: 0.0, gravity: 0.0, ..FlyerTask::default() };
    let mut life = Life::new(&task, &genotype);
    for _ in 0..3 {
        life.step().unwrap();
        life.steps += 1;
    }
    // Half the phase: the wave of frequency 1 at dt/2, then at 3/2 dt, by which the hinge turns 2 rad/s.
    let expected = [0.0, 0.5 * 0.025 * 2.0 * 0.05, (0.5 * 0.025 + 0.5 * 0.075) * 2.0 * 0.05];
    for (found, expected) in life.flaps.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }
}

/// F-50: whoever touches the ground has landed, and the step counts.
#[test]
fn a_creature_lands_and_its_flight_counts() {
    let task = FlyerTask { start_height: 60.0, ..FlyerTask::default() };
    let outcome = live(&task, &faller());
    assert_eq!((outcome.status, measure(&outcome, "landed")), (Status::Completed, Some(1.0)));
    assert!(outcome.steps > 20 && outcome.steps < 1500);
    assert_eq!(measure(&outcome, "hover_steps"), Some(f64::from(outcome.steps)));
    let higher = live(&FlyerTask { start_height: 61.0, ..task }, &faller());
    assert!(higher.steps > outcome.steps);
    assert!(higher.fitness > outcome.fitness);
}

#[test]
fn a_creature_that_never_lands_is_complete() {
    let task = FlyerTask { steps: 40, ..FlyerTask::default() };
    let outcome = live(&task, &faller());
    assert_eq!((outcome.status, outcome.steps), (Status::Completed, 40));
    assert_eq!((measure(&outcome, "landed"), measure(&outcome, "hover_steps")), (Some(0.0), Some(40.0)));
}

/// T-19, F-53: strictly below the cutoff is culled, and a control goes on.
#[test]
fn a_creature_below_the_cutoff_stops_after_its_first_quarter() {
    for interim in [Measure::Distance, Measure::Fitness] {
        let task = FlyerTask { interim, ..FlyerTask::default() };
        let (genotype, free) = flier(&task);
        let quarter = measure(&free, &format!("quarter_{}", interim.name())).unwrap();
        let above = quarter + 0.001;

        let culled = culled_at(&task, &genotype, Some(above), false);
        assert_eq!((culled.status, culled.fitness, culled.steps), (Status::Culled, 0.0, 375));
        assert_eq!(culled.interim, Some(Interim { step: 375, measure: quarter }));
        for (cutoff, control) in
            [(Some(quarter), false), (Some(0.0), false), (None, false), (Some(above), true)]
        {
            let outcome = culled_at(&task, &genotype, cutoff, control);
            assert_eq!((outcome.status, outcome.steps), (Status::Completed, free.steps), "{cutoff:?}");
            assert_eq!(outcome.fitness.to_bits(), free.fitness.to_bits());
            assert_eq!(outcome.interim, culled.interim);
        }
    }
}

/// A share of less than a step is one step: whoever sets a rule hears of everybody.
#[test]
fn the_earliest_interim_report_comes_after_the_first_step() {
    let cull = Cull { at: 1e-6, cutoff: None, control: false };
    let mut heard = vec![];
    let task = FlyerTask { steps: 8, ..FlyerTask::default() };
    task.evaluate(&faller().encode(), 0, Some(&cull), &mut |interim: Interim| heard.push(interim.step))
        .unwrap();
    assert_eq!(heard, [1]);
}

/// T-19: before its first quarter, or at its very end, landing comes first.
#[test]
fn who_has_landed_is_not_culled() {
    let low = FlyerTask { start_height: 60.0, ..FlyerTask::default() };
    let landing = live(&low, &faller()).steps;
    assert!(landing < 375);
    for steps in [1500, 4 * landing] {
        let task = FlyerTask { steps, ..low.clone() };
        let outcome = culled_at(&task, &faller(), Some(1e9), false);
        assert_eq!((outcome.status, outcome.steps, outcome.interim), (Status::Completed, landing, None));
        assert!(outcome.fitness != 0.0);
        assert_eq!(measure(&outcome, "quarter_distance"), None);
    }
    let task = FlyerTask { steps: 4 * (landing - 1), ..low };
    let culled = culled_at(&task, &faller(), Some(1e9), false);
    assert_eq!((culled.status, culled.steps), (Status::Culled, landing - 1));
}

///
#[test]
fn a_creature_whose_films_cross_is_not_simulated() {
    let genotype = creature((30.0, 2.0), 20.0, &[wing(40.0, 0, 90.0, 60.0)]);
    let outcome = live(&FlyerTask::default(), &genotype);
    assert_eq!((outcome.status, outcome.steps), (Status::Aborted(Reason::SelfIntersecting), 0));
    assert_eq!((outcome.fitness, outcome.interim), (0.0, None));
    assert!(outcome.measures.iter().all(|(_, value)| value.is_finite()));
}

/// X-8, F-39
#[test]
fn a_creature_that_blows_up_ends_with_its_step_and_no_fitness() {
    let slow = FlyerTask { blow_up_speed: 5.0, ..FlyerTask::default() };
    let outcome = live(&slow, &faller());
    assert_eq!((outcome.status, outcome.fitness), (Status::Aborted(Reason::BlowUp), 0.0));
    assert!(outcome.note.ends_with(&format!("at step {}", outcome.steps)), "{}", outcome.note);
    assert_eq!(measure(&outcome, "hover_steps"), Some(f64::from(outcome.steps - 1)));

    // Thick air and long steps throw everything about without bounds.
    let wild = FlyerTask { alpha: 1e3, dt: 1.0, blow_up_speed: 1e6, ..FlyerTask::default() };
    let aborted = (0..40).map(|place| live(&wild, &founder(place))).filter(|outcome| outcome.steps > 0);
    for outcome in aborted {
        assert!(matches!(outcome.status, Status::Aborted(_)), "{outcome:?}");
        assert_eq!(outcome.fitness, 0.0);
        assert!(outcome.measures.iter().all(|(_, value)| value.is_finite()), "{outcome:?}");
    }
}

///
#[test]
fn a_creature_that_starts_below_the_ground_lands_at_once() {
    let outcome = live(&FlyerTask { start_height: 0.0, ..FlyerTask::default() }, &faller());
    assert_eq!((outcome.status, outcome.steps), (Status::Completed, 1));
    assert_eq!((outcome.fitness, measure(&outcome, "landed")), (1.0, Some(1.0)));
}

///
#[test]
fn a_creature_without_film_or_air_is_legal() {
    let bare = creature((30.0, 2.0), 70.0, &[wing(40.0, 0, 10.0, 0.0)]);
    let outcome = live(&FlyerTask::default(), &bare);
    assert_eq!((outcome.status, measure(&outcome, "span")), (Status::Completed, Some(0.0)));
    let vacuum = live(&FlyerTask { alpha: 0.0, ..FlyerTask::default() }, &faller());
    assert_eq!((vacuum.status, measure(&vacuum, "landed")), (Status::Completed, Some(1.0)));
    assert!(measure(&vacuum, "distance").unwrap() < 1e-6, "the way down is no distance (F-52)");
}

/// F-70
#[test]
fn a_beat_is_two_crossings_of_the_mean() {
    let wave = |k: u32| 0.3 + 0.2 * crate::math::sin(std::f64::consts::TAU * (f64::from(k) + 0.25) / 40.0);
    let angles: Vec<f64> = (0..400).map(wave).collect();
    assert_eq!(beat(&angles, 20.0), 19.0 / 40.0, "ten periods have nineteen crossings inside them");
    let still: Vec<f64> = (0..400).map(|k| 0.3 + f64::from(k % 2) * 1e-15).collect();
    assert_eq!((beat(&still, 20.0), beat(&[], 0.0)), (0.0, 0.0));
}

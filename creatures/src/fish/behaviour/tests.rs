use super::*;
use crate::fish::Body;
use crate::fish::motor::Turn;
use crate::fish::perception::tests::Pond;
use crate::fish::perception::{Hazard, Percept, Preferences};
use crate::fish::world::Obstacle;
use glam::DVec3;

/// The positions of the pond's first fish.
fn positions() -> Vec<DVec3> {
    Body::published(1.0).rest.iter().map(|&node| node - DVec3::Y * 6.0).collect()
}

fn bias(command: &Command) -> f64 {
    match command.turn {
        Turn::Bias(bias) => bias,
        Turn::Angle(_) => panic!("routines turn step by step"),
    }
}

fn avoiding(pond: &Pond, avoid: Preferences) -> Command {
    let positions = positions();
    pond.senses(0, |senses| {
        let posture = Posture::new(&positions);
        match Hazard::of(senses, crate::fish::mind::Intention::Wander, None, &mut Vec::new()).unwrap() {
            Hazard::Surface(surface) => super::avoid::surface(senses, &posture, &surface, avoid),
            Hazard::Fish(id) => super::avoid::fish(senses, &senses.fish(id).unwrap(), avoid),
        }
    })
}

///
#[test]
fn obstacles_are_turned_from_and_climbed_over_if_there_is_no_side() {
    let mut pond = Pond::with_eye_at_origin();
    let free = Preferences::default();
    for (x, side) in [(-3.0, -1.0), (3.0, 1.0), (0.0, 1.0)] {
        pond.obstacles = vec![Obstacle::Sphere { center: [x, 18.0, 0.0], radius: 5.0 }];
        assert!(bias(&avoiding(&pond, free)) * side > 0.7, "{x}");
    }
    let no_left = Preferences { no_left: true, ..free };
    assert!(bias(&avoiding(&pond, no_left)) < 0.0, "dead ahead and no way to the left");
    let neither = Preferences { no_right: true, ..no_left };
    assert_eq!(avoiding(&pond, neither).fins.left, super::super::fins::ASCENT);
    let down = Preferences { no_up: true, ..neither };
    assert_eq!(avoiding(&pond, down).fins.left, super::super::fins::DESCENT);
    pond.obstacles = vec![Obstacle::Sphere { center: [0.0, 9.0, 0.0], radius: 5.0 }];
    assert_eq!(avoiding(&pond, neither).fins.left, super::super::fins::BRAKE);
}

///
#[test]
fn a_fish_that_crosses_is_passed_astern() {
    let mut pond = Pond::with_eye_at_origin();
    pond.add(DVec3::new(0.0, 25.0, 1.0), 0.0);
    for (velocity, side) in [(1.0, 1.0), (-1.0, -1.0), (0.0, 1.0)] {
        pond.figures[1].velocity = DVec3::X * velocity;
        let command = avoiding(&pond, Preferences::default());
        assert!(bias(&command) * side > 0.7 && command.swim == 0.8, "{velocity}");
        assert!(command.fins.left < super::super::fins::NEUTRAL, "it is above");
    }
}

/// A-73, AF-9
#[test]
fn prey_flee_from_the_side_of_the_predator_and_straight_on_from_behind() {
    let mut pond = Pond::with_eye_at_origin();
    let flee = |pond: &mut Pond, place: DVec3| {
        pond.figures.truncate(1);
        pond.habits.truncate(1);
        pond.add(place - DVec3::Y * (1.0 / 3.0), 0.0);
        pond.senses(0, |senses| escape::from(senses, &Percept::new(senses.me, &senses.scene.figures[1])))
    };
    assert!(bias(&flee(&mut pond, DVec3::new(-30.0, 10.0, 0.0))) < -0.7);
    assert!(bias(&flee(&mut pond, DVec3::new(30.0, 10.0, 0.0))) > 0.7);
    assert_eq!(bias(&flee(&mut pond, DVec3::new(5.0, -60.0, 0.0))), 0.0);
    assert!(flee(&mut pond, DVec3::new(0.0, -60.0, 20.0)).fins.left < super::super::fins::NEUTRAL);
    let swallowed = flee(&mut pond, DVec3::ZERO);
    assert!(bias(&swallowed).is_finite() && swallowed.fins.left.is_finite());
}

///
#[test]
fn a_school_is_joined_kept_and_not_crowded() {
    let positions = positions();
    let school = |places: &[(f64, f64)]| {
        let mut pond = Pond::with_eye_at_origin();
        for &(x, y) in places {
            pond.add(DVec3::new(x, y - 6.0, 0.0), 0.0);
        }
        pond.senses(0, |senses| {
            super::school::keep(senses, &mut Chase::default(), &Posture::new(&positions), &mut Vec::new())
        })
    };
    assert!(school(&[]).is_none());
    let joins = school(&[(60.0, 60.0), (60.0, 90.0)]).unwrap();
    assert!(joins.swim == 1.0 && bias(&joins) < 0.0, "makes for the one ahead");
    let keeps = school(&[(20.0, 0.0), (-20.0, 0.0)]).unwrap();
    assert!((keeps.swim - 0.7).abs() < 1e-9 && bias(&keeps).abs() < 1e-9, "{keeps:?}");
    let behind = school(&[(20.0, 20.0), (-20.0, 20.0)]).unwrap();
    assert!((behind.swim - 1.0).abs() < 1e-9, "{}", behind.swim);
    let crowded = school(&[(-10.0, 0.0)]).unwrap();
    assert!(crowded.swim <= 0.6 && bias(&crowded) < 0.0);
    let offset = school(&[(-35.0, 0.0)]).unwrap();
    assert!(bias(&offset) > 0.0, "more than a body length aside it closes up");
}

///
#[test]
fn wandering_turns_now_and_then_and_leaving_goes_where_it_is_better() {
    let positions = positions();
    let posture = Posture::new(&positions);
    let draws = || crate::random::stream(1, [0, 0, 0], "wander");
    let mut wander = Wander::new(draws());
    let mut turns = 0;
    let mut last = f64::NAN;
    for step in 0..2000 {
        let command = wander.about(&posture, 0.1 * f64::from(step), 0.5);
        turns += u32::from(bias(&command) != last);
        last = bias(&command);
        assert!(last.abs() <= 0.75 && command.swim == 0.5);
    }
    assert!((10..=25).contains(&turns), "200 time units have 10 to 25 legs: {turns}");
    let mut pond = Pond::with_eye_at_origin();
    let blob = |x| crate::fish::world::climate::Blob { center: [x, 0.0, 0.0], width: 50.0, excess: 5.0 };
    pond.habits[0].temperature_min = 30.0;
    for (x, side) in [(-40.0, 1.0), (40.0, -1.0)] {
        pond.climate.blobs = vec![blob(x)];
        let command = pond.senses(0, |senses| {
            assert!(!senses.comfortable());
            Wander::new(draws()).leave(senses, &posture, 0.0)
        });
        assert!(bias(&command) * side > 0.7, "{x}: toward the warmth");
    }
}

use super::*;
use crate::esp::brain::{NodeKind, Source};
use crate::esp::fitness::tests::context;
use crate::esp::sample;
use crate::esp::syllabus::SkillId;
use crate::esp::trial::tests::{Broken, Puppet, driven};
use crate::record::{Keeper, Pose, Shape};
use crate::{Nobody, System};
use serde_json::json;

fn script(points: &[[f64; 3]]) -> LightScript {
    let point = |&[at, ahead, left]: &[f64; 3]| WayPoint { at, ahead, left };
    LightScript { height: 0.5, strength: 0.3, point: points.iter().map(point).collect() }
}

#[test]
fn a_light_goes_straight_from_point_to_point() {
    let script = script(&[[0.0, 4.0, 0.0], [2.0, 4.0, 6.0], [3.0, 0.0, 6.0]]);
    let place = |seconds| script.position(seconds).to_array();
    assert_eq!([place(0.0), place(1.0)], [[4.0, 0.0, 0.5], [4.0, 3.0, 0.5]]);
    assert_eq!([place(2.0), place(2.75), place(9.0)], [[4.0, 6.0, 0.5], [1.0, 6.0, 0.5], [0.0, 6.0, 0.5]]);
    assert_eq!(script.seconds(), 3.0);
}

#[test]
fn what_is_no_path_is_refused_by_its_key() {
    let path = |points: &[[f64; 3]]| script(points).check().map_err(|error| error.to_string());
    assert_eq!(path(&[[0.0, 1.0, 1.0], [1.0, 1.0, 1.0]]), Ok(()));
    for (points, key, word) in [
        (&[[0.0, 1.0, 1.0]][..], "point", "two points"),
        (&[[1.0, 1.0, 1.0], [2.0, 1.0, 1.0]], "point[0].at", "at 0 s"),
        (&[[0.0, 1.0, 1.0], [2.0, 1.0, 1.0], [2.0, 0.0, 0.0]], "point[2].at", "not later"),
        (&[[0.0, 1.0, 1.0], [601.0, 1.0, 1.0]], "point[1].at", "[0, 600]"),
        (&[[0.0, 1.0, f64::NAN], [1.0, 1.0, 1.0]], "point[0].left", "NaN"),
        (&[[0.0, 1001.0, 0.0], [1.0, 1.0, 1.0]], "point[0].ahead", "1000"),
    ] {
        let problem = path(points).unwrap_err();
        assert!(problem.contains(key) && problem.contains(word), "{problem}");
    }
    let read = |table| LightScript::read(table).map_err(|error| error.to_string());
    assert!(read(json!({ "point": [] })).unwrap_err().contains("two points"), "what is read is checked");
    assert!(read(json!({ "point": [{ "at": 0, "ahead": 1 }] })).unwrap_err().contains("left"));
    let dark = LightScript { strength: -1.0, ..script(&[[0.0, 1.0, 1.0], [1.0, 1.0, 1.0]]) };
    assert!(dark.check().unwrap_err().to_string().contains("strength"));
}

/// A puppet that turns to the side that is brighter keeps a light in view that goes round it.
#[test]
fn who_turns_to_the_light_keeps_looking_at_it() {
    let photo = |gene| Some(Source::Photo(crate::esp::brain::tests::key(gene)));
    let kinds =
        [NodeKind::Constant { value: 0.0 }, NodeKind::Scale { factor: 4.0 }, NodeKind::Scale { factor: 4.0 }];
    let brain = driven(kinds, [None, photo(3), photo(4)]);
    let context = context();
    let forced = [Forced { skill: SkillId(0), sigma: 1.0 }];
    let mut circuit = Circuit::new(&brain, &Puppet::body(), context.syllabus, &forced);
    let script = script(&[[0.0, 5.0, 0.0], [4.0, 0.0, 5.0], [8.0, -5.0, 0.0]]);
    let mut keeper = Keeper::new(0, 1);
    let mut show = Show { observer: &mut keeper, number: 0 };
    // Turned and moved away, so that the script's frame is the creature's and not the world's.
    let (seen, fault) = follow(&mut Puppet::at(3.0, -2.0, 1.0), &mut circuit, &script, &mut show);
    assert_eq!((seen.len(), fault), (481, None));
    assert!(seen.iter().all(|one| one.heading_error_degrees.abs() < 20.0));
    let last = seen[480];
    assert!((last.distance - 5.0).abs() < 1e-9 && (last.light[0] + 5.0).abs() < 1e-9, "{last:?}");
    let recording = keeper.recording().unwrap();
    assert_eq!(recording.scene.parts[1].shapes, [Shape::Light { strength: 0.3 }]);
    let Pose::Rigid { position, .. } = recording.shots[480].frame.poses[1] else {
        panic!("a light is rigid")
    };
    assert!(((position - DVec3::new(3.0, -2.0, 0.5)).length() - 5.0).abs() < 1e-9, "{position}");
}

#[test]
fn a_light_to_the_left_is_a_positive_error_and_a_fault_ends_it() {
    let silent = driven([NodeKind::Constant { value: 0.0 }; 3], [None, None, None]);
    let context = context();
    let mut circuit = Circuit::new(&silent, &Puppet::body(), context.syllabus, &[]);
    let mut nobody = Nobody;
    let mut show = Show { observer: &mut nobody, number: 0 };
    let mut puppet = Puppet { breaks: Some(30), ..Puppet::at(0.0, 0.0, 0.0) };
    let script = script(&[[0.0, 0.0, 2.0], [1.0, 0.0, -2.0]]);
    let (seen, fault) = follow(&mut puppet, &mut circuit, &script, &mut show);
    assert_eq!((seen.len(), fault), (31, Some(Broken(30))));
    assert!((seen[0].heading_error_degrees - 90.0).abs() < 1e-9 && (seen[0].distance - 2.0).abs() < 1e-9);
}

#[test]
fn a_real_creature_shows_a_skill_that_it_has_and_no_other() {
    let fitness = json!({ "kind": "locomotion" });
    let task = json!({ "skill": [{ "id": "walk", "fitness": fitness }, { "id": "run", "fitness": fitness }],
        "tests": [{ "skill": "walk" }] });
    let task: crate::esp::TaskTable = serde_json::from_value(crate::esp::Esp.resolve(task).unwrap()).unwrap();
    let (task, genotype) = (task.check().unwrap(), sample::seeker().encode());
    let script = script(&[[0.0, 3.0, 0.0], [1.0, 3.0, 3.0]]);
    let watched = |skill| {
        let mut keeper = Keeper::new(0, 1);
        let shown = task.demonstrate(&genotype, skill, &script, &mut keeper).unwrap();
        (shown, keeper.recording().unwrap())
    };
    let (shown, recording) = watched(None);
    assert_eq!((shown.skill.as_str(), shown.sightings.len(), shown.fault), ("walk", 61, None));
    // Again, by its name, and unseen: the same to the bit.
    let digits = |shown: &Demonstration| serde_json::to_string(&shown.sightings).unwrap();
    let again = watched(Some("walk"));
    assert_eq!((digits(&again.0), &again.1), (digits(&shown), &recording));
    let unseen = task.demonstrate(&genotype, None, &script, &mut Nobody).unwrap();
    assert_eq!(digits(&unseen), digits(&shown));
    // Its eyes see the script's light: it goes another way under another one.
    let dark = LightScript { strength: 0.0, ..script.clone() };
    let dark = task.demonstrate(&genotype, None, &dark, &mut Nobody).unwrap();
    assert_ne!(dark.sightings[60].creature, shown.sightings[60].creature);
    for (skill, word) in [("run", "not learned `run`"), ("wlak", "did you mean `walk`")] {
        let error = task.demonstrate(&genotype, Some(skill), &script, &mut Nobody).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
    assert!(task.demonstrate(&[1, 2], None, &script, &mut Nobody).is_err());
}

//! What is seen of every system's lives: the proofs of the fingerprint, watched.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use creatures::record::{Frame, Header, Keeper, Pose, Recording, Scene, Shape, Shot, Subject};
use creatures::{Nobody, Observer, Outcome, Proof, System, systems};

/// Lives a proof and records a trial of it.
fn watched(system: &dyn System, proof: &Proof, every: u32) -> (Outcome, Option<Recording>) {
    let task = system.task(&proof.task).unwrap();
    let mut keeper = Keeper::new(0, every);
    let outcome = task.evaluate(&proof.genotype, proof.seed, None, &mut keeper).unwrap();
    (outcome, keeper.recording())
}

fn proofs() -> impl Iterator<Item = (&'static dyn System, Proof)> {
    systems().into_iter().flat_map(|system| system.proofs().into_iter().map(move |proof| (system, proof)))
}

#[test]
fn who_is_watched_comes_to_the_same_outcome() {
    for (system, proof) in proofs() {
        let task = system.task(&proof.task).unwrap();
        let unseen = task.evaluate(&proof.genotype, proof.seed, None, &mut Nobody).unwrap();
        assert_eq!(
            watched(system, &proof, 1).0.digest(),
            unseen.digest(),
            "{} {}",
            system.name(),
            proof.task
        );
    }
}

/// Counts what there is to see of all trials.
#[derive(Default)]
struct Tally {
    trials: u32,
    frames: u32,
}

impl Observer for Tally {
    fn trial(&mut self, number: u32, _scene: &dyn Fn() -> Scene) {
        assert_eq!(number, self.trials, "trials are numbered from 0");
        self.trials += 1;
    }

    fn frame(&mut self, _time: f64, _frame: &dyn Fn() -> Frame) {
        self.frames += 1;
    }
}

#[test]
fn every_creature_is_seen_from_its_start_to_its_last_step() {
    for (system, proof) in proofs().filter(|(system, _)| system.name() != "probe") {
        let (outcome, recording) = watched(system, &proof, 1);
        let Recording { scene, shots } = recording.expect("every creature has a body");
        let what = format!("{} {}", system.name(), proof.task);
        assert!(scene.up.is_normalized() && scene.forward.is_normalized(), "{what}");
        assert!(scene.up.dot(scene.forward).abs() < 1e-9, "{what}");
        let mut tally = Tally::default();
        let task = system.task(&proof.task).unwrap();
        task.evaluate(&proof.genotype, proof.seed, None, &mut tally).unwrap();
        assert_eq!(tally.frames, tally.trials + outcome.steps, "a start each, and every step: {what}");
        assert!(shots.len() as u32 <= tally.frames && !shots.is_empty(), "{what}");
        for (step, shot) in (0..).zip(&shots) {
            assert!((shot.time - f64::from(step) * scene.step).abs() < 1e-9, "{what} at {}", shot.time);
            assert_eq!(shot.frame.poses.len(), scene.parts.len(), "{what}");
            assert_eq!(shot.frame.centers.len(), scene.creatures.len(), "{what}");
            for contracted in &shot.frame.muscles {
                assert_eq!(contracted.len(), scene.muscles.len(), "{what}");
            }
        }
        let moved = shots.first().unwrap().frame != shots.last().unwrap().frame;
        assert!(moved, "{what}");
    }
}

/// A skin has nodes at all its corners, everything else has one place and one attitude.
#[test]
fn poses_are_of_the_kind_that_their_shapes_need() {
    for (system, proof) in proofs() {
        let Some(Recording { scene, shots }) = watched(system, &proof, 7).1 else { continue };
        for (part, pose) in shots.iter().flat_map(|shot| scene.parts.iter().zip(&shot.frame.poses)) {
            for shape in &part.shapes {
                match (shape, pose) {
                    (_, Pose::Absent) => {}
                    (Shape::Skin { triangles }, Pose::Nodes(nodes)) => {
                        assert!(triangles.iter().flatten().all(|&node| (node as usize) < nodes.len()));
                    }
                    (Shape::Skin { .. }, _) | (_, Pose::Nodes(_)) => panic!("{}: {shape:?}", part.name),
                    (_, Pose::Rigid { position, orientation }) => {
                        assert!(position.is_finite() && (orientation.length() - 1.0).abs() < 1e-6);
                    }
                }
            }
        }
    }
}

#[test]
fn a_recording_reads_back_to_the_same_bits() {
    for (system, proof) in proofs() {
        let Some(recording) = watched(system, &proof, 5).1 else { continue };
        let subject = Subject {
            system: system.name().to_owned(),
            version: system.version(),
            individual: 4711,
            task: serde_json::from_str(&proof.task).unwrap(),
            seed: u64::MAX,
            trial: 1,
            light: None,
        };
        let mut lines = recording.lines(&subject);
        let header: Header = serde_json::from_str(&lines.next().unwrap()).unwrap();
        let shots: Vec<Shot> = lines.map(|line| serde_json::from_str(&line).unwrap()).collect();
        assert_eq!((header.subject, header.frames), (subject, shots.len()));
        assert_eq!(Recording { scene: header.scene, shots }, recording, "{} {}", system.name(), proof.task);
    }
}

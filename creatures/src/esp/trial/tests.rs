//! Trials of a puppet: a point on wheels whose muscles are its motors, so that what is recorded of it is known.

use super::*;
use crate::esp::brain::tests::key;
use crate::esp::brain::{Brain, Control, Forced, Instances, Node, NodeKind, Output, Seal, Source};
use crate::esp::fitness::tests::context;
use crate::esp::fitness::{End, Form, Start};
use crate::esp::syllabus::SkillId;
use crate::{Nobody, Observer};
use std::f64::consts::PI;

/// Muscle 0 drives it ahead at 1 m/s, muscle 1 turns it left and muscle 2 right at π/2 rad/s. Its receptors look
/// to the left and to the right. Muscle 0 is three times as strong as the others.
#[derive(Debug, Clone)]
pub(in crate::esp) struct Puppet {
    pub(in crate::esp) state: State,
    /// The step at which it breaks.
    pub(in crate::esp) breaks: Option<usize>,
    pub(in crate::esp) discs: Option<(DVec3, usize)>,
    pub(in crate::esp) steps: usize,
}

#[derive(Debug, PartialEq, Eq)]
pub(in crate::esp) struct Broken(pub(in crate::esp) usize);

impl Puppet {
    pub(in crate::esp) fn at(x: f64, y: f64, heading: f64) -> Puppet {
        let state = State { centre: DVec3::new(x, y, 0.4), heading, up: 1.0, top: 0.8, ..State::default() };
        Puppet { state, breaks: None, discs: None, steps: 0 }
    }

    pub(in crate::esp) fn body() -> Instances {
        Instances { muscles: vec![key(0), key(1), key(2)], photos: vec![key(3), key(4)] }
    }
}

impl Living for Puppet {
    type Fault = Broken;

    fn strengths(&self) -> &[f64] {
        &[300.0, 100.0, 100.0]
    }

    fn weight(&self) -> f64 {
        200.0
    }

    fn state(&self) -> State {
        self.state
    }

    fn place_discs(&mut self, centre: DVec3, count: usize) {
        self.discs = Some((centre, count));
    }

    fn feel(&self, lengths: &mut [f64]) {
        lengths.copy_from_slice(&[0.1, 0.2, 0.3]);
    }

    fn see(&self, lights: &[Light], signals: &mut [f64]) {
        for (signal, side) in signals.iter_mut().zip([1.0, -1.0]) {
            let seen = lights.iter().map(|light| {
                let way = light.position - self.state.centre;
                let angle = wrap_angle(atan2(way.y, way.x) - self.state.heading);
                if angle * side > 1e-3 { light.strength } else { 0.0 }
            });
            *signal = seen.sum();
        }
    }

    fn step(&mut self, activations: &[f64]) -> Result<(), Broken> {
        if self.breaks == Some(self.steps) {
            return Err(Broken(self.steps));
        }
        self.steps += 1;
        let [ahead, left, right] = *activations else { panic!("three muscles") };
        self.state.heading = wrap_angle(self.state.heading + 0.5 * PI * (left - right) * TICK);
        self.state.velocity = ahead * DVec3::new(cos(self.state.heading), sin(self.state.heading), 0.0);
        self.state.centre += TICK * self.state.velocity;
        self.state.ground_force = 200.0;
        if let Some((centre, count)) = self.discs {
            self.state.touches = count > 0 && (self.state.centre - centre).with_z(0.0).length() < 0.25;
        }
        Ok(())
    }

    fn scene(&self) -> Scene {
        let point = Part { name: "point".to_owned(), creature: Some(0), shapes: vec![Shape::Point] };
        Scene {
            length_unit: "m".to_owned(),
            time_unit: "s".to_owned(),
            step: TICK,
            up: DVec3::Z,
            forward: DVec3::X,
            creatures: vec!["puppet".to_owned()],
            parts: vec![point],
            props: Vec::new(),
            muscles: vec![],
            cords: vec![],
        }
    }

    fn frame(&self) -> Frame {
        Frame {
            centers: vec![self.state.centre],
            poses: vec![Pose::at(self.state.centre)],
            ..Frame::default()
        }
    }
}

/// An open control of the first skill that drives the three muscles from three nodes.
pub(in crate::esp) fn driven(nodes: [NodeKind; 3], inputs: [Option<Source>; 3]) -> Brain {
    let nodes = nodes.into_iter().zip(inputs).map(|(kind, input)| {
        let mut node = Node { kind, inputs: vec![input] };
        node.inputs.truncate(kind.slots());
        node.trim();
        node
    });
    let outputs =
        (0..3).map(|at| Output { node: at, target: crate::esp::brain::Target::Muscle(key(u32::from(at))) });
    let outputs = outputs.collect();
    Brain { controls: vec![Control { skill: SkillId(0), seal: Seal::Open, nodes: nodes.collect(), outputs }] }
}

/// Muscles at constant activations.
pub(in crate::esp) fn constant(activations: [f64; 3]) -> Brain {
    driven(activations.map(|value| NodeKind::Constant { value }), [None, None, None])
}

/// A brain that turns to the side on which it sees a light, and goes ahead at the same time.
pub(in crate::esp) fn seeker() -> Brain {
    let see = |photo| Some(Source::Photo(key(photo)));
    let ahead = NodeKind::Constant { value: 0.5 };
    driven([ahead, NodeKind::Scale { factor: 4.0 }, NodeKind::Scale { factor: 4.0 }], [None, see(3), see(4)])
}

fn record(brain: &Brain, creature: &mut Puppet, setup: &Setup) -> (Record, Result<(), Broken>) {
    let forced = [Forced { skill: SkillId(0), sigma: 1.0 }];
    let mut circuit = Circuit::new(brain, &Puppet::body(), context().syllabus, &forced);
    let mut record = Record::default();
    let mut show = Show { observer: &mut Nobody, number: 0 };
    let end = live(creature, &mut circuit, setup, &mut record, &mut show);
    (record, end)
}

fn setup(target: Option<Target>, end: End) -> Setup {
    Setup { seconds: 4.0, start: Start::Rest, target, end }
}

/// E-20, E-80: the frame is that of the settled creature, wherever it stands and faces. The first tick is silent.
#[test]
fn positions_and_headings_are_from_where_it_settled() {
    for (x, y, heading) in [(0.0, 0.0, 0.0), (3.0, -7.0, 2.5)] {
        let light = Target::new(Form::Light, 90.0, 5.0);
        let (record, end) = record(
            &constant([0.5, 0.0, 0.0]),
            &mut Puppet::at(x, y, heading),
            &setup(Some(light), End::Never),
        );
        assert_eq!((end, record.moments.len(), record.ended), (Ok(()), 241, false));
        let (first, last) = (record.moments[0], record.last());
        assert!((first.position - DVec3::new(0.0, 0.0, 0.4)).length() < 1e-9);
        assert!((first.light_distance - 5.0).abs() < 1e-9 && (first.light_angle - 0.5 * PI).abs() < 1e-9);
        let way = 0.5 * 239.0 * TICK;
        assert!((last.position - DVec3::new(way, 0.0, 0.4)).length() < 1e-9, "{}", last.position);
        assert!((last.light_distance - (25.0 + way * way).sqrt()).abs() < 1e-9);
        assert!((last.light_angle - (0.5 * PI + atan2(way, 5.0))).abs() < 1e-9);
        assert!((last.speed - 0.5).abs() < 1e-9 && last.yaw.abs() < 1e-9);
        assert_eq!((last.up, last.top, last.ground_force), (1.0, 0.8, 1.0));
    }
}

/// E-70: three fifths of the strength at half activation.
#[test]
fn effort_is_weighted_by_strength() {
    let (record, _) =
        record(&constant([0.5, 0.0, 0.25]), &mut Puppet::at(0.0, 0.0, 0.0), &setup(None, End::Never));
    assert!(record.has_muscles);
    assert_eq!((record.moments[1].effort, record.moments[2].effort), (0.0, 0.35));
    assert_eq!((record.last().light_distance, record.last().light_angle), (0.0, 0.0));
}

/// E-71: more than one turn, either way round, across the seam of the angle.
#[test]
fn turns_are_unwrapped() {
    for (activations, sign) in [([0.0, 1.0, 0.0], 1.0), ([0.0, 0.0, 1.0], -1.0)] {
        let setup = Setup { seconds: 10.0, ..setup(None, End::Never) };
        let (record, _) = record(&constant(activations), &mut Puppet::at(0.0, 0.0, 3.0), &setup);
        let expected = sign * 0.5 * PI * 599.0 * TICK;
        assert!((record.last().yaw - expected).abs() < 1e-9, "{} is not {expected}", record.last().yaw);
    }
}

/// The brain sees the light where it is, through its receptors.
#[test]
fn a_seeker_faces_the_light_and_gets_there() {
    for heading in [135.0, -135.0] {
        let light = Target::new(Form::Light, heading, 2.0);
        let long = Setup { seconds: 30.0, ..setup(Some(light), End::Within(0.2)) };
        let (record, _) = record(&seeker(), &mut Puppet::at(1.0, 2.0, -2.0), &long);
        assert!(record.ended && record.last().light_distance < 0.2, "{heading}: {:?}", record.last());
    }
}

/// E-78
#[test]
fn discs_stand_where_the_target_is_and_are_touched() {
    let target = |form| Some(Target::new(form, 0.0, 1.0));
    for (form, discs) in [(Form::Light, 0), (Form::Disc, 1), (Form::Stack, 3)] {
        let mut creature = Puppet::at(1.0, 1.0, 0.5 * PI);
        let (record, _) = record(&constant([1.0, 0.0, 0.0]), &mut creature, &setup(target(form), End::Touch));
        let (centre, count) = creature.discs.unwrap();
        assert!((centre - DVec3::new(1.0, 2.0, 0.0)).length() < 1e-9 && count == discs);
        assert_eq!(record.ended, discs > 0);
        if discs > 0 {
            assert!((record.last().light_distance - 0.25).abs() < TICK + 1e-9);
        }
    }
}

/// E-23
#[test]
fn a_fault_ends_a_trial_where_it_is() {
    let mut creature = Puppet { breaks: Some(7), ..Puppet::at(0.0, 0.0, 0.0) };
    let (record, end) = record(&constant([1.0; 3]), &mut creature, &setup(None, End::Never));
    assert_eq!((end, record.lived().len()), (Err(Broken(7)), 7));
}

/// Who watches sees every step, and the lights where they are.
#[test]
fn a_trial_can_be_watched() {
    #[derive(Default)]
    struct Watcher {
        trials: Vec<(u32, usize)>,
        frames: Vec<(f64, Frame)>,
    }
    impl Observer for Watcher {
        fn trial(&mut self, number: u32, scene: &dyn Fn() -> Scene) {
            self.trials.push((number, scene().parts.len()));
        }
        fn frame(&mut self, time: f64, frame: &dyn Fn() -> Frame) {
            self.frames.push((time, frame()));
        }
    }
    let mut watcher = Watcher::default();
    let forced = [Forced { skill: SkillId(0), sigma: 1.0 }];
    let circuit = Circuit::new(&constant([1.0, 0.0, 0.0]), &Puppet::body(), context().syllabus, &forced);
    let setup = setup(Some(Target::new(Form::Stack, 0.0, 2.0)), End::Never);
    let mut show = Show { observer: &mut watcher, number: 4 };
    for _ in 0..2 {
        let mut creature = Puppet::at(0.0, 0.0, 0.0);
        live(&mut creature, &mut circuit.clone(), &setup, &mut Record::default(), &mut show).unwrap();
    }
    assert_eq!(watcher.trials, [(4, 4), (5, 4)], "a point and three lights");
    assert_eq!(watcher.frames.len(), 2 * 241);
    let (time, frame) = &watcher.frames[15];
    assert!((time - 0.25).abs() < 1e-12 && frame.centers[0].x > 0.2);
    let light = setup.target.unwrap().light(0, 0.25);
    assert_eq!((frame.poses.len(), &frame.poses[1]), (4, &Pose::at(light)));
}

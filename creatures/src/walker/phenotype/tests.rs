//! The bodies as they start, at rest (T-18), under open-loop commands (T-19), and their bits (T-20).

use super::*;
use crate::math::{floor, sin};
use std::f64::consts::{PI, TAU};

/// Control steps of 1/60 s in 7.5 s.
const CONTROLS: u32 = 450;

/// Runs a body for 7.5 s at a physics rate under commands given by time; `observe` sees every control step.
fn run(
    body: BodyKind,
    physics_hz: u32,
    commands: impl Fn(f64) -> Vec<f64>,
    mut observe: impl FnMut(u32, &mut Phenotype),
) -> Phenotype {
    let mut phenotype = Phenotype::develop(body, &Footing::default());
    for control in 0..CONTROLS {
        let clamped: Vec<f64> =
            commands(f64::from(control) / 60.0).into_iter().map(|c| c.clamp(-1.0, 1.0)).collect();
        assert_eq!(clamped.len(), body.degrees());
        phenotype.drive(&clamped);
        for _ in 0..physics_hz / 60 {
            phenotype.step(1.0 / f64::from(physics_hz)).unwrap();
        }
        observe(control + 1, &mut phenotype);
    }
    phenotype
}

/// T-19's commands, at time `t`, s. The arm's have other numbers: T-19's own count on joints that give
/// way under load; exact joints hold, and that arm rears up on its hands and falls on its back.
fn open_loop(body: BodyKind, t: f64) -> Vec<f64> {
    match body {
        BodyKind::Crawler => vec![1.0, 1.0],
        BodyKind::Arm => {
            let arm =
                |a: f64| [0.93 + 0.33 * sin(a), 0.11 + 0.15 * sin(a + 5.5), -0.22 + 0.15 * sin(a + 0.75)];
            let a = TAU * 2.59 * t;
            [arm(a), arm(a + PI)].concat()
        }
        BodyKind::Hopper => {
            let phase = 3.26 * t;
            let hip = -0.40 + 0.52 * sin(TAU * phase + 4.27);
            let leg = if phase - floor(phase) < 0.29 { 1.0 } else { -1.0 };
            vec![hip, leg, hip, leg]
        }
        BodyKind::Runner => {
            let a = TAU * 3.86 * t;
            let (y, z) = (0.6 * crate::math::cos(a + 4.52) + 0.3, 0.73 * sin(a));
            vec![0.88, -y, -z, 0.88, y, z]
        }
    }
}

fn readings(phenotype: &mut Phenotype, body: BodyKind) -> Vec<f64> {
    let mut readings = vec![f64::NAN; body.inputs()];
    phenotype.sense(&mut readings).unwrap();
    readings
}

/// G-51, G-52: every sensor reads the start pose; sliders are retracted; the lowest point is 1 mm up.
#[test]
fn a_body_starts_at_rest_in_its_start_pose() {
    for body in BodyKind::ALL {
        let mut phenotype = Phenotype::develop(body, &Footing::default());
        let readings = readings(&mut phenotype, body);
        let expected = phenotype.joints.iter().flat_map(|actuator| match actuator.drive {
            Drive::Slider => vec![0.0],
            drive => vec![0.5; drive.degrees()],
        });
        let expected: Vec<f64> = expected.chain([0.5; 6]).collect();
        let (still, rest) = readings.split_at(expected.len());
        for (found, expected) in still.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{body:?}: {still:?}");
        }
        assert_eq!(rest[1], 0.5, "faces straight ahead");
        let world = phenotype.world();
        let height = world.position(phenotype.torso()).z;
        let [crawler, arm, hopper, runner] = [0.026, 0.021, 0.151, 0.021];
        let expected = match body {
            BodyKind::Crawler => crawler,
            BodyKind::Arm => arm,
            BodyKind::Hopper => hopper,
            BodyKind::Runner => runner,
        };
        assert!((height - expected).abs() < 1e-12, "{body:?} starts at {height} m");
        assert_eq!(world.position(phenotype.torso()).truncate(), glam::DVec2::ZERO);
        assert!(world.separation() < 1e-12);
    }
}

/// G-51: which limb is which.
#[test]
fn the_first_limb_is_on_the_right_where_x_is_negative() {
    for body in BodyKind::ALL {
        let phenotype = Phenotype::develop(body, &Footing::default());
        let [_, limbs @ ..] = phenotype.parts() else { panic!("a body has parts") };
        let (first, second) = limbs.split_at(limbs.len() / 2);
        for (right, left) in first.iter().zip(second) {
            let world = phenotype.world();
            let (right, left) = (world.position(*right), world.position(*left));
            assert!(right.x < 0.0 && left.x == -right.x && left.y == right.y && left.z == right.z);
        }
    }
}

/// G-52: a positive hinge command turns a forward-pointing arm downwards, a positive slider extends.
#[test]
fn positive_commands_flex() {
    let mut crawler = Phenotype::develop(BodyKind::Crawler, &Footing::default());
    let arm = crawler.parts()[1];
    crawler.drive(&[1.0, 1.0]);
    let before = crawler.world().position(arm).z - crawler.world().position(crawler.torso()).z;
    for _ in 0..6 {
        crawler.step(1.0 / 240.0).unwrap();
    }
    let after = crawler.world().position(arm).z - crawler.world().position(crawler.torso()).z;
    assert!(after < before - 0.002, "the arm went from {before} to {after}");
    let mut hopper = Phenotype::develop(BodyKind::Hopper, &Footing::default());
    hopper.drive(&[0.0, 1.0, 0.0, 1.0]);
    for _ in 0..48 {
        hopper.step(1.0 / 240.0).unwrap();
    }
    let readings = readings(&mut hopper, BodyKind::Hopper);
    assert!(readings[1] > 0.9 && readings[3] > 0.9, "{readings:?}");
}

/// T-18
#[test]
fn without_commands_a_body_rests_where_it_is() {
    let heights = [0.025, 0.020, 0.150, 0.021];
    let touches: [&[f64]; 4] = [&[1.0], &[1.0], &[0.0, 1.0, 1.0], &[1.0]];
    for ((body, height), touching) in BodyKind::ALL.into_iter().zip(heights).zip(touches) {
        let phenotype = run(
            body,
            240,
            |_| vec![0.0; body.degrees()],
            |control, phenotype| {
                if control == 60 {
                    let readings = readings(phenotype, body);
                    let first_touch = body.degrees() + 8;
                    assert_eq!(readings[first_touch..][..touching.len()], *touching, "{body:?}");
                    let found = phenotype.world().position(phenotype.torso()).z;
                    assert!((found - height).abs() < 0.0015, "{body:?} rests at {found} m");
                }
            },
        );
        let end = phenotype.world().position(phenotype.torso());
        assert!(end.x.abs() <= 0.02 && end.y.abs() <= 0.02, "{body:?} drifted to {end}");
    }
}

/// T-19, T-20: the published kind of motion at three step lengths, with joints that hold together.
#[test]
fn open_loop_commands_carry_every_body_forward_at_any_step_length() {
    let mut report = Vec::new();
    for body in BodyKind::ALL {
        for physics_hz in [120, 240, 480] {
            let mut separation = 0.0f64;
            let phenotype = run(
                body,
                physics_hz,
                |t| open_loop(body, t),
                |_, phenotype| {
                    separation = separation.max(phenotype.world().separation());
                },
            );
            let end = phenotype.world().position(phenotype.torso());
            report.push((body, physics_hz, -end.y, end.x, separation));
        }
    }
    for &(body, physics_hz, advance, _, separation) in &report {
        assert!(advance >= 1.0, "{body:?} at {physics_hz} Hz advances {advance} m: {report:#?}");
        assert!(physics_hz != 240 || separation <= 0.003, "{body:?} comes apart: {report:#?}");
    }
}

/// T-20
#[test]
fn a_body_moves_alike_alone_and_among_others() {
    let body = BodyKind::Arm;
    let pose = |phenotype: &Phenotype| {
        let world = phenotype.world();
        let bits = |part: &BodyId| {
            let (p, q) = (world.position(*part), world.orientation(*part));
            [p.x, p.y, p.z, q.x, q.y, q.z, q.w].map(f64::to_bits)
        };
        phenotype.parts().iter().map(bits).collect::<Vec<_>>()
    };
    let alone = run(body, 240, |t| open_loop(body, t), |_, _| {});
    let mut other = Phenotype::develop(BodyKind::Hopper, &Footing::default());
    let among = run(
        body,
        240,
        |t| open_loop(body, t),
        |control, _| {
            other.drive(&open_loop(BodyKind::Hopper, f64::from(control) / 60.0));
            other.step(1.0 / 240.0).unwrap();
        },
    );
    assert_eq!(pose(&alone), pose(&among));
}

#[test]
fn a_footing_out_of_range_is_named() {
    let bad = Footing { damping: f64::NAN, ..Footing::default() };
    assert_eq!(bad.check().unwrap_err().path, "damping");
    Footing::default().check().unwrap();
}

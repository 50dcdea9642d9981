//! Open-loop commands that carry each body, so that engines are measured on bodies in motion (walker T-19).

use std::f64::consts::TAU;

use creatures::walker::BodyKind;

/// The commands at a time in seconds, one a degree of freedom in the order of the joints, each within ±1.
pub fn open_loop(body: BodyKind, time: f64) -> Vec<f64> {
    let commands = match body {
        BodyKind::Crawler => vec![1.0, 1.0],
        BodyKind::Arm => {
            let a = TAU * 2.47 * time;
            let limb = |a: f64| [0.81 - 0.05 * a.sin(), -0.18 * (a + 1.09).sin(), -0.45 * (a + 4.07).sin()];
            [limb(a), limb(a + std::f64::consts::PI)].concat()
        }
        BodyKind::Hopper => {
            let cycles = 3.26 * time;
            let hip = -0.40 + 0.52 * (TAU * cycles + 4.27).sin();
            let slider = if cycles.fract() < 0.29 { 1.0 } else { -1.0 };
            vec![hip, slider, hip, slider]
        }
        BodyKind::Runner => {
            let a = TAU * 3.86 * time;
            let (y, z) = (0.6 * (a + 4.52).cos() + 0.3, 0.73 * a.sin());
            vec![0.88, -y, -z, 0.88, y, z]
        }
    };
    commands.into_iter().map(|command: f64| command.clamp(-1.0, 1.0)).collect()
}

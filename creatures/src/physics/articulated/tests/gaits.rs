//! Open-loop commands that carry the walkers of G-51 forwards (T-19), and wings that flap.

use super::articulated::{Motor, Settings};
use super::bodies::{self, Creature};
use libm::{cos, sin};
use std::f64::consts::{PI, TAU};

/// A walker with its commands as a function of time.
pub(super) struct Gait {
    pub(super) name: &'static str,
    pub(super) body: fn(Settings) -> Creature,
    pub(super) commands: fn(&mut Creature, f64),
}

pub(super) const ALL: [Gait; 4] = [
    Gait { name: "crawler", body: bodies::crawler, commands: crawl },
    Gait { name: "arm", body: bodies::arm, commands: pull },
    Gait { name: "hopper", body: bodies::hopper, commands: hop },
    Gait { name: "runner", body: bodies::runner, commands: run },
];

fn crawl(creature: &mut Creature, _: f64) {
    creature.command(0, 0, 1.0);
    creature.command(1, 0, 1.0);
}

/// Not T-19's command: that one counts on elbows that give way under load, as those of impulse joints do.
/// Exact elbows hold, and the arms lift the torso on its tail instead of passing beneath it.
fn pull(creature: &mut Creature, t: f64) {
    for (arm, phase) in [(0, 0.0), (3, PI)] {
        let a = TAU * 2.59 * t + phase;
        creature.command(arm, 0, 0.93 + 0.33 * sin(a));
        creature.command(arm + 1, 0, 0.11 + 0.15 * sin(a + 5.5));
        creature.command(arm + 2, 0, -0.22 + 0.15 * sin(a + 0.75));
    }
}

fn hop(creature: &mut Creature, t: f64) {
    let turns = 3.26 * t;
    let hip = -0.40 + 0.52 * sin(TAU * turns + 4.27);
    let leg = if turns - turns.floor() < 0.29 { 1.0 } else { -1.0 };
    for side in [0, 2] {
        creature.command(side, 0, hip);
        creature.command(side + 1, 0, leg);
    }
}

fn run(creature: &mut Creature, t: f64) {
    let a = TAU * 3.86 * t;
    let (y, z) = (0.6 * cos(a + 4.52) + 0.3, 0.73 * sin(a));
    for (arm, side) in [(0, -1.0), (1, 1.0)] {
        for (dof, command) in [0.88, side * y, side * z].into_iter().enumerate() {
            creature.command(arm, dof, command);
        }
    }
}

/// Beats a flyer's wings at 1/4 Hz, each segment a little later than the one before.
pub(super) fn flap(creature: &mut Creature, t: f64) {
    for (k, id) in creature.joints.clone().into_iter().enumerate() {
        for dof in 0..creature.world.degrees(id) {
            let rate = 2.0 * sin(TAU * 0.25 * t - 0.4 * (k % 4) as f64);
            creature.world.drive(id, dof, Motor { rate, effort: 300.0 });
        }
    }
}

//! The walkers' bodies at rest and under open-loop commands.

use super::bodies::{self, Creature};
use super::gaits;
use glam::DVec3;

/// Steps a creature for `seconds`, with commands at 60 Hz.
fn live(creature: &mut Creature, hz: u32, seconds: f64, commands: impl Fn(&mut Creature, f64)) -> f64 {
    let mut separation = 0.0_f64;
    for step in 0..(seconds * f64::from(hz)) as u32 {
        if step % (hz / 60) == 0 {
            commands(creature, f64::from(step) / f64::from(hz));
        }
        creature.world.step(1.0 / f64::from(hz)).unwrap();
        separation = separation.max(creature.world.separation());
    }
    separation
}

/// T-18.
#[test]
fn walkers_at_rest_stay_where_they_are() {
    for gait in gaits::ALL {
        let (height, torso_touches) = match gait.name {
            "crawler" => (0.025, true),
            "arm" => (0.020, true),
            "hopper" => (0.150, false),
            _ => (0.021, true),
        };
        let mut creature = (gait.body)(bodies::earth());
        let still = |creature: &mut Creature, _: f64| creature.command_all(|| 0.0);
        live(&mut creature, 240, 1.0, still);
        let world = &creature.world;
        assert_eq!(world.touches(creature.bodies[0], 0.001), torso_touches, "{}", gait.name);
        if gait.name == "hopper" {
            assert!([2, 4].iter().all(|&foot| world.touches(creature.bodies[foot], 0.001)));
        }
        assert!((creature.torso().z - height).abs() < 0.0015, "{}: {}", gait.name, creature.torso());
        live(&mut creature, 240, 6.5, still);
        let drift = creature.torso() - DVec3::Z * height;
        assert!(drift.truncate().abs().max_element() < 1e-4, "{}: {drift}", gait.name);
        assert!(creature.world.kinetic_energy() < 1e-20, "{}", gait.name);
    }
}

/// T-19, T-20.
#[test]
fn open_loop_commands_carry_every_walker_at_every_step_size() {
    for gait in gaits::ALL {
        for hz in [120, 240, 480] {
            let mut creature = (gait.body)(bodies::earth());
            let separation = live(&mut creature, hz, 7.5, gait.commands);
            let end = creature.torso();
            assert!(-end.y >= 1.0, "{} at {hz} Hz advanced {} m", gait.name, -end.y);
            assert!(hz != 240 || separation <= 0.003, "{}: joints {separation} m apart", gait.name);
        }
    }
}

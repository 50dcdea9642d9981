//! The same bits: in debug and release, alone and among others, from a clone.

use super::articulated::{Settings, World};
use super::bodies;
use super::gaits;
use glam::DVec3;

fn hash(world: &World) -> String {
    let mut hasher = blake3::Hasher::new();
    for id in world.bodies() {
        let (p, q, v, w) = (world.position(id), world.orientation(id), world.velocity(id), world.spin(id));
        for x in [p.x, p.y, p.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z] {
            hasher.update(&x.to_bits().to_le_bytes());
        }
    }
    hasher.finalize().to_hex()[..16].to_owned()
}

/// CI runs this in debug and in release: the figures hold in both, or one of them computes something else.
#[test]
fn two_thousand_steps_have_the_bits_they_always_had() {
    let golden = [
        ("crawler", "fb170a9f1f8d7d7a"),
        ("arm", "57e4c8b2e5b2c3d9"),
        ("hopper", "619642fba7b03396"),
        ("runner", "e84a4b24125df394"),
        ("flyer", "786d7c8e88075d03"),
    ];
    let mut seen = vec![];
    for gait in gaits::ALL {
        let mut creature = (gait.body)(bodies::earth());
        for step in 0..2000 {
            if step % 4 == 0 {
                (gait.commands)(&mut creature, f64::from(step) / 240.0);
            }
            creature.world.step(1.0 / 240.0).unwrap();
        }
        seen.push((gait.name, hash(&creature.world)));
    }
    let mut flyer = bodies::flyer(Settings { gravity: DVec3::NEG_Y * 9.81, ..bodies::space() });
    for step in 0..2000 {
        gaits::flap(&mut flyer, f64::from(step) * 0.05);
        flyer.world.step(0.05).unwrap();
    }
    seen.push(("flyer", hash(&flyer.world)));
    let seen: Vec<(&str, &str)> = seen.iter().map(|(name, hash)| (*name, hash.as_str())).collect();
    assert_eq!(seen, golden, "the physics has changed: raise the systems' versions with these");
}

/// T-20.
#[test]
fn a_creature_moves_alike_alone_and_among_others() {
    let alone: Vec<String> = gaits::ALL
        .iter()
        .map(|gait| {
            let mut creature = (gait.body)(bodies::earth());
            for step in 0..600 {
                (gait.commands)(&mut creature, f64::from(step) / 240.0);
                creature.world.step(1.0 / 240.0).unwrap();
            }
            hash(&creature.world)
        })
        .collect();
    let mut together: Vec<_> = gaits::ALL.iter().map(|gait| (gait.body)(bodies::earth())).collect();
    for step in 0..600 {
        for (gait, creature) in gaits::ALL.iter().zip(&mut together).rev() {
            (gait.commands)(creature, f64::from(step) / 240.0);
            creature.world.step(1.0 / 240.0).unwrap();
            if step == 300 {
                creature.world = creature.world.clone();
            }
        }
    }
    let together: Vec<String> = together.iter().map(|creature| hash(&creature.world)).collect();
    assert_eq!(alone, together);
}

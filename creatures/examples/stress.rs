#![allow(missing_docs)]
use creatures::physics::articulated;
use creatures::random::stream;
#[path = "../src/physics/articulated/tests/bodies.rs"]
mod bodies;
#[path = "../src/physics/articulated/tests/gaits.rs"]
mod gaits;
fn main() {
    for (k, gait) in gaits::ALL.iter().enumerate() {
        let mut hist = vec![0u64; 202];
        let start = std::time::Instant::now();
        let mut steps = 0u64;
        for seed in 0..60u64 {
            let d = &mut stream(seed, [k as u32, 0, 0], "stress");
            let mut c = (gait.body)(bodies::earth());
            let hold = 1 + d.below(60);
            for step in 0..1800 {
                if step % (4 * hold) == 0 {
                    for j in 0..c.joints.len() {
                        for dof in 0..c.world.degrees(c.joints[j]) {
                            let s = if d.chance(0.3) { 0.0 } else { d.between(-1.2, 1.2) };
                            c.command(j, dof, s);
                        }
                    }
                }
                c.world
                    .step(1.0 / 240.0)
                    .unwrap_or_else(|e| panic!("{} seed {seed} step {step}: {e}", gait.name));
                steps += 1;
                hist[c.world.rounds() as usize] += 1;
            }
        }
        let us = start.elapsed().as_secs_f64() * 1e6 / steps as f64;
        let mean = hist.iter().enumerate().map(|(r, n)| r as u64 * n).sum::<u64>() as f64 / steps as f64;
        let over = |m: usize| hist[m..].iter().sum::<u64>() as f64 / steps as f64 * 1e6;
        println!(
            "{:8} us {us:.3} mean {mean:.3} per million: >3 {:.0} >6 {:.0} >12 {:.0} >24 {:.0} >50 {:.0} >100 {:.0} cap {:.0}",
            gait.name,
            over(4),
            over(7),
            over(13),
            over(25),
            over(51),
            over(101),
            over(201)
        );
    }
}

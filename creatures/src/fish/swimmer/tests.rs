use super::*;
use crate::fish::body::MUSCLES;
use crate::fish::fins::{BRAKE, FinAngles, NEUTRAL};
use crate::fish::hydrodynamics::Still;
use crate::fish::mechanics::TIME_STEP;
use crate::fish::motor::Turn;
use crate::math::{sin, wrap_angle};
use crate::random::{Stream, stream};
use std::f64::consts::PI;

fn fish() -> Swimmer {
    Swimmer::new(Arc::new(Body::published(1.0)), DVec3::ZERO, 0.0)
}

/// Swims a gait for some steps.
fn swim(fish: &mut Swimmer, gait: &Gait, steps: usize, water: &impl Water) {
    for _ in 0..steps {
        let actuation = fish.motor.beat(gait);
        fish.practise(&actuation, water).unwrap();
    }
}

fn gait(amplitude: f64, beat: f64) -> Gait {
    Gait { amplitudes: [amplitude; 2], beats: [beat; 2], lag: PI }
}

fn close(found: DVec3, expected: [f64; 3]) {
    assert!((found - DVec3::from_array(expected)).abs().max_element() < 1e-6, "{found} is not {expected:?}");
}

/// T-10
#[test]
fn a_swim_passes_its_published_points() {
    let mut fish = fish();
    let beat = gait(1.0, 4.0);
    swim(&mut fish, &beat, 10, &Still);
    close(fish.center_of_mass(), [0.001746617, -0.407811158, 0.0]);
    close(fish.motion.positions[21], [0.499408533, -11.100230107, 2.397258324]);
    swim(&mut fish, &beat, 172, &Still);
    close(fish.center_of_mass(), [-0.020879381, 3.852690085, 0.0]);
    close(fish.motion.positions[0], [-0.065803600, 11.971823276, 0.0]);
    close(fish.motion.positions[21], [0.160174969, -6.629373379, 2.412027462]);
    let kinetic = fish.body.lattice.energy(&fish.motion, &fish.rest_lengths).kinetic;
    assert!((kinetic - 106.44825336).abs() < 1e-6, "{kinetic}");

    let mut other = self::fish();
    swim(&mut other, &gait(0.6, 3.0), 364, &Still);
    close(other.center_of_mass(), [-0.073080126, 3.981836980, 0.0]);
}

/// BL by time from rest, mean over the second half of 60 time units.
fn cruise(gait: &Gait, newton: u32) -> f64 {
    let mut fish = Swimmer::linearised(Arc::new(Body::published(1.0)), DVec3::ZERO, 0.0, newton);
    let half = 545; // of 60 time units, in steps
    swim(&mut fish, gait, half, &Still);
    let start = fish.center_of_mass();
    swim(&mut fish, gait, half, &Still);
    let way = fish.center_of_mass() - start;
    way.length() / (half as f64 * TIME_STEP) / fish.body.length()
}

/// T-26, A-24: ±2 % or ±0.0001.
#[test]
fn speed_follows_amplitude_and_rises_with_the_beat_up_to_a_threshold() {
    let beats = [1.0, 2.0, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 8.0];
    let table = [
        (0.25, [0.0019, 0.0065, 0.0091, 0.0161, 0.0204, 0.0201, 0.0139, 0.0074, 0.0055]),
        (0.50, [0.0041, 0.0151, 0.0187, 0.0332, 0.0417, 0.0415, 0.0297, 0.0154, 0.0113]),
        (0.75, [0.0063, 0.0251, 0.0286, 0.0487, 0.0591, 0.0595, 0.0453, 0.0239, 0.0173]),
        (1.00, [0.0080, 0.0351, 0.0385, 0.0617, 0.0719, 0.0731, 0.0596, 0.0328, 0.0236]),
    ];
    let mut misses = Vec::new();
    for (amplitude, speeds) in table {
        for (beat, expected) in beats.into_iter().zip(speeds) {
            let found = cruise(&gait(amplitude, beat), 1);
            if (found - expected).abs() > (0.02 * expected).max(1e-4) {
                misses.push((amplitude, beat, expected, found));
            }
        }
    }
    assert_eq!(misses, [], "amplitude, beat, expected, found");
}

/// lags of 0°, 90°, 180° and 270° at r 1, s 4.5, and either segment alone.
#[test]
fn the_tail_swims_best_half_a_beat_behind() {
    let near = |gait: Gait, expected: f64| {
        let found = cruise(&gait, 1);
        assert!((found - expected).abs() < 0.02 * expected, "{gait:?}: {found} is not {expected}");
    };
    for (quarters, expected) in [(0.0, 0.0280), (1.0, 0.0651), (2.0, 0.0731), (3.0, 0.0538)] {
        near(Gait { lag: 0.5 * PI * quarters, ..gait(1.0, 4.5) }, expected);
    }
    near(Gait { amplitudes: [1.0, 0.0], ..gait(1.0, 4.5) }, 0.0279);
    near(Gait { amplitudes: [0.0, 1.0], ..gait(1.0, 4.5) }, 0.0535);
}

///
#[test]
fn more_linearisations_change_a_swim_little() {
    for (beat, expected) in [(gait(0.6, 3.0), [0.0226, 0.0230]), (gait(1.0, 4.5), [0.0731, 0.0792])] {
        for (newton, expected) in [1, 4].into_iter().zip(expected) {
            let found = cruise(&beat, newton);
            assert!((found - expected).abs() < 0.02 * expected, "{newton}: {found} is not {expected}");
        }
    }
}

/// T-9
#[test]
fn mirrored_input_gives_the_mirrored_trajectory() {
    // Images of a ring's corners and of the tips, and which axis turns over.
    let mirror = |images: [usize; 4], tips: [usize; 2], flip: DVec3| {
        let (mut one, mut other) = (fish(), fish());
        let mut draws = stream(4, [0, 0, 0], "mirror");
        for _ in 0..364 {
            let actuation: Actuation = std::array::from_fn(|_| draws.unit());
            let mirrored = std::array::from_fn(|muscle| actuation[muscle - muscle % 4 + images[muscle % 4]]);
            one.practise(&actuation, &Still).unwrap();
            other.practise(&mirrored, &Still).unwrap();
        }
        let image = |node: usize| match node {
            0 => 0,
            21 | 22 => tips[node - 21],
            node => node - (node - 1) % 4 + images[(node - 1) % 4],
        };
        for node in 0..NODES {
            let (found, expected) = (other.motion.positions[image(node)], one.motion.positions[node] * flip);
            assert!((found - expected).length() < 1e-12, "{node}: {found} is not {expected}");
        }
    };
    mirror([1, 0, 3, 2], [21, 22], DVec3::new(-1.0, 1.0, 1.0));
    mirror([3, 2, 1, 0], [22, 21], DVec3::new(1.0, 1.0, -1.0));
}

/// T-11, A-9
#[test]
fn a_larger_fish_swims_the_same_way_larger() {
    let mut one = fish();
    let mut other = Swimmer::new(Arc::new(Body::published(1.7)), DVec3::ZERO, 0.0);
    let command = Command { swim: 1.0, turn: Turn::Bias(0.4), ..Command::default() };
    for _ in 0..400 {
        one.step(&command, &Still, &[]).unwrap();
        other.step(&command, &Still, &[]).unwrap();
    }
    for (a, b) in one.motion.positions.iter().zip(&other.motion.positions) {
        assert!((*a * 1.7 - *b).length() < 1e-11, "{a} {b}");
    }
}

/// T-12
#[test]
fn a_current_carries_a_fish() {
    let drift = |current: DVec3| {
        let mut fish = fish();
        for _ in 0..1818 {
            fish.practise(&[0.0; MUSCLES], &|_| current).unwrap();
        }
        fish.velocity()
    };
    let across = drift(DVec3::new(0.5, 0.0, 0.0));
    assert!((across - DVec3::new(0.492556, 0.012285, 0.0)).length() < 1e-5, "{across}");
    let along = drift(DVec3::new(0.0, 0.5, 0.0));
    assert!((along - DVec3::new(0.0, 0.387, 0.0)).length() < 1e-3, "{along}");

    let mut fish = fish();
    let against = |_: DVec3| DVec3::new(0.0, -1.0, 0.0);
    swim(&mut fish, &gait(1.0, 4.0), 1636, &against);
    let start = fish.center_of_mass();
    swim(&mut fish, &gait(1.0, 4.0), 182, &against);
    let net = (fish.center_of_mass() - start).y / (182.0 * TIME_STEP);
    assert!((net - 0.574).abs() < 0.00574, "{net}");
}

/// A fish that has swum at σ = 1 for so many steps.
fn cruising(steps: usize) -> Swimmer {
    let mut fish = fish();
    let command = Command { swim: 1.0, ..Command::default() };
    for _ in 0..steps {
        fish.step(&command, &Still, &[]).unwrap();
    }
    fish
}

/// Mean heading over one beat, rad: the head sways by several degrees.
fn mean_heading(fish: &mut Swimmer) -> f64 {
    let command = Command { swim: 1.0, ..Command::default() };
    let first = fish.posture().heading();
    let steps = 200; // seven beats to within a step
    let sway: f64 = (0..steps)
        .map(|_| {
            fish.step(&command, &Still, &[]).unwrap();
            wrap_angle(fish.posture().heading() - first)
        })
        .sum();
    first + sway / f64::from(steps)
}

/// Degrees by which a fish turns that is asked to by an angle in degrees.
fn turned(fish: &Swimmer, degrees: f64) -> f64 {
    let before = mean_heading(&mut fish.clone());
    let mut fish = fish.clone();
    let command = Command { swim: 1.0, turn: Turn::Angle(degrees.to_radians()), ..Command::default() };
    for _ in 0..600 {
        fish.step(&command, &Still, &[]).unwrap();
    }
    wrap_angle(mean_heading(&mut fish) - before).to_degrees()
}

/// T-26, A-26
#[test]
fn a_timed_turn_turns_by_its_angle() {
    let fish = cruising(420);
    for (degrees, expected) in
        [(5.0, 6.9), (10.0, 13.5), (20.0, 24.1), (30.0, 30.4), (45.0, 45.5), (60.0, 60.6), (90.0, 90.4)]
    {
        let found = turned(&fish, degrees);
        assert!((found - expected).abs() < 2.0, "{degrees}°: {found} is not {expected}");
        let right = turned(&fish, -degrees);
        assert!((found + right).abs() < 1.5, "{degrees}°: left {found}, right {right}");
    }
}

/// T-26: right is left in the mirror when the beat is mirrored too.
#[test]
fn a_right_turn_is_a_left_turn_in_the_mirror() {
    let end = |phase: f64, angle: f64| {
        let mut fish = fish();
        fish.motor.phases = [phase; 2];
        let command = Command { swim: 1.0, turn: Turn::Angle(angle), ..Command::default() };
        for _ in 0..300 {
            fish.step(&command, &Still, &[]).unwrap();
        }
        fish.center_of_mass()
    };
    let (left, right) = (end(0.0, 0.7), end(PI, -0.7));
    assert!((left * DVec3::new(-1.0, 1.0, 1.0) - right).length() < 1e-9, "{left} {right}");
}

/// T-26, A-31: the path over the last 5 of 60 time units. It goes on steepening.
#[test]
fn fins_make_a_fish_climb_and_dive() {
    let climb = |degrees: f64| {
        let mut fish = fish();
        let fins = FinAngles::both(degrees.to_radians());
        let command = Command { swim: 1.0, fins, ..Command::default() };
        for _ in 0..1000 {
            fish.step(&command, &Still, &[]).unwrap();
        }
        let start = fish.center_of_mass();
        for _ in 0..91 {
            fish.step(&command, &Still, &[]).unwrap();
        }
        let way = fish.center_of_mass() - start;
        let speed = way.length() / (91.0 * TIME_STEP) / fish.body.length();
        (crate::math::asin(way.z / way.length()).to_degrees(), speed)
    };
    for (degrees, expected, speed) in
        [(105.0, 16.8, 0.067), (120.0, 30.0, 0.054), (135.0, 34.8, 0.041), (150.0, 30.3, 0.033)]
    {
        let (found, found_speed) = climb(degrees);
        assert!((found - expected).abs() < 1.5, "{degrees}°: {found} is not {expected}");
        assert!((found_speed - speed).abs() < 0.002, "{degrees}°: {found_speed} is not {speed}");
    }
    assert!((climb(60.0).0 + climb(120.0).0).abs() < 1e-6, "diving mirrors climbing");
}

/// speeds after 2, 5 and 10 time units, with the fins at once where they are to be.
#[test]
fn fins_brake_a_coasting_fish() {
    let coast = |angle: f64| {
        let mut fish = cruising(545);
        fish.motor.fins = FinAngles::both(angle);
        let command = Command { fins: fish.motor.fins, ..Command::default() };
        [0, 37, 54, 91].map(|steps| {
            for _ in 0..steps {
                fish.step(&command, &Still, &[]).unwrap();
            }
            fish.velocity().length()
        })
    };
    for (angle, expected) in [(BRAKE, [1.38, 0.90, 0.44, 0.13]), (NEUTRAL, [1.38, 1.32, 1.12, 0.84])] {
        for (found, expected) in coast(angle).into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.01, "{found} is not {expected}");
        }
    }
}

/// one-sided static contraction bends the axis.
#[test]
fn a_bend_to_the_left_is_left() {
    let bend = |segments: std::ops::Range<usize>| {
        let mut fish = fish();
        let mut actuation = [0.0; MUSCLES];
        for segment in segments {
            (actuation[4 * segment], actuation[4 * segment + 3]) = (1.0, 1.0);
        }
        for _ in 0..500 {
            fish.practise(&actuation, &Still).unwrap();
        }
        let ring = |first: usize| fish.motion.positions[first..first + 4].iter().sum::<DVec3>() * 0.25;
        let head = (ring(1) - ring(5)).truncate();
        let peduncle = (ring(13) - ring(17)).truncate();
        peduncle.angle_to(head).to_degrees()
    };
    for (segments, expected) in [(0..1, 13.8), (1..2, 22.5), (2..3, 32.8), (0..2, 35.9), (1..3, 54.4)] {
        let found = bend(segments.clone());
        assert!((found - expected).abs() < 0.2, "{segments:?}: {found} is not {expected}");
    }
}

/// the fastest node of random input stays far below the bound.
#[test]
fn no_input_throws_a_fish_out_of_bounds() {
    let mut largest = 0.0f64;
    let mut run = |draw: fn(&mut Stream) -> f64, seed: u64| {
        let (mut fish, mut draws) = (fish(), stream(seed, [0, 0, 0], "bang"));
        for _ in 0..400 {
            let actuation: Actuation = std::array::from_fn(|_| draw(&mut draws));
            fish.practise(&actuation, &Still).unwrap();
            largest = fish.motion.velocities.iter().map(|v| v.length()).fold(largest, f64::max);
        }
    };
    for seed in 0..20 {
        run(|draws| if draws.chance(0.5) { 1.0 } else { 0.0 }, seed);
        run(Stream::unit, seed);
    }
    assert!(largest < 12.0, "{largest}");
}

///
#[test]
fn actuation_is_clamped_and_what_is_no_number_ends_the_step() {
    let ends = |u: f64| {
        let mut fish = fish();
        (0..20)
            .map(|_| fish.practise(&[u; MUSCLES], &Still))
            .find(Result::is_err)
            .map_or(Ok(fish.center_of_mass()), |fault| Err(fault.unwrap_err()))
    };
    assert_eq!(ends(3.0), ends(1.0));
    assert_eq!(ends(-3.0), ends(0.0));
    assert!(ends(f64::NAN).is_err());
}

///
#[test]
fn a_fish_backs_off_and_bobs_its_head() {
    let mut fish = fish();
    let back = Command { fins: FinAngles::both(BRAKE), stroke: 0.4, ..Command::default() };
    for _ in 0..2000 {
        fish.step(&back, &Still, &[]).unwrap();
    }
    let ahead = fish.velocity().dot(fish.posture().forward);
    assert!((-0.4..-0.3).contains(&ahead), "{ahead}");

    let mut fish = self::fish();
    let mut heights = Vec::new();
    for step in 0..400 {
        let time = f64::from(step) * TIME_STEP;
        let stroke = 0.3 * sin(PI * time / 2.0);
        fish.step(&Command { stroke, ..Command::default() }, &Still, &[]).unwrap();
        heights.push(fish.posture().mouth().z);
    }
    let range = heights.iter().fold(0.0f64, |most, z| most.max(z.abs()));
    assert!(range > 0.1, "the head moves by {range}");
}

//! T-5..T-9, T-22 (films take energy only) and T-23. T-10 runs on the engine, in the phenotype's tests.

use super::*;
use crate::physics::articulated::Body;
use crate::random::stream;

const DT: f64 = 0.05;
const GRAVITY: f64 = 9.81;
/// kg: the cylinder of R = 0.5, L = 40 (T-1).
const MASS: f64 = 0.319395;

fn vector(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn close(found: DVec3, expected: DVec3, tolerance: f64) {
    assert!((found - expected).abs().max_element() <= tolerance, "{found} is not {expected}");
}

/// T-5's film, about a centre of mass `x` along its first edge.
fn sail(alpha: f64, x: f64, limited: bool) -> Sail {
    let corners = [vector(0.0, 0.0, 0.0), vector(20.0, 0.0, 0.0), vector(0.0, 0.0, 30.0)];
    let film = Film { corners: corners.map(|corner| corner - vector(x, 0.0, 0.0)) };
    Sail::new(Air::scaled(alpha), &film, MASS, DT, limited)
}

fn power(wrench: &Wrench, velocity: DVec3, spin: DVec3) -> f64 {
    wrench.force.dot(velocity) + wrench.torque.dot(spin)
}

/// T-5
#[test]
fn a_film_in_slant_flow_feels_pressure_and_friction() {
    let velocity = vector(3.0, -2.0, 0.0);
    let wrench = sail(1.0, 0.0, false).drag(velocity, DVec3::ZERO);
    close(wrench.force, vector(-0.01629, 1440.0, 0.0), 1e-9);
    close(wrench.torque, vector(-14400.0, -0.1629, 9600.0), 1e-9);
    assert!((power(&wrench, velocity, DVec3::ZERO) + 2880.04887).abs() < 1e-5);
}

/// T-6
#[test]
fn a_turning_film_feels_the_air_where_it_moves() {
    let (sail, spin) = (sail(1e-3, 10.0, false), vector(0.0, 0.0, 0.5));
    let cases = [
        (DVec3::ZERO, vector(0.0, 2.0, 0.0), vector(-26.25, 0.0, -15.0), -7.5),
        (vector(0.0, -2.0, 0.0), vector(0.0, 6.34, 0.0), vector(-76.15, 0.0, -38.133333), -31.746667),
    ];
    for (velocity, force, torque, watts) in cases {
        let wrench = sail.drag(velocity, spin);
        close(wrench.force, force, 1e-6);
        close(wrench.torque, torque, 1e-6);
        assert!((power(&wrench, velocity, spin) - watts).abs() < 1e-6);
    }
}

/// F-43: the side to which the normal points does not matter.
#[test]
fn a_film_has_no_upper_side() {
    let film = Film { corners: [vector(0.0, 1.0, 0.0), vector(9.0, 0.0, 2.0), vector(1.0, 5.0, 7.0)] };
    let [a, b, c] = film.corners;
    let turned = Film { corners: [a, c, b] };
    let [one, other] = [film, turned].map(|film| {
        Sail::new(Air::scaled(1.0), &film, MASS, DT, false).drag(vector(1.0, -2.0, 3.0), DVec3::splat(0.1))
    });
    close(one.force, other.force, 1e-9);
    close(one.torque, other.torque, 1e-9);
}

/// T-7
#[test]
fn a_cylinder_is_dragged_by_its_side_and_its_caps() {
    let hull = Hull::new(Air::scaled(1e-3), 0.5, 40.0);
    let cases = [
        (vector(0.0, -10.0, 0.0), vector(0.0, 4.894248, 0.0)),
        (vector(0.0, 0.0, 10.0), vector(0.0, 0.0, -0.094248)),
        (vector(0.0, -5.0, 8.660254), vector(0.0, 1.247124, -2.160082)),
        (DVec3::ZERO, DVec3::ZERO),
    ];
    for (velocity, force) in cases {
        close(hull.drag(velocity, DVec3::ZERO).force, force, 1e-6);
    }
}

/// T-8: semi-implicit Euler until nothing changes. `attitude` takes the world's down to the cylinder's axes.
#[test]
fn a_falling_cylinder_reaches_its_terminal_speed() {
    let air = Air::scaled(1e-3);
    let level = Film { corners: [vector(0.0, 0.0, 0.0), vector(0.0, 0.0, 40.0), vector(20.0, 0.0, 0.0)] };
    let centroid = level.centroids()[3];
    let level = Film { corners: level.corners.map(|corner| corner - centroid) };
    let terminal = |radius: f64, length: f64, down: DVec3, film: Option<Film>| {
        let mass = Body::capsule(radius, length, 0.01, DVec3::ZERO).mass;
        let hull = Hull::new(air, radius, length);
        let sail = film.map(|film| Sail::new(air, &film, mass, DT, false));
        (0..20_000).fold(0.0, |speed: f64, _| {
            let motion = down * speed;
            let film = sail.map_or(DVec3::ZERO, |sail| sail.drag(motion, DVec3::ZERO).force);
            speed + DT * (GRAVITY + (hull.drag(motion, DVec3::ZERO).force + film).dot(down) / mass)
        })
    };
    let cases = [
        (0.5, 40.0, DVec3::NEG_Y, None, 8.001212),
        (0.5, 40.0, DVec3::Z, None, 57.658477),
        (2.0, 30.0, DVec3::NEG_Y, None, 15.910526),
        (0.5, 40.0, DVec3::NEG_Y, Some(level), 2.433854),
    ];
    for (radius, length, down, film, expected) in cases {
        let found = terminal(radius, length, down, film);
        assert!((found - expected).abs() < 2e-6, "{found} is not {expected}");
    }
}

/// T-9
#[test]
fn a_turning_cylinder_is_braked_about_each_axis() {
    let air = Air::scaled(1e-3);
    let hull = Hull::new(air, 0.5, 40.0);
    close(hull.turning, vector(105.966037, 105.966037, 0.0015375), 1e-6);
    let torque = |hull: &Hull, spin| hull.drag(DVec3::ZERO, spin).torque;
    close(torque(&hull, vector(0.5, 0.0, 0.0)), vector(-26.491509, 0.0, 0.0), 1e-6);
    close(torque(&hull, vector(0.0, 0.0, -2.0)), vector(0.0, 0.0, 0.00615), 1e-9);
    let body = Hull::new(air, 2.0, 30.0).with_tail(1.75);
    close(torque(&body, vector(0.5, 0.0, 0.0)), vector(-87.697050, 0.0, 0.0), 1e-6);
    close(torque(&body, vector(0.0, 0.5, 0.0)), vector(0.0, -50.1126, 0.0), 1e-6);
}

/// T-22: neither films nor cylinders give energy to what moves through the air.
#[test]
fn the_air_never_adds_energy() {
    let mut draws = stream(1, [0; 3], "aerodynamics test");
    let mut draw = |scale: f64| {
        let mut component = || draws.between(-scale, scale);
        vector(component(), component(), component())
    };
    let air = Air::scaled(1e-3);
    for round in 0..2000 {
        let film = Film { corners: [draw(40.0), draw(40.0), draw(40.0)] };
        let (velocity, spin) = (draw(50.0), draw(3.0));
        let sail = Sail::new(air, &film, MASS, DT, round % 2 == 0);
        let hull = Hull::new(air, 0.5, 40.0).with_tail(1.75);
        for wrench in [sail.drag(velocity, spin), hull.drag(velocity, spin)] {
            let watts = power(&wrench, velocity, spin);
            assert!(watts <= 0.0, "{watts} W from {film:?} at {velocity}, {spin}");
        }
    }
}

/// T-23
#[test]
fn the_stability_number_tells_how_much_a_step_takes_off() {
    let corners = [vector(0.0, 0.0, 0.0), vector(20.0, 0.0, 0.0), vector(0.0, 0.0, 40.0)];
    let sail = Sail::new(Air::scaled(1e-3), &Film { corners }, MASS, DT, false);
    assert!((sail.stability(10.0) - 0.751421).abs() < 1e-6);
}

/// F-40: without the limit a fast film is thrown back, with it it only slows down.
#[test]
fn a_limited_sail_never_turns_its_motion_back() {
    let after = |limited: bool, speed: f64| {
        let force = sail(1e-3, 0.0, limited).drag(vector(0.0, speed, 0.0), DVec3::ZERO).force;
        speed + DT * force.y / MASS
    };
    assert!(after(false, 100.0) < -100.0);
    for speed in [0.1, 10.0, 1000.0] {
        assert!(after(true, speed) > 0.0 && after(true, speed) < speed);
    }
}

///
#[test]
fn a_vacuum_does_nothing() {
    let still = Wrench { force: DVec3::ZERO, torque: DVec3::ZERO };
    let (velocity, spin) = (vector(1.0, 2.0, 3.0), vector(0.3, 0.2, 0.1));
    assert_eq!(sail(0.0, 0.0, false).drag(velocity, spin), still);
    assert_eq!(Hull::new(Air::scaled(0.0), 0.5, 40.0).drag(velocity, spin), still);
}

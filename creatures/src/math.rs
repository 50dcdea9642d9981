//! Portable mathematics: every transcendental function that the systems may call, from `libm`, so that
//! outcomes have the same bits on every machine. Angles are in radians.

pub use libm::{acos, asin, atan, atan2, cos, exp, fabs, floor, log, log10, pow, sin};

use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// Wraps an angle to [-π, π).
pub fn wrap_angle(angle: f64) -> f64 {
    let wrapped = angle - TAU * floor((angle + PI) / TAU);
    if wrapped >= PI { wrapped - TAU } else { wrapped }
}

/// The rotation vector (axis times angle, angle in [0, π]) of a unit quaternion.
pub fn rotation_vector(rotation: DQuat) -> DVec3 {
    let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
    let imaginary = DVec3::new(rotation.x, rotation.y, rotation.z);
    let sine = imaginary.length();
    if sine < 1e-12 { 2.0 * imaginary } else { imaginary * (2.0 * atan2(sine, rotation.w) / sine) }
}

/// The unit quaternion of a rotation vector: the inverse of [`rotation_vector`].
pub fn from_rotation_vector(vector: DVec3) -> DQuat {
    let angle = vector.length();
    let half = 0.5 * angle;
    let scale = if angle < 1e-12 { 0.5 } else { sin(half) / angle };
    DQuat::from_xyzw(vector.x * scale, vector.y * scale, vector.z * scale, cos(half))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_wrap_to_the_half_open_circle() {
        assert_eq!(wrap_angle(PI), -PI);
        assert_eq!(wrap_angle(-PI), -PI);
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-15);
        assert!((-PI..PI).contains(&wrap_angle(-1e-17 - PI)));
    }

    #[test]
    fn rotation_vectors_round_trip() {
        for vector in
            [DVec3::ZERO, DVec3::new(0.1, -0.2, 0.3), DVec3::new(0.0, 3.0, 0.0), DVec3::splat(1e-14)]
        {
            assert!((rotation_vector(from_rotation_vector(vector)) - vector).length() < 1e-12);
        }
    }
}

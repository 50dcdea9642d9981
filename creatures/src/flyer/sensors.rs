//! What a flyer feels: joint angles, joint stops, and a gyro that tells roll and pitch (F-25..F-27). It reads
//! no world; a phenotype hands it the numbers.

use super::function::limit;
use crate::math::{asin, atan2};
use glam::{DMat3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Below this length the wing-root points straight up or down, and has no roll (F-27).
const UPRIGHT: f64 = 1e-9;

/// A joint's angle as a share of its stop's, within [−1, 1] (F-26).
pub fn joint_angle(angle: f64, stop: f64) -> f64 {
    limit(angle / stop)
}

/// −1 within the last `fraction` of a joint's range on either side, and beyond it; else 1 (F-26).
pub fn joint_stop(angle: f64, stop: f64, fraction: f64) -> f64 {
    if stop - angle.abs() < fraction * stop { -1.0 } else { 1.0 }
}

/// Roll and pitch of the wing-root, each within [−1, 1], from its axes in the world's (F-27).
///
/// Roll is signed about z: 0 level, positive with the left side up, ±1 inverted; 0 where the nose points
/// straight up or down. Pitch is −1 with the nose straight down, 0 level, 1 straight up.
pub fn gyro(axes: &DMat3) -> (f64, f64) {
    let (x, y, z) = (axes.x_axis, axes.y_axis, axes.z_axis);
    let level = z.cross(DVec3::NEG_Y);
    let length = level.length();
    let roll = if length < UPRIGHT {
        0.0
    } else {
        let level = level / length;
        atan2(-level.dot(y), level.dot(x)) / PI
    };
    // The angle from straight down less a right angle is the angle above the horizon.
    let pitch = asin(z.y.clamp(-1.0, 1.0)) / FRAC_PI_2;
    (limit(roll), limit(pitch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn turned(axis: DVec3, degrees: f64) -> DQuat {
        crate::math::from_rotation_vector(axis * degrees.to_radians())
    }

    fn reads(attitude: DQuat, roll: f64, pitch: f64) {
        let found = gyro(&DMat3::from_quat(attitude));
        let close = (found.0 - roll).abs() < 1e-6 && (found.1 - pitch).abs() < 1e-6;
        assert!(close, "{found:?} is not ({roll}, {pitch})");
    }

    /// T-13
    #[test]
    fn the_gyro_reads_roll_and_pitch_whatever_the_heading() {
        reads(DQuat::IDENTITY, 0.0, 0.0);
        let rolled = turned(DVec3::Z, 30.0);
        for heading in [0.0, 45.0, 170.0, -90.0] {
            let yawed = turned(DVec3::Y, heading);
            reads(yawed * rolled, 0.166667, 0.0);
            reads(yawed * turned(DVec3::Z, -30.0), -0.166667, 0.0);
            reads(yawed * turned(DVec3::X, -30.0), 0.0, 0.333333);
            reads(yawed * turned(DVec3::X, 90.0), 0.0, -1.0);
        }
        let inverted = gyro(&DMat3::from_quat(turned(DVec3::Z, 180.0)));
        assert!((inverted.0.abs() - 1.0).abs() < 1e-12 && inverted.1.abs() < 1e-12, "{inverted:?}");
    }

    /// T-13
    #[test]
    fn nose_down_there_is_no_roll() {
        let axes = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y);
        assert_eq!(gyro(&axes), (0.0, -1.0));
        let axes = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);
        assert_eq!(gyro(&axes), (0.0, 1.0));
    }

    /// T-14
    #[test]
    fn joint_sensors_tell_the_angle_and_the_nearness_of_the_stop() {
        let cases = [(30.0, 0.5, 1.0), (54.1, 0.901667, -1.0), (53.9, 0.898333, 1.0), (70.0, 1.0, -1.0)];
        let stop = 60f64.to_radians();
        for (degrees, angle, nearness) in cases {
            for side in [1.0, -1.0] {
                let q = side * f64::to_radians(degrees);
                assert!((joint_angle(q, stop) - side * angle).abs() < 1e-6, "{degrees}");
                assert_eq!(joint_stop(q, stop, 0.1), nearness, "{degrees}");
            }
        }
    }

    ///
    #[test]
    fn no_number_reads_as_nothing() {
        assert_eq!(joint_angle(f64::NAN, 1.0), 0.0);
        assert_eq!(gyro(&DMat3::NAN), (0.0, 0.0));
    }
}

//! What a walker senses, and over which range (G-16, eq. 4). It reads no world: the phenotype measures,
//! this page scales.

use crate::math::atan2;
use glam::DVec3;
use std::f64::consts::PI;

/// Kinds of sensor with the ranges of the paper's first table, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sensor {
    /// Angle of a hinge, rad, within [−π, π).
    Hinge,
    /// Place in a slider's stroke: −1 retracted, +1 extended (see [`stroke`]).
    Slider,
    /// One component of a ball joint's rotation vector in the parent's frame, rad.
    Ball,
    /// One component of the torso's velocity in the world, m/s.
    LinearVelocity,
    /// One component of the torso's angular velocity in the world, rad/s.
    AngularVelocity,
    /// Height of the torso's centre, m.
    Height,
    /// Where the torso faces, rad (see [`Heading`]).
    Direction,
    /// 1 where a part touches the ground, else 0.
    Touch,
}

impl Sensor {
    /// Lowest and highest value told apart.
    pub fn range(self) -> (f64, f64) {
        match self {
            Sensor::Hinge | Sensor::Ball => (-PI, PI),
            Sensor::Slider => (-1.0, 1.0),
            Sensor::LinearVelocity => (-3.0, 3.0),
            Sensor::AngularVelocity => (-100.0, 100.0),
            Sensor::Height => (0.0, 10.0),
            Sensor::Direction => (0.0, 2.0 * PI),
            Sensor::Touch => (0.0, 1.0),
        }
    }

    /// Eq. 4: the value's share of the range, clamped to [0, 1]. NaN stays NaN.
    pub fn norm(self, value: f64) -> f64 {
        let (low, high) = self.range();
        (value.clamp(low, high) - low) / (high - low)
    }
}

/// A share of [0, 1] as NEAT takes it, within [−1, 1] (G-20).
pub fn signed(norm: f64) -> f64 {
    2.0 * norm - 1.0
}

/// A slider's reading from its extension and its stops, m: (d − mid)/half.
pub fn stroke(extension: f64, (low, high): (f64, f64)) -> f64 {
    (extension - 0.5 * (low + high)) / (0.5 * (high - low))
}

/// The direction sensor: straight ahead, which is −y, is π, so that the seam lies behind. Facing straight
/// up or down it keeps its last value.
#[derive(Debug, Clone)]
pub struct Heading {
    last: f64,
}

impl Default for Heading {
    /// As every creature starts.
    fn default() -> Self {
        Heading { last: PI }
    }
}

impl Heading {
    /// The direction of a forward axis given in the world, rad, within [0, 2π].
    pub fn read(&mut self, forward: DVec3) -> f64 {
        let DVec3 { x, y, .. } = forward;
        // NaN compares false, and so goes through to where it is refused.
        let upright = x * x + y * y < 1e-12;
        if !upright {
            self.last = atan2(x, -y) + PI;
        }
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T-8
    #[test]
    fn readings_are_scaled_to_their_ranges() {
        let ahead = Heading::default().read(DVec3::NEG_Y);
        let left = Heading::default().read(DVec3::X);
        let slid = stroke(0.02, (0.0, 0.08));
        assert!((slid + 0.5).abs() < 1e-12);
        let cases = [
            (Sensor::Hinge, PI / 6.0, 0.583333333333, 0.166666666667),
            (Sensor::Hinge, -PI, 0.0, -1.0),
            (Sensor::Slider, slid, 0.25, -0.5),
            (Sensor::Ball, -PI / 2.0, 0.25, -0.5),
            (Sensor::LinearVelocity, -0.9, 0.35, -0.3),
            (Sensor::LinearVelocity, 4.0, 1.0, 1.0),
            (Sensor::AngularVelocity, 25.0, 0.625, 0.25),
            (Sensor::Height, 0.15, 0.015, -0.97),
            (Sensor::Direction, ahead, 0.5, 0.0),
            (Sensor::Direction, left, 0.75, 0.5),
            (Sensor::Touch, 0.0, 0.0, -1.0),
            (Sensor::Touch, 1.0, 1.0, 1.0),
        ];
        for (sensor, value, norm, bipolar) in cases {
            let found = sensor.norm(value);
            assert!((found - norm).abs() < 1e-9, "{sensor:?} of {value} is {found}, not {norm}");
            assert!((signed(found) - bipolar).abs() < 1e-9, "{sensor:?} of {value}");
        }
    }

    /// X-13, G-4
    #[test]
    fn beyond_its_range_a_sensor_clamps_and_nan_stays_nan() {
        assert_eq!(Sensor::Height.norm(-0.5), 0.0);
        assert_eq!(Sensor::AngularVelocity.norm(1e9), 1.0);
        assert!(Sensor::Hinge.norm(f64::NAN).is_nan());
        assert!(Heading::default().read(DVec3::NAN).is_nan());
    }

    ///
    #[test]
    fn facing_straight_up_the_direction_keeps_its_last_value() {
        let mut heading = Heading::default();
        assert_eq!(heading.read(DVec3::Z), PI);
        let right = heading.read(DVec3::NEG_X);
        assert!((right - 0.5 * PI).abs() < 1e-12);
        assert_eq!(heading.read(DVec3::new(1e-7, -1e-7, 1.0)), right);
    }
}

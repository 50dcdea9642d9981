//! How the water moves by itself: a sum of simple flows, each given everywhere in closed form. Fishes do
//! not stir it.

use crate::SpecError;
use crate::fish::Water;
use crate::math::sin;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// One flow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "flow", rename_all = "snake_case", deny_unknown_fields)]
pub enum Current {
    /// The same everywhere and always.
    Uniform {
        /// Length by time.
        velocity: [f64; 3],
    },
    /// Linear in height: none at z = 0.
    Shear {
        /// Velocity gained by each length unit of height, 1/time.
        gradient: [f64; 3],
    },
    /// Swings to and fro everywhere at once.
    Swell {
        /// At its largest, length by time.
        velocity: [f64; 3],
        /// Rad by time.
        frequency: f64,
        /// At time 0, rad.
        phase: f64,
    },
    /// Turns about a vertical axis: like a solid within the core, by 1/r outside.
    Vortex {
        /// Where the axis stands.
        center: [f64; 2],
        /// Radius of the core.
        core: f64,
        /// Speed at the core's edge, length by time; counter-clockwise seen from above if positive.
        speed: f64,
    },
}

impl Current {
    /// Its velocity at a place and time.
    pub fn velocity(&self, at: DVec3, time: f64) -> DVec3 {
        match *self {
            Current::Uniform { velocity } => DVec3::from_array(velocity),
            Current::Shear { gradient } => DVec3::from_array(gradient) * at.z,
            Current::Swell { velocity, frequency, phase } => {
                DVec3::from_array(velocity) * sin(frequency * time + phase)
            }
            Current::Vortex { center: [x, y], core, speed } => {
                let (x, y) = (at.x - x, at.y - y);
                let square = x * x + y * y;
                let spin = if square <= core * core { speed / core } else { speed * core / square };
                DVec3::new(-y * spin, x * spin, 0.0)
            }
        }
    }

    /// # Errors
    /// The key that is out of range and what is allowed.
    fn check(&self) -> Result<(), SpecError> {
        let finite = |key: &str, values: &[f64]| {
            let legal = values.iter().all(|value| value.abs() <= 1e3);
            if legal { Ok(()) } else { Err(SpecError::new(key, "is not within -1000 to 1000")) }
        };
        match self {
            Current::Uniform { velocity } => finite("velocity", velocity),
            Current::Shear { gradient } => finite("gradient", gradient),
            Current::Swell { velocity, frequency, phase } => finite("velocity", velocity)
                .and_then(|()| finite("frequency", &[*frequency]))
                .and_then(|()| finite("phase", &[*phase])),
            Current::Vortex { center, core, speed } => {
                if !(*core > 0.0 && *core <= 1e3) {
                    return Err(SpecError::new("core", format!("{core} is not within (0, 1000]")));
                }
                finite("center", center).and_then(|()| finite("speed", &[*speed]))
            }
        }
    }
}

/// All flows together.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Currents(pub Vec<Current>);

impl Currents {
    /// u(x, t), length by time.
    pub fn velocity(&self, at: DVec3, time: f64) -> DVec3 {
        self.0.iter().fold(DVec3::ZERO, |sum, current| sum + current.velocity(at, time))
    }

    /// The water at a time, as bodies feel it.
    pub fn at(&self, time: f64) -> impl Water {
        move |at| self.velocity(at, time)
    }

    /// # Errors
    /// The number of the flow, its key, and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        for (index, current) in self.0.iter().enumerate() {
            current.check().map_err(|error| error.below(&format!("[{index}]")))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    ///
    #[test]
    fn flows_add_up() {
        let vortex = Current::Vortex { center: [1.0, 0.0], core: 2.0, speed: 3.0 };
        let swell = Current::Swell { velocity: [0.0, 0.0, 2.0], frequency: 0.5, phase: 0.0 };
        let shear = Current::Shear { gradient: [0.1, 0.0, 0.0] };
        let uniform = Current::Uniform { velocity: [0.5, 0.0, 0.0] };
        let close = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-12, "{a} is not {b}");
        close(vortex.velocity(DVec3::new(2.0, 0.0, 5.0), 0.0), DVec3::new(0.0, 1.5, 0.0));
        close(vortex.velocity(DVec3::new(1.0, 4.0, 0.0), 0.0), DVec3::new(-1.5, 0.0, 0.0));
        close(vortex.velocity(DVec3::new(1.0, 0.0, 0.0), 0.0), DVec3::ZERO);
        close(swell.velocity(DVec3::ZERO, std::f64::consts::PI), DVec3::new(0.0, 0.0, 2.0));
        let all = Currents(vec![uniform, shear, swell, vortex]);
        close(all.velocity(DVec3::new(2.0, 0.0, 10.0), 0.0), DVec3::new(1.5, 1.5, 0.0));
    }

    #[test]
    fn a_vortex_without_core_is_refused_by_name() {
        let flat = Currents(vec![Current::Vortex { center: [0.0; 2], core: 0.0, speed: 1.0 }]);
        assert_eq!(flat.check().unwrap_err().path, "[0].core");
    }
}
